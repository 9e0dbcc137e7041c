"""Both flanks of one tooth in one frame.

Each flank is solved in the position its own machine cuts it in. The loaded one stays there; the other one is turned
about the axis until the tooth has the thickness the pair gives it.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Literal

import numpy as np

from ...core.arrays import Array
from ...core.checks import instance, one_of
from ...core.errors import GeometryError
from ..cutting.generating_surface import GeneratingSurface
from ..flanks.blank_section import BlankSection
from ..flanks.flank import Flank, solve_flank
from ..pair.gear_pair import MEMBERS, GearPair, Member, tooth_angles
from ..pair.member_names import MemberName as MemberName
from ..vectors import rotate_z

Side = Literal["concave", "convex"]


def side(surface: GeneratingSurface) -> Side:
    """Side of the flank that a blade cuts: the outside blade the concave one, the inside blade the convex one."""
    return "concave" if surface.blade.side == "outside" else "convex"


@dataclass(frozen=True)
class PlacedFlank:
    """A flank turned about the member's axis."""

    section: BlankSection
    surface: GeneratingSurface
    rotation: float = 0.0  # about z, from where the machine cuts it to its tooth [rad]

    def at(self, axial: Array, radial: Array) -> Flank:
        """The flank at axial and radial coordinates (n) [mm], turned to its tooth, in the member's frame."""
        flank = solve_flank(self.surface, self.section, axial, radial)
        if self.rotation == 0.0:
            return flank
        angle = np.full(flank.position.shape[1], self.rotation)
        return replace(flank, position=rotate_z(angle, flank.position), normal=rotate_z(angle, flank.normal))


def placed_flanks(member: Member, tooth_angle: float) -> dict[Side, PlacedFlank]:
    """Both flanks of one tooth, of angular thickness ``tooth_angle`` [rad] in the middle of the flank.

    An unknown other flank is that of the other blade in the same machine.
    """
    loaded = PlacedFlank(member.section, member.loaded)
    opposite = PlacedFlank(member.section, member.other)
    placed = replace(opposite, rotation=placing_rotation(member, tooth_angle))
    return {side(member.loaded): loaded, side(opposite.surface): placed}


def placing_rotation(member: Member, tooth_angle: float) -> float:
    """Rotation of the flank that is not loaded from its machine to the tooth of an angular thickness [rad]."""
    turn, as_cut = member.middle_angle()
    return float(np.mod(turn * (tooth_angle - as_cut) + np.pi, 2.0 * np.pi) - np.pi)


def named_member(pair: GearPair, name: str) -> Member:
    """The pinion or the gear of a pair."""
    instance("pair", pair, GearPair)
    one_of("member", name, MEMBERS)
    return pair.pinion if name == "pinion" else pair.gear


def tooth_angle(pair: GearPair, name: str) -> float:
    """Angular thickness of a member's tooth in the middle of the flank [rad], see ``gear_pair.tooth_angles``.

    Raises
    ------
    InputError
        If the member is neither ``pinion`` nor ``gear``.
    GeometryError
        If the flanks leave no tooth.

    Examples
    --------
    >>> from easeoff.cases import gear_pair, read_case
    >>> pair = gear_pair(read_case("nasa-12x36"))
    >>> pitch = 2.0 * np.pi / 36
    >>> bool(0.3 < tooth_angle(pair, "gear") / pitch < 0.7)
    True
    """
    named_member(pair, name)
    angle = tooth_angles(pair)[MEMBERS.index(name)]
    if angle <= 0.0:
        raise GeometryError(
            f"the tooth of the {name} would be {np.degrees(angle):.3f} degrees thick in its middle: check the "
            "thickness, the point radii and the blade angles of both flanks"
        )
    return angle
