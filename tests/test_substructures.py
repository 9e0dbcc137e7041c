"""Bodies of bricks in substructures, against a sparse factorisation, full matrices and rigid motions."""

from __future__ import annotations

from functools import cache
from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray
from scipy.sparse.linalg import splu

from easeoff.cases import gear_pair, read_case
from easeoff.contact import STEEL
from easeoff.contact.compliance.finite_elements.bricks import brick_stiffness, stiffness
from easeoff.contact.compliance.finite_elements.substructures import Substructures, lattice_places, substructures
from easeoff.core.errors import GeometryError
from easeoff.geometry import LatticeSize, ToothLattice, tooth_lattice

Array = NDArray[Any]
NOTHING = np.empty(0, dtype=np.int64)


@cache
def tooth() -> ToothLattice:
    return tooth_lattice(gear_pair(read_case("fm-11x41")), "pinion", LatticeSize(3, 2, 2, 1, 1, 1, 1))


def factored(lattice: ToothLattice, held: NDArray[np.int64], kept: NDArray[np.int64] = NOTHING) -> Substructures:
    return substructures(lattice.cells, *brick_stiffness(lattice.nodes, lattice.cells, STEEL), held, kept)


def displacements(nodes: NDArray[np.int64]) -> NDArray[np.int64]:
    return np.asarray((3 * nodes[:, None] + np.arange(3)).ravel())


def test_displacements_are_those_of_a_sparse_factorisation() -> None:
    lattice = tooth()
    matrix = stiffness(lattice.nodes, lattice.cells, STEEL)
    free = np.setdiff1d(np.arange(matrix.shape[0]), displacements(lattice.held))
    loads = np.random.default_rng(5).normal(size=(matrix.shape[0], 4))
    found = factored(lattice, lattice.held).solve(loads)
    expected = np.zeros_like(loads)
    expected[free] = splu(matrix[free][:, free].tocsc()).solve(loads[free])
    np.testing.assert_allclose(found, expected, rtol=0, atol=1e-11 * np.abs(expected).max())


def test_stiffness_against_kept_nodes_is_the_schur_complement() -> None:
    """And displacements with the kept nodes held are those of the others alone."""
    lattice = tooth()
    matrix = stiffness(lattice.nodes, lattice.cells, STEEL).toarray()
    kept = lattice.flank[::2, ::-1].ravel()  # in no order of their numbers
    on, held = displacements(kept), displacements(lattice.held)
    others = np.setdiff1d(np.arange(len(matrix)), np.concatenate([on, held]))
    body = factored(lattice, lattice.held, kept)
    within, to_kept = matrix[np.ix_(others, others)], matrix[np.ix_(others, on)]
    expected = matrix[np.ix_(on, on)] - to_kept.T @ np.linalg.solve(within, to_kept)
    np.testing.assert_allclose(body.stiffness, expected, rtol=0, atol=1e-11 * np.abs(expected).max())
    assert body.unknowns == others.size
    loads = np.random.default_rng(6).normal(size=(len(matrix), 2))
    moved = np.zeros_like(loads)
    moved[others] = np.linalg.solve(within, loads[others])
    np.testing.assert_allclose(body.solve(loads), moved, rtol=0, atol=1e-11 * np.abs(moved).max())


def test_a_body_that_is_not_held_resists_no_rigid_motion() -> None:
    lattice = tooth()
    kept = lattice.column[0, 0]
    body, points = factored(lattice, NOTHING, kept), lattice.nodes[kept]
    turned = [np.cross(axis, points) for axis in np.eye(3)]
    motions = np.stack([*(np.broadcast_to(axis, points.shape) for axis in np.eye(3)), *turned]).reshape(6, -1)
    forces = body.stiffness @ motions.T
    assert np.abs(forces).max() < 1e-10 * np.abs(body.stiffness).max() * np.abs(motions).max()
    assert np.linalg.matrix_rank(body.stiffness, tol=1e-9 * np.abs(body.stiffness).max()) == body.stiffness.shape[0] - 6


def test_a_part_that_is_free_to_move_is_refused() -> None:
    lattice = tooth()
    apart = np.concatenate([lattice.cells, lattice.cells + len(lattice.nodes)])  # a second body, held nowhere
    nodes = np.concatenate([lattice.nodes, lattice.nodes])
    with pytest.raises(GeometryError, match="free to move"):
        substructures(apart, *brick_stiffness(nodes, apart, STEEL), lattice.held)


def test_places_count_bricks_from_neighbour_to_neighbour() -> None:
    """Along a block's three axes, whatever the order of its bricks; bodies that do not touch have their own."""
    shape = (4, 3, 2)
    numbers = np.arange(9 * 7 * 5).reshape(9, 7, 5)
    index = np.stack(np.meshgrid(*map(np.arange, shape), indexing="ij"), axis=-1).reshape(-1, 3)
    index = np.random.default_rng(7).permutation(index)
    cells = np.stack([numbers[2 * i : 2 * i + 3, 2 * j : 2 * j + 3, 2 * k : 2 * k + 3] for i, j, k in index])
    np.testing.assert_array_equal(lattice_places(cells), index - index[0])
    both = lattice_places(np.concatenate([cells, cells + numbers.size]))
    np.testing.assert_array_equal(both, np.tile(index - index[0], (2, 1)))


def test_halving_keeps_the_factor_small() -> None:
    """The longest block of a bar of 40 x 3 x 3 bricks is eliminated with no more than two sections on its border."""
    numbers = np.arange(81 * 7 * 7).reshape(81, 7, 7)
    index = np.stack(np.meshgrid(np.arange(40), np.arange(3), np.arange(3), indexing="ij"), axis=-1).reshape(-1, 3)
    cells = np.stack([numbers[2 * i : 2 * i + 3, 2 * j : 2 * j + 3, 2 * k : 2 * k + 3] for i, j, k in index])
    points = np.stack(np.meshgrid(*(0.5 * np.arange(n) for n in numbers.shape), indexing="ij"), axis=-1)
    body = substructures(cells, *brick_stiffness(points.reshape(-1, 3), cells, STEEL), numbers[0].ravel())
    section = 3 * 7 * 7
    assert max(step.border.size for step in body.eliminations) <= 2 * section
    assert body.unknowns == 80 * section
