"""Run the notebooks from first to last cell, store their outputs, and redraw every figure.

    python tools/redraw.py              all notebooks
    python tools/redraw.py 3_1 4        those whose names start so

A notebook is stored only when it ran to its end and shows something else than before; what
differs by the last digits of this machine is kept (see outputs.py), and so are figures (see
`inetlib.publish`).  The table at the end shows, for each figure, the largest deviation of theta
and theta0 over all its faces, and whether it was kept.
"""

import argparse
import copy
import os
import sys
import tempfile
import time
from pathlib import Path

import nbformat
import outputs
from nbclient import NotebookClient
from nbclient.exceptions import CellExecutionError, DeadKernelError
from tqdm import tqdm

from inetlib import publish

ROOT = Path(__file__).resolve().parent.parent


def main(arguments=None):
    """Exit code 0 when every notebook ran to its end."""
    parser = argparse.ArgumentParser(description="Run the notebooks and redraw the figures.")
    parser.add_argument("names", nargs="*", help="beginnings of notebook names; none: all")
    paths = chosen(parser.parse_args(arguments).names)
    if not paths:
        print("redraw: no notebook of that name in notebooks/", file=sys.stderr)
        return 2
    notebooks = {}
    for path in paths:
        try:
            notebooks[path] = nbformat.read(path, as_version=4)
        except ValueError:
            print(f"redraw: {path} is not a notebook: restore it with git", file=sys.stderr)
            return 2
    total = sum(cell.cell_type == "code" for nb in notebooks.values() for cell in nb.cells)
    seconds, before = {}, stamps()
    with tqdm(total=total, unit="cell") as bar:
        for path, notebook in notebooks.items():
            bar.set_description(path.stem)
            try:
                seconds |= run(notebook, path.parent, bar)
            except (CellExecutionError, DeadKernelError) as error:
                bar.close()
                print(
                    f"{error}\nredraw: {path.name} stopped; it was left as it was", file=sys.stderr
                )
                return 1
            store(notebook, path)
    print(table(seconds, before))
    return 0


def chosen(names):
    """The notebooks whose names start with one of `names`, or all, in order."""
    paths = sorted((ROOT / "notebooks").glob("*.ipynb"))
    return [path for path in paths if not names or path.stem.startswith(tuple(names))]


def run(notebook, folder, bar):
    """Execute in place; return the seconds of each cell that carries a figure's tag."""
    seconds, started = {}, {}
    stored = copy.deepcopy(notebook.cells)

    def start(cell, cell_index):
        started[cell_index] = time.perf_counter()

    def done(cell, cell_index, execute_reply):
        for tag in outputs.tags(cell):
            if tag.startswith(("fig", "table", "beyond")):
                seconds[tag] = time.perf_counter() - started[cell_index]
        bar.update()

    NotebookClient(
        notebook,
        timeout=600,
        kernel_name="python3",
        record_timing=False,
        coalesce_streams=True,  # else prints may be split in two, or not, from run to run
        extra_arguments=["--log-level=40"],
        resources={"metadata": {"path": str(folder)}},
        on_cell_execute=start,
        on_cell_executed=done,
    ).execute()
    for cell, old in zip(notebook.cells, stored, strict=True):
        if cell.cell_type == "code":
            keep(cell, old)
    return seconds


def keep(cell, stored):
    """Keep what is stored below the cell where the fresh outputs show the same."""
    if outputs.kept(stored, cell):
        cell.outputs = stored.outputs
    elif "view" in outputs.tags(cell):  # without OpenGL's warnings
        cell.outputs = [o for o in cell.outputs if o.get("name") != "stderr"]


def store(notebook, path):
    """Write the notebook back, without anything that depends on the machine, if it changed."""
    notebook.metadata = {
        "kernelspec": {"display_name": "Python 3", "language": "python", "name": "python3"},
        "language_info": {"name": "python"},
    }
    text = nbformat.writes(notebook) + "\n"
    if text == path.read_text(encoding="utf-8"):
        return
    handle, temporary = tempfile.mkstemp(dir=path.parent, prefix=".new-")
    with os.fdopen(handle, "w", encoding="utf-8") as file:
        file.write(text)
    os.chmod(temporary, 0o644)
    os.replace(temporary, path)


def stamps():
    """When each figure was last written: {name: time}."""
    return {path.stem: path.stat().st_mtime_ns for path in (ROOT / "figures").glob("*.svg")}


def table(seconds, before):
    """One line a figure that was drawn: deviations in degrees, seconds, whether it was kept."""
    head = f"{'figure':16} {'max |dtheta| deg':>18} {'max |dtheta0| deg':>18} {'seconds':>9}"
    rows, after = [head], stamps()
    for name, entry in publish.read_manifest(ROOT / "figures").items():
        if name in seconds:
            off = [entry["max_deviation_theta_deg"], entry["max_deviation_theta0_deg"]]
            cells = ["-" if x is None else f"{x:.9f}" for x in off]
            fate = "kept" if before.get(name) == after[name] else "written"
            rows.append(f"{name:16} {cells[0]:>18} {cells[1]:>18} {seconds[name]:9.2f}  {fate}")
    rows.append("over all faces that claim the angles; nets sampled from curves: see manifest.json")
    rows.append("kept: on file is the same figure, but for rounding")
    return "\n".join(rows)


if __name__ == "__main__":
    sys.exit(main())
