"""Neighbouring teeth of a member coupled by its body, in a few modes of the loaded flank.

A tooth is condensed on a sector of its own. What the whole body changes is smooth on the flank: the displacement of a
tooth under loads on another, and the change of its own from its sector to the body closed round the member. A coarse
lattice and a dozen modes are enough for both. Loads and displacements are those of the flank itself: the indentation
under a load is none of the neighbours'.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ....geometry.pair.gear_pair import GearPair
from ....geometry.tooth.tooth_flanks import MemberName, named_member
from ....geometry.tooth.tooth_lattice import LatticeSize, ToothLattice, Web, graded, tooth_lattice
from ....geometry.vectors import rotate_z
from ..material import Material
from .elastic_body import elastic_body, functionals
from .flank_compliance import FlankCompliance, SharedBody, flank_loads, flank_shares, square_root
from .tooth_ring import RingCompliance, pitch_angle, ring_compliance

Array = NDArray[Any]
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


def body_modes(
    pair: GearPair,
    member: MemberName,
    material: Material,
    size: LatticeSize,
    rim_depth: float | None = None,
    web: Web | None = None,
) -> tuple[ToothLattice, dict[str, Array]]:
    """Coupling of the teeth of a member by its body, in modes of the nodes of a lattice of one pitch.

    Parameters
    ----------
    pair, member, material, rim_depth, web
        As ``finite_element_tooth.finite_element_tooth``.
    size
        From ``ring_size``.

    Returns
    -------
    tuple
        The lattice, and arrays by name: ``shapes`` (q, nodes), the modes on the nodes of its flank; ``coupling``
        (N, q, q), see ``SharedBody``; ``own`` (q, q), what of that the sector of a single tooth contains already.
    """
    lattice = ring_lattice(pair, member, size, rim_depth)
    teeth, loads = named_member(pair, member).teeth, flank_loads(lattice)
    if web is None:
        ring = ring_compliance(lattice, teeth, material, loads, np.unique(lattice.body[:, :, 0]))
    else:
        carried = tooth_lattice(pair, member, size, rim_depth, surface_nodes=SURFACE_NODES, web=web)
        ring = ring_compliance(carried, teeth, material, flank_loads(carried), np.unique(carried.body[0]))
    nodes, cells, held = sector_of(lattice, teeth)
    inward = -lattice.flank_normal.reshape(-1, 3)
    on_sector = functionals(len(nodes), lattice.flank.reshape(-1, 1), np.ones((len(inward), 1)), inward)
    single = elastic_body(nodes, cells, held, material).response(on_sector, on_sector)
    return lattice, modes_of(ring, single, nodal_areas(lattice), MODE_COUNT)


def sector_of(lattice: ToothLattice, teeth: int) -> tuple[Array, NDArray[np.int64], NDArray[np.int64]]:
    """One pitch with a pitch of plain body at either side: nodes, bricks and held nodes, as of a tooth of its own."""
    angle, nodes, cells = pitch_angle(lattice, teeth), [lattice.nodes], [lattice.cells]
    held, count = [lattice.body[:, :, 0].ravel()], len(lattice.nodes)
    for side, sense in zip(lattice.sides, (-1.0, 1.0), strict=True):
        away = graded(BESIDE, BESIDE_GROWTH)[1:]
        start = lattice.nodes[side.ravel()].T
        nodes += [rotate_z(np.full(side.size, sense * share * angle), start).T for share in away]
        numbers = count + np.arange(away.size * side.size).reshape(away.size, *side.shape)
        count += numbers.size
        layers = np.concatenate([side[None], numbers])[:: int(sense)]  # across the body, from the loaded side
        windows = np.lib.stride_tricks.sliding_window_view(layers, (3, 3, 3))[::2, ::2, ::2].reshape(-1, 3, 3, 3)
        along = np.swapaxes(windows, 1, 2)  # the first index runs along the face
        cells.append(along if _right_way_round(lattice) else along[:, ::-1])
        held += [numbers[:, :, 0].ravel(), numbers[-1].ravel()]
    return np.concatenate(nodes), np.concatenate(cells), np.unique(np.concatenate(held))


def _right_way_round(lattice: ToothLattice) -> bool:
    """Whether the bricks of a lattice count from toe to heel, not from heel to toe."""
    return bool(np.any(lattice.cells[0][0] == lattice.body[0, 0, 0]))


def modes_of(ring: RingCompliance, single: Array, areas: Array, count: int) -> dict[str, Array]:
    """The modes that hold most of the coupling of all teeth and of the change of the own one.

    Parameters
    ----------
    ring
        Compliance of all teeth on one body.
    single
        That of a tooth on a sector of its own (n, n) [mm/N].
    areas
        Weights (n) of the loads.
    count
        Number of modes q.
    """
    own = 0.5 * (single + single.T) - ring.alone
    weights = np.sqrt(areas)
    change = ring.shared * weights[:, None] * weights
    change[0] -= own * weights[:, None] * weights
    vectors = np.linalg.eigh(np.einsum("kij,klj->il", change, change))[1][:, : -count - 1 : -1]
    loads = vectors * weights[:, None]
    return {
        "shapes": vectors.T / weights,
        "coupling": loads.T @ ring.shared @ loads,
        "own": loads.T @ own @ loads,
    }


def nodal_areas(lattice: ToothLattice) -> Array:
    """Shares of a uniform load on the flank that fall on its nodes, none less than a tenth of the mean."""
    along, up = ((np.arange(n) + 0.5) / n for n in AREA_GRID)
    points = np.stack(np.meshgrid(along, up, indexing="ij")).reshape(2, -1)
    nodes, shares = flank_shares(lattice.lengthwise, lattice.profile, points)
    areas = np.bincount(nodes.ravel(), shares.ravel(), minlength=lattice.profile.size)
    return np.asarray(np.maximum(areas, AREA_SHARE_MINIMUM * areas.mean()))


def with_body(flank: FlankCompliance, lattice: ToothLattice, modes: Mapping[str, Array]) -> FlankCompliance:
    """A tooth on a sector of its own, put on the body that it shares with its neighbours.

    Parameters
    ----------
    flank
        Compliance of the tooth on its sector.
    lattice, modes
        From ``body_modes``.
    """
    along = np.broadcast_to(flank.lengthwise[:, None], flank.profile.shape)
    nodes, shares = flank_shares(lattice.lengthwise, lattice.profile, np.stack([along.ravel(), flank.profile.ravel()]))
    shapes = np.einsum("qnk,nk->qn", modes["shapes"][:, nodes], shares)
    alone = flank.factor.T @ flank.factor - shapes.T @ modes["own"] @ shapes
    return replace(flank, factor=square_root(alone), body=SharedBody(shapes, modes["coupling"]))
