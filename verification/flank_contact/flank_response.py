"""Compliance of a flank under pressures on it, indentation and bending in one, from finite elements.

Between two points a distance r apart the compliance is that of a half space, (1 - nu^2) / (pi E r), plus what the real
body adds. The latter is smooth and is interpolated between nodes; the former is integrated in closed form over the
cells of a pressure field by whoever has such cells.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import csr_array

from ...contact.compliance.finite_elements.array_store import kept, key_of
from ...contact.compliance.finite_elements.finite_element_tooth import unfilled
from ...contact.compliance.material import Material
from ...core.checks import frozen_arrays, instance
from ...core.errors import GeometryError
from ...geometry.pair.gear_pair import GearPair
from ...geometry.tooth.lattice_spacing import LatticeSpacing, with_middles
from ...geometry.tooth.tooth_flanks import MemberName
from ...geometry.tooth.tooth_lattice import LatticeSize, ToothLattice, tooth_lattice
from .surface_compliance import surface_compliance

Array = NDArray[Any]
# Thicknesses of bricks over that of the others, the outermost first: at tip, toe and heel, and below the loaded flank.
# A tooth ends in wedges; with bricks as thick as the load is far from the end, a sharp one would be much too stiff.
EDGE_BRICKS = (0.05, 0.12, 0.3, 0.65)
THROUGH_BRICKS = (0.04, 0.1, 0.25, 0.7, 1.0, 0.3)
EDGE_SHARE = 4  # at most every so many bricks are thinner at one edge
LOADED_PROFILE_LIMIT = 0.02  # of the nodes that are loaded; the fillet below is too strongly curved for a half space
STORE_VERSION = 2  # of what is kept; raise it when the same input gives other arrays


@frozen_arrays
@dataclass(frozen=True)
class FlankResponse:
    """Compliance that a tooth's body adds to the half space under normal forces on its loaded flank.

    Parameters
    ----------
    lengthwise
        Lengthwise fractions (nt) of the loaded nodes.
    profile
        Their profile fractions (nt, nh).
    beyond_half_space
        (nt nh, nt nh) [mm/N], symmetric.

    Examples
    --------
    >>> even = np.linspace(0.0, 1.0, 4)
    >>> response = FlankResponse(even, np.tile(even, (4, 1)), np.eye(16))
    >>> print(response.shares(np.array([[0.5], [0.5]])).sum().round(12))
    1.0
    """

    lengthwise: Array
    profile: Array
    beyond_half_space: Array

    def shares(self, points: Array) -> csr_array:
        """Nodes' shares (n, nt nh) in points (2, n) of the flank, by cubics; beyond the outermost nodes, theirs."""
        count, rows = self.profile.shape
        sections, along = cubic_shares(np.broadcast_to(self.lengthwise, (points.shape[1], count)), points[0])
        nodes, shares = [], []
        for k in range(sections.shape[1]):
            levels, up = cubic_shares(self.profile[sections[:, k]], points[1])
            nodes.append(sections[:, [k]] * rows + levels)
            shares.append(along[:, [k]] * up)
        index = np.concatenate(nodes, axis=1)
        points_of = np.repeat(np.arange(points.shape[1]), index.shape[1])
        values = np.concatenate(shares, axis=1).ravel()
        return csr_array((values, (points_of, index.ravel())), shape=(points.shape[1], self.profile.size))


def cubic_shares(points: Array, wanted: Array) -> tuple[NDArray[np.int64], Array]:
    """Indices and shares (n, 4) of the four of each row's increasing points (n, m) around the wanted ones (n)."""
    inside = np.clip(wanted, points[:, 0], points[:, -1])
    first = np.clip(np.sum(points <= inside[:, None], axis=1) - 2, 0, points.shape[1] - 4)
    index = first[:, None] + np.arange(4)
    four = np.take_along_axis(points, index, axis=1)
    shares = np.ones_like(four)
    for j in range(4):
        for m in range(4):
            if m != j:
                shares[:, j] *= (inside - four[:, m]) / (four[:, j] - four[:, m])
    return index.astype(np.int64), shares


def thinner_edges(points: LatticeSpacing, ratios: tuple[float, ...]) -> LatticeSpacing:
    """Points of as many bricks, those at tip, toe and heel thinner by ratios, the outermost by the first."""
    heel = _thinner_end(points.lengthwise, ratios)
    both = 1.0 - _thinner_end((1.0 - heel)[::-1], ratios)[::-1]
    enough = points.through.size == 2 * len(THROUGH_BRICKS) + 1
    through = _points(np.array(THROUGH_BRICKS)) if enough else points.through
    return LatticeSpacing(both, _thinner_end(points.upward, ratios), through)


def _thinner_end(points: Array, ratios: tuple[float, ...]) -> Array:
    sizes = np.diff(points[::2])
    count = min(len(ratios), max(sizes.size // EDGE_SHARE, 1))
    sizes[-count:] *= ratios[count - 1 :: -1]
    return _points(sizes)


def _points(sizes: Array) -> Array:
    return with_middles(np.concatenate([[0.0], np.cumsum(sizes)]) / sizes.sum())


def flank_response(
    pair: GearPair, member: MemberName, material: Material, size: LatticeSize, rim_depth: float | None = None
) -> FlankResponse:
    """Response of one member's loaded flank; made once and kept on disk, see ``array_store.cache_folder``.

    Parameters
    ----------
    pair
        The gear pair.
    member
        ``"pinion"`` or ``"gear"``.
    material
        Its material.
    size
        Number of bricks; those at tip, toe and heel are thin.
    rim_depth
        As ``tooth_lattice``.

    Raises
    ------
    GeometryError
        As ``tooth_lattice``, or if a brick is turned inside out.

    Examples
    --------
    >>> from easeoff.cases import gear_pair, read_case
    >>> from easeoff.contact import STEEL
    >>> from easeoff.geometry import LatticeSize
    >>> pair = gear_pair(read_case("nasa-12x36"))
    >>> response = flank_response(pair, "gear", STEEL, LatticeSize(4, 3, 2, 1, 1, 1, 0))
    >>> response.beyond_half_space.shape
    (35, 35)
    """
    instance("material", material, Material)
    instance("size", size, LatticeSize)
    lattice = tooth_lattice(pair, member, size, rim_depth, thinner_edges(LatticeSpacing.of_size(size), EDGE_BRICKS))
    key = key_of("flank_response", STORE_VERSION, lattice.nodes, lattice.held, lattice.flank_normal, material)
    shapes = {"lengthwise": (None,), "profile": (None, None), "beyond_half_space": (None, None)}
    found = kept(key, shapes, lambda: _response(lattice, material, member))
    return FlankResponse(found["lengthwise"], found["profile"], found["beyond_half_space"])


def _response(lattice: ToothLattice, material: Material, member: str) -> dict[str, Array]:
    lowest = int(np.argmax(np.all(lattice.profile > LOADED_PROFILE_LIMIT, axis=0)))
    chosen = (slice(1, -1), slice(lowest, -1))  # nothing is known of a force on the edge itself
    loaded, normal = lattice.flank[chosen].ravel(), lattice.flank_normal[chosen].reshape(-1, 3)
    try:
        whole = surface_compliance(lattice.nodes, lattice.cells, lattice.held, material, loaded, normal)
    except GeometryError as error:
        raise unfilled(member, error) from error
    position = lattice.nodes[loaded]
    distance = np.linalg.norm(position[:, None] - position, axis=2)
    np.fill_diagonal(distance, np.inf)
    beyond = whole - 1.0 / (np.pi * material.plane_strain_modulus * distance)
    return {
        "lengthwise": lattice.lengthwise[chosen[0]],
        "profile": lattice.profile[chosen],
        "beyond_half_space": 0.5 * (beyond + beyond.T),
    }
