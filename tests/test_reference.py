"""`reference` against closed forms, brute-force searches and the conditions of a closest point."""

import numpy as np
import pytest
from scipy.spatial import ConvexHull, cKDTree
from scipy.spatial.transform import Rotation

from inetlib import mesh as quads
from inetlib import moebius, reference, surfaces
from inetlib.surfaces import CATENOID, CYLINDER, SPHERE

TAU = 2 * np.pi
TURN = Rotation.from_rotvec([0.4, -0.7, 1.1])
ROUND = SPHERE.point, (0, TAU), (-1, 1)
RNG = np.random.default_rng()


@pytest.fixture(autouse=True)
def the_same_numbers_in_any_order():
    RNG.bit_generator.state = np.random.default_rng(4).bit_generator.state


def norm(x):
    return np.linalg.norm(x, axis=-1, keepdims=True)


def directions(k):
    d = RNG.normal(size=(k, 3))
    return d / norm(d)


def dot(a, b):
    return np.einsum("ij,ij->i", a, b)


def grid(m, n, height=None):
    """A grid of quads over the unit square, as it is or with z = height(x, y)."""
    x, y = np.meshgrid(np.linspace(0, 1, m + 1), np.linspace(0, 1, n + 1), indexing="ij")
    z = 0 * x if height is None else height(x, y)
    return np.stack([x, y, z], axis=-1).reshape(-1, 3), quads.grid_quads(m, n)


def wavy(x, y):
    return 0.2 * np.sin(4 * x) * np.cos(3 * y) + 0.1 * x


def ball(count):
    """A unit sphere of triangles between points on a spiral, outward normals."""
    k = np.arange(count) + 0.5
    z, angle = 1 - 2 * k / count, np.pi * (1 + 5**0.5) * k
    V = np.stack([np.sqrt(1 - z**2) * np.cos(angle), np.sqrt(1 - z**2) * np.sin(angle), z], axis=1)
    F = ConvexHull(V).simplices.astype(np.int64)
    inward = np.linalg.det(V[F]) < 0
    return V, np.where(inward[:, None], F[:, ::-1], F)


def tube(m, n):
    """A cylinder of radius 1 and height 1 of m x n quads, outward normals, two boundary loops."""
    i, j = np.divmod(np.arange(m * (n + 1)), n + 1)
    V = np.stack([np.cos(TAU * i / m), np.sin(TAU * i / m), j / n], axis=1)
    return V, quads.grid_quads(m, n) % (m * (n + 1))


def fine_points(V, F, parts=40):
    """Many points of all triangles."""
    i, j = np.divmod(np.arange((parts + 1) ** 2), parts + 1)
    weights = np.stack([parts - i - j, i, j], axis=1)[i + j <= parts] / parts
    return (weights @ V[F]).reshape(-1, 3)


def test_feet_and_normals_of_squares_are_those_of_the_plane_and_do_not_change_later():
    V, Q = grid(5, 4)
    R = reference.mesh(TURN.apply(V), Q)
    P = RNG.uniform(-0.5, 1.5, (300, 3))
    feet, normals = R.closest(TURN.apply(P))
    wanted = np.clip(P, 0, 1) * [1, 1, 0]
    np.testing.assert_allclose(feet, TURN.apply(wanted), atol=1e-14)
    np.testing.assert_allclose(normals, np.tile(TURN.apply([0, 0, 1]), (300, 1)), atol=1e-14)
    assert R.diagonal == pytest.approx(np.linalg.norm(np.ptp(TURN.apply(V), axis=0)))
    V, Q = grid(2, 2)
    V = np.concatenate([V, [[100.0, 0, 0]]])
    R = reference.mesh(V, Q)
    V += 7
    assert R.diagonal == pytest.approx(2**0.5)
    feet, _ = R.closest([[0.3, 0.4, 1], [50, 0.5, 0]])
    np.testing.assert_allclose(feet, [[0.3, 0.4, 0], [1, 0.5, 0]], atol=1e-15)


@pytest.mark.parametrize("sides", [3, 4])
def test_feet_are_never_farther_than_the_nearest_of_many_points_of_the_faces(sides):
    V, Q = grid(6, 5, wavy)
    R = reference.mesh(V, Q if sides == 4 else np.concatenate([Q[:, :3], Q[:, [0, 2, 3]]]))
    P = RNG.uniform([-0.3, -0.3, -0.5], [1.3, 1.3, 0.7], (400, 3))
    feet, normals = R.closest(P)
    many = cKDTree(fine_points(R.V, R.F))
    near, far = many.query(P)[0], norm(P - feet)[:, 0]
    assert (far <= near + 1e-14).all()
    spacing = 2**0.5 / 5 / 40  # no point of a face is farther from one of the many
    assert (near**2 - far**2 <= 2 * far * spacing + spacing**2).all()
    assert many.query(feet)[0].max() < spacing
    np.testing.assert_allclose(norm(normals), 1, rtol=1e-14)
    np.testing.assert_allclose(R.closest(many.data[::50])[0], many.data[::50], atol=1e-15)


def test_a_fine_sphere_has_feet_and_normals_along_the_radius():
    V, F = ball(1000)
    d = directions(500)
    feet, normals = reference.mesh(V, F).closest(1.3 * d)
    edge = np.linalg.norm(V[F[:, 0]] - V[F[:, 1]], axis=1).max()
    np.testing.assert_allclose(norm(feet), 1, atol=edge**2 / 3)  # the sagitta of a triangle
    assert dot(feet / norm(feet), d).min() > np.cos(edge)
    assert dot(normals, feet / norm(feet)).min() > 1 - edge**4  # far better than the faces'


def test_normals_have_no_jump_across_edges_and_turn_with_the_surface():
    m = 24
    R = reference.mesh(*tube(m, 3))
    angle = np.linspace(0, TAU, 5000)
    P = np.stack([1.2 * np.cos(angle), 1.2 * np.sin(angle), 0 * angle + 0.37], axis=1)
    feet, normals = R.closest(P)
    faces = TAU / m  # by how much the normals of neighbouring faces differ
    turns = np.arccos(np.clip(dot(normals[1:], normals[:-1]), -1, 1))
    assert turns.max() < faces / 50
    radial = feet * [1, 1, 0]
    assert norm(normals - radial / norm(radial)).max() < faces**3 / 10


def test_a_normal_that_cancels_is_replaced_by_that_of_the_face():
    """Two leaves folded together: at the common edge the vertex normals are zero."""
    V = np.array([[0, 0, 0], [0, 1, 0], [1, 0.5, 0], [1, 0.5, 0.0]])
    R = reference.mesh(V, [[1, 0, 2], [0, 1, 3]])
    feet, normals = R.closest([[-1, 0.5, 0.3]])
    np.testing.assert_allclose(feet, [[0, 0.5, 0]], atol=1e-15)
    np.testing.assert_allclose(np.abs(normals), [[0, 0, 1]], atol=1e-15)
    feet, *frame = R.boundary([[0, -0.2, 0], [1, 0, 1]])
    np.testing.assert_allclose(feet[0], [0, 0, 0], atol=1e-15)
    np.testing.assert_allclose(np.abs(frame[2]), [[0, 0, 1]] * 2, atol=1e-12)
    assert_frame(*frame)


def test_turning_and_scaling_the_mesh_turns_and_scales_the_answers():
    V, Q = grid(12, 12, wavy)
    P = RNG.uniform(0, 1, (50, 3))
    one, two = reference.mesh(V, Q), reference.mesh(1e3 * TURN.apply(V) + 5, Q)
    for ask in ("closest", "boundary"):
        feet, *frame = getattr(one, ask)(P)
        there, *turned = getattr(two, ask)(1e3 * TURN.apply(P) + 5)
        np.testing.assert_allclose(there, 1e3 * TURN.apply(feet) + 5, atol=1e-9)
        single = ~np.isin(feet[:, :2], [0, 1]).all(axis=1)  # a corner has two tangents
        assert single.sum() > 40
        for a, b in zip(frame, turned, strict=True):
            np.testing.assert_allclose(b[single], TURN.apply(a)[single], atol=1e-9)


def assert_frame(e1, e2, e3):
    frame = np.stack([e1, e2, e3], axis=1)
    products = np.einsum("kix,kjx->kij", frame, frame)
    np.testing.assert_allclose(products, np.tile(np.eye(3), (len(e1), 1, 1)), atol=1e-13)
    np.testing.assert_allclose(np.linalg.det(frame), 1, rtol=1e-13)


def test_the_boundary_of_a_tilted_square_and_of_one_with_a_hole_by_hand():
    V, Q = grid(4, 4)
    inside = np.array([[0.1, 0.4, 0.5], [0.45, 0.97, -1], [0.9, 0.6, 0], [0.33, -2, 3]])
    wanted = np.array([[0, 0.4, 0], [0.45, 1, 0], [1, 0.6, 0], [0.33, 0, 0]])
    along = np.array([[0, -1, 0], [-1, 0, 0], [0, 1, 0], [1, 0, 0]])  # the square on the left
    feet, e1, e2, e3 = reference.mesh(TURN.apply(V), Q).boundary(TURN.apply(inside))
    np.testing.assert_allclose(feet, TURN.apply(wanted), atol=1e-14)
    np.testing.assert_allclose(e1, TURN.apply(along), atol=1e-14)
    np.testing.assert_allclose(e3, np.tile(TURN.apply([0, 0, 1]), (4, 1)), atol=1e-14)
    assert_frame(e1, e2, e3)
    V, Q = grid(5, 5)
    R = reference.mesh(V, np.delete(Q, 12, axis=0))  # the middle one of 5 x 5
    feet, e1, *_ = R.boundary([[0.5, 0.45, 0.1], [0.05, 0.5, 0]])
    np.testing.assert_allclose(feet, [[0.5, 0.4, 0], [0, 0.5, 0]], atol=1e-15)
    np.testing.assert_allclose(e1, [[-1, 0, 0], [0, -1, 0]], atol=1e-15)


def test_boundary_feet_are_never_farther_than_the_nearest_of_many_boundary_points():
    V, Q = grid(6, 5, wavy)
    (loop,) = quads.boundary_loops(Q)
    t = np.linspace(0, 1, 200)[:, None, None]
    many = cKDTree(((1 - t) * V[loop] + t * V[np.roll(loop, -1)]).reshape(-1, 3))
    P = RNG.uniform([-0.3, -0.3, -0.5], [1.3, 1.3, 0.7], (500, 3))
    feet, *frame = reference.mesh(V, Q).boundary(P)
    near, far = many.query(P)[0], norm(P - feet)[:, 0]
    assert (far <= near + 1e-14).all()
    assert (near - far).max() < 1e-3
    assert many.query(feet)[0].max() < 1e-3
    assert_frame(*frame)


def test_a_round_boundary_has_a_tangent_without_jumps():
    m = 48
    R = reference.mesh(*tube(m, 2))
    angle = np.linspace(0, TAU, 4000)
    for height, sense in ((-0.5, 1), (1.5, -1)):  # the mesh lies on the left of its boundary
        P = np.stack([np.cos(angle), np.sin(angle), 0 * angle + height], axis=1)
        feet, e1, e2, e3 = R.boundary(P)
        assert_frame(e1, e2, e3)
        np.testing.assert_array_equal(feet[:, 2], np.clip(height, 0, 1))
        circle = sense * np.stack([-np.sin(angle), np.cos(angle), 0 * angle], axis=1)
        assert norm(e1 - circle).max() < (TAU / m) ** 3
        assert norm(e3 - P * [1, 1, 0]).max() < (TAU / m) ** 3
        np.testing.assert_allclose(np.abs(e2[:, 2]), 1, atol=1e-6)


def test_corners_turn_by_more_than_30_degrees_and_keep_the_direction_of_the_segment_hit():
    for degrees, corner in ((29, False), (31, True)):
        turn = np.radians(degrees)
        V = np.array([[-1, 0, 0], [0, 0, 0], [np.cos(turn), np.sin(turn), 0], [-0.5, 2, 0]])
        feet, e1, *_ = reference.mesh(V, [[0, 1, 3], [1, 2, 3]]).boundary([[-1e-6, -0.1, 0]])
        np.testing.assert_allclose(feet, [[0, 0, 0]], atol=2e-6)
        half = 0 if corner else turn / 2
        np.testing.assert_allclose(e1, [[np.cos(half), np.sin(half), 0]], atol=1e-5)


@pytest.mark.parametrize("seed", range(8))
def test_whatever_the_rounding_the_boundary_leaves_at_corners_and_30_degrees_make_none(seed):
    R = reference.mesh(*grid(3, 3))
    corners = np.array([[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0]], dtype=float)
    noise = 1e-13 * np.random.default_rng(seed).standard_normal(corners.shape)
    for away in (0, 0.1):
        outside = corners + away * (corners - [0.5, 0.5, 0])
        feet, e1, *_ = R.boundary(outside + noise)
        np.testing.assert_allclose(feet, corners, atol=1e-12)
        np.testing.assert_allclose(e1, [[1, 0, 0], [0, 1, 0], [-1, 0, 0], [0, -1, 0]], atol=1e-9)
    k, angle = np.arange(12), seed + TAU * np.arange(12) / 12
    fan = np.stack([0 * k, k + 1, np.roll(k, -1) + 1], axis=1)
    V = np.stack([np.cos(angle), np.sin(angle), 0 * angle], axis=1)
    feet, e1, *_ = reference.mesh(np.concatenate([0 * V[:1], V]), fan).boundary(1.1 * V)
    np.testing.assert_allclose(feet, V, atol=1e-14)
    np.testing.assert_allclose(dot(e1, feet), 0, atol=1e-12)


def test_feet_of_points_over_a_valley_do_not_hang_on_rounding():
    V, Q = grid(6, 6, lambda x, y: np.abs(x - 0.5) + np.abs(y - 0.5))
    s = np.linspace(0.05, 0.95, 10)
    points = np.concatenate([np.stack([0.5 + 0 * s, s, s + 1], 1), np.stack([s, s, s + 1.2], 1)])
    ends = np.stack([s, s, 0 * s], axis=1)  # inside, as near to two sides of the boundary
    known = None
    for seed in range(4):
        noise = 1 + 1e-13 * np.random.default_rng(seed).standard_normal((30, 3))
        R = reference.mesh(V * (1 + 1e-14 * seed), Q)
        flat = reference.mesh(*grid(6, 6))
        found = *R.closest(points * noise[:20]), *flat.boundary(ends * noise[20:])[:2]
        known = known or found
        for one, two in zip(known, found, strict=True):
            np.testing.assert_allclose(one, two, atol=1e-11)
    far = norm(points - known[0])[:, 0]
    assert (far <= norm(points[:, None] - V).min(axis=(1, 2)) + 1e-12).all()
    np.testing.assert_allclose(norm(ends - known[2])[:, 0], np.minimum(s, 1 - s), atol=1e-11)


def test_bad_points_and_surfaces_without_boundary_are_refused_and_no_points_have_no_feet():
    square, sphere = reference.mesh(*grid(2, 2)), reference.parametric(*ROUND)
    for answer in (square.closest, square.boundary):
        with pytest.raises(ValueError, match=r"points have the shape \(3,\)"):
            answer(np.zeros(3))
        with pytest.raises(ValueError, match="point 1 has a coordinate that is not a finite"):
            answer([[0, 0, 0], [0, np.nan, 0]])
    for answer in (square.closest, square.boundary, sphere.closest):
        assert all(X.shape == (0, 3) for X in answer(np.zeros((0, 3))))
    assert square.has_boundary
    for R in (reference.mesh(*ball(20)), sphere):
        assert not R.has_boundary
        with pytest.raises(ValueError, match=r"no boundary: it is closed, or no `reference\.mesh`"):
            R.boundary(np.zeros((1, 3)))


def test_bad_meshes_and_surfaces_are_refused():
    V, Q = grid(2, 2)
    for faces, words in [
        (np.zeros((0, 3), dtype=int), "no faces"),
        (np.concatenate([Q[:3], Q[3:, ::-1]]), "oriented against each other"),
        ([[0, 1, 4], [1, 0, 3], [3, 0, 1]], "more than two faces"),
        ([[0, 1, 4], [0, 3, 6]], r"triangle 0-3-6 near .* has no area"),
        ([[4, 0, 1], [4, 8, 7]], "vertex 4 near .* form two fans"),
    ]:
        with pytest.raises(ValueError, match=words):
            reference.mesh(V, faces)

    def cut(u, v):
        return CYLINDER.point(u, np.where(u > 0.5, np.nan, v))

    for point, u, v, words in [
        (SPHERE.point, (1, 1), (0, 1), r"u = \(1, 1\): two finite numbers, the lower first"),
        (SPHERE.point, (0, 1), (0, np.inf), "v = "),
        (lambda u, v: u + v, (0, 1), (0, 1), "points .* are wanted"),
        (cut, (0, 1), (0, 1), r"not finite at u = 0\.505, v = 0"),
        (lambda u, v: CYLINDER.point(u + v, 0 * v), (0, 1), (0, 1), "a curve or a point"),
    ]:
        with pytest.raises(ValueError, match=words):
            reference.parametric(point, u, v)


def sphere_tangents(u, v):
    c, t = 1 / np.cosh(v), np.tanh(v)
    along_u = np.stack([-c * np.sin(u), c * np.cos(u), 0 * u], axis=-1)
    return along_u, np.stack([-c * t * np.cos(u), -c * t * np.sin(u), c * c], axis=-1)


@pytest.mark.parametrize("tangents", [None, sphere_tangents])
@pytest.mark.parametrize("off", [0, 1e-3, 0.1, 0.6])
def test_feet_on_the_sphere_are_exact(off, tangents):
    R = reference.parametric(SPHERE.point, (0, TAU), (-4, 4), tangents)
    d = directions(400)
    d = d[np.abs(d[:, 2]) < 0.999]
    feet, normals = R.closest(d * (1 + off * RNG.uniform(-1, 1, (len(d), 1))))
    np.testing.assert_allclose(feet, d, atol=2e-12)
    np.testing.assert_allclose(np.abs(dot(normals, d)), 1, rtol=1e-12)
    assert R.diagonal == pytest.approx(12**0.5, rel=1e-3)


def test_feet_on_the_cylinder_are_exact_and_go_on_beyond_its_rim():
    R = reference.parametric(CYLINDER.point, (0, TAU), (0, 1))
    u, v = RNG.uniform(0, TAU, 300), RNG.uniform(-0.09, 1.09, 300)
    X = CYLINDER.point(u, v)
    feet, normals = R.closest(X * [0.7, 0.7, 1])
    np.testing.assert_allclose(feet, X, atol=1e-12)
    np.testing.assert_allclose(np.abs(dot(normals, X * [1, 1, 0])), 1, rtol=1e-12)
    assert np.allclose(R.closest([[2, 0, 9.0]])[0], [[1, 0, 1.1]])  # not for ever
    plane = reference.parametric(lambda u, v: np.stack([u, v, 0 * u], axis=-1), (0, 2), (0, 1))
    feet, normals = plane.closest([[0.3, 0.8, 50], [1.99, 1.01, -7]])  # far off
    np.testing.assert_allclose(feet, [[0.3, 0.8, 0], [1.99, 1.01, 0]], atol=1e-11)
    np.testing.assert_allclose(np.abs(normals), [[0, 0, 1]] * 2, atol=1e-15)


IMAGE = moebius.image(moebius.inversion((0, 0, 2.5), 1.5), CATENOID)
CURVED = {"catenoid": (CATENOID, 0.15), "moebius image": (IMAGE, 0.05)}


@pytest.mark.parametrize("name", CURVED)
def test_feet_are_orthogonal_and_the_nearest_of_all(name):
    surface, off = CURVED[name]
    R = reference.parametric(surface.point, (0, TAU), (-1.2, 1.2))
    X = surface.point(RNG.uniform(0, TAU, 300), RNG.uniform(-1, 1, 300))
    P = X + off * RNG.uniform(-1, 1, X.shape)
    feet, normals = R.closest(P)
    assert norm(np.cross(P - feet, normals)).max() < 1e-12 * R.diagonal
    np.testing.assert_allclose(norm(normals), 1, rtol=1e-14)
    many = surface.point(*np.meshgrid(np.linspace(0, TAU, 800), np.linspace(-1.3, 1.3, 500)))
    near, far = cKDTree(many.reshape(-1, 3)).query(P)[0], norm(P - feet)[:, 0]
    assert (far <= near + 1e-14).all()
    assert (near - far).max() < 1e-2


@pytest.mark.parametrize("raises", [False, True])
def test_a_surface_that_is_not_finite_or_raises_beyond_its_domain_ends_there(raises):
    def saddle(u, v):
        inside = (u >= 0) & (u <= 1) & (v >= 0) & (v <= 1)
        if raises and not inside.all():
            raise ValueError("u and v from 0 to 1 are wanted")
        return np.where(inside[..., None], np.stack([u, v, u * u - v * v], axis=-1), np.nan)

    P = RNG.uniform(-0.3, 1.3, (400, 3)) * [1, 1, 0.5]
    feet, normals = reference.parametric(saddle, (0, 1), (0, 1)).closest(P)
    assert feet[:, :2].min() == 0
    assert feet[:, :2].max() == 1
    many = saddle(*np.meshgrid(np.linspace(0, 1, 501), np.linspace(0, 1, 501))).reshape(-1, 3)
    near, far = cKDTree(many).query(P)[0], norm(P - feet)[:, 0]
    assert (far <= near + 1e-12).all()
    assert (near - far).max() < 2e-3
    inner = ((feet[:, :2] > 0) & (feet[:, :2] < 1)).all(axis=1)
    assert inner.sum() > 100
    assert norm(np.cross(P - feet, normals))[inner].max() < 1e-6  # rougher near the edge
    wanted = feet * [-2, 2, 0] + [0, 0, 1]
    np.testing.assert_allclose(np.abs(dot(normals, wanted / norm(wanted))), 1, rtol=1e-6)


def test_a_surface_that_stands_still_beyond_its_domain_ends_there():
    """The parameters of `surfaces.mercator` stop at the ends of the profile."""
    profile = surfaces.vase_profile()
    w, t_of_w = surfaces.mercator(profile)
    stop = float(w(profile.stop))
    R = reference.parametric(
        lambda u, v: surfaces.revolve(profile, u, t_of_w(v)), (0, TAU), (0, stop)
    )
    u, t = RNG.uniform(0, TAU, 100), RNG.uniform(0.2, 3, 100)
    X = surfaces.revolve(profile, u, t)
    radial = np.stack([np.cos(u), np.sin(u), 0 * u], axis=1)
    slope = 0.33 * 1.9 * np.cos(1.9 * t + 0.25)
    normal = (radial - slope[:, None] * [0, 0, 1]) / np.hypot(1, slope)[:, None]
    feet, normals = R.closest(X + 0.1 * normal)
    np.testing.assert_allclose(feet, X, atol=1e-10)
    np.testing.assert_allclose(np.abs(dot(normals, normal)), 1, rtol=1e-12)
    rim = surfaces.revolve(profile, u, 0 * t + 3.2)
    feet, _ = R.closest(rim + np.array([0, 0, 0.5]))
    assert (feet[:, 2] <= 3.2).all()


def test_the_poles_of_a_sphere_by_latitude_have_feet_and_normals():
    profile = surfaces.sphere_profile()
    R = reference.parametric(
        lambda u, v: surfaces.revolve(profile, u, v), (0, TAU), (-np.pi / 2, np.pi / 2)
    )
    d = np.concatenate([[[0, 0, 1], [0, 0, -1]], directions(50)])
    for scale in (0.8, 1, 1.1):
        feet, normals = R.closest(scale * d)
        np.testing.assert_allclose(feet, d, atol=1e-9)
        np.testing.assert_allclose(np.abs(dot(normals, d)), 1, rtol=1e-8)
