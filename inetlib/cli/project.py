"""Commands for the course and for the project itself."""

import contextlib
import functools
import importlib
import json
import sys
from pathlib import Path

from .. import files
from . import options

ROOT = Path(__file__).resolve().parent.parent.parent


def _figures_options(command):
    text = "beginnings of notebook names, or figures; none: all"
    command.add_argument("names", nargs="*", help=text)
    text = "the clone whose notebooks/ and figures/ are changed (the current folder, if it is one)"
    command.add_argument("--folder", default=".", metavar="FOLDER", help=text)
    options.say(command)


def _figures(given):
    target = Path(given.folder).resolve()
    runner, folder = target / "tools" / "redraw.py", target / "notebooks"
    if not (runner.is_file() and folder.is_dir()):
        what = "no clone of the project (one has tools/redraw.py and notebooks/)"
        raise ValueError(f"figures: {target} is {what}, name one with --folder")
    if target != ROOT:
        raise ValueError(
            f"figures: this inet is of {ROOT}, use the inet of {target} (in its .venv)"
        )
    names = [stem for name in given.names for stem in notebooks(folder, name)]
    names = list(dict.fromkeys(names))
    quiet = given.quiet or given.json
    if not quiet:
        print(f"redraws {', '.join(names) or 'all notebooks'} in {target}", flush=True)
    sys.path.insert(0, str(runner.parent))
    redraw = importlib.import_module("redraw")
    if not options.progress(given):
        redraw.tqdm = functools.partial(redraw.tqdm, disable=True)
    before = redraw.stamps()
    with contextlib.redirect_stdout(None if quiet else sys.stdout):
        code = redraw.main(names)
    if given.json and not code:
        written = [name for name, stamp in redraw.stamps().items() if before.get(name) != stamp]
        known = {"folder": str(target), "notebooks": names, "written": written}
        print(json.dumps(known, indent=2))
    return code


def notebooks(folder: Path, name: str) -> list[str]:
    """The notebooks whose names begin so, or that draw the figure of this name (their tags)."""
    found = []
    for path in sorted(folder.glob("*.ipynb")):
        cells = json.loads(path.read_text(encoding="utf-8"))["cells"]
        tags = {tag for cell in cells for tag in cell["metadata"].get("tags", [])}
        if path.stem.startswith(name) or name in tags:
            found.append(path.stem)
    if not found:
        known = ", ".join(path.stem for path in sorted(folder.glob("*.ipynb")))
        raise ValueError(f"figures: no notebook begins with {name!r}, and none draws it: {known}")
    return found


def _course_options(command):
    add = command.add_argument
    add("task", choices=("grade",), metavar="grade", help="grade what is in a folder")
    text = """of the notebooks, *.ipynb; copies of them are run, with limits and in a temporary
        folder, but with your rights: this is no sandbox against malice"""
    add("folder", help=text)
    text = "the table, a row a notebook: 1 right, 0 wrong, nothing where no answer is (%(default)s)"
    add("-o", "--output", default="grades.csv", metavar="FILE", help=text)
    add("--force", action="store_true", help="replace the file if it is there")
    text = "for each notebook, at most (%(default)g)"
    add("--seconds", type=options.positive, default=30.0, metavar="S", help=text)
    options.say(command)


def _course(given):
    output = Path(given.output)
    if output.suffix.lower() != ".csv":
        raise ValueError(f"{output}: a table is written, its name ends with .csv")
    files.check_place(output, given.force)
    from ..exercises import grade, names

    paths = grade.notebooks(given.folder)
    bar = {"unit": "notebook", "disable": not options.progress(given)}
    from tqdm import tqdm

    rows = [grade.grade(path, given.seconds) for path in tqdm(paths, **bar)]
    grade.write(output, rows, names())
    told = [row._asdict() | {"right": row.right} for row in rows]
    known = {"file": str(output), "notebooks": told}
    options.put(given, known, lambda: f"{output}\n{grade.summary(rows)}")


COMMANDS = {
    "course": (_course, _course_options),
    "figures": (_figures, _figures_options),
}
