"""`moebius` against the direct formulas, invariants, finite differences and the plane maps."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.spatial.transform import Rotation

from inetlib import conformal, moebius, surfaces

RANDOM = np.random.default_rng(5)
V = RANDOM.normal(size=(12, 3))
ON_SPHERE = V / np.linalg.norm(V, axis=1)[:, None]
CENTRE, RADIUS, SHIFT = np.array([0.7, -1.9, 2.4]), 1.3, np.array([-0.4, 0.8, 1.5])
ROTATION = np.eye(5)
ROTATION[:3, :3] = TURN = np.linalg.qr(RANDOM.normal(size=(3, 3)))[0]
FAR = moebius.inversion(CENTRE, RADIUS) @ ROTATION @ moebius.inversion((0, 0, 4), 3)
FAR = FAR @ moebius.inversion((5, 1, 0), 4)

number = st.floats(-3, 3)
vectors = st.tuples(number, number, number).map(np.array)
sizes = st.floats(0.2, 5)


def inverted(x, centre, radius):
    """The inversion as its definition says it."""
    centre = np.asarray(centre)
    return centre + radius**2 * (x - centre) / np.sum((x - centre) ** 2, axis=-1, keepdims=True)


@given(vectors, sizes, st.floats(1, 5), st.floats(1, 5))
def test_inversions_are_their_definition_and_two_about_one_centre_scale(centre, radius, one, two):
    away, M = V + centre + 6, moebius.inversion(centre, radius)
    found = moebius.apply(M, away)
    np.testing.assert_allclose(found, inverted(away, centre, radius), rtol=1e-10, atol=1e-10)
    np.testing.assert_allclose(M @ M, np.eye(5), atol=1e-7)
    M = moebius.inversion(centre, two) @ moebius.inversion(centre, one)
    wanted = centre + (two / one) ** 2 * (V - centre)
    np.testing.assert_allclose(moebius.apply(M, V), wanted, rtol=1e-8, atol=1e-8)


def test_the_sphere_of_inversion_stays_spheres_go_to_spheres_and_circles_to_circles():
    np.testing.assert_allclose(moebius.apply(moebius.inversion(), V), inverted(V, 0, 1))
    on = CENTRE + RADIUS * ON_SPHERE
    M = moebius.inversion(CENTRE, RADIUS)
    np.testing.assert_allclose(moebius.apply(M, on), on, atol=1e-13)
    inside = moebius.apply(M, CENTRE + 0.3 * (on - CENTRE))
    np.testing.assert_allclose(np.linalg.norm(inside - CENTRE, axis=1), RADIUS / 0.3)
    mapped = moebius.apply(FAR, SHIFT + 0.9 * ON_SPHERE)
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
    assert spread[2] < 1e-12


def test_matrices_keep_the_lorentz_product_and_points_may_have_any_shape():
    J = np.diag([1, 1, 1, 1, -1])
    np.testing.assert_allclose(FAR.T @ J @ FAR, J, atol=1e-11)
    assert np.linalg.det(moebius.inversion(CENTRE, RADIUS)) == pytest.approx(-1)  # orientation
    X = moebius.lift(V)
    np.testing.assert_allclose(np.einsum("ij,jk,ik->i", X, J, X), 0, atol=1e-13)
    np.testing.assert_allclose(X[:, 4] - X[:, 3], 1, rtol=1e-13)
    np.testing.assert_array_equal(X[:, :3], V)
    block = V.reshape(2, 6, 3)
    np.testing.assert_array_equal(moebius.apply(FAR, block).reshape(-1, 3), moebius.apply(FAR, V))
    single = moebius.apply(FAR, V[0])
    assert single.shape == (3,)
    np.testing.assert_allclose(single, moebius.apply(FAR, V)[0], rtol=1e-14)
    np.testing.assert_allclose(moebius.apply(-FAR, V), moebius.apply(FAR, V), rtol=1e-14)


@given(vectors, st.floats(6, 12), vectors, sizes)
def test_products_are_compositions_and_the_inverse_matrix_undoes(centre, radius, other, size):
    one, two = moebius.inversion(centre + 6, radius), moebius.inversion(other - 6, 10 + size)
    step = moebius.apply(two, moebius.apply(one, V))
    np.testing.assert_allclose(moebius.apply(two @ one, V), step, atol=1e-8)
    np.testing.assert_allclose(moebius.apply(np.linalg.inv(two @ one), step), V, atol=1e-7)


def test_cross_ratios_are_kept_and_the_derivative_is_a_multiple_of_an_orthogonal_matrix():
    def cross_ratios(P):
        a, b, c, d = P.reshape(4, 3, 3)
        ab, cd, ad, cb = np.linalg.norm([a - b, c - d, a - d, c - b], axis=2)
        return ab * cd / (ad * cb)

    found = cross_ratios(moebius.apply(FAR, V))
    np.testing.assert_allclose(found, cross_ratios(V), rtol=1e-11)
    for x in V[:4]:
        columns = [moebius.apply(FAR, x + h) - moebius.apply(FAR, x - h) for h in 1e-5 * np.eye(3)]
        D = np.stack(columns, axis=-1) / 2e-5
        scale = np.cbrt(abs(np.linalg.det(D)))
        np.testing.assert_allclose(D.T @ D / scale**2, np.eye(3), atol=1e-8)
        assert np.linalg.det(D) * np.linalg.det(FAR) > 0


def test_the_pole_of_a_composition_is_found_and_a_similarity_has_none():
    np.testing.assert_allclose(moebius.pole(moebius.inversion(CENTRE, RADIUS)), CENTRE)
    wanted = inverted(inverted(TURN.T @ CENTRE, (0, 0, 4), 3), (5, 1, 0), 4)
    np.testing.assert_allclose(moebius.pole(FAR), wanted, atol=1e-12)
    assert moebius.pole(ROTATION) is None
    assert moebius.pole(moebius.inversion(radius=2) @ moebius.inversion(radius=1)) is None


def test_the_vertex_that_goes_to_infinity_is_named():
    net = V.copy()
    net[7] = moebius.pole(FAR)
    with pytest.raises(ValueError, match="vertex 7 goes to infinity: move the pole off the net"):
        moebius.apply(FAR, net)
    with pytest.raises(ValueError, match=r"vertex \(1, 1\) goes to infinity"):
        moebius.apply(FAR, net.reshape(2, 6, 3))
    with pytest.raises(ValueError, match="vertex goes to infinity"):
        moebius.apply(moebius.inversion(), np.zeros(3))
    near = CENTRE + np.array([0, 1e-3, 0])  # still has an image
    found = moebius.apply(moebius.inversion(CENTRE, 1), near)
    np.testing.assert_allclose(found, CENTRE + np.array([0, 1e3, 0]), atol=1e-5)
    new = moebius.image(moebius.inversion((1, 0, 0)), surfaces.CYLINDER)  # through the pole
    assert new.point(1.0, 1.0).shape == (3,)
    with pytest.raises(ValueError, match=r"vertex 2 goes to infinity"):
        new.point(np.array([1.0, 2.0, 0.0]), 0.0)


ISOTHERMAL = (surfaces.CYLINDER, surfaces.SPHERE, surfaces.CATENOID, surfaces.HELICOID)


@pytest.mark.parametrize("surface", [*ISOTHERMAL, surfaces.conjugate(0.7)], ids=lambda s: s.name)
def test_the_image_of_an_isothermal_surface_is_isothermal(surface):
    new = moebius.image(moebius.inversion((0.3, 5, -4), 2), surface)
    assert new.name == f"Moebius image of the {surface.name}"
    u, v = np.meshgrid(np.linspace(-1, 2, 5), np.linspace(-1, 1, 4), indexing="ij")
    wanted = inverted(surface.point(u, v), (0.3, 5, -4), 2)
    np.testing.assert_allclose(new.point(u, v), wanted, rtol=1e-10)
    step = 1e-5
    along_u = new.point(u + step, v) - new.point(u - step, v)
    along_v = new.point(u, v + step) - new.point(u, v - step)
    pairs = (along_u, along_u), (along_u, along_v), (along_v, along_v)
    E, F, G = (np.sum(a * b, axis=-1) for a, b in pairs)
    np.testing.assert_allclose(G / E, 1, atol=1e-6)
    np.testing.assert_allclose(F / E, 0, atol=1e-6)


Z = np.array([0, 1, -2j, 0.3 + 0.4j, -5 + 7j, 1e-9, 1e6])


def test_stereographic_is_an_inversion_and_comes_back_up_to_the_north_pole():
    w = moebius.stereographic(ON_SPHERE)
    plane = np.c_[w.real, w.imag, 0 * w.real]
    np.testing.assert_allclose(inverted(ON_SPHERE, (0, 0, 1), np.sqrt(2)), plane, atol=1e-13)
    P = moebius.sphere_points(Z)
    np.testing.assert_allclose(np.linalg.norm(P, axis=1), 1, atol=1e-15)
    np.testing.assert_allclose(moebius.stereographic(P), Z, rtol=1e-9)
    np.testing.assert_array_equal(moebius.sphere_points(0), [0, 0, -1])
    np.testing.assert_allclose(moebius.sphere_points(1j), [0, 1, 0], atol=1e-16)
    assert moebius.stereographic([0, 0, -1]) == 0
    t = np.array([np.pi - 1e-9, 3.1, 1.0, 0.5, 0.01, 1e-5, 1e-8])
    P = np.stack([np.sin(t), 0 * t, np.cos(t)], axis=1)
    np.testing.assert_allclose(moebius.stereographic(P), 1 / np.tan(t / 2), rtol=1e-12, atol=1e-15)


def test_stereographic_is_conformal():
    z, h = Z[1:5], 1e-5
    along_x = (moebius.sphere_points(z + h) - moebius.sphere_points(z - h)) / (2 * h)
    along_y = (moebius.sphere_points(z + 1j * h) - moebius.sphere_points(z - 1j * h)) / (2 * h)
    scale = 2 / (1 + abs(z) ** 2)
    np.testing.assert_allclose(np.linalg.norm(along_x, axis=1), scale, rtol=1e-6)
    np.testing.assert_allclose(np.linalg.norm(along_y, axis=1), scale, rtol=1e-6)
    np.testing.assert_allclose(np.sum(along_x * along_y, axis=1), 0, atol=1e-8)


@given(number, number, number)
def test_a_rotation_of_the_sphere_is_a_moebius_transformation_of_the_plane(first, angle, last):
    """Rx(t): z -> (cos(t/2) z + i sin(t/2)) / (i sin(t/2) z + cos(t/2)); Rz(t): exp(it) z."""
    turn = Rotation.from_euler("zxz", [first, angle, last])
    c, s = np.cos(angle / 2), 1j * np.sin(angle / 2)
    plane = np.array([[c, s], [s, c]])
    plane = np.diag([np.exp(1j * last), 1]) @ plane @ np.diag([np.exp(1j * first), 1])
    z = 0.9 * np.exp(2j * np.pi * np.arange(8) / 8 + 0.1j) * np.linspace(0.4, 1, 8)
    rotated = turn.apply(moebius.sphere_points(z))
    wanted = moebius.sphere_points(conformal.moebius(plane, z))
    np.testing.assert_allclose(rotated, wanted, atol=1e-12)


BAD_MATRICES = {
    "a 3 x 3 matrix": (np.eye(3), "5 x 5 matrix"),
    "NaN": (np.full((5, 5), np.nan), "finite numbers"),
    "twice a Lorentz matrix": (2 * FAR, "no Lorentz matrix"),
    "an orthogonal matrix": (np.linalg.qr(RANDOM.normal(size=(5, 5)))[0], "no Lorentz matrix"),
    "zero": (np.zeros((5, 5)), "no Lorentz matrix"),
    "a slightly damaged one": (FAR + 1e-6 * np.abs(FAR).max() * np.eye(5), "no Lorentz matrix"),
}


@pytest.mark.parametrize(("M", "words"), BAD_MATRICES.values(), ids=BAD_MATRICES)
def test_matrices_that_are_not_lorentz_are_refused(M, words):
    for use, what in ((moebius.apply, V), (moebius.image, surfaces.SPHERE)):
        with pytest.raises(ValueError, match=words):
            use(M, what)
    with pytest.raises(ValueError, match=words):
        moebius.pole(M)


BAD_ARGUMENTS = {
    "no radius": (lambda: moebius.inversion(radius=0), "radius = 0"),
    "a centre in the plane": (lambda: moebius.inversion((1, 2)), "centre ="),
    "an infinite point": (lambda: moebius.sphere_points([1, 2, np.inf]), "point 2 is not a finite"),
    "plane points": (lambda: moebius.apply(FAR, np.zeros((4, 2))), r"V has the shape \(4, 2\)"),
    "infinite": (lambda: moebius.apply(FAR, [[0, 0, -1], [0, np.inf, 0]]), "vertex 1 has a coord"),
    "plane": (lambda: moebius.stereographic(np.zeros((4, 2))), r"V has the shape \(4, 2\)"),
    "off": (lambda: moebius.stereographic([[0, 0, -1], [0, 1.000001, 0]]), "vertex 1 does not lie"),
    "north pole": (lambda: moebius.stereographic([[0, 0, -1], [0, 0, 1]]), "vertex 1 is the north"),
}


@pytest.mark.parametrize(("call", "words"), BAD_ARGUMENTS.values(), ids=BAD_ARGUMENTS)
def test_bad_arguments_are_refused(call, words):
    with pytest.raises(ValueError, match=words):
        call()
