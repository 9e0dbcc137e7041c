"""The angles of a generated flank at a point of the pitch cone, measured on the surface itself.

A blank prescribes spiral angle and pressure angle at the mean point; basic settings aim at them by formulas. Here they
are measured, so that the settings can be corrected until the flank has them.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ...core.errors import GeometryError
from ..cutting.generating_surface import GeneratingSurface, Hand
from ..flanks.blank_section import BlankSection
from ..flanks.flank import solve_flank
from .iso23509.blank_dimensions import MemberBlank

Array = NDArray[Any]


@dataclass(frozen=True)
class MeanPointAngles:
    """Angles of a flank at the mean point's axial and radial coordinates.

    Parameters
    ----------
    spiral_angle
        Between tooth trace and cone element, in the plane that touches the pitch cone [rad]; positive for the hand of
        the member.
    pressure_angle
        Between the flank's normal and that plane [rad]; positive where the tooth narrows towards its tip.
    azimuth
        Of the point about the member's axis [rad], counted as on a right-hand member.
    """

    spiral_angle: float
    pressure_angle: float
    azimuth: float


def mean_point_angles(surface: GeneratingSurface, section: BlankSection, member: MemberBlank) -> MeanPointAngles:
    """Measure a flank at the mean point of its blank.

    Parameters
    ----------
    surface
        Generating surface of the flank.
    section
        Axial section of the blank.
    member
        Dimensions of the blank; pitch cone and mean cone distance are used.

    Raises
    ------
    GeometryError
        If the flank does not pass through the mean point.
    """
    sine, cosine = math.sin(member.pitch_angle), math.cos(member.pitch_angle)
    axial = member.mean_cone_distance * cosine - member.pitch_apex
    radial = member.mean_cone_distance * sine
    flank = solve_flank(surface, section, np.array([axial]), np.array([radial]))
    position, normal = flank.position[:, 0], flank.normal[:, 0]
    if not np.all(np.isfinite(position)):
        raise GeometryError("the flank does not pass through the mean point of its blank")
    return angles_of_normal(position, normal, member.pitch_angle, surface.hand)


def angles_of_normal(position: Array, normal: Array, pitch_angle: float, hand: Hand) -> MeanPointAngles:
    """Angles of a flank at a point, from its outward normal.

    Parameters
    ----------
    position, normal
        Point [mm] and unit normal (3) in the member's frame.
    pitch_angle
        Of the cone whose elements the spiral angle is measured against [rad].
    hand
        Hand of spiral of the member.
    """
    sine, cosine = math.sin(pitch_angle), math.cos(pitch_angle)
    side = 1.0 if hand == "right" else -1.0
    azimuth = math.atan2(side * position[1], position[0])
    towards_axis = np.array([math.cos(azimuth), math.sin(azimuth)])
    across = np.array([normal[0], side * normal[1]])
    outward = float(towards_axis @ across)
    around = float(towards_axis[0] * across[1] - towards_axis[1] * across[0])
    along_element = sine * outward + cosine * float(normal[2])
    off_cone = cosine * outward - sine * float(normal[2])
    # The trace is at right angles to the normal; towards the heel of a right-hand member the azimuth grows along it.
    return MeanPointAngles(
        spiral_angle=math.atan(-along_element / around),
        pressure_angle=math.asin(off_cone),
        azimuth=azimuth,
    )
