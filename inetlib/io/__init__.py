"""Reading surfaces and nets from files, and writing nets for other programs.

Coordinates are kept bit by bit (GLB and STL have float32 and triangles only), and so is the
order of vertices, faces and corners.  What is wrong with a file is a ValueError of one sentence
that starts with its name; a missing package is an ImportError that says what to install."""

import importlib.util
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path
from typing import NamedTuple

import numpy as np

from .. import files, mesh, repair
from . import binary, exchange, glb, text


class Format(NamedTuple):
    """How files are read and written, if at all; the package for it is in the extra of inetlib."""

    read: Callable | None = None
    write: Callable | None = None
    curves: bool = False
    package: str = ""
    extra: str = ""


FORMATS = {
    ".obj": Format(text.read_obj, text.write_obj, curves=True),
    ".ply": Format(binary.read_ply, binary.write_ply),
    ".off": Format(text.read_off, text.write_off),
    ".stl": Format(binary.read_stl, binary.write_stl),
    ".vtp": Format(exchange.read_vtp, exchange.write_vtp, True, "pyvista", "view"),
    ".glb": Format(glb.read_glb, glb.write_glb, curves=True),
    ".gltf": Format(glb.read_glb),
    ".dxf": Format(None, exchange.write_dxf, True, "ezdxf", "cad"),
    ".3dm": Format(exchange.read_3dm, exchange.write_3dm, True, "rhino3dm", "cad"),
}
READERS = [suffix for suffix, known in FORMATS.items() if known.read]
WRITERS = [suffix for suffix, known in FORMATS.items() if known.write]
WITH_CURVES = [suffix for suffix, known in FORMATS.items() if known.curves]
PACKAGES = {suffix: known.package for suffix, known in FORMATS.items() if known.package}
SOUPS = ".stl", ".glb", ".gltf"  # here a point is said once a triangle
TOO_FAR = 1e100  # products of such coordinates would overflow
SINGLE = *SOUPS, ".3dm"  # where numbers are float32, too, and so end at 3.4e38


class Surface(NamedTuple):
    """A surface from a file: V (n, 3), triangles F (f, 3), sentences on what was repaired."""

    V: np.ndarray
    F: np.ndarray
    repaired: list[str]


class Net(NamedTuple):
    """A net from a file: V (n, 3), quads Q (f, 4), polygons: index arrays of all other faces.

    Faces of four corners that `write` was given as polygons are among the polygons again."""

    V: np.ndarray
    Q: np.ndarray
    polygons: list[np.ndarray]


def read(path: str | Path) -> tuple[np.ndarray, np.ndarray | list]:
    """The mesh in a file, as it is: V (n, 3) float64 and F, counted from 0.

    F is int64, (f, 3) or (f, 4) when all faces are triangles or all are quads, else a list
    of lists.  Equal points of STL and GLB files are one vertex.  ValueError when the file is
    missing, empty, broken, of another kind than its suffix says, without faces, or has an
    index out of range or a coordinate that is NaN, infinite or beyond 1e100."""
    return _read(Path(path))[:2]


def _read(path):
    """V and F as in `read`, and the numbers of the faces that the file calls cut panels."""
    known = _format(path, READERS, "read")
    with named(path), np.errstate(all="ignore"):
        if not path.is_file():
            raise ValueError(
                "a directory: name a file in it" if path.is_dir() else "there is no such file"
            )
        if not path.stat().st_size:
            raise ValueError("the file is empty: export it again")
        with open(path, "rb") as file:
            if file.read(26) == b"version https://git-lfs.gi":
                raise ValueError("a pointer of Git LFS, not the file itself: run `git lfs pull`")
        V, F, *cut = known.read(path)
        V, F = _checked(V, F)
    if path.suffix.lower() in SOUPS:
        V, F = repair.weld(V, F)
    return V, F, {int(k) for numbers in cut for k in numbers}


def surface(path: str | Path, merge: bool = True) -> Surface:
    """The file's mesh as a surface of triangles: `repair.manifold`, which `merge` is for.

    ValueError as in `read`, and for what is no surface."""
    V, F = read(path)
    with named(path, V):
        V, F, repaired = repair.manifold(V, F, merge)
    if Path(path).suffix.lower() in SOUPS:
        repaired = ["corners of triangles at equal points were read as one vertex", *repaired]
    return Surface(V, F, repaired)


def net(path: str | Path) -> Net:
    """The file's mesh as a net, with the order and the labels of the file.

    A corner that repeats the one before is none.  ValueError as in `read`, when no face is a
    quad, and when a face uses a vertex twice."""
    V, F, cut = _read(Path(path))
    if not isinstance(F, list) and (cut or (np.roll(F, 1, axis=1) == F).any()):
        F = F.tolist()
    if isinstance(F, list):
        F = repair.without_repeats(F)
    Q, others = F, []
    if isinstance(F, list):
        whole = [len(face) == 4 and k not in cut for k, face in enumerate(F)]
        Q = np.array([face for face, yes in zip(F, whole, strict=True) if yes], dtype=np.int64)
        others = [np.array(face) for face, yes in zip(F, whole, strict=True) if not yes]
    if not len(Q) or Q.shape[1] != 4:
        what = "polygons" if others else "triangles"
        raise ValueError(
            f"{path} holds {what}: quads are wanted (inet cover makes a net of such a surface)"
        )
    with named(path, V):
        return Net(*mesh.check_arrays(V, Q), others)


def _checked(V, F):
    """Finite float64 points and faces that name them."""
    V = np.asarray(V, dtype=np.float64).reshape(-1, 3)
    if not len(F):
        raise ValueError("the file has no faces: export a mesh, not points or curves")
    far = np.flatnonzero(~(np.abs(V) < TOO_FAR).all(axis=1))  # NaN too
    if far.size:
        raise mesh.Fault(
            "vertex {} has a coordinate that is no usable number: export the mesh again without it",
            far[0],
        )
    sizes = {len(face) for face in F}
    if min(sizes) < 3:
        raise ValueError("a face has fewer than three corners")
    _check_indices(np.concatenate(F) if len(sizes) > 1 else np.asarray(F), len(V), "face")
    if sizes in ({3}, {4}):
        return V, np.asarray(F).astype(np.int64)
    return V, [[int(k) for k in face] for face in F]


def _check_indices(indices, count, what):
    bad = indices[~((indices >= 0) & (indices < count) & (indices % 1 == 0))]  # NaN too
    if bad.size:
        raise ValueError(f"a {what} names vertex {bad[0]:.15g}, but there are 0 to {count - 1}")


@contextmanager
def named(path: str | Path, V: np.ndarray | None = None, counted: bool = True) -> Iterator[None]:
    """ValueErrors inside get the file's name, and its own numbers of the vertices V, if any.

    counted: whether vertices are still those of the file, so that their numbers say something."""
    first = 1 if Path(path).suffix.lower() == ".obj" else 0
    try:
        yield
    except mesh.Fault as error:
        raise ValueError(f"{path}: {error.told(V, first if counted else None)}") from error
    except ValueError as error:
        raise ValueError(f"{path}: {error}") from error


def _format(path, suffixes, verb):
    """The `Format` of a path, one of those with these suffixes, its package at hand."""
    suffix = path.suffix.lower()
    if suffix not in suffixes:
        what = f"the suffix {path.suffix!r}" if suffix else "no suffix"
        raise ValueError(f"{path} has {what}: files to {verb} end with {' '.join(suffixes)}")
    if package := missing(suffix):
        what = f"{suffix[1:].upper()} files need the package {package}"
        raise ImportError(f"{what}: pip install inetlib[{FORMATS[suffix].extra}]")
    return FORMATS[suffix]


def missing(suffix: str) -> str:
    """The package that a file with this suffix needs and that is not installed, or ""."""
    package = PACKAGES.get(suffix, "")
    return package if package and importlib.util.find_spec(package) is None else ""


def check_output(
    path: str | Path,
    curves: bool = False,
    force: bool = False,
    unit: str | None = None,
    faces: bool = False,
    up: str = "z",
) -> Format:
    """The format of a file that `write` can write; else its errors, before the work begins.

    >>> check_output("net.step")  # doctest: +ELLIPSIS
    Traceback (most recent call last):
    ValueError: net.step has the suffix '.step': files to write end with .obj .ply .off ..."""
    path = Path(path)
    known = _format(path, WRITERS, "write")
    if curves and not known.curves:
        raise ValueError(f"{path}: no place for curves; write one of {' '.join(WITH_CURVES)}")
    files.check_place(path, force)
    suffix = path.suffix.lower()
    if unit not in exchange.UNITS or up not in ("z", "y"):
        raise ValueError(f'unit = {unit!r}, up = {up!r}: mm, cm, m, in or ft, and "z" or "y"')
    if (unit and suffix not in (".dxf", ".3dm")) or (faces and suffix != ".dxf"):
        raise ValueError(f"{path}: only .dxf and .3dm have units, only .dxf has faces")
    if up == "y" and suffix == ".glb":
        raise ValueError(f"{path}: y is upwards in GLB files anyway, leave `up` as it is")
    return known


def write(
    path: str | Path,
    V: np.ndarray,
    Q: np.ndarray,
    curves: mesh.Families | str | None = None,
    polygons: Sequence = (),
    force: bool = False,
    unit: str | None = None,
    faces: bool = False,
    up: str = "z",
) -> None:
    """Write a net, all of it or nothing; the suffix of the path names the format.

    V         (n, 3) vertices
    Q         (f, 4) quads, or triangles (f, 3)
    curves    `mesh.Families` of vertex index arrays, "all" for mesh.polylines(Q), or None
    polygons  further faces, such as cut panels: index arrays (k,) of three or more corners; they
              come after the quads, in the layer (group, mesh) `panels_cut` where there are any
    force     whether to replace an existing file
    unit      of the coordinates, noted in .dxf and .3dm: "mm", "cm", "m", "in" or "ft"
    faces     in .dxf faces of three or four corners, not one MESH
    up        "z", or "y" for programs with y upwards: (x, y, z) is written as (x, z, -y)

    ValueError for unknown suffixes, directories, a missing folder, curves in a format without
    them, indices out of range, and coordinates beyond 1e38 in .stl, .glb and .3dm;
    FileExistsError without `force`; PermissionError; ImportError when the package for the
    format is missing."""
    check = mesh.triangles if np.ndim(Q) == 2 and np.shape(Q)[1] == 3 else mesh.check_arrays
    V, Q = check(V, Q)
    if isinstance(curves, str) and curves == "all":
        curves = mesh.polylines(Q)
    if not isinstance(curves, mesh.Families | None):
        raise ValueError(f'curves are a {type(curves).__name__}: mesh.Families, "all" or None')
    given = curves._asdict() if curves else {}
    families = {k: [_row(c, len(V), 2, "curve") for c in x] for k, x in given.items() if x}
    polygons = [_row(polygon, len(V), 3, "polygon") for polygon in polygons]
    known = check_output(path, bool(families), force, unit, faces, up)
    suffix = Path(path).suffix.lower()
    if suffix in SINGLE and np.abs(V).max() > 1e38:
        raise ValueError(f"{path}: no place for coordinates beyond 1e38, write .obj or .ply")
    V = V @ glb.Y_UP.T if up == "y" else V
    more = {".dxf": (unit, faces), ".3dm": (unit,)}.get(suffix, ())
    with files.replacing(path) as new:
        known.write(new, V, Q, polygons, families, *more)


def _row(given, count, least, what):
    """Indices of at least so many of `count` vertices, as int64."""
    indices = np.asarray(given)
    if indices.ndim != 1 or indices.dtype.kind not in "iu" or len(indices) < least:
        found = f"the shape {indices.shape} and type {indices.dtype}"
        raise ValueError(f"a {what} has {found}: {least} or more vertex indices are wanted")
    _check_indices(indices, count, what)
    return indices.astype(np.int64)
