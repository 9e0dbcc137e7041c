"""From the pitch cones to the teeth: pressure angles, depth, face and root cones, face width, thickness.

One function for each step of ISO 23509:2016, clause 7. Pairs of values are ordered pinion, gear.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

from ....core.errors import GeometryError, InputError
from .blank_design import BlankDesign
from .pitch_cones import PitchCones


@dataclass(frozen=True)
class PressureAngles:
    """Normal pressure angles of both flanks [rad] (formulas 117 to 121 and 201)."""

    limit: float
    generated_drive: float
    generated_coast: float

    @property
    def effective_drive(self) -> float:
        """Angle against the limit flank, drive side (alpha_eD) [rad]."""
        return self.generated_drive - self.limit

    @property
    def effective_coast(self) -> float:
        """Angle against the limit flank, coast side (alpha_eC) [rad]."""
        return self.generated_coast + self.limit

    @property
    def mean(self) -> float:
        """Mean of both generated angles (alpha_n) [rad]."""
        return (self.generated_drive + self.generated_coast) / 2.0


@dataclass(frozen=True)
class ToothDepth:
    """Tooth depth at the mean point [mm] (formulas 132 to 139), with the coefficients it came from."""

    profile_shift_coefficient: float
    thickness_modification_coefficient: float
    working_depth: float
    clearance: float
    addendum: tuple[float, float]
    dedendum: tuple[float, float]


@dataclass(frozen=True)
class MatingCone:
    """Cone of the pinion that runs at a distance along a cone of the gear."""

    offset_angle: float
    angle: float
    apex: float


@dataclass(frozen=True)
class PinionFaceWidth:
    """Face width of the pinion from the mean point outwards and inwards [mm] (formulas 156 to 173)."""

    outside: float
    inside: float
    axial_angle: float = math.nan
    face_contact_width: float = math.nan


def pressure_angles(design: BlankDesign, cones: PitchCones) -> PressureAngles:
    """Pressure angles, shifted by the asked share of the limit pressure angle."""
    limit = cones.limit_pressure_angle
    shift = design.limit_pressure_angle_influence * limit
    return PressureAngles(
        limit, design.nominal_drive_pressure_angle + shift, design.nominal_coast_pressure_angle - shift
    )


def tooth_depth(design: BlankDesign, module: float, normal_pressure_angle: float) -> ToothDepth:
    """Tooth depth from data type I, or from type II turned into type I (ISO 23509:2016, table 4)."""
    shift, thickness = design.profile_shift_coefficient, design.thickness_modification_coefficient
    above, below = design.basic_addendum_factor, design.basic_dedendum_factor
    if design.depth_factor is not None:
        addendum_factor, clearance_factor = design.gear_mean_addendum_factor, design.clearance_factor
        if addendum_factor is None or clearance_factor is None:
            raise InputError("gear_mean_addendum_factor, clearance_factor: data type II needs both")
        above = design.depth_factor / 2.0
        shift = design.depth_factor * (0.5 - addendum_factor)
        below = design.depth_factor * (clearance_factor + 0.5)
        if design.thickness_factor is not None:
            thickness = design.thickness_factor / 2.0
        elif design.gear_mean_slot_width is not None:
            # the slot narrows from its width at the pitch cone by both flanks down to the gear's dedendum
            slope = math.tan(normal_pressure_angle)
            thickness = (design.gear_mean_slot_width / module + 2.0 * below * slope - math.pi / 2.0) / 2.0
    if shift is None or above is None or below is None or thickness is None:
        raise InputError("profile_shift_coefficient: data type I is incomplete")
    return ToothDepth(
        profile_shift_coefficient=shift,
        thickness_modification_coefficient=thickness,
        working_depth=2.0 * module * above,
        clearance=module * (below - above),
        addendum=(module * (above + shift), module * (above - shift)),
        dedendum=(module * (below - shift), module * (below + shift)),
    )


def mating_cone(
    cones: PitchCones, gear_pitch_apex: float, cone_angle: float, taper: float, apex: float, clearance: float
) -> MatingCone:
    """Pinion cone that clears a gear cone: face over root, or root under face (formulas 142 to 147, 152, 153).

    Angles [rad]; apexes beyond the crossing point and clearance [mm]; ``taper`` is the angle of that cone against the
    pitch cone, without sign. GeometryError if the offset leaves no common plane.
    """
    excess, offset = cones.shaft_angle - math.pi / 2, cones.hypoid_offset
    reach = cones.gear_mean_cone_distance * math.cos(taper) - gear_pitch_apex * math.cos(cone_angle)
    tilt = math.atan(offset * math.tan(excess) * math.cos(cone_angle) / reach)
    sine = offset * math.cos(tilt) * math.sin(cone_angle) / reach
    if not abs(sine) < 1.0:
        raise GeometryError(f"hypoid_offset = {offset:g} mm: no pinion cone can follow the gear's face and root cones")
    turn = math.asin(sine) - tilt
    angle = math.asin(
        math.sin(excess) * math.sin(cone_angle) + math.cos(excess) * math.cos(cone_angle) * math.cos(turn)
    )
    level = offset * math.sin(turn) * math.cos(cone_angle) - apex * math.sin(cone_angle)
    return MatingCone(turn, angle, (level - clearance) / math.sin(angle))


def width_in_pitch_plane(cones: PitchCones, inner: float, outer: float) -> float:
    """Pinion face width between two cone distances of the gear [mm] (formulas 154 and 155)."""
    offset = cones.gear_mean_cone_distance * math.sin(cones.offset_angle)
    if not inner > abs(offset):
        raise GeometryError(f"gear_face_width: the gear's inner cone distance {inner:g} mm falls short of the offset")
    return math.sqrt(outer**2 - offset**2) - math.sqrt(inner**2 - offset**2)


def pinion_face_width(
    design: BlankDesign, cones: PitchCones, module: float, depth: ToothDepth, face: MatingCone
) -> PinionFaceWidth:
    """Face width of the pinion by the rule of its method (formulas 156 to 173); method 1 uses the face cone."""
    width, share = design.gear_face_width, cones.face_width_factor
    if design.method == 0:
        return PinionFaceWidth(share * width, (1.0 - share) * width)
    if design.method == 2:
        total = width * (1.0 + math.tan(cones.offset_angle) ** 2)
        return PinionFaceWidth(share * total, (1.0 - share) * total)
    if design.method == 3:
        outer = cones.gear_mean_cone_distance + share * width
        inner = outer - width
        in_plane = width_in_pitch_plane(cones, inner, outer)
        # the standard asks for a whole number of millimetres
        total = math.floor(in_plane + 3.0 * module * abs(math.tan(cones.offset_angle)) + 1.0)
        inside = width_in_pitch_plane(cones, inner, cones.gear_mean_cone_distance) + (total - in_plane) / 2.0
        return PinionFaceWidth(total - inside, inside)
    return _gleason_face_width(design, cones, depth, face)


def _gleason_face_width(design: BlankDesign, cones: PitchCones, depth: ToothDepth, face: MatingCone) -> PinionFaceWidth:
    """Face width of the pinion long enough to cover the gear's, along its axis (formulas 159 to 165)."""
    ratio = design.number_of_teeth[1] / design.number_of_teeth[0]
    pinion, gear, turn = cones.pinion_pitch_angle, cones.gear_pitch_angle, cones.offset_angle
    axial_angle = math.atan2(
        math.sin(turn) * math.cos(gear), ratio * math.cos(pinion) + math.cos(gear) * math.cos(turn)
    )
    contact = design.gear_face_width * math.cos(axial_angle) / math.cos(turn - axial_angle)
    # one millimetre along the pitch cone covers this much of the pinion axis, measured on the face cone
    axial = math.cos(face.angle) / math.cos(face.angle - pinion)
    margin = depth.working_depth * abs(math.sin(face.offset_angle)) * (1.0 - 1.0 / ratio)
    step = (depth.dedendum[1] - depth.clearance) * math.sin(pinion)
    raised = depth.addendum[0] * math.sin(pinion)
    share = cones.face_width_factor
    outside = (share * contact * axial + margin - step + raised) / axial
    inside = ((1.0 - share) * contact * axial + margin + step - raised) / axial
    return PinionFaceWidth(outside, inside, axial_angle, contact)


def thickness_modification(
    design: BlankDesign,
    module: float,
    theoretical: float,
    normal_pressure_angle: float,
    spiral_angles: tuple[float, float],
    cone_distances: tuple[float, float],
) -> tuple[float, float]:
    """Coefficients x_sm1, x_sm2, half the backlash taken off each member (formulas 202 to 210).

    ``theoretical`` is x_smn, without backlash; spiral angles [rad] and cone distances [mm] are the gear's (mean,
    outer).
    """
    mean_spiral, outer_spiral = spiral_angles
    scale = cone_distances[0] / cone_distances[1]
    normal = 1.0 / math.cos(normal_pressure_angle)
    factors = (
        (design.outer_normal_backlash, normal * scale * math.cos(mean_spiral) / math.cos(outer_spiral)),
        (design.outer_transverse_backlash, scale * math.cos(mean_spiral)),
        (design.mean_normal_backlash, normal),
        (design.mean_transverse_backlash, math.cos(mean_spiral)),
    )
    # normal to the tooth at the mean point, as the circular thickness that both members lose together
    lost = sum(backlash * factor for backlash, factor in factors if backlash is not None)
    return theoretical - lost / (4.0 * module), -theoretical - lost / (4.0 * module)
