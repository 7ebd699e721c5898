"""The benchmark runs and fills its table; how long anything takes is nobody's promise."""

import runpy
from pathlib import Path
from types import SimpleNamespace

import pytest

pytestmark = pytest.mark.program

SCRIPT = Path(__file__).resolve().parent.parent / "bench" / "bench_solver.py"
BENCH = SimpleNamespace(**runpy.run_path(str(SCRIPT)))


def test_the_smallest_case_fills_all_columns(capsys):
    given = BENCH.options(["--sizes", "400", "--repeats", "1", "--skip-paper"])
    BENCH.heading()
    BENCH.table(BENCH.plan(given.sizes, given.settings, given.repeats, True), given.limit)
    printed, progress = capsys.readouterr()
    first, names, *lines = printed.splitlines()
    assert "Python" in first and "SciPy" in first
    assert names.split() == " ".join(name for name, _ in BENCH.COLUMNS).split()
    peer, *lines = lines
    assert peer.startswith("     400    E  least_squares, lsmr ")
    steps, _, _, whole, _, off, flips, darts, small, unfair, *_ = peer.split()[4:]
    assert float(whole) > 0 and float(off) < 1e-9 and flips == darts == "0"
    for setting, text in zip("EB", lines, strict=True):
        assert text.startswith(f"     400    {setting}  solver.optimize ")
        steps, shape, angle, whole, peak, off, flips, darts, area, rough, *faster = text.split()[3:]
        assert int(steps) <= 12 and float(off) < 1e-9 and flips == darts == "0"
        assert float(area) > float(small) and float(rough) < float(unfair)
        assert min(float(x) for x in (shape, angle, whole)) > 0
        assert peak == "n/a" or float(peak) > 10
        assert faster == ["-", "-", "-"]
    assert "400 quads, B: solver.optimize ..." in progress


def test_large_sizes_of_slow_cases_are_not_run_and_say_why():
    rows = list(BENCH.plan([400, 10_000, 1_000_000], ["E", "B"], 9, False))
    large = [("grids", "E", 10_000), ("grids", "E", 1_000_000)]
    assert [row[:3] for row in rows if row[0] == "grids"] == large
    assert [row[:3] for row in rows if row[0] == "least"] == [
        ("least", "E", 400),
        ("least", "E", 10_000),
    ]
    slow = {(case, "E", 1_000_000) for case in ("spsolve", "paper")}
    assert {row[:3] for row in rows if row[4]} == slow


def test_covers_are_measured_too():
    assert [row[:3] for row in BENCH.plan([], ["E"], 1, True, [300])] == [("cover", "E", 300)]
    found = BENCH.run_case("cover", "E", 300, 1)
    assert found["quads"] == pytest.approx(300, rel=0.03) and found["off"] < 1e-9
    assert found["flips"] == found["darts"] == 0 < found["steps"] < 8


@pytest.mark.parametrize("words", [["--sizes", "1"], ["--repeats", "0"], ["--settings", "X"]])
def test_bad_options_are_refused(words, capsys):
    with pytest.raises(SystemExit) as stop:
        BENCH.options(words)
    assert stop.value.code == 2 and "usage" in capsys.readouterr().err
