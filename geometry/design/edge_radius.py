"""The edge radius of a cutter's blades where a design gives none: that of the basic rack, as far as it fits."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

import numpy as np

from ...core.errors import GeometryError
from ..cutting.generating_surface import GeneratingSurface
from ..pair.gear_pair import MEMBERS, GearPair
from ..tooth.tooth_flanks import MemberName
from ..tooth.tooth_surface import tooth_surface
from .blank import BlankDimensions
from .closest_fit import StandardSteps
from .slot_width import EdgeRadiusLimits, SlotWidths, ToothLine
from .tooth_proportions import measured_proportions

ToothCheck = Callable[[GearPair, MemberName], None]

BASIC_RACK_RADIUS = 0.25  # over the mean normal module
SMALLEST_SHARE = 0.05  # of an edge radius over the module: a tooth is never without a fillet
REDUCTIONS = (1.0, 0.8, 0.6, 0.45, 0.3, 0.2)  # of the usual radius, until the tooth has its fillets
WHOLE_TOOTH_NODES, WHOLE_FILLET_NODES = (9, 7), 25


def usual_edge_radii(blank: BlankDimensions, limits: EdgeRadiusLimits) -> tuple[float, float]:
    """Edge radii of the blades of pinion and gear [mm].

    A quarter of the mean normal module, the fillet radius of the basic rack profile C of ISO 53:1998, table 2, and no
    more than AGMA 929-B22 allows: no fillet meets the mate's tip, the blades can be made, and neither cuts into the
    other's fillet.

    Parameters
    ----------
    blank
        Dimensions of the pair.
    limits
        Largest edge radii of the pair.

    Examples
    --------
    >>> from easeoff.cases import designed_blanks, read_design
    >>> from easeoff.geometry.design.slot_width import SlotWidths
    >>> from easeoff.geometry.design.slot_width import ToothLine
    >>> from easeoff.geometry.design.tooth_proportions import ToothProportions
    >>> design = read_design("fm-11x41")
    >>> blanks = designed_blanks(design.blank_design, (11, 41), design.pair)
    >>> limits = EdgeRadiusLimits(SlotWidths(ToothLine(ToothProportions.of(blanks, 95.25, generated_gear=False))))
    >>> [round(radius / blanks.mean_normal_module, 3) for radius in usual_edge_radii(blanks, limits)]
    [0.25, 0.25]
    """
    least, usual = (share * blank.mean_normal_module for share in (SMALLEST_SHARE, BASIC_RACK_RADIUS))
    pinion, gear = (max(least, min(usual, float(np.nan_to_num(limit)))) for limit in limits.largest)
    return round(pinion, 4), round(gear, 4)


def allowed_edge_radius(pair: GearPair, member: MemberName, usual: float) -> float:
    """An edge radius, made smaller where AGMA 929-B22 allows less for the slots as they were cut [mm].

    Parameters
    ----------
    pair
        The pair seen from its drive side, with both flanks of both members.
    member
        ``"pinion"`` or ``"gear"``.
    usual
        See ``usual_edge_radii`` [mm].
    """
    try:
        proportions = measured_proportions(pair)
    except GeometryError:  # no mean point to measure at
        return usual
    limit = float(EdgeRadiusLimits(SlotWidths(ToothLine(proportions))).largest[MEMBERS.index(member)])
    least = SMALLEST_SHARE * proportions.mean_normal_module
    return min(usual, max(least, limit)) if np.isfinite(limit) else usual


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


def fitting_edge_radius(
    pair: GearPair, member: MemberName, usual: float, require: ToothCheck, steps: StandardSteps
) -> float:
    """The usual edge radius of a member's blades, made smaller until the tooth passes a check [mm].

    The flanks do not depend on it. If no radius passes, the usual one stands.

    Parameters
    ----------
    pair
        The pair, with both flanks of the member.
    member
        ``"pinion"`` or ``"gear"``.
    usual
        See ``usual_edge_radii`` [mm].
    steps
        Standard steps of the radius.
    require
        Raises ``GeometryError`` for a pair and a member whose tooth will not do, as ``require_whole_tooth``.
    """
    for share in REDUCTIONS:
        try:
            require(_rounded(pair, member, steps.edge(share * usual)), member)
        except GeometryError:
            continue
        return round(steps.edge(share * usual), 4)
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
