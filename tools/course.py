"""Write what a course needs: FOLDER/handout for students, FOLDER/teacher with the solutions.

    python tools/course.py                  into course/
    python tools/course.py FOLDER --force   elsewhere; what was changed in it is lost

The notebooks are as they are stored, but nothing stands below an exercise.  A folder that this
has written before, and that nobody changed, is replaced; one with other files in it never is."""

import argparse
import hashlib
import json
import os
import shutil
import sys
from pathlib import Path

from inetlib import files
from inetlib.ending import held
from inetlib.exercises.grade import CHECK
from inetlib.start import finished, listen

ROOT = Path(__file__).resolve().parent.parent
MADE = ".made.json"  # {file: hash} of all that was written
HANDOUT = """\
# Isogonal nets: the notebooks of the course

Start with notebooks/0_start_here.ipynb. They need Python with the package inetlib (with its
own README it is installed in one step). An exercise is a cell that begins with `answer = None`:
put yours in its place and run the cell, it says what is right. Helpers of yours stand in cells
of their own below the first exercise, or in the same cell. Save the notebook to hand it in.
"""
TEACHER = """\
# Isogonal nets: the course, with solutions

What students get, and solutions/, where each answer has its reason. Put the notebooks that were
handed in into one folder: `inet course grade FOLDER` runs their answers and writes grades.csv.
They run with time and memory limits, but with your rights: this is no sandbox against malice.
"""


def main(arguments=None):
    """Exit code 0 when the folders are written; a sentence and 2 when not."""
    parser = argparse.ArgumentParser(description="Write the folders of a course.")
    parser.add_argument("folder", nargs="?", default=str(ROOT / "course"), help="(course/)")
    parser.add_argument("--force", action="store_true", help="replace a course that was changed")
    given = parser.parse_args(arguments)
    try:
        count = write(Path(given.folder), given.force)
    except (OSError, ValueError) as error:
        print("course:", " ".join(str(error).split()), file=sys.stderr)
        return 2
    print(f"{given.folder}: handout/ and teacher/, {count} notebooks each")
    return 0


def write(folder, force=False):
    """Make the folder, whole or not at all: the number of notebooks."""
    folder = Path(os.path.realpath(folder))
    check(folder, force)
    notebooks = {p.name: handed(p) for p in sorted((ROOT / "notebooks").glob("*.ipynb"))}
    with files.scratch(folder.parent) as own:
        new, old = own / "new", own / "old"
        for name, words in (("handout", HANDOUT), ("teacher", TEACHER)):
            (new / name / "notebooks").mkdir(parents=True)
            (new / name / "README.md").write_text(words, encoding="utf-8")
            for other in ("PAPER.md", "ERRATA.md"):  # the notebooks link to them
                shutil.copyfile(ROOT / other, new / name / other)
            for stem, text in notebooks.items():
                (new / name / "notebooks" / stem).write_text(text, encoding="utf-8", newline="\n")
        (new / "teacher" / "solutions").mkdir()
        for path in (ROOT / "solutions").glob("*.ipynb"):
            shutil.copyfile(path, new / "teacher" / "solutions" / path.name)
        (new / MADE).write_text(json.dumps(hashes(new), indent=1), encoding="utf-8")
        with held():  # no signal comes between the two names
            if folder.exists():
                os.rename(folder, old)
            try:
                os.rename(new, folder)
            except OSError:
                if old.exists():
                    os.rename(old, folder)
                raise
    return len(notebooks)


def check(folder, force):
    """ValueError if the folder cannot be made, or has what would be lost."""
    if not folder.parent.is_dir():
        raise ValueError(f"{folder}: there is no folder {folder.parent}: make it first")
    if not os.access(folder.parent, os.W_OK):
        raise ValueError(f"{folder}: no permission to write there")
    if not folder.exists():
        return
    if not folder.is_dir():
        raise ValueError(f"{folder} is a file: the name of a folder is wanted")
    if not any(folder.iterdir()):
        return
    try:
        made = dict(json.loads((folder / MADE).read_text(encoding="utf-8")))
    except (OSError, ValueError, TypeError):
        raise ValueError(f"{folder} has files and is no course: name another folder") from None
    found = hashes(folder)
    other = sorted(name for name in {*made, *found} if made.get(name) != found.get(name))
    if other and not force:
        words = f"{other[0]} was changed, added or removed"
        raise ValueError(f"{folder}: {words} since it was written: --force replaces all of it")


def hashes(folder):
    """{file: SHA-256} of all files below a folder, but for the list of them."""
    found = [p for p in sorted(folder.rglob("*")) if not p.is_dir() and p != folder / MADE]
    return {
        p.relative_to(folder).as_posix(): hashlib.sha256(p.read_bytes()).hexdigest() for p in found
    }


def handed(path):
    """The text of a notebook to hand out; ValueError if an answer is filled in."""
    notebook = json.loads(path.read_text(encoding="utf-8"))
    for cell in notebook["cells"]:
        source = "".join(cell["source"])
        if cell["cell_type"] == "code" and CHECK.search(source):
            if "\nanswer = None  #" not in f"\n{source}":
                raise ValueError(
                    f"{path} has an answer in it ({source[:40]!r} ...): empty it first"
                )
            cell["outputs"], cell["execution_count"] = [], None
    return json.dumps(notebook, indent=1, ensure_ascii=False) + "\n"


if __name__ == "__main__":
    listen(lambda: "course: stopped, nothing was written")
    code = main()
    finished()
    sys.exit(code)
