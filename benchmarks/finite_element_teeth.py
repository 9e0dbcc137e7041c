"""Teeth by finite elements, as a solid shell and as a shell, for the benchmark of finite elements to compare."""

from __future__ import annotations

import time
from dataclasses import dataclass, replace
from functools import cache
from typing import Any

import numpy as np
from numpy.polynomial import legendre
from numpy.typing import NDArray
from scipy.sparse import csc_array

from easeoff.cases import gear_pair, read_case
from easeoff.contact import Shell
from easeoff.contact import STEEL
from easeoff.contact.compliance.finite_elements.elastic_body import Substructures, elastic_body, functionals
from easeoff.contact.compliance.finite_elements.flank_compliance import (
    flank_loads,
    flank_shares,
    foot_displacements,
    square_root,
)
from easeoff.contact.compliance.finite_elements.finite_element_tooth import solid_shell_size, usual_size
from easeoff.contact.compliance.finite_elements.finite_element_tooth import SolidShell, solid_shell
from easeoff.geometry import GearPair
from easeoff.geometry.flanks.flank import solve_flank
from easeoff.geometry.pair.gear_pair import bodies
from easeoff.geometry.tooth.tooth_flanks import MemberName, named_member
from easeoff.geometry import LatticeSize, ToothLattice, tooth_lattice

Array = NDArray[Any]
CASES = ("fm-11x41", "fh-12x41-45")
MEMBERS: tuple[MemberName, MemberName] = ("pinion", "gear")
PATCH = 2.0  # [mm]
FORCE = 500.0  # [N]
GRID = (np.linspace(0.1, 0.9, 5), np.linspace(0.15, 0.85, 4))
MIDDLE = (np.array([0.5]), np.array([0.5]))


@dataclass
class Tooth:
    """A solved tooth: compliance between patches, free-edge deflection of a force at mid face and mid height."""

    lattice: ToothLattice
    dofs: int
    matrix: Array
    edge: Array
    seconds: dict[str, float]
    begun: float


@cache
def pair_of(name: str) -> GearPair:
    """A shipped pair."""
    return gear_pair(read_case(name))


def patches(name: str, member: MemberName, along: Array, up: Array) -> tuple[Array, Array, Array]:
    """Quadrature points (2, n, 9) of square patches on the flank, weights, and positions with normals (2, 3, n 9)."""
    one = named_member(pair_of(name), member)
    t, h = (a.ravel() for a in np.meshgrid(along, up, indexing="ij"))
    step = 1e-3

    def flank(t: Array, h: Array) -> Array:
        found = solve_flank(one.loaded, one.section, *one.section.points(t, h))
        return np.stack([found.position, found.normal])

    here = flank(t, h)[0]
    sizes = [np.linalg.norm(flank(t + step * a, h + step * (1 - a))[0] - here, axis=0) / step for a in (1, 0)]
    x, w = np.polynomial.legendre.leggauss(3)
    a, b = (g.ravel() for g in np.meshgrid(x, x, indexing="ij"))
    points = np.stack(
        [t[:, None] + 0.5 * PATCH / sizes[0][:, None] * a, h[:, None] + 0.5 * PATCH / sizes[1][:, None] * b]
    )
    return points, np.outer(w, w).ravel() / 4.0, flank(points[0].ravel(), points[1].ravel())


@cache
def tooth(name: str, member: MemberName, size: LatticeSize | None = None, depth: float | None = None) -> Tooth:
    """Solve one tooth by finite elements."""
    pair = pair_of(name)
    start = time.process_time()
    lattice = tooth_lattice(pair, member, size or usual_size(pair, member), depth)
    made = time.process_time()
    body = elastic_body(lattice.nodes, lattice.cells, lattice.fixed_nodes, STEEL)
    solved = measured(name, member, lattice, body, foot_displacements(lattice), body.unknowns)
    return replace(
        solved, seconds=solved.seconds | {"lattice": made - start, "assembly and factor": solved.begun - made}
    )


@cache
def reference(name: str, member: MemberName) -> Tooth:
    """The tooth on the finest lattice."""
    usual = usual_size(pair_of(name), member)
    finest = replace(usual, upward=7, through=usual.through + 2, slot=3, lengthwise=usual.lengthwise + 8)
    return tooth(name, member, finest)


@cache
def solid_tooth(name: str, member: MemberName, fineness: float = 1.0) -> Tooth:
    """Solve one tooth as a solid shell."""
    pair = pair_of(name)
    start = time.process_time()
    size, counts = solid_shell_size(pair, member, fineness)
    lattice = tooth_lattice(pair, member, size)
    made = time.process_time()
    shell = solid_shell(lattice, STEEL, counts)
    solved = measured(
        name, member, lattice, shell, foot_displacements(lattice, in_tooth=True), 3 * int(np.prod(counts))
    )
    return replace(
        solved, seconds=solved.seconds | {"lattice": made - start, "assembly and factor": solved.begun - made}
    )


def measured(
    name: str,
    member: MemberName,
    lattice: ToothLattice,
    body: Substructures | SolidShell,
    feet: csc_array,
    unknowns: int,
) -> Tooth:
    """What is compared, of a factored tooth."""
    begun = time.process_time()
    loads = flank_loads(lattice)
    factor = square_root(body.response(loads, feet))
    seconds = {"solves": time.process_time() - begun}

    def shares(which: tuple[Array, Array]) -> Array:
        points, weights, _ = patches(name, member, *which)
        result = np.zeros((lattice.profile.size, points.shape[1]))
        for k in range(points.shape[1]):
            nodes, share = flank_shares(lattice.lengthwise, lattice.profile, points[:, k])
            np.add.at(result[:, k], nodes.ravel(), (share * weights[:, None]).ravel())
        return result

    on_grid = factor @ shares(GRID)
    edge = FORCE * body.response(csc_array(loads @ csc_array(shares(MIDDLE))), free_edge(lattice))[:, 0]
    return Tooth(lattice, unknowns, on_grid.T @ on_grid, edge, seconds, begun)


def free_edge(lattice: ToothLattice) -> csc_array:
    """Displacement of the middle of the tip, across the tooth away from the load, at every section."""
    middle = lattice.column[:, lattice.column.shape[1] // 2]
    surface = lattice.nodes[middle]
    normal = np.cross(np.gradient(surface[:, -1], axis=0), surface[:, -1] - surface[:, -3])
    normal /= np.linalg.norm(normal, axis=1)[:, None]
    normal *= -np.sign(np.sum(normal * lattice.flank_normal[:, -1], axis=1))[:, None]
    return functionals(len(lattice.nodes), middle[:, -1:], np.ones((len(normal), 1)), normal)


def shell_of(name: str, member: MemberName, shell: Shell, lengthwise: Array) -> tuple[Array, Array]:
    """Compliance between the same patches, and deflection of the free edge, of the shell."""
    body = bodies(pair_of(name))[MEMBERS.index(member)]

    def vectors(where: tuple[Array, Array]) -> Array:
        points, weights, flank = patches(name, member, *where)
        found, shape = body.shell_coordinates(*flank), points.shape[1:]
        arc = np.clip(found.arc, 0.0, body.trace_length).reshape(shape)
        direction = np.moveaxis(found.direction.reshape(3, *shape), 0, -1)
        return shell.whiten(shell.load_vectors(found.height.reshape(shape), arc, direction, weights))

    grid, middle = vectors(GRID), vectors(MIDDLE)
    arc = legendre.legval(2 * lengthwise - 1, body.trace_arc) - legendre.legval(-1.0, body.trace_arc)
    outward = np.zeros((arc.size, 3))
    outward[:, 2] = -1.0 if body.convex else 1.0
    edge = shell.whiten(shell.load_vectors(shell.dimensions.height(arc), np.clip(arc, 0, body.trace_length), outward))
    return grid.T @ grid, FORCE * (edge.T @ middle)[:, 0]


def difference(matrix: Array, edge: Array, other: Tooth) -> list[float]:
    """Peak of the free edge, whole matrix, uniform load [%]."""
    return [
        100.0 * (edge.max() / other.edge.max() - 1.0),
        100.0 * np.linalg.norm(matrix - other.matrix) / np.linalg.norm(other.matrix),
        100.0 * (matrix.sum() / other.matrix.sum() - 1.0),
    ]
