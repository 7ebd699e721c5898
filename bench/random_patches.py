"""How often random patches reach random angles: rates by the distance of the angles.

python bench/random_patches.py [--patches 200] [--pairs 5] [--seed 1]

Bumpy patches of 8 x 8 to 30 x 30 quads, bumps up to 30 % of their size; targets uniform in
(30, 150) degrees.  Each run must end converged, without a flipped face or a dart as `measure`
judges, or say that it did not converge: one that claims more than the judge finds stops the
script."""

import argparse
import time

import numpy as np
from tqdm import tqdm

from inetlib import measure, mesh, solver

TOLERANCE = np.radians(1e-9)


def patch(rng):
    """A random patch (V, Q)."""
    m, n = rng.integers(8, 31, 2)
    u, v = np.meshgrid(np.linspace(0, 1, m + 1), np.linspace(0, n / m, n + 1), indexing="ij")
    z = sum(
        rng.normal() * np.cos(a * u + b * v + c)
        for a, b, c in rng.uniform(-1, 1, (4, 3)) * 2 * np.pi
    )
    z *= rng.uniform(0, 0.3) * max(1, n / m) / np.ptp(z)
    return np.stack([u, v, z], axis=-1).reshape(-1, 3), mesh.grid_quads(m, n)


def judge(V, Q, target):
    """Whether all faces have the angles and none is flipped or a dart."""
    off, quality = measure.deviations(V, Q, *target).max(), measure.quality(V, Q)
    return off <= TOLERANCE and quality.flips == 0 and quality.darts == 0


def runs(patches, pairs, seed):
    """One row a run: distance of the angles (degrees), converged, steps, seconds, area ratio."""
    rng = np.random.default_rng(seed)
    for _ in tqdm(range(patches), unit=" patches"):
        V, Q = patch(rng)
        mean = np.array([a.mean() for a in measure.angles(V, Q)])
        for target in rng.uniform(*np.radians([30, 150]), (pairs, 2)):
            start = time.perf_counter()
            found = solver.optimize(V, Q, *target)
            seconds = time.perf_counter() - start
            if found.converged != judge(found.V, Q, target):
                raise SystemExit(f"the solver says {found.message}, the judge disagrees")
            area = measure.quality(found.V, Q).area_ratio
            distance = np.degrees(np.abs(target - mean).max())
            yield distance, found.converged, len(found.history) - 1, seconds, area


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--patches", type=int, default=200)
    parser.add_argument("--pairs", type=int, default=5)
    parser.add_argument("--seed", type=int, default=1)
    options = parser.parse_args()
    table = np.array(list(runs(options.patches, options.pairs, options.seed)), dtype=float)
    print(
        "angles away      runs  converged  steps (median, most)  smallest area ratio  ms (median)"
    )
    for low, high in [*zip(range(0, 60, 15), range(15, 75, 15), strict=True), (0, 180)]:
        rows = table[(table[:, 0] >= low) & (table[:, 0] < high)]
        if len(rows):
            name = "all" if high == 180 else f"{low} to {high} degrees"
            print(
                f"{name:15s} {len(rows):5d}  {100 * rows[:, 1].mean():8.2f} %"
                f"  {np.median(rows[:, 2]):8.0f} {rows[:, 2].max():11.0f}"
                f"  {rows[:, 4].min():19.3f}  {1000 * np.median(rows[:, 3]):11.0f}"
            )


if __name__ == "__main__":
    main()
