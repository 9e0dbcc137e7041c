"""Both teeth of a pair by finite elements, kept on disk."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import hstack

from ....core.errors import GeometryError, InputError
from ....geometry.pair import GearPair
from ....geometry.tooth_flanks import MemberName, named_member
from ....geometry.tooth_lattice import SHELL_HINT, LatticeSize, ToothLattice, tooth_lattice, usual_depth
from ..material import Material
from .body import elastic_body
from .condensed import FlankCompliance, flank_loads, foot_displacements, square_root
from .root_stress import RootStress, by_station, stress_functionals
from .store import kept, key_of

Array = NDArray[Any]
BRICKS_PER_HEIGHT = 4.4  # along the face, per usual depth of the body
BRICKS_ALONG = (8, 32)
FORMAT = 3  # of what is kept; raise it when the same input gives other arrays


@dataclass(frozen=True)
class FiniteElementTooth:
    """What the contact needs to know of one member's finite elements.

    Parameters
    ----------
    flank
        Compliance of its loaded flank.
    root
        Stress in its root.
    """

    flank: FlankCompliance
    root: RootStress


def usual_size(pair: GearPair, member: MemberName) -> LatticeSize:
    """Number of bricks that leaves about 1 % in the compliance: about a third of the tooth's height long."""
    one = named_member(pair, member)
    trace = one.flank(np.linspace(0.0, 1.0, 17), np.array([0.5])).position
    length = float(np.nansum(np.linalg.norm(np.diff(trace, axis=1), axis=0)))
    return LatticeSize(int(np.clip(round(BRICKS_PER_HEIGHT * length / usual_depth(one.section)), *BRICKS_ALONG)))


def finite_element_tooth(
    pair: GearPair,
    member: MemberName,
    material: Material,
    *,
    fineness: float = 1.0,
    rim_depth: float | None = None,
) -> FiniteElementTooth:
    """Compliance and root stress of one member's tooth.

    Made once and kept on disk, see ``store.cache_folder``.

    Parameters
    ----------
    pair
        The gear pair.
    member
        ``"pinion"`` or ``"gear"``.
    material
        Its material.
    fineness
        Multiplies the number of bricks in every direction.
    rim_depth
        Depth of the elastic body below the root [mm]; ``None`` for 1.2 times the tooth's height.

    Raises
    ------
    GeometryError
        If the tooth cannot be filled with bricks: pointed, undercut, cut through by its own fillets.
    InputError
        If a number is out of range.
    """
    if not 0.2 <= fineness <= 4.0:
        raise InputError(f"fineness = {fineness!r}: must lie between 0.2 and 4")
    size = usual_size(pair, member).finer(fineness)
    lattice = tooth_lattice(pair, member, replace(size, lengthwise=max(size.lengthwise, 4)), rim_depth)
    key = key_of(FORMAT, lattice.nodes, lattice.held, lattice.flank_normal, material)
    found = kept(key, lambda: _condensed(lattice, material, member))
    flank = FlankCompliance(lattice.lengthwise, lattice.profile, found["factor"])
    return FiniteElementTooth(flank, RootStress(found["stations"], found["stress"]))


def _condensed(lattice: ToothLattice, material: Material, member: str) -> dict[str, Array]:
    try:
        body = elastic_body(lattice.nodes, lattice.cells, lattice.held, material)
    except GeometryError as error:
        raise GeometryError(f"the {member}'s tooth cannot be filled with bricks: {error}; {SHELL_HINT}") from error
    feet, (stresses, station) = foot_displacements(lattice), stress_functionals(lattice, material)
    response = body.response(flank_loads(lattice), hstack([feet, stresses], format="csc"))
    count = feet.shape[1]
    root = by_station(response[count:], station)
    return {"factor": square_root(response[:count]), "stations": root.lengthwise, "stress": root.stress}
