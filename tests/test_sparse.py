"""Sparse matrices from blocks, and their solution, against dense linear algebra."""

import numpy as np
import pytest
from scipy.sparse import csr_array, diags_array, eye_array, kron
from scipy.sparse.linalg import splu

from inetlib import mesh, surfaces
from inetlib.solver import residuals, sparse

RANDOM = np.random.default_rng(5)


def system(V, Q):
    """The matrix of a smallest step, with the centres of the faces."""
    _, jacobian = residuals.log_ratios(V[Q].reshape(-1, 12))
    J = sparse.rows(jacobian, sparse.coordinates(Q), V.size)
    S = J @ J.T
    return V[Q].mean(axis=1), S + 1e-9 * S.diagonal().mean() * eye_array(S.shape[0])


def hexagon(rings):
    V, Q, _ = mesh.polygon_rings(6, rings)
    V[:, 2] = 0.3 * np.sin(V[:, 0])
    return V, Q


MESHES = pytest.mark.parametrize(
    "mesh_of", [lambda: surfaces.freeform_patch(8, 6), lambda: hexagon(6)]
)


def test_rows_put_the_blocks_where_the_index_says():
    jacobian, index = RANDOM.normal(size=(4, 2, 3)), np.array([[0, 2, 4], [1, 2, 3]] * 2)
    dense = np.zeros((8, 5))
    for row, block in enumerate(jacobian.reshape(8, 3)):
        dense[row, index[row // 2]] = block
    np.testing.assert_array_equal(sparse.rows(jacobian, index, 5).toarray(), dense)
    assert sparse.coordinates([[2, 0]]).tolist() == [[6, 7, 8, 0, 1, 2]]


@pytest.mark.parametrize("columns", [(), (3,)])
@MESHES
@pytest.mark.parametrize("dissect", [False, True])
@pytest.mark.parametrize("narrow", [0, 1000])
def test_factor_solves(mesh_of, narrow, dissect, columns, monkeypatch):
    monkeypatch.setattr(sparse, "NARROW", narrow)
    points, S = system(*mesh_of())
    b = RANDOM.normal(size=(S.shape[0], *columns))
    x = sparse.factor(S, sparse.nested_dissection(points, S) if dissect else None)(b)
    assert x.shape == b.shape
    np.testing.assert_allclose(S.toarray() @ x, b, atol=1e-8)


@pytest.mark.parametrize("narrow", [0, 1000])
@pytest.mark.parametrize("many", [10, 10**6])
@MESHES
def test_a_factor_orders_once_and_solves_again_and_again(mesh_of, many, narrow, monkeypatch):
    monkeypatch.setattr(sparse, "MANY", many)
    monkeypatch.setattr(sparse, "NARROW", narrow)
    points, S = system(*mesh_of())
    solver, orders = sparse.Factor(points), []
    for scale in (1, 2, 3):
        b = RANDOM.normal(size=(S.shape[0], 2))
        np.testing.assert_allclose(scale * (S @ solver(scale * S)(b)), b, atol=1e-8)
        orders.append(solver.order)
    assert orders[0] is orders[2]
    assert (orders[0] is None) == (narrow > 0)  # a band needs no order


def test_a_narrow_matrix_that_is_not_positive_is_solved_too():
    A = diags_array([np.full(9, 2.0), np.full(10, 1.0), np.full(9, 2.0)], offsets=[-1, 0, 1])
    b = RANDOM.normal(size=10)
    np.testing.assert_allclose(A.tocsr() @ sparse.factor(A.tocsr())(b), b, atol=1e-12)


@pytest.mark.parametrize("mesh_of", [lambda: surfaces.freeform_patch(36, 36), lambda: hexagon(14)])
def test_dissection_is_a_permutation_that_keeps_the_factor_sparse(mesh_of):
    points, S = system(*mesh_of())
    order, rows = sparse.nested_dissection(points, S), np.arange(S.shape[0])
    np.testing.assert_array_equal(np.sort(order), rows)
    np.testing.assert_array_equal(order[1::2], order[::2] + 1)  # pairs stay together
    how = {"permc_spec": "NATURAL", "diag_pivot_thresh": 0.0, "options": {"SymmetricMode": True}}
    dissected, as_is = (splu(S.tocsr()[k][:, k].tocsc(), **how).L.nnz for k in (order, rows))
    assert dissected < 0.75 * as_is


def test_dissection_puts_the_middle_of_a_chain_last_and_copes_with_points_in_one_place():
    chain = diags_array([np.ones(99), np.full(100, 4.0), np.ones(99)], offsets=[-1, 0, 1]).tocsr()
    points = np.arange(100.0)[:, None]
    order = sparse.nested_dissection(points, chain)
    assert order[-1] == 49
    three = sparse.nested_dissection(points, csr_array(kron(chain, np.ones((3, 3)))))
    np.testing.assert_array_equal(three[::3], 3 * order)
    order = sparse.nested_dissection(np.zeros((50, 3)), csr_array(np.ones((50, 50))))
    np.testing.assert_array_equal(np.sort(order), np.arange(50))
