"""Compliance of a tooth between points of its loaded flank, condensed from its finite elements.

A unit force along the flank's normal acts at a node of the flank; the displacement along the normal of another node is
read at the foot of *its* normal, on the middle surface of the tooth. Between lies the local indentation, which the line
contact adds with the distance to the foot. The kernel from flank to middle surface is smooth, so that forces anywhere
on the flank are shared among its nodes by the shape functions; a deflection of the loaded point itself is never
interpolated. By reciprocity the kernel is symmetric but for the last millimetres around a load; its symmetric part is
taken, with the eigenvalues that rounding and mesh leave below zero put to zero.

The same forces stress the root of the loaded side. Stresses of quadratic bricks are most exact at the 2 x 2 x 2 Gauss
points. They are read at the four points of each surface face that lie above these points, carried on to the surface
along the line through both points beneath.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING

import numpy as np

from ....core.arrays import Array, Integers, record
from ....geometry.tooth.tooth_lattice import ToothLattice
from ....geometry.tooth.tooth_surface import EndFace
from ..material import Material
from .elastic_body import brick_gradients, functionals, gauss_rule, quadratic, shape_functions

if TYPE_CHECKING:
    from scipy.sparse import csc_array

FOOT_ITERATIONS = 30
SPREAD_POINT_COUNT = 8  # points over a brick on which a force is spread
EIGENVALUE_RATIO_LIMIT = 1e-9  # of the greatest; what is below does not reach the digits of a force


@record(frozen=True)
class SharedBody:
    """The body that all teeth (N) of a member share, in modes (q) on the nodes of a flank.

    ``coupling`` [mm/N] counts from the loaded side through the tooth; at 0 it is the body's part in the tooth's own
    compliance.
    """

    shapes: Array
    coupling: Array  # with the tooth k pitches further (N, q, q)


@record(frozen=True)
class FlankCompliance:
    """Bending of one tooth between points of its loaded flank: Z^T Z [mm/N] between nodes, with Z the ``factor``."""

    lengthwise: Array
    profile: Array  # (nt, nh)
    factor: Array  # Z (k, nt nh)
    body: SharedBody | None = None  # adds to Z^T Z; None if each tooth has its own
    ends: tuple[EndFace, EndFace] | None = None  # toe and heel; None leaves out what they add

    def whitened(self, points: Array, weights: Array) -> Array:
        """Whitened unit loads Y (k, n): Y^T Y is the compliance of segments [mm/N], but for that of the shared body.

        Points (2, n, g) are fractions on this member; the weights (g) add up to one.
        """
        return self.unit_loads(points, weights)[0].T

    def unit_loads(self, points: Array, weights: Array) -> tuple[Array, Array]:
        """Unit loads on segments: whitened (n, k), as ``whitened``, and in the modes of the shared body (n, q)."""
        from scipy.sparse import csr_array

        nodes, shares = flank_shares(self.lengthwise, self.profile, np.reshape(points, (2, -1)))
        shares = shares * np.tile(weights, points.shape[1])[:, None]
        starts = np.arange(points.shape[1] + 1) * (weights.size * shares.shape[1])
        loads = csr_array((shares.ravel(), nodes.ravel(), starts), shape=(points.shape[1], self.profile.size))
        loads.sum_duplicates()  # the points of a segment share most of their nodes
        both = np.asarray(loads @ self._by_node)
        return both[:, : len(self.factor)], both[:, len(self.factor) :]

    @cached_property
    def _by_node(self) -> Array:
        parts = [self.factor] if self.body is None else [self.factor, self.body.shapes]
        return np.ascontiguousarray(np.concatenate(parts).T)


def share_of_three(point: Array, count: int) -> tuple[Integers, Array, Array]:
    """Nodes, shares and their slopes (n, 3 each) at points (n) counted in nodes along ``count`` of them."""
    brick = np.clip(np.floor(0.5 * point), 0, (count - 3) // 2).astype(np.int64)
    shares, slopes = quadratic(point - 2 * brick - 1)
    return 2 * brick[:, None] + np.arange(3), shares, slopes


def flank_shares(lengthwise: Array, profile: Array, points: Array) -> tuple[Integers, Array]:
    """Nodes and their shares (n, 9 each) of forces at points (2, n) of the flank; points beyond its ends move there."""
    rows = profile.shape[1]
    along = np.interp(np.clip(points[0], 0.0, 1.0), lengthwise, np.arange(lengthwise.size))
    sections, section_shares, _ = share_of_three(along, lengthwise.size)
    # Heights of the nodes at this lengthwise fraction; then the brick, and the point in it, from a parabola.
    heights = np.einsum("nk,nkh->nh", section_shares, profile[sections])
    wanted = np.clip(points[1], heights[:, 0], heights[:, -1])
    brick = np.clip(np.sum(heights[:, ::2] <= wanted[:, None], axis=1) - 1, 0, (rows - 3) // 2)
    levels = 2 * brick[:, None] + np.arange(3)
    low, middle, high = np.take_along_axis(heights, levels, axis=1).T
    rise, bend, above = 0.5 * (high - low), 0.5 * (high + low) - middle, wanted - middle
    shares = quadratic(2.0 * above / (rise + np.sqrt(rise * rise + 4.0 * bend * above)))[0]
    nodes = sections[:, :, None] * rows + levels[:, None, :]
    return nodes.reshape(-1, 9), (section_shares[:, :, None] * shares[:, None, :]).reshape(-1, 9)


def spread_shares(lengthwise: Array, profile: Array, points: Array) -> tuple[Integers, Array]:
    """As ``flank_shares``, of forces spread evenly over the length of a brick along the face (n, 9 k each).

    So the stress next to a force does not depend on whether that is on a corner or in the middle of a brick.
    """
    nodes = np.arange(lengthwise.size)
    at = np.interp(np.clip(points[0], 0.0, 1.0), lengthwise, nodes)
    away = 2.0 * ((np.arange(SPREAD_POINT_COUNT) + 0.5) / SPREAD_POINT_COUNT - 0.5)
    along = np.interp(at[:, None] + away, nodes, lengthwise)
    spread = np.stack([along, np.broadcast_to(points[1][:, None], along.shape)]).reshape(2, -1)
    loaded_nodes, shares = flank_shares(lengthwise, profile, spread)
    of_point = (at.size, 9 * SPREAD_POINT_COUNT)
    return loaded_nodes.reshape(of_point), shares.reshape(of_point) / SPREAD_POINT_COUNT


@dataclass(frozen=True)
class Feet:
    """Points at which the normals of n flank nodes meet the middle surface of the tooth."""

    nodes: Integers
    shares: Array
    depth: Array  # from the flank (n) [mm]


def feet_of_normals(lattice: ToothLattice, *, in_tooth: bool = False) -> Feet:
    """Feet of the normals of all nodes of the loaded side; at the ends of the tooth the nearest points.

    Normals in the fillet may lead down into the body; if ``in_tooth``, not below the tooth's lowest nodes.
    """
    middle = lattice.column[:, lattice.column.shape[1] // 2]
    count, rows = middle.shape
    start, normal = lattice.nodes[lattice.flank].reshape(-1, 3), lattice.flank_normal.reshape(-1, 3)
    point, depth = np.mgrid[:count, lattice.root_row : rows].reshape(2, -1).astype(float), np.zeros(len(start))
    lowest = np.array([[0.0], [float(lattice.root_row) if in_tooth else 0.0]])
    highest = np.array([[count - 1.0], [rows - 1.0]])

    def shares(point: Array) -> tuple[Integers, list[Array]]:
        (i, along, d_along), (j, up, d_up) = (share_of_three(p, n) for p, n in zip(point, (count, rows), strict=True))
        products = (along, up), (d_along, up), (along, d_up)
        nodes = middle[i[:, :, None], j[:, None, :]].reshape(-1, 9)
        return nodes, [(a[:, :, None] * b[:, None, :]).reshape(-1, 9) for a, b in products]

    for _ in range(FOOT_ITERATIONS):
        nodes, value_and_slopes = shares(point)
        position, *tangents = (np.einsum("nk,nkx->nx", share, lattice.nodes[nodes]) for share in value_and_slopes)
        off = position + depth[:, None] * normal - start
        step = np.linalg.solve(np.stack([*tangents, normal], axis=2), off[..., None])[..., 0]
        point = np.clip(point - np.clip(step[:, :2].T, -2.0, 2.0), lowest, highest)
        depth = depth - step[:, 2]
    nodes, (value, _, _) = shares(point)
    position = np.einsum("nk,nkx->nx", value, lattice.nodes[nodes])
    return Feet(nodes, value, np.sum((start - position) * normal, axis=1))


def flank_loads(lattice: ToothLattice) -> csc_array:
    """Unit forces into the tooth at the nodes of the loaded side (3 n, k)."""
    flank = lattice.flank.reshape(-1, 1)
    return functionals(len(lattice.nodes), flank, np.ones(flank.shape), -lattice.flank_normal.reshape(-1, 3))


def foot_displacements(lattice: ToothLattice, *, in_tooth: bool = False) -> csc_array:
    """Displacement at the foot of the normal of each node of the loaded side, along it into the tooth (3 n, k)."""
    feet = feet_of_normals(lattice, in_tooth=in_tooth)
    return functionals(len(lattice.nodes), feet.nodes, feet.shares, -lattice.flank_normal.reshape(-1, 3))


def square_root(compliance: Array) -> Array:
    """Factor Z such that Z^T Z is the positive semidefinite matrix nearest to a compliance (k, k), made symmetric."""
    values, vectors = np.linalg.eigh(0.5 * (compliance + compliance.T))
    kept = values > EIGENVALUE_RATIO_LIMIT * values[-1]
    return np.ascontiguousarray((vectors[:, kept] * np.sqrt(values[kept])).T)


ROOT_BRICK_SHARE = 0.35  # of the bricks from the fillet's middle to the tip whose stress is read; it falls off above
FORCE_SETS_PER_BATCH = 512  # bounds the memory
STRESS_COMPONENTS = ((0, 0), (1, 1), (2, 2), (1, 2), (0, 2), (0, 1))


@record(frozen=True)
class StressResponse:
    """Stress at the root of the loaded side under unit forces on the nodes (k) of the flank."""

    lengthwise: Array
    stress: Array  # xx, yy, zz, yz, xz, xy around the fillet (s, p, 6, k) [MPa/N]

    def largest(self, forces: Array) -> Array:
        """Largest tensile stress (s, n) [MPa] at each station, for n sets of forces (k, n) [N] on the nodes."""
        tensors = (self._tensor(batch) for batch in _batches(forces))
        parts = [np.linalg.eigvalsh(tensor)[..., -1].max(axis=1) for tensor in tensors]
        return np.concatenate([np.empty((self.lengthwise.size, 0)), *parts], axis=1)

    def gradients(self, forces: Array) -> Array:
        """Derivatives (k, n) [MPa/N] of the largest tensile stress of all stations by the forces on the nodes (k, n).

        The place of the largest stress and its direction, in which there is no shear, stay to first order.
        """
        return np.concatenate([np.empty((len(forces), 0)), *map(self._gradients, _batches(forces))], axis=1)

    def _gradients(self, forces: Array) -> Array:
        tensor = self._tensor(forces)
        points, columns = self.stress.shape[1], np.arange(forces.shape[1])
        stress = np.linalg.eigvalsh(tensor)[..., -1].reshape(-1, columns.size)
        station, point = np.divmod(np.argmax(stress, axis=0), points)
        direction = np.linalg.eigh(tensor[station, point, columns])[1][..., -1]
        shares = [(1.0 if i == j else 2.0) * direction[:, i] * direction[:, j] for i, j in STRESS_COMPONENTS]
        return np.asarray(np.einsum("cn,nck->kn", np.stack(shares), self.stress[station, point]))

    def _tensor(self, forces: Array) -> Array:
        """Stress tensors (s, p, n, 3, 3) [MPa] under sets of forces (k, n)."""
        stress = np.einsum("spck,kn->spnc", self.stress, forces, optimize=True)
        tensor = np.empty((*stress.shape[:-1], 3, 3))
        for component, (i, j) in enumerate(STRESS_COMPONENTS):
            tensor[..., i, j] = tensor[..., j, i] = stress[..., component]
        return tensor


def _batches(forces: Array) -> Iterator[Array]:
    """Sets of forces (k, n), so many at a time."""
    step = FORCE_SETS_PER_BATCH
    return (forces[:, start : start + step] for start in range(0, forces.shape[1], step))


def _faces(lattice: ToothLattice) -> list[tuple[Integers, int, int]]:
    """Bricks on the loaded side's fillet (m, 3, 3, 3), the axis across their surface, and the end it is at."""
    rows = 2 * max(round(ROOT_BRICK_SHARE * (lattice.flank.shape[1] // 2)), 1) + 1
    # Not the bricks at toe and heel: the sharp corner where the tooth ends on its body has no stress of its own.
    on_flank = np.isin(lattice.cells[:, :, 0, :], lattice.flank[1:-1, :rows]).all(axis=(1, 2))
    on_floor = np.isin(lattice.cells[:, :, :, 2], lattice.slot[0, 1:-1]).all(axis=(1, 2))
    return [(lattice.cells[on_flank], 1, -1), (lattice.cells[on_floor], 2, 1)]


def stress_functionals(lattice: ToothLattice, material: Material) -> tuple[csc_array, Array]:
    """Stress components around the loaded side's fillet as functionals (3 n, 6 q), and the q lengthwise fractions."""
    from scipy.sparse import csc_array

    nu, shear = material.poisson_ratio, material.shear_modulus
    first = 2.0 * shear * nu / (1.0 - 2.0 * nu)
    points, _ = gauss_rule(2)
    depth = abs(points[0, 0])
    per_section = int(lattice.column[1, 0, 0] - lattice.column[0, 0, 0])
    values, gradients = shape_functions(points)
    columns, stations = [], []
    for cells, axis, end in _faces(lattice):
        flat = cells.reshape(-1, 27)
        spatial, _ = brick_gradients(lattice.nodes[flat], gradients)
        # The two Gauss points on a line across the surface: the nearer one counts 1 + w, the further one -w.
        near = np.flatnonzero(np.sign(points[:, axis]) == end)
        mirrored = points[near].copy()
        mirrored[:, axis] *= -1.0
        far = np.array([np.flatnonzero(np.all(np.isclose(points, m), axis=1))[0] for m in mirrored])
        beyond = (1.0 - depth) / (2.0 * depth)
        slope = (1.0 + beyond) * spatial[:, near] - beyond * spatial[:, far]  # (m, 4, 27, 3)
        stations.append(np.einsum("na,ma->mn", values[near], lattice.lengthwise[flat // per_section]))
        columns.append((np.broadcast_to(flat[:, None], slope.shape[:3]), slope))
    station = np.concatenate([s.ravel() for s in stations])
    nodes = np.concatenate([c[0].reshape(-1, 27) for c in columns])
    slope = np.concatenate([c[1].reshape(-1, 27, 3) for c in columns])
    # Work of a displacement on each stress component, per node and direction (m, 6, 27, 3).
    work = np.zeros((len(nodes), 6, 27, 3))
    for component, (i, j) in enumerate(STRESS_COMPONENTS):
        work[:, component, :, i] += shear * slope[:, :, j]
        work[:, component, :, j] += shear * slope[:, :, i]
        if i == j:
            work[:, component] += first * slope
    rows = np.broadcast_to((3 * nodes[:, None, :, None] + np.arange(3)), work.shape)
    column = np.broadcast_to(np.arange(6 * len(nodes)).reshape(-1, 6, 1, 1), work.shape)
    wanted = csc_array((work.ravel(), (rows.ravel(), column.ravel())), shape=(3 * len(lattice.nodes), 6 * len(nodes)))
    return wanted, station


def by_station(stress: Array, station: Array) -> StressResponse:
    """Stresses (6 q, k) by unit forces, put in the order of their lengthwise fractions (q)."""
    levels, which = np.unique(np.round(station, 9), return_inverse=True)
    order = np.argsort(which, kind="stable")
    in_order = stress.reshape(station.size, 6, -1)[order]
    return StressResponse(levels, in_order.reshape(levels.size, -1, 6, stress.shape[1]))
