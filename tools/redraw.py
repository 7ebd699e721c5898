"""Run the notebooks from first to last cell, store their outputs, and redraw every figure.

    python tools/redraw.py              all notebooks
    python tools/redraw.py 3_1 4        those whose names start so

A notebook is stored only when it ran to its end and something changed; seconds that cells
tagged `timing` print stay those of the first run, or every run would change it.  The table at
the end shows, for each figure, the largest deviation of theta and theta0 over all its faces.
"""

import sys

from inetlib.start import ENDS, finished, held, listen

if __name__ == "__main__":  # before the slow imports
    words = "redraw: stopped, notebooks that were not finished are as they were"
    listen(lambda: words, fresh=True)

import argparse
import os
import signal
import tempfile
import time
from contextlib import contextmanager, suppress
from functools import partial
from pathlib import Path

import matplotlib
import nbformat
from jupyter_client import AsyncKernelManager
from jupyter_client.kernelspec import KernelSpecManager
from nbclient import NotebookClient
from nbclient.exceptions import CellExecutionError, DeadKernelError
from tqdm import tqdm

from inetlib import files, publish, view

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
    seconds = {}
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
    print(table(seconds))
    return 0


def chosen(names):
    """The notebooks whose names start with one of `names`, or all, in order."""
    paths = sorted((ROOT / "notebooks").glob("*.ipynb"))
    return [path for path in paths if not names or path.stem.startswith(tuple(names))]


def run(notebook, folder, bar):
    """Execute in place; return the seconds of each cell that carries a figure's tag."""
    seconds, started = {}, {}
    cells = enumerate(notebook.cells)
    stored = {k: cell.outputs for k, cell in cells if {"view", "timing"} & set(tags(cell))}

    def start(cell, cell_index):
        started[cell_index] = time.perf_counter()

    def done(cell, cell_index, execute_reply):
        for tag in tags(cell):
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
    for k, outputs in stored.items():
        keep_or_renew(notebook.cells[k], outputs)
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


def environment(folder):
    """What a kernel needs to draw alike for everybody; folder: an empty one, for its settings."""
    own = os.environ | {
        "IPYTHONDIR": str(folder),
        "MATPLOTLIBRC": matplotlib.get_data_path(),
        "MPLBACKEND": "module://matplotlib_inline.backend_inline",
    }
    for name in ("PYTHONSTARTUP", "JPY_SESSION_NAME"):  # the latter says that a person looks on
        own.pop(name, None)
    return own


def end(process):
    """Kill a kernel, if it lives, with what it started; remove what it leaves half written."""
    with suppress(OSError):
        if os.name == "nt":
            process.kill()
            process.wait(2)
        else:
            os.killpg(process.pid, signal.SIGKILL)  # jupyter_client made it a group of its own
            os.waitpid(process.pid, 0)  # until then its number counts as alive
    tidy()


def tidy():
    """Remove what a killed run has left half written."""
    for folder in ("notebooks", "figures", "figures/data"):
        files.sweep(ROOT / folder)


def keep_or_renew(cell, stored):
    """Keep stored seconds, and pictures that this machine cannot draw; drop GL's warnings."""
    if "timing" in tags(cell):
        cell.outputs = stored or cell.outputs
    elif view.available()[0]:
        cell.outputs = [o for o in cell.outputs if o.get("name") != "stderr"]
    else:
        cell.outputs = stored


def tags(cell):
    """The tags of a cell, none for most."""
    return cell.metadata.get("tags", [])


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
        new.write_text(text, encoding="utf-8")


def table(seconds):
    """One line a figure that was drawn: deviations in degrees, seconds."""
    rows = [f"{'figure':16} {'max |dtheta| deg':>18} {'max |dtheta0| deg':>18} {'seconds':>9}"]
    for name, entry in publish.read_manifest(ROOT / "figures").items():
        if name in seconds:
            off = [entry["max_deviation_theta_deg"], entry["max_deviation_theta0_deg"]]
            cells = ["-" if x is None else f"{x:.9f}" for x in off]
            rows.append(f"{name:16} {cells[0]:>18} {cells[1]:>18} {seconds[name]:9.2f}")
    rows.append("over all faces that claim the angles; nets sampled from curves: see manifest.json")
    return "\n".join(rows)


if __name__ == "__main__":
    code = main()
    finished()
    sys.exit(code)
