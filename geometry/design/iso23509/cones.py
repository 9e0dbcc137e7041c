"""Two pitch cones that touch at the mean point, and what follows from their position alone."""

from __future__ import annotations

import math
from dataclasses import dataclass

from ....core.checks import check_fields


@dataclass(frozen=True)
class PitchCones:
    """Pitch cones that touch at the mean point.

    Parameters
    ----------
    shaft_angle
        Angle between the axes (Sigma) [rad].
    hypoid_offset
        Distance between the axes (a) [mm].
    pinion_pitch_angle, gear_pitch_angle
        Cone angles (delta1, delta2) [rad].
    pinion_mean_cone_distance, gear_mean_cone_distance
        Apex to mean point (Rm1, Rm2) [mm].
    pinion_mean_spiral_angle, gear_mean_spiral_angle
        Spiral angles (beta_m1, beta_m2) [rad].
    face_width_factor
        Share of the gear's face width outside the mean point (c_be2).

    Examples
    --------
    >>> from math import pi
    >>> cones = PitchCones(pi / 2, 0.0, 0.35, pi / 2 - 0.35, 75.0, 75.0, 0.6, 0.6)
    >>> cones.face_width_factor
    0.5
    """

    shaft_angle: float
    hypoid_offset: float
    pinion_pitch_angle: float
    gear_pitch_angle: float
    pinion_mean_cone_distance: float
    gear_mean_cone_distance: float
    pinion_mean_spiral_angle: float
    gear_mean_spiral_angle: float
    face_width_factor: float = 0.5

    def __post_init__(self) -> None:
        check_fields(self)

    @property
    def pinion_mean_pitch_diameter(self) -> float:
        """Mean pitch diameter dm1 [mm] (formula 110)."""
        return 2.0 * self.pinion_mean_cone_distance * math.sin(self.pinion_pitch_angle)

    @property
    def gear_mean_pitch_diameter(self) -> float:
        """Mean pitch diameter dm2 [mm] (formula 111)."""
        return 2.0 * self.gear_mean_cone_distance * math.sin(self.gear_pitch_angle)

    @property
    def axial_offset_angle(self) -> float:
        """Pinion offset angle in the pinion axial plane zeta_m [rad] (formula 113)."""
        lean = math.cos(self.gear_pitch_angle) / math.cos(self.pinion_pitch_angle)
        reach = self.gear_mean_pitch_diameter + self.pinion_mean_pitch_diameter * lean
        return math.asin(2.0 * self.hypoid_offset / reach)

    @property
    def offset_angle(self) -> float:
        """Pinion offset angle in the pitch plane zeta_mp [rad], between the two cone elements (formula 114)."""
        sine = math.sin(self.axial_offset_angle) * math.sin(self.shaft_angle) / math.cos(self.pinion_pitch_angle)
        return math.asin(sine)

    @property
    def limit_pressure_angle(self) -> float:
        """Pressure angle alpha_lim [rad] of the flank that would not mesh at all (formulas 32 and 117)."""
        pinion, gear = math.tan(self.pinion_pitch_angle), math.tan(self.gear_pitch_angle)
        r1, r2 = self.pinion_mean_cone_distance, self.gear_mean_cone_distance
        unbalance = r1 * math.sin(self.pinion_mean_spiral_angle) - r2 * math.sin(self.gear_mean_spiral_angle)
        return -math.atan(pinion * gear * unbalance / (math.cos(self.offset_angle) * (r1 * pinion + r2 * gear)))

    @property
    def limit_curvature(self) -> float:
        """Lengthwise curvature 1/rho_lim [1/mm] of the limit flank (formula 33); NaN without offset, where any fits."""
        slope1, slope2 = math.tan(self.pinion_mean_spiral_angle), math.tan(self.gear_mean_spiral_angle)
        if slope1 == slope2:
            return math.nan
        r1, r2 = self.pinion_mean_cone_distance, self.gear_mean_cone_distance
        limit = self.limit_pressure_angle
        twist = slope1 / (r1 * math.tan(self.pinion_pitch_angle)) + slope2 / (r2 * math.tan(self.gear_pitch_angle))
        spread = 1.0 / (r1 * math.cos(self.pinion_mean_spiral_angle)) - 1.0 / (
            r2 * math.cos(self.gear_mean_spiral_angle)
        )
        return math.cos(limit) * (spread - math.tan(limit) * twist) / (slope1 - slope2)

    @property
    def limit_radius_of_curvature(self) -> float:
        """Lengthwise radius of curvature rho_lim [mm] of the limit flank; infinite where it is straight."""
        curvature = self.limit_curvature
        return math.inf if curvature == 0.0 else 1.0 / curvature
