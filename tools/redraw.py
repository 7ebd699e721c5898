"""Run the notebooks from first to last cell, store their outputs, and redraw every figure.

    python tools/redraw.py              all notebooks
    python tools/redraw.py 3_1 4        those whose names start so

A notebook is stored only when it ran to its end and shows something else than before; what
differs by the last digits of this machine is kept (see outputs.py), and so are figures (see
`inetlib.publish`).  The table at the end shows, for each figure, the largest deviation of theta
and theta0 over all its faces, and whether it was kept.
"""

import contextlib
import os
import signal
import subprocess
import sys

from inetlib import start

if __name__ == "__main__":  # before anything large is loaded
    start.watch("redraw", "; a notebook that had not ended is as it was")

import argparse
import copy
import tempfile
import time
from concurrent.futures import ThreadPoolExecutor, wait
from pathlib import Path

import nbformat
import outputs
from nbclient import NotebookClient
from nbclient.exceptions import CellExecutionError, DeadKernelError
from tqdm import tqdm

from inetlib import files, publish

ROOT = Path(__file__).resolve().parent.parent
RUNNING = []  # the client whose kernel must not outlive this process


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
    start.at_stop(end_kernel)
    sweep()
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

    def begin(cell, cell_index):
        started[cell_index] = time.perf_counter()

    def end(cell, cell_index, execute_reply):
        for tag in outputs.tags(cell):
            if tag.startswith(("fig", "table", "beyond")):
                seconds[tag] = time.perf_counter() - started[cell_index]
        bar.update()

    client = NotebookClient(
        notebook,
        timeout=600,
        kernel_name="python3",
        record_timing=False,
        coalesce_streams=True,  # else prints may be split in two, or not, from run to run
        extra_arguments=["--log-level=40"],
        resources={"metadata": {"path": str(folder)}},
        on_cell_execute=begin,
        on_cell_executed=end,
    )
    RUNNING[:] = [client]
    with files.scratch(tempfile.gettempdir()) as empty, ThreadPoolExecutor(1) as worker:
        # nbclient takes over Ctrl-C in the main thread, and loses it: so it works in another
        done = worker.submit(client.execute, env=outputs.environment(empty))
        while not done.done():
            wait([done], timeout=1)  # on Windows Ctrl-C waits for this
    done.result()
    RUNNING.clear()
    for cell, old in zip(notebook.cells, stored, strict=True):
        if cell.cell_type == "code":
            keep(cell, old)
    return seconds


def end_kernel():
    """Kill the kernel that runs, and what it has started: it leads a session of its own.

    One that is just being started ends by itself, within a second of this process.
    """
    for client in RUNNING:
        process = getattr(getattr(client.km, "provisioner", None), "process", None)
        with contextlib.suppress(OSError):
            if process is not None and os.name == "posix":
                os.killpg(process.pid, signal.SIGKILL)
            elif process is not None:
                process.kill()
        with contextlib.suppress(subprocess.TimeoutExpired):
            if process is not None:
                process.wait(2)
        if client.km is not None:
            client.km.cleanup_connection_file()
    sweep()


def sweep():
    """Remove what killed processes have left."""
    for folder in ("notebooks", "figures"):
        files.sweep(ROOT / folder)


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
    with files.replacing(path) as name:
        name.write_text(text, encoding="utf-8", newline="\n")


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
    code = main()
    signal.signal(signal.SIGINT, signal.SIG_IGN)  # all is done, Python only cleans up
    sys.exit(code)
