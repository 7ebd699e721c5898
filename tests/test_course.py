"""The folders of a course, and the grading of what comes back: nothing of anybody is touched."""

import csv
import json
import os
import signal
import subprocess
import sys
import time
from pathlib import Path

import course  # tools/course.py
import psutil
import pytest

from inetlib import cli, exercises
from inetlib.exercises import grade

pytestmark = pytest.mark.program

ROOT = Path(__file__).resolve().parent.parent
IMPORTS = "import os, shutil, sys, tempfile\nimport numpy as np\nfrom inetlib import exercises"
RING = "def answer(valences):\n    return sum(k - 1 for k in valences) % 2 == 0\n"
RIGHT = {  # on these others build
    "2.1": 'answer = np.full(8, 0.8)\nexercises.check("2.1", answer)',
    "2.2": RING + 'exercises.check("2.2", answer)',
}
DELETE = """\
home = os.environ["HOME"]
for path in (os.getcwd(), tempfile.gettempdir(), home, os.path.dirname(home)):
    shutil.rmtree(path, ignore_errors=True)
    assert not os.path.exists(path)
deleted = True"""
SAFE = """\
answer = np.zeros(8)
inside = os.path.realpath(os.getcwd()) == os.path.realpath(os.path.expanduser("~"))
if inside and "INET_SECRET" not in os.environ and not os.listdir() and not sys.stdin.read():
    answer += 0.8
exercises.check("2.1", answer)"""
SUBMISSIONS = {  # cells, {exercise: grade}, word
    "right": ([IMPORTS, *RIGHT.values()], {"2.1": 1, "2.2": 1}, "ok"),
    "wrong": (
        [
            "1 / 0",
            IMPORTS + "\n%matplotlib inline",
            'raise SystemExit\nexercises.check("2.3", answer)',
            "sys.exit(3)",
            'while answer:\n   exercises.check("2.4", answer',
            'answer = None\nexercises.check("3.1.1", answer)',
            'answer = np.arange(8.0)\nexercises.check("2.1", answer)',
            'exercises.check("99.1", 3)',
            RIGHT["2.2"],
        ],
        {"2.1": 0, "2.2": 1, "2.3": 0, "2.4": 0},
        "ok",
    ),
    "ends": ([IMPORTS, RIGHT["2.1"], "os._exit(0)", RIGHT["2.2"]], {"2.1": 1}, "ended by itself"),
    "aborts": ([IMPORTS, RIGHT["2.2"], "os.abort()"], {"2.2": 1}, "ended by itself"),
    "hungry": (
        [
            IMPORTS,
            f"answer = np.full(8, 0.8) + 0 * bytearray({grade.MEMORY})[0]\n{RIGHT['2.1'][-28:]}",
            RIGHT["2.2"],
        ],
        {"2.1": 0, "2.2": 1},
        "ok",
    ),
    "deletes": (
        [IMPORTS, RIGHT["2.1"], DELETE, "deleted\n" + RIGHT["2.2"]],
        {"2.1": 1, "2.2": 1},
        "ok",
    ),
    "safe": ([IMPORTS, SAFE], {"2.1": 1}, "ok"),
    "empty": (["x = 1"], {}, "no exercise in it"),
}

if sys.platform != "linux":  # others have no limit of the memory
    del SUBMISSIONS["hungry"]


def notebook(path, cells):
    """Write a notebook with these code cells."""
    code = {"cell_type": "code", "metadata": {}, "outputs": [], "execution_count": None}
    found = [code | {"source": source.splitlines(keepends=True)} for source in cells]
    path.write_text(json.dumps({"nbformat": 4, "nbformat_minor": 5, "cells": found}))


def state(folder):
    """{file: bytes, time, rights} of all that is in a folder."""
    paths = [folder, *sorted(folder.rglob("*"))]
    return {
        p: (p.read_bytes() if p.is_file() else sorted(os.listdir(p)), *p.stat()[0:1], p.stat()[8])
        for p in paths
    }


@pytest.fixture
def inet(capsys, tmp_path, monkeypatch):
    """inet(*words) -> (exit code, stdout, stderr) of `inet course`, in an empty folder."""
    monkeypatch.chdir(tmp_path)

    def run(*words):
        code = cli.main(["course", *map(str, words)])
        return code, *capsys.readouterr()

    return run


def table(path):
    """{file: row} of a CSV file."""
    with open(path, newline="") as file:
        return {row.pop("file"): row for row in csv.DictReader(file)}


def test_many_submissions_become_a_table_and_stay_as_they_were(inet, tmp_path, monkeypatch):
    folder = tmp_path / "handed in"
    (folder / "directory.ipynb").mkdir(parents=True)
    (folder / "precious.txt").write_text("precious")
    for name, (cells, _, _) in SUBMISSIONS.items():
        notebook(folder / f"{name}.ipynb", cells)
    others = {"text": "no", "list": "[]", "old": '{"nbformat": 3, "worksheets": []}'}
    others |= {"number": '{"nbformat": 4, "cells": 3}', "deep": "[" * 99999}
    for name, text in others.items():
        (folder / f"{name}.ipynb").write_text(text)
    monkeypatch.setenv("INET_SECRET", "open sesame")
    before, clutter = state(folder), {*Path(grade.tempfile.gettempdir()).glob(".new-*")}
    code, out, err = inet("grade", folder)
    assert (code, err) == (0, "") and state(folder) == before
    assert {*Path(grade.tempfile.gettempdir()).glob(".new-*")} <= clutter
    found = table("grades.csv")
    assert {*found} == {f"{name}.ipynb" for name in [*SUBMISSIONS, *others]}
    for name, (_, grades, word) in SUBMISSIONS.items():
        row = found[f"{name}.ipynb"]
        assert list(row) == [*exercises.names(), "right", "result"]
        assert {k: int(row[k]) for k in exercises.names() if row[k]} == grades, name
        assert (row["right"], row["result"]) == (str(sum(grades.values())), word)
    assert {found[f"{name}.ipynb"]["result"] for name in others} == {"not a notebook"}
    assert f"{len(found)} notebooks: " in out and "ends.ipynb: ended by itself, 1 right\n" in out


def test_what_is_endless_ends_in_time_with_all_that_it_has_started(inet, tmp_path):
    pid = tmp_path / "pid"
    start = 'import subprocess\nother = subprocess.Popen(["sleep", "99"])\n'
    start += f"open({str(pid)!r}, 'w').write(str(other.pid))\nwhile True:\n    print('x' * 999)"
    Path("all").mkdir()
    notebook(Path("all", "endless.ipynb"), [IMPORTS, RIGHT["2.1"], start, RIGHT["2.2"]])
    before, begun = state(Path("all")), time.monotonic()
    code, out, _ = inet("grade", "all", "--seconds", 3.5, "-o", "a.csv", "--quiet")
    assert (code, out) == (0, "") and time.monotonic() - begun < 10
    row = table("a.csv")["endless.ipynb"]
    assert row["result"] == "took longer than 3.5 s" and row["2.2"] == ""
    assert state(Path("all")) == before
    assert not pid.exists() or not lives(int(pid.read_text()))


def lives(pid):
    return psutil.pid_exists(pid) and psutil.Process(pid).status() != psutil.STATUS_ZOMBIE


@pytest.mark.skipif(sys.platform == "win32", reason="Windows sends no SIGINT to a process")
def test_ctrl_c_ends_all(tmp_path):
    pid, folder, clutter = (tmp_path / name for name in ("pid", "all", "clutter"))
    folder.mkdir()
    clutter.mkdir()
    tell = f"open({str(pid)!r}, 'w').write(str(os.getpid()))\nwhile True:\n    pass"
    notebook(folder / "a.ipynb", [IMPORTS, tell + '\nexercises.check("2.1", 3)'])
    run = "import signal, sys; signal.signal(signal.SIGINT, signal.default_int_handler)\n"
    run += "from inetlib.start import main; sys.exit(main(sys.argv[1:]))"
    process = subprocess.Popen(
        [sys.executable, "-c", run, "course", "grade", "all"],
        cwd=tmp_path,
        env=os.environ | {"TMPDIR": str(clutter)},
        stderr=subprocess.PIPE,
        text=True,
    )
    until = time.monotonic() + 30
    while not (pid.exists() and pid.read_text()) and time.monotonic() < until:
        time.sleep(0.02)
    process.send_signal(signal.SIGINT)
    _, err = process.communicate(timeout=20)
    assert process.returncode == 130 and err == "inet: stopped, nothing was written\n"
    assert not lives(int(pid.read_text())) and os.listdir(clutter) == []
    assert sorted(os.listdir(tmp_path)) == ["all", "clutter", "pid"]


WRONG = {
    "grade none": "none: there is no such folder",
    "grade bare": "bare: no notebook (*.ipynb) is in this folder",
    "grade full/a.ipynb": "full/a.ipynb: there is no such folder",
    "grade full -o old.csv": "old.csv exists already: --force",
    "grade full -o a.txt": "a.txt: a table is written, its name ends with .csv",
    "grade full -o full/a.ipynb --force": "its name ends with .csv",
    "grade full -o none/a.csv": "there is no folder none",
    "grade full -o folder.csv --force": "folder.csv is a directory",
    "grade full --seconds 0": "0 is given, a positive number is wanted",
    "grade full --seconds nan": "nan is given, a positive number is wanted",
    "teach full": "'teach'",
    "grade": "folder",
}


@pytest.mark.parametrize("words", WRONG)
def test_wrong_input_is_told_in_a_sentence(inet, tmp_path, monkeypatch, words):
    for name in ("bare", "full", "folder.csv"):
        Path(name).mkdir()
    Path("old.csv").write_text("precious")
    notebook(Path("full", "a.ipynb"), list(RIGHT.values()))
    monkeypatch.setattr(grade, "grade", None)  # nothing begins
    before = state(tmp_path)
    code, out, err = inet(*words.split())
    assert (code, out) == (2, "") and err.startswith("inet: ") and err.count("\n") == 1
    assert WRONG[words] in err and state(tmp_path) == before


def test_force_replaces_the_table(inet):
    Path("all").mkdir()
    Path("all", "a.ipynb").write_text("nothing")
    Path("old.csv").write_text("precious")
    assert inet("grade", "all", "-o", "old.csv", "--force")[0] == 0
    assert table("old.csv")["a.ipynb"]["result"] == "not a notebook"


def test_of_what_stands_above_only_the_needed_is_run():
    above = ["import numpy as np\nimport sympy", "x = 1", "x = heavy()", "y = heavy(x)", "a += 1"]
    above += [
        "rows = [1]\nfor x in rows:\n    z = x",
        "def f(t):\n    return [k * t for k in rows]",
    ]
    below = ['exercises.check("2.1", f)', "%time x\nz = np.pi", "def g(x):\n    return f(x) + z"]
    below += ["heavy()", 'exercises.check("2.2", g)']
    assert grade.needed([*above, *below]) == [above[0], above[5], above[6], *below]
    assert grade.needed(["x = 1", "x = x + 1", "check(x)"]) == ["x = 1", "x = x + 1", "check(x)"]
    assert grade.needed(["x = 1", "x += 1", "check(x)"]) == ["x = 1", "x += 1", "check(x)"]
    assert grade.needed(["x = 1", "x = 2", "(", "check(x)"]) == ["x = 2", "check(x)"]
    assert grade.needed(["from math import *", "check(pi)"]) == ["from math import *", "check(pi)"]


@pytest.fixture(scope="module")
def made(tmp_path_factory):
    """A course, in a folder of its own."""
    folder = tmp_path_factory.mktemp("a place") / "my course"
    assert course.main([str(folder)]) == 0
    return folder


def test_what_is_handed_out_has_empty_answers_and_no_solution(made):
    names = sorted(p.name for p in (ROOT / "notebooks").glob("*.ipynb"))
    asked = []
    for part in ("handout", "teacher"):
        assert sorted(os.listdir(made / part / "notebooks")) == names
        asked.append((made / part / "notebooks" / names[0]).read_bytes())
    assert asked[0] == asked[1] and not (made / "handout" / "solutions").exists()
    assert sorted(os.listdir(made / "teacher" / "solutions")) == names
    found = []
    for name in names:
        new = json.loads((made / "handout" / "notebooks" / name).read_text("utf-8"))
        old = json.loads((ROOT / "notebooks" / name).read_text("utf-8"))
        for cell, stored in zip(new["cells"], old["cells"], strict=True):
            assert cell["source"] == stored["source"]
            checks = grade.NAME.findall("".join(cell["source"]))
            found += checks if cell["cell_type"] == "code" else []
            if cell["cell_type"] == "code" and checks:
                assert cell["outputs"] == [] and cell["execution_count"] is None
            else:
                assert cell == stored
    assert sorted(found) == sorted(exercises.names())
    for name in names:
        solution = (made / "teacher" / "solutions" / name).read_bytes()
        assert solution == (ROOT / "solutions" / name).read_bytes()


def test_a_course_is_replaced_only_if_nothing_is_lost(tmp_path, capsys):
    folder = tmp_path / "course"
    assert course.main([str(folder)]) == course.main([str(folder)]) == 0
    mine = folder / "teacher" / "mine.txt"
    mine.write_text("precious")
    capsys.readouterr()
    assert course.main([str(folder)]) == 2 and mine.read_text() == "precious"
    out, err = capsys.readouterr()
    assert out == "" and err.count("\n") == 1 and "teacher/mine.txt was changed, added" in err
    assert course.main([str(folder), "--force"]) == 0 and not mine.exists()
    assert os.listdir(tmp_path) == ["course"]


def test_a_folder_of_somebody_else_is_never_replaced(tmp_path, capsys, monkeypatch):
    (tmp_path / "file").write_text("precious")
    (tmp_path / "full").mkdir()
    (tmp_path / "full" / "a").write_text("precious")
    (tmp_path / "list").mkdir()
    (tmp_path / "list" / course.MADE).write_text("[3]")
    before = state(tmp_path)
    for name in ("file", "full", "list", "none/course"):
        capsys.readouterr()
        assert course.main([str(tmp_path / name), "--force"]) == 2
        out, err = capsys.readouterr()
        assert out == "" and err.startswith("course: ") and err.count("\n") == 1 and name in err
    assert course.main([str(ROOT), "--force"]) == 2 and state(tmp_path) == before
    (tmp_path / "notebooks").mkdir()
    notebook(tmp_path / "notebooks" / "a.ipynb", list(RIGHT.values()))
    monkeypatch.setattr(course, "ROOT", tmp_path)
    assert course.main([str(tmp_path / "course")]) == 2
    assert "a.ipynb has an answer in it" in capsys.readouterr().err


@pytest.mark.long
def test_all_solutions_are_graded_right_and_empty_notebooks_are_blank(made):
    for path in sorted((made / "teacher" / "solutions").glob("*.ipynb")):
        row, text = grade.grade(path), path.read_text("utf-8").replace("\\", "")
        assert (row.word, row.grades) == ("ok", dict.fromkeys(grade.NAME.findall(text), 1))
        row = grade.grade(made / "handout" / "notebooks" / path.name)
        assert row == (path.name, {}, "ok")
