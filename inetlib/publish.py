"""Writing a figure: SVG and PNG with stable bytes, and its entry in the manifest.

A drawing (see `inetlib.drawings`) is a `Drawing`; `save` writes it and `figures/manifest.json`
remembers the function, its parameters, a hash of the data drawn and the numbers claimed.

Paper: Figs. 1-13.
"""

import hashlib
import io
import json
from contextlib import ExitStack
from pathlib import Path
from typing import NamedTuple

import matplotlib.pyplot as plt
import numpy as np
import PIL.Image

from . import measure
from .files import replacing

DIGITS = 6  # of the data in the hash; angles are reported to 1e-9 degrees


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


def digest(data):
    """SHA-256 of arrays rounded to 1e-6, names and shapes included; -0 counts as 0.

    data: {name: array of numbers, real or complex}.

    Paper: Figs. 1-13 (manifest).
    """
    total = hashlib.sha256()
    for name in sorted(data):
        array = np.asarray(data[name])
        if np.iscomplexobj(array):
            array = np.stack([array.real, array.imag], axis=-1)
        rounded = np.round(array.astype(np.float64), DIGITS) + 0.0
        total.update(f"{name}{rounded.shape}".encode())
        total.update(np.ascontiguousarray(rounded, dtype="<f8").tobytes())
    return total.hexdigest()


def deviations(nets):
    """Largest deviation of theta and theta0, degrees, over all faces of all nets.

    nets: (V, Q, theta, theta0) tuples, angles in radians.  (nan, nan) without nets.

    Paper: Figs. 1-13 (manifest).
    """
    if not nets:
        return np.nan, np.nan
    off = [
        [
            measure.spread(a, b).max_deviation
            for a, b in zip(measure.angles(V, Q), asked, strict=True)
        ]
        for V, Q, *asked in nets
    ]
    return tuple(float(x) for x in np.degrees(np.max(off, axis=0)))


def save(drawing, folder):
    """Write folder/NAME.svg, folder/NAME.png and the figure's entry in folder/manifest.json.

    All three are written under temporary names and renamed at the end: when anything fails,
    the old files stay.  `folder` is made when only its last part is missing.  Returns the
    manifest's entry.

    Paper: Figs. 1-13.
    """
    folder = Path(folder)
    folder.mkdir(exist_ok=True)
    manifest = read_manifest(folder)
    theta_off, theta0_off = deviations(drawing.nets)
    entry = {
        "function": drawing.function,
        "parameters": drawing.parameters,
        "sha256": digest(drawing.data),
        "max_deviation_theta_deg": _rounded(theta_off),
        "max_deviation_theta0_deg": _rounded(theta0_off),
        "claims": drawing.claims,
    }
    manifest[drawing.name] = entry
    text = json.dumps(dict(sorted(manifest.items())), indent=2, allow_nan=False)
    names = "manifest.json", f"{drawing.name}.svg", f"{drawing.name}.png"
    with ExitStack() as stack:
        listing, svg, png = (stack.enter_context(replacing(folder / name)) for name in names)
        drawing.figure.savefig(svg, format="svg", metadata={"Date": None, "Creator": None})
        drawing.figure.savefig(png, format="png", metadata={"Software": None})
        Path(listing).write_text(text + "\n", encoding="utf-8", newline="\n")
    return entry


def save_text(text, path):
    """Write a text file under a temporary name, then rename it: never half a file.

    Paper: Table 1.
    """
    path = Path(path)
    with replacing(path) as name:
        Path(name).write_text(text, encoding="utf-8", newline="\n")


def preview(drawing, colours=96):
    """The drawing for a notebook, a small PNG (IPython Image) of a few colours; closes the figure.

    For figures that would make a notebook too large; the files of `save` are finer.

    Paper: Figs. 1-13.
    """
    from IPython.display import Image  # only a notebook needs it

    fine, small = io.BytesIO(), io.BytesIO()
    drawing.figure.savefig(fine, format="png", dpi="figure")
    plt.close(drawing.figure)
    picture = PIL.Image.open(fine).convert("RGB")
    picture.quantize(colours, dither=PIL.Image.Dither.NONE).save(small, format="png", optimize=True)
    return Image(data=small.getvalue(), format="png")


def read_manifest(folder):
    """The manifest of a folder as a dict, empty when there is none yet.

    Paper: Figs. 1-13 (manifest).
    """
    path = Path(folder) / "manifest.json"
    if not path.exists():
        return {}
    try:
        return {} | json.loads(path.read_text(encoding="utf-8"))
    except (ValueError, TypeError) as error:
        raise ValueError(
            f"{path} is not a JSON object: delete it and make the figures again"
        ) from error


def _rounded(degrees):
    return None if np.isnan(degrees) else round(degrees, 9) + 0.0
