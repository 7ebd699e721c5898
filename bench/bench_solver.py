"""Seconds, memory, accuracy and shape: both formulations, an independent peer, and covers.

    python bench/bench_solver.py [--sizes 400 2500 10000 100000 1000000] [--repeats 9]

The tasks are settings of Fig. 12 from `surfaces.freeform_patch`: E, theta = theta0 = 60
degrees, where the paper's formulation is at its smallest, and B, mu = 1, in its general mode.
"least_squares" is SciPy's (trf, lsmr) on the same two logarithms a face, with their sparse
Jacobian and nothing for the shape.  Covers are of `--surface`, or of an own shell.
Every case runs in a process of its own, so that its peak memory is its own too; seconds are
medians over the repeats.  "x" columns: how many times faster than the paper's formulation
with SciPy's spsolve."""

import argparse
import json
import os
import platform
import subprocess
import sys
import time
from itertools import pairwise

import numpy as np
import scipy
from scipy.optimize import least_squares

import inetlib
from inetlib import design, examples, io, measure, mesh, parallelogram, solver, surfaces
from inetlib.solver import grids, residuals, sparse

SETTINGS = {"E": {"theta": np.radians(60), "theta0": np.radians(60)}, "B": {"mu": 1.0}}
CASES = {
    "spsolve": "paper, spsolve",
    "paper": "paper, splu",
    "least": "least_squares, lsmr",
    "ratio": "solver.optimize",
    "grids": "grids.optimize",
    "cover": "design.cover",
}
COVERS = [1500, 20_000, 100_000]  # quads
FULL = 17  # iterations of the paper
PAPER_FULL, MIDDLE = 1000, 20_000  # quads: all iterations up to here, two up to there
MOST = 200_000  # quads, for all but coarse to fine
THREADS = "OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS"
COLUMNS = (
    ("quads", 8),
    ("set", 3),
    ("formulation, solver", 19),
    ("steps", 6),
    ("s/shape step", 13),
    ("s/angle step", 13),
    ("s whole", 10),
    ("peak MB", 8),
    ("max deg off", 12),
    ("flips", 6),
    ("darts", 6),
    ("area", 7),
    ("unfair", 7),
    ("x step", 7),
    ("x angle", 8),
    ("x whole", 8),
)


def run_case(case, setting, quads, repeats, surface=None):
    """The measured numbers of one case, medians over the repeats, as a dict."""
    if case == "cover":
        work, Q = cover(surface), None
    else:
        side = round(quads**0.5)
        V, Q = surfaces.freeform_patch(side, side)
        takes = {"spsolve": baseline, "paper": paper, "least": least, "ratio": ratio}
        take = (takes | {"grids": coarse_to_fine})[case]

        def work(quads, asked):
            return take(V, Q, asked)

    runs = [work(quads, SETTINGS[setting]) for _ in range(repeats)]
    nets = [(run.pop("V"), run.pop("angles"), run.pop("Q", Q)) for run in runs]
    V, wanted, Q = nets[-1]
    found = {key: median([run[key] for run in runs]) for key in runs[-1]}
    angles = measure.angles(V, Q)
    off = max(np.abs(a - b).max() for a, b in zip(angles, wanted, strict=True))
    flips, darts = (len(f(V, Q)) for f in (measure.flipped, measure.nonconvex))
    found |= {"off": float(np.degrees(off)), "flips": flips, "darts": darts}
    found |= {"area": measure.quality(V, Q).area_ratio, "unfair": unfairness(V, Q)}
    return found | {"quads": len(Q), "megabytes": megabytes()}


def unfairness(V, Q):
    """Root mean square of the second differences along the polylines, in mean edges."""
    left, middle, right = V[mesh.triples(Q)].swapaxes(0, 1)
    edge = np.linalg.norm(V[Q] - V[np.roll(Q, -1, axis=1)], axis=2).mean()
    return float(np.sqrt(np.mean(np.sum((left - 2 * middle + right) ** 2, axis=1))) / edge)


def median(values):
    values = [value for value in values if value is not None]
    return float(np.median(values)) if values else None


def megabytes():
    """Peak memory of this process; None on Windows."""
    try:
        import resource
    except ImportError:
        return None
    unit = 1 if sys.platform == "darwin" else 1024
    return resource.getrusage(resource.RUSAGE_SELF).ru_maxrss * unit / 1e6


def solved(V, Q, **options):
    """A run of `solver.optimize`, timed as a whole and between the steps."""
    clock = []

    def tick(step, _):
        clock.append((step.kind, time.perf_counter()))

    start = time.perf_counter()
    result = solver.optimize(V, Q, callback=tick, **options)
    whole = time.perf_counter() - start
    spans = [(kind, stop - start) for (_, start), (kind, stop) in pairwise(clock)]
    kinds = {k: median([t for kind, t in spans if kind == k]) for k in ("shape", "angle", "guided")}
    mean = sum(t for _, t in spans) / len(spans)
    steps = len(result.history) - 1
    net = {"V": result.V, "angles": (result.theta, result.theta0)}
    return kinds | net | {"steps": steps, "step": mean, "whole": whole}


def baseline(V, Q, setting):
    return paper(V, Q, setting, "paper")


def paper(V, Q, setting, formulation="paper, splu"):
    count = FULL if len(Q) <= PAPER_FULL else 2
    found = solved(V, Q, formulation=formulation, via="jump", iterations=count, **setting)
    return found | {"whole": found["whole"] + (FULL - count) * found["step"]}


def ratio(V, Q, setting):
    return solved(V, Q, **setting)


def least(V, Q, setting):
    """SciPy's `least_squares` on the two logarithms of every face."""
    wanted = np.log(parallelogram.ratios(setting["theta"], setting["theta0"]))
    columns = sparse.coordinates(Q)

    def local(x):
        return residuals.log_ratios(x.reshape(-1, 3)[Q].reshape(-1, 12))

    def residual(x):
        return (local(x)[0] - wanted).ravel()

    def jacobian(x):
        return sparse.rows(local(x)[1], columns, V.size)

    tight = dict.fromkeys(("xtol", "ftol", "gtol"), 1e-15)
    start = time.perf_counter()
    found = least_squares(residual, V.ravel(), jacobian, method="trf", tr_solver="lsmr", **tight)
    whole = time.perf_counter() - start
    net = {"V": found.x.reshape(-1, 3), "angles": (setting["theta"], setting["theta0"])}
    return net | {"steps": found.njev, "step": whole / found.njev, "whole": whole}


def coarse_to_fine(V, Q, setting):
    X = V.reshape(round(len(Q) ** 0.5) + 1, -1, 3)
    start = time.perf_counter()
    result = grids.optimize(X, **setting)
    whole = time.perf_counter() - start
    P = np.moveaxis(X, 2, 0)
    start = time.perf_counter()
    f, A = sparse.equations(P, 0, 0)
    d, _ = sparse.step(A, f)
    measure.angles(np.moveaxis(P - d, 0, 2).reshape(-1, 3), Q)
    step = time.perf_counter() - start
    steps = sum(step.kind != "start" for step in result.history)
    net = {"V": result.V, "angles": (result.theta, result.theta0)}
    return net | {"steps": steps, "step": step, "angle": step, "whole": whole}


def cover(path):
    """A function that covers the surface of a file, or of an example."""
    surface = io.read(path) if path else examples.hanging_shell()

    def work(quads, asked):
        clock = []
        start = time.perf_counter()
        net = design.cover(*surface, **asked, count=quads, callback=lambda *_: clock.append(0))
        whole = time.perf_counter() - start
        found = {"V": net.V, "Q": net.Q, "angles": (asked["theta"], asked["theta0"])}
        return found | {"steps": len(clock) - 1, "step": None, "whole": whole}

    return work


def child(case, setting, quads, repeats, limit, surface=None):
    """`run_case` in a new process; a sentence where it takes too long or fails."""
    command = [sys.executable, __file__, "--case", case, "--settings", setting]
    command += ["--sizes", str(quads), "--repeats", str(repeats)]
    command += ["--surface", surface] if surface else []
    environment = dict.fromkeys(THREADS, "1") | os.environ
    try:
        done = subprocess.run(
            command, env=environment, capture_output=True, text=True, timeout=limit
        )
    except subprocess.TimeoutExpired:
        return f"stopped after {limit:.0f} s"
    if done.returncode:
        return f"failed: {(done.stderr.strip() or 'killed').splitlines()[-1]}"
    return json.loads(done.stdout)


def plan(sizes, settings, repeats, skip_paper, covers=()):
    """Rows (case, setting, quads, repeats, why it is not run)."""
    for quads in sizes:
        for setting in settings if quads <= PAPER_FULL else settings[:1]:
            times = repeats if quads <= PAPER_FULL else min(repeats, 3) if quads <= MIDDLE else 1
            if not skip_paper:
                why = "too slow" if quads > MOST else ""
                for case in ("spsolve", "paper"):
                    yield case, setting, quads, times if quads <= PAPER_FULL else 1, why
            exact = len(SETTINGS[setting]) == 2
            if exact and quads <= MIDDLE:
                yield "least", setting, quads, times, ""
            yield "ratio", setting, quads, times, ""
            if quads > PAPER_FULL and exact:
                yield "grids", setting, quads, times, ""
    for quads in covers:
        yield "cover", "E", quads, min(repeats, 3), ""


def row(case, setting, found, base):
    """The cells of one line of the table."""

    def cell(key, form):
        return "-" if found.get(key) is None else format(found[key], form)

    def faster(key, over):
        if case == "spsolve" or not (base and isinstance(base, dict) and found.get(over)):
            return "-"
        times = base[key] / found[over]
        return f"{times:.0f}" if times >= 10 else f"{times:.1f}"

    guided = case in ("spsolve", "paper")
    estimated = guided and found["steps"] < FULL
    return [
        f"{found['quads']:.0f}",
        setting,
        CASES[case],
        cell("steps", ".0f"),
        cell("shape", ".4f"),
        cell("guided" if guided else "angle", ".4f"),
        ("~" if estimated else "") + cell("whole", ".3f"),
        cell("megabytes", ".0f") if found["megabytes"] else "n/a",
        cell("off", ".1e"),
        cell("flips", ".0f"),
        cell("darts", ".0f"),
        cell("area", ".3f"),
        cell("unfair", ".3f"),
        faster("step", "step"),
        faster("step", "angle"),
        faster("whole", "whole"),
    ]


def line(cells):
    return "  ".join(
        cell.rjust(width) if k != 2 else cell.ljust(width)
        for k, (cell, (_, width)) in enumerate(zip(cells, COLUMNS, strict=False))
    ).rstrip()


def reckoned(known, quads):
    """In words: the seconds of a step that the growth of the known ones leads to."""
    if len(known) < 2:
        return ""
    (one, early), (two, late) = known[-2:]
    growth = np.log(late / early) / np.log(two / one)
    return f", about {late * (quads / two) ** growth:.2g} s a step by the growth so far"


def table(rows, limit, surface=None):
    """Print the whole table, a line as soon as it is known."""
    print(line([name for name, _ in COLUMNS]), flush=True)
    base, seconds = {}, {}
    for case, setting, quads, times, why in rows:
        print(f"{quads} quads, {setting}: {CASES[case]} ...", file=sys.stderr, flush=True)
        if why:
            found = f"not run: {why}{reckoned(seconds.get((case, setting), []), quads)}"
        else:
            found = child(case, setting, quads, times, limit, surface)
        if isinstance(found, dict) and found["step"]:
            seconds.setdefault((case, setting), []).append((found["quads"], found["step"]))
        if case == "spsolve":
            base[quads, setting] = found
        if isinstance(found, str):
            print(line([str(quads), setting, CASES[case]]), f" {found}", flush=True)
        else:
            print(line(row(case, setting, found, base.get((quads, setting)))), flush=True)


def heading():
    threads = os.environ.get(THREADS[0], "1")
    print(f"inetlib {inetlib.__version__}, Python {platform.python_version()}, ", end="")
    print(f"NumPy {np.__version__}, SciPy {scipy.__version__}, {os.cpu_count()} cores, ", end="")
    print(f"{threads} BLAS thread{'s' * (threads != '1')}")


NOTES = f"""
set: E, theta = theta0 = 60 degrees; B, mu = 1 (the paper's general mode).  s/step: medians,
judging included; "angle" are smallest steps, for the paper its guided steps, for coarse to
fine one at full size.  s whole: with set-up; ~ reckoned from two of {FULL} iterations.  The
accuracy is that of the steps that were run: two for the paper above {PAPER_FULL} quads.  peak MB:
of the whole process.  area: the smallest quad / the largest; unfair: root mean square of the
second differences along the curves, in mean edges.  x: times faster than the paper's
formulation with SciPy's spsolve; step: mean of all steps, angle: angle steps only."""


def options(words=None):
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    sizes = [400, 2500, 10_000, 100_000, 1_000_000]
    parser.add_argument("--sizes", type=int, nargs="+", default=sizes, help="numbers of quads")
    parser.add_argument(
        "--covers", type=int, nargs="*", default=COVERS, help="their numbers of quads"
    )
    parser.add_argument("--surface", help="file of the surface that is covered")
    parser.add_argument("--settings", nargs="+", default=list(SETTINGS), choices=SETTINGS)
    parser.add_argument("--repeats", type=int, default=9, help="of the small cases")
    parser.add_argument("--skip-paper", action="store_true", help="no baseline")
    parser.add_argument("--limit", type=float, default=180, help="seconds a case, at most")
    parser.add_argument("--case", choices=CASES, help="only this one, here, as JSON")
    given = parser.parse_args(words)
    if min(given.sizes + given.covers) < 4 or given.repeats < 1:
        parser.error("at least 4 quads and one repeat are wanted")
    return given


def main():
    given = options()
    if given.case:
        one = given.settings[0], given.sizes[0], given.repeats, given.surface
        print(json.dumps(run_case(given.case, *one)))
        return
    heading()
    rows = plan(given.sizes, given.settings, given.repeats, given.skip_paper, given.covers)
    table(rows, given.limit, given.surface)
    print(NOTES)


if __name__ == "__main__":
    main()
