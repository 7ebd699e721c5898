"""OBJ and OFF: meshes as lines of text, read strictly and written with every digit.

Readers return points and faces (lists, counted from 0); their ValueErrors name the line.
"""

from pathlib import Path

# --- OBJ ----------------------------------------------------------------------------------


def read_obj(path):
    """Points (n lists of 3) and faces (lists of indices) of a Wavefront OBJ file.

    Understands v/vt/vn corners, indices from the end (negative) and continued lines; colours
    behind the coordinates, textures, normals, lines and groups are passed over.
    """
    points, faces, lines = [], [], []
    for number, words in _rows(path):
        if words[0] == "v":
            points.append(_point(words[1:], number))
        elif words[0] == "f":
            faces.append(_obj_face(words[1:], len(points), number))
            lines.append(number)
        elif not words[0][0].isalpha():
            raise ValueError(f"line {number}: {words[0][:40]!r} is no OBJ keyword")
    for number, face in zip(lines, faces, strict=True):
        if max(face) >= len(points):
            raise ValueError(
                f"line {number}: there is no vertex {max(face) + 1}, only {len(points)}"
            )
    return points, faces


def _obj_face(words, count, number):
    try:
        given = [int(word.partition("/")[0]) for word in words]
    except ValueError:
        raise ValueError(f"line {number}: {' '.join(words)[:60]!r} is no face") from None
    face = [k - 1 if k > 0 else count + k for k in given]
    if 0 in given or min(face, default=0) < 0:
        raise ValueError(f"line {number}: vertex {min(given)} of {count}: OBJ counts from 1")
    return _long_enough(face, number)


def write_obj(path, V, Q, polygons, curves):
    """Write an OBJ file: the group `panels`, and each family of curves as a group of `l` lines."""
    with open(path, "w", encoding="utf-8", newline="\n") as out:
        out.writelines(f"v {x!r} {y!r} {z!r}\n" for x, y, z in V.tolist())
        out.write("g panels\n")
        out.writelines(_obj_line("f", face) for face in [*Q, *polygons])
        for name, family in curves.items():
            out.write(f"g {name}\n")
            out.writelines(_obj_line("l", curve) for curve in family)


def _obj_line(key, indices):
    return f"{key} {' '.join(str(k) for k in (indices + 1).tolist())}\n"


# --- OFF ----------------------------------------------------------------------------------


def read_off(path):
    """Points (n lists of 3) and faces of an OFF file; colours are passed over."""
    rows = list(_rows(path))
    number, first = rows[0] if rows else (1, [""])
    kind = first[0].upper()
    if not kind.endswith("OFF") or not set(kind[:-3]) <= set("STCN") or "BINARY" in first:
        raise ValueError(f"line {number}: a text OFF file starts with OFF, not {first[0][:40]!r}")
    rows = [(number, first[1:])] * (len(first) > 1) + rows[1:]  # the counts may follow OFF
    try:
        number, words = rows[0]
        vertices, faces = (int(word) for word in words[:2])
    except (IndexError, ValueError):
        raise ValueError(f"line {number}: the numbers of vertices and faces are missing") from None
    if min(vertices, faces) < 0 or len(rows) < 1 + vertices + faces:
        raise ValueError(
            f"the file ends early: it promises {vertices} vertices and {faces} faces, "
            f"and has {len(rows) - 1} lines for them"
        )
    points = [_point(words, number) for number, words in rows[1 : vertices + 1]]
    body = rows[vertices + 1 : vertices + faces + 1]
    return points, [_off_face(words, vertices, number) for number, words in body]


def _off_face(words, count, number):
    try:
        size = int(words[0])
        face = [int(word) for word in words[1 : size + 1]]
    except ValueError:
        raise ValueError(f"line {number}: {' '.join(words)[:60]!r} is no face") from None
    if len(face) != size:
        raise ValueError(f"line {number}: a face of {size} corners has only {len(face)} of them")
    if face and not 0 <= min(face) <= max(face) < count:
        bad = max(face) if min(face) >= 0 else min(face)
        raise ValueError(f"line {number}: there is no vertex {bad}, only 0 to {count - 1}")
    return _long_enough(face, number)


def write_off(path, V, Q, polygons, curves):
    """Write an OFF file; it has no place for curves."""
    faces = [*Q.tolist(), *(polygon.tolist() for polygon in polygons)]
    with open(path, "w", encoding="utf-8", newline="\n") as out:
        out.write(f"OFF\n{len(V)} {len(faces)} 0\n")
        out.writelines(f"{x!r} {y!r} {z!r}\n" for x, y, z in V.tolist())
        out.writelines(f"{len(face)} {' '.join(map(str, face))}\n" for face in faces)


# --- lines --------------------------------------------------------------------------------


def text(data):
    """The bytes of a text file as a string; ValueError when they are something else."""
    if b"\0" in data:
        raise ValueError("the file is binary, not text: does its suffix fit?")
    return data.decode("utf-8-sig", errors="replace")  # names and comments may be anything


def _rows(path):
    """(line number, words) of every line that says something; `\\` at an end continues a line."""
    held = []
    for number, line in enumerate(text(Path(path).read_bytes()).splitlines(), 1):
        words = held + line.partition("#")[0].split()
        if words and words[-1].endswith("\\"):
            held = words[:-1] + [word for word in [words[-1][:-1]] if word]
            continue
        held = []
        if words:
            yield number, words


def _point(words, number):
    try:
        point = [float(word) for word in words[:3]]
    except ValueError:
        point = []
    if len(point) != 3:
        raise ValueError(f"line {number}: {' '.join(words)[:60]!r} are no three coordinates")
    return point


def _long_enough(face, number):
    if len(face) < 3:
        raise ValueError(f"line {number}: a face needs three corners, this one has {len(face)}")
    return face
