"""GLB and glTF 2.0, float32 by the format.

Read here and not by VTK, whose reader ends the process on some broken files."""

import base64
import json
import struct
from itertools import pairwise
from pathlib import Path
from urllib.parse import unquote

import numpy as np

from .text import CUT

TYPES = {5121: "u1", 5123: "<u2", 5125: "<u4", 5126: "<f4"}
MOST = 50_000_000  # entries of an accessor
Y_UP = np.array([[1.0, 0, 0], [0, 0, 1], [0, -1, 0]])  # x y z -> x z -y


def read_glb(path: Path) -> tuple[np.ndarray, np.ndarray]:
    """Points (n, 3) and triangles (f, 3) of all meshes of a GLB or glTF scene.

    glTF has y upwards: (x, y, z) is returned as (x, -z, y).  Lines and points are passed over."""
    data = path.read_bytes()
    try:
        if path.suffix.lower() == ".gltf":
            scene = json.loads(data)
            buffers = [_buffer(path, one["uri"]) for one in scene.get("buffers", [])]
        elif data[:4] != b"glTF" or int.from_bytes(data[8:12], "little") != len(data):
            raise ValueError("it does not begin as one, or ends early")
        else:
            length = int.from_bytes(data[12:16], "little")
            scene, buffers = json.loads(data[20 : 20 + length]), [data[28 + length :]]
        if needed := scene.get("extensionsRequired"):
            words = "not known here: export it without compression"
            raise ValueError(f"it needs the extensions {', '.join(needed)}, {words}")
        parts = [*_parts(scene, buffers, _roots(scene), np.eye(4))]
    except (LookupError, TypeError, ValueError, RecursionError, MemoryError) as error:
        words = f"it has no {error}" if isinstance(error, KeyError) else error
        raise ValueError(f"no glTF file, or a broken one ({words})") from error
    if not parts:
        raise ValueError("the file has no faces: export a mesh, not points or curves")
    points, faces = zip(*parts, strict=True)
    shifts = np.cumsum([0, *map(len, points[:-1])])
    return np.concatenate(points) @ Y_UP, np.concatenate([*map(np.add, faces, shifts)])


def _buffer(path, uri):
    """The bytes of a buffer, in the glTF file itself or in a file beside it."""
    if uri.startswith("data:"):
        return base64.b64decode(uri.partition(",")[2])
    beside = path.parent / Path(unquote(uri)).name
    if not beside.is_file():
        raise ValueError(f"its file {beside.name} is not beside it")
    return beside.read_bytes()


def _roots(scene):
    """The nodes that the scene begins with: without a scene all that are no children."""
    if "scenes" in scene:
        return scene["scenes"][scene.get("scene", 0)]["nodes"]
    children = {child for node in scene["nodes"] for child in node.get("children", [])}
    return [k for k in range(len(scene["nodes"])) if k not in children]


def _parts(scene, data, nodes, above):
    """(points, triangles) of every primitive below the nodes, moved to where the scene has it."""
    for node in (scene["nodes"][k] for k in nodes):
        place = above @ _matrix(node)
        for part in scene["meshes"][node["mesh"]]["primitives"] if "mesh" in node else ():
            mode = part.get("mode", 4)
            if mode >= 4:
                points = _array(scene, data, part["attributes"]["POSITION"], 3)
                corners = np.arange(len(points))
                if "indices" in part:
                    corners = _array(scene, data, part["indices"], 1).astype(np.int64).ravel()
                if corners.max(initial=-1) >= len(points):
                    raise ValueError(f"there is no vertex {corners.max()}, only {len(points)}")
                if mode > 4:
                    corners = _unrolled(corners, fan=mode == 6)
                yield points @ place[:3, :3].T + place[:3, 3], corners.reshape(-1, 3)
        yield from _parts(scene, data, node.get("children", []), place)


def _matrix(node):
    if "matrix" in node:
        return np.array(node["matrix"], dtype=float).reshape(4, 4).T
    x, y, z, w = node.get("rotation", (0, 0, 0, 1))
    K = np.array([[0, -z, y], [z, 0, -x], [-y, x, 0]])
    M = np.eye(4)
    M[:3, :3] = (np.eye(3) + 2 * w * K + 2 * K @ K) * np.array(node.get("scale", (1, 1, 1)))
    M[:3, 3] = node.get("translation", (0, 0, 0))
    return M


def _unrolled(corners, fan):
    """The triangles of a fan, or of a strip, in which every second one is turned round."""
    one, two, three = corners[:-2], corners[1:-1], corners[2:]
    if fan:
        return np.stack([np.full_like(two, corners[0]), two, three], axis=1)
    odd = np.arange(len(three)) % 2 == 1
    return np.stack([np.where(odd, two, one), np.where(odd, one, two), three], axis=1)


def _array(scene, data, number, width):
    accessor = scene["accessors"][number]
    if not 0 <= accessor["count"] <= MOST:
        raise ValueError(f"it promises {accessor['count']} numbers")
    found = np.zeros((accessor["count"], width), TYPES[accessor["componentType"]])
    if "bufferView" in accessor:
        found[:] = _block(scene, data, accessor, accessor["componentType"], found.shape)
    if (sparse := accessor.get("sparse")) is not None:
        kind, count = sparse["indices"]["componentType"], sparse["count"]
        at = _block(scene, data, sparse["indices"], kind, (count, 1)).ravel()
        found[at] = _block(scene, data, sparse["values"], accessor["componentType"], (count, width))
    return found


def _block(scene, data, where, kind, shape):
    """The numbers of a buffer view of the file, from a place in it on."""
    view, kind = scene["bufferViews"][where["bufferView"]], np.dtype(TYPES[kind])
    start = view.get("byteOffset", 0) + where.get("byteOffset", 0)
    strides = view.get("byteStride", shape[1] * kind.itemsize), kind.itemsize
    return np.ndarray(shape, kind, data[view.get("buffer", 0)], start, strides)


def write_glb(path: Path, V: np.ndarray, Q: np.ndarray, polygons: list, curves: dict) -> None:
    """Write a GLB scene: meshes `panels` and, of polygons, `panels_cut`, of triangles, and one of
    lines a family; y is upwards."""
    from ..plot import COLOURS, PALE
    from ..repair import triangulate

    cells = {"panels": triangulate(V, Q)}
    if polygons:
        cells[CUT] = triangulate(V, polygons)
    for name, family in curves.items():
        cells[name] = np.concatenate([np.stack([c[:-1], c[1:]], axis=1) for c in family])
    middle = (V.min(axis=0) + V.max(axis=0)) / 2  # float32 has no digits to spare far away
    points = ((V - middle) @ Y_UP.T).astype("<f4")
    place = {"translation": (Y_UP @ middle).tolist()}
    blocks = [points, *(ends.astype("<u4") for ends in cells.values())]
    starts = np.cumsum([0] + [block.nbytes for block in blocks]).tolist()
    low, high = points.min(axis=0).tolist(), points.max(axis=0).tolist()
    kinds = [{"componentType": 5126, "type": "VEC3", "count": len(V), "min": low, "max": high}]
    kinds += [{"componentType": 5125, "type": "SCALAR", "count": b.size} for b in blocks[1:]]
    scene = {
        "asset": {"version": "2.0", "generator": "inetlib"},
        "scene": 0,
        "scenes": [{"nodes": list(range(len(cells)))}],
        "nodes": [{"mesh": k, "name": name} | place for k, name in enumerate(cells)],
        "meshes": [_mesh(k, name) for k, name in enumerate(cells)],
        "materials": [_material(name, COLOURS.get(name, PALE)) for name in cells],
        "accessors": [kind | {"bufferView": k} for k, kind in enumerate(kinds)],
        "bufferViews": [
            {"buffer": 0, "byteOffset": a, "byteLength": b - a} for a, b in pairwise(starts)
        ],
        "buffers": [{"byteLength": starts[-1]}],
    }
    words = json.dumps(scene).encode()
    words += b" " * (-len(words) % 4)
    head = struct.pack("<4s3I4s", b"glTF", 2, 28 + len(words) + starts[-1], len(words), b"JSON")
    body = [struct.pack("<I4s", starts[-1], b"BIN\0"), *(block.tobytes() for block in blocks)]
    path.write_bytes(b"".join([head, words, *body]))


def _mesh(k, name):
    part = {"attributes": {"POSITION": 0}, "indices": k + 1, "material": k}
    part["mode"] = 4 if name in ("panels", CUT) else 1
    return {"name": name, "primitives": [part]}


def _material(name, colour):
    srgb = np.array(list(bytes.fromhex(colour[1:]))) / 255
    linear = [*(srgb**2.2).round(4).tolist(), 1.0]
    look = {"baseColorFactor": linear, "metallicFactor": 0.0, "roughnessFactor": 1.0}
    return {"name": name, "doubleSided": True, "pbrMetallicRoughness": look}
