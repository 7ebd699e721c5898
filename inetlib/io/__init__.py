"""Reading surfaces and nets from files, and writing nets for other programs.

                 quads   float64   curves   needs
    .obj          yes      yes      yes      -
    .ply          yes      yes      no       -
    .off          yes      yes      no       -
    .vtp          yes      yes      yes      the extra `view` (VTK)
    .glb          no       no       yes      -          float32 and triangles, by the format
    .stl          no       no       -        -          read only
    .dxf          yes      yes      yes      the extra `cad` (ezdxf)      written only
    .3dm          yes      yes      yes      the extra `cad` (rhino3dm)   written only

Coordinates come back bit by bit where the table says float64 (from OBJ and OFF too: 17 digits
where they are needed), and so does the order of vertices, faces and corners: the labels
v1 ... v4 are kept.  Errors about a file are ValueErrors of one sentence that starts with its
name; a missing package is an ImportError that says what to install.
"""

from contextlib import contextmanager
from pathlib import Path
from typing import NamedTuple

import numpy as np

from .. import files, mesh, repair
from .binary import read_ply, read_stl, write_ply
from .exchange import read_vtp, write_3dm, write_dxf, write_vtp
from .glb import read_glb, write_glb
from .text import read_obj, read_off, write_obj, write_off

READERS = {
    ".obj": read_obj,
    ".ply": read_ply,
    ".off": read_off,
    ".stl": read_stl,
    ".vtp": read_vtp,
    ".glb": read_glb,
}
WRITERS = {
    ".obj": write_obj,
    ".ply": write_ply,
    ".off": write_off,
    ".vtp": write_vtp,
    ".glb": write_glb,
    ".dxf": write_dxf,
    ".3dm": write_3dm,
}
TOO_FAR = 1e100  # products of such coordinates would overflow
WITH_CURVES = ".obj", ".vtp", ".glb", ".dxf", ".3dm"


class Surface(NamedTuple):
    """A surface from a file: V (n, 3), triangles F (f, 3), sentences on what was repaired."""

    V: np.ndarray
    F: np.ndarray
    repaired: list


class Net(NamedTuple):
    """A net from a file: V (n, 3), quads Q (f, 4), polygons: index arrays of all other faces."""

    V: np.ndarray
    Q: np.ndarray
    polygons: list


# --- reading ------------------------------------------------------------------------------


def read(path):
    """The mesh in a file, as it is: V (n, 3) float64 and F.

    F is int64, (f, 3) or (f, 4) when all faces are triangles or all are quads, else a list
    of lists of indices.  Suffixes: .obj .ply .off .stl .vtp .glb.  STL and GLB files say
    their points once a triangle: equal ones are returned as one vertex.  ValueError when
    the file is missing, empty, broken, of another kind than its suffix says, has no faces,
    an index out of range or a coordinate that is NaN, infinite or beyond 1e100.
    """
    path = Path(path)
    reader = _by_suffix(READERS, path, "read")
    if path.is_dir():
        raise ValueError(f"{path} is a directory: a file is wanted")
    if not path.is_file():
        raise ValueError(f"{path}: there is no such file")
    if not path.stat().st_size:
        raise ValueError(f"{path}: the file is empty")
    with _named(path):
        return _arrays(*reader(path))


def surface(path, merge=True):
    """The file's mesh as a reference surface of triangles: `Surface(V, F, repaired)`.

    Polygons are cut into triangles; duplicate vertices (within 1e-6 of the bounding box) are
    merged where the surface stays a manifold; collapsed and double triangles and unused
    vertices go; triangles are oriented alike; `repaired` says so, a sentence each.  With
    merge=False duplicates stay: a surface that was cut open on purpose stays open.
    ValueError as in `read`, for edges of more than two faces, vertices with two fans,
    one-sided surfaces and triangles without area; vertex numbers count from 0.
    """
    path = Path(path)
    V, F = read(path)
    with _named(path):
        V, F, repaired = repair.manifold(V, F, merge)
    if path.suffix.lower() in (".stl", ".glb"):
        repaired = ["corners of triangles at equal points were read as one vertex", *repaired]
    return Surface(V, F, repaired)


def net(path):
    """The file's mesh as a net: `Net(V, Q, polygons)`, everything in the order of the file.

    Faces with three, five or more corners go to `polygons`.  ValueError as in `read`, when
    no face is a quad, and when a face uses a vertex twice.  The labels are those of the file:
    see `mesh.is_labelled`, `mesh.label`.
    """
    V, F = read(path)
    if isinstance(F, list):
        Q = np.array([face for face in F if len(face) == 4], dtype=np.int64).reshape(-1, 4)
        others = [np.array(face) for face in F if len(face) != 4]
    else:
        Q, others = (F, []) if F.shape[1] == 4 else (F[:0], list(F))
    if not len(Q):
        kind = "triangles" if all(len(face) == 3 for face in others) else "polygons"
        raise ValueError(f"{path} holds {kind}: quads are wanted")
    with _named(path):
        return Net(*mesh.check_arrays(V, Q), others)


def _arrays(V, F):
    """Checked arrays: finite float64 points and faces that name them."""
    V = np.asarray(V, dtype=np.float64).reshape(-1, 3)
    if not len(F):
        raise ValueError("the file has no faces")
    sizes = {len(face) for face in F}
    if min(sizes) < 3:
        raise ValueError("a face has fewer than three corners")
    good = (np.abs(V) < TOO_FAR).all(axis=1)  # false for NaN too
    if not good.all():
        bad = np.argmin(good)
        raise ValueError(f"vertex {bad} (from 0) has a coordinate that is no usable number")
    joined = np.concatenate([np.asarray(face) for face in F]) if len(sizes) > 1 else np.asarray(F)
    if joined.dtype.kind not in "iu":
        raise ValueError(f"the faces are of type {joined.dtype}: integers are wanted")
    if joined.min() < 0 or joined.max() >= len(V):
        bad = joined.min() if joined.min() < 0 else joined.max()
        raise ValueError(f"a face names vertex {bad}, but there are 0 to {len(V) - 1}")
    if sizes in ({3}, {4}):
        return V, joined.astype(np.int64)
    return V, [[int(k) for k in face] for face in F]


@contextmanager
def _named(path):
    """ValueErrors inside get the file's name."""
    try:
        yield
    except ValueError as error:
        raise ValueError(f"{path}: {error}") from error


def _by_suffix(table, path, verb):
    try:
        return table[path.suffix.lower()]
    except KeyError:
        known = " ".join(table)
        what = f"the suffix {path.suffix!r}" if path.suffix else "no suffix"
        raise ValueError(f"{path} has {what}: files to {verb} end with {known}") from None


# --- writing ------------------------------------------------------------------------------


def write(path, V, Q, curves=None, polygons=(), force=False):
    """Write a net; the suffix of the path names the format: see the table of this module.

    V         (n, 3) vertices; float32 in GLB files by the format, else every bit is kept
    Q         (f, 4) quads, or triangles (f, 3); GLB cuts quads along the shorter diagonal
    curves    `mesh.Families` of vertex index arrays, "all" for mesh.polylines(Q), or None;
              a family is a group of lines in OBJ, the number `family` in VTP, a mesh of
              lines in GLB and a layer of polylines in DXF and 3DM
    polygons  further faces: index arrays (k,)
    force     whether to replace an existing file

    The file is written beside its place and renamed when complete.  FileExistsError for an
    existing file without `force`; ValueError for unknown suffixes, directories, a missing
    folder, curves where the format has no place for them, and indices out of range;
    ImportError when the package for the format is missing.
    """
    path = Path(path)
    writer = _by_suffix(WRITERS, path, "write")
    check = mesh.triangles if np.ndim(Q) == 2 and np.shape(Q)[1] == 3 else mesh.check_arrays
    V, Q = check(V, Q)
    polygons = [_indices(polygon, len(V), 3, "polygon") for polygon in polygons]
    families = _families(curves, Q, len(V))
    if families and path.suffix.lower() not in WITH_CURVES:
        raise ValueError(f"{path}: no place for curves; write one of {' '.join(WITH_CURVES)}")
    if path.is_dir():
        raise ValueError(f"{path} is a directory: the name of a file is wanted")
    if not path.parent.is_dir():
        raise ValueError(f"{path}: there is no folder {path.parent}")
    if path.exists() and not force:
        raise FileExistsError(f"{path} exists already: force=True replaces it")
    with files.replacing(path) as new:
        writer(new, V, Q, polygons, families)


def _families(curves, Q, count):
    """{family: curves} without the empty families."""
    if curves is None:
        return {}
    if isinstance(curves, str) and curves == "all":
        curves = mesh.polylines(Q)
    if not isinstance(curves, mesh.Families):
        raise ValueError(f'curves are a {type(curves).__name__}: mesh.Families, "all" or None')
    found = {k: [_indices(c, count, 2, "curve") for c in f] for k, f in curves._asdict().items()}
    return {name: family for name, family in found.items() if family}


def _indices(given, count, least, what):
    indices = np.asarray(given)
    if indices.ndim != 1 or indices.dtype.kind not in "iu" or len(indices) < least:
        raise ValueError(
            f"a {what} has the shape {indices.shape} and type {indices.dtype}: "
            f"a row of at least {least} vertex indices is wanted"
        )
    if indices.min() < 0 or indices.max() >= count:
        bad = indices.min() if indices.min() < 0 else indices.max()
        raise ValueError(f"a {what} names vertex {bad}, but there are 0 to {count - 1}")
    return indices.astype(np.int64)
