"""The tables of `inet schedule`, against numpy and libigl on the tables' own nodes; bad input."""

import csv
import json
import math
from collections import Counter
from itertools import pairwise
from pathlib import Path

import igl
import numpy as np
import pytest
from test_cli import inet, numbers, refused  # noqa: F401
from test_ties import noisy

from inetlib import design, examples, io, loxodrome, mesh, panels, schedule, surfaces

NAMES = "panels.csv", "panels_nodes.csv", "panels_bars.csv"


def clipped(corners, a, b, c):
    """The part of a convex polygon in the plane where a x + b y <= c."""
    kept = []
    for p, q in pairwise([*corners, corners[0]]):
        at, then = (a * r[0] + b * r[1] - c for r in (p, q))
        kept += [p] if at <= 0 else []
        if at * then < 0:
            kept.append(p + (q - p) * at / (at - then))
    return kept


def trimmed(height=lambda x, y: 0 * x, count=9):
    """(V, Q, polygons): a sheared grid cut along a straight line, its quads u = x, v upwards."""
    places, quads, polygons = {}, [], []
    for i in range(count):
        for j in range(count):
            cell = np.array([[i, j + 1], [i, j], [i + 1, j], [i + 1, j + 1]]) @ [[1, 0], [0.3, 0.8]]
            part = clipped([*cell], 0.8, 1.1, 9.13)
            face = [places.setdefault(tuple(np.round(p, 9)), len(places)) for p in part]
            if len(part) == 4 and np.allclose(part, cell):
                quads.append(face)
            elif part:
                polygons.append(np.array(face))
    x, y = np.array([*places]).T
    return np.stack([x, y, height(x, y)], axis=1), np.array(quads), polygons


def wave(x, y):
    return 0.3 * np.sin(0.7 * x) * np.cos(0.5 * y)


def tables(folder, found):
    """The rows of the three tables, dicts, written to a folder."""
    return [read(path) for path in schedule.write(Path(folder) / NAMES[0], found)]


def read(path):
    with open(path, encoding="utf-8", newline="") as file:
        return list(csv.DictReader(file))


def cells(row, name, kind=float):
    """The numbers of the columns name1, name2, ... that are not empty."""
    found = (row.get(f"{name}{k}", "") for k in range(1, 7))
    return [kind(x) for x in found if x]


def test_lengths_areas_and_angles_are_those_of_the_nodes(tmp_path):
    V, Q, polygons = trimmed(wave)
    found, nodes, bars = tables(tmp_path, schedule.schedule(V, Q, polygons))
    P = np.array([[float(row[x]) for x in "xyz"] for row in nodes])
    assert np.abs(P - V).max() < 1e-8
    assert [int(row["node"]) for row in nodes] == [*range(1, len(V) + 1)]
    assert Counter(row["kind"] for row in found) == {"whole": len(Q), "cut": len(polygons)}
    assert {len(p) for p in polygons} == {3, 4, 5}
    for row, face in zip(found, [*Q, *polygons], strict=True):
        corners = np.array(cells(row, "node", int)) - 1
        assert corners.tolist() == face.tolist()
        C = P[corners]
        edges = np.roll(C, -1, axis=0) - C
        assert np.allclose(cells(row, "edge"), np.sqrt((edges**2).sum(axis=1)), atol=2e-8)
        shadow = sum(np.cross(C[k] - C[0], C[k + 1] - C[0]) for k in range(1, len(C) - 1)) / 2
        assert float(row["area"]) == pytest.approx(math.sqrt(shadow @ shadow), rel=1e-6)
        flat = (C - C.mean(axis=0)) @ shadow / np.linalg.norm(shadow)
        assert float(row["planarity"]) == pytest.approx(np.ptp(flat), abs=2e-8)
        cosines = -np.sum(edges * np.roll(edges, 1, axis=0), axis=1)
        cosines /= np.linalg.norm(edges, axis=1) * np.linalg.norm(np.roll(edges, 1, axis=0), axis=1)
        assert np.allclose(cells(row, "angle"), np.degrees(np.arccos(cosines)), atol=1e-5)
        if row["kind"] == "whole":
            v1, v2, v3, v4 = C
            cosine = (v3 - v1) @ (v4 - v2) / np.linalg.norm(v3 - v1) / np.linalg.norm(v4 - v2)
            assert float(row["theta"]) == pytest.approx(np.degrees(np.arccos(cosine)), abs=1e-5)
        else:
            assert row["theta"] == row["theta0"] == ""
    for row in bars:
        a, b = P[int(row["node1"]) - 1], P[int(row["node2"]) - 1]
        assert float(row["length"]) == pytest.approx(math.dist(a, b), abs=2e-8)


def test_areas_of_a_plane_net_are_those_of_libigl_and_fill_the_outline(tmp_path):
    V, Q, polygons = trimmed()
    found, *_ = tables(tmp_path, schedule.schedule(V, Q, polygons))
    for row in found:
        corners = np.array(cells(row, "node", int)) - 1
        fan = np.array([[corners[0], a, b] for a, b in pairwise(corners[1:])])
        assert float(row["area"]) == pytest.approx(igl.doublearea(V, fan).sum() / 2, rel=1e-9)
    outline = [np.array(p) for p in ([0, 0], [9, 0], [9 + 0.3 * 9, 0.8 * 9], [0.3 * 9, 0.8 * 9])]
    x, y = np.array(clipped(outline, 0.8, 1.1, 9.13)).T
    whole = (x * np.roll(y, -1) - y * np.roll(x, -1)).sum() / 2
    assert sum(float(row["area"]) for row in found) == pytest.approx(whole, rel=1e-9)
    assert all(float(row["planarity"]) == 0 for row in found)
    assert "-0.0" not in (tmp_path / NAMES[0]).read_text()


def test_neighbours_bars_and_families_agree(tmp_path):
    V, Q, polygons = trimmed(wave)
    found, nodes, bars = tables(tmp_path, schedule.schedule(V, Q, polygons))
    around = {}  # the panels at each pair of nodes
    for row in found:
        corners = cells(row, "node", int)
        for side in map(frozenset, zip(corners, corners[1:] + corners[:1], strict=True)):
            around.setdefault(side, []).append(row["panel"])
    for row in found:
        corners = cells(row, "node", int)
        for k, side in enumerate(zip(corners, corners[1:] + corners[:1], strict=True), 1):
            others = [x for x in around[frozenset(side)] if x != row["panel"]]
            assert row[f"neighbour{k}"] == "".join(others)
    assert len(bars) == len(around)
    degree, rim = Counter(), set()
    for row in bars:
        ends = row["node1"], row["node2"]
        degree.update(ends)
        sides = around[frozenset(map(int, ends))]
        assert [x for x in (row["panel1"], row["panel2"]) if x] == sides
        rim.update(ends if len(sides) == 1 else ())
        a, b = (V[int(x) - 1, :2] for x in ends)
        along = "u" if abs(b[1] - a[1]) < 1e-9 else "v"
        cut = min(map(int, sides)) > len(Q)
        if not cut or not {*ends} <= rim | {k["node"] for k in nodes if k["boundary"] == "yes"}:
            assert row["family"] == along
        else:
            assert row["family"] == "edge"
    assert {row["node"] for row in nodes if row["boundary"] == "yes"} == rim
    assert {row["node"]: int(row["valence"]) for row in nodes} == degree
    assert Counter(row["family"] for row in bars).keys() == {"u", "v", "edge"}


def types(V, faces, tolerance=1e-3):
    return panels.types(np.asarray(V, dtype=float), faces, tolerance).tolist()


def placed(*quads):
    """The corners of some quads and where they stand, each somewhere else in space."""
    rng = np.random.default_rng(4)
    turns = [np.linalg.qr(rng.normal(size=(3, 3)))[0] for _ in quads]
    turns = [turn * np.linalg.det(turn) for turn in turns]  # no reflections
    V = [np.array(P) @ R + rng.normal(size=3) for P, R in zip(quads, turns, strict=True)]
    return np.concatenate(V), np.arange(4 * len(quads)).reshape(-1, 4)


KITE = np.array([[0, 0, 0], [3, 0, 0], [4, 2, 0], [0, 1, 0.0]])
BENT = KITE + np.outer([1, 0, 1, 0], [0, 0, 0.1])


def test_a_type_does_not_see_where_a_panel_is_nor_its_first_corner_but_a_mirror_image():
    turned = np.roll(KITE, 1, axis=0)
    mirrored = KITE[::-1] * [-1, 1, 1]
    assert types(*placed(KITE, turned, mirrored, KITE, turned, mirrored)) == [0, 0, 1, 0, 0, 1]
    up, down = BENT, BENT * [1, 1, -1]  # lengths of edges and diagonals agree
    assert types(*placed(up, down, np.roll(up, 2, axis=0), KITE)) == [0, 1, 0, 2]
    assert types(*placed(up, down, KITE), tolerance=0.2) == [0, 0, 0]
    V, Q = placed(KITE, KITE)
    assert types(V, [Q[0], Q[1, :3], Q[0, :3], np.roll(Q[1], 1)]) == [0, 1, 1, 0]


def test_panels_agree_with_the_first_of_their_type_and_a_tie_is_within_the_tolerance():
    def row(*widths):
        x = np.concatenate([[0], np.cumsum(widths)])
        V = np.stack([np.repeat(x, 2), np.tile([0.0, 1], len(x)), 0 * np.repeat(x, 2)], axis=1)
        return V, mesh.grid_quads(len(widths), 1)

    assert types(*row(1, 1.0006, 1.0012, 1.0018)) == [0, 0, 1, 1]
    assert types(*row(1.0006, 1, 1.0012, 1.0018)) == [0, 0, 0, 1]  # the first is the pattern
    assert types(*row(1, 1.001, 1.0021, 1.001, 1)) == [0, 0, 1, 0, 0]
    assert types(*row(1, 1.001, 1.0010001, 1, 3)) == [0, 0, 1, 0, 2]
    for seed in range(5):
        V, Q = row(1, 1.001, 1.0010001, 1, 1.001, 3, 1)
        V += 1e-13 * np.random.default_rng(seed).uniform(-1, 1, V.shape)
        assert types(V, Q) == [0, 0, 1, 0, 0, 2, 0]


def test_all_panels_of_a_type_are_near_the_first_and_none_was_nearer_to_one_before():
    V, Q = surfaces.freeform_patch(12, 14)
    size = np.linalg.norm(V[Q[:, 0]] - V[Q[:, 1]], axis=1).mean()
    found = np.array(types(V, Q, 0.02 * size))
    assert 3 < found.max() < len(Q) - 3

    def apart(a, b):
        """The least possible largest difference of distances, corners begun anywhere."""
        table = [np.linalg.norm(V[f][:, None] - V[f][None], axis=2) for f in (a, b)]
        shifts = (np.roll(table[1], (s, s), axis=(0, 1)) for s in range(4))
        return min(np.abs(table[0] - other).max() for other in shifts)

    first = [np.flatnonzero(found == k)[0] for k in range(found.max() + 1)]
    assert first == sorted(first)
    for k, kind in enumerate(found):
        assert apart(Q[first[kind]], Q[k]) <= 0.02 * size * (1 + 1e-9)


def test_a_web_of_revolution_has_a_type_for_each_row_on_every_processor(tmp_path):
    profile = surfaces.PROFILES["vase"]()
    net = loxodrome.web(profile, np.radians(75), np.radians(60), 24, 12)
    expected = schedule.schedule(net.V, net.Q, tolerance=1e-6)
    ring = np.round(net.V[net.Q].mean(axis=1)[:, 2], 9)  # the height of a quad is that of its row
    pairs = {*zip(ring.tolist(), expected.type.tolist(), strict=True)}
    assert len(pairs) == expected.type.max() + 1 == 12
    for seed in range(3):
        V = noisy(seed, net.V)
        assert np.array_equal(schedule.schedule(V, net.Q, tolerance=1e-6).type, expected.type)


def test_a_net_around_a_hexagon_a_mesh_without_labels_and_vertices_of_no_face(tmp_path):
    V, Q, polygon = mesh.polygon_rings(6, 3)
    about = schedule.numbers(schedule.schedule(V, Q, [polygon]))
    assert (about["whole"], about["cut"], about["nodes"]) == (72, 1, 96)
    assert about["lengths"]["edge"] == 0  # the hexagon has edges of quads only
    V, Q, polygon = mesh.polygon_rings(5, 2)
    V, shift = np.concatenate([[[9, 9, 9]], V]), 1
    found, nodes, bars = tables(tmp_path, schedule.schedule(V, Q + shift, [polygon + shift]))
    assert len(nodes) == len(V) - 1 and int(found[0]["node1"]) == Q[0, 0] + 1
    assert {row["theta"] for row in found} == {""} and {row["family"] for row in bars} == {"edge"}


def test_a_hollow_corner_is_larger_than_half_a_turn():
    P = np.array([[0, 0], [4, 0], [4, 3], [2, 1], [0, 3.0]])
    shape = panels.shapes(np.insert(P, 2, 0, axis=1), [np.arange(5), np.array([2, 3, 4])])
    degrees = np.degrees(shape.angle)
    assert degrees[:5].sum() == pytest.approx(540) and degrees[3] == pytest.approx(270)
    assert degrees[6] == pytest.approx(90)  # the triangle in the hollow is on the other side
    assert shape.area == pytest.approx([8, 4])


GRID = np.array([[0, 0, 0], [0, 1, 0], [1, 0, 0], [1, 1, 0], [2, 0, 0], [2, 1, 0.0]])
BAD = {
    "twice": ([[3, 2, 4, 2]], "3, 2, 4, 2"),
    "two": ([[3, 2]], "three or more"),
    "unknown": ([[3, 2, 6]], "0 to 5"),
    "against": ([[2, 3, 5, 4]], "the edge 3-2|the edge 2-3"),
    "three": ([[3, 2, 4], [3, 2, 5]], "more than two panels"),
    "flat": ([[2, 0, 4]], "no area"),
}


@pytest.mark.parametrize("name", BAD)
def test_panels_that_are_none_are_refused(name):
    polygons, words = BAD[name]
    with pytest.raises(ValueError, match=words):
        schedule.schedule(GRID, mesh.grid_quads(1, 1), polygons)


@pytest.mark.parametrize("tolerance", [0, -1, math.nan, math.inf])
def test_the_tolerance_is_a_positive_length(tolerance):
    with pytest.raises(ValueError, match="tolerance"):
        schedule.schedule(GRID, mesh.grid_quads(1, 1), tolerance=tolerance)


@pytest.mark.parametrize("suffix", [".obj", ".ply", ".off"])
def test_the_command_writes_three_tables_and_tells_the_sums(inet, suffix):  # noqa: F811
    V, Q, polygons = trimmed(wave)
    io.write(f"net{suffix}", V, Q, polygons=polygons)
    about = numbers(inet("schedule", f"net{suffix}", "-o", NAMES[0], "--json"))
    assert about["files"] == [*NAMES] and about["file"] == NAMES[0] and about["notes"] == []
    found, nodes, bars = map(read, NAMES)
    assert (about["panels"], about["nodes"], about["bars"]) == (len(found), len(nodes), len(bars))
    assert (about["whole"], about["cut"]) == (len(Q), len(polygons))
    assert about["types"] == len({row["type"] for row in found})
    for name, total in about["lengths"].items():
        parts = (float(row["length"]) for row in bars if row["family"] == name)
        assert total == pytest.approx(sum(parts), abs=1e-6)
    assert about["area"] == pytest.approx(sum(float(row["area"]) for row in found))
    before = [Path(name).read_bytes() for name in NAMES]
    code, out, err = inet("schedule", f"net{suffix}", "-o", NAMES[0], "--force")
    assert (code, err) == (0, "") and out.split("\n")[:3] == [*NAMES]
    assert f"{len(found)} panels, {len(Q)} whole and {len(polygons)} cut" in out
    assert [Path(name).read_bytes() for name in NAMES] == before
    assert inet("schedule", f"net{suffix}", "-o", NAMES[0], "--force", "--quiet") == (0, "", "")


FILES = {
    "triangles.obj": b"v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n",
    "empty.obj": b"",
    "nan.obj": b"v 0 0 0\nv 1 0 0\nv 1 nan 0\nv 0 1 0\nf 1 2 3 4\n",
    "line.obj": b"v 0 0 0\nv 1 0 0\nv 2 0 0\nv 3 0 0\nf 1 2 3 4\n",
    "turned.obj": b"v 0 1 0\nv 0 0 0\nv 1 0 0\nv 1 1 0\nv 2 0 0\nf 1 2 3 4\nf 3 4 5\n",
}


@pytest.mark.parametrize("name", [*FILES, "missing.obj"])
def test_bad_nets_are_refused_and_nothing_is_written(inet, name):  # noqa: F811
    if name in FILES:
        Path(name).write_bytes(FILES[name])
    before = sorted(Path().iterdir())
    assert refused(inet("schedule", name, "-o", "a.csv"))
    assert sorted(Path().iterdir()) == before


def test_places_and_numbers_are_checked_before_the_work(inet, monkeypatch):  # noqa: F811
    io.write("net.obj", GRID, mesh.grid_quads(1, 1))
    words = "schedule", "net.obj", "-o"
    assert refused(inet(*words, "no folder/a.csv"), "no folder")
    assert refused(inet(*words, "a.xlsx"), ".csv")
    for tolerance in ("0", "nan", "-1", "x"):
        assert refused(inet(*words, "a.csv", f"--tolerance={tolerance}"), "a positive number")
    Path("a_bars.csv").write_text("precious")
    assert refused(inet(*words, "a.csv"), "a_bars.csv exists already")
    assert not Path("a.csv").exists() and not Path("a_nodes.csv").exists()

    def fail(found):
        yield ["bar"]
        raise OSError(28, "No space left on device")

    monkeypatch.setattr(schedule, "_bar_rows", fail)
    before = sorted(Path().iterdir())
    assert refused(inet(*words, "a.csv", "--force"), "No space")
    assert sorted(Path().iterdir()) == before and Path("a_bars.csv").read_text() == "precious"


def test_the_command_takes_meshes_without_labels(inet):  # noqa: F811
    V, Q, polygon = mesh.polygon_rings(5, 2)
    io.write("five.obj", V, Q, polygons=[polygon])
    about = numbers(inet("schedule", "five.obj", "-o", "a.csv", "--json"))
    assert about["lengths"]["u"] == about["lengths"]["v"] == 0 < about["lengths"]["edge"]
    assert "odd" in about["notes"][0] and "no theta" in about["notes"][0]


def test_corners_at_one_place_are_one_and_a_panel_that_has_none_left_is_gone(inet):  # noqa: F811
    near = [[3, 0.5, 0], [3, 0.5 + 1e-9, 0], [2 + 1e-9, 0, 0]]
    V, polygons = np.concatenate([GRID, near]), [[3, 2, 4, 6, 7, 5], [4, 2, 8]]
    io.write("net.obj", V, mesh.grid_quads(1, 1), polygons=polygons)
    about = numbers(inet("schedule", "net.obj", "-o", "a.csv", "--json"))
    assert about["notes"] == ["duplicate vertices merged: 2"] and about["cut"] == 1
    assert read("a.csv")[1]["area"] == "1.5" and cells(read("a.csv")[1], "node", int)[:4]


def test_measure_names_the_panels_that_are_out_of_plane(inet):  # noqa: F811
    V, Q, polygons = trimmed(lambda x, y: 0.05 * x * x * y)
    io.write("net.obj", V, Q, polygons=polygons)
    v1, v2, v3, v4 = V[Q].transpose(1, 0, 2)
    normal = np.cross(v3 - v1, v4 - v2)
    off = np.abs(np.sum((v2 - v1) * normal, axis=1)) / np.linalg.norm(normal, axis=1)
    limit = float(np.sort(off)[-5:-3].mean())
    found = numbers(inet("measure", "net.obj", "--planar-report", limit, "--json"))["out_of_plane"]
    named = {one["panel"]: one for one in found["panels"]}
    whole = [k for k in named if k <= len(Q)]
    assert sorted(whole) == (np.flatnonzero(off > limit) + 1).tolist()
    assert len(named) == found["count"] and found["beyond"] == limit
    for k in whole:
        assert named[k]["planarity"] == pytest.approx(off[k - 1])
        assert np.allclose(named[k]["place"], V[Q[k - 1]].mean(axis=0))
    sizes = [one["planarity"] for one in found["panels"]]
    assert sizes == sorted(sizes, reverse=True)
    code, out, _ = inet("measure", "net.obj", "--planar-report", 1e-6)
    lines = out[out.index("panels more than 1e-06 out of plane") :].splitlines()
    assert code == 0 and len(lines) == 21 and "the worst 20 of them" in lines[0]
    assert inet("measure", "net.obj", "--planar-report", 9)[1].endswith("out of plane: 0\n")
    for wrong in ("0", "nan", "-1"):
        assert refused(inet("measure", "net.obj", f"--planar-report={wrong}"), "positive")


def test_the_report_says_where_quads_are_small_and_how_many_would_even_them():
    surface = examples.hanging_shell(20)
    net = design.cover(*surface, np.radians(60), np.radians(60), count=300)
    d1 = np.linalg.norm(net.V[net.Q[:, 2]] - net.V[net.Q[:, 0]], axis=1)
    about, middles = net.report, net.V[net.Q].mean(axis=1)
    for place, size in ((about.smallest, d1.min()), (about.largest, d1.max())):
        (k,) = np.flatnonzero(np.linalg.norm(middles - place, axis=1) < 1e-12)
        assert d1[k] == pytest.approx(size, rel=1e-8)
    words = design.report.text(about)
    wanted = int(words.split("with about ")[1].split(" quads")[0])
    assert f"{d1.max() / d1.min():.3g} times as large" in words and wanted > len(net.Q)
    finer = design.cover(*surface, np.radians(60), np.radians(60), count=wanted)
    largest = np.linalg.norm(finer.V[finer.Q[:, 2]] - finer.V[finer.Q[:, 0]], axis=1).max()
    assert largest == pytest.approx(d1.min(), rel=0.03)
    assert json.dumps(design.report.numbers(about))
    flat = design.report.report(GRID, mesh.grid_quads(2, 1))
    assert "all quads are of one size" in design.report.text(flat)
