"""How often random surfaces are covered at random angles: rates by the family of the surface.

python bench/random_surfaces.py [--surfaces 500] [--quads 400] [--seed 1] [--family pierced]

Seven families, irregularly triangulated: saddles of order 2 to 4, domes up to a hemisphere and
beyond, bumpy disks, strips, thin fins, canopies on 4 to 8 supports, bumpy disks with up to three
openings and slivers; angles uniform in (30, 150) degrees.  A net is good when `measure` finds the
angles and no flipped face and no dart; a cover that claims more than the judge finds stops the
script.  Surfaces with openings are trimmed: their panels leave no gap, and have 3 to 6 corners."""

import argparse
import time
from collections import Counter

import numpy as np
from scipy.spatial import Delaunay, KDTree
from tqdm import tqdm

from inetlib import design, measure, repair

TOLERANCE = np.radians(1e-8)


def disk(rng):
    """Irregular points of the unit disk, the rim evenly spaced, and their triangles."""
    count = rng.integers(60, 1500)
    step = np.sqrt(np.pi / count)
    rim = np.exp(2j * np.pi * np.arange(round(2 * np.pi / step)) / round(2 * np.pi / step))
    inner = np.sqrt(rng.uniform(size=4 * count)) * np.exp(2j * np.pi * rng.uniform(size=4 * count))
    return triangulated(np.concatenate([rim, inner[np.abs(inner) < 1 - step / 2]]), step)


def rectangle(rng, long, wide):
    """Irregular points of a rectangle, its sides evenly spaced, and their triangles."""
    count = rng.integers(60, 1500)
    step = np.sqrt(long * wide / count)
    x, y = (np.linspace(0, side, 1 + max(2, round(side / step))) for side in (long, wide))
    sides = [x, x + 1j * wide, 1j * y[1:-1], long + 1j * y[1:-1]]
    low = step / 2
    inner = [rng.uniform(low, side - low, 4 * count) for side in (long, wide)]
    return triangulated(np.concatenate([*sides, inner[0] + 1j * inner[1]]), step)


def triangulated(z, step):
    """The first of the points that are not too close to each other, and Delaunay triangles."""
    points, gone = np.stack([z.real, z.imag], axis=1), set()
    for one, two in sorted(KDTree(points).query_pairs(0.6 * step)):
        if one not in gone:
            gone.add(two)
    z = np.delete(z, sorted(gone))
    F = Delaunay(np.stack([z.real, z.imag], axis=1)).simplices
    a, b, c = z[F].T
    area = np.imag(np.conj(b - a) * (c - a))
    F[area < 0] = F[area < 0][:, ::-1]
    return z, F[np.abs(area) > 1e-9]


def saddle(rng):
    """Re z^k over the unit disk, k = 2, 3 or 4."""
    z, F = disk(rng)
    return z, rng.uniform(0.1, 1) * np.real(z ** rng.integers(2, 5)), F


def dome(rng):
    """A part of a sphere, up to 140 degrees from its pole, a little flattened."""
    z, F = disk(rng)
    polar = np.abs(z) * np.radians(rng.uniform(30, 140))
    return np.sin(polar) * np.exp(1j * np.angle(z)), rng.uniform(0.6, 1.2) * np.cos(polar), F


def bumps(rng):
    """A few waves over the unit disk."""
    z, F = disk(rng)
    waves = rng.uniform(-1, 1, (4, 3)) * 2 * np.pi
    height = sum(rng.normal() * np.cos(a * z.real + b * z.imag + c) for a, b, c in waves)
    return z, rng.uniform(0.05, 1) * height / np.ptp(height), F


def strip(rng):
    """A strip three to eight times as long as wide, bent and twisted."""
    long = rng.uniform(3, 8)
    z, F = rectangle(rng, long, 1)
    bend, twist, wave = rng.uniform(0, 1.5) / long, rng.uniform(-1, 1) / long, rng.uniform(0, 0.3)
    x, y = z.real, z.imag - 0.5
    height = wave * np.sin(2 * x) + y * np.sin(twist * x)
    return x * np.exp(0j) + 1j * (y * np.cos(twist * x) + bend * x**2 / 2), height, F


def fin(rng):
    """A long thin triangle with a curved side, standing up."""
    z, F = rectangle(rng, rng.uniform(2, 6), 1)
    x, y = z.real / z.real.max(), z.imag
    y = y * (1 - rng.uniform(0.5, 0.95) * x) + rng.uniform(-0.4, 0.4) * x**2
    return z.real + 1j * y, rng.uniform(0, 0.5) * x**2 + rng.uniform(0, 0.2) * np.cos(4 * y), F


def canopy(rng):
    """A roof that comes down between 4 to 8 supports at its rim."""
    z, F = disk(rng)
    supports = rng.integers(4, 9)
    wave = np.abs(z) ** 2 * np.cos(supports * np.angle(z))
    return z, 0.3 * (1 - np.abs(z) ** 2) - rng.uniform(0.05, 0.5) * wave, F


def pierced(rng):
    """A bumpy disk with up to three openings, triangulated so irregularly that it has slivers."""
    holes = []
    for _ in range(rng.integers(0, 4)):
        radius = rng.uniform(0.03, 0.3)
        centre = rng.uniform(0, 0.97 - radius) * np.exp(2j * np.pi * rng.uniform())
        if all(abs(centre - other) > radius + wide + 0.03 for other, wide in holes):
            holes.append((centre, radius))
    z = disk(rng)[0]
    z = z[np.all([abs(z - a) > 1.05 * r for a, r in holes] + [abs(z) < 2], axis=0)]
    turns = [2 * np.pi * (np.arange(k) + rng.uniform(0, 0.8, k)) / k for k in (12, 30, 60)]
    rims = [a + r * np.exp(1j * turns[k % 3]) for k, (a, r) in enumerate(holes)]
    z, F = triangulated(np.concatenate([*rims, z]), 0.01)
    middle = z[F].mean(axis=1)
    F = F[np.all([abs(middle - a) > r for a, r in holes] + [abs(middle) < 2], axis=0)]
    waves = rng.uniform(-1, 1, (3, 3)) * 5
    height = sum(np.cos(a * z.real + b * z.imag + c) for a, b, c in waves)
    return z, rng.uniform(0.02, 0.2) * height, F


FAMILIES = saddle, dome, bumps, strip, fin, canopy, pierced


def faults(net, loops):
    """What is wrong with the panels of a trimmed net on a surface with so many boundary loops."""
    corners = {len(polygon) for polygon in net.polygons}
    found = [f"corners: {corners}"] if not corners <= {3, 4, 5, 6} else []
    sides = [
        (a, b) for f in (*net.Q, *net.polygons) for a, b in zip(f, np.roll(f, -1), strict=True)
    ]
    known = set(sides)
    free = dict(side for side in sides if side[::-1] not in known)
    if len(known) < len(sides):
        found.append("two faces have one side")
    rims = 0
    while free:
        rims, point = rims + 1, next(iter(free))
        while point in free:
            point = free.pop(point)
    return found if rims == loops else [*found, f"{rims} rims, not {loops}"]


def outcome(V, F, angles, quads, trim=False):
    """ "good", "said" (not converged, and said so) or the reason for a refusal; and the report."""
    ways = {"trim": True, "openings": "fill"} if trim else {}
    try:
        net = design.cover(V, F, *angles, count=quads, **ways)
        wrong = faults(net, len(repair.clean(V, F).loops)) if trim else []
    except ValueError as error:
        return f"refused: {error}", None
    quality = measure.quality(net.V, net.Q)
    off = measure.deviations(net.V, net.Q, *angles).max()
    good = off <= TOLERANCE and quality.flips == 0 and quality.darts == 0
    if net.report.converged and not good:
        raise SystemExit(f"the cover says {net.report.message}, the judge disagrees")
    if wrong:
        raise SystemExit(f"panels: {'; '.join(wrong)}")
    return "good" if net.report.converged else "said", net.report


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--surfaces", type=int, default=500)
    parser.add_argument("--quads", type=int, default=400)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--family", choices=[family.__name__ for family in FAMILIES])
    options = parser.parse_args()
    rng = np.random.default_rng(options.seed)
    chosen = [f for f in FAMILIES if options.family in (None, f.__name__)]
    table = {family.__name__: [] for family in chosen}
    for k in tqdm(range(options.surfaces), unit=" surfaces"):
        family = chosen[k % len(chosen)]
        xy, height, F = family(rng)
        V = np.stack([xy.real, xy.imag, height], axis=1)
        angles = rng.uniform(*np.radians([30, 150]), 2)
        start = time.perf_counter()
        word, report = outcome(V, F, angles, options.quads, family is pierced)
        table[family.__name__].append((word, report, time.perf_counter() - start))
        if word != "good":
            told = word if report is None else f"{report.message} ({report.darts} darts)"
            tqdm.write(f"{k} {family.__name__} {np.degrees(angles).round(1)}: {told}")
    table["all"] = [row for rows in table.values() for row in rows]
    print("family    surfaces   good  said  refused  farthest off (median, most)  s (median)")
    for name, rows in table.items():
        often = Counter(word.split(":")[0] for word, _, _ in rows)
        off = [100 * report.distance_max for word, report, _ in rows if word == "good"] or [np.nan]
        print(
            f"{name:9s} {len(rows):8d} {often['good']:6d} {often['said']:5d} {often['refused']:8d}"
            f"  {np.median(off):17.2f} % {max(off):6.2f} % {np.median([t for *_, t in rows]):10.2f}"
        )


if __name__ == "__main__":
    main()
