"""The files of the command line: what is checked before the work, and how a net is read."""

import importlib.util
import os
import re
from pathlib import Path

import numpy as np

from . import io, measure, mesh, surfaces
from .io import exchange

PACKAGES = {".vtp": "vtkmodules", ".dxf": "ezdxf", ".3dm": "rhino3dm"}


def check_output(path, force=False, curves=False):
    """Refuse, before the work, a file that could not be written after it.

    ValueError for an unknown suffix, a missing folder, a file that is there (without force),
    curves where the format has no place for them; ImportError for a missing package.
    """
    path = Path(path)
    if path.suffix.lower() not in io.WRITERS:
        raise ValueError(f"{path}: the name must end with one of {' '.join(io.WRITERS)}")
    if curves and path.suffix.lower() not in io.WITH_CURVES:
        raise ValueError(f"{path}: curves go into {' '.join(io.WITH_CURVES)} only")
    package = PACKAGES.get(path.suffix.lower())
    if package and importlib.util.find_spec(package) is None:
        raise ImportError(exchange.MISSING[package])
    if path.is_dir():
        raise ValueError(f"{path} is a folder: the name of a file is wanted")
    if not path.parent.is_dir():
        raise ValueError(f"there is no folder {path.parent}: make it first")
    if path.exists() and not force:
        raise ValueError(f"{path} is there already: --force replaces it")
    if not os.access(path if path.exists() else path.parent, os.W_OK):
        raise ValueError(f"{path}: no permission to write there")


def read_net(path, must_label=True):
    """(V, Q, polygons, notes) of a net's file, labelled where that is possible.

    Where it is not: ValueError, or with must_label=False the labels of the file and a note.
    """
    V, Q, polygons = io.net(path)
    try:
        if mesh.is_labelled(Q):
            return V, Q, polygons, []
    except ValueError:  # not oriented alike
        pass
    try:
        Q = mesh.label(Q)
    except ValueError as reason:
        if must_label:
            raise
        return V, Q, polygons, [f"the numbers are those of the labels in the file: {reason}"]
    words = "the faces did not agree on u and v: all are labelled like the first one now"
    return V, Q, polygons, [words]


def turned(V, Q, theta, theta0):
    """A note, or none, that u and v seem exchanged: the net would fit the wanted angles theta,
    theta0 (degrees or None) much better with the labels turned by a quarter.
    """
    if theta is None or theta0 is None:
        return []
    means = np.degrees([x.mean() for x in measure.angles(V, Q)])
    wanted = np.array([theta, theta0])
    as_it_is, other = (np.abs(x - wanted).max() for x in (means, 180 - means))
    if as_it_is < 2 * other + 1:
        return []
    return [
        "u and v may be exchanged in the file: with the other labels its angles are "
        f"{180 - means[0]:.6g} and {180 - means[1]:.6g}"
    ]


def curves(path, Q, in_obj=False):
    """The families of curves, for formats that keep them apart, and for OBJ if asked for."""
    suffix = Path(path).suffix.lower()
    wanted = suffix in io.WITH_CURVES and (suffix != ".obj" or in_obj)
    return mesh.polylines(Q) if wanted else None


def profile(path):
    """The `surfaces.Profile` through the rows of a text file, each a radius and a height.

    Commas, semicolons, tabs or spaces stand between the two; a first row without numbers is a
    heading.  ValueError names the first line that is something else.
    """
    rows = []
    lines = Path(path).read_text(encoding="utf-8-sig", errors="replace").splitlines()
    filled = [(k, line) for k, line in enumerate(lines, 1) if line.strip()]
    for k, line in filled:
        try:
            radius, height = (float(x) for x in re.split(r"[,;\s]+", line.strip(" \t,;")))
        except ValueError:
            if k == filled[0][0] and not re.search(r"\d", line):
                continue
            raise ValueError(
                f"{path}, line {k}: a radius and a height are wanted, not {line.strip()[:40]!r}"
            ) from None
        rows.append((radius, height))
    if len(rows) < 2:
        raise ValueError(f"{path}: at least two rows with a radius and a height are wanted")
    try:
        return surfaces.spline_profile(rows)
    except ValueError as error:
        raise ValueError(f"{path}: {error}") from None
