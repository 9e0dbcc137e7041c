"""The dimensions of one member, from its cones and its depth at the mean point (ISO 23509:2016, 7.7 to 7.9)."""

from __future__ import annotations

import math
from dataclasses import dataclass

from ....core.errors import GeometryError
from .blank_dimensions import MemberBlank


@dataclass(frozen=True, kw_only=True)
class MemberFrame:
    """Data that one member's dimensions follow from: lengths in mm, angles in rad.

    The spiral angles are those at the heel, at the mean point and at the toe; the profile shift coefficient counts
    positive where it makes this member's tooth thicker.
    """

    number_of_teeth: int
    pitch_angle: float
    mean_cone_distance: float
    mean_point_distance: float
    outer_width: float
    inner_width: float
    face_angle: float
    root_angle: float
    face_apex: float
    root_apex: float
    addendum: float
    dedendum: float
    spiral_angles: tuple[float, float, float]
    profile_shift_coefficient: float
    thickness_modification_coefficient: float


def member_blank(frame: MemberFrame, module: float, normal_pressure_angle: float) -> MemberBlank:
    """Dimensions of one member (ISO 23509:2016, 195 to 200, 206, 211 to 225).

    Parameters
    ----------
    frame
        Cones, widths and depth of the member.
    module
        Mean normal module [mm].
    normal_pressure_angle
        Mean normal pressure angle [rad].

    Returns
    -------
    MemberBlank
        All dimensions.

    Raises
    ------
    GeometryError
        If the teeth have no depth or no thickness left.
    """
    sine, cosine = math.sin(frame.pitch_angle), math.cos(frame.pitch_angle)
    above, below = frame.face_angle - frame.pitch_angle, frame.pitch_angle - frame.root_angle
    outer_addendum = frame.addendum + frame.outer_width * math.tan(above)
    inner_addendum = frame.addendum - frame.inner_width * math.tan(above)
    outer_dedendum = frame.dedendum + frame.outer_width * math.tan(below)
    inner_dedendum = frame.dedendum - frame.inner_width * math.tan(below)
    outer_distance = frame.mean_cone_distance + frame.outer_width
    inner_distance = frame.mean_cone_distance - frame.inner_width
    if min(inner_distance, inner_addendum + inner_dedendum, outer_addendum + outer_dedendum) <= 0.0:
        raise GeometryError(
            f"member with {frame.number_of_teeth} teeth: nothing is left of the tooth at one end; reduce "
            "gear_face_width or the taper (gear_addendum_angle, gear_dedendum_angle)"
        )
    mean_diameter = 2.0 * frame.mean_cone_distance * sine
    outer_diameter, inner_diameter = 2.0 * outer_distance * sine, 2.0 * inner_distance * sine

    spiral = frame.spiral_angles[1]
    shift = frame.profile_shift_coefficient * math.tan(normal_pressure_angle)
    thickness = module * (math.pi / 2.0 + 2.0 * (frame.thickness_modification_coefficient + shift))
    if not thickness > 0.0:
        raise GeometryError(
            f"member with {frame.number_of_teeth} teeth: mean normal thickness {thickness:g} mm; change the thickness "
            "or profile shift coefficients"
        )
    normal_diameter = mean_diameter / (cosine * (1.0 - (math.sin(spiral) * math.cos(normal_pressure_angle)) ** 2))
    half_angle = thickness / normal_diameter
    return MemberBlank(
        number_of_teeth=frame.number_of_teeth,
        pitch_angle=frame.pitch_angle,
        face_angle=frame.face_angle,
        root_angle=frame.root_angle,
        addendum_angle=above,
        dedendum_angle=below,
        pitch_apex=frame.mean_cone_distance * cosine - frame.mean_point_distance,
        face_apex=frame.face_apex,
        root_apex=frame.root_apex,
        mean_point_distance=frame.mean_point_distance,
        crown_distance=frame.mean_point_distance + frame.outer_width * cosine - outer_addendum * sine,
        front_crown_distance=frame.mean_point_distance - frame.inner_width * cosine - inner_addendum * sine,
        outer_cone_distance=outer_distance,
        mean_cone_distance=frame.mean_cone_distance,
        inner_cone_distance=inner_distance,
        face_width=frame.outer_width + frame.inner_width,
        outer_face_width=frame.outer_width,
        inner_face_width=frame.inner_width,
        outer_spiral_angle=frame.spiral_angles[0],
        mean_spiral_angle=spiral,
        inner_spiral_angle=frame.spiral_angles[2],
        outer_pitch_diameter=outer_diameter,
        mean_pitch_diameter=mean_diameter,
        inner_pitch_diameter=inner_diameter,
        outer_tip_diameter=outer_diameter + 2.0 * outer_addendum * cosine,
        inner_tip_diameter=inner_diameter + 2.0 * inner_addendum * cosine,
        outer_root_diameter=outer_diameter - 2.0 * outer_dedendum * cosine,
        inner_root_diameter=inner_diameter - 2.0 * inner_dedendum * cosine,
        outer_addendum=outer_addendum,
        mean_addendum=frame.addendum,
        inner_addendum=inner_addendum,
        outer_dedendum=outer_dedendum,
        mean_dedendum=frame.dedendum,
        inner_dedendum=inner_dedendum,
        outer_whole_depth=outer_addendum + outer_dedendum,
        inner_whole_depth=inner_addendum + inner_dedendum,
        thickness_modification_coefficient=frame.thickness_modification_coefficient,
        mean_normal_thickness=thickness,
        mean_transverse_thickness=thickness / math.cos(spiral),
        mean_normal_diameter=normal_diameter,
        mean_normal_chordal_thickness=normal_diameter * math.sin(half_angle),
        mean_chordal_addendum=frame.addendum + 0.5 * normal_diameter * cosine * (1.0 - math.cos(half_angle)),
    )
