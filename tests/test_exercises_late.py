"""The truths of the exercises of chapters 5 to 8 against the library, and against misprints."""

import numpy as np
import sympy as sp

from inetlib import developable, exercises, loxodrome, measure, mesh, parallelogram, surfaces
from inetlib.exercises import c52, engine
from inetlib.solver import goal, guided, residuals


def truths(name):
    """(instance, what is right there)."""
    exercise = exercises.find(name)
    for case in exercise.instances(np.random.default_rng(17)):
        yield case, exercise.truth(*case)


def judged(name, answer):
    return engine.judge(exercises.find(name), answer)


def crossings(gamma):
    """Pairs of polyline pieces of a line on the developed cone that meet on the cone itself."""
    phi = np.linspace(-1, 1, 4001) * 1.5707
    around, far = phi / np.sin(gamma), 1 / np.cos(phi)
    found = 0
    for k in range(1, int(np.ptp(around) / (2 * np.pi)) + 1):  # the line and its copy, k laps on
        copy = np.interp(around, around + 2 * np.pi * k, far, left=np.nan, right=np.nan)
        signs = np.sign((far - copy)[np.isfinite(copy)])
        found += np.count_nonzero(np.diff(signs[signs != 0]))
    return found


def test_lines_on_cones_are_counted_on_a_developed_polyline():
    for (gamma,), wanted in truths("5.1.2"):
        assert crossings(gamma) == wanted
    limit = np.radians(exercises.find("5.1.1").truth)
    assert crossings(limit - 1e-2) == 1 and crossings(limit + 1e-2) == 0


def test_curves_and_chords_are_those_of_a_rolled_plane():
    for (r, h), wanted in truths("5.1.3"):
        turn = np.exp(1j * np.arctan2(h, 2 * np.pi * r))  # along the unrolled helix
        a, b, c = developable.roll(np.array([-1e-3, 0, 1e-3]) * turn, 1 / r)
        assert np.isclose(np.linalg.norm(a - 2 * b + c) / 1e-6, float(wanted), rtol=1e-5)
    for (x, y, k), wanted in truths("5.1.5"):
        a, b = developable.roll(np.array([0.3 + 0.1j, 0.3 + x + (0.1 + y) * 1j]), k)
        assert np.isclose(np.linalg.norm(a - b), float(wanted))


def test_three_geodesics_are_three_lines_to_the_same_point():
    for (turn, rise, r), wanted in truths("5.1.4"):
        for length in wanted:
            around = np.sqrt(max(length**2 - rise**2, 0)) / r
            off = [(sign * around - turn) / (2 * np.pi) for sign in (1, -1)]
            assert min(abs(x - round(x)) for x in off) < 1e-7
        assert (np.diff(wanted) >= 0).all() and wanted[0] <= np.hypot(r * np.pi, rise)


def test_the_truths_of_5_2_agree_with_the_library():
    for (k,), wanted in truths("5.2.1"):
        corners = np.array([(1, 1, 0), (0, 1, 0), (k - 1, 0, 0), (k, 0, 0)], dtype=float)
        np.testing.assert_allclose(np.ravel(measure.angles(corners, [[0, 1, 2, 3]])), wanted)
    u = sp.Symbol("u")
    for (f, v, _), _ in truths("5.2.2"):
        point = (f * sp.cos(u), f * sp.sin(u), c52.HEIGHTS[f])
        E, F, G = surfaces.first_form(surfaces.Surface("", sp.Lambda((u, v), point)), u, v)
        assert abs(float((E - G).subs({u: 0.3, v: 0.8}))) < 1e-9 and sp.simplify(F) == 0
    assert judged("5.2.3", lambda u, v: surfaces.HELICOID.point(u, v).T).right
    assert judged("5.2.3", lambda u, v: -surfaces.HELICOID.point(u, v).T).right


def test_courses_are_those_of_the_library():
    for (a, b, theta0), turned in truths("5.3.2"):
        profile = surfaces.sphere_profile(start=min(a, b), stop=max(a, b))
        curve = loxodrome.loxodrome(profile, theta0, samples=4001)
        angle = np.unwrap(np.arctan2(curve[:, 1], curve[:, 0]))
        assert np.isclose((angle[-1] - angle[0]) * np.sign(b - a), turned, atol=1e-9)
        length = np.linalg.norm(np.diff(curve, axis=0), axis=1).sum()
        assert np.isclose(length, exercises.find("5.3.3").truth(a, b, theta0), rtol=1e-5)
    wrong = np.radians(exercises.find("5.3.1").truth)
    assert np.isclose(np.degrees(np.arctan(1 / np.cos(wrong))), 60)


def test_rows_and_closed_webs_are_those_of_the_library():
    profile = surfaces.sphere_profile(start=-1.5, stop=1.5)
    w_of_t, _ = surfaces.mercator(profile)
    for (theta, theta0, m), wanted in truths("5.3.4"):
        if wanted < 1:
            net = loxodrome.web(profile, theta, theta0, m, n=2, method="smooth")
            np.testing.assert_allclose(np.diff(w_of_t(net.t)), wanted)
    for (R, r, m, n, k), wanted in truths("5.3.5"):
        profile = surfaces.torus_profile(R, r)
        W, _ = surfaces.mercator(profile)
        high = float(W(profile.stop) - W(profile.start))
        found = parallelogram.from_rho((k + 1j * m * high / (2 * np.pi)) / n)
        np.testing.assert_allclose([found.theta, found.theta0], wanted, atol=1e-6)


def test_the_truths_of_6_agree_with_the_solver():
    angles = {0: {}, 1: {"theta": 1.5}, 2: {"theta": 1.1, "theta0": 0.8}}
    for (m, n, short, given), wanted in truths("6.1"):
        if not short or given:
            wish = goal.aim(theta=1.0, theta0=1.0) if short else goal.aim(**angles[given])
            assert guided.size(mesh.grid_quads(m, n), (m + 1) * (n + 1), wish) == wanted
    for (v,), wanted in truths("6.2"):
        _, jacobian = residuals.theta_quad(v.reshape(1, 12))
        np.testing.assert_allclose(np.ravel(jacobian), np.ravel(wanted), atol=1e-9)
    for (J, f, mobility), wanted in truths("6.3"):
        np.testing.assert_allclose(J @ wanted, -f, atol=1e-9)
        moved = mobility > 0
        sized = np.linalg.lstsq((J * np.sqrt(mobility))[:, moved], -f, rcond=None)[0]
        np.testing.assert_allclose(np.sqrt(mobility[moved]) * sized, wanted[moved], atol=1e-9)
        assert not wanted[~moved].any()
    for (theta,), wanted in truths("6.4"):
        up, down = (np.log(parallelogram.ratios(theta + s, theta + s)[0]) for s in (1e-5, -1e-5))
        assert np.isclose((up - down) / 2e-5, float(wanted))


def test_the_truths_of_7_agree_with_the_library():
    for pair, wanted in truths("7.1"):
        assert np.isclose(parallelogram.rho(*parallelogram.ratios(*pair)), wanted)
    for lines, wanted in truths("7.2"):
        assert np.isclose(parallelogram.cross_ratio(*lines), wanted)
    for (m, n, closed), wanted in truths("7.3"):
        Q = mesh.grid_quads(m, n)
        if closed:
            Q = np.where(m * (n + 1) <= Q, Q - m * (n + 1), Q)
        assert 2 * (len(np.unique(Q)) - len(Q)) == wanted
    supplement = parallelogram.from_rho(1 + np.sqrt(2) * np.exp(2.1j))
    assert np.isclose(supplement.theta + supplement.theta0, np.pi)
    on = exercises.find("7.4").truth(1 + np.sqrt(2) * np.cos(2.1), np.sqrt(2) * np.sin(2.1))
    assert abs(on) < 1e-12


def test_the_truths_of_8_agree_with_what_is_known_of_these_surfaces():
    disk, ring, torus, strip, holes = (1, 1), (2, 0), (0, 0), (1, 0), (3, -1)
    known = [disk, disk, ring, torus, strip, (0, 2), ring, holes, (3, 1), disk, disk, torus, holes]
    assert [wanted for _, wanted in truths("8.2")] == known
    for (size, count, more), wanted in truths("8.1"):
        assert np.isclose(more * wanted**2, count * size**2)
    for (A, N, mu, theta0), wanted in truths("8.3"):
        a = complex(wanted)
        assert np.isclose(N * (np.conj(a) * a / mu * np.exp(1j * theta0)).imag, A)


def test_what_the_paper_prints_does_not_pass_and_is_called_so():
    def other_root(theta, theta0, m):
        return 2 * np.pi / m * np.sin(theta0) * parallelogram.ratios(theta, theta0)[1]

    def table_1(m, n, short, given):
        unknowns, equations = exercises.find("6.1").truth(m, n, short, given)
        return unknowns + (2 if short else 3), equations + 1

    def course(a, b, theta0):
        return (np.arctanh(np.sin(b)) - np.arctanh(np.sin(a))) * np.cos(theta0)

    wrong = {
        "5.2.3": (lambda u, v: (np.sinh(v) * np.cos(u), np.sinh(v) * np.sin(u), u), "printed"),
        "5.3.2": (course, "prints it"),
        "5.3.4": (other_root, "other root"),
        "6.1": (table_1, "Table 1 prints"),
    }
    for name, (answer, words) in wrong.items():
        checked = judged(name, answer)
        assert not checked.right and words in checked.message, checked
