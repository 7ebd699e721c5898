"""Writing a figure: SVG, PNG, the data drawn, and its entry in the manifest, if it changed.

A drawing (see `inetlib.drawings`) is a `Drawing`; `save` writes it and `figures/manifest.json`
remembers the function, its parameters, the hash of the file of its data and the numbers
claimed.  On another machine the last digits of all these differ: what shows the same is kept.

Paper: Figs. 1-13.
"""

import functools
import hashlib
import inspect
import io
import json
import os
import zipfile
from pathlib import Path
from typing import NamedTuple

import matplotlib.pyplot as plt
import numpy as np
import PIL.Image

from . import files, measure, same

DIGITS = 7  # decimals of the data that are stored


class Drawing(NamedTuple):
    """A finished figure and what stands behind it.

    name        file stem, as fig03
    figure      the matplotlib figure
    function    the function that drew it, as a dotted name
    parameters  {name: number}, what the function was called with
    data        {name: array}, the geometry drawn
    nets        (V, Q, theta, theta0) of each net shown, its angles in radians
    claims      {name: number or text}, what the figure states
    """

    name: str
    figure: object
    function: str
    parameters: dict
    data: dict
    nets: list
    claims: dict


def drawn(draw):
    """`draw` of a module of `drawings`, which returns (figure, data, nets, claims), as a function
    that returns the `Drawing`: named by its module, with the arguments of the call.
    """
    signature, name = inspect.signature(draw), draw.__module__.rpartition(".")[2]

    @functools.wraps(draw)
    def whole(*args, **kwargs):
        given = signature.bind(*args, **kwargs)
        given.apply_defaults()
        figure, data, nets, claims = draw(*given.args, **given.kwargs)
        parameters = {k: x for k, x in given.arguments.items() if not (x is None or callable(x))}
        return Drawing(name, figure, f"{draw.__module__}.draw", parameters, data, nets, claims)

    return whole


def deviations(nets):
    """Largest deviation of theta and theta0, degrees, over all faces of all nets.

    nets: (V, Q, theta, theta0) tuples, angles in radians.  (nan, nan) without nets.
    """
    if not nets:
        return np.nan, np.nan
    off = [measure.deviations(V, Q, *asked).max(axis=1) for V, Q, *asked in nets]
    if not np.isfinite(off).all():
        raise ValueError("the angles that a net should have are no finite numbers")
    return tuple(float(x) for x in np.degrees(np.max(off, axis=0)))


def off(V, Q, angles):
    """The larger deviation of both angles (radians) over all faces: degrees, 6 decimals."""
    return round(float(np.degrees(measure.deviations(V, Q, *angles).max())), 6)


def save(drawing, folder):
    """Write the figure into a folder, unless what is there shows the same; its manifest entry.

    folder/NAME.svg, folder/NAME.png, folder/data/NAME.npz and the entry in
    folder/manifest.json go together: where one of them differs from the new drawing by more
    than the tolerances of `same`, all are replaced, else all are kept.  The new ones are made
    under temporary names first: when anything fails, the old files stay.  `folder` is made
    when only its last part is missing.
    """
    folder = Path(folder)
    folder.mkdir(exist_ok=True)
    manifest = read_manifest(folder)
    with files.scratch(folder) as fresh:
        entry = _draw(drawing, fresh)
        if not differences(drawing.name, fresh, folder):
            return manifest[drawing.name]
        text = json.dumps(dict(sorted((manifest | {drawing.name: entry}).items())), indent=2)
        (fresh / "manifest.json").write_text(text + "\n", encoding="utf-8", newline="\n")
        (folder / "data").mkdir(exist_ok=True)
        for name in (*_names(drawing.name), "manifest.json"):  # the last vouches for the others
            os.replace(fresh / name, folder / name)
    return entry


def _names(name):
    return f"{name}.svg", f"{name}.png", f"data/{name}.npz"


def _draw(drawing, folder):
    """Write the three files of a drawing and a manifest of it alone; its entry."""
    svg, png, data = (folder / name for name in _names(drawing.name))
    data.parent.mkdir()
    figure = drawing.figure
    text = io.StringIO()
    figure.savefig(text, format="svg", metadata={"Date": None, "Creator": None})
    svg.write_text(same.plain_svg(text.getvalue()), encoding="utf-8", newline="\n")
    figure.savefig(png, format="png", metadata={"Software": None})
    np.savez(data, **{name: _plain(drawing.data[name]) for name in sorted(drawing.data)})
    theta_off, theta0_off = (None if np.isnan(x) else x for x in deviations(drawing.nets))
    entry = {
        "function": drawing.function,
        "parameters": _rounded(drawing.parameters),
        "sha256": _hash(data),
        "max_deviation_theta_deg": _rounded(theta_off),
        "max_deviation_theta0_deg": _rounded(theta0_off),
        "claims": _rounded(drawing.claims),
    }
    text = json.dumps({drawing.name: entry}, indent=2, allow_nan=False)
    (folder / "manifest.json").write_text(text, encoding="utf-8")
    return json.loads(text)[drawing.name]


def _plain(array):
    """An array rounded, complex numbers as pairs; -0 is 0."""
    array = np.asarray(array)
    if np.iscomplexobj(array):
        array = np.stack([array.real, array.imag], axis=-1)
    return np.round(array.astype("<f8"), DIGITS) + 0.0


def _rounded(value):
    """The same with floats rounded to 1e-9; None for nan."""
    if isinstance(value, dict):
        return {name: _rounded(x) for name, x in value.items()}
    if isinstance(value, (list, tuple)):
        return [_rounded(x) for x in value]
    if isinstance(value, complex):
        return _rounded([value.real, value.imag])
    if isinstance(value, float) and np.isfinite(value):
        return round(value, 9) + 0.0
    return value


def _hash(path):
    return hashlib.sha256(path.read_bytes()).hexdigest()


def differences(name, one, two):
    """What differs between the figure `name` in two folders by more than the tolerances of `same`.

    Returns a list of words, empty where both folders hold the same figure: "missing",
    "unreadable", or some of "manifest", "data NAME" for each array, "svg" and "png";
    "manifest" also where that of `two` does not have the hash of its data.
    """
    one, two = Path(one), Path(two)
    pairs = [(one / file, two / file) for file in _names(name)]
    entries = [read_manifest(folder).get(name) for folder in (one, two)]
    if None in entries or not all(path.exists() for pair in pairs for path in pair):
        return ["missing"]
    try:
        return _differences(entries, *pairs)
    except (OSError, EOFError, ValueError, zipfile.BadZipFile):  # a broken file, half a merge
        return ["unreadable"]


def _differences(entries, svg, png, data):
    """`differences` of two entries of manifests and three pairs of paths."""
    stated = [{k: x for k, x in entry.items() if k != "sha256"} for entry in entries]
    good = same.claims(*stated) and entries[1]["sha256"] == _hash(data[1])
    found = [] if good else ["manifest"]
    found += [f"data {array}" for array in same.data(*map(read_data, data))]
    if not same.svg(*(path.read_text(encoding="utf-8") for path in svg)):
        found.append("svg")
    if not same.picture(*(path.read_bytes() for path in png)):
        found.append("png")
    return found


def read_data(path):
    """The arrays of a figure's data file, {name: array}; complex ones are pairs of numbers."""
    with open(path, "rb") as file, np.load(file, allow_pickle=False) as found:
        return {name: found[name] for name in found.files}


def save_text(text, path):
    """Write a text file unless what is there says the same (see `same.text`).

    Under a temporary name, then renamed: never half a file.

    Paper: Table 1.
    """
    path = Path(path)
    if path.exists() and same.text(path.read_text(encoding="utf-8"), text):
        return
    with files.replacing(path) as name:
        name.write_text(text, encoding="utf-8", newline="\n")


def preview(drawing, colours=96):
    """The drawing for a notebook, a small PNG (IPython Image) of a few colours; closes the figure.

    For figures that would make a notebook too large; the files of `save` are finer.
    """
    from IPython.display import Image  # only a notebook needs it

    fine, small = io.BytesIO(), io.BytesIO()
    drawing.figure.savefig(fine, format="png", dpi="figure")
    plt.close(drawing.figure)
    picture = PIL.Image.open(fine).convert("RGB")
    picture.quantize(colours, dither=PIL.Image.Dither.NONE).save(small, format="png", optimize=True)
    return Image(data=small.getvalue(), format="png")


def read_manifest(folder):
    """The manifest of a folder as a dict, empty when there is none yet."""
    path = Path(folder) / "manifest.json"
    if not path.exists():
        return {}
    try:
        return {} | json.loads(path.read_text(encoding="utf-8"))
    except (ValueError, TypeError) as error:
        raise ValueError(
            f"{path} is not a JSON object: delete it and make the figures again"
        ) from error
