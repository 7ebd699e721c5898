"""Beyond the paper: rho and its half plane, the pencil, labels, freedom, darts, stars."""

import matplotlib.pyplot as plt
import numpy as np
import pytest
import sympy as sp

from inetlib import (
    conformal,
    examples,
    loxodrome,
    measure,
    mesh,
    parallelogram,
    reference,
    solver,
    surfaces,
)
from inetlib.drawings import beyond_freedom, beyond_labels, beyond_rho, beyond_star
from inetlib.solver import freedom, problem, run
from inetlib.solver.goal import aim

DEGREE = np.pi / 180


def many(count=500, seed=5):
    """Random points rho of the upper half plane."""
    rng = np.random.default_rng(seed)
    return rng.normal(0, 1.5, count) + 1j * np.exp(rng.normal(0, 1, count))


def test_the_cross_ratio_of_the_web_is_minus_one_for_every_rho():
    x, y = sp.Symbol("x", real=True), sp.Symbol("y", positive=True)
    xu, yv, xv, yu = parallelogram.directions(x + sp.I * y)
    assert sp.simplify(parallelogram.cross_ratio(xu, xv, yv, yu) + 1) == 0
    xu, yv, xv, yu = parallelogram.directions(many())
    assert np.allclose(parallelogram.cross_ratio(xu, xv, yv, yu), -1, atol=1e-9)


def test_the_cross_ratio_knows_neither_lengths_nor_signs_but_the_order():
    a, b, c, d = 1 + 0j, 2 + 1j, 0.3 + 1j, -1 + 0.4j
    ratio = parallelogram.cross_ratio(a, b, c, d)
    assert parallelogram.cross_ratio(-2 * a, 0.3 * b, -c, 5 * d) == pytest.approx(ratio)
    assert parallelogram.cross_ratio(a, b, d, c) == pytest.approx(1 / ratio)
    assert parallelogram.cross_ratio(a, c, b, d) == pytest.approx(1 - ratio)
    p, q, r, s = (z.imag / z.real for z in (a, b, c, d))
    assert ratio == pytest.approx((r - p) * (s - q) / ((s - p) * (r - q)))
    with pytest.raises(ValueError, match="coincide"):
        parallelogram.cross_ratio(a, b, c, -2 * a)


def test_the_gaps_are_the_angles_between_the_directions():
    for rho in many(50):
        shape = parallelogram.from_rho(rho)
        lines = np.array([*parallelogram.directions(rho), -1])
        turned = np.angle(lines[1:] / lines[:-1]) % np.pi
        gaps = parallelogram.gaps(shape.lam, shape.mu)
        assert np.allclose(gaps, turned, atol=1e-9) and min(gaps) > 0
        assert sum(gaps) == pytest.approx(np.pi)
        assert gaps[0] + gaps[3] == pytest.approx(shape.theta)


def test_cotangents_of_the_half_angles():
    lam, mu = sp.symbols("lam mu", positive=True)
    alpha, beta = parallelogram.half_angles(lam, mu)
    _, theta0 = parallelogram.angles(lam, mu)
    cot = [sp.cos(x) / sp.sin(x) for x in (alpha, beta)]
    wanted = [(mu + s * sp.cos(theta0)) / sp.sin(theta0) for s in (1, -1)]
    off = [one - other for one, other in zip(cot, wanted, strict=True)]
    assert all(sp.simplify(sp.factor(x, deep=True)) == 0 for x in off)


@pytest.mark.parametrize("pair", [(90, 60), (90, 120), (60, 90), (120, 90)])
def test_four_shapes_contain_the_regular_three_web(pair):
    gaps = parallelogram.gaps(*parallelogram.ratios(*np.radians(pair)))
    assert sorted(np.degrees(gaps)) == pytest.approx([30, 30, 60, 60])
    assert np.degrees(parallelogram.gaps(1.0, 1.0)) == pytest.approx([45] * 4)


def test_every_point_lies_on_its_four_curves():
    rho = many()
    lam, mu, theta, theta0 = parallelogram.from_rho(rho)
    for centre, radius in (beyond_rho.mu_circle(mu), beyond_rho.lam_circle(lam)):
        assert np.allclose(np.abs(rho - centre), radius, rtol=1e-8)
    height, radius = beyond_rho.theta_circle(theta)
    assert np.allclose(np.abs(rho - 1j * height), radius, rtol=1e-8)
    assert np.allclose(np.abs(1 - 1j * height), radius)  # the circle passes through 1
    assert np.allclose(np.angle(rho), theta0)


def test_the_curves_are_proved_with_symbols():
    x, y = sp.Symbol("x", real=True), sp.Symbol("y", positive=True)
    K = sp.simplify(parallelogram.diagonal_ratio(x + sp.I * y))
    re, im = (sp.simplify(part) for part in K.as_real_imag())
    lam2 = re**2 + im**2
    centre, radius2 = (lam2 + 1) / (lam2 - 1), 4 * lam2 / (lam2 - 1) ** 2
    assert sp.simplify((x - centre) ** 2 + y**2 - radius2) == 0
    height = -re / im  # -cot theta
    assert sp.simplify(x**2 + (y - height) ** 2 - 1 - height**2) == 0
    assert sp.simplify(beyond_rho.theta_circle(sp.pi / 2)[0]) == 0


def test_equal_angles_lie_on_one_circle_and_nowhere_else():
    rho = many()
    shape = parallelogram.from_rho(rho)
    centre, radius = beyond_rho.equal_circle()
    inside = np.abs(rho - centre) < radius
    assert np.array_equal(inside, shape.lam < shape.mu) and 0.1 < inside.mean() < 0.9
    for degrees in (20, 60, 135):
        lam, mu = parallelogram.ratios(degrees * DEGREE, degrees * DEGREE)
        assert abs(parallelogram.rho(lam, mu) - centre) == pytest.approx(radius)
    with pytest.raises(ValueError, match="imaginary axis"):
        beyond_rho.lam_circle(1)


def right_way_up(V, Q):
    V, Q = mesh.check(V, Q)
    d1, d2, _, _ = measure.vectors(V, Q)
    return (np.cross(d1, d2)[:, 2] > 0).all()


@pytest.mark.parametrize("valence", range(3, 9))
def test_vertices_of_even_valence_can_be_labelled(valence):
    V, Q = examples.vertex(valence, 3)
    assert right_way_up(V, Q) and np.sum(Q == 0) == valence
    assert len(Q) == 9 * valence and len(np.unique(Q)) == len(V)
    if valence % 2:
        with pytest.raises(ValueError, match=f"vertex 0 has the odd valence {valence}"):
            mesh.label(Q)
    else:
        assert mesh.is_labelled(mesh.label(Q))


@pytest.mark.parametrize("sides", [3, 4, 5, 8])
def test_polar_caps_are_labelled_for_any_number_of_sides(sides):
    V, Q, polygon = examples.polar_cap(sides, 4)
    assert right_way_up(V, Q) and mesh.is_labelled(Q)
    assert len(Q) == 4 * sides and len(polygon) == sides
    assert sorted(np.bincount(Q.ravel())[polygon]) == [2] * sides  # and the polygon: valence 3
    loops = [sorted(loop.tolist()) for loop in mesh.boundary_loops(Q)]
    assert sorted(polygon.tolist()) in loops


def test_the_moebius_strip_has_no_orientation():
    V, Q = examples.moebius_strip(20, 2)
    with pytest.raises(ValueError, match="not orientable"):
        mesh.label(Q)
    edges = np.linalg.norm(V[Q] - V[np.roll(Q, -1, axis=1)], axis=2)
    assert edges.max() < 0.7  # the seam is closed


def test_counts_out_of_range_are_refused():
    for build in (examples.vertex, examples.polar_cap, examples.moebius_strip):
        for bad in ((2, 3), (6, 0), (5.5, 2)):
            with pytest.raises(ValueError, match="whole number"):
                build(*bad)
    for fixed in ([0.5], [99]):
        with pytest.raises(ValueError, match="fixed: vertex numbers or a mask"):
            freedom.count(*examples.vertex(4, 1), fixed)


def test_the_names_disagree_somewhere_exactly_on_refused_meshes():
    shuffled = np.array([np.roll(q, k) for k, q in enumerate(mesh.grid_quads(3, 4))])
    for Q in [shuffled, *(Q for _, _, Q, _ in beyond_labels.gallery().values())]:
        labelled, edges = examples.seam(Q)
        good = beyond_labels.verdict(Q) == "labelled"
        assert good == (len(edges) == 0) and (good or Q is not shuffled)
        assert np.array_equal(np.sort(labelled, axis=1), np.sort(Q, axis=1))
        if good:
            assert mesh.is_labelled(labelled)


def test_a_mesh_is_refused_where_an_odd_number_of_edges_would_alternate():
    for title, _, Q, polygon in beyond_labels.gallery().values():
        words = beyond_labels.verdict(Q)
        if words == "not orientable":
            assert title == "M\u00f6bius strip"
            continue
        count = beyond_labels.around(Q, polygon)
        assert (count % 2 == 0) == (words == "labelled")
        if "quads meet" in title:
            assert count == int(title[0]) == np.sum(Q == 0)
        elif "cap" in title:  # its sides, and one edge from each corner
            assert count == 2 * len(polygon)


def test_the_jacobian_is_the_derivative():
    rng = np.random.default_rng(2)
    V, Q = surfaces.freeform_patch(3, 2)
    move = rng.normal(size=V.shape)
    ahead, back = (np.log(measure.ratios(V + h * move, Q)).T.ravel() for h in (1e-6, -1e-6))
    assert np.allclose(freedom.jacobian(V, Q) @ move.ravel(), (ahead - back) / 2e-6, atol=1e-7)


def own_rank(V, Q, moving):
    """The rank of the derivative of all log ratios by the coordinates that move: differences."""

    def logs(x):
        W = V.copy()
        W[moving] = x.reshape(-1, 3)
        v1, v2, v3, v4 = W[Q].transpose(1, 0, 2)
        d1, d2 = v3 - v1, v4 - v2
        squares = [np.sum(d * d, axis=1) for d in (d1, d2, d1 + d2, d2 - d1)]
        return np.log(np.concatenate([squares[1] / squares[0], squares[2] / squares[3]]))

    x, size = V[moving].ravel(), np.ptp(V, axis=0).max()
    steps = 1e-4 * size * np.eye(x.size)
    J = [8 * (logs(x + h) - logs(x - h)) - logs(x + 2 * h) + logs(x - 2 * h) for h in steps]
    return np.linalg.matrix_rank(np.array(J), rtol=1e-9)


def nets_of_all_kinds():
    """{name: (V, Q)}: exact and bent, planar and in space, with boundary, singular, closed."""
    rng = np.random.default_rng(8)
    for k in range(12):
        angles, (m, n) = rng.uniform(0.6, 2.5, 2), rng.integers(1, 6, 2)
        V, Q = conformal.quads(conformal.sheared_grid(*angles, m, n))
        yield f"grid {k}", V, Q
        yield f"bent grid {k}", V + 0.1 * rng.normal(size=V.shape), Q
    yield "hexagon", *mesh.polygon_rings(6, 2)[:2]
    yield "polar cap", *examples.polar_cap(7, 2)[:2]
    yield "web", *loxodrome.web(surfaces.sphere_profile(), 1.2, 1.0, 9, 4)[:2]
    yield "torus", *loxodrome.torus_web(2, 0.8, 8, 6, 1)[:2]
    yield "roof", *surfaces.freeform_patch(5, 5)


def test_b8_all_equations_are_independent_by_two_ranks():
    for name, V, Q in nets_of_all_kinds():
        rank, found = own_rank(V, Q, np.arange(len(V))), freedom.count(V, Q)
        assert rank == found.rank == found.equations == 2 * len(Q), name
        assert found.free == 3 * len(V) - 2 * len(Q), name
    V, Q = loxodrome.torus_web(2, 0.8, 9, 5, 0)[:2]  # an exception: one of them follows
    assert own_rank(V, Q, np.arange(len(V))) == freedom.count(V, Q).rank == 2 * len(Q) - 1


def test_b8_what_may_stay_by_two_ranks():
    """One curve leaves all equations independent; of a flat net its whole boundary does not."""
    index = np.arange(49).reshape(7, 7)
    rim = mesh.boundary_loops(mesh.grid_quads(6, 6))[0]
    flat = conformal.quads(conformal.sheared_grid(60 * DEGREE, 45 * DEGREE, 6, 6))
    roof = surfaces.freeform_patch(6, 6)
    curve, both = index[3], index[[0, -1]].ravel()
    assert list(map(len, beyond_freedom.curves(6).values())) == [7, 7, 14, 0, 0, 24]
    wanted = [(flat, curve, 72), (flat, rim, 50), (roof, curve, 72), (roof, both, 72)]
    for (V, Q), stay, rank in [*wanted, (roof, rim, 72)]:
        found = freedom.count(V, Q, stay)
        moving = np.setdiff1d(np.arange(len(V)), stay)
        assert own_rank(V, Q, moving) == found.rank == rank
        assert (found.unknowns, found.free) == (3 * len(moving), 3 * len(moving) - rank)
        assert freedom.count(V, Q, np.isin(np.arange(len(V)), stay)) == found
    assert found.free == 3  # of 75 coordinates: too few to reach angles far away
    with pytest.raises(ValueError, match="1225 faces: at most 1200"):
        freedom.count(*surfaces.freeform_patch(35, 35))


def test_one_curve_can_be_kept_and_the_whole_boundary_not():
    V, Q = surfaces.freeform_patch(10, 10)
    near = reference.mesh(V, Q)
    index = np.arange(121).reshape(11, 11)
    angles = 60 * DEGREE, 45 * DEGREE
    for stay in (index[0], index[5], index[:, 5]):
        net = solver.optimize(V, Q, *angles, reference=near, fixed=stay)
        assert net.converged and np.array_equal(net.V[stay], V[stay])
        assert measure.quality(net.V, Q).flips == 0
    failed = solver.optimize(V, Q, *angles, reference=near, fixed="boundary", iterations=20)
    assert not failed.converged and "not converged" in failed.message
    rim = mesh.boundary_loops(Q)[0]
    assert np.array_equal(failed.V[rim], V[rim]) and np.isfinite(failed.V).all()


def turns_wrong(V, Q):
    """The faces with a corner that turns the other way, seen along the normal of the diagonals."""
    P = V[Q]
    normal = np.cross(P[:, 2] - P[:, 0], P[:, 3] - P[:, 1])
    sides = np.roll(P, -1, axis=1) - P
    turns = np.cross(np.roll(sides, 1, axis=1), sides)
    return np.flatnonzero((np.einsum("fkx,fx->fk", turns, normal) < 0).any(axis=1))


def test_shifting_every_other_vertex_changes_no_angle_and_makes_darts():
    web = loxodrome.web(surfaces.vase_profile(), 75 * DEGREE, 60 * DEGREE, 24, 12)
    hexagon, rings, _ = mesh.polygon_rings(6, 4)
    tan = np.tan(0.8 * conformal.sheared_grid(60 * DEGREE, 45 * DEGREE, 12, 9, edge=0.08))
    for V, Q in (web[:2], (hexagon, rings), surfaces.freeform_patch(9, 7), conformal.quads(tan)):
        sides = np.stack([Q, np.roll(Q, -1, axis=1)], axis=-1).reshape(-1, 2).T
        colour, loop = mesh.two_colour(len(V), *sides, np.ones(Q.size, dtype=bool))
        assert loop is None and (colour[sides[0]] != colour[sides[1]]).all()
        size = np.linalg.norm(measure.vectors(V, Q)[0], axis=1).mean()
        across = np.eye(3)[np.argsort(np.ptp(V, axis=0))[-2:]].sum(axis=0)  # in the flatter plane
        before, seen = measure.quality(V, Q), []
        assert before.darts == len(turns_wrong(V, Q)) == 0
        for length in (0.01, 0.3, 0.6, 1.2):
            shift = length * size * colour[:, None] * across
            for judge in (measure.ratios, measure.angles):
                np.testing.assert_allclose(judge(V + shift, Q), judge(V, Q), rtol=0, atol=1e-12)
            after = measure.quality(V + shift, Q)
            assert (after.flips, after.area_ratio) == (
                before.flips,
                pytest.approx(before.area_ratio),
            )
            assert after.nonconvex.tolist() == turns_wrong(V + shift, Q).tolist()
            seen.append(after.darts)
        assert seen[0] == 0 and seen[-1] > len(Q) / 3
        np.testing.assert_allclose(freedom.jacobian(V, Q) @ shift.ravel(), 0, atol=1e-9)


def test_a_coupled_step_shifts_every_other_vertex_less():
    V, Q = surfaces.freeform_patch(10, 10)
    V = V + 0.01 * np.random.default_rng(2).normal(size=V.shape)
    goal = aim(60 * DEGREE, 45 * DEGREE)
    given = problem.prepare(V, Q, goal)
    free, _ = run.angle_step(given, V, goal, np.zeros(0))
    tied, _ = run.coupled_step(given, V, goal, np.zeros(0), run.LOOSE)
    apart = [
        np.linalg.norm(d[Q][:, ::2].sum(axis=1) - d[Q][:, 1::2].sum(axis=1)) for d in (free, tied)
    ]
    residual, J, _ = run.equations(given, V, goal, np.zeros(0))
    for d in (free, tied):  # both meet the linearised angles
        assert np.abs(residual + J @ d.ravel()).max() < 1e-6 * np.abs(residual).max()
    assert apart[1] < 0.5 * apart[0]


def test_half_turns_keep_any_angles_and_mirrors_only_right_ones():
    V, Q = beyond_freedom.vault(8)
    skew = np.linspace(0.01, 0.1, len(V))
    for fairness, symmetric in ((0.01, True), (skew + skew[::-1], True), (skew, False)):
        weights = solver.Weights(fairness)
        net = solver.optimize(V, Q, 60 * DEGREE, 45 * DEGREE, weights=weights)
        asymmetry = np.abs(net.V[::-1] * [-1, -1, 1] - net.V).max()
        assert net.converged and (asymmetry < 1e-9 if symmetric else asymmetry > 1e-3)
    u, v = np.meshgrid(*2 * [np.linspace(-1, 1, 9)], indexing="ij")
    W = np.stack([u, v + 0.1 * u**2, 0.4 * np.cos(u) - 0.2 * v**2 + 0.1 * v**3], axis=-1)
    for theta, symmetric in ((90, True), (60, False)):
        net = solver.optimize(W.reshape(-1, 3), Q, 60 * DEGREE, theta * DEGREE)
        grid = net.V.reshape(9, 9, 3)
        asymmetry = np.abs(grid[::-1] * [-1, 1, 1] - grid).max()
        assert net.converged and (asymmetry < 1e-9 if symmetric else asymmetry > 0.1)


def test_star_angles_of_affine_grids_squares_and_exponentials_in_closed_form():
    z = conformal.sheared_grid(70 * DEGREE, 40 * DEGREE, 4, 3, direction=0.3 + 1j)
    for unit in (False, True):  # those of the faces
        star = measure.star_angles(*conformal.quads(z), unit)
        assert star.vertex.tolist() == [5, 6, 9, 10, 13, 14]
        assert np.allclose(star.theta, 70 * DEGREE, atol=1e-14)
        assert np.allclose(star.theta0, 40 * DEGREE, atol=1e-14)
    z = conformal.sheared_grid(60 * DEGREE, 45 * DEGREE, 5, 5, origin=1, edge=0.3)
    star = measure.star_angles(*conformal.quads(z**2))
    assert np.allclose(star.theta, 60 * DEGREE, atol=1e-12)
    assert np.allclose(star.theta0, 45 * DEGREE, atol=1e-12)
    u, v = z[1, 0] - z[0, 0], z[0, 1] - z[0, 0]
    for unit, half in ((False, 1), (True, 2)):
        star = measure.star_angles(*conformal.quads(np.exp(z)), unit)
        angle0 = np.angle(np.sinh(v / half) / np.sinh(u / half))
        angle = np.angle(np.sinh((u + v) / half) / np.sinh((u - v) / half))
        assert np.allclose(star.theta0, angle0, atol=1e-12)
        assert np.allclose(star.theta, angle, atol=1e-12)
    assert abs(angle0 - 45 * DEGREE) > 1e-4


def test_star_angles_do_not_depend_on_half_turns_or_order_and_leave_out_rim_and_singular_vertices():
    V, Q = surfaces.freeform_patch(5, 4)
    star = measure.star_angles(V, Q)
    other = np.where(np.arange(len(Q))[:, None] % 3 == 0, np.roll(Q, 2, axis=1), Q)[::-1]
    for one, two in zip(star, measure.star_angles(V, other), strict=True):
        assert np.array_equal(one, two)
    turned = measure.star_angles(V, np.roll(Q, 1, axis=1))
    assert np.allclose(turned.theta + star.theta, np.pi)
    assert np.allclose(turned.theta0 + star.theta0, np.pi)
    with pytest.raises(ValueError, match=r"mesh\.label"):
        measure.star_angles(V, np.concatenate([np.roll(Q[:1], 1, axis=1), Q[1:]]))
    V, Q = examples.vertex(6, 3)
    star, rim = measure.star_angles(V, mesh.label(Q)), mesh.boundary_loops(Q)[0]
    assert len(star.vertex) == len(V) - len(rim) - 1 and 0 not in star.vertex
    one = measure.star_angles(*conformal.quads(np.array([[0, 1j], [1, 1 + 1j]])))
    assert [x.size for x in one] == [0, 0, 0]


def test_star_angles_come_with_the_square_of_the_size():
    found = beyond_star.nets(sizes=(8, 16, 32))
    for unit in (False, True):
        rows = beyond_star.table(found, 60 * DEGREE, 45 * DEGREE, unit)
        for name in ("exp", "inverse", "sphere"):
            first, second, third = rows[name][:, 1]
            assert 3.3 < first / second < 4.5 and 3.5 < second / third < 4.2
        asked = 60 * DEGREE, 45 * DEGREE, unit, 0.9
        most = [beyond_star.deviation(*net, *asked)[1] for net in found["roof"]]
        assert 3.3 < most[0] / most[1] < 4.5 and 3.5 < most[1] / most[2] < 4.2
        assert rows["roof"][1, 1] < 2 * rows["roof"][2, 1]  # the largest does not follow
    assert beyond_star.table(found, 60 * DEGREE, 45 * DEGREE)["z2"].max() < 1e-10


def test_the_worst_vertices_of_the_refined_roof_stand_next_to_its_corners():
    V, Q = beyond_star.nets(sizes=(8, 32))["roof"][1]
    star = measure.star_angles(V, Q)
    i, j = np.divmod(star.vertex, 33)
    off = np.abs(star.theta0 - 45 * DEGREE) / DEGREE
    corner = (np.minimum(i, 32 - i) < 4) & (np.minimum(j, 32 - j) < 4)
    assert corner[np.argmax(off)] and off[corner].max() > 2 * off[~corner].max()


def test_marching_from_two_sides_is_exact_and_unstable():
    size, grown = [], []
    for m in (4, 6, 8):
        V, Q = surfaces.freeform_patch(m, m)
        W = freedom.march(V, m, m, 75 * DEGREE, 70 * DEGREE)
        for angles, asked in zip(measure.angles(W, Q), (75, 70), strict=True):
            assert np.allclose(angles, asked * DEGREE, atol=1e-12)
        index = np.arange((m + 1) ** 2).reshape(m + 1, m + 1)
        assert np.array_equal(W[index[0]], V[index[0]])
        assert np.array_equal(W[index[:, 0]], V[index[:, 0]])
        size.append(measure.quality(W, Q).flips / len(Q))
        exact = conformal.quads(conformal.sheared_grid(75 * DEGREE, 70 * DEGREE, m, m))[0]
        assert np.allclose(freedom.march(exact, m, m, 75 * DEGREE, 70 * DEGREE), exact, atol=1e-9)
        shifted = exact + 1e-9 * np.eye(len(V))[:, [1]] * [0, 1, 0]
        moved = freedom.march(shifted, m, m, 75 * DEGREE, 70 * DEGREE) - exact
        grown.append(np.linalg.norm(moved, axis=1).max() / 1e-9)
    assert size[0] < size[1] < size[2] and size[2] > 0.5
    assert grown[1] > 10 * grown[0] and grown[2] > 10 * grown[1]
    with pytest.raises(ValueError, match="6 x 3"):
        freedom.march(V, 2, 1, 1.0, 1.0)


@pytest.mark.parametrize("theta, theta0", [(60, 45), (90, 90), (120, 90), (20, 160)])
def test_exploring_draws_the_asked_angles(theta, theta0):
    figure = beyond_rho.explore(theta, theta0)
    words = " ".join(text.get_text() for ax in figure.axes for text in ax.texts)
    plt.close(figure)
    assert rf"\theta={theta:.1f}\degree" in words and rf"\theta_0={theta0:.1f}\degree" in words
    with pytest.raises(ValueError, match="theta0"):
        beyond_rho.explore(60, 180)
