"""The equivalent radius and the slide-to-roll ratio as the dissertation may have them, to redraw its figures."""

from __future__ import annotations

from dataclasses import replace
from typing import Any, Literal

import numpy as np
import xarray as xr
from numpy.typing import NDArray

from easeoff.contact.lines.flank_splines import fit
from easeoff.friction import COEFFICIENTS, ContactConditions
from easeoff.friction.loaded_contacts import axes_of
from easeoff.geometry.vectors import column, cross, dot

Array = NDArray[Any]
# Directions in which both flanks' radii may have been taken: that of the contact line, and that of the tooth trace, on
# which the height on the flank stays.
Direction = Literal["line", "trace"]


def radii_along(tree: xr.DataTree, points: Array, direction: Direction) -> Array:
    """R_p R_g / (R_p + R_g) of both flanks' radii in a direction along the tooth, without their signs (...) [m].

    One flank is about as hollow as the other is round, so that this is about half of either. It is no radius of the
    line contact, in which the radii count across the line and with their signs; the radii that the dissertation prints
    (Kolivand 2009, figure 5.8) are of this size and not of that one.

    Parameters
    ----------
    tree
        A result of ``analyze`` or ``read_result``.
    points
        Lengthwise and profile fractions (2, ...).
    direction
        Along the contact line or the tooth trace.
    """
    order = ("lengthwise", "profile")
    ease_off, gear = tree["ease_off"].to_dataset(), tree["flanks"].to_dataset().sel(member="gear")
    flanks = {
        # At the points of action the pinion's normals turn along the line as its flank bends.
        "pinion": (ease_off["action_position"], ease_off["action_normal"], "space"),
        "gear": (gear["position"], gear["normal"], "xyz"),
    }
    values = {"roll_angle": ease_off["roll_angle"].transpose(*order).values}
    for name, (position, normal, component) in flanks.items():
        values[f"{name}_position"] = 1e-3 * position.transpose(*order, component).values
        values[f"{name}_normal"] = normal.transpose(*order, component).values
    fields = fit(ease_off["lengthwise"].values, ease_off["profile"].values, values)
    slopes = [fields.evaluate(list(values), points, d) for d in ((1, 0), (0, 1))]
    first, second = (s["roll_angle"] for s in slopes)
    if direction == "trace":
        gear_bend = _bend(slopes[0]["gear_position"], slopes[0]["gear_normal"])
        here = fields.evaluate(["pinion_position", "pinion_normal"], points)
        return np.asarray(1.0 / (gear_bend + _bend_on_pinion(tree, here, slopes)))

    def along(name: str) -> Array:
        # The contact line is a level set of the roll angle.
        return np.asarray(first * slopes[1][name] - second * slopes[0][name])

    return np.asarray(1.0 / sum(_bend(along(f"{name}_position"), along(f"{name}_normal")) for name in flanks))


def _bend(tangent: Array, turn: Array) -> Array:
    """Size of the normal curvature (...) along a tangent (3, ...) on which the normal turns so (3, ...)."""
    return np.asarray(np.abs(dot(tangent, turn)) / dot(tangent, tangent))


def _bend_on_pinion(tree: xr.DataTree, here: dict[str, Array], slopes: list[dict[str, Array]]) -> Array:
    """Size of the pinion flank's curvature (...) in the direction of the gear's tooth trace.

    Turning with a member, the points of action are its flank.
    """
    axes = axes_of(tree["ease_off"].to_dataset())
    position, normal = here["pinion_position"], here["pinion_normal"]
    of_pinion, of_gear = axes.velocities(position)
    spin = cross(column(axes.pinion_axis, normal), normal)
    trace = slopes[0]["pinion_position"] - slopes[0]["roll_angle"] * of_gear
    tangents = [s["pinion_position"] - s["roll_angle"] * of_pinion for s in slopes]
    turns = [s["pinion_normal"] - s["roll_angle"] * spin for s in slopes]
    one, mixed, two = (dot(tangents[i], tangents[j]) for i, j in ((0, 0), (0, 1), (1, 1)))
    parts = [dot(trace, tangent) for tangent in tangents]
    weights = (two * parts[0] - mixed * parts[1], one * parts[1] - mixed * parts[0])
    turn = (weights[0] * turns[0] + weights[1] * turns[1]) / (one * two - mixed**2)
    return _bend(trace, turn)


def with_radius_along(tree: xr.DataTree, direction: Direction) -> xr.DataTree:
    """A result whose equivalent radii, and the Hertz pressures that go with them, are those in a direction."""
    loaded = tree["loaded"].to_dataset()
    exists = loaded["lengthwise"].notnull().values[0]
    points = np.stack([loaded[name].values[0][exists] for name in ("lengthwise", "profile")])
    along = np.full(exists.shape, np.nan)
    along[exists] = 1e3 * radii_along(tree, points, direction)
    radius = xr.DataArray(along, dims=("mesh_position", "segment")).broadcast_like(loaded["equivalent_radius"])
    radius = radius.transpose(*loaded["equivalent_radius"].dims)
    pressure = loaded["pressure"] * np.sqrt(loaded["equivalent_radius"] / radius)
    changed = loaded.assign(
        equivalent_radius=radius, pressure=pressure, max_pressure=pressure.max(("mesh_position", "segment"))
    )
    return tree.assign(loaded=xr.DataTree(changed))


def whole_sliding(conditions: ContactConditions) -> Array:
    """The dissertation's friction coefficient, the slide-to-roll ratio made of the whole sliding velocity."""
    ratio = conditions.sliding_velocity / conditions.rolling_velocity
    return COEFFICIENTS["kolivand"](replace(conditions, slide_to_roll=ratio))
