"""The crown gear of a pair: the tooth line that a cutter traces on the gear's developed pitch cone.

A face-milling cutter traces a circle. A face-hobbing cutter turns in step with the work and traces an extended
epicycloid: a circle rolling on the base circle carries the blade. Without blade groups the epicycloid becomes the
circle, so that one set of formulas serves both.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Protocol

from ....core.errors import GeometryError


class CutterAndTeeth(Protocol):
    """What a crown gear takes of a pair's basic data."""

    @property
    def cutter_radius(self) -> float:
        """Mean radius of the cutter (r_c0) [mm]."""

    @property
    def number_of_blade_groups(self) -> int | None:
        """Starts of a face-hobbing cutter (z0); none or zero for face milling."""

    @property
    def number_of_teeth(self) -> tuple[int, int]:
        """Pinion, gear (z1, z2)."""


@dataclass(frozen=True)
class CrownGear:
    """Tooth line on the gear's developed pitch cone.

    Parameters
    ----------
    cutter_radius
        Distance of the tracing point from the cutter axis [mm].
    cutter_lead_angle
        Angle between the radius of the cutter and the normal of the tooth line (nu) [rad], 0 when face-milled.
    centre_distance
        From the crown gear's centre to the cutter's (rho_P0) [mm].
    base_radius
        Radius of the epicycloid's base circle (rho_b) [mm]; the centre distance when face-milled.
    mean_radius_of_curvature
        Of the tooth line at the mean point (rho_m_beta) [mm].
    """

    cutter_radius: float
    cutter_lead_angle: float
    centre_distance: float
    base_radius: float
    mean_radius_of_curvature: float

    def spiral_angle(self, cone_distance: float) -> float:
        """Spiral angle of the tooth line at a distance from the centre (ISO 23509:2016, 179 to 184).

        Parameters
        ----------
        cone_distance
            Distance from the apex along the pitch cone [mm].

        Returns
        -------
        float
            Spiral angle [rad].

        Raises
        ------
        GeometryError
            If the cutter does not reach that far.
        """
        angle = self.generating_angle(cone_distance)
        return math.atan2(cone_distance - self.base_radius * math.cos(angle), self.base_radius * math.sin(angle))

    def generating_angle(self, cone_distance: float) -> float:
        """Angle at the centre between a point of the tooth line and the cutter's centre (q) [rad].

        Parameters and exceptions are those of ``spiral_angle``.
        """
        centre, cutter = self.centre_distance, self.cutter_radius
        cosine = (cone_distance**2 + centre**2 - cutter**2) / (2.0 * cone_distance * centre)
        if not abs(cosine) < 1.0:
            raise GeometryError(
                f"the cutter (cutter_radius = {cutter:g} mm) does not reach the cone distance {cone_distance:g} mm"
            )
        return math.acos(cosine)

    @property
    def involute_cone_distance(self) -> float:
        """Cone distance at which the tooth line is curved as an involute [mm]: generating and spiral angle agree there.

        NaN where there is none. From ``rho_b = R cos(q)`` and the triangle of the centres and the point; face-milled it
        is formula 39 of AGMA 929-B22, face-hobbed the solution of its 41 to 46.
        """
        centre = self.centre_distance
        square = 2.0 * centre * self.base_radius - centre**2 + self.cutter_radius**2
        return math.sqrt(square) if square > 0.0 else math.nan


def crown_gear(
    design: CutterAndTeeth, gear_pitch_angle: float, gear_mean_cone_distance: float, gear_mean_spiral_angle: float
) -> CrownGear:
    """Crown gear of a pair from the mean point of its gear (ISO 23509:2016, 34 to 40 and 176 to 178).

    Parameters
    ----------
    design
        Basic data; the cutter and the teeth are used.
    gear_pitch_angle, gear_mean_spiral_angle
        Of the gear [rad].
    gear_mean_cone_distance
        Of the gear [mm].

    Returns
    -------
    CrownGear
        Tooth line through the mean point.

    Raises
    ------
    GeometryError
        If the face-hobbing cutter is too small for its number of blade groups.
    """
    cutter = design.cutter_radius
    distance, spiral = gear_mean_cone_distance, gear_mean_spiral_angle
    groups = design.number_of_blade_groups or 0
    crown_teeth = design.number_of_teeth[1] / math.sin(gear_pitch_angle)
    lead_sine = distance * groups * math.cos(spiral) / (cutter * crown_teeth)
    if not lead_sine < 1.0:
        raise GeometryError(f"number_of_blade_groups = {groups}: too many for cutter_radius = {cutter:g} mm")
    lead = math.asin(lead_sine)
    centre = math.sqrt(distance**2 + cutter**2 - 2.0 * distance * cutter * math.sin(spiral - lead))
    base = centre / (1.0 + groups / crown_teeth)
    if groups == 0:
        return CrownGear(cutter, lead, centre, base, cutter)
    # direction from the crown gear's centre to the cutter's, counted from the tangent of the tooth line; formula 52
    # rather than 38, because it keeps the sign when the cutter is small
    along = cutter * math.sin(lead) + distance * math.cos(spiral)
    across = cutter * math.cos(lead) - distance * math.sin(spiral)
    pole = across / along
    slope = math.tan(spiral)
    curvature_radius = distance * math.cos(spiral) * (slope + pole / (1.0 + math.tan(lead) * (slope + pole)))
    return CrownGear(cutter, lead, centre, base, curvature_radius)
