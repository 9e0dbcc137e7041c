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
    """Edge radii of the blades of pinion and gear [mm]: ISO 53:1998, profile C, within AGMA 929-B22.

    That is a quarter of the mean normal module, less where a fillet would meet the mate's tip, the blade could not be
    made, or one would cut into the other's fillet.
    """
    least, usual = (share * blank.mean_normal_module for share in (SMALLEST_SHARE, BASIC_RACK_RADIUS))
    pinion, gear = (max(least, min(usual, float(np.nan_to_num(limit)))) for limit in limits.largest)
    return round(pinion, 4), round(gear, 4)


def allowed_edge_radius(pair: GearPair, member: MemberName, usual: float) -> float:
    """Usual edge radius, or a smaller one where AGMA 929-B22 allows less for the slots as they were cut [mm]."""
    try:
        proportions = measured_proportions(pair)
    except GeometryError:  # no mean point to measure at
        return usual
    limit = float(EdgeRadiusLimits(SlotWidths(ToothLine(proportions))).largest[MEMBERS.index(member)])
    least = SMALLEST_SHARE * proportions.mean_normal_module
    return min(usual, max(least, limit)) if np.isfinite(limit) else usual


def require_whole_tooth(pair: GearPair, member: MemberName) -> None:
    """Refuse a member whose flanks and fillets make no whole tooth (GeometryError)."""
    tooth_surface(pair, member, WHOLE_TOOTH_NODES, WHOLE_FILLET_NODES)


def fitting_edge_radius(
    pair: GearPair, member: MemberName, usual: float, require: ToothCheck, steps: StandardSteps
) -> float:
    """Usual edge radius, made smaller until the tooth passes ``require`` [mm]; the usual one if none does."""
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
