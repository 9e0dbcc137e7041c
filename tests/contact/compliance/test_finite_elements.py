"""Quadratic bricks: patch tests, order of convergence, beam theory, CalculiX on the same mesh; in substructures."""

from __future__ import annotations

import shutil
import subprocess
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray
from scipy.sparse.linalg import splu, spsolve

from easeoff import GeometryError
from easeoff.cases import gear_pair, read_case
from easeoff.contact import STEEL, Material
from easeoff.contact.compliance.finite_elements.elastic_body import (
    ShapeFunctions,
    Substructures,
    brick_gradients,
    brick_stiffness,
    elastic_body,
    functionals,
    gauss_rule,
    lattice_places,
    shape_functions,
    stiffness,
    substructures,
)
from easeoff.geometry import LatticeSize, ToothLattice, tooth_lattice

Array = NDArray[Any]
COARSE = LatticeSize(5, 3, 2, 1, 1, 2)


def block(counts: tuple[int, int, int], lengths: tuple[float, float, float] = (1.0, 1.0, 1.0)) -> tuple[Array, Array]:
    """Nodes and cells of a box."""
    axes = [np.linspace(0.0, size, 2 * n + 1) for n, size in zip(counts, lengths, strict=True)]
    nodes = np.stack(np.meshgrid(*axes, indexing="ij"), axis=-1)
    numbers = np.arange(nodes[..., 0].size).reshape(nodes.shape[:3])
    windows = np.lib.stride_tricks.sliding_window_view(numbers, (3, 3, 3))[::2, ::2, ::2]
    return nodes.reshape(-1, 3), np.array(windows.reshape(-1, 3, 3, 3))


def on_boundary(nodes: Array) -> Array:
    low, high = nodes.min(axis=0), nodes.max(axis=0)
    return np.asarray(np.any((nodes < low + 1e-9) | (nodes > high - 1e-9), axis=1))


def with_boundary_values(
    nodes: Array, cells: Array, field: Array, boundary: Array, functions: ShapeFunctions = shape_functions
) -> Array:
    """Displacements (n, 3) of a body without loads whose boundary nodes follow a field; NaN where there is no node."""
    matrix = stiffness(nodes, cells, STEEL, functions).tocsr()
    given = np.repeat(boundary, 3)
    free = np.flatnonzero(~given & (matrix.diagonal() > 0.0))
    given = np.flatnonzero(given)
    values = np.where(np.repeat(boundary, 3), field.ravel(), np.nan)
    values[free] = spsolve(matrix[free][:, free].tocsc(), -(matrix[free][:, given] @ field.ravel()[given]))
    return values.reshape(-1, 3)


def serendipity_functions(points: Array) -> tuple[Array, Array]:
    """Shape functions and gradients as ``elastic_body.shape_functions``, zero for seven nodes the brick lacks."""
    values, gradients = shape_functions(points)
    fewer = _serendipity()
    return values @ fewer, np.einsum("nak,ab->nbk", gradients, fewer)


@cache
def _serendipity() -> Array:
    """Values (27, 27) of the 20 functions at all 27 nodes, zero for the nodes they lack."""
    points = np.stack(np.meshgrid(*[[-1.0, 0.0, 1.0]] * 3, indexing="ij"), axis=-1).reshape(27, 3)
    values = np.zeros((27, 27))
    for node, at in enumerate(points):
        zero = np.flatnonzero(at == 0.0)
        linear = np.prod(1.0 + np.delete(points, zero, axis=1) * np.delete(at, zero), axis=1)
        if zero.size == 0:
            values[:, node] = linear * (points @ at - 2.0) / 8.0
        elif zero.size == 1:
            values[:, node] = linear * (1.0 - points[:, zero[0]] ** 2) / 4.0
    return values


@pytest.mark.parametrize("functions", [serendipity_functions, shape_functions])
def test_patch_test_of_distorted_bricks(functions: ShapeFunctions) -> None:
    """Any linear displacement comes back exactly, however the bricks are distorted."""
    nodes, cells = block((2, 2, 2))
    boundary = on_boundary(nodes)
    random = np.random.default_rng(1)
    nodes = np.where(boundary[:, None], nodes, nodes + random.uniform(-0.06, 0.06, nodes.shape))
    field = nodes @ random.normal(size=(3, 3)) + random.normal(size=3)
    found = with_boundary_values(nodes, cells, field, boundary, functions)
    used = np.isfinite(found)
    assert used.all() if functions is shape_functions else not used.all()
    np.testing.assert_allclose(found[used], field[used], rtol=0, atol=1e-12 * np.abs(field).max())


def test_pure_bending_is_exact() -> None:
    """The exact solution of a bent bar is quadratic; bricks with straight edges hold it."""
    nodes, cells = block((2, 2, 1), (4.0, 1.0, 0.7))
    x, y, z = nodes.T - np.array([[0.0], [0.5], [0.35]])
    nu = STEEL.poisson_ratio
    field = 1e-3 * np.stack([x * y, -0.5 * (x**2 + nu * (y**2 - z**2)), -nu * y * z], axis=1)
    ends = (nodes[:, 0] < 1e-9) | (nodes[:, 0] > 4.0 - 1e-9)
    np.testing.assert_allclose(with_boundary_values(nodes, cells, field, ends), field, rtol=0, atol=1e-13)


def test_rigid_motions_cost_nothing_and_volume_is_kept() -> None:
    nodes, cells = block((2, 1, 2), (2.0, 1.0, 1.5))
    matrix = stiffness(nodes, cells, STEEL)
    rotation = np.cross([0.3, -0.2, 0.5], nodes)
    for motion in (rotation, np.ones_like(nodes)):
        assert np.abs(matrix @ motion.ravel()).max() < 1e-9 * abs(matrix).max()
    _, weights = gauss_rule()
    _, determinant = brick_gradients(nodes[cells.reshape(-1, 27)], shape_functions(gauss_rule()[0])[1])
    assert (determinant @ weights).sum() == pytest.approx(3.0, rel=1e-13)


def test_order_of_convergence() -> None:
    """Displacements of a smooth exact solution converge with the third power of the size of the bricks."""

    def exact(points: Array) -> Array:
        # Gradient of a harmonic function: no change of volume, no load inside.
        x, y, z = points.T
        a, b = 2.0, 1.5
        c = np.hypot(a, b)
        grow = np.exp(c * z)
        return np.stack(
            [
                a * np.cos(a * x) * np.sin(b * y) * grow,
                b * np.sin(a * x) * np.cos(b * y) * grow,
                c * np.sin(a * x) * np.sin(b * y) * grow,
            ],
            axis=1,
        )

    points, weights = gauss_rule()
    values, _ = shape_functions(points)
    errors = []
    for count in (2, 4):
        nodes, cells = block((count, count, count))
        nodes = nodes + 0.04 * np.sin(np.pi * nodes[:, [1, 2, 0]]) * np.sin(np.pi * nodes)
        found = with_boundary_values(nodes, cells, exact(nodes), on_boundary(nodes))
        flat = cells.reshape(-1, 27)
        inside = np.einsum("ga,mai->mgi", values, nodes[flat])
        difference = np.einsum("ga,mai->mgi", values, found[flat]) - exact(inside.reshape(-1, 3)).reshape(inside.shape)
        errors.append(np.sqrt(np.mean(np.sum(difference**2, axis=-1) @ weights)))
    assert np.log2(errors[0] / errors[1]) == pytest.approx(3.0, abs=0.3)


def test_cantilever_against_beam_theory() -> None:
    """A slender bar, of a material that does not contract where it is clamped: Timoshenko's beam."""
    material = Material(206000.0, 0.0)
    length, height, width = 20.0, 1.0, 0.8
    nodes, cells = block((12, 2, 1), (length, height, width))
    body = elastic_body(nodes, cells, np.flatnonzero(nodes[:, 0] < 1e-9), material)
    end = np.flatnonzero(nodes[:, 0] > length - 1e-9)
    even = functionals(len(nodes), end[None], np.full((1, end.size), 1.0 / end.size), np.array([[0.0, 1.0, 0.0]]))
    inertia, area = width * height**3 / 12.0, width * height
    expected = length**3 / (3.0 * material.elastic_modulus * inertia)
    expected += length / (5.0 / 6.0 * material.shear_modulus * area)
    assert body.response(even, even).item() == pytest.approx(expected, rel=1e-3)


def test_bricks_inside_out_are_refused() -> None:
    nodes, cells = block((1, 1, 1))
    with pytest.raises(GeometryError, match="inside out"):
        stiffness(nodes, cells[:, ::-1], STEEL)


# Nodes of a 20-node brick as CalculiX counts them, as places in the array (3, 3, 3).
CORNERS = [(0, 0), (2, 0), (2, 2), (0, 2)]
MIDDLES = [(1, 0), (2, 1), (1, 2), (0, 1)]
CALCULIX = [(*c, k) for k in (0, 2) for c in CORNERS] + [(*c, k) for k in (0, 2) for c in MIDDLES]
CALCULIX += [(*c, 1) for c in CORNERS]


@pytest.mark.skipif(shutil.which("ccx") is None, reason="CalculiX is not installed")
def test_calculix_on_the_same_tooth(tmp_path: Path) -> None:
    """A generated tooth on its body under one force: every displacement as CalculiX's."""
    lattice = tooth_lattice(gear_pair(read_case("fm-11x41")), "gear", COARSE)
    body = elastic_body(lattice.nodes, lattice.cells, lattice.fixed_nodes, STEEL, functions=serendipity_functions)
    loaded = int(lattice.flank[4, 4])
    force = np.array([-300.0, 200.0, -100.0])
    load = functionals(len(lattice.nodes), np.array([[loaded]]), np.ones((1, 1)), force[None])
    found = body.solve(load.toarray())[:, 0]

    bricks = np.stack([lattice.cells[:, i, j, k] for i, j, k in CALCULIX], axis=1)
    used = np.unique(bricks)
    lines = ["*NODE, NSET=ALL"]
    lines += [f"{n + 1}, " + ", ".join(f"{x:.11e}" for x in lattice.nodes[n]) for n in used]
    lines += ["*ELEMENT, TYPE=C3D20, ELSET=TOOTH"]
    for number, brick in enumerate(bricks + 1, start=1):
        lines += [f"{number}, " + ", ".join(map(str, brick[:10])) + ",", ", ".join(map(str, brick[10:]))]
    lines += ["*MATERIAL, NAME=STEEL", "*ELASTIC", f"{STEEL.elastic_modulus}, {STEEL.poisson_ratio}"]
    lines += ["*SOLID SECTION, ELSET=TOOTH, MATERIAL=STEEL", "*BOUNDARY"]
    lines += [f"{n + 1}, 1, 3" for n in np.intersect1d(lattice.fixed_nodes, used)]
    lines += ["*STEP", "*STATIC", "*CLOAD", *(f"{loaded + 1}, {k + 1}, {force[k]}" for k in range(3))]
    lines += ["*NODE PRINT, NSET=ALL", "U", "*END STEP", ""]
    (tmp_path / "tooth.inp").write_text("\n".join(lines))
    subprocess.run(["ccx", "tooth"], cwd=tmp_path, check=True, capture_output=True)
    table = np.loadtxt(tmp_path / "tooth.dat", skiprows=3)
    theirs = table[:, 1:4]
    ours = found.reshape(-1, 3)[table[:, 0].astype(int) - 1]
    assert np.abs(theirs[ours == 0.0]).max() == 0.0
    np.testing.assert_allclose(ours, theirs, rtol=0, atol=1e-5 * np.abs(theirs).max())


# Bodies of bricks in substructures, against a sparse factorisation, full matrices and rigid motions


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
    free = np.setdiff1d(np.arange(matrix.shape[0]), displacements(lattice.fixed_nodes))
    loads = np.random.default_rng(5).normal(size=(matrix.shape[0], 4))
    found = factored(lattice, lattice.fixed_nodes).solve(loads)
    expected = np.zeros_like(loads)
    expected[free] = splu(matrix[free][:, free].tocsc()).solve(loads[free])
    np.testing.assert_allclose(found, expected, rtol=0, atol=1e-11 * np.abs(expected).max())


def test_stiffness_against_kept_nodes_is_the_schur_complement() -> None:
    """And displacements with the kept nodes held are those of the others alone."""
    lattice = tooth()
    matrix = stiffness(lattice.nodes, lattice.cells, STEEL).toarray()
    kept = lattice.flank[::2, ::-1].ravel()  # in no order of their numbers
    on, held = displacements(kept), displacements(lattice.fixed_nodes)
    others = np.setdiff1d(np.arange(len(matrix)), np.concatenate([on, held]))
    body = factored(lattice, lattice.fixed_nodes, kept)
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
        substructures(apart, *brick_stiffness(nodes, apart, STEEL), lattice.fixed_nodes)


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
