"""Showing a figure, and writing it: SVG, PNG, the data drawn, its entry in the manifest."""

import hashlib
import io
import json
import os
import zipfile
from pathlib import Path

import matplotlib.pyplot as plt
import numpy as np

from . import files
from .drawings import Drawing, deviations, rounded, same

# dots per inch of pictures inside an SVG, their part of its bytes: the first with which it is small
INSIDE = (128, 0.3), (96, 0.18)
DIGITS = 7  # decimals of the data that are stored
FOLDER = "INETLIB_FIGURES"  # the variable that says where shown drawings are written, see `asked`


def save(drawing: Drawing, folder) -> dict:
    """Write the figure into a folder, unless what is there shows the same; its manifest entry.

    folder/NAME.svg, NAME.png, data/NAME.npz and the entry in manifest.json go together: where one
    differs by more than the tolerances of `same`, all are replaced.  When anything fails the old
    files stay.  `folder` is made when only its last part is missing."""
    folder = Path(folder)
    folder.mkdir(exist_ok=True)
    with files.scratch(folder) as fresh:
        _draw(drawing, fresh, read_manifest(folder))
        if differences(drawing.name, fresh, folder):
            (folder / "data").mkdir(exist_ok=True)
            for file in (*_names(drawing.name), "manifest.json"):  # it vouches for the others
                os.replace(fresh / file, folder / file)
    return read_manifest(folder)[drawing.name]


def _names(name):
    return f"{name}.svg", f"{name}.png", f"data/{name}.npz"


def _draw(drawing, folder, manifest):
    """Write the three files of a drawing, and the manifest with its entry."""
    svg, png, data = (folder / name for name in _names(drawing.name))
    data.parent.mkdir()
    for dpi, part in INSIDE:
        drawn, nothing = io.StringIO(), {"Date": None, "Creator": None}
        drawing.figure.savefig(drawn, format="svg", dpi=dpi, metadata=nothing)
        plain = same.plain_svg(drawn.getvalue(), part)
        if len(plain) <= same.LARGE:
            break
    svg.write_text(plain, encoding="utf-8", newline="\n")
    drawing.figure.savefig(png, format="png", metadata={"Software": None})
    png.write_bytes(same.few_tones(png.read_bytes()))
    np.savez(data, **{name: _plain(drawing.data[name]) for name in sorted(drawing.data)})
    off = np.degrees(deviations(drawing.nets)).tolist() if drawing.nets else (None, None)
    entry = {"function": drawing.function, "parameters": drawing.parameters, "sha256": _hash(data)}
    entry |= {"max_deviation_theta_deg": off[0], "max_deviation_theta0_deg": off[1]}
    manifest[drawing.name] = rounded(entry | {"claims": drawing.claims})
    text = json.dumps(dict(sorted(manifest.items())), indent=2, allow_nan=False) + "\n"
    (folder / "manifest.json").write_text(text, encoding="utf-8", newline="\n")


def _plain(array):
    """An array rounded, complex numbers as pairs; -0 is 0."""
    array = np.asarray(array)
    if np.iscomplexobj(array):
        array = np.stack([array.real, array.imag], axis=-1)
    return np.round(array.astype("<f8"), DIGITS) + 0.0


def _hash(path):
    return hashlib.sha256(path.read_bytes()).hexdigest()


def differences(name: str, one, two) -> list:
    """What differs between the figure `name` in two folders by more than the tolerances of `same`.

    Words: "missing", "unreadable", or some of "manifest" (in `two` it has the hash of the data,
    too), "data NAME" for each array, "svg" and "png"."""
    svg, png, data = ([Path(x) / file for x in (one, two)] for file in _names(name))
    entries = [read_manifest(folder).get(name) for folder in (one, two)]
    if None in entries or not all(path.exists() for path in (*svg, *png, *data)):
        return ["missing"]
    stated = [entry | {"sha256": ""} for entry in entries]
    try:
        good = same.claims(*stated) and entries[1]["sha256"] == _hash(data[1])
        found = [] if good else ["manifest"]
        found += [f"data {array}" for array in same.data(*map(read_data, data))]
        found += ["svg"] * (not same.svg(*(path.read_text(encoding="utf-8") for path in svg)))
        old, new = (path.read_bytes() for path in png)
        found += ["png"] * (not same.picture(old, new, *same.FEW))
    except (OSError, EOFError, ValueError, zipfile.BadZipFile):  # a broken file, half a merge
        return ["unreadable"]
    return found


def read_data(path) -> dict:
    """The arrays of a figure's data file, {name: array}; complex ones are pairs of numbers."""
    with open(path, "rb") as file, np.load(file, allow_pickle=False) as found:
        return {name: found[name] for name in found.files}


def save_text(text: str, path):
    """Write a text file, never half of it, unless what is there says the same (see `same.text`).

    Paper: Table 1."""
    path = Path(path)
    if not (path.exists() and same.text(path.read_text(encoding="utf-8"), text)):
        with files.replacing(path) as new:
            new.write_text(text, encoding="utf-8", newline="\n")


def show(drawing: Drawing, colours: int | None = None):
    """Show a drawing below the cell of a notebook: as matplotlib does, or as a small PNG.

    colours: of the PNG (IPython Image).  The words of the drawing are stored beside the picture,
    as its alternative text, for books and HTML made of the notebook; JupyterLab and GitHub do not
    read it, so a caption stands below, see tools/outputs.py.  What is shown is closed.

    Nothing is written, unless somebody says where: see `asked`.  To keep a drawing of your own,
    `save` it."""
    if folder := asked():
        save(drawing, folder)
    from IPython.display import Image, display  # only a notebook needs it

    if colours is None:
        if "inline" in plt.get_backend():
            display(drawing.figure, metadata={"image/png": {"alt": drawing.words}})
            plt.close(drawing.figure)
        return None
    fine = io.BytesIO()
    drawing.figure.savefig(fine, format="png", dpi="figure")
    plt.close(drawing.figure)
    small = same.few_tones(fine.getvalue(), tones=(colours,))
    return Image(data=small, format="png", alt=drawing.words)


def asked() -> Path | None:
    """Where drawings that are shown are written too, or None: the variable INETLIB_FIGURES.

    `make figures` and the tests set it for the notebooks they run, and nobody else."""
    folder = os.environ.get(FOLDER)
    return Path(folder) if folder else None


def read_manifest(folder) -> dict:
    """The manifest of a folder as a dict, empty when there is none yet."""
    path = Path(folder) / "manifest.json"
    if not path.exists():
        return {}
    try:
        return {} | json.loads(path.read_text(encoding="utf-8"))
    except (ValueError, TypeError) as error:
        raise ValueError(
            f"{path} is not a JSON object: delete it and redraw the figures"
        ) from error
