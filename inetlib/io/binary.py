"""PLY and STL: meshes as bytes (or as text; both formats come in two kinds)."""

from contextlib import suppress
from pathlib import Path

import numpy as np

from ..repair import triangulate
from .text import CUT, cut_mark, decoded

PLY_TYPES = {
    "char": "i1", "uchar": "u1", "short": "i2", "ushort": "u2", "int": "i4", "uint": "u4",
    "float": "f4", "double": "f8", "int8": "i1", "uint8": "u1", "int16": "i2", "uint16": "u2",
    "int32": "i4", "uint32": "u4", "float32": "f4", "float64": "f8",
}  # fmt: skip
PLY_ORDERS = {"binary_little_endian": "<", "binary_big_endian": ">"}


def read_ply(path: Path) -> tuple[np.ndarray, np.ndarray | list, range]:
    """Points (n, 3), faces and cut panels of a PLY file, text or binary of either byte order."""
    head, mark, body = path.read_bytes().partition(b"end_header")
    if not head.startswith(b"ply") or not mark:
        raise ValueError("a PLY file starts with `ply` and a header that ends with `end_header`")
    header = head.decode("ascii", errors="replace").splitlines()
    form, elements = _ply_header(header)
    body = body.partition(b"\n")[2]  # the line may end with CR LF
    if form == "ascii":
        body = np.array(decoded(body).split(), dtype=np.float64).tobytes()
    runs, at = {}, 0
    for name, count, properties in elements:
        try:
            runs[name], at = _ply_runs(body, at, count, properties)
        except (ValueError, OverflowError):
            raise ValueError(f"the file ends early or breaks off in the element `{name}`") from None
    if not (runs.get("vertex") and runs.get("face")):
        raise ValueError("the file has no faces: the elements `vertex` and `face` are wanted")
    key = "vertex_indices" if "vertex_indices" in runs["face"][0].dtype.names else "vertex_index"
    try:
        points = [np.hstack([run[k] for k in "xyz"], dtype=np.float64) for run in runs["vertex"]]
        faces = [run[key] for run in runs["face"]]
    except ValueError:
        raise ValueError(f"the vertices have no x, y and z, or the faces no {key}") from None
    count = sum(map(len, faces))
    cut = range(max(count - cut_mark("\n".join(header)), 0), count)
    if len({part.shape[1] for part in faces}) > 1:
        return np.concatenate(points), [face for part in faces for face in part], cut
    return np.concatenate(points), np.concatenate(faces), cut


def _ply_header(lines):
    """The format, and the elements (name, count, [(name, type, type of the count or None)])."""
    form, types, elements = "", {}, []
    for number, line in enumerate(lines[1:], 2):
        try:
            match line.split():
                case ["format", "ascii" as form, _]:
                    types = dict.fromkeys(PLY_TYPES, "f8")  # as which its text is read
                case ["format", form, _]:
                    types = {name: PLY_ORDERS[form] + kind for name, kind in PLY_TYPES.items()}
                case ["element", name, count] if int(count) >= 0:
                    elements.append((name, int(count), []))
                case ["property", "list", size, kind, name]:
                    elements[-1][2].append((name, types[kind], types[size]))
                case ["property", kind, name]:
                    elements[-1][2].append((name, types[kind], None))
                case ["comment" | "obj_info", *_] | []:
                    pass
                case _:
                    raise ValueError
        except (KeyError, IndexError, ValueError):
            raise ValueError(f"line {number}: {line[:60]!r} is no line of a PLY header") from None
    return form, elements


def _ply_runs(body, at, count, properties):
    """The rows of an element as structured arrays, one a run of equally long lists, and the end."""
    runs, most = [], 1  # rows to look at: 1, 2, 4, ..., while lists are as long as in the first
    while count and properties:
        fields, counts = [], []
        for name, kind, size in properties:
            length = 1
            if size:
                length = int(np.frombuffer(body, size, 1, at + np.dtype(fields).itemsize)[0])
                counts.append(f"count of {name}")
                fields.append((counts[-1], size))
            fields.append((name, kind, (length,)))
        fitting = max(1, (len(body) - at) // np.dtype(fields).itemsize)
        rows = np.frombuffer(body, fields, min(count, most, fitting), at)
        if not all((rows[name] == rows[name][0]).all() for name in counts):
            rows, most = rows[:1], 0
        runs.append(rows)
        at, count, most = at + rows.nbytes, count - len(rows), 2 * most or 1
    return runs, at


def write_ply(path: Path, V: np.ndarray, Q: np.ndarray, polygons: list, curves: dict) -> None:
    """Write a binary PLY file, coordinates as `double`; it has no place for curves here."""
    size = "uchar" if all(len(polygon) < 256 for polygon in polygons) else "int"
    head = "ply\nformat binary_little_endian 1.0\n"
    head += f"comment {CUT} {len(polygons)}\n" if polygons else ""
    head += f"element vertex {len(V)}\n"
    head += "".join(f"property double {x}\n" for x in "xyz")
    head += f"element face {len(Q) + len(polygons)}\n"
    head += f"property list {size} int vertex_indices\nend_header\n"
    kind = "<" + PLY_TYPES[size]
    rows = np.empty(len(Q), dtype=[("count", kind), ("corners", "<i4", Q.shape[1:])])
    rows["count"], rows["corners"] = Q.shape[1], Q
    more = [np.array(len(p), kind).tobytes() + p.astype("<i4").tobytes() for p in polygons]
    body = [V.astype("<f8").tobytes(), rows.tobytes(), *more]
    path.write_bytes(head.encode() + b"".join(body))


def read_stl(path: Path) -> tuple[np.ndarray, np.ndarray | list]:
    """Corners (3 f, 3) of all triangles of an STL file, and the triangles (f, 3) themselves."""
    data = path.read_bytes()
    count = int.from_bytes(data[80:84], "little")
    if len(data) == 84 + 50 * count:
        rows = np.frombuffer(data, [("floats", "<f4", (4, 3)), ("other", "<u2")], count, 84)
        corners = rows["floats"][:, 1:].astype(np.float64)
    elif (corners := _stl_payload(data, count)) is not None:
        pass
    elif data.lstrip()[:5].lower() == b"solid" and b"\0" not in data:
        corners = _stl_text(decoded(data).lower().splitlines())
    else:
        size = f"{len(data)} bytes, and a binary file of {count} triangles has {84 + 50 * count}"
        raise ValueError(f"no STL file, or a broken one: {size}")
    return corners.reshape(-1, 3), np.arange(corners.size // 3).reshape(-1, 3)


def write_stl(path: Path, V: np.ndarray, Q: np.ndarray, polygons: list, curves: dict) -> None:
    """Write a binary STL file of triangles, float32; it has no place for curves."""
    corners = V[triangulate(V, [*Q, *polygons])]
    size = np.ptp(V, axis=0).max()
    if np.spacing(np.float32(np.abs(V).max())) > 1e-5 * size:
        raise ValueError("too far from the origin for the float32 of STL: write .obj or .ply")
    normal = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    normal /= np.linalg.norm(normal, axis=1, keepdims=True)
    rows = np.zeros(len(corners), dtype=[("floats", "<f4", (4, 3)), ("other", "<u2")])
    rows["floats"][:, 0], rows["floats"][:, 1:] = normal, corners
    path.write_bytes(bytes(80) + np.uint32(len(rows)).tobytes() + rows.tobytes())


def _stl_payload(data, count):
    """The corners in a binary STL file with data of their own behind the triangles, or None."""
    at, found = 84, []
    while len(found) < count and at + 50 <= len(data):
        found.append(np.frombuffer(data, "<f4", 9, at + 12))
        at += 50 + int.from_bytes(data[at + 48 : at + 50], "little")
    if len(found) == count and at == len(data):
        return np.array(found, dtype=np.float64)
    return None


def _stl_text(lines):
    rows = [line.split() for line in lines]
    with suppress(ValueError):
        points = np.array([row[1:4] for row in rows if row[:1] == ["vertex"]], dtype=np.float64)
        if any("".join(row).startswith("endsolid") for row in rows):
            return points.reshape(-1, 3, 3)
    raise ValueError("the STL text ends early or has a vertex without three coordinates")
