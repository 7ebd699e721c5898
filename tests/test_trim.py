"""Roofs with openings, panels cut at the boundary, and where the grid lies: judged by shapely,
libigl and a few lines of numpy."""

from collections import Counter

import igl
import numpy as np
import pytest
import shapely
from test_repair import sheet

from inetlib import design, examples, io, measure, mesh, panels, repair
from inetlib.design import opening, overlay, regions, trim

PAIRS = [(60, 60), (90, 90), (75, 50)]
ROOFS = {"skylight": 1, "two_skylights": 2, "five_skylights": 5}


def cover(surface, pair, **options):
    return design.cover(*surface, *np.radians(pair), **options)


def plate(keep=lambda x, y: True, long=12, wide=8):
    """A flat plate of unit squares, those that are kept, by their middles."""
    V, Q = sheet(long, wide, lambda u, v: (long * u, wide * v, 0 * u))
    return V, Q[[bool(keep(x, y)) for x, y, _ in V[Q].mean(axis=1)]]


def sides_of(faces):
    return Counter((int(a), int(b)) for f in faces for a, b in zip(f, np.roll(f, -1), strict=True))


def loops_of(faces):
    """The boundary loops of faces of any sizes; they are an oriented manifold, else an error."""
    sides = sides_of(faces)
    assert max(sides.values()) == 1
    free = [side for side in sides if side[::-1] not in sides]
    assert len(dict(free)) == len(free)  # no two loops touch
    graph, loops = dict(free), []
    while graph:
        loops.append([next(iter(graph))])
        while (after := graph.pop(loops[-1][-1])) != loops[-1][0]:
            loops[-1].append(after)
    return loops


def check_panels(net, surface):
    """Few corners, a manifold with the boundary loops of the surface, and on its own edges."""
    V, F = mesh.triangles(*surface)
    assert {len(polygon) for polygon in net.polygons} <= {3, 4, 5, 6}
    rims, known = loops_of([*net.Q, *net.polygons]), mesh.boundary_loops(F)
    assert len(rims) == len(known)
    edges = np.concatenate([np.stack([loop, np.roll(loop, -1)], axis=1) for loop in known])
    corners = net.V[np.setdiff1d(np.concatenate(rims), net.Q)]
    assert len(corners) > 10
    a, b = (V[edges[:, k]] for k in (0, 1))
    along = np.einsum("ckx,kx->ck", corners[:, None] - a, b - a) / np.sum((b - a) ** 2, axis=1)
    feet = a + np.clip(along, 0, 1)[..., None] * (b - a)
    off = np.linalg.norm(corners[:, None] - feet, axis=2).min(axis=1)
    assert off.max() < 1e-9 * np.linalg.norm(np.ptp(V, axis=0))
    assert np.unique(np.concatenate([net.Q.ravel(), *net.polygons])).size == len(net.V)


@pytest.mark.parametrize("pair", PAIRS)
@pytest.mark.parametrize("name", ROOFS)
def test_roofs_with_openings_are_covered_exactly_and_to_the_edge(name, pair):
    surface = examples.SURFACES[name](20)
    net = cover(surface, pair, count=300, openings="fill", trim=True)
    assert measure.deviations(net.V, net.Q, *np.radians(pair)).max() < np.radians(1e-9)
    quality = measure.quality(net.V, net.Q)
    assert (quality.flips, quality.darts, net.report.converged) == (0, 0, True)
    check_panels(net, surface)
    V, F = surface
    seen = shapely.union_all(shapely.polygons(V[F][:, :, :2]))  # from above
    assert len(seen.interiors) == ROOFS[name]
    quads = shapely.polygons(net.V[net.Q][:, :, :2])
    assert (shapely.area(shapely.intersection(quads, seen)) > 0.5 * shapely.area(quads)).all()
    shadows = [*quads, *(shapely.Polygon(net.V[polygon, :2]) for polygon in net.polygons)]
    assert all(shadow.is_valid and shadow.exterior.is_ccw for shadow in shadows)
    area = sum(shadow.area for shadow in shadows)
    assert shapely.union_all(shadows).area == pytest.approx(area, rel=1e-3)
    assert area == pytest.approx(seen.area, rel=0.01)
    assert net.report.covered == pytest.approx(1, abs=0.01) and not net.report.notes
    assert len(net.report.polygons) == len(net.polygons)
    assert 0.02 < net.report.cut_smallest < 1


def domain(surface, openings):
    """The flattened surface, and its area in the plane by shapely."""
    clean = repair.clean(*surface)
    filled = opening.are_filled(openings, clean.loops)
    W, flat = design._flatten(clean, filled, "even")
    triangles = shapely.polygons(np.stack([flat.z[flat.F].real, flat.z[flat.F].imag], axis=2))
    return overlay.Domain(flat, W), shapely.area(triangles).sum()


@pytest.mark.parametrize(
    ("name", "openings"),
    [("roof", None), ("saddle", "ring"), ("skylight", "fill"), ("five_skylights", "fill")],
)
def test_the_areas_of_quads_and_panels_in_the_plane_add_up(name, openings):
    flat, area = domain(examples.SURFACES[name](16), openings)
    for pair, count in ((PAIRS[0], 60), (PAIRS[2], 200)):
        layer = overlay.cover(flat, *np.radians(pair), count, None, 0.2)
        found = trim.trim(flat, layer)
        cell = abs(np.imag(np.conj(layer.u) * layer.v))
        assert found.areas.min() > 0
        total = found.areas.sum() + len(found.layer.Q) * cell
        assert total == pytest.approx(area, rel=1e-9)
        around = regions.regions(flat, layer)
        parts = [np.imag(np.conj(z) @ np.roll(z, -1)) / 2 for z in around.z]
        assert sum(parts) + len(around.layer.Q) * cell == pytest.approx(area, rel=1e-9)


def test_a_corner_that_moves_across_the_boundary_leaves_no_panel_crossed(tmp_path):
    surface, pair = examples.five_skylights(12), (102, 70)
    flat, _ = domain(surface, "fill")
    laid = trim.trim(flat, overlay.cover(flat, *np.radians(pair), 676))
    net = cover(surface, pair, count=676, openings="fill", trim=True)
    check_panels(net, surface)
    lost = len(laid.layer.Q) - len(net.Q)
    assert lost > 0 and len(net.polygons) == len(laid.polygons) + lost
    assert len(repair.triangulate(net.V, net.polygons)) == sum(len(p) - 2 for p in net.polygons)
    assert net.report.covered == pytest.approx(1, abs=0.01)
    assert measure.deviations(net.V, net.Q, *np.radians(pair)).max() < np.radians(1e-9)
    known = {frozenset(side) for side in sides_of(net.Q)}
    assert all(len(x) for x in net.edges.values())
    assert not [e for x in net.edges.values() for e in x.tolist() if frozenset(e) in known]


def test_panels_with_sides_that_cross_are_found_in_any_plane():
    rng = np.random.default_rng(3)
    across = np.linalg.qr(rng.normal(size=(3, 3)))[0][:2]
    places = [[0, 0], [2, 0], [2, 1], [0, 1], [1, 0.2], [0.5, -0.2]]
    V = np.array(places) @ across + 0.01 * rng.normal(size=(6, 3))
    good = [[0, 1, 2], [0, 1, 2, 3], [0, 1, 2, 4], [0, 5, 1, 2, 3]]
    bad = [[0, 1, 3, 2], [0, 2, 1, 4, 3], [0, 1, 5, 4, 2]]
    for panel in bad:
        x, y = np.array(places)[panel].T
        assert not shapely.Polygon(np.stack([x, y], axis=1)).is_valid
    assert panels.crossed(V, [*good, *bad]).tolist() == [4, 5, 6]
    assert panels.crossed(V, good).size == panels.crossed(V, []).size == 0


def test_a_ring_is_trimmed_across_its_seam():
    surface = examples.saddle_with_hole(8)
    net = cover(surface, (75, 50), count=300, trim=True)
    check_panels(net, surface)
    assert len(mesh.boundary_loops(net.Q)) == 2 and sum(map(abs, net.report.winding)) > 2
    assert net.report.covered == pytest.approx(1, abs=0.01)


def test_curves_run_on_to_the_boundary_and_panels_are_written(tmp_path):
    surface = examples.two_skylights(16)
    net = cover(surface, (60, 60), count=200, trim=True)
    known = sides_of([*net.Q, *net.polygons])
    inner = {tuple(sorted(side)) for side in known if side[::-1] in known}
    rim = {k for loop in loops_of([*net.Q, *net.polygons]) for k in loop}
    plain, longer = mesh.polylines(net.Q), mesh.polylines(net.Q, net.edges)
    for kind in "uv":
        edges = {tuple(edge) for edge in np.sort(net.edges[kind]).tolist()}
        assert 0.7 * len(edges) < len(edges & inner)  # the others are inside panels
        ends = [{line[0], line[-1]} <= rim for line in getattr(longer, kind)]
        assert np.mean(ends) > 0.8  # the others end beside slivers that joined panels
        assert sum(map(len, getattr(longer, kind))) > sum(map(len, getattr(plain, kind)))
    io.write(tmp_path / "roof.ply", net.V, net.Q, polygons=net.polygons)
    again = io.net(tmp_path / "roof.ply")
    assert len(again.Q) + len(again.polygons) == len(net.Q) + len(net.polygons)


CASES = {  # lines of the grid on the boundary, nodes in corners, openings inside a cell
    "on the boundary": (plate(), {"size": 1.0, "through": (0, 0, 0)}, 96),
    "on an opening": (plate(lambda x, y: not (3 < x < 6 and 2 < y < 5)), {"size": 1.0}, 87),
    "inside cells": (plate(lambda x, y: (x, y) not in ((5.5, 2.5), (8.5, 4.5))), {"size": 3.0}, 94),
    "an edge of many": (
        plate(lambda x, y: x % 3 != 1.5 or y % 3 != 1.5, 18, 12),
        {"size": 2.0},
        192,
    ),
    "beside a thin strip": (
        plate(lambda x, y: not (8 < x < 12 and 1 < y < 5), 24, 16),
        {"size": 1.6},
        368,
    ),
}


@pytest.mark.parametrize("pair", [(90, 90), (60, 60)])
@pytest.mark.parametrize("name", CASES)
def test_plates_are_tiled_without_gap_and_overlap_where_lines_meet_the_boundary(name, pair):
    surface, options, area = CASES[name]
    loops = mesh.boundary_loops(surface[1])
    options = options | ({"openings": "fill"} if len(loops) > 1 else {})
    net = cover(surface, pair, trim=True, **options)
    assert len(loops_of([*net.Q, *net.polygons])) == len(loops)
    panels = [shapely.Polygon(net.V[face, :2]) for face in (*net.Q, *net.polygons)]
    assert all(panel.is_valid and panel.exterior.is_ccw for panel in panels)
    total = sum(panel.area for panel in panels)
    assert total == pytest.approx(area, rel=3e-3)
    assert shapely.union_all(panels).area == pytest.approx(total, rel=1e-9)


def test_an_opening_is_left_out_or_goes_around_as_one_says():
    surface = examples.skylight(16)
    ring, same, filled = (
        cover(surface, (60, 60), count=200, openings=x, optimise=False)
        for x in (None, "ring", "fill")
    )
    assert np.array_equal(ring.Q, same.Q) and ring.report.winding != (0, 0)
    assert filled.report.winding == (0, 0) and len(mesh.boundary_loops(filled.Q)) == 2
    V, F = opening.filled(*repair.clean(*surface)[:3])
    assert len(mesh.boundary_loops(F)) == 1
    assert igl.doublearea(V, F).min() > 1e-6


def test_the_grid_goes_through_a_point_and_stays_there_and_along_a_direction():
    V, F = examples.wavy_roof(24)
    wish = np.array([1.3, 0.9, 0.7])
    foot = igl.point_mesh_squared_distance(wish[None], V, F)[2].ravel()
    net = cover((V, F), (75, 50), count=300, through=wish, align=(1, 1, 0))
    assert net.report.converged
    off = np.linalg.norm(net.V - foot, axis=1)
    node = np.argmin(off)
    assert off[node] < 1e-12
    (line,) = (x for x in mesh.polylines(net.Q).u if node in x)
    k = list(line).index(node)
    way = net.V[line[k + 1]] - net.V[line[k - 1]]
    assert abs(way[0] - way[1]) < 0.05 * np.linalg.norm(way[:2])
    tip = V[np.argmax(V[:, 0] - V[:, 1])]  # a corner of the roof narrower than those of a quad
    outside = [cover((V, F), (75, 50), count=99, through=tip, trim=trim) for trim in (False, True)]
    assert [any("go through" in x for x in net.report.notes) for net in outside] == [True, False]
    assert np.linalg.norm(outside[1].V - tip, axis=1).min() < 1e-9
    turned = cover((V, F), (75, 50), count=300, align=(1, 1, 0), direction=0.5, optimise=False)
    other = cover((V, F), (75, 50), count=300, align=(1, 1, 0), optimise=False)
    a, b = (x.V[x.Q[:, 2]] - x.V[x.Q[:, 1]] for x in (turned, other))
    a, b = (np.angle(np.mean((x @ [1, 1j, 0]) ** 2)) / 2 for x in (a, b))
    assert a - b == pytest.approx(0.5, abs=0.05)


def test_curves_follow_the_longest_side_of_a_roof():
    V, Q = sheet(30, 20, lambda u, v: (3 * u + v, 2 * v, 0 * u))  # a parallelogram
    for width, wanted in ((3, 0.0), (0.5, np.arctan2(2, 1))):
        surface = V * [width / 3, 1, 1] + V[:, 1:2] * [0.5 - width / 6, 0, 0], Q
        net = cover(surface, (90, 90), size=0.1, along="boundary", optimise=False)
        way = net.V[net.Q[:, 2]] - net.V[net.Q[:, 1]]
        found = np.angle(np.mean((way @ [1, 1j, 0]) ** 2)) / 2
        assert found == pytest.approx(wanted, abs=1e-4)


TOUCHING = plate(lambda x, y: not (0 < x < 1 and 3 < y < 4) and not (1 < x < 3 and 4 < y < 6))
NESTED = plate(lambda x, y: not (2 < x < 9 and 2 < y < 7) or (4 < x < 6 and 4 < y < 6))
WRONG = {
    "form two fans": (TOUCHING, {}),
    "2 separate pieces": (NESTED, {}),
    r"through = \(99, 0, 0\): 87 from the surface, whose diagonal is 14.4": (
        plate(),
        {"through": (99, 0, 0)},
    ),
    "through = .*three finite numbers": (plate(), {"through": (0, np.nan, 0)}),
    "align = .*normal to the surface": (plate(), {"align": (0, 0, 1)}),
    "align = .*three finite": (plate(), {"align": 3}),
    "along and align both": (plate(), {"along": "boundary", "align": (1, 0, 0)}),
    'along = "edge"': (plate(), {"along": "edge"}),
    "size = nan": (plate(), {"size": np.nan}),
    'openings = "ring": the surface has 2 openings': (
        examples.two_skylights(12),
        {"openings": "ring"},
    ),
    'openings = "none"': (plate(), {"openings": "none"}),
    "not one whole quad": (plate(), {"size": 9.0}),
}


@pytest.mark.parametrize("words", WRONG)
def test_what_cannot_be_covered_is_refused_in_a_sentence(words):
    surface, options = WRONG[words]
    with pytest.raises(ValueError, match=words) as caught:
        cover(surface, (60, 60), trim=True, **options)
    assert "\n" not in str(caught.value)
