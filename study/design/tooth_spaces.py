"""Top lands, slots and fillets of a pair: by the formulas of AGMA 929-B22, and on the generated teeth."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ...core.checks import frozen_arrays
from ...core.errors import GeometryError
from ...geometry.cutting.generating_surface import GeneratingSurface
from ...geometry.design.slot_width import BLADE_OVERLAP, EdgeRadiusLimits, SlotWidths, ToothLine, TopLands
from ...geometry.design.tooth_proportions import FILLET_MUTILATION, ToothProportions
from ...geometry.flanks.blank_section import BlankSection
from ...geometry.pair.gear_pair import MEMBERS, GearPair
from ...geometry.tooth.tooth_surface import LandWidths, contact_heights, land_widths, tooth_side

Array = NDArray[Any]

TOE_HALF = np.linspace(0.0, 0.5, 6)
NO_VALUE = "-"


@frozen_arrays
@dataclass(frozen=True)
class ToothSpaces:
    """Spaces of a pair by the formulas and on the generated teeth; arrays have the pinion first.

    Parameters
    ----------
    slots, lands, limits
        Slot widths, top lands and edge-radius limits by AGMA 929-B22.
    measured
        Lands of the generated teeth at toe, mean point and heel, of both members.
    edge_radius
        Of the blades, the larger one of each member (2) [mm].
    fillet_clearance
        Between the fillets and the path of the mate's tip, the least in the half at the toe: (2, 2) [mm], the side on
        which the pinion is concave first; NaN where the teeth have no such place.
    """

    slots: SlotWidths
    lands: TopLands
    limits: EdgeRadiusLimits
    measured: tuple[LandWidths, LandWidths]
    edge_radius: Array
    fillet_clearance: Array

    def rows(self) -> Iterator[tuple[str, ...]]:
        """Table: quantity, by the formulas, on the generated teeth, their difference; toe / mean / heel [mm].

        The blade tips' heights are those of the path that they cut on the whole tooth, in their deepest positions.
        """
        yield "toe / mean / heel [mm]", "AGMA 929-B22", "generated teeth", "difference"
        for k, name in enumerate(MEMBERS):
            for label, formula, teeth in (
                ("top land", self.lands.width[k], self.measured[k].top_land),
                ("slot width", self.slots.width[k], self.measured[k].slot),
            ):
                yield f"{name} {label}", _texts(formula), _texts(teeth), _texts(teeth - formula, sign=True)
        clearance = self.limits.fillet_clearance(self.edge_radius)
        for k, name in enumerate(MEMBERS):
            for j, which in enumerate(("drive", "coast")):
                pair = clearance[k, j : j + 1], self.fillet_clearance[k, j : j + 1]
                apart = _texts(pair[1] - pair[0], sign=True)
                yield f"{name} fillet clearance at the toe, {which}", *map(_texts, pair), apart
        for k, name in enumerate(MEMBERS):
            for j, which in enumerate(("concave", "convex") if k == 0 else ("convex", "concave")):
                path = _texts(self.measured[k].root_line[j], sign=True)
                yield f"{name} {which}: blade tip above the root cone", NO_VALUE, path, NO_VALUE
        for k, name in enumerate(MEMBERS):
            least, most = self.blade_point(k)
            yield f"{name} blade point, least / greatest", _texts(np.array([least, most])), NO_VALUE, NO_VALUE
            limit = f"{self.limits.largest[k]:.3f} ({self.limits.governing[k]})"
            yield f"{name} edge radius: greatest; as cut", limit, f"{self.edge_radius[k]:.3f}", NO_VALUE

    def blade_point(self, member: int) -> tuple[float, float]:
        """Least blade point that leaves no fin in the widest slot, and greatest that fits the narrowest [mm].

        Parameters
        ----------
        member
            0 for the pinion, 1 for the gear.
        """
        return float(self.slots.greatest[member]) / 2.0 + BLADE_OVERLAP, float(self.slots.least[member])

    def warnings(self) -> Iterator[str]:
        """What cannot be cut as it is, a sentence each."""
        for k, name in enumerate(MEMBERS):
            least, most = self.blade_point(k)
            if not most > 0.0:
                yield f"the {name}'s slot has no width at its narrowest end ({most:.2f} mm): no blade enters it"
            elif least > most:
                yield (
                    f"the {name}'s slot narrows from {self.slots.greatest[k]:.2f} to {most:.2f} mm: a blade that fits "
                    "the narrow end leaves a fin at the wide one; change depth_taper or cutter_radius"
                )
            if (deepest := float(np.nanmin(self.fillet_clearance[k], initial=np.inf))) < -FILLET_MUTILATION:
                yield (
                    f"the {name}'s fillet reaches {-deepest:.2f} mm into the path of the mate's tip: a smaller "
                    "tool_edge_radius or a larger clearance_factor helps"
                )


def tooth_spaces(drive: GearPair, coast: GearPair, proportions: ToothProportions) -> ToothSpaces:
    """Spaces of a pair.

    Parameters
    ----------
    drive, coast
        The pair seen from both sides, with both flanks of both members.
    proportions
        Its tooth proportions.

    Raises
    ------
    GeometryError
        If a cutter meets no tooth of its blank, or does not reach an end of the face.

    Examples
    --------
    >>> from easeoff.cases import gear_pair, read_case
    >>> from easeoff.geometry.design.tooth_proportions import measured_proportions
    >>> drive, coast = (gear_pair(read_case("nasa-12x36"), side) for side in ("drive", "coast"))
    >>> spaces = tooth_spaces(drive, coast, measured_proportions(drive))
    >>> list(spaces.warnings())
    []
    """
    slots = SlotWidths(ToothLine(proportions))
    members = drive.pinion, drive.gear
    places = [_places(proportions, k) for k in (0, 1)]
    measured = tuple(land_widths(drive, name, t) for name, t in zip(MEMBERS, places, strict=True))
    clearance = np.stack([_fillet_clearance(pair) for pair in (drive, coast)], axis=1)
    edges = [max(m.loaded.blade.edge_radius, m.from_opposite.loaded.blade.edge_radius) for m in members]
    return ToothSpaces(
        slots, TopLands(slots), EdgeRadiusLimits(slots), (measured[0], measured[1]), np.array(edges), clearance
    )


def _places(proportions: ToothProportions, member: int) -> Array:
    """Lengthwise fractions of toe, mean point and heel (3)."""
    outer, width = proportions.outer_cone_distance[member], proportions.face_width[member]
    return np.array([0.0, 1.0 - (outer - proportions.mean_cone_distance[member]) / width, 1.0])


def _fillet_clearance(pair: GearPair) -> Array:
    """Least height of the contact above the end of the fillet, in the half at the toe, of both members (2) [mm]."""
    found = []
    for member, heights, along in zip((pair.pinion, pair.gear), *contact_heights(pair, TOE_HALF), strict=True):
        known = np.isfinite(heights) & (along >= 0.0) & (along <= 1.0)
        ends = _fillet_ends(member.loaded, member.section, along[known])
        found.append(float(np.min(heights[known] - ends)) if ends.size else float("nan"))
    return np.array(found)


def _fillet_ends(surface: GeneratingSurface, section: BlankSection, lengthwise: Array) -> Array:
    """Heights above the root cone at which a fillet ends (n) [mm]; none if the flank has no whole fillet there."""
    if lengthwise.size < 3:  # what the search along the face takes
        return np.zeros(0)
    try:
        found = tooth_side(surface, section, tuple(lengthwise.tolist()), 5, 2).fillet[:, :, -1]
    except GeometryError:
        return np.zeros(0)
    return section.height_above_root(found[2], np.hypot(found[0], found[1]))


def _texts(values: Array, *, sign: bool = False) -> str:
    return " / ".join(NO_VALUE if not np.isfinite(v) else f"{v:+.3f}" if sign else f"{v:.3f}" for v in values)
