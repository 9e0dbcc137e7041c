"""All teeth of a member on one closed body: their compliance under loads on one of them, from one pitch of the body.

Every pitch of the body is the same as the next, turned. A load on one tooth is a sum of waves round the member, and a
wave needs one pitch alone, whose sides move alike but for the turn and the phase of the wave. The pitch is condensed
to its sides once; each wave is then a small dense system.

The body couples neighbouring teeth in a few modes of the loaded flank. A tooth is condensed on a sector of its own.
What the whole body changes is smooth on the flank: the displacement of a tooth under loads on another, and the change
of its own from its sector to the body closed round the member. A coarse lattice and a dozen modes are enough for both.
Loads and displacements are those of the flank itself: the indentation under a load is none of the neighbours'.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

import numpy as np

from ....core.arrays import Array, Integers
from ....core.errors import GeometryError
from ....geometry.pair.gear_pair import GearPair
from ....geometry.tooth.tooth_flanks import MemberName, named_member
from ....geometry.tooth.tooth_lattice import LatticeSize, ToothLattice, Web, graded, tooth_lattice
from ....geometry.vectors import rotate_z
from ..material import Material
from .elastic_body import brick_stiffness, displacements, elastic_body, functionals, substructures
from .flank_compliance import FlankCompliance, SharedBody, flank_loads, flank_shares, square_root

if TYPE_CHECKING:
    from scipy.sparse import csc_array

SIDE_MISFIT_LIMIT = 1e-6  # [mm], between one side of a pitch and the other, turned by the pitch


@dataclass(frozen=True)
class RingCompliance:
    """Compliance between loads (n) on a tooth and the same on every other tooth of the member (N)."""

    alone: Array  # of one pitch with both sides held (n, n) [mm/N]
    shared: Array  # added by the sides' motion, k pitches further through the tooth (N, n, n)


def pitch_angle(lattice: ToothLattice, teeth: int) -> float:
    """Angle about the member's axis from one pitch of the body to that next to its opposite side [rad]."""
    start, end = (lattice.nodes[side].reshape(-1, 3).T for side in lattice.sides)
    for angle in (2.0 * np.pi / teeth, -2.0 * np.pi / teeth):
        if np.abs(rotate_z(np.full(start.shape[1], angle), start) - end).max() < SIDE_MISFIT_LIMIT:
            return angle
    raise GeometryError("the sides of the lattice must lie one pitch apart")


def ring_compliance(
    lattice: ToothLattice, teeth: int, material: Material, loads: csc_array, fixed: Integers
) -> RingCompliance:
    """Compliance of all teeth of a member on one body, from a lattice of one pitch, mid slot to mid slot.

    The unit loads (3 m, n) are also the displacements wanted; ``fixed`` are the same nodes on both sides.
    """
    from scipy.linalg import cho_factor, cho_solve

    angle = pitch_angle(lattice, teeth)
    movable = ~np.isin(lattice.sides[0].ravel(), fixed)
    on_sides = np.concatenate([side.ravel()[movable] for side in lattice.sides])
    loaded = np.setdiff1d(loads.tocoo().row // 3, np.concatenate([on_sides, fixed]))
    kept = np.concatenate([on_sides, loaded])
    bricks = brick_stiffness(lattice.nodes, lattice.cells, material)
    matrix = substructures(lattice.cells, *bricks, fixed, kept).stiffness
    sides, within = slice(0, 3 * on_sides.size), slice(3 * on_sides.size, None)
    to_sides, forces = matrix[within, sides], loads.tocsr()[displacements(loaded)].toarray()
    moved = cho_solve(cho_factor(matrix[within, within]), np.concatenate([to_sides, forces], axis=1))
    of_sides, of_forces = moved[:, sides], moved[:, within]
    condensed = matrix[sides, sides] - to_sides.T @ of_sides
    by_forces = to_sides.T @ of_forces
    turned = _second_turned(_second_turned(condensed, angle).T, angle)
    waves = _waves(0.5 * (turned + turned.T), _second_turned(by_forces, angle), teeth)
    alone = forces.T @ of_forces
    return RingCompliance(0.5 * (alone + alone.T), waves)


def _second_turned(rows: Array, angle: float) -> Array:
    """Rows (2 m, k) of both sides with those of the second one in the frame of the first, turned back by an angle."""
    half = len(rows) // 2
    second = np.moveaxis(rows[half:].reshape(half // 3, 3, rows.shape[1]), 1, 0)
    back = rotate_z(np.full(second.shape[1:], -angle), second)
    return np.concatenate([rows[:half], np.moveaxis(back, 0, 1).reshape(half, rows.shape[1])])


def _waves(stiffness_of_sides: Array, loads: Array, teeth: int) -> Array:
    """Compliance by distance (N, n, n) of sides that move alike but for the phase of each wave."""
    half = len(loads) // 2
    first, second = slice(0, half), slice(half, None)
    diagonal = stiffness_of_sides[first, first] + stiffness_of_sides[second, second]
    across = stiffness_of_sides[first, second]
    count = loads.shape[1]
    spectrum = np.empty((teeth // 2 + 1, count, count), dtype=complex)
    for wave in range(len(spectrum)):
        phase = np.exp(2j * np.pi * wave / teeth)
        factor = np.linalg.cholesky(diagonal + phase * across + np.conj(phase) * across.T)
        whitened = np.linalg.solve(factor, loads[first] + np.conj(phase) * loads[second])
        spectrum[wave] = np.conj(whitened.T) @ whitened
    return np.fft.irfft(spectrum, teeth, axis=0)


MODE_COUNT = 12  # modes of the body on a flank
BESIDE, BESIDE_GROWTH = 2, 1.6  # bricks in the pitch beside a tooth's own, each longer than the one before
SURFACE_NODES = (9, 13)  # up the fillet and up the flank
AREA_GRID = (24, 12)  # points along the flank and up it, by which the nodes are weighted
AREA_SHARE_MINIMUM = 0.1  # of the mean area: nodes in the fillet have none
RING_SIZE = LatticeSize(lengthwise=6, upward=2, through=2, slot=1, beside=0, deep=2, overhang=1)


def ring_size(fineness: float = 1.0) -> LatticeSize:
    """Bricks of one pitch of the body; with the usual ones, coupling is within 2 % of that on three times as many."""
    return replace(RING_SIZE.finer(fineness), beside=0)


def ring_lattice(pair: GearPair, member: MemberName, size: LatticeSize, rim_depth: float | None = None) -> ToothLattice:
    """Lattice of one pitch of the body with its tooth; ``size`` from ``ring_size``. Raises as ``tooth_lattice``."""
    return tooth_lattice(pair, member, size, rim_depth, surface_nodes=SURFACE_NODES)


@dataclass(frozen=True)
class ToothBody:
    """Body that carries a tooth; its depth below the root is 1.2 times the tooth's height by default."""

    rim_depth: float | None = None  # [mm]
    neighbours: bool = True  # whether all teeth of the member share it
    web: Web | None = None  # without one it is held at its bottom


WHOLE_BODY = ToothBody()


def body_modes(
    pair: GearPair, member: MemberName, material: Material, size: LatticeSize, body: ToothBody = WHOLE_BODY
) -> tuple[ToothLattice, dict[str, Array]]:
    """Lattice of one pitch, and the coupling of the teeth of a member by its body, in modes (q) of the flank's nodes.

    ``shapes`` (q, nodes); ``coupling`` (N, q, q), see ``SharedBody``; ``own`` (q, q), the part of it that the sector of
    a single tooth contains already.
    """
    lattice = ring_lattice(pair, member, size, body.rim_depth)
    teeth, loads = named_member(pair, member).teeth, flank_loads(lattice)
    if body.web is None:
        ring = ring_compliance(lattice, teeth, material, loads, np.unique(lattice.body[:, :, 0]))
    else:
        carried = tooth_lattice(pair, member, size, body.rim_depth, surface_nodes=SURFACE_NODES, web=body.web)
        ring = ring_compliance(carried, teeth, material, flank_loads(carried), np.unique(carried.body[0]))
    nodes, cells, held_nodes = sector_of(lattice, teeth)
    inward = -lattice.flank_normal.reshape(-1, 3)
    on_sector = functionals(len(nodes), lattice.flank.reshape(-1, 1), np.ones((len(inward), 1)), inward)
    single = elastic_body(nodes, cells, held_nodes, material).response(on_sector, on_sector)
    return lattice, modes_of(ring, single, nodal_areas(lattice), MODE_COUNT)


def sector_of(lattice: ToothLattice, teeth: int) -> tuple[Array, Integers, Integers]:
    """One pitch with a pitch of plain body at either side: nodes, bricks and held nodes, as of a tooth of its own."""
    angle, nodes, cells = pitch_angle(lattice, teeth), [lattice.nodes], [lattice.cells]
    held_nodes, count = [lattice.body[:, :, 0].ravel()], len(lattice.nodes)
    for side, sense in zip(lattice.sides, (-1.0, 1.0), strict=True):
        away = graded(BESIDE, BESIDE_GROWTH)[1:]
        start = lattice.nodes[side.ravel()].T
        nodes += [rotate_z(np.full(side.size, sense * share * angle), start).T for share in away]
        numbers = count + np.arange(away.size * side.size).reshape(away.size, *side.shape)
        count += numbers.size
        layers = np.concatenate([side[None], numbers])[:: int(sense)]  # across the body, from the loaded side
        windows = np.lib.stride_tricks.sliding_window_view(layers, (3, 3, 3))[::2, ::2, ::2].reshape(-1, 3, 3, 3)
        along = np.swapaxes(windows, 1, 2)  # the first index runs along the face
        from_toe = np.any(lattice.cells[0][0] == lattice.body[0, 0, 0])  # as the lattice's own bricks count
        cells.append(along if from_toe else along[:, ::-1])
        held_nodes += [numbers[:, :, 0].ravel(), numbers[-1].ravel()]
    return np.concatenate(nodes), np.concatenate(cells), np.unique(np.concatenate(held_nodes))


def modes_of(ring: RingCompliance, single: Array, areas: Array, count: int) -> dict[str, Array]:
    """Modes (``count``) that hold most of the coupling of all teeth and of the change of the own compliance.

    ``single`` is that of a tooth on a sector of its own (n, n) [mm/N]; ``areas`` are weights of the loads (n).
    """
    excess = 0.5 * (single + single.T) - ring.alone
    weights = np.sqrt(areas)
    change = ring.shared * weights[:, None] * weights
    change[0] -= excess * weights[:, None] * weights
    vectors = np.linalg.eigh(np.einsum("kij,klj->il", change, change))[1][:, : -count - 1 : -1]
    loads = vectors * weights[:, None]
    return {"shapes": vectors.T / weights, "coupling": loads.T @ ring.shared @ loads, "own": loads.T @ excess @ loads}


def nodal_areas(lattice: ToothLattice) -> Array:
    """Shares of a uniform load on the flank that fall on its nodes, none less than a tenth of the mean."""
    along, up = ((np.arange(n) + 0.5) / n for n in AREA_GRID)
    points = np.stack(np.meshgrid(along, up, indexing="ij")).reshape(2, -1)
    nodes, shares = flank_shares(lattice.lengthwise, lattice.profile, points)
    areas = np.bincount(nodes.ravel(), shares.ravel(), minlength=lattice.profile.size)
    return np.asarray(np.maximum(areas, AREA_SHARE_MINIMUM * areas.mean()))


def with_body(flank: FlankCompliance, lattice: ToothLattice, modes: Mapping[str, Array]) -> FlankCompliance:
    """A tooth on a sector of its own, put on the body that it shares with its neighbours."""
    along = np.broadcast_to(flank.lengthwise[:, None], flank.profile.shape)
    nodes, shares = flank_shares(lattice.lengthwise, lattice.profile, np.stack([along.ravel(), flank.profile.ravel()]))
    shapes = np.einsum("qnk,nk->qn", modes["shapes"][:, nodes], shares)
    alone = flank.factor.T @ flank.factor - shapes.T @ modes["own"] @ shapes
    return replace(flank, factor=square_root(alone), body=SharedBody(shapes, modes["coupling"]))
