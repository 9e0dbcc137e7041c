"""An involute spur pair in its plane of action, and the curvatures of conjugate flanks from points of action."""

from __future__ import annotations

from typing import Any

import numpy as np
import xarray as xr
from numpy.typing import NDArray

from easeoff.friction.loaded_contacts import Axes, surface_velocities
from easeoff.geometry.vectors import column, cross, dot

Array = NDArray[Any]


def spur(radius: float = 0.05, ratio: float = 2.5, pressure_angle: float = 0.35) -> tuple[xr.Dataset, Array]:
    """Points of action of an involute spur pair, in its plane of action, and the distance [m] from the pitch point."""
    width, height = np.linspace(0.0, 20.0, 9), np.linspace(-6.0, 6.0, 11)
    z, s = np.meshgrid(width, height, indexing="ij")
    direction = np.array([np.sin(pressure_angle), np.cos(pressure_angle), 0.0])
    position = np.array([1e3 * radius, 0.0, 0.0]) + s[..., None] * direction + z[..., None] * np.array([0.0, 0.0, 1.0])
    base = 1e3 * radius * np.cos(pressure_angle)
    shape = (*s.shape, 3)
    data = xr.Dataset(
        {
            "action_position": (("lengthwise", "profile", "space"), position),
            "action_normal": (("lengthwise", "profile", "space"), np.broadcast_to(direction, shape)),
            "roll_angle": (("lengthwise", "profile"), s / base),
        },
        coords={"lengthwise": np.linspace(0, 1, 9), "profile": np.linspace(0, 1, 11)},
        attrs={
            "pinion_axis": [0.0, 0.0, 1.0],
            "pinion_origin_mm": [0.0, 0.0, 0.0],
            "gear_axis": [0.0, 0.0, -1.0],
            "gear_origin_mm": [1e3 * radius * (1.0 + ratio), 0.0, 5.0],
            "ratio": ratio,
        },
    )
    return data, 1e-3 * s


def shape_operators(axes: Axes, fields: Any, points: Array) -> tuple[Any, Any]:
    """What pinion's and gear's conjugate flanks make of a tangent: minus the change of the normal along it.

    From the points of action alone: turning with a member, they and their normals are its flank.
    """
    here = surface_velocities(axes, fields, points)
    slopes = [fields.evaluate(["position", "normal", "roll_angle"], points, d) for d in ((1, 0), (0, 1))]

    def operator(turning: Array, velocity: Array) -> Any:
        spin = cross(column(turning, here.normal), here.normal)
        first, second = (s["position"] - s["roll_angle"] * velocity for s in slopes)
        changes = [s["normal"] - s["roll_angle"] * spin for s in slopes]

        def applied(tangent: Array) -> Array:
            one, mixed, two = dot(first, first), dot(first, second), dot(second, second)
            along, across = dot(tangent, first), dot(tangent, second)
            parts = (two * along - mixed * across, one * across - mixed * along)
            return np.asarray(-(parts[0] * changes[0] + parts[1] * changes[1]) / (one * two - mixed**2))

        return applied

    return operator(axes.pinion_axis, here.pinion), operator(axes.gear_axis / axes.ratio, here.gear)
