"""`design.cover(callback=...)`: what is told on the way, and how a caller ends it."""

import numpy as np
import pytest

from inetlib import design, examples, measure, solver
from inetlib.solver import run

ROOF, SADDLE = examples.wavy_roof(12), examples.saddle_with_hole(6)
CASES = {
    "disk": (ROOF, (70, 50), 60),
    "ring": (SADDLE, (60, 60), 40),
    "several attempts": (SADDLE, (8, 170), 40),  # so flat that the first ones fail
}
each_case = pytest.mark.parametrize("name", CASES)


def cover(name, **options):
    """The cover of a case."""
    surface, angles, count = CASES[name]
    return design.cover(*surface, *np.radians(angles), count=count, **options)


def merit(name, V, Q):
    """(flipped faces, the largest deviation of an angle): small is good."""
    found, wanted = measure.angles(V, Q), np.radians(CASES[name][1])
    most = max(np.abs(x - a).max() for x, a in zip(found, wanted, strict=True))
    return measure.quality(V, Q).flips, most


@pytest.fixture(scope="module")
def ways():
    """{case: (its cover, [(step, V, Q), ...] on the way)}."""
    found = {}
    for name in CASES:
        way = []
        net = cover(name, callback=lambda step, V, Q, way=way: way.append((step, V.copy(), Q)))
        found[name] = net, way
    return found


@each_case
def test_the_start_is_told_first_and_then_every_step_with_the_quads_of_the_net(ways, name):
    net, way = ways[name]
    start = cover(name, optimise=False)
    assert way[0][0] is None and np.array_equal(way[0][1], start.V)
    assert len(way) > 2 and all(isinstance(step, run.Step) for step, _, _ in way[1:])
    assert all(np.array_equal(Q, net.Q) and V.shape == net.V.shape for _, V, Q in way)


@each_case
def test_every_step_is_told_with_the_net_it_speaks_of(ways, name):
    for step, V, Q in ways[name][1][1:]:
        flips, most = merit(name, V, Q)
        assert step.flips == flips and step.deviation == pytest.approx(most, abs=1e-12)


@each_case
def test_being_told_changes_nothing(ways, name):
    net, way = ways[name]
    alone = cover(name)
    assert np.array_equal(alone.V, net.V) and alone.report.message == net.report.message
    assert any(np.array_equal(V, net.V) for _, V, _ in way)


@pytest.mark.parametrize("answer", [None, True, 0, "", np.bool_(True)])
def test_only_false_stops(ways, answer):
    calls = []

    def callback(*told):
        calls.append(told)
        return answer

    net = cover("disk", callback=callback)
    assert len(calls) == len(ways["disk"][1]) and net.report.converged
    assert np.array_equal(net.V, ways["disk"][0].V)


@each_case
def test_stopped_before_the_first_step_the_start_comes_back(name):
    calls = []

    def stop(*told):
        calls.append(told)
        return False

    net, start = cover(name, callback=stop), cover(name, optimise=False)
    assert len(calls) == 1
    assert np.array_equal(net.V, start.V) and np.array_equal(net.Q, start.Q)
    assert not net.report.converged and "stopped" in net.report.message


def stopped(name, last):
    """The cover that is stopped after so many steps; the nets that were told."""
    told = []

    def callback(step, V, Q):
        told.append(V.copy())
        return len(told) <= last

    return cover(name, callback=callback), told


@pytest.mark.parametrize("last", [1, 2, 3])
@each_case
def test_stopped_after_a_step_no_further_one_is_made(ways, name, last):
    net, told = stopped(name, last)
    assert len(told) == last + 1
    assert all(
        np.array_equal(V, known) for V, (_, known, _) in zip(told, ways[name][1], strict=False)
    )
    assert "stopped" in net.report.message and not net.report.converged


@pytest.mark.parametrize("last", [0, 1, 2, 3])
@pytest.mark.parametrize("name", ["disk", "ring"])
def test_the_best_net_on_the_way_is_kept(name, last):
    net, told = stopped(name, last)
    assert merit(name, net.V, net.Q) == min(merit(name, V, net.Q) for V in told)


@pytest.mark.parametrize("part", [0.0, 0.3, 0.7, 1.0])
def test_stopped_in_a_later_attempt_what_an_earlier_one_has_found_is_kept(ways, part):
    name = "several attempts"
    whole, way = ways[name]
    found = next(k for k, (_, V, _) in enumerate(way) if np.array_equal(V, whole.V))
    assert found < len(way) - 10  # later attempts gained nothing
    last = found + 1 + int(part * (len(way) - 2 - found))
    net, told = stopped(name, last)
    assert len(told) == last + 1
    assert merit(name, net.V, net.Q) <= merit(name, whole.V, whole.Q)


@pytest.mark.parametrize("name", ["disk", "ring"])
def test_stopped_at_a_net_with_exact_angles_the_report_does_not_contradict_itself(ways, name):
    good = [k for k, (step, _, _) in enumerate(ways[name][1]) if step and step.deviation < 1e-11]
    net, told = stopped(name, good[0])
    assert np.array_equal(net.V, told[-1])
    assert net.report.converged is net.report.message.startswith("converged")


def test_nothing_is_told_where_nothing_is_optimised():
    calls = []
    cover("disk", optimise=False, callback=lambda *told: calls.append(told))
    assert calls == []


@pytest.mark.parametrize("when", [0, 2])
def test_an_error_of_the_caller_reaches_the_caller(when):
    calls = []

    def fail(*told):
        calls.append(told)
        if len(calls) > when:
            raise RuntimeError("of the caller")

    with pytest.raises(RuntimeError, match="of the caller"):
        cover("disk", callback=fail)
    assert len(calls) == when + 1


def test_the_solver_tells_its_steps_alike(ways):
    V, Q = ways["disk"][1][0][1:]
    calls = []
    solver.optimize(V, Q, *np.radians([70, 50]), callback=lambda step, V: calls.append((step, V)))
    assert calls and all(isinstance(step, run.Step) for step, _ in calls)
    assert calls[-1][0].deviation == pytest.approx(merit("disk", calls[-1][1], Q)[1], abs=1e-12)
