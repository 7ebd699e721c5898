"""What another machine would compute and draw: run by test_elsewhere.py in fresh processes.

    python tests/elsewhere.py FOLDER [NOISE]

Draws every figure into FOLDER, a copy of figures/, under the settings of this process's
environment, and writes FOLDER/results.npz and FOLDER/rewritten.json.  NOISE: every array is
multiplied by 1 + NOISE * (a random number between -1 and 1) before it is drawn."""

import importlib
import json
import sys
from pathlib import Path

import matplotlib
import matplotlib.lines
import matplotlib.pyplot as plt
import numpy as np
import threadpoolctl

from inetlib import design, examples, mesh, plot, publish, surfaces
from inetlib.drawings import fig13, table1

FIGURES = Path(__file__).resolve().parent.parent / "figures"
SHELL = {"theta": np.radians(60), "theta0": np.radians(60), "count": 300}
SQUARE = {"theta": np.radians(75), "theta0": np.radians(50), "count": 150}


def results():
    """{name: array} of what hangs on ties: cuts of quads, symmetric covers."""
    found = {}
    starts = {"rings": fig13.start()[:2], "patch": surfaces.freeform_patch()}
    for name, (V, Q) in starts.items():
        found[f"triangles of {name}"] = mesh.triangles(V, Q)[1]
    side = np.linspace(-1, 1, 13)
    x, y = np.meshgrid(side, side, indexing="ij")
    flat = np.stack([x, y, 0 * x], axis=-1).reshape(-1, 3)
    square = mesh.triangles(flat, mesh.grid_quads(12, 12))
    for name, surface, wanted in (
        ("shell", examples.hanging_shell(16), SHELL),
        ("square", square, SQUARE),
        ("ring", examples.saddle_with_hole(8), SQUARE),
    ):
        net = design.cover(*surface, **wanted)
        found |= {f"cover of {name}": net.V, f"quads of {name}": net.Q}
    return found


def kernels():
    """The kernels of OpenBLAS in this process, for example ["Prescott"]; [] for another BLAS."""
    info = threadpoolctl.threadpool_info()
    return sorted({x["architecture"] for x in info if x["internal_api"] == "openblas"})


def shaken(size):
    """Let all that is drawn from now on be a little off."""
    rng = np.random.default_rng(0)

    def noisy(x):
        x = np.asarray(x)
        return x * (1 + size * rng.uniform(-1, 1, x.shape)) if x.dtype.kind in "fc" else x

    camera, plane = plot.camera, plot.plane
    plot.camera = lambda *angles: lambda points: camera(*angles)(noisy(points))
    plot.plane = lambda points: plane(noisy(points))
    lines = matplotlib.lines.Line2D.set_data
    matplotlib.lines.Line2D.set_data = lambda line, *xy: lines(line, *map(noisy, xy))
    return noisy


def drawn(names, folder, noise=0.0):
    """The figures of these names that differ from those in a folder, {name: differences}.

    They are written there as `publish.save` does."""
    noisy = shaken(noise) if noise else lambda x: x
    found = {}
    for name in names:
        drawing = importlib.import_module(f"inetlib.drawings.{name}").draw()
        drawing = drawing._replace(data={k: noisy(x) for k, x in drawing.data.items()})
        before = {p: p.read_bytes() for p in folder.rglob(f"{name}.*")}
        publish.save(drawing, folder)
        if {p: p.read_bytes() for p in folder.rglob(f"{name}.*")} != before:
            found[name] = publish.differences(name, folder, FIGURES)
        plt.close("all")
    return found


def main(folder, noise=0.0):
    """Everything, into a folder."""
    matplotlib.use("Agg")
    folder, rewritten = Path(folder), {}
    np.savez(folder / "results.npz", **results())
    tables = [folder / "table1.csv", folder / "table1.md"]
    before = [table.read_bytes() for table in tables]
    table1.save(table1.rows({name: table1.results(name) for name in table1.VARIANTS}), folder)
    if before != [table.read_bytes() for table in tables]:
        rewritten["table1"] = tables[0].read_text()
    rewritten |= drawn(sorted(publish.read_manifest(FIGURES)), folder, float(noise))
    (folder / "rewritten.json").write_text(json.dumps([kernels(), rewritten]))


if __name__ == "__main__":
    main(*sys.argv[1:])
