"""Surface velocities of the flanks in contact: sliding and rolling, along and across the contact line.

At its conjugate position a point of the flank moves with v = w a x (r - o) on either member (Kolivand 2009, Eq. 5.1).
The members turn at their ratio, so both velocities have the same part along the common normal (Eq. 5.2): the points of
action and the pinion's normals there are where that holds to rounding. On the gear's own flank it holds to the slope of
the ease-off only.

The contact line is the level set of the roll angle. All velocities are per angular velocity of the pinion.
"""

from __future__ import annotations

from dataclasses import dataclass
from dataclasses import fields as dataclass_fields
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from ..contact.lines.flank_splines import FlankSplines, fit
from ..core.errors import InputError
from ..geometry.newton import cramers_rule, determinant
from ..geometry.vectors import column, cross, dot

if TYPE_CHECKING:
    import xarray as xr

Array = NDArray[Any]
AXIS_ATTRIBUTES = ("pinion_axis", "pinion_origin_mm", "gear_axis", "gear_origin_mm", "ratio")


@dataclass(frozen=True)
class Axes:
    """Both axes of a pair in the global frame.

    Parameters
    ----------
    pinion_axis, gear_axis
        Unit vectors (3), oriented so that the drive rotation is positive.
    pinion_origin, gear_origin
        A point (3) on each [m].
    ratio
        Gear teeth over pinion teeth.
    """

    pinion_axis: Array
    pinion_origin: Array
    gear_axis: Array
    gear_origin: Array
    ratio: float

    def velocities(self, position: Array) -> tuple[Array, Array]:
        """Velocities (3, ...) of points (3, ...) [m] of pinion and gear [m/rad], per angular velocity of the pinion."""
        pinion = cross(column(self.pinion_axis, position), position - column(self.pinion_origin, position))
        gear = cross(column(self.gear_axis, position), position - column(self.gear_origin, position))
        return pinion, gear / self.ratio


@dataclass(frozen=True)
class SurfaceVelocities:
    """Velocities at points of contact (...) per angular velocity of the pinion [m/rad].

    Parameters
    ----------
    pinion, gear
        Velocities (3, ...) of the two surfaces in the global frame.
    normal, along, across
        Unit vectors (3, ...): the pinion's outward normal, the contact line towards the heel, and across it in the
        tangent plane, in the direction in which the line moves over the gear's flank.
    line_over_gear
        Speed (...) at which the contact line moves over the gear's flank, in the direction across.
    """

    pinion: Array
    gear: Array
    normal: Array
    along: Array
    across: Array
    line_over_gear: Array

    def chosen(self, index: Any) -> SurfaceVelocities:
        """The velocities of some of the points."""
        return SurfaceVelocities(**{f.name: getattr(self, f.name)[..., index] for f in dataclass_fields(self)})

    @property
    def sliding(self) -> Array:
        """Velocity (3, ...) of the pinion's surface relative to the gear's."""
        return np.asarray(self.pinion - self.gear)

    @property
    def sliding_along(self) -> Array:
        """Sliding along the contact line (Eq. 5.4a)."""
        return dot(self.sliding, self.along)

    @property
    def sliding_across(self) -> Array:
        """Sliding across the contact line (Eq. 5.4b)."""
        return dot(self.sliding, self.across)

    @property
    def sliding_speed(self) -> Array:
        """Size of the sliding velocity in the tangent plane (Eq. 5.5)."""
        return np.hypot(self.sliding_along, self.sliding_across)

    @property
    def rolling(self) -> Array:
        """Mean of both surface velocities across the contact line, in the fixed frame (Eq. 5.6)."""
        return 0.5 * (dot(self.pinion, self.across) + dot(self.gear, self.across))

    @property
    def over_line(self) -> tuple[Array, Array]:
        """Velocities of pinion and gear relative to the contact line, across it."""
        return np.asarray(self.sliding_across - self.line_over_gear), -self.line_over_gear

    @property
    def rolling_over_line(self) -> Array:
        """Rolling relative to the contact line, which itself moves across the flank's normal: what draws the oil in."""
        return np.asarray(0.5 * self.sliding_across - self.line_over_gear)


def axes_of(ease_off: xr.Dataset) -> Axes:
    """Axes of the pair a result's ``/ease_off`` belongs to.

    Raises
    ------
    InputError
        If the result has none, as those of older versions.
    """
    if "action_position" not in ease_off or any(name not in ease_off.attrs for name in AXIS_ATTRIBUTES):
        raise InputError(
            "this result has no points of action in its group ease_off, which friction needs: it was written by an "
            "older version; make it anew with 'easeoff run'"
        )
    pinion_axis, pinion_origin, gear_axis, gear_origin = (
        np.asarray(ease_off.attrs[n], float) for n in AXIS_ATTRIBUTES[:4]
    )
    return Axes(pinion_axis, 1e-3 * pinion_origin, gear_axis, 1e-3 * gear_origin, float(ease_off.attrs["ratio"]))


def action_splines(ease_off: xr.Dataset) -> FlankSplines:
    """Splines of the points of action [m], normals and roll angle, over the gear's flank."""
    order = ("lengthwise", "profile")
    fields = {
        "position": 1e-3 * ease_off["action_position"].transpose(*order, "space").values,
        "normal": ease_off["action_normal"].transpose(*order, "space").values,
        "roll_angle": ease_off["roll_angle"].transpose(*order).values,
    }
    return fit(ease_off["lengthwise"].values, ease_off["profile"].values, fields)


def surface_velocities(axes: Axes, splines: FlankSplines, points: Array) -> SurfaceVelocities:
    """Surface velocities at points of the gear's flank, each at its conjugate position.

    Parameters
    ----------
    axes
        From ``axes_of``.
    splines
        From ``action_splines``.
    points
        Lengthwise and profile fractions (2, ...).
    """
    here = splines.evaluate(["position", "normal"], points)
    position = here["position"]
    normal = here["normal"] / np.sqrt(dot(here["normal"], here["normal"]))
    pinion, gear = axes.velocities(position)
    slopes = [splines.evaluate(["position", "roll_angle"], points, d) for d in ((1, 0), (0, 1))]
    rates = [s["roll_angle"] for s in slopes]
    # Along a level set of the roll angle the points of action are those of one moment: the contact line.
    line = rates[0] * slopes[1]["position"] - rates[1] * slopes[0]["position"]
    line = (line - normal * dot(line, normal)) * np.where(rates[1] <= 0.0, 1.0, -1.0)
    along = line / np.sqrt(dot(line, line))
    # On the gear, turning with it, the same points make the flank. Its tangents are what is left of the derivatives.
    tangents = [s["position"] - rate * gear for s, rate in zip(slopes, rates, strict=True)]
    first, mixed, second = (dot(tangents[i], tangents[j]) for i, j in ((0, 0), (0, 1), (1, 1)))
    squared = second * rates[0] ** 2 - 2.0 * mixed * rates[0] * rates[1] + first * rates[1] ** 2
    climb = squared / determinant((first, mixed), (mixed, second))
    by_first, by_second = cramers_rule((first, mixed), (mixed, second), rates)
    uphill = tangents[0] * by_first + tangents[1] * by_second
    across = cross(normal, along)
    across = across * np.sign(dot(across, uphill))
    return SurfaceVelocities(pinion, gear, normal, along, across, 1.0 / np.sqrt(climb))
