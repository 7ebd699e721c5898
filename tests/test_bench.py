"""The benchmark runs and fills its table; how long anything takes is nobody's promise."""

import runpy
import subprocess
import sys
from pathlib import Path

import pytest

SCRIPT = Path(__file__).resolve().parent.parent / "bench" / "bench_solver.py"
COLUMNS = runpy.run_path(str(SCRIPT))["COLUMNS"]


def bench(*options):
    """The lines that the script prints, and what it says meanwhile."""
    command = [sys.executable, str(SCRIPT), *options]
    done = subprocess.run(command, capture_output=True, text=True)
    assert done.returncode == 0, done.stderr
    return done.stdout.splitlines(), done.stderr


def test_the_smallest_case_fills_all_columns():
    lines, progress = bench("--sizes", "400", "--repeats", "1", "--skip-paper")
    assert "Python" in lines[0]
    assert "SciPy" in lines[0]
    assert lines[1].split() == " ".join(name for name, _ in COLUMNS).split()
    for setting, text in zip("EB", lines[2:4], strict=True):
        assert text.startswith(f"     400    {setting}  ratio, splu ")
        steps, shape, angle, whole, peak, off, flips, *faster = text.split()[4:]
        assert int(steps) <= 12
        assert min(float(x) for x in (shape, angle, whole)) > 0
        assert peak == "n/a" or float(peak) > 10
        assert float(off) < 1e-9
        assert flips == "0"
        assert faster == ["-", "-", "-"]
    assert "400 quads, B: ratio, splu ..." in progress


def test_large_sizes_of_slow_cases_are_not_run_and_say_why():
    plan = runpy.run_path(str(SCRIPT))["plan"]
    rows = list(plan([400, 10_000, 1_000_000], ["E", "B"], 9, False))
    assert [row[:3] for row in rows if row[0] == "grids"] == [
        ("grids", "E", 10_000),
        ("grids", "E", 1_000_000),
    ]
    assert {row[:3] for row in rows if row[4]} == {
        ("spsolve", "E", 1_000_000),
        ("paper", "E", 1_000_000),
        ("ratio", "E", 1_000_000),
    }


@pytest.mark.parametrize("options", [["--sizes", "1"], ["--repeats", "0"], ["--settings", "X"]])
def test_bad_options_are_refused(options):
    done = subprocess.run([sys.executable, str(SCRIPT), *options], capture_output=True, text=True)
    assert done.returncode == 2
    assert "usage" in done.stderr
