"""The pages of the figures: picture, code, parameters, numbers, and their nets as files."""

import importlib
import inspect
import shutil
from pathlib import Path

import matplotlib.pyplot as plt
import numpy as np
import pages

from inetlib import io, publish

ROOT = pages.ROOT


def write(folder: Path):
    """The gallery of figures and a page for each."""
    folder.mkdir()
    manifest = publish.read_manifest(ROOT / "figures")
    manifest = dict(sorted(manifest.items(), key=lambda x: not x[0].startswith("fig")))
    index = [
        "# Figures",
        "",
        "All figures, as they are drawn here; each page has the picture as",
        "SVG and PNG, the Python that draws it, its numbers and its nets.",
        "",
    ]
    for name, entry in manifest.items():
        for suffix in ("svg", "png"):
            shutil.copyfile(ROOT / "figures" / f"{name}.{suffix}", folder / f"{name}.{suffix}")
        module = importlib.import_module(f"inetlib.drawings.{name}")
        heading = (module.__doc__ or name).strip().splitlines()[0].rstrip(".")
        nets = _nets(module, folder / "nets")
        _page(folder / f"{name}.md", heading, name, entry, module, nets)
        index += [f"[![{heading}]({name}.png)]({name}.md)", "", f"[{heading}]({name}.md)", ""]
    index += ["```{toctree}", ":hidden:", "", *manifest, "```"]
    (folder / "index.md").write_text("\n".join(index) + "\n", encoding="utf-8")


def _nets(module, folder):
    """Write the nets of a figure as OBJ files: their names.

    A drawing names its vertices; those without faces of their own have those of the net with as
    many vertices."""
    folder.mkdir(exist_ok=True)
    drawing = module.draw()
    plt.close(drawing.figure)
    faces = {len(V): Q for V, Q, *_ in drawing.nets}
    named = {
        key: V
        for key, V in drawing.data.items()
        if np.shape(V)[1:] in ((2,), (3,)) or np.iscomplexobj(V)
    }
    nets = {key: (_spatial(V), faces.get(len(V))) for key, V in named.items()}
    nets = {key: (V, Q) for key, (V, Q) in nets.items() if Q is not None}
    if not nets:
        nets = {str(k + 1): (_spatial(V), Q) for k, (V, Q, *_) in enumerate(drawing.nets)}
    written = []
    for key, (V, Q) in nets.items():
        file = f"{drawing.name}_{key}.obj".replace("'", "_image")
        io.write(folder / file, np.round(V, publish.DIGITS), Q)
        written.append((key, file, len(Q)))
    return written


def _spatial(V):
    """Points of the plane, complex or not, as points of space."""
    V = np.asarray(V)
    V = np.stack([V.real, V.imag], axis=-1).reshape(-1, 2) if np.iscomplexobj(V) else V
    return np.pad(V, ((0, 0), (0, 3 - V.shape[1])))


def _page(path, heading, name, entry, module, nets):
    """The page of one figure."""
    lines = [f"# {heading}", "", "{.figure}", f"![{heading}]({name}.svg)", ""]
    files = (f"{{download}}`{x.upper()} <{name}.{x}>`" for x in ("svg", "png"))
    lines += [" \u00b7 ".join(files), ""]
    lines += [pages.scene(x, name) + "\n" for x in pages.SCENES.get(name, [])]
    item = f"Fig. {int(name[3:])}" if name.startswith("fig") else None
    if item:
        lines += [
            f"What it shows, where it is explained and tested: [{item}]({pages.address(item, 1)}).",
            "",
        ]
    lines += ["## Parameters and numbers", "", "| | |", "|---|---|"]
    lines += [f"| `{key}` | {_shown(value)} |" for key, value in entry["parameters"].items()]
    for key in ("max_deviation_theta_deg", "max_deviation_theta0_deg"):
        if entry[key] is not None:
            lines.append(f"| {key.replace('_', ' ')} | {entry[key]:.9f} |")
    lines += [
        f"| {key.replace('_', ' ')} | {_shown(value)} |" for key, value in entry["claims"].items()
    ]
    if nets:
        lines += ["", "## Nets", "", "With 7 decimals, as OBJ:", ""]
        lines += [
            f"* {{download}}`{key} <nets/{file}>`, {count} quads" for key, file, count in nets
        ]
    lines += ["", "## The Python that draws it", "", f"`{entry['function']}`, all of its file:", ""]
    lines += ["```python", inspect.getsource(module).rstrip(), "```"]
    path.write_text("\n".join(lines) + "\n", encoding="utf-8")


def _shown(value):
    """A number, text or list for a table."""
    if isinstance(value, list):
        return ", ".join(map(_shown, value))
    return f"{value:.6g}" if isinstance(value, float) else str(value)
