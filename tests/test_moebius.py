"""`moebius` against the direct formulas, invariants, finite differences and the plane maps."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from inetlib import conformal, moebius, surfaces

RANDOM = np.random.default_rng(5)
V = RANDOM.normal(size=(12, 3))
CENTRE, RADIUS, SHIFT = np.array([0.7, -1.9, 2.4]), 1.3, np.array([-0.4, 0.8, 1.5])
TURN = np.linalg.qr(RANDOM.normal(size=(3, 3)))[0]
TURN = TURN * np.sign(np.linalg.det(TURN))
FAR = moebius.inversion(CENTRE, RADIUS) @ moebius.similarity(TURN, 0.6, SHIFT)

number = st.floats(-3, 3)
vectors = st.tuples(number, number, number).map(np.array)
sizes = st.floats(0.2, 5)


def inverted(x, centre, radius):
    """The inversion as its definition says it."""
    return centre + radius**2 * (x - centre) / np.sum((x - centre) ** 2, axis=-1, keepdims=True)


def jacobian(f, x, step=1e-5):
    columns = [(f(x + step * e) - f(x - step * e)) / (2 * step) for e in np.eye(3)]
    return np.stack(columns, axis=-1)


# --- inversions and similarities ----------------------------------------------------------


@given(vectors, sizes)
def test_an_inversion_is_its_definition(centre, radius):
    away = V + centre + 6
    found = moebius.apply(moebius.inversion(centre, radius), away)
    np.testing.assert_allclose(found, inverted(away, centre, radius), rtol=1e-10, atol=1e-10)


@given(vectors, sizes, st.sampled_from([-1, 1]))
def test_a_similarity_is_its_definition(shift, scale, side):
    found = moebius.apply(moebius.similarity(side * TURN, scale, shift), V)
    np.testing.assert_allclose(found, scale * (V @ (side * TURN).T) + shift, atol=1e-11)


def test_the_defaults_are_the_unit_sphere_and_the_identity():
    np.testing.assert_allclose(moebius.apply(moebius.inversion(), V), inverted(V, 0, 1))
    np.testing.assert_array_equal(moebius.similarity(), np.eye(5))


def test_the_sphere_of_inversion_stays_and_its_inside_goes_out():
    on = CENTRE + RADIUS * V / np.linalg.norm(V, axis=1)[:, None]
    M = moebius.inversion(CENTRE, RADIUS)
    np.testing.assert_allclose(moebius.apply(M, on), on, atol=1e-13)
    inside = moebius.apply(M, CENTRE + 0.3 * (on - CENTRE))
    np.testing.assert_allclose(np.linalg.norm(inside - CENTRE, axis=1), RADIUS / 0.3)


def test_matrices_keep_the_lorentz_product_and_lifted_points_have_length_0():
    J = np.diag([1, 1, 1, 1, -1])
    np.testing.assert_allclose(FAR.T @ J @ FAR, J, atol=1e-12)
    X = moebius.lift(V)
    np.testing.assert_allclose(np.einsum("ij,jk,ik->i", X, J, X), 0, atol=1e-13)
    np.testing.assert_allclose(X[:, 4] - X[:, 3], 1, rtol=1e-13)
    np.testing.assert_array_equal(X[:, :3], V)


def test_the_determinant_tells_the_orientation():
    assert np.linalg.det(moebius.inversion(CENTRE, RADIUS)) == pytest.approx(-1)
    assert np.linalg.det(moebius.similarity(TURN, 0.6, SHIFT)) == pytest.approx(1)
    assert np.linalg.det(moebius.similarity(-TURN)) == pytest.approx(-1)


@given(vectors, st.floats(6, 12), vectors, sizes)
def test_products_are_compositions_and_the_inverse_matrix_undoes(centre, radius, shift, scale):
    one = moebius.inversion(centre + 6, radius)
    two = moebius.similarity(TURN, scale, shift)
    step = moebius.apply(two, moebius.apply(one, V))
    np.testing.assert_allclose(moebius.apply(two @ one, V), step, atol=1e-9)
    np.testing.assert_allclose(moebius.apply(np.linalg.inv(two @ one), step), V, atol=1e-10)
    np.testing.assert_allclose(one @ one, np.eye(5), atol=1e-8)


def test_any_shape_of_points_and_any_multiple_of_the_order():
    block = V.reshape(2, 6, 3)
    np.testing.assert_array_equal(moebius.apply(FAR, block).reshape(-1, 3), moebius.apply(FAR, V))
    single = moebius.apply(FAR, V[0])
    assert single.shape == (3,)
    np.testing.assert_allclose(single, moebius.apply(FAR, V)[0], rtol=1e-14)
    np.testing.assert_allclose(moebius.apply(-FAR, V), moebius.apply(FAR, V), rtol=1e-14)


# --- what every Moebius transformation keeps ----------------------------------------------


def test_cross_ratios_of_distances_are_kept():
    def cross_ratios(P):
        a, b, c, d = P.reshape(4, 3, 3)
        length = np.linalg.norm
        top = length(a - b, axis=1) * length(c - d, axis=1)
        return top / (length(a - d, axis=1) * length(c - b, axis=1))

    found = cross_ratios(moebius.apply(FAR, V))
    np.testing.assert_allclose(found, cross_ratios(V), rtol=1e-11)


def test_spheres_go_to_spheres_and_circles_to_circles():
    on = SHIFT + 0.9 * V / np.linalg.norm(V, axis=1)[:, None]
    mapped = moebius.apply(FAR, on)
    # |x|^2 - 2 a.x - b = 0: four unknowns, twelve points.
    system = np.c_[2 * mapped, np.ones(12)]
    *_, b = fit = np.linalg.lstsq(system, (mapped**2).sum(axis=1))[0]
    residual = np.linalg.norm(mapped - fit[:3], axis=1) - np.sqrt(b + fit[:3] @ fit[:3])
    np.testing.assert_allclose(residual, 0, atol=1e-11)
    t = np.linspace(0, 6, 12)
    circle = SHIFT + np.cos(t)[:, None] * TURN[0] + np.sin(t)[:, None] * TURN[1]
    flat = moebius.apply(FAR, circle)
    spread = np.linalg.svd(flat - flat.mean(axis=0), compute_uv=False)
    assert spread[1] > 0.05
    assert spread[2] < 1e-13


def test_the_derivative_is_a_multiple_of_an_orthogonal_matrix():
    for x in V[:4]:
        D = jacobian(lambda y: moebius.apply(FAR, y), x)
        scale = np.cbrt(abs(np.linalg.det(D)))
        np.testing.assert_allclose(D.T @ D / scale**2, np.eye(3), atol=1e-8)
        assert np.linalg.det(D) < 0  # one inversion


# --- the pole -----------------------------------------------------------------------------


def test_the_pole_of_a_composition_is_found():
    np.testing.assert_allclose(moebius.pole(moebius.inversion(CENTRE, RADIUS)), CENTRE)
    wanted = TURN.T @ (CENTRE - SHIFT) / 0.6
    np.testing.assert_allclose(moebius.pole(FAR), wanted, atol=1e-12)
    assert moebius.pole(moebius.similarity(TURN, 0.6, SHIFT)) is None


def test_the_vertex_that_goes_to_infinity_is_named():
    net = V.copy()
    net[7] = moebius.pole(FAR)
    with pytest.raises(ValueError, match="vertex 7 goes to infinity: move the pole off the net"):
        moebius.apply(FAR, net)
    with pytest.raises(ValueError, match=r"vertex \(1, 1\) goes to infinity"):
        moebius.apply(FAR, net.reshape(2, 6, 3))
    with pytest.raises(ValueError, match="vertex goes to infinity"):
        moebius.apply(moebius.inversion(), np.zeros(3))


def test_a_vertex_near_the_pole_still_has_an_image():
    near = CENTRE + np.array([0, 1e-3, 0])
    found = moebius.apply(moebius.inversion(CENTRE, 1), near)
    np.testing.assert_allclose(found, CENTRE + np.array([0, 1e3, 0]), atol=1e-5)


NETS = {
    "a cloud": V,
    "a sphere": V / np.linalg.norm(V, axis=1)[:, None],
    "a planar net": conformal.quads(conformal.sheared_grid(1, 0.8, 9, 9))[0],
    "a grid": RANDOM.normal(size=(3, 4, 3)),
}


@pytest.mark.parametrize("what", NETS)
@pytest.mark.parametrize("clearance", [0.05, 0.2, 0.7, 3])
def test_away_from_keeps_its_distance(what, clearance):
    net = NETS[what]
    centre = moebius.away_from(net, clearance)
    points = net.reshape(-1, 3)
    diagonal = np.linalg.norm(points.max(axis=0) - points.min(axis=0))
    nearest = np.linalg.norm(points - centre, axis=1).min()
    assert nearest >= clearance * diagonal
    assert nearest <= (clearance + 1.2) * diagonal
    assert np.isfinite(moebius.apply(moebius.inversion(centre), net)).all()


def test_away_from_leaves_a_horizontal_net_upwards():
    centre = moebius.away_from(NETS["a planar net"], 0.2)
    middle = NETS["a planar net"].mean(axis=0)
    np.testing.assert_allclose(centre[:2], middle[:2], atol=1e-12)
    assert centre[2] > 0


def test_a_distance_that_ties_with_the_clearance_is_too_small():
    x, y = np.meshgrid(np.linspace(-1, 1, 5), np.linspace(-1, 1, 5))
    net = np.stack([x, y, 0 * x], axis=-1).reshape(-1, 3)  # the middle is a vertex
    for seed in range(8):
        noise = np.random.default_rng(seed).standard_normal(net.shape)
        centre = moebius.away_from(net * (1 + 1e-13 * noise), 0.2)
        np.testing.assert_allclose(centre, [0, 0, 0.3 * np.sqrt(8)], atol=1e-9)


# --- whole surfaces -----------------------------------------------------------------------

ISOTHERMAL = (
    surfaces.CYLINDER,
    surfaces.SPHERE,
    surfaces.CATENOID,
    surfaces.HELICOID,
    surfaces.conjugate(0.7),
)


@pytest.mark.parametrize("surface", ISOTHERMAL, ids=lambda s: s.name)
def test_the_image_of_an_isothermal_surface_is_isothermal(surface):
    M = moebius.inversion((0.3, 5, -4), 2)
    new = moebius.image(M, surface)
    assert new.name == f"Moebius image of the {surface.name}"
    u, v = np.meshgrid(np.linspace(-1, 2, 5), np.linspace(-1, 1, 4), indexing="ij")
    wanted = inverted(surface.point(u, v), np.array([0.3, 5, -4]), 2)
    np.testing.assert_allclose(new.point(u, v), wanted, rtol=1e-10)
    step = 1e-5
    along_u = new.point(u + step, v) - new.point(u - step, v)
    along_v = new.point(u, v + step) - new.point(u, v - step)
    E, F, G = (
        np.sum(a * b, axis=-1) for a, b in ((along_u,) * 2, (along_u, along_v), (along_v,) * 2)
    )
    np.testing.assert_allclose(G / E, 1, atol=1e-6)
    np.testing.assert_allclose(F / E, 0, atol=1e-6)


def test_a_surface_through_the_pole_says_so_where_it_is_asked():
    new = moebius.image(moebius.inversion((1, 0, 0)), surfaces.CYLINDER)
    assert new.point(1.0, 1.0).shape == (3,)
    with pytest.raises(ValueError, match=r"vertex 2 goes to infinity"):
        new.point(np.array([1.0, 2.0, 0.0]), 0.0)


# --- stereographic projection -------------------------------------------------------------

Z = np.array([0, 1, -2j, 0.3 + 0.4j, -5 + 7j, 1e-9, 1e6])


def test_stereographic_is_the_line_from_the_north_pole_to_the_plane():
    P = V / np.linalg.norm(V, axis=1)[:, None]
    w = moebius.stereographic(P)
    north, plane = np.array([0, 0, 1.0]), np.c_[w.real, w.imag, 0 * w.real]
    np.testing.assert_allclose(np.cross(P - north, plane - north), 0, atol=1e-12)


def test_sphere_points_lie_on_the_sphere_and_come_back():
    P = moebius.sphere_points(Z)
    np.testing.assert_allclose(np.linalg.norm(P, axis=1), 1, atol=1e-15)
    np.testing.assert_allclose(moebius.stereographic(P), Z, rtol=1e-9)
    np.testing.assert_array_equal(moebius.sphere_points(0), [0, 0, -1])
    np.testing.assert_allclose(moebius.sphere_points(1j), [0, 1, 0], atol=1e-16)


def test_points_come_back_up_to_the_north_pole():
    t = np.array([np.pi - 1e-9, 3.1, 1.0, 0.5, 0.01, 1e-5, 1e-8])
    P = np.stack([np.sin(t), 0 * t, np.cos(t)], axis=1)
    np.testing.assert_allclose(moebius.stereographic(P), 1 / np.tan(t / 2), rtol=1e-12, atol=1e-15)


def test_stereographic_is_the_restriction_of_an_inversion():
    P = V / np.linalg.norm(V, axis=1)[:, None]
    w = moebius.stereographic(P)
    mapped = moebius.apply(moebius.inversion((0, 0, 1), np.sqrt(2)), P)
    np.testing.assert_allclose(mapped, np.c_[w.real, w.imag, 0 * w.real], atol=1e-13)


def test_stereographic_is_conformal():
    z, h = Z[1:5], 1e-5
    along_x = (moebius.sphere_points(z + h) - moebius.sphere_points(z - h)) / (2 * h)
    along_y = (moebius.sphere_points(z + 1j * h) - moebius.sphere_points(z - 1j * h)) / (2 * h)
    scale = 2 / (1 + abs(z) ** 2)
    np.testing.assert_allclose(np.linalg.norm(along_x, axis=1), scale, rtol=1e-6)
    np.testing.assert_allclose(np.linalg.norm(along_y, axis=1), scale, rtol=1e-6)
    np.testing.assert_allclose(np.sum(along_x * along_y, axis=1), 0, atol=1e-8)


@given(st.floats(-3, 3), st.floats(-3, 3), st.floats(-3, 3))
def test_a_rotation_of_the_sphere_is_a_moebius_transformation_of_the_plane(angle, turn, tilt):
    """Rx(t): z -> (cos(t/2) z + i sin(t/2)) / (i sin(t/2) z + cos(t/2)); Rz(t): exp(it) z."""
    c, s = np.cos(angle), np.sin(angle)
    about_x = np.array([[1, 0, 0], [0, c, -s], [0, s, c]])
    about_z = [
        np.array([[np.cos(t), -np.sin(t), 0], [np.sin(t), np.cos(t), 0], [0, 0, 1]])
        for t in (turn, tilt)
    ]
    half_c, half_s = np.cos(angle / 2), 1j * np.sin(angle / 2)
    plane = np.diag([np.exp(1j * turn), 1]) @ [[half_c, half_s], [half_s, half_c]]
    plane = plane @ np.diag([np.exp(1j * tilt), 1])
    z = 0.9 * np.exp(2j * np.pi * np.arange(8) / 8 + 0.1j) * np.linspace(0.4, 1, 8)
    M = moebius.similarity(about_z[0] @ about_x @ about_z[1])
    rotated = moebius.apply(M, moebius.sphere_points(z))
    wanted = moebius.sphere_points(conformal.moebius(plane, z))
    np.testing.assert_allclose(rotated, wanted, atol=1e-12)


# --- refusals -----------------------------------------------------------------------------


def test_a_vertex_off_the_sphere_or_at_the_north_pole_is_named():
    P = V / np.linalg.norm(V, axis=1)[:, None]
    P[4] *= 1 + 1e-6
    with pytest.raises(ValueError, match="vertex 4 does not lie on the unit sphere"):
        moebius.stereographic(P)
    P[4] = 0, 0, 1
    with pytest.raises(ValueError, match="vertex 4 is the north pole"):
        moebius.stereographic(P)
    assert moebius.stereographic([0, 0, -1]) == 0


BAD_MATRICES = {
    "a 3 x 3 matrix": (np.eye(3), "5 x 5 matrix"),
    "NaN": (np.full((5, 5), np.nan), "finite numbers"),
    "twice a Lorentz matrix": (2 * FAR, "no Lorentz matrix"),
    "an orthogonal matrix": (np.linalg.qr(RANDOM.normal(size=(5, 5)))[0], "no Lorentz matrix"),
    "zero": (np.zeros((5, 5)), "no Lorentz matrix"),
    "a slightly damaged one": (FAR + 1e-6 * np.eye(5), "no Lorentz matrix"),
}


@pytest.mark.parametrize("what", BAD_MATRICES)
@pytest.mark.parametrize(
    "use",
    [lambda M: moebius.apply(M, V), moebius.pole, lambda M: moebius.image(M, surfaces.SPHERE)],
    ids=["apply", "pole", "image"],
)
def test_matrices_that_are_not_lorentz_are_refused(what, use):
    M, words = BAD_MATRICES[what]
    with pytest.raises(ValueError, match=words):
        use(M)


@pytest.mark.parametrize("f", [lambda P: moebius.apply(FAR, P), moebius.stereographic])
def test_points_must_be_points(f):
    with pytest.raises(ValueError, match=r"V has the shape \(4, 2\)"):
        f(np.zeros((4, 2)))
    with pytest.raises(ValueError, match="vertex 1 has a coordinate that is not a finite number"):
        f([[0, 0, -1], [0, np.inf, 0]])


BAD_ARGUMENTS = {
    "no radius": (lambda: moebius.inversion(radius=0), "radius = 0"),
    "a negative scale": (lambda: moebius.similarity(scale=-2), "scale = -2"),
    "a centre in the plane": (lambda: moebius.inversion((1, 2)), "centre ="),
    "an infinite shift": (lambda: moebius.similarity(shift=(0, np.inf, 0)), "shift ="),
    "a sheared rotation": (lambda: moebius.similarity([[1, 1, 0], [0, 1, 0], [0, 0, 1]]), "orthog"),
    "NaN as rotation": (lambda: moebius.similarity(np.full((3, 3), np.nan)), "orthogonal 3 x 3"),
    "an infinite point": (lambda: moebius.sphere_points([1, 2, np.inf]), "point 2 is not a finite"),
    "one point": (lambda: moebius.away_from([[1, 2, 3]]), "two different points"),
    "the same point twice": (lambda: moebius.away_from([[1, 2, 3]] * 2), "two different points"),
    "no clearance": (lambda: moebius.away_from(V, 0), "clearance = 0"),
}


@pytest.mark.parametrize("what", BAD_ARGUMENTS)
def test_bad_arguments_are_refused(what):
    call, words = BAD_ARGUMENTS[what]
    with pytest.raises(ValueError, match=words):
        call()
