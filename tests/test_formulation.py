"""Eqs. (17) to (22) written out face by face, on any numbers; and every column of Table 1."""

import csv
from pathlib import Path

import numpy as np
import pytest

from inetlib import conformal, mesh, publish, solver
from inetlib.drawings import table1
from inetlib.solver import guided
from inetlib.solver.goal import aim

FIGURES = Path(__file__).resolve().parent.parent / "figures"
GOALS = [
    {},
    {"theta": 1.0},
    {"theta0": 2.0},
    {"theta": 1.0, "theta0": 1.2},
    {"lam": 1.7},
    {"mu": 0.6},
    {"equal": True},
    {"theta": 1.1, "theta0": 1.1},
]
EQUAL = [wanted for wanted in GOALS if wanted.get("equal") or wanted.get("theta") == 1.1]


def written_out(x, V, Q, at, theta=None, theta0=None, lam=None, mu=None, equal=False):
    """{number: residuals} of the equations for all faces; at: columns of the variables."""
    found = {k: [] for k in (17, 18, 19, 20, 21, 22)}
    alike = equal or (theta is not None and theta == theta0)
    for f, (v1, v2, v3, v4) in enumerate(V[Q]):
        here = {name: x[columns[f]] for name, columns in at.items()}
        found[17] += [sum((v3 - v1) ** 2) - here["La"], sum((v4 - v2) ** 2) - here["Lb"]]
        found[17].append(here["Lb"] - here["c1"] * here["La"])
        if alike:
            d1, d2 = v3 - v1, v4 - v2
            found[21].append(sum(d2**2) - sum(d1**2) - 2 * sum(d1 * d2))
            continue
        found[17].append(here["lam"] ** 2 - here["c1"])
        found[18].append(sum((v3 + v4 - v1 - v2) ** 2) - here["Lp"])
        found[18].append(sum((v1 + v4 - v2 - v3) ** 2) - here["Lq"])
        found[18].append(here["Lp"] - here["c2"] * here["Lq"])  # E1: printed the other way round
        found[18].append(here["mu"] ** 2 - here["c2"])
        c1, c2 = here["c1"], here["c2"]
        if theta is not None:
            found[20].append((1 + c1) * (c2 - 1) - 2 * np.cos(theta) * here["lam"] * (1 + c2))
        if theta0 is not None:
            found[20].append((1 + c2) * (c1 - 1) - 2 * np.cos(theta0) * here["mu"] * (1 + c1))
    if alike and theta is not None:  # of the one common unknown, c1 = lam^2
        found[22] = [here["c1"] - (np.cos(theta) + np.sqrt(1 + np.cos(theta) ** 2)) ** 2]
    if lam is not None or mu is not None:
        found[19] = [here["lam"] - lam if mu is None else here["mu"] - mu]
    return found


@pytest.mark.parametrize("wanted", GOALS, ids=str)
def test_eqs_17_to_22_are_those_written_out_at_any_numbers(wanted):
    """Off every net, so that no residual is small; in the order of the equations or another."""
    rng = np.random.default_rng(17)
    for m, n in [(3, 2), (4, 5), *100 * [(1, 1)]]:
        Q, count = mesh.grid_quads(m, n), (m + 1) * (n + 1)
        goal = aim(**wanted)
        lay = guided.layout(Q, count, goal.equal)
        x = np.exp(rng.uniform(-1, 1, lay.columns)) * rng.choice([1, -1], lay.columns)
        own = written_out(x, x[: 3 * count].reshape(-1, 3), Q, lay.at, **wanted)
        values = np.concatenate([own[k] for k in own])
        assert np.abs(values).min() > 1e-6
        found = [f(x[index], *more)[0].ravel() for f, index, more in guided.equations(lay, goal)]
        np.testing.assert_allclose(np.sort(np.concatenate(found)), np.sort(values), rtol=1e-9)
        # App. A.4: as many variables and equations as have just been written out
        names = {3 * vertex + c for vertex in range(count) for c in range(3)}
        names |= {column for columns in lay.at.values() for column in columns}
        assert guided.size(Q, count, goal) == (len(names), len(values))
        if wanted not in EQUAL:
            assert (len(own[17]), len(own[18])) == (4 * len(Q), 4 * len(Q))


@pytest.mark.parametrize("wanted", [GOALS[3], GOALS[-1]], ids=str)
def test_eqs_17_to_22_vanish_on_nets_of_these_angles_and_on_no_others(wanted):
    def residuals(theta, theta0):
        z = conformal.sheared_grid(theta, theta0, 3, 2, origin=1 + 1j, edge=0.3)
        V, Q = conformal.quads(z**2)
        goal = aim(**wanted)
        lay = guided.layout(Q, len(V), goal.equal)
        x = guided.start(lay, V, Q)  # auxiliary variables as the net has them
        own = np.concatenate(list(written_out(x, V, Q, lay.at, **wanted).values()))
        return guided.hard(lay, goal, x)[0], own

    theta, theta0 = wanted["theta"], wanted["theta0"]
    for found in residuals(theta, theta0):
        np.testing.assert_allclose(found, 0, atol=1e-10)
    for other in ((np.pi - theta, theta0), (theta, np.pi - theta0), (theta + 0.1, theta0)):
        for found in residuals(*other):
            assert np.abs(found).max() > 0.01


def judged(V, Q, theta, theta0):
    """Largest and mean deviations in degrees, flipped and dart-shaped faces, least over largest
    area: from coordinates alone."""
    v1, v2, v3, v4 = V[Q].transpose(1, 0, 2)
    d1, d2 = v3 - v1, v4 - v2

    def angle(a, b):
        lengths = np.linalg.norm(a, axis=1) * np.linalg.norm(b, axis=1)
        return np.degrees(np.arccos(np.sum(a * b, axis=1) / lengths))

    off = [abs(angle(d1, d2) - theta), abs(angle(d1 + d2, d2 - d1) - theta0)]
    normal = np.cross(d1, d2)
    corners = [np.cross(b - a, c - b) for a, b, c in ((v1, v2, v3), (v2, v3, v4), (v3, v4, v1))]
    corners.append(np.cross(v1 - v4, v2 - v1))
    darts = np.any([np.sum(c * normal, axis=1) < 0 for c in corners], axis=0).sum()
    area = np.linalg.norm(normal, axis=1)
    return [*np.max(off, axis=1), *np.mean(off, axis=1)], darts, area.min() / area.max()


def test_app_a4_every_number_of_a_row_is_that_of_its_net():
    u, v = np.meshgrid(*2 * [np.linspace(-1, 1, 6)], indexing="ij")
    V = np.stack([u * (1 + 0.1 * v), v, 0.3 * np.cos(1.3 * u) + 0.2 * u * v], axis=-1)
    V, Q = V.reshape(-1, 3), mesh.grid_quads(5, 5)
    names = dict(zip(table1.PRINTED, [{}, *GOALS[1:4], *GOALS[-2:], {"lam": 1.3}], strict=True))
    noise = 0.04 * np.random.default_rng(4).normal(size=V.shape)  # angles that are off, and darts
    noise += np.outer(np.indices((6, 6)).sum(axis=0).ravel() % 2, [0.3, 0.3, 0])
    for formulation in ("paper, splu", "ratio"):
        nets = {}
        for name, wanted in names.items():
            found = solver.optimize(V, Q, **wanted, formulation=formulation)
            nets[name] = Q, found._replace(V=found.V + noise)
        rows = table1.rows({"noisy": nets})
        assert [row[:2] for row in rows[1::2]] == [[name, "noisy"] for name in names]
        for row, (_, found) in zip(rows[1::2], nets.values(), strict=True):
            cells = dict(zip(table1.HEADER, row, strict=True))
            off, darts, ratio = judged(found.V, Q, *np.degrees([found.theta, found.theta0]))
            assert off[0] > 2 * off[2] > 2 and darts > 0
            assert list(map(float, row[7:11])) == pytest.approx(off, rel=0.06)
            assert cells["flips, darts"].endswith(f", {darts}")
            assert float(cells["area ratio"]) == pytest.approx(ratio, abs=6e-4)
            assert int(cells["F"]) == 25 and int(cells["#iter"]) == len(found.history) - 1
            wanted = names[cells["Fig."]]
            sizes = guided.size(Q, 36, aim(**wanted))
            if formulation == "ratio":  # vertices and what is left free; two equations a face
                sizes = 108 + (1 if "equal" in wanted else 2 - len(wanted)), 50
            assert (int(cells["#var"]), int(cells["#cons"])) == sizes


def test_app_a4_the_stored_table_has_the_printed_rows_and_the_deviations_of_the_stored_nets():
    with open(FIGURES / "table1.csv", encoding="utf-8", newline="") as file:
        header, *rows = csv.reader(file)
    assert header == table1.HEADER
    names = [*table1.VARIANTS]
    assert [row[:2] for row in rows] == [
        [k, w] for k in table1.PRINTED for w in ("printed", *names)
    ]
    nets = {
        name: publish.read_data(FIGURES / "data" / f"{name}.npz") for name in ("fig12", "fig13")
    }
    meshes = {"fig12": mesh.grid_quads(20, 20), "fig13": mesh.polygon_rings(6, 8)[1]}
    angles = {"12B": (90, None), "12C": (None, 90), "12D": (90, 90), "12E": (60, 60)}
    angles |= {"12A": (None, None), "13A": (60, 60), "13B": (60, 45)}
    for row in rows:
        figure, letter = f"fig{row[0][:2]}", row[0][2]
        Q = meshes[figure]
        if row[1] == "printed":
            assert int(row[2]) == len(Q) + (figure == "fig13")  # with the hexagon
        elif row[1] == "ratios":
            cells, given = dict(zip(header, row, strict=True)), angles[row[0]]
            off, darts, ratio = judged(nets[figure][f"net_{letter}"], Q, *(a or 0 for a in given))
            for name, angle, value in zip(header[7:11], given * 2, off, strict=True):
                assert cells[name] == "< 1e-9"
                assert angle is None or value < 1e-3  # the data are rounded
            assert cells["flips, darts"] == f"0, {darts}"
            assert float(cells["area ratio"]) == pytest.approx(ratio, abs=6e-4)
