"""Run the notebooks from first to last cell, store their outputs, and redraw every figure.

    python tools/redraw.py              all notebooks, those of solutions, too
    python tools/redraw.py 3_1 4        those whose names start so

A notebook is stored only when it ran to its end and shows something else than before; what
differs by the last digits of this machine is kept (see outputs.py), and so are figures (see
`inetlib.publish`).  The table at the end shows, for each figure, the largest deviation of theta
and theta0 over all faces, of its exact nets and of all that it draws, and whether it was kept."""

import sys

from inetlib.ending import ENDS, held, kill
from inetlib.start import finished, listen

if __name__ == "__main__":  # before the slow imports
    words = "redraw: stopped, notebooks that were not finished are as they were"
    listen(lambda: words, fresh=True)

import argparse
import copy
import tempfile
import time
from contextlib import contextmanager
from functools import partial
from pathlib import Path

import nbformat
import outputs
from jupyter_client import AsyncKernelManager
from jupyter_client.kernelspec import KernelSpecManager
from nbclient import NotebookClient
from nbclient.exceptions import CellExecutionError, DeadKernelError
from tqdm import tqdm

from inetlib import files, publish

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
    tidy()
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
    """The notebooks whose names start with one of `names`, or all, in order; then solutions."""
    folders = ROOT / "notebooks", ROOT / "solutions"
    paths = [path for folder in folders for path in sorted(folder.glob("*.ipynb"))]
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

    client = NotebookClient(
        notebook,
        timeout=600,
        record_timing=False,
        coalesce_streams=True,  # else prints may be split in two, or not, from run to run
        extra_arguments=["--log-level=40"],
        on_cell_execute=start,
        on_cell_executed=done,
    )
    with kernel(client, folder):
        for k, cell in enumerate(notebook.cells):  # `execute` would take our signal handlers away
            client.execute_cell(cell, k, execution_count=client.code_cells_executed + 1)
    below = [cell.source for cell in notebook.cells[1:]] + [""]
    for cell, old, words in zip(notebook.cells, stored, below, strict=True):
        if cell.cell_type == "code":
            keep(cell, old)
            outputs.describe(cell, words)
    return seconds


@contextmanager
def kernel(client, folder):
    """A kernel for the client, in this folder, that ends with the block or with this process."""
    with files.scratch(tempfile.gettempdir()) as own:
        client.km = AsyncKernelManager(
            connection_file=str(own / "connection.json"),
            kernel_spec_manager=KernelSpecManager(kernel_dirs=[]),  # the one of this environment
        )
        try:
            with held():
                client.start_new_kernel(cwd=str(folder), env=environment(own))
                ENDS.append(partial(end, client.km.provisioner.process))
            with client.setup_kernel(cleanup_kc=True):
                yield
        finally:
            while ENDS:
                ENDS.pop()()


def environment(own):
    """That of a kernel whose drawings go into figures/; own: see `outputs.environment`."""
    return outputs.environment(own) | {publish.FOLDER: str(ROOT / "figures")}


def end(process):
    """Kill a kernel, if it lives, with what it started; remove what it leaves half written."""
    kill(process)  # jupyter_client made it a group of its own
    tidy()


def tidy():
    """Remove what a killed run has left half written."""
    for folder in ("notebooks", "solutions", "figures", "figures/data"):
        files.sweep(ROOT / folder)


def keep(cell, stored):
    """Keep what is stored below the cell where the fresh outputs show the same."""
    if outputs.kept(stored, cell):
        for old, new in zip(stored.outputs, cell.outputs, strict=False):
            if old.get("data", {}).keys() == new.get("data", {}).keys() != set():
                old.metadata = new.metadata  # alternative texts
        cell.outputs = stored.outputs
        return
    if "view" in outputs.tags(cell):  # without OpenGL's warnings
        cell.outputs = [o for o in cell.outputs if o.get("name") != "stderr"]
    for output in cell.outputs:
        if picture := output.get("data", {}).get("image/png"):
            output.data["image/png"] = outputs.few_tones(picture)


def store(notebook, path):
    """Write the notebook back, without anything that depends on the machine, if it changed."""
    notebook.metadata = {
        "kernelspec": {"display_name": "Python 3", "language": "python", "name": "python3"},
        "language_info": {"name": "python"},
    }
    text = nbformat.writes(notebook) + "\n"
    if text == path.read_text(encoding="utf-8"):
        return
    with files.replacing(path) as new:
        new.write_text(text, encoding="utf-8", newline="\n")


def stamps():
    """When each figure was last written: {name: time}."""
    return {path.stem: path.stat().st_mtime_ns for path in (ROOT / "figures").glob("*.svg")}


def table(seconds, before):
    """One line a figure that was drawn: deviations in degrees, seconds, whether it was kept."""
    rows, after = [f"{'figure':16} {'exact nets':>14} {'as drawn':>14} {'seconds':>9}"], stamps()
    for name, entry in publish.read_manifest(ROOT / "figures").items():
        if name in seconds:
            pairs = zip(deviations(entry), (9, 6), strict=True)
            cells = ["-" if x is None else f"{x:.{digits}f}" for x, digits in pairs]
            fate = "kept" if before.get(name) == after[name] else "written"
            rows.append(f"{name:16} {cells[0]:>14} {cells[1]:>14} {seconds[name]:9.2f}  {fate}")
    rows.append(
        "largest deviation of theta and theta0 in degrees, over all faces: of the nets that are"
    )
    rows.append(
        "exact by construction or optimised; of these and of those sampled from a smooth net"
    )
    rows.append("kept: on file is the same figure, but for rounding")
    return "\n".join(rows)


def deviations(entry):
    """(exact, as drawn), degrees or None, of a figure in the manifest; see `table`.

    What is sampled says so by claims NAME_max_deviation_deg."""
    exact = [entry["max_deviation_theta_deg"], entry["max_deviation_theta0_deg"]]
    exact = [x for x in exact if x is not None]
    claims = entry["claims"].items()
    sampled = [x for k, x in claims if k.endswith("_max_deviation_deg")]
    return max(exact, default=None), max(exact + sampled, default=None)


if __name__ == "__main__":
    code = main()
    finished()
    sys.exit(code)
