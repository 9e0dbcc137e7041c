"""The edge radius of a cutter's blades where a design gives none: that of the basic rack, as far as it fits."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import replace

from ...core.errors import GeometryError
from ..cutting.generating_surface import GeneratingSurface
from ..pair.gear_pair import GearPair
from ..tooth.tooth_flanks import MemberName
from ..tooth.tooth_surface import tooth_surface
from .blank import BlankDimensions
from .iso23509.blank_dimensions import MemberBlank

ToothCheck = Callable[[GearPair, MemberName], None]

BASIC_RACK_RADIUS = 0.25  # over the mean normal module
SMALLEST_SHARE = 0.05  # of an edge radius over the module: a tooth is never without a fillet
REDUCTIONS = (1.0, 0.8, 0.6, 0.45, 0.3, 0.2)  # of the usual radius, until the tooth has its fillets
WHOLE_TOOTH_NODES, WHOLE_FILLET_NODES = (9, 7), 25
WIDTH_SHARE = 0.8  # of the radius at which the edges of both blades meet in the middle of the slot


def usual_edge_radius(blank: BlankDimensions, member: MemberBlank) -> float:
    """Edge radius of the blades of one member [mm].

    A quarter of the mean normal module, the fillet radius of the basic rack profile C of ISO 53:1998, table 2, and no
    more than two limits allow (ISO 53:1998, 5.3, with the slot of the bevel gear): the fillet ends below the clearance,
    ``r (1 - sin alpha) <= c``, and both fillets fit beside one another on the bottom of the slot,
    ``2 r tan((90 deg - alpha) / 2) <= w``, at the toe, where the slot is narrowest.

    Parameters
    ----------
    blank
        Dimensions of the pair.
    member
        Its pinion or its gear.

    Examples
    --------
    >>> from easeoff.cases import designed_blanks, read_design
    >>> design = read_design("fm-11x41")
    >>> blanks = designed_blanks(design.blank_design, (11, 41), design.pair)
    >>> round(usual_edge_radius(blanks, blanks.gear) / blanks.mean_normal_module, 3)
    0.25
    """
    drive, coast = blank.generated_drive_pressure_angle, blank.generated_coast_pressure_angle
    steeper = max(drive, coast)
    by_clearance = blank.clearance / (1.0 - math.sin(min(drive, coast)))
    pitch = math.pi * blank.mean_normal_module - member.mean_normal_thickness
    toe = member.inner_cone_distance * math.cos(member.inner_spiral_angle)
    toe /= member.mean_cone_distance * math.cos(member.mean_spiral_angle)
    bottom = toe * pitch - member.inner_dedendum * (math.tan(drive) + math.tan(coast))
    by_width = WIDTH_SHARE * bottom / (2.0 * math.tan((math.pi / 2 - steeper) / 2.0))
    radius = min(BASIC_RACK_RADIUS * blank.mean_normal_module, by_clearance, by_width)
    return round(max(radius, SMALLEST_SHARE * blank.mean_normal_module), 4)


def require_whole_tooth(pair: GearPair, member: MemberName) -> None:
    """Refuse a member whose flanks and fillets make no whole tooth.

    Parameters
    ----------
    pair
        The pair, with both flanks of the member.
    member
        ``"pinion"`` or ``"gear"``.

    Raises
    ------
    GeometryError
        As ``tooth_surface``.
    """
    tooth_surface(pair, member, WHOLE_TOOTH_NODES, WHOLE_FILLET_NODES)


def fitting_edge_radius(pair: GearPair, member: MemberName, usual: float, require: ToothCheck) -> float:
    """The usual edge radius of a member's blades, made smaller until the tooth passes a check [mm].

    The flanks do not depend on it. If no radius passes, the usual one stands.

    Parameters
    ----------
    pair
        The pair, with both flanks of the member.
    member
        ``"pinion"`` or ``"gear"``.
    usual
        See ``usual_edge_radius`` [mm].
    require
        Raises ``GeometryError`` for a pair and a member whose tooth will not do, as ``require_whole_tooth``.
    """
    for share in REDUCTIONS:
        try:
            require(_rounded(pair, member, share * usual), member)
        except GeometryError:
            continue
        return round(share * usual, 4)
    return usual


def _rounded(pair: GearPair, name: str, radius: float) -> GearPair:
    """The pair with an edge radius on both blades of one member."""
    member = pair.pinion if name == "pinion" else pair.gear
    opposite = None if member.opposite is None else rounded(member.opposite, radius)
    changed = replace(member, loaded=rounded(member.loaded, radius), opposite=opposite)
    return replace(pair, pinion=changed) if name == "pinion" else replace(pair, gear=changed)


def rounded(surface: GeneratingSurface, edge_radius: float) -> GeneratingSurface:
    """The same flank with another edge radius of its blade [mm]."""
    return replace(surface, blade=replace(surface.blade, edge_radius=edge_radius))
