"""GLB (binary glTF 2.0), float32 by the format.

Read here and not by VTK, whose reader ends the process on some broken files."""

import json
import struct
from itertools import pairwise
from pathlib import Path

import numpy as np

TYPES = {5121: "u1", 5123: "<u2", 5125: "<u4", 5126: "<f4"}
Y_UP = np.array([[1.0, 0, 0], [0, 0, 1], [0, -1, 0]])  # x y z -> x z -y


def read_glb(path: Path) -> tuple[np.ndarray, np.ndarray]:
    """Points (n, 3) and triangles (f, 3) of all meshes of a GLB scene.

    glTF has y upwards: (x, y, z) is returned as (x, -z, y).  Lines and points are passed over."""
    data = path.read_bytes()
    if data[:4] != b"glTF" or int.from_bytes(data[8:12], "little") != len(data):
        raise ValueError("no GLB file (binary glTF), or a broken one")
    try:
        length = int.from_bytes(data[12:16], "little")
        scene = json.loads(data[20 : 20 + length])
        if needed := scene.get("extensionsRequired"):
            raise ValueError(f"it needs the extensions {needed}, which are not known here")
        parts = [*_parts(scene, data[28 + length :], _roots(scene), np.eye(4))]
    except (KeyError, IndexError, TypeError, ValueError, RecursionError) as error:
        raise ValueError(f"the GLB file is broken ({type(error).__name__}: {error})") from error
    if not parts:
        raise ValueError("the file has no faces")
    points, faces = zip(*parts, strict=True)
    shifts = np.cumsum([0, *map(len, points[:-1])])
    return np.concatenate(points) @ Y_UP, np.concatenate([*map(np.add, faces, shifts)])


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
            if part.get("mode", 4) > 4:
                raise ValueError("it holds strips or fans of triangles")
            if part.get("mode", 4) == 4:
                points = _array(scene, data, part["attributes"]["POSITION"], 3)
                corners = np.arange(len(points))
                if "indices" in part:
                    corners = _array(scene, data, part["indices"], 1).astype(np.int64)
                if corners.max(initial=-1) >= len(points):
                    raise ValueError(f"there is no vertex {corners.max()}, only {len(points)}")
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


def _array(scene, data, number, width):
    accessor = scene["accessors"][number]
    if "sparse" in accessor:
        raise ValueError("it has sparse accessors, which are not known here")
    view = scene["bufferViews"][accessor["bufferView"]]
    kind = np.dtype(TYPES[accessor["componentType"]])
    start = view.get("byteOffset", 0) + accessor.get("byteOffset", 0)
    strides = view.get("byteStride", width * kind.itemsize), kind.itemsize
    return np.ndarray((accessor["count"], width), kind, data, start, strides)


def write_glb(path: Path, V: np.ndarray, Q: np.ndarray, polygons: list, curves: dict) -> None:
    """Write a GLB scene: a mesh `panels` of triangles, one of lines a family; y is upwards."""
    from ..plot import COLOURS, PALE
    from ..repair import triangulate

    cells = {"panels": triangulate(V, [*Q, *polygons])}
    for name, family in curves.items():
        cells[name] = np.concatenate([np.stack([c[:-1], c[1:]], axis=1) for c in family])
    points = (V @ Y_UP.T).astype("<f4")
    blocks = [points, *(ends.astype("<u4") for ends in cells.values())]
    starts = np.cumsum([0] + [block.nbytes for block in blocks]).tolist()
    low, high = points.min(axis=0).tolist(), points.max(axis=0).tolist()
    kinds = [{"componentType": 5126, "type": "VEC3", "count": len(V), "min": low, "max": high}]
    kinds += [{"componentType": 5125, "type": "SCALAR", "count": b.size} for b in blocks[1:]]
    scene = {
        "asset": {"version": "2.0", "generator": "inetlib"},
        "scene": 0,
        "scenes": [{"nodes": list(range(len(cells)))}],
        "nodes": [{"mesh": k, "name": name} for k, name in enumerate(cells)],
        "meshes": [_mesh(k, name) for k, name in enumerate(cells)],
        "materials": [_material(name, (COLOURS | {"panels": PALE})[name]) for name in cells],
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
    part = {"attributes": {"POSITION": 0}, "indices": k + 1, "material": k, "mode": 1 if k else 4}
    return {"name": name, "primitives": [part]}


def _material(name, colour):
    srgb = np.array(list(bytes.fromhex(colour[1:]))) / 255
    linear = [*(srgb**2.2).round(4).tolist(), 1.0]
    look = {"baseColorFactor": linear, "metallicFactor": 0.0, "roughnessFactor": 1.0}
    return {"name": name, "doubleSided": True, "pbrMetallicRoughness": look}
