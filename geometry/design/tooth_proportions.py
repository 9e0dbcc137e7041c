"""The tooth proportions of a pair that AGMA 929-B22 takes, and the cutters that are to make them.

Tooth proportions of a pair whose basic data are not known: measured on its blanks and flanks.
"""

from __future__ import annotations

import math
from contextlib import nullcontext, suppress
from dataclasses import dataclass
from typing import Any

from ...core.arrays import shared_fields
from ...core.checks import array, number
from ...core.errors import GeometryError
from ..cutting.generating_surface import GeneratingSurface
from ..flanks.blank_section import BlankSection
from ..pair.gear_pair import GearPair, Member
from ..pair.tooth_thickness import mean_cone_distances, mean_flanks, mean_normal_thickness, mean_thicknesses
from .blank import BlankDimensions, MeanPointAngles, angles_of_normal
from .iso23509.blank_dimensions import MemberBlank, MemberFrame, member_blank

Two = tuple[float, float]

FILLET_MUTILATION = 0.05  # [mm], suggested in table 3
BLADE_FLAT = 0.2  # [mm], suggested in table 3
BLADE_FLAT_SHARE = 0.1  # of the module: the most that is taken of a small blade


@dataclass(frozen=True, kw_only=True)
class ToothProportions:
    """Tooth proportions of a pair (AGMA 929-B22, tables 2 and 3) [mm, rad]; of two values the pinion's first."""

    number_of_teeth: tuple[int, int]
    shaft_angle: float
    hypoid_offset: float
    mean_normal_module: float
    face_width: Two
    outer_cone_distance: Two
    mean_cone_distance: Two
    pitch_angle: Two
    dedendum_angle: Two
    mean_addendum: Two
    mean_dedendum: Two
    mean_normal_thickness: Two
    clearance: float
    drive_pressure_angle: float  # of the pinion's concave flank (alpha_cv1)
    coast_pressure_angle: float  # of its convex flank, positive (-alpha_cx1)
    gear_spiral_angle: float
    cutter_radius: float
    number_of_blade_groups: int = 0  # z0; 0 for face milling
    generated_gear: bool = True
    inside_blade_angle: float | None = None  # Formate (alpha_BX2); mean pressure angle if None
    #: k_E: 0 spread blade, 1 face-hobbed, 1.3 with a roughing blade; by the process if None
    gear_rotation_factor: float | None = None
    stock_allowance: Two = (0.0, 0.0)  # S_A, by the roughing cutter; 0 if completing
    fillet_mutilation: float = FILLET_MUTILATION
    blade_flat: float = BLADE_FLAT

    def __post_init__(self) -> None:
        array("stock_allowance", self.stock_allowance, "mm", ndim=1, size=2, least=0.0)
        for name in ("fillet_mutilation", "blade_flat"):
            number(name, getattr(self, name), "mm", least=0.0)

    @classmethod
    def of(
        cls, blank: BlankDimensions, cutter_radius: float, number_of_blade_groups: int = 0, *, generated_gear: bool
    ) -> ToothProportions:
        """Proportions of a pair of blanks, with the suggested allowances and members finished in one cut."""
        pinion, gear = (shared_fields(cls, member) for member in (blank.pinion, blank.gear))
        of_members: dict[str, Any] = {name: (pinion[name], gear[name]) for name in gear}
        return cls(
            **shared_fields(cls, blank),
            **of_members,
            drive_pressure_angle=blank.generated_drive_pressure_angle,
            coast_pressure_angle=blank.generated_coast_pressure_angle,
            gear_spiral_angle=blank.gear.mean_spiral_angle,
            cutter_radius=cutter_radius,
            number_of_blade_groups=number_of_blade_groups,
            generated_gear=generated_gear,
            blade_flat=min(BLADE_FLAT, BLADE_FLAT_SHARE * blank.mean_normal_module),
        )

    @property
    def pitch(self) -> float:
        """Mean normal circular pitch (p_n) [mm] (50)."""
        return math.pi * self.mean_normal_module

    @property
    def taper(self) -> float:
        """Thickness that both flanks of a tooth lose per height: the sum of the tangents."""
        return math.tan(self.drive_pressure_angle) + math.tan(self.coast_pressure_angle)

    @property
    def half_included_angle(self) -> float:
        """Half the angle between both flanks of a tooth (Sigma_alpha / 2) [rad] (49)."""
        return 0.5 * (self.drive_pressure_angle + self.coast_pressure_angle)

    @property
    def offset_angle(self) -> float:
        """Offset angle in the pitch plane (zeta_mp) [rad] (7, 8, 13, 14)."""
        pinion, gear = self.pitch_angle
        of_pinion, of_gear = self.mean_cone_distance
        lean = 2.0 * of_gear * math.sin(gear) + 2.0 * of_pinion * math.sin(pinion) * math.cos(gear) / math.cos(pinion)
        return math.asin(2.0 * self.hypoid_offset / lean * math.sin(self.shaft_angle) / math.cos(pinion))

    @property
    def rotation_factor(self) -> float:
        """k_E (65 to 68)."""
        if self.gear_rotation_factor is not None:
            return self.gear_rotation_factor
        return 1.0 if self.number_of_blade_groups else 0.0


def measured_proportions(pair: GearPair) -> ToothProportions:
    """Tooth proportions of a pair with all four flanks, seen from its drive side, in the middle of the gear's face."""
    members, sections = (pair.pinion, pair.gear), (pair.pinion.section, pair.gear.section)
    of_pinion, of_gear = sections
    distance = mean_cone_distances(pair, must_touch=True)
    thickness = [
        mean_normal_thickness(member, middle, r)
        for member, middle, r in zip(members, mean_thicknesses(pair), distance, strict=True)
    ]
    heights = [_heights(section, r) for section, r in zip(sections, distance, strict=True)]
    angles = [mean_flank_angles(member, r) for member, r in zip(members, distance, strict=True)]
    spiral = [sum(abs(each.spiral_angle) for each in both) / 2.0 for both in angles]
    gear = pair.gear
    settings = gear.loaded.settings
    module = 2.0 * distance[1] * math.sin(of_gear.pitch_angle) * math.cos(spiral[1]) / gear.teeth
    flanks = gear.loaded, gear.from_opposite.loaded
    return ToothProportions(
        number_of_teeth=(pair.pinion.teeth, gear.teeth),
        shaft_angle=pair.assembly.shaft_angle,
        hypoid_offset=pair.assembly.hypoid_offset,
        mean_normal_module=module,
        face_width=(of_pinion.face_width, of_gear.face_width),
        outer_cone_distance=(of_pinion.outer_cone_distance, of_gear.outer_cone_distance),
        mean_cone_distance=distance,
        pitch_angle=(of_pinion.pitch_angle, of_gear.pitch_angle),
        dedendum_angle=(of_pinion.pitch_angle - of_pinion.root_angle, of_gear.pitch_angle - of_gear.root_angle),
        mean_addendum=(heights[0][0], heights[1][0]),
        mean_dedendum=(heights[0][1], heights[1][1]),
        mean_normal_thickness=(thickness[0], thickness[1]),
        clearance=(heights[1][1] - heights[0][0] + heights[0][1] - heights[1][0]) / 2.0,
        drive_pressure_angle=angles[1][0].pressure_angle,
        coast_pressure_angle=angles[1][1].pressure_angle,
        gear_spiral_angle=spiral[1],
        cutter_radius=sum(_cutter_radius(each, heights[1][1]) for each in flanks) / 2.0,
        number_of_blade_groups=round(settings.indexing_ratio * gear.teeth),
        generated_gear=settings.generated,
        inside_blade_angle=flanks[0].blade.pressure_angle,
        blade_flat=min(BLADE_FLAT, BLADE_FLAT_SHARE * module),
    )


def measured_blank(member: Member, distance: float, mid_flank_thickness: float) -> tuple[MemberBlank, float]:
    """Blank and mean normal module [mm] of a member by ISO 23509:2016, measured at a mean cone distance [mm].

    The normal circular thickness [mm] is given mid-flank. Raises GeometryError where a flank has no such place.
    """
    section = member.section
    spiral = dict.fromkeys(("outer", "mean", "inner"), math.nan)
    outer = section.outer_cone_distance
    for place, at in (("outer", outer), ("mean", distance), ("inner", outer - section.face_width)):
        with suppress(GeometryError) if place != "mean" else nullcontext():
            spiral[place] = sum(abs(each.spiral_angle) for each in mean_flank_angles(member, at)) / 2.0
    pressure = sum(abs(each.pressure_angle) for each in mean_flank_angles(member, distance)) / 2.0
    axial, radial = map(float, section.on_pitch_cone(distance))
    module = 2.0 * radial * math.cos(spiral["mean"]) / member.teeth
    addendum, dedendum = _heights(section, distance)
    frame = MemberFrame(
        number_of_teeth=member.teeth,
        mean_point_distance=axial,
        mean_cone_distance=distance,
        outer_face_width=outer - distance,
        inner_face_width=section.face_width - outer + distance,
        mean_addendum=addendum,
        mean_dedendum=dedendum,
        thickness_modification_coefficient=mean_normal_thickness(member, mid_flank_thickness, distance) / module / 2.0
        - math.pi / 4.0,
        **{f"{place}_spiral_angle": angle for place, angle in spiral.items()},
        **shared_fields(MemberFrame, section),
    )
    return member_blank(frame, module, pressure, 0.0), module


def _heights(section: BlankSection, distance: float) -> tuple[float, float]:
    """Addendum and dedendum at right angles to the pitch cone at a cone distance [mm]."""
    pitch = section.pitch_angle
    axial, radial = map(float, section.on_pitch_cone(distance))

    def to_cone(angle: float, apex: float) -> float:
        return ((axial + apex) * math.sin(angle) - radial * math.cos(angle)) / math.cos(pitch - angle)

    return to_cone(section.face_angle, section.face_apex), -to_cone(section.root_angle, section.root_apex)


def mean_flank_angles(member: Member, distance: float) -> tuple[MeanPointAngles, MeanPointAngles]:
    """Angles of the loaded and of the other flank at a cone distance."""
    loaded, other = (
        angles_of_normal(flank.position[:, 0], flank.normal[:, 0], member.section.pitch_angle, flank.surface.hand)
        for flank in mean_flanks(member, distance)
    )
    return loaded, other


def _cutter_radius(surface: GeneratingSurface, height: float) -> float:
    """Distance from the cutter axis of the edge at a height above the tip [mm]."""
    blade = surface.blade
    along = height / abs(blade.edge[2])
    return math.hypot(blade.tip[0] + along * blade.edge[0], blade.tip[1] + along * blade.edge[1])
