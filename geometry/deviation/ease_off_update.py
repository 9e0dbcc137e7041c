"""The ease-off of deviating flanks without new flanks: the update of the dissertation, in its correct form.

A deviation d along the normal moves the place where the flank meets a circle about the member's axis by the angle
d / ((a x r) . n), the lever arm in the denominator. Kolivand 2009, Eq. 4.5a prints the product (u . n) d / L instead,
with u the circumferential direction and L the distance from the axis, which is low by (u . n)^2. With the condition
of conjugate contact, R (a_p x r) . n = (a_g x r) . n, the normal gap changes by just the sum of both deviations.

The roll angle of a place on the gear is where its gap is smallest. At a fixed place of the gear the gap of the designed
flanks is a + (1/2) c (q - Q)^2. What the pinion shows to that place moves on with q, so its deviation takes off
D(q) = d / lever, and the smallest gap moves to Q + D'(Q) / c. Kolivand 2009, Eq. 4.6 has the change d / ((a_p x r) . n)
instead: right for a flank turned as a whole, but without the slope of the deviation, which is the larger part.
"""

from __future__ import annotations

from typing import Any, Literal, get_args

import numpy as np
import xarray as xr
from numpy.typing import NDArray

from ...core.attributes import labelled
from ...core.errors import InputError
from ..pair.datasets import first_contact
from ..pair.gear_pair import GearPair, PairGeometry
from .deviation import Deviation

Array = NDArray[Any]
Form = Literal["correct", "printed"]
GRID = ("lengthwise", "profile")


def deviated_ease_off(
    geometry: PairGeometry,
    *,
    pinion: Deviation | None = None,
    gear: Deviation | None = None,
    form: Form = "correct",
) -> xr.Dataset:
    """Ease-off and surface of roll angle of a pair whose flanks deviate (Kolivand 2009, Eq. 4.3 to 4.10).

    Good to the first order, but for one part: the pinion's deviation goes over the lever arm of the gear's normal,
    which differs from its own with the slope of the ease-off. So both members count alike; for the flanks themselves
    see ``deviated_surface``.

    Parameters
    ----------
    geometry
        The designed pair, from ``pair_geometry``.
    pinion, gear
        Deviations of the members' flanks. The pinion's is taken at the point conjugate to the gear's node.
    form
        ``correct``, or ``printed`` for Eq. 4.5a as it stands in the dissertation.

    Returns
    -------
    xr.Dataset
        The same variables, of the deviating flanks; also ``pinion_deviation``, ``gear_deviation`` and their sum's
        effect ``ease_off_change`` [um], and ``extrapolated``, 1 where a deviation is taken beyond its outermost nodes.

    Raises
    ------
    InputError
        If the form is unknown.
    """
    if form not in get_args(Form):
        raise InputError(f"form = {form!r}: allowed are {', '.join(get_args(Form))}")
    pair, ease_off = geometry.pair, geometry.ease_off
    fields = {name: ease_off[name].transpose(*GRID).values for name in ("lever_arm", "ease_off_angle", "roll_angle")}
    lever, ratio = fields["lever_arm"], pair.assembly.ratio
    t, h = np.meshgrid(ease_off["lengthwise"].values, ease_off["profile"].values, indexing="ij")
    pinion_t, pinion_h = (ease_off[f"pinion_{name}"].transpose(*GRID).values for name in GRID)
    on_gear, beyond_gear = _sampled(gear, t, h)
    on_pinion, beyond_pinion = _sampled(pinion, pinion_t, pinion_h)
    by_gear, by_pinion = _turns(form, pair, lever, (t, h), (pinion_t, pinion_h))
    roll = fields["roll_angle"]
    if pinion is not None:
        later = _later(geometry, pinion).reshape(t.shape) if form == "correct" else -on_pinion * by_pinion
        roll = roll + later
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
        ).assign_attrs(first_contact_rad=ease_off.attrs["first_contact_rad"] + shift, deviation_form=form)
    )


def _sampled(deviation: Deviation | None, lengthwise: Array, profile: Array) -> tuple[Array, NDArray[np.bool_]]:
    """Deviation [mm] at fractions (nt, nh), and where it is taken beyond its outermost nodes."""
    if deviation is None:
        return np.zeros(lengthwise.shape), np.zeros(lengthwise.shape, dtype=bool)
    return deviation.at(lengthwise, profile), deviation.extrapolated(lengthwise, profile)


def _turns(
    form: Form, pair: GearPair, lever: Array, on_gear: tuple[Array, Array], on_pinion: tuple[Array, Array]
) -> tuple[Array, Array]:
    """Rotation of gear and pinion per deviation of their flank (nt, nh) [rad/mm], at fractions of both flanks."""
    ratio = pair.assembly.ratio
    if form == "correct":
        return 1.0 / lever, ratio / lever
    distance, pinion_distance = (m.section.points(*p)[1] for m, p in ((pair.gear, on_gear), (pair.pinion, on_pinion)))
    return lever / distance**2, lever / ratio / pinion_distance**2


def _later(geometry: PairGeometry, deviation: Deviation) -> Array:
    """How much later the nodes of the gear (n) meet the pinion for its deviation [rad]."""
    exact, moving = geometry.exact, geometry.drift
    position, lever = exact.pinion_position, exact.lever_arm
    value, slope = deviation.interpolant(position[2], np.hypot(position[0], position[1]))
    rate = (slope[0] * moving.axial + slope[1] * moving.radial) / lever - value * moving.lever_arm / lever**2
    return np.asarray(rate / exact.separation_curvature)
