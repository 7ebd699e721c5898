"""Grading many notebooks: each runs in a process of its own, with limits, and gives a row.

What runs is a copy of the cells, in a temporary folder that is also its HOME, with no input, none
of our environment and limits of time, memory and the size of files.  That holds off accidents:
endless loops, crashes, cells that delete what lies around.  It is no sandbox against malice, since
the process has the rights of whoever grades: notebooks of strangers belong into a container.

Of a notebook run, in order: the cells from the first that calls `check` on, and of those above
only what they need, found by the names that a cell uses and binds.  A cell that fails stops none.

`python -m inetlib.exercises.grade CELLS` is that process."""

import ast
import csv
import json
import os
import re
import subprocess
import symtable
import sys
import tempfile
from collections import Counter
from collections.abc import Iterable
from contextlib import suppress
from pathlib import Path
from typing import NamedTuple

from .. import files
from ..ending import started

CHECK = re.compile(r"""\bcheck\((?!\s*["']tour)""")  # the tour is no exercise
NAME = re.compile(CHECK.pattern + r"""\s*["']([\w.]+)["']""")
MEMORY, LARGEST = 2 << 30, 100 << 20  # bytes: of a process, and of a file that it writes
KEPT = "PATH", "LANG", "LC_ALL", "LD_LIBRARY_PATH", "SYSTEMROOT", "COMSPEC", "PATHEXT"
OK, ENDED, NONE = "ok", "ended by itself", "no exercise in it"
UNREADABLE, OTHER = "cannot be read", "not a notebook"


class Row(NamedTuple):
    """The grades of a notebook: {name: 1 or 0}, without those that have no answer, and a word."""

    file: str
    grades: dict[str, int]
    word: str

    @property
    def right(self) -> int:
        """How many answers are right."""
        return sum(self.grades.values())


def notebooks(folder: str | Path) -> list[Path]:
    """The *.ipynb in a folder, not below it, by name; ValueError where there are none."""
    folder = Path(folder)
    if not folder.is_dir():
        raise ValueError(f"{folder}: there is no such folder")
    paths = sorted(p for p in folder.iterdir() if p.suffix.lower() == ".ipynb" and p.is_file())
    if not paths:
        raise ValueError(f"{folder}: no notebook (*.ipynb) is in this folder")
    return paths


def grade(path: str | Path, seconds: float = 30.0) -> Row:
    """Run what a notebook answers, for so many seconds at most, and see what is right."""
    path = Path(path)
    try:
        cells = _sources(json.loads(path.read_bytes()))
    except OSError:
        return Row(path.name, {}, UNREADABLE)
    except (ValueError, KeyError, TypeError, AttributeError, RecursionError):
        return Row(path.name, {}, OTHER)
    cells = needed(cells)
    if not cells:
        return Row(path.name, {}, NONE)
    with files.scratch(tempfile.gettempdir()) as own, tempfile.TemporaryFile("w+b") as records:
        (own / "cells.json").write_text(json.dumps(cells), encoding="utf-8")
        word = _run(own, records, seconds)
        records.seek(0)
        said = [*map(_record, records)]
    grades = {}
    for record in said:
        for name, right in record.items():
            grades[name] = max(right, grades.get(name, 0))
    ended = grades.pop("", None)
    return Row(path.name, grades, word or (ENDED if ended is None else OK))


def write(path: Path, rows: Iterable[Row], names: Iterable[str]) -> None:
    """A CSV file with a row a notebook: file, each exercise (1, 0 or nothing), right, result."""
    names = list(names)
    with (
        files.replacing(path) as new,
        open(new, "w", encoding="utf-8", errors="backslashreplace", newline="") as file,
    ):
        table = csv.writer(file, lineterminator="\n")
        table.writerow(["file", *names, "right", "result"])
        for row in rows:
            grades = [row.grades.get(name, "") for name in names]
            table.writerow([row.file, *grades, row.right, row.word])


def summary(rows: list[Row]) -> str:
    """How many notebooks there are, what became of them, and who did not come to the end."""
    counts = ", ".join(f"{n} {word}" for word, n in Counter(row.word for row in rows).items())
    lines = [f"{len(rows)} notebook{'s' * (len(rows) > 1)}: {counts}"]
    lines += [f"{row.file}: {row.word}, {row.right} right" for row in rows if row.word != OK]
    return "\n".join(lines)


def needed(cells: list[str]) -> list[str]:
    """The cells from the first that calls `check` on, after what they need of those above."""
    first = next((k for k, source in enumerate(cells) if CHECK.search(source)), len(cells))
    open_names, chosen = set(), cells[first:]
    for source in reversed(chosen):
        binds, uses = _names(source)
        open_names = (open_names - binds) | uses
    for source in reversed(cells[:first]):
        binds, uses = _names(source)
        if binds & open_names or "import *" in source:
            open_names = (open_names - binds) | uses
            chosen.insert(0, source)
    return chosen


def _names(source):
    """The names that a cell binds, and those that it needs; none where it is not plain Python."""
    lines = source.splitlines()
    plain = "\n".join("" if re.match(r"\s*[%!?]", line) else line for line in lines)
    binds, needs = set(), set()
    with suppress(SyntaxError, ValueError, RecursionError):
        for statement in reversed(ast.parse(plain).body):
            table = symtable.symtable(ast.unparse(statement), "cell", "exec")
            mine = {x.get_name() for x in table.get_symbols() if x.is_assigned() or x.is_imported()}
            uses = {x.get_name() for x in table.get_symbols() if x.is_referenced()}
            tables = list(table.get_children())  # what functions use when they are called
            while tables:
                tables += tables[0].get_children()
                uses |= {x.get_name() for x in tables.pop(0).get_symbols() if x.is_global()}
            if isinstance(statement, ast.AugAssign):
                uses |= mine
            elif not isinstance(statement, ast.Assign):  # loops use what they have bound
                uses -= mine
            binds, needs = binds | mine, (needs - mine) | uses
    return binds, needs


def _sources(notebook):
    """The text of the code cells; an error of some kind if it is not a notebook."""
    if notebook["nbformat"] < 4:
        raise ValueError("an old notebook")
    return ["".join(c["source"]) for c in notebook["cells"] if c["cell_type"] == "code"]


def _run(own, records, seconds):
    """Run the cells in `own`: a word if that came to no end."""
    home = own / "home"
    home.mkdir()
    folders = "HOME", "USERPROFILE", "APPDATA", "TMPDIR", "TEMP", "TMP"
    environment = {name: os.environ[name] for name in KEPT if name in os.environ}
    environment |= dict.fromkeys(folders, str(home)) | {
        "PYTHONPATH": os.pathsep.join(map(os.path.abspath, filter(None, sys.path))),
        "IPYTHONDIR": str(own / "settings"),
        "MPLBACKEND": "Agg",
        "OPENBLAS_NUM_THREADS": "1",  # each thread wants memory
        "PYTHONDONTWRITEBYTECODE": "1",
    }
    ways = {"cwd": home, "env": environment, "stdin": subprocess.DEVNULL, "stdout": records}
    command = [sys.executable, "-m", __name__, str(own / "cells.json")]
    with started(command, stderr=subprocess.DEVNULL, **ways) as process:
        try:
            process.wait(seconds)
        except subprocess.TimeoutExpired:
            return f"took longer than {seconds:g} s"
    return ""


def _record(line):
    """What a line of the records says: {name: 1 or 0}; nothing if it is not one of ours."""
    with suppress(ValueError, RecursionError):
        found = json.loads(line)
        if isinstance(found, dict) and all(type(x) is int and x in (0, 1) for x in found.values()):
            return found
    return {}


def _limit():
    """Limits of this process, where the system has them."""
    with suppress(ImportError):
        import resource

        for kind, most in (("AS", MEMORY), ("FSIZE", LARGEST), ("CORE", 0)):
            with suppress(AttributeError, ValueError, OSError):
                resource.setrlimit(getattr(resource, f"RLIMIT_{kind}"), (most, most))


def _answer(path):
    """Run the cells, and say on what was our stdout what came out; never returns."""
    records = os.dup(1)
    os.dup2(os.open(os.devnull, os.O_WRONLY), 1)  # prints go nowhere
    _limit()

    def say(name, right):
        os.write(records, f"{json.dumps({name: int(right)})}\n".encode())

    from IPython.core.interactiveshell import InteractiveShell
    from traitlets.config import Config

    from inetlib import exercises

    known, check = set(exercises.names()), exercises.check  # all are loaded now

    def checked(name, answer=None):
        found = check(name, answer)
        if answer is not None and name in known:
            say(name, found.right)
        return found

    exercises.check = checked
    shell = InteractiveShell.instance(config=Config(HistoryManager={"enabled": False}))
    shell.showtraceback = shell.showsyntaxtraceback = lambda *a, **also: None
    for source in json.loads(Path(path).read_text(encoding="utf-8")):
        failed = True
        with suppress(BaseException):
            failed = not shell.run_cell(source).success
        for name in known.intersection(NAME.findall(source) if failed else ()):
            say(name, False)
    say("", True)
    os._exit(0)  # threads that an answer has left do not keep us


if __name__ == "__main__":
    _answer(sys.argv[1])
