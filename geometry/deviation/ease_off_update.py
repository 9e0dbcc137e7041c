"""The ease-off of deviated flanks as an update of the designed one (Kolivand 2009, chapter 4, Eq. 4.5a corrected).

A deviation d along the normal moves the point where the flank meets a circle about the member's axis by the angle
d / ((a x r) . n), the lever arm in the denominator. Kolivand 2009, Eq. 4.5a prints the product (u . n) d / L instead,
with u the circumferential direction and L the distance from the axis, which is low by (u . n)^2. With the condition
of conjugate contact, R (a_p x r) . n = (a_g x r) . n, the normal gap changes by just the sum of both deviations.

The roll angle of a point of the gear is where its gap is smallest. At a fixed point of the gear the gap of the designed
flanks is a + (1/2) c (q - Q)^2. What the pinion shows to that point moves on with q, so its deviation takes off
D(q) = d / lever, and the smallest gap moves to Q + D'(Q) / c. Kolivand 2009, Eq. 4.6 has the change d / ((a_p x r) . n)
instead: right for a flank turned as a whole, but without the slope of the deviation, which is the larger part.
"""

from __future__ import annotations

from typing import Any

import numpy as np
import xarray as xr
from numpy.typing import NDArray

from ...core.attributes import labelled
from ..pair.datasets import first_contact
from ..pair.gear_pair import PairGeometry
from .deviation import Deviation

Array = NDArray[Any]
GRID = ("lengthwise", "profile")


def deviated_ease_off(
    geometry: PairGeometry,
    *,
    pinion: Deviation | None = None,
    gear: Deviation | None = None,
) -> xr.Dataset:
    """Ease-off and surface of roll angle of a pair with deviated flanks (Kolivand 2009, Eq. 4.3 to 4.10).

    Good to the first order, but for one part: the pinion's deviation is divided by the lever arm of the gear's normal,
    which differs from its own with the slope of the ease-off. So both members count alike; for the flanks themselves
    see ``deviated_flank``.

    Parameters
    ----------
    geometry
        The designed pair, from ``pair_geometry``.
    pinion, gear
        Deviations of the members' flanks. The pinion's is taken at the point conjugate to the gear's node.

    Returns
    -------
    xr.Dataset
        The same variables, of the deviated flanks; also ``pinion_deviation``, ``gear_deviation`` and their sum's
        effect ``ease_off_change`` [um], and ``extrapolated``, 1 where a deviation is taken beyond its outermost nodes.

    Examples
    --------
    >>> from easeoff.cases import gear_pair, read_case
    >>> from easeoff.geometry import GlobalErrors, deviation_from_formula, pair_geometry
    >>> pair = gear_pair(read_case("fm-11x41"))
    >>> deviation = deviation_from_formula(pair.gear.section, GlobalErrors(spiral_angle=5.0))
    >>> updated = deviated_ease_off(pair_geometry(pair, (7, 5)), gear=deviation)
    >>> [round(float(v), 3) + 0.0 for v in updated["ease_off_change"].sel(profile=0.5)]  # metal at the heel
    [5.0, 3.333, 1.667, 0.0, -1.667, -3.333, -5.0]
    """
    ease_off, ratio = geometry.ease_off, geometry.pair.assembly.ratio
    fields = {name: ease_off[name].transpose(*GRID).values for name in ("lever_arm", "ease_off_angle", "roll_angle")}
    lever = fields["lever_arm"]
    t, h = np.meshgrid(ease_off["lengthwise"].values, ease_off["profile"].values, indexing="ij")
    pinion_t, pinion_h = (ease_off[f"pinion_{name}"].transpose(*GRID).values for name in GRID)
    on_gear, beyond_gear = _sampled(gear, t, h)
    on_pinion, beyond_pinion = _sampled(pinion, pinion_t, pinion_h)
    roll = fields["roll_angle"]
    if pinion is not None:
        roll = roll + _later(geometry, pinion).reshape(t.shape)
    by_gear, by_pinion = 1.0 / lever, ratio / lever  # rotation of a member per deviation of its flank [rad/mm]
    change = -(on_pinion * by_pinion / ratio + on_gear * by_gear)
    angle = fields["ease_off_angle"] + change
    inside = ease_off["inside"].transpose(*GRID).values.astype(bool)
    # The difference of two zeros, so that without deviation nothing changes in the last digit.
    shift = first_contact(angle, inside) - first_contact(fields["ease_off_angle"], inside)
    return labelled(
        ease_off.assign(
            ease_off_angle=(GRID, angle - shift),
            ease_off=(GRID, ease_off["ease_off"].transpose(*GRID).values + 1e3 * (change - shift) * lever),
            roll_angle=(GRID, roll),
            pinion_deviation=(GRID, 1e3 * on_pinion),
            gear_deviation=(GRID, 1e3 * on_gear),
            ease_off_change=(GRID, 1e3 * change * lever),
            extrapolated=(GRID, (beyond_pinion | beyond_gear).astype(np.int8)),
        ).assign_attrs(first_contact_rad=ease_off.attrs["first_contact_rad"] + shift)
    )


def _sampled(deviation: Deviation | None, lengthwise: Array, profile: Array) -> tuple[Array, NDArray[np.bool_]]:
    """Deviation [mm] at fractions (nt, nh), and where it is taken beyond its outermost nodes."""
    if deviation is None:
        return np.zeros(lengthwise.shape), np.zeros(lengthwise.shape, dtype=bool)
    return deviation.at(lengthwise, profile), deviation.extrapolated(lengthwise, profile)


def _later(geometry: PairGeometry, deviation: Deviation) -> Array:
    """Change of the roll angle of the gear's nodes (n) by the pinion's deviation [rad]."""
    exact, moving = geometry.exact, geometry.drift
    position, lever = exact.pinion_position, exact.lever_arm
    value, slope = deviation.interpolant(position[2], np.hypot(position[0], position[1]))
    rate = (slope[0] * moving.axial + slope[1] * moving.radial) / lever - value * moving.lever_arm / lever**2
    return np.asarray(rate / exact.separation_curvature)
