"""The equivalent radius and the slide-to-roll ratio as the dissertation may have them, to redraw its figures."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
import xarray as xr
from numpy.typing import NDArray

from easeoff.contact.lines.flank_splines import fit
from easeoff.friction import COEFFICIENTS, ContactConditions
from easeoff.geometry.vectors import dot

Array = NDArray[Any]


def radii_along_line(tree: xr.DataTree, points: Array) -> Array:
    """R_p R_g / (R_p + R_g) of both flanks' radii along the contact line, without their signs (...) [m].

    One flank is about as hollow as the other is round, so that this is about half of either. It is no radius of the
    line contact, in which the radii count across the line and with their signs; the radii that the dissertation prints
    (Kolivand 2009, figure 5.8) are of this size and not of that one.

    Parameters
    ----------
    tree
        A result of ``analyze`` or ``read_result``.
    points
        Lengthwise and profile fractions (2, ...).
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

    def along(name: str) -> Array:
        # The contact line is a level set of the roll angle.
        return np.asarray(first * slopes[1][name] - second * slopes[0][name])

    lines = {name: (along(f"{name}_position"), along(f"{name}_normal")) for name in flanks}
    return np.asarray(1.0 / sum(np.abs(dot(line, turn)) / dot(line, line) for line, turn in lines.values()))


def with_radius_along_line(tree: xr.DataTree) -> xr.DataTree:
    """A result whose equivalent radii, and the Hertz pressures that go with them, are those along the contact line."""
    loaded = tree["loaded"].to_dataset()
    exists = loaded["lengthwise"].notnull().values[0]
    points = np.stack([loaded[name].values[0][exists] for name in ("lengthwise", "profile")])
    along = np.full(exists.shape, np.nan)
    along[exists] = 1e3 * radii_along_line(tree, points)
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
