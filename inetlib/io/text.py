"""OBJ and OFF: meshes as lines of text, read strictly and written with every digit.

Readers return points and faces as lists, counted from 0, and the numbers of the faces that are
noted as cut panels; their ValueErrors name the line."""

import re
from contextlib import suppress
from pathlib import Path

import numpy as np

CUT = "panels_cut"  # the name of the panels that are no whole quads, in all formats


def decoded(data: bytes) -> str:
    """The bytes of a text file as a string; ValueError when they are something else."""
    if data[:2] in (b"\xff\xfe", b"\xfe\xff"):
        raise ValueError("the text is UTF-16: save it as UTF-8")
    if b"\0" in data:
        raise ValueError("the file is binary, not text: does its suffix fit?")
    return data.decode("utf-8-sig", errors="replace")  # names and comments may be anything


def _rows(path):
    """(line number, words) of every line that says something; `\\` at an end continues a line."""
    held = []
    for number, line in enumerate(decoded(path.read_bytes()).splitlines(), 1):
        words = held + line.partition("#")[0].split()
        held = []
        if words and words[-1].endswith("\\"):
            held = words[:-1] + words[-1][:-1].split()
        elif words:
            yield number, words


def _numbers(kind, words, count, number, what):
    """The `count` numbers that a line begins with; ValueError that it is no such `what`."""
    try:
        found = [kind(word) for word in words[:count]]
    except ValueError:
        found = []
    if len(found) != count:
        raise ValueError(f"line {number}: {' '.join(words)[:60]!r} is no {what}")
    return found


def _check_face(face, given, count, first, number):
    """ValueError for corners, `given` as the line counts them from `first`, that make no face."""
    if len(face) < 3:
        raise ValueError(f"line {number}: a face needs three corners, this one has {len(face)}")
    if not 0 <= min(face) <= max(face) < count:
        bad = next(word for k, word in zip(face, given, strict=True) if not 0 <= k < count)
        last = count - 1 + first
        raise ValueError(f"line {number}: there is no vertex {bad}, only {first} to {last}")


def cut_mark(text: str) -> int:
    """How many of the last faces a header or a comment notes as cut panels: `panels_cut 12`."""
    found = re.search(rf"^(?:#|comment) {CUT} (\d{{1,9}})\s*$", text, re.MULTILINE)
    return int(found[1]) if found else 0


def read_obj(path: Path) -> tuple[list, list, list]:
    """Points (n lists of 3), faces (lists of indices) and cut panels of an OBJ file, no more."""
    points, faces, lines, cut, group = [], [], [], [], []
    for number, words in _rows(path):
        if words[0] == "v":
            points.append(_numbers(float, words[1:], 3, number, "point of three coordinates"))
        elif words[0] == "f":
            corners = [word.partition("/")[0] for word in words[1:]]
            given = _numbers(int, corners, len(corners), number, "face")
            faces.append([k - 1 if k >= 0 else len(points) + k for k in given])
            lines.append((number, given))
            cut += [len(lines) - 1] * (group == [CUT])
        elif words[0] in ("g", "o"):
            group = words[1:]
        elif words[0] in ("surf", "curv", "curv2"):
            raise ValueError(f"line {number}: a free-form surface, no mesh: export it as a mesh")
        elif not words[0][0].isalpha():
            raise ValueError(f"line {number}: {words[0][:40]!r} is no OBJ keyword")
    for face, (number, given) in zip(faces, lines, strict=True):  # vertices may come later
        _check_face(face, given, len(points), 1, number)
    return points, faces, cut


def read_off(path: Path) -> tuple[list, list, range]:
    """Points (n lists of 3), faces (lists of indices) and cut panels of an OFF file; no colours."""
    rows = [*_rows(path)] or [(1, [""])]
    number, (kind, *words) = rows[0]
    if not re.fullmatch("[STCN]*OFF", kind.upper()) or "BINARY" in words:
        raise ValueError(f"line {number}: a text OFF file starts with OFF, not {kind[:40]!r}")
    rows = [(number, words)] * bool(words) + rows[1:]  # the counts may follow OFF
    points, faces = _off_of_any_lines(rows)
    whole = max(len(faces) - cut_mark(decoded(path.read_bytes())), 0)
    return points, faces, range(whole, len(faces))


def _off_of_any_lines(rows):
    try:
        return _off(rows)
    except ValueError:
        every = [(number, word) for number, words in rows for word in words]
        with suppress(ValueError):
            return _off(_off_rows(every))
        raise


def _off(rows):
    """Points and faces of the rows of an OFF file behind its first word."""
    number, words = rows[0] if rows else (1, [])
    most = _numbers(int, words, 2, number, "pair of numbers, of vertices and faces")
    if min(most) < 0 or len(rows) < 1 + sum(most):
        words = f"{most} vertices and faces are promised, and there are {len(rows) - 1} lines"
        raise ValueError(f"the file ends early: {words} for them")
    points, faces = [], []
    for number, words in rows[1 : 1 + most[0]]:
        points.append(_numbers(float, words, 3, number, "point of three coordinates"))
    for number, words in rows[1 + most[0] : 1 + sum(most)]:
        size = _numbers(int, words, 1, number, "face")[0]
        faces.append(_numbers(int, words[1:], size, number, f"face of {size} corners"))
        _check_face(faces[-1], faces[-1], len(points), 0, number)
    return points, faces


def _off_rows(every):
    """Rows for `_off` of (line number, word) pairs: the counts, points, and faces, without more."""
    rows, at = [], 0
    most = [int(word) for _, word in every[:2]]
    if len(most) < 2 or min(most) < 0 or sum(most) > len(every):
        raise ValueError
    for number in range(1 + sum(most)):
        face = number > most[0] and at < len(every)
        size = 1 + int(every[at][1]) if face else 3
        if not 0 < size <= len(every) - at:
            raise ValueError
        number, words = zip(*every[at : at + size], strict=True)
        rows.append((number[0], list(words)))
        at += size
    if at != len(every):
        raise ValueError
    return rows


def write_obj(path: Path, V: np.ndarray, Q: np.ndarray, polygons: list, curves: dict) -> None:
    """Write an OBJ file: groups `panels`, `panels_cut`, and of `l` lines each family of curves."""
    with open(path, "w", encoding="utf-8", newline="\n") as out:
        out.writelines(f"v {x!r} {y!r} {z!r}\n" for x, y, z in V.tolist())
        faces = {"panels": Q} | ({CUT: polygons} if polygons else {})
        for name, lists in {**faces, **curves}.items():
            out.write(f"g {name}\n")
            key = "f" if name in faces else "l"
            out.writelines(f"{key} {_words(indices + 1)}\n" for indices in lists)


def write_off(path: Path, V: np.ndarray, Q: np.ndarray, polygons: list, curves: dict) -> None:
    """Write an OFF file; it has no place for curves."""
    faces = [*Q, *polygons]
    with open(path, "w", encoding="utf-8", newline="\n") as out:
        out.write("OFF\n" + (f"# {CUT} {len(polygons)}\n" if polygons else ""))
        out.write(f"{len(V)} {len(faces)} 0\n")
        out.writelines(f"{x!r} {y!r} {z!r}\n" for x, y, z in V.tolist())
        out.writelines(f"{len(face)} {_words(face)}\n" for face in faces)


def _words(indices):
    return " ".join(map(str, indices.tolist()))
