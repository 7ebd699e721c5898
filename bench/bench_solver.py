"""Seconds, memory and accuracy of the optimisation, both formulations side by side.

    python bench/bench_solver.py [--sizes 400 10000 100000 1000000] [--repeats 9]

The tasks are settings of Fig. 12 from `surfaces.freeform_patch`: E, theta = theta0 = 60
degrees, where the paper's formulation is at its smallest, and B, mu = 1, in its general mode.
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

import inetlib
from inetlib import measure, solver, surfaces
from inetlib.solver import grids, sparse

SETTINGS = {"E": {"theta": np.radians(60), "theta0": np.radians(60)}, "B": {"mu": 1.0}}
CASES = {
    "spsolve": "paper, spsolve",
    "paper": "paper, splu",
    "ratio": "ratio, splu",
    "grids": "ratio, coarse to fine",
}
FULL = 17  # iterations of the paper
PAPER_FULL, MIDDLE = 1000, 20_000  # quads: all iterations up to here, two up to there
MOST = 200_000  # quads, for all but coarse to fine
THREADS = "OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS"
COLUMNS = (
    ("quads", 8),
    ("set", 3),
    ("formulation, solver", 21),
    ("steps", 6),
    ("s/shape step", 13),
    ("s/angle step", 13),
    ("s whole", 10),
    ("peak MB", 8),
    ("max deg off", 12),
    ("flips", 6),
    ("darts", 6),
    ("x step", 7),
    ("x angle", 8),
    ("x whole", 8),
)


def run_case(case, setting, quads, repeats):
    """The measured numbers of one case, medians over the repeats, as a dict."""
    side = round(quads**0.5)
    V, Q = surfaces.freeform_patch(side, side)
    take = {"spsolve": baseline, "paper": paper, "ratio": ratio, "grids": coarse_to_fine}[case]
    runs = [take(V, Q, SETTINGS[setting]) for _ in range(repeats)]
    result = [run.pop("result") for run in runs][-1]
    found = {key: median([run[key] for run in runs]) for key in runs[-1]}
    wanted = result.theta, result.theta0
    angles = measure.angles(result.V, Q)
    off = max(np.abs(a - b).max() for a, b in zip(angles, wanted, strict=True))
    flips, darts = (len(f(result.V, Q)) for f in (measure.flipped, measure.nonconvex))
    found |= {"off": float(np.degrees(off)), "flips": flips, "darts": darts}
    return found | {"quads": len(Q), "megabytes": megabytes()}


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
    return kinds | {"result": result, "steps": steps, "step": mean, "whole": whole}


def baseline(V, Q, setting):
    return paper(V, Q, setting, "paper")


def paper(V, Q, setting, formulation="paper, splu"):
    count = FULL if len(Q) <= PAPER_FULL else 2
    found = solved(V, Q, formulation=formulation, via="jump", iterations=count, **setting)
    return found | {"whole": found["whole"] + (FULL - count) * found["step"]}


def ratio(V, Q, setting):
    if len(Q) <= MIDDLE:
        return solved(V, Q, **setting)
    part = solved(V, Q, via="jump", shape_steps=0, iterations=2, **setting)
    return part | {"whole": None}


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
    return {"result": result, "steps": steps, "step": step, "angle": step, "whole": whole}


def child(case, setting, quads, repeats, limit):
    """`run_case` in a new process; a sentence where it takes too long or fails."""
    command = [sys.executable, __file__, "--case", case, "--settings", setting]
    command += ["--sizes", str(quads), "--repeats", str(repeats)]
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


def plan(sizes, settings, repeats, skip_paper):
    """Rows (case, setting, quads, repeats, why it is not run)."""
    for quads in sizes:
        for setting in settings if quads <= PAPER_FULL else settings[:1]:
            times = repeats if quads <= PAPER_FULL else min(repeats, 3) if quads <= MIDDLE else 1
            if not skip_paper:
                why = "too slow" if quads > MOST else ""
                for case in ("spsolve", "paper"):
                    yield case, setting, quads, times if quads <= PAPER_FULL else 1, why
            why = "the factors would fill the memory" if quads > MOST else ""
            yield "ratio", setting, quads, times, why
            if quads > PAPER_FULL and len(SETTINGS[setting]) == 2:
                yield "grids", setting, quads, times, ""


def row(case, setting, found, base):
    """The cells of one line of the table."""

    def cell(key, form):
        return "-" if found.get(key) is None else format(found[key], form)

    def faster(key, over):
        if case == "spsolve" or not isinstance(base, dict) or found.get(over) is None:
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


def table(rows, limit):
    """Print the whole table, a line as soon as it is known."""
    print(line([name for name, _ in COLUMNS]), flush=True)
    base, seconds = {}, {}
    for case, setting, quads, times, why in rows:
        print(f"{quads} quads, {setting}: {CASES[case]} ...", file=sys.stderr, flush=True)
        if why:
            found = f"not run: {why}{reckoned(seconds.get((case, setting), []), quads)}"
        else:
            found = child(case, setting, quads, times, limit)
        if isinstance(found, dict):
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
accuracy is that of the steps that were run: two for the paper from 10 000 quads on, and for
the ratios by splu at 100 000.  peak MB: of the whole process.  x: times faster than the
paper's formulation with SciPy's spsolve; step: mean of all steps, angle: angle steps only."""


def options(words=None):
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    sizes = [400, 10_000, 100_000, 1_000_000]
    parser.add_argument("--sizes", type=int, nargs="+", default=sizes, help="numbers of quads")
    parser.add_argument("--settings", nargs="+", default=list(SETTINGS), choices=SETTINGS)
    parser.add_argument("--repeats", type=int, default=9, help="of the small cases")
    parser.add_argument("--skip-paper", action="store_true", help="no baseline")
    parser.add_argument("--limit", type=float, default=180, help="seconds a case, at most")
    parser.add_argument("--case", choices=CASES, help="only this one, here, as JSON")
    given = parser.parse_args(words)
    if min(given.sizes) < 4 or given.repeats < 1:
        parser.error("at least 4 quads and one repeat are wanted")
    return given


def main():
    given = options()
    if given.case:
        print(json.dumps(run_case(given.case, given.settings[0], given.sizes[0], given.repeats)))
        return
    heading()
    table(plan(given.sizes, given.settings, given.repeats, given.skip_paper), given.limit)
    print(NOTES)


if __name__ == "__main__":
    main()
