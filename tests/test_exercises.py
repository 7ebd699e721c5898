"""Solutions pass, typical mistakes are named, and nothing else passes; see `inetlib.exercises`.

What holds for every exercise is tested for all that there are; `truth` is compared with the
library, or with a construction that it does not use."""

import contextlib
import functools
import io
import json
import re
import sys
import threading
import time
from itertools import pairwise
from pathlib import Path

import numpy as np
import pytest
import sympy as sp

from inetlib import conformal, exercises, measure, mesh, parallelogram
from inetlib.exercises import engine

ROOT = Path(__file__).resolve().parent.parent
EVERY = pytest.mark.parametrize("name", exercises.names())
STEMS = sorted(path.stem for path in (ROOT / "solutions").glob("*.ipynb"))


def cells(folder, stem, kind="code"):
    found = json.loads((ROOT / folder / f"{stem}.ipynb").read_text("utf-8"))["cells"]
    return [c for c in found if c["cell_type"] == kind]


def text(cell):
    return "".join(cell["source"])


@functools.cache
def solved(stem):
    """What the cells of a notebook of solutions print, what is stored, and {name: answer}."""
    space, printed, stored, answers = {}, [], [], {}
    for cell in cells("solutions", stem):
        with contextlib.redirect_stdout(io.StringIO()) as out:
            exec(text(cell), space)
        printed.append(out.getvalue())
        stored.append("".join("".join(o.get("text", "")) for o in cell["outputs"]))
        if found := re.search(r'exercises\.check\("([\d.]+)", answer\)\.right', text(cell)):
            answers[found[1]] = space["answer"]
    return printed, stored, answers


@functools.cache
def solutions():
    return {name: answer for stem in STEMS for name, answer in solved(stem)[2].items()}


@functools.cache
def truths(name):
    """The instances of an exercise and what is right there."""
    exercise = exercises.find(name)
    found = exercise.instances(np.random.default_rng(17))
    return [(case, exercise.truth(*case)) for case in found]


def symbolic(exercise, function):
    """What a student types: an expression in the symbols of the exercise, or the thing itself."""
    if exercise.kind == "expression":
        names = re.search(r"`([\w, ]+)`", exercise.task[exercise.task.index("expression") :])[1]
        return function(*sp.symbols(names, seq=True))
    constant = exercise.kind in ("number", "array") and callable(function)
    return function() if constant else function


def endless(*arguments):
    """Never returns."""
    while True:
        pass


def raising(*arguments):
    """Raises an error of its own."""
    raise KeyError("here")


def wrong_answers(exercise):
    """{what is wrong: (answer, words to expect in the message)}, the same for all exercises."""
    if exercise.kind == "function":
        return {
            "nothing": (lambda *a: None, "it gives None"),
            "raises": (raising, "it raised KeyError: 'here'"),
            "signature": (lambda: 1, "it raised TypeError"),
            "shape": (lambda *a: np.zeros((7, 5)), "for "),
            "nan": (lambda *a: np.nan, "for "),
            "words": (lambda *a: "many", "for .*many"),
            "constant": (lambda *a: 0.123, "for .*0.123"),
            "True": (lambda *a: True, "for "),
            "False": (lambda *a: False, "for "),
            "no function": (3.5, "a function of .* is wanted, not 3.5"),
        }
    found = {
        "function": (lambda *a: 1, "a value is wanted"),
        "words": ("many", "many"),
        "shape": (np.zeros((7, 5)), "wanted|form"),
        "nan": (np.nan, "nan"),
        "zero": (0, "0"),
        "constant": (0.123, "0.123"),
        "large": (1e9, "1e\\+09"),
    }
    if exercise.kind == "expression":
        found["symbol"] = sp.Symbol("other"), "other must not be in it"
    return found


@pytest.mark.parametrize("stem", STEMS)
def test_a_notebook_of_solutions_runs_and_prints_what_is_stored(stem):
    printed, stored, answers = solved(stem)
    assert printed == stored and len(answers) >= 3
    assert [c["execution_count"] for c in cells("solutions", stem)] == [*range(1, len(stored) + 1)]
    heads = "\n".join(map(text, cells("solutions", stem, "markdown")))
    for name in answers:
        exercise = exercises.find(name)
        assert f"## Exercise {name}: {exercise.title}" in heads and exercise.task in heads


@EVERY
def test_the_solution_is_right(name):
    checked = engine.judge(exercises.find(name), solutions()[name])
    assert checked.right and checked.message.startswith("right")


@EVERY
def test_each_typical_mistake_is_told_by_its_sentence(name):
    exercise = exercises.find(name)
    assert len({sentence for sentence, _ in exercise.mistakes}) == len(exercise.mistakes) >= 2
    for sentence, wrong in exercise.mistakes:
        checked = engine.judge(exercise, symbolic(exercise, wrong))
        assert not checked.right, sentence
        assert checked.message.startswith("not yet: ") and sentence in checked.message


@EVERY
def test_no_other_answer_passes_and_each_gets_a_sentence(name, monkeypatch):
    exercise, wrong = exercises.find(name), wrong_answers(exercises.find(name))
    assert len(wrong) + len(exercise.mistakes) > 6
    hidden = exercise.truth if exercise.kind in ("number", "array") else None
    hidden = None if hidden is None else engine.told(symbolic(exercise, hidden))
    for what, (answer, words) in wrong.items():
        checked = engine.judge(exercise, answer)
        assert not checked.right, what
        assert re.search(words, checked.message) and "\n" not in checked.message, checked
        assert hidden is None or hidden not in checked.message
    if exercise.kind == "function":
        monkeypatch.setattr(engine, "SECONDS", 0.03)
        checked = engine.judge(exercise, endless)
        assert not checked.right and "more than 0.03 seconds" in checked.message


@EVERY
def test_a_function_needs_more_than_one_value(name):
    exercise = exercises.find(name)
    if exercise.kind in ("function", "expression") and exercise.truth is not None:
        values = [value for _, value in truths(name)]
        assert len(values) >= 6
        assert not all(engine.alike(values[0], x, 1e-6) for x in values)
        for value in (values[0], values[-1]):
            constant = value if exercise.kind == "expression" else (lambda *a, value=value: value)
            assert not engine.judge(exercise, constant).right
    else:
        assert exercise.kind != "expression"


def test_the_exercises_are_declared_in_order_and_spread_over_the_levels():
    chapters = {}
    for name in exercises.names():
        exercise = exercises.find(name)
        assert exercise.kind in engine.KINDS and exercise.level in engine.LEVELS
        assert 1 <= exercise.minutes <= 60 and exercise.tolerance <= 1e-2
        assert all(len(x) > 10 for x in (exercise.task, exercise.hint)) and exercise.title
        chapters.setdefault(name.rpartition(".")[0], []).append(exercise)
    for chapter, inside in chapters.items():
        assert [e.name for e in inside] == [f"{chapter}.{k + 1}" for k in range(len(inside))]
        assert len(inside) >= 3 and len({e.level for e in inside}) >= 2
    assert {e.level for inside in chapters.values() for e in inside} == set(engine.LEVELS)


@EVERY
def test_the_notebook_asks_for_it_and_is_patient(name):
    exercise, start = exercises.find(name), name.rpartition(".")[0].replace(".", "_")
    (stem,) = [p.stem for p in (ROOT / "notebooks").glob(f"{start}_[a-z]*.ipynb")]
    asked = [text(c) for c in cells("notebooks", stem, "markdown")]
    (asked,) = [x for x in asked if f"**Exercise {name}" in x]
    assert exercise.task in asked and exercise.hint in asked and exercise.title in asked
    assert f"({exercise.level}, {exercise.minutes} min)" in asked
    (cell,) = [c for c in cells("notebooks", stem) if f'exercises.check("{name}"' in text(c)]
    assert re.search(rf'^answer = None .*\nexercises\.check\("{name}", answer\)$', text(cell), re.M)
    (output,) = cell["outputs"]
    assert "".join(output["text"]) == f"{name}: {engine.EMPTY}\n"


def test_check_prints_a_sentence_and_keeps_what_is_solved(capsys, monkeypatch):
    monkeypatch.setattr(exercises, "solved", set())
    assert exercises.check("2.4") == (False, engine.EMPTY)
    d1, d2, theta = sp.symbols("d1 d2 theta")
    checked = exercises.check("2.4", d1 * d2 * sp.sin(theta) / 4)
    assert checked.right and exercises.solved == {"2.4"}
    assert capsys.readouterr().out == f"2.4: {engine.EMPTY}\n2.4: {checked.message}\n"
    exercises.hint("2.4")
    assert "diagonals" in capsys.readouterr().out
    exercises.report()
    lines = capsys.readouterr().out.splitlines()
    assert "2.4 solved" in next(line for line in lines if line.startswith("2 "))
    assert lines[-1] == f"1 of {len(exercises.names())} are solved"
    assert checked._ipython_display_() is None and capsys.readouterr().out == ""
    with pytest.raises(ValueError, match=r"no exercise '4\.99': there are 0\.1, "):
        exercises.check("4.99", 1)


def toured(changed):
    """The five steps of the tour, or what they say once their number is `changed`."""
    lines, found = [text(c) for c in cells("notebooks", "0_start_here")], []
    space = {}
    exec(next(x for x in lines if "grid = " in x), space)
    for cell in (x for x in lines if 'check("tour.' in x):
        (line,) = [x for x in cell.splitlines() if "# change" in x]
        old, new = re.search(r"# change (?:the first )?(\S+) to (\S+)", line).groups()
        line_now = re.sub(rf"\b{old}\b", new, line, count=1) if changed else line
        with contextlib.redirect_stdout(io.StringIO()) as out:
            exec(cell.replace(line, line_now), space)
        found.append(out.getvalue())
    return found


def test_each_step_of_the_tour_says_what_one_change_did():
    before, after = toured(False), [" ".join(x.split()) for x in toured(True)]
    stored = [c for c in cells("notebooks", "0_start_here") if 'check("tour.' in text(c)]
    assert before == ["".join(c["outputs"][0]["text"]) for c in stored]
    assert len(before) == len(exercises.tour.STEPS) == 5
    assert all("Now" in x for x in before) and not any("Now" in x for x in after)
    lam, mu = parallelogram.ratios(np.radians(75), np.radians(60))
    assert f"theta = 75.00, theta0 = 60.00 degrees, lam = {lam:.5f}, mu = {mu:.5f}" in after[0]
    grids = [conformal.sheared_grid(np.pi / 3, np.pi / 3, m, m, 0.6, 2 / m) for m in (8, 16)]
    coarse, fine = (deviation(*conformal.quads(1 / grid)) for grid in grids)
    assert (
        f"off by up to {fine:.3f} degrees. Without every second line it was {coarse:.3f}"
        in after[2]
    )
    assert f"{fine / coarse:.2f} of that is left" in after[2]
    pushed = conformal.quads(conformal.sheared_grid(np.pi / 3, np.pi / 3, 10, 8, 0.6, 0.25) ** 2)
    pushed[0][49, 0] += 0.05
    assert f"4 of 80 faces are off, by up to {deviation(*pushed):.2f} degrees" in after[4]


def deviation(V, Q):
    """By how much the angles are off 60 degrees at most, in degrees."""
    d1, d2 = V[Q[:, 2]] - V[Q[:, 0]], V[Q[:, 3]] - V[Q[:, 1]]
    pairs = (d1, d2), (d1 + d2, d2 - d1)
    cosines = [
        (a * b).sum(1) / np.linalg.norm(a, axis=1) / np.linalg.norm(b, axis=1) for a, b in pairs
    ]
    return np.abs(np.degrees(np.arccos(cosines)) - 60).max()


def test_the_tour_tells_turns_of_the_labels_and_what_is_no_net():
    V, Q = conformal.quads(conformal.sheared_grid(1.2, 0.9, 4, 4) ** 2)
    for turns in range(5):
        checked = exercises.check("tour.4", (V, np.roll(Q, turns, axis=1)))
        angles = np.degrees([1.2, 0.9] if turns % 2 == 0 else [np.pi - 1.2, np.pi - 0.9])
        assert checked.right == (turns % 4 > 0)
        assert "theta = {:.2f}, theta0 = {:.2f} degrees".format(*angles) in checked.message
        assert ("supplements" in checked.message) == (turns % 2 == 1)
    for step in exercises.tour.STEPS:
        for wrong in (None, 5, "net", (V,), (V, 3), (V, Q[:, :3])):
            checked = exercises.check(step, wrong)
            assert not checked.right and "a net (V, Q) is wanted" in checked.message
    assert not exercises.solved & set(exercises.tour.STEPS)


def test_symbols_count_by_their_names_and_lambda_is_lam():
    mu, lam = sp.symbols("mu lambda", positive=True)
    right = lam * sp.sqrt(2 * (1 + mu**2) / (1 + lam**2)) / mu
    assert engine.judge(exercises.find("4.6"), right).right
    assert engine.judge(exercises.find("4.6"), right.subs(mu, sp.Symbol("mu"))).right
    assert not engine.judge(exercises.find("4.6"), right + sp.Float("1e-6")).right


def test_what_is_endless_ends_and_what_ends_the_program_does_not(monkeypatch):
    monkeypatch.setattr(engine, "SECONDS", 0.05)
    before, exercise = threading.active_count(), exercises.find("4.5")
    assert "endless" in engine.judge(exercise, endless).message
    until = time.monotonic() + 5
    while threading.active_count() > before and time.monotonic() < until:
        time.sleep(0.01)
    assert threading.active_count() == before
    assert "it raised SystemExit." in engine.judge(exercise, lambda *a: sys.exit()).message


def test_an_answer_may_change_what_it_is_given():
    def rolls(V, Q, theta, theta0):
        V *= np.nan
        Q[:] = 0
        return Q

    assert not engine.judge(exercises.find("0.3"), rolls).right
    assert engine.judge(exercises.find("0.3"), solutions()["0.3"]).right


def test_no_printed_misprint_passes_and_each_is_called_so():
    wrong = {
        "3.1.3": (lambda lam, mu: bool((mu - 1) / (mu + 1) < lam < (mu + 1) / (mu - 1)), "Eq. (6)"),
        "3.3.2": (lambda mu, j, k: mu, "the paper"),
        "4.2": (lambda Xu, Xv: solutions()["4.2"](Xu, Xv)[::-1], "prints it"),
        "4.3": (lambda X, u, v: X(u - v, u + v), "printed"),
    }
    for name, (answer, words) in wrong.items():
        checked = engine.judge(exercises.find(name), answer)
        assert not checked.right and words in checked.message


def test_an_arccos_near_zero_is_told_from_a_mistake():
    def arccos(a, b):
        return np.arccos(a @ b / np.sqrt((a @ a) * (b @ b)))

    checked = engine.judge(exercises.find("3.1.4"), arccos)
    assert not checked.right and "arccos" in checked.message


def ring(valences):
    """The quads of one ring around a polygon with corners of these valences, and nothing else."""
    spokes = [[(c, s) for s in range(k - 2)] for c, k in enumerate(valences)]
    number = {}

    def at(key):
        return number.setdefault(key, len(number))

    quads = []
    for c, mine in enumerate(spokes):
        after = (c + 1) % len(spokes)
        quads.append([("p", c), mine[-1], spokes[after][0], ("p", after)])
        quads += [[("p", c), a, ("q", *a), b] for a, b in pairwise(mine)]
    return np.array([[at(key) for key in quad] for quad in quads])


def labelled(valences):
    try:
        return bool(mesh.is_labelled(mesh.label(ring(valences))))
    except ValueError:
        return False


def test_the_truth_of_2_agrees_with_mesh_and_measure():
    found = [labelled(case[0]) == wanted for case, wanted in truths("2.2")]
    assert all(found) and {wanted for _, wanted in truths("2.2")} == {True, False}
    for (corners,), wanted in truths("2.3"):
        np.testing.assert_allclose(np.ravel(measure.angles(corners, [[0, 1, 2, 3]])), wanted)
    for (d1, d2, theta), wanted in truths("2.4"):
        across = d2 * np.exp(1j * theta)
        quad = np.array([0, 0.3 * d1 - 0.4 * across, d1, 0.3 * d1 + 0.6 * across])
        mid = (quad + np.roll(quad, -1)) / 2
        area = abs(np.imag(np.conj(mid[1] - mid[0]) * (mid[3] - mid[0])))
        assert np.isclose(area, abs(float(wanted)))


def test_the_truth_of_3_agrees_with_the_library():
    for (lam, mu), wanted in truths("3.1.1"):
        np.testing.assert_allclose(parallelogram.angles(lam, mu), wanted)
    for pair, wanted in truths("3.1.2"):
        np.testing.assert_allclose(parallelogram.ratios(*pair), wanted)
    for (lam, mu), wanted in truths("3.1.3"):
        assert parallelogram.is_admissible(lam, mu) == wanted
    for (lam, mu), wanted in truths("3.1.5"):
        theta, _ = parallelogram.angles(lam, mu)
        left = 16 - (lam - 1 / lam) ** 2 * (mu - 1 / mu) ** 2
        assert np.isclose(left, float(wanted) * np.sin(theta) ** 2)
    for (theta, theta0), wanted in truths("3.3.1"):
        grid = conformal.sheared_grid(theta, theta0, 1, 1)
        assert np.isclose(grid[0, 1] - grid[0, 0], wanted)
    for (mu, j, k), wanted in truths("3.3.2"):
        grid = np.add.outer(np.arange(j + 1), np.arange(k + 1) * np.exp(1.2j) / mu)
        block = conformal.quads(grid[::j, ::k])
        assert np.isclose(measure.ratios(*block)[1][0], wanted)
    for (f, z), wanted in truths("3.3.3"):
        kappa = conformal.kappa(f, z)
        assert (z in kappa.free_symbols) == (wanted is None)
        assert wanted is None or abs(complex(kappa) - wanted) < 1e-5
    for (c, z), wanted in truths("3.3.4"):
        u, v = 1e-3, 1e-3 * np.exp(1.1j)
        error, _ = conformal.cell_errors(lambda w, c=c: w**c, z, u, v)
        assert abs(error / (u * v) - complex(wanted)) < 1e-4


def test_the_truth_of_4_agrees_with_the_library():
    for (Xu, Xv), wanted in truths("4.2"):
        corners = np.array([Xv, 0 * Xv, Xu, Xu + Xv])  # m13 along X_u, m24 along X_v
        six = measure.web_angles(corners, [[0, 1, 2, 3]])
        np.testing.assert_allclose([six.m13_d2[0], six.m13_d1[0]], wanted)
    for (X, u, v), wanted in truths("4.3"):
        h, Y = 1e-5, exercises.find("4.3").truth
        Yu, Yv = Y(X, u + h, v) - Y(X, u - h, v), Y(X, u, v + h) - Y(X, u, v - h)
        p, q = u + v, v - u
        Xu, Xv = X(p + h, q) - X(p - h, q), X(p, q + h) - X(p, q - h)
        np.testing.assert_allclose([Yu, Yv], [Xu - Xv, Xu + Xv], atol=1e-12)
        np.testing.assert_allclose(wanted, X(p, q))
    for (corners,), wanted in truths("4.4"):
        assert (abs(measure.theta_defect(corners, [[0, 1, 2, 3]])[0]) < 1e-9) == wanted
    for (v1, v2, v3, *pair), wanted in truths("4.5"):
        V = np.array([[z.real, z.imag, 0] for z in (v1, v2, v3, wanted)])
        np.testing.assert_allclose(np.ravel(measure.angles(V, [[0, 1, 2, 3]])), pair)
    for ratios, wanted in truths("4.6"):
        if parallelogram.is_admissible(*ratios):
            rho = parallelogram.rho(*ratios)
            assert np.isclose(abs(1 + rho), float(wanted))
