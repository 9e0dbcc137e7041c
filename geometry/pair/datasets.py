"""Results of the geometry as labelled datasets, with units and long names."""

from __future__ import annotations

from typing import Any

import numpy as np
import xarray as xr
from numpy.typing import NDArray

from ...core.attributes import flag_attributes, labelled
from ..flanks.curvature import principal_curvatures
from ..flanks.flank import Flank, NodeStatus
from .ease_off import EaseOff
from .rolling import Drift
from .tooth_body import ShellCoordinates, ToothBody

Array = NDArray[Any]
STATUS = flag_attributes({int(s): s.name for s in NodeStatus})


def _on_grid(values: Array, shape: tuple[int, int]) -> Array:
    """Components-first values (..., n) as (lengthwise, profile, ...)."""
    grid = values.reshape(*values.shape[:-1], *shape)
    return np.moveaxis(grid, (-2, -1), (0, 1))


def flank_dataset(lengthwise: Array, profile: Array, flank: Flank) -> xr.Dataset:
    """One flank on its own grid.

    Parameters
    ----------
    lengthwise, profile
        Grid coordinates (nt), (nh).
    flank
        Flank with nt * nh nodes, in lengthwise-major order.

    Returns
    -------
    xr.Dataset
        Variables over (lengthwise, profile).
    """
    shape = (lengthwise.size, profile.size)
    curvatures = principal_curvatures(flank)
    grid = ("lengthwise", "profile")
    return labelled(
        xr.Dataset(
            {
                "position": ((*grid, "xyz"), _on_grid(flank.position, shape)),
                "normal": ((*grid, "xyz"), _on_grid(flank.normal, shape)),
                "principal_curvature": ((*grid, "principal"), _on_grid(curvatures.curvature, shape)),
                "principal_direction": ((*grid, "xyz"), _on_grid(curvatures.direction, shape)),
                "flank_status": (grid, flank.status.reshape(shape), STATUS),
                "inside": (grid, flank.inside.astype(np.int8).reshape(shape)),
            },
            coords={"lengthwise": lengthwise, "profile": profile, "xyz": list("xyz"), "principal": [1, 2]},
        )
    )


def flanks_dataset(lengthwise: Array, profile: Array, pinion: Flank, gear: Flank) -> xr.Dataset:
    """Both members' flanks on their own grids, over (member, lengthwise, profile); see ``flank_dataset``."""
    members = [flank_dataset(lengthwise, profile, flank) for flank in (pinion, gear)]
    both = xr.concat(members, xr.DataArray(["pinion", "gear"], dims="member", name="member"), combine_attrs="override")
    return labelled(both)


def first_contact(angle: Array, inside: Array) -> float:
    """Smallest value of a field (nt, nh) over its valid nodes, refined by the paraboloid through the nodes around it.

    The refinement makes the zero of the ease-off independent of where the nodes happen to lie.
    """
    row, column = np.unravel_index(np.argmin(np.where(inside, angle, np.inf)), angle.shape)
    smallest = float(angle[row, column])
    patch = angle[max(row - 1, 0) : row + 2, max(column - 1, 0) : column + 2]
    if patch.shape != (3, 3) or not np.all(np.isfinite(patch)) or np.min(patch) < smallest:
        return smallest
    gradient = np.array([patch[2, 1] - patch[0, 1], patch[1, 2] - patch[1, 0]]) / 2.0
    mixed = (patch[2, 2] - patch[2, 0] - patch[0, 2] + patch[0, 0]) / 4.0
    bend = np.array(
        [[patch[2, 1] - 2 * smallest + patch[0, 1], mixed], [mixed, patch[1, 2] - 2 * smallest + patch[1, 0]]]
    )
    if np.linalg.det(bend) <= 0.0 or bend[0, 0] <= 0.0:
        return smallest
    return smallest - 0.5 * float(gradient @ np.linalg.solve(bend, gradient))


def ease_off_dataset(lengthwise: Array, profile: Array, ease_off: EaseOff, drift: Drift) -> xr.Dataset:
    """Ease-off and roll angle on the gear's grid.

    Parameters
    ----------
    lengthwise, profile
        Grid coordinates (nt), (nh).
    ease_off
        Ease-off at the nt * nh nodes.
    drift
        Velocity and acceleration of the conjugate points of the pinion past the nodes.

    Returns
    -------
    xr.Dataset
        Variables over (lengthwise, profile); the ease-off is zero at first contact, the gear rotation to it is the
        attribute ``first_contact_rad``. Other attributes are the axes, oriented so that the drive rotation is positive,
        a point on each, and the ratio: with them the points of action tell the surface velocities.
    """
    shape = (lengthwise.size, profile.size)
    grid = ("lengthwise", "profile")
    zero = first_contact(ease_off.angle.reshape(shape), ease_off.inside.reshape(shape))
    angle = ease_off.angle - zero
    values = {
        "ease_off": 1e3 * angle * ease_off.lever_arm,
        "ease_off_angle": angle,
        "roll_angle": ease_off.roll_angle,
        "lever_arm": ease_off.lever_arm,
        "separation_curvature": ease_off.separation_curvature,
        "separation_skew": ease_off.separation_skew,
        "pinion_lengthwise": ease_off.pinion_lengthwise,
        "pinion_profile": ease_off.pinion_profile,
        "pinion_lengthwise_rate": drift.lengthwise[0],
        "pinion_profile_rate": drift.profile[0],
        "pinion_lengthwise_acceleration": drift.lengthwise[1],
        "pinion_profile_acceleration": drift.profile[1],
        "blade_distance": ease_off.blade_distance,
    }
    vectors = {"action_position": ease_off.action_position, "action_normal": ease_off.action_normal}
    motion = ease_off.motion
    dataset = xr.Dataset(
        {name: (grid, value.reshape(shape)) for name, value in values.items()}
        | {name: ((*grid, "space"), _on_grid(value, shape)) for name, value in vectors.items()}
        | {
            "status": (grid, ease_off.status.reshape(shape), STATUS),
            "inside": (grid, ease_off.inside.astype(np.int8).reshape(shape)),
        },
        coords={"lengthwise": lengthwise, "profile": profile, "space": list("xyz")},
        attrs={
            "first_contact_rad": zero,
            "pinion_axis": motion.pinion_axis,
            "pinion_origin_mm": motion.assembly.pinion_origin,
            "gear_axis": motion.gear_axis,
            "gear_origin_mm": motion.assembly.gear_origin,
            "ratio": motion.assembly.ratio,
        },
    )
    return labelled(dataset)


def teeth_dataset(
    lengthwise: Array,
    profile: Array,
    bodies: tuple[ToothBody, ToothBody],
    coordinates: tuple[ShellCoordinates, ShellCoordinates],
) -> xr.Dataset:
    """Both teeth as plates, and where the contact forces meet them.

    Parameters
    ----------
    lengthwise, profile
        Grid coordinates (nt), (nh) on the gear.
    bodies
        Teeth of pinion and gear.
    coordinates
        Feet of the contact normals at the nt * nh nodes, for pinion and gear.

    Returns
    -------
    xr.Dataset
        Variables over (member, lengthwise, profile), and the dimensions of the plates over (member).
    """
    shape = (lengthwise.size, profile.size)
    grid = ("member", "lengthwise", "profile")
    values = {
        "shell_height": [c.height for c in coordinates],
        "shell_arc": [c.arc for c in coordinates],
        "depth": [c.depth for c in coordinates],
    }
    data: dict[str, Any] = {name: (grid, np.stack([v.reshape(shape) for v in both])) for name, both in values.items()}
    data["shell_direction"] = ((*grid, "shell_axis"), np.stack([_on_grid(c.direction, shape) for c in coordinates]))
    data["trace_length"] = ("member", [b.trace_length for b in bodies])
    data["trace_radius"] = ("member", [b.trace_radius for b in bodies])
    data["tooth_height"] = (("member", "tooth_end"), np.stack([b.height for b in bodies]))
    data["plate_thickness"] = (("member", "tooth_end", "plate_edge"), np.stack([b.thickness for b in bodies]))
    data["fitted_thickness"] = (("member", "tooth_end", "plate_edge"), np.stack([b.fitted_thickness for b in bodies]))
    data["bulge"] = (("member", "tooth_end"), np.stack([b.bulge for b in bodies]))
    data["fanning"] = ("member", [b.fanning for b in bodies])
    coords = {
        "member": ["pinion", "gear"],
        "lengthwise": lengthwise,
        "profile": profile,
        "shell_axis": ["height", "trace", "outward"],
        "tooth_end": ["toe", "heel"],
        "plate_edge": ["root", "tip"],
    }
    return labelled(xr.Dataset(data, coords=coords))
