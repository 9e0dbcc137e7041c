"""Taper of the tooth depth along the face: addendum and dedendum angle of the gear (ISO 23509:2016, annex C.5).

The sum of the dedendum angles of both members is the amount by which the roots of pinion and gear open towards the
heel. Standard taper makes the depth proportional to the cone distance; constant slot width (duplex) tilts the root
line until a slot has the same width at toe and heel, so that one cutter can finish both flanks; modified slot width
(tilted root line) does the same but never exceeds 1.3 times the standard sum.
"""

from __future__ import annotations

import math

from ....core.errors import GeometryError
from .blank_design import DepthTaper


def standard_sum_of_dedendum_angles(
    pinion_mean_dedendum: float, gear_mean_dedendum: float, gear_mean_cone_distance: float
) -> float:
    """Sum of the dedendum angles with standard taper [rad] (ISO 23509:2016, C.3).

    Parameters
    ----------
    pinion_mean_dedendum, gear_mean_dedendum
        Dedenda at mid face (hfm1, hfm2) [mm].
    gear_mean_cone_distance
        Rm2 [mm].

    Returns
    -------
    float
        Sum of both dedendum angles [rad].
    """
    return math.atan(pinion_mean_dedendum / gear_mean_cone_distance) + math.atan(
        gear_mean_dedendum / gear_mean_cone_distance
    )


def constant_slot_width_sum_of_dedendum_angles(
    *,
    outer_transverse_module: float,
    gear_outer_cone_distance: float,
    gear_mean_cone_distance: float,
    mean_normal_pressure_angle: float,
    gear_mean_spiral_angle: float,
    cutter_radius: float,
) -> float:
    """Sum of the dedendum angles with constant slot width [rad] (ISO 23509:2016, C.5).

    Parameters
    ----------
    outer_transverse_module
        m_et2 [mm].
    gear_outer_cone_distance, gear_mean_cone_distance
        Re2, Rm2 [mm].
    mean_normal_pressure_angle
        alpha_n [rad].
    gear_mean_spiral_angle
        beta_m2 [rad].
    cutter_radius
        rc0 [mm].

    Returns
    -------
    float
        Sum of both dedendum angles [rad].

    Raises
    ------
    GeometryError
        If the cutter is so small that the teeth would have to be deeper at the toe.
    """
    opening = 1.0 - gear_mean_cone_distance * math.sin(gear_mean_spiral_angle) / cutter_radius
    if opening < 0.0:
        raise GeometryError(
            f"cutter_radius = {cutter_radius:g} mm: too small for this depth_taper, must be at least "
            f"{gear_mean_cone_distance * math.sin(gear_mean_spiral_angle):g} mm"
        )
    width = gear_outer_cone_distance * math.tan(mean_normal_pressure_angle) * math.cos(gear_mean_spiral_angle)
    return math.pi / 2 * outer_transverse_module / width * opening


def gear_taper_angles(
    taper: DepthTaper,
    *,
    pinion_mean_dedendum: float,
    gear_mean_dedendum: float,
    gear_mean_addendum: float,
    mean_working_depth: float,
    outer_transverse_module: float,
    gear_outer_cone_distance: float,
    gear_mean_cone_distance: float,
    mean_normal_pressure_angle: float,
    gear_mean_spiral_angle: float,
    cutter_radius: float,
) -> tuple[float, float]:
    """Addendum and dedendum angle of the gear for a kind of taper (ISO 23509:2016, C.6 to C.11).

    Parameters
    ----------
    taper
        Kind of taper.
    pinion_mean_dedendum, gear_mean_dedendum, gear_mean_addendum, mean_working_depth
        hfm1, hfm2, ham2, hmw [mm].
    outer_transverse_module, gear_outer_cone_distance, gear_mean_cone_distance
        m_et2, Re2, Rm2 [mm].
    mean_normal_pressure_angle, gear_mean_spiral_angle
        alpha_n, beta_m2 [rad].
    cutter_radius
        rc0 [mm].

    Returns
    -------
    tuple of float
        theta_a2, theta_f2 [rad].

    Raises
    ------
    GeometryError
        If the cutter is too small for the taper.
    """
    if taper == "uniform":
        return 0.0, 0.0
    standard = standard_sum_of_dedendum_angles(pinion_mean_dedendum, gear_mean_dedendum, gear_mean_cone_distance)
    if taper == "standard":
        # the gear's face cone follows the pinion's root cone
        addendum_angle = math.atan(pinion_mean_dedendum / gear_mean_cone_distance)
        return addendum_angle, standard - addendum_angle
    total = constant_slot_width_sum_of_dedendum_angles(
        outer_transverse_module=outer_transverse_module,
        gear_outer_cone_distance=gear_outer_cone_distance,
        gear_mean_cone_distance=gear_mean_cone_distance,
        mean_normal_pressure_angle=mean_normal_pressure_angle,
        gear_mean_spiral_angle=gear_mean_spiral_angle,
        cutter_radius=cutter_radius,
    )
    if taper == "modified_slot_width":
        total = min(total, 1.3 * standard)
    addendum_angle = total * gear_mean_addendum / mean_working_depth
    return addendum_angle, total - addendum_angle
