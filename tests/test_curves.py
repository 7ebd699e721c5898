"""`curves` against scipy's quadrature, polynomials by hand and closed forms."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays
from scipy.integrate import quad

from inetlib import developable

CONTROL = np.array([[0, 0, 0], [3, 0, 0], [6, 3, 1], [6, 6, 3.0]])


@given(arrays(float, (4, 3), elements=st.floats(-9, 9)), st.floats(0, 1))
def test_cubic_bezier_curves_and_their_derivatives(points, t):
    a, b, c, d = points
    s = 1 - t
    curve = developable.bezier(points)
    value = s**3 * a + 3 * s**2 * t * b + 3 * s * t**2 * c + t**3 * d
    first = 3 * (s**2 * (b - a) + 2 * s * t * (c - b) + t**2 * (d - c))
    second = 6 * (s * (c - 2 * b + a) + t * (d - 2 * c + b))
    third = 6 * (d - 3 * c + 3 * b - a)
    for k, wanted in enumerate((value, first, second, third, 0 * third)):
        np.testing.assert_allclose(curve(t, k), wanted, atol=1e-11)


@pytest.mark.parametrize("points", [CONTROL, CONTROL[:, :2], CONTROL[:2], CONTROL[[0, 2, 1, 3]]])
def test_arc_lengths_agree_with_adaptive_quadrature(points):
    position = developable.bezier(points)
    curve = developable.arc_length(position)
    for t in (0.3, 0.8, 1.0):
        length = quad(lambda x: np.linalg.norm(position(x, 1)), 0, t, epsabs=1e-13, limit=200)[0]
        assert curve.integral(t) == pytest.approx(length, abs=1e-11)
    assert curve.length == pytest.approx(length, abs=1e-11)


def test_points_move_at_unit_speed():
    curve = developable.arc_length(developable.bezier(CONTROL))
    s, h = np.linspace(0.1, curve.length - 0.1, 50), 1e-3
    far, near = (
        curve.point(s + 2 * h) - curve.point(s - 2 * h),
        curve.point(s + h) - curve.point(s - h),
    )
    speed = np.linalg.norm(8 * near - far, axis=1) / (12 * h)
    np.testing.assert_allclose(speed, 1, atol=1e-11)
    np.testing.assert_allclose(curve.integral(curve.parameter(s)), s, atol=1e-12)


def test_both_ends_are_the_end_points():
    curve = developable.arc_length(developable.bezier(CONTROL))
    np.testing.assert_allclose(curve.point(0), CONTROL[0], atol=1e-13)
    np.testing.assert_allclose(curve.point(curve.length), CONTROL[-1], atol=1e-12)


def test_a_circle_by_a_strange_parameter():
    def position(t, k=0):
        return np.stack([np.cos(np.exp(t)), np.sin(np.exp(t))], axis=-1) if k == 0 else rate(t)

    def rate(t):
        return np.exp(t)[..., None] * np.stack([-np.sin(np.exp(t)), np.cos(np.exp(t))], axis=-1)

    curve = developable.arc_length(position, 0.0, 1.5)
    assert curve.length == pytest.approx(np.exp(1.5) - 1, abs=1e-12)
    s = np.linspace(0, curve.length, 9)
    wanted = np.stack([np.cos(1 + s), np.sin(1 + s)], axis=-1)
    np.testing.assert_allclose(curve.point(s), wanted, atol=1e-12)


def test_scaling_the_points_scales_the_length():
    one, many = (developable.arc_length(developable.bezier(k * CONTROL)).length for k in (1, 1e6))
    assert many == pytest.approx(1e6 * one, rel=1e-13)


@pytest.mark.parametrize(
    "call, message",
    [
        (lambda: developable.bezier([[0, 0, 0]]), "at least two control points"),
        (lambda: developable.bezier([[0, 0, 0, 0], [1, 1, 1, 1]]), "at least two control points"),
        (lambda: developable.bezier([[0, 0], [1, np.inf]]), "not a finite number"),
        (lambda: developable.arc_length(developable.bezier(CONTROL), 1, 0), "start < stop"),
        (lambda: developable.arc_length(developable.bezier(0 * CONTROL)), "cusp"),
        (
            lambda: developable.arc_length(developable.bezier([[0, 0], [1, 1], [0, 1], [1, 0]])),
            "cusp",
        ),
        (
            lambda: developable.arc_length(developable.bezier(CONTROL)).point([0, 99.0]),
            r"grid point \(1,\) asks for arc length 99 on a curve of length 9.9",
        ),
        (
            lambda: developable._require([[True, False]], lambda at: "fails"),
            r"grid point \(0, 1\) fails",
        ),
    ],
)
def test_bad_curves_are_clear_errors(call, message):
    with pytest.raises(ValueError, match=message):
        call()
