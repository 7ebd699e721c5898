"""PLY and STL: meshes as bytes (or as text; both formats come in two kinds).

Readers return points and faces as arrays, or faces as lists where their sizes differ.
"""

from pathlib import Path

import numpy as np

from ..repair import weld
from .text import text

PLY_TYPES = {
    "char": "i1", "uchar": "u1", "short": "i2", "ushort": "u2", "int": "i4", "uint": "u4",
    "float": "f4", "double": "f8", "int8": "i1", "uint8": "u1", "int16": "i2", "uint16": "u2",
    "int32": "i4", "uint32": "u4", "float32": "f4", "float64": "f8",
}  # fmt: skip
PLY_ORDERS = {"ascii": None, "binary_little_endian": "<", "binary_big_endian": ">"}

# --- PLY ----------------------------------------------------------------------------------


def read_ply(path):
    """Points (n, 3) and faces of a PLY file, text or binary of either byte order."""
    data = Path(path).read_bytes()
    head, mark, body = data.partition(b"end_header")
    if not data.startswith(b"ply") or not mark:
        raise ValueError("a PLY file starts with `ply` and a header that ends with `end_header`")
    order, elements = _ply_header(head.decode("ascii", errors="replace").splitlines()[1:])
    body = body.partition(b"\n")[2]  # the line may end with CR LF
    source = iter(text(body).split()) if order is None else memoryview(body)
    points = faces = None
    for name, count, properties in elements:
        columns, source = _ply_element(source, order, name, count, properties)
        if name == "vertex":
            if not {"x", "y", "z"} <= set(columns):
                raise ValueError("the vertices have no properties x, y and z")
            points = np.stack([columns[k].astype(np.float64) for k in "xyz"], axis=1)
        elif name == "face":
            faces = columns.get("vertex_indices", columns.get("vertex_index"))
    if points is None or faces is None:
        raise ValueError("the file has no faces: the elements `vertex` and `face` are wanted")
    return points, faces


def _ply_header(lines):
    """Byte order and the elements (name, count, [(name, type, type of the count or None)])."""
    order, elements = "", []
    for number, line in enumerate(lines, 2):
        try:
            match line.split():
                case ["format", kind, _]:
                    order = PLY_ORDERS[kind]
                case ["element", name, count]:
                    elements.append((name, int(count), []))
                case ["property", "list", size, kind, name]:
                    elements[-1][2].append((name, PLY_TYPES[kind], PLY_TYPES[size]))
                case ["property", kind, name]:
                    elements[-1][2].append((name, PLY_TYPES[kind], None))
                case ["comment" | "obj_info", *_] | []:
                    pass
                case _:
                    raise ValueError
        except (KeyError, IndexError, ValueError):
            raise ValueError(f"line {number}: {line[:60]!r} is no line of a PLY header") from None
    if order == "" or any(count < 0 for _, count, _ in elements):
        raise ValueError("the PLY header names no format, or a negative number of elements")
    return order, elements


def _ply_element(source, order, name, count, properties):
    """The columns {name: array, or list of arrays} of an element, and what follows it."""
    if not properties:
        return {}, source
    if order is None:
        return _ply_text(source, name, count, properties), source
    if count == 0:
        return {key: np.empty(0) for key, _, _ in properties}, source
    rows = _ply_uniform(source, order, count, properties)
    if rows is not None:
        return {key: rows[key] for key, _, _ in properties}, source[rows.nbytes :]
    columns, at = {key: [] for key, _, _ in properties}, 0
    try:
        for _ in range(count):
            for key, kind, size in properties:
                length = 1
                if size:
                    length = int(np.frombuffer(source, order + size, 1, at)[0])
                    if length < 0:
                        raise ValueError
                    at += int(size[1])
                columns[key].append(np.frombuffer(source, order + kind, length, at))
                at += length * int(kind[1])
    except ValueError:
        raise ValueError(f"the file ends early, or breaks off, in the element `{name}`") from None
    lists = {key for key, _, size in properties if size}
    return {k: c if k in lists else np.concatenate(c) for k, c in columns.items()}, source[at:]


def _ply_uniform(source, order, count, properties):
    """The rows as one structured array when all lists are as long as in the first row, or None."""
    fields, at = [], 0
    try:
        for key, kind, size in properties:
            length = ()
            if size:
                length = (int(np.frombuffer(source, order + size, 1, at)[0]),)
                fields.append((f"count of {key}", order + size))
            fields.append((key, order + kind, length))
            at = np.dtype(fields).itemsize
        rows = np.frombuffer(source, np.dtype(fields), count)
    except ValueError:  # too short: lists may be shorter further on
        return None
    counts = [(rows[f"count of {key}"], rows[key].shape[1]) for key, _, size in properties if size]
    return rows if all((found == length).all() for found, length in counts) else None


def _ply_text(words, name, count, properties):
    columns = {key: [] for key, _, _ in properties}
    try:
        for _ in range(count):
            for key, kind, size in properties:
                read = float if kind[0] == "f" else int
                if size:
                    columns[key].append([read(next(words)) for _ in range(int(next(words)))])
                else:
                    columns[key].append(read(next(words)))
    except (StopIteration, RuntimeError):
        raise ValueError(f"the file ends early, in the {count} rows of `{name}`") from None
    except ValueError as error:
        raise ValueError(f"the element `{name}` cannot be read: {error}") from None
    return {k: columns[k] if size else np.array(columns[k]) for k, _, size in properties}


def write_ply(path, V, Q, polygons, curves):
    """Write a binary PLY file, coordinates as `double`; it has no place for curves here."""
    size = "uchar" if all(len(polygon) < 256 for polygon in polygons) else "int"
    head = (
        f"ply\nformat binary_little_endian 1.0\nelement vertex {len(V)}\n"
        "property double x\nproperty double y\nproperty double z\n"
        f"element face {len(Q) + len(polygons)}\n"
        f"property list {size} int vertex_indices\nend_header\n"
    )
    kind = "<" + PLY_TYPES[size]
    rows = np.empty(len(Q), dtype=[("count", kind), ("corners", "<i4", Q.shape[1:])])
    rows["count"], rows["corners"] = Q.shape[1], Q
    more = [np.array(len(p), kind).tobytes() + p.astype("<i4").tobytes() for p in polygons]
    body = [V.astype("<f8").tobytes(), rows.tobytes(), *more]
    Path(path).write_bytes(head.encode() + b"".join(body))


# --- STL ----------------------------------------------------------------------------------


def read_stl(path):
    """Points (n, 3) and triangles (f, 3) of an STL file; equal corners become one vertex."""
    data = Path(path).read_bytes()
    count = int.from_bytes(data[80:84], "little")
    if len(data) == 84 + 50 * count:
        rows = np.frombuffer(data, [("floats", "<f4", (4, 3)), ("other", "<u2")], count, 84)
        corners = rows["floats"][:, 1:].astype(np.float64)
    elif data.lstrip().startswith(b"solid") and b"\0" not in data:
        corners = _stl_text(text(data))
    else:
        raise ValueError(
            f"no STL file, or a broken one: {len(data)} bytes, and a binary file "
            f"of {count} triangles has {84 + 50 * count}"
        )
    return weld(corners.reshape(-1, 3), np.arange(corners.size // 3).reshape(-1, 3))


def _stl_text(lines):
    words = [line.split() for line in lines.splitlines()]
    closed = any(row[:1] == ["endsolid"] for row in words)
    try:
        points = [[float(x) for x in row[1:4]] for row in words if row[:1] == ["vertex"]]
        corners = np.array(points, dtype=np.float64).reshape(-1, 3, 3)
    except ValueError:
        closed = False
    if not closed:
        raise ValueError("the STL text ends early or has a vertex without three coordinates")
    return corners
