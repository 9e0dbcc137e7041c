"""Data of the flank pictures: outlines, rasters over the mesh cycle, and the loaded segments at each mesh position."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import xarray as xr
from numpy.typing import NDArray

from ....contact.evaluation.carrying_error import CarryingError
from ....contact.evaluation.marking_print import MarkingPrint
from ....contact.lines.contact_lines import boundary_distance
from ....core.attributes import ordered
from ....friction.loaded_contacts import action_splines, axes_of, surface_velocities
from ...plot.pattern_lines import contact_pattern
from ...plot.tooth_view import ToothView, fine_grid
from .flank_raster import RASTER, gear_raster, on_lines, on_member, pressure_raster, scattered_rasters
from .packed_array import packed, packed_exactly

Array = NDArray[Any]

#: Fields of ``/friction`` over the loaded segments that have a picture, with their names.
FRICTION_FIELDS = {
    "film_thickness": "film thickness [µm]",
    "lambda_ratio": "lambda ratio",
    "friction_coefficient": "friction coefficient",
    "flash_temperature": "flash temperature [K]",
}
COMMON_MARGIN = 0.03  # beyond the common flank, as a fraction, to which rasters reach; the page cuts them at its border
UNIT_SPEED = 2.0 * math.pi / 60.0  # [rad/s] of one revolution a minute


def outlines(views: tuple[ToothView, ...]) -> dict[str, Any]:
    """Plane, corners and boundary of the common flank [mm] of each flank."""
    return {
        view.member: {
            "plane": view.plane.coefficients.tolist(),
            "window": list(view.window),
            "common": [packed(view.in_plane(curve)) for curve in view.common],
        }
        for view in views
    }


def surface_fields(tree: xr.DataTree, views: tuple[ToothView, ...]) -> dict[str, Any]:
    """Rasters that no load enters: ease-off, and sliding velocity at one revolution a minute."""
    gear = views[0]
    grid = fine_grid(RASTER)
    ease_off = tree["ease_off"].to_dataset()
    distance = gear.fields("ease_off_angle", grid) * gear.fields("lever_arm", grid) * 1e3
    beyond = boundary_distance(gear.fields, grid) < -COMMON_MARGIN
    fields = {"ease_off": packed(np.where(beyond, np.nan, distance))}
    if "friction" in tree.children:
        found = surface_velocities(axes_of(ease_off), action_splines(ease_off), grid.reshape(2, -1))
        sliding = UNIT_SPEED * found.sliding_speed.reshape(RASTER)
        fields["sliding_velocity"] = packed(np.where(beyond, np.nan, sliding))
    return fields


def unloaded_marks(tree: xr.DataTree, views: tuple[ToothView, ...]) -> dict[str, Any]:
    """Contact lines, path of contact and marking print without load, and the pattern at light load."""
    unloaded = tree["unloaded"].to_dataset()
    pattern = contact_pattern(unloaded, views[0].fields)
    error = CarryingError.of(unloaded, 2.0 * math.pi / tree.attrs["pinion_teeth"])
    thickness = float(unloaded.attrs["separation"])
    printed = MarkingPrint.of(views[0].fields, error, thickness, RASTER) if error.is_known else None
    light = tree["light_load"].to_dataset().isel(torque=0) if "light_load" in tree.children else None
    there = np.all(np.isfinite(pattern.lines), axis=(1, 2))
    marks: dict[str, Any] = {
        "thickness": thickness,
        "carrying": pattern.carrying[there].astype(int).tolist(),
        "light_torque": None if light is None else float(light["torque"]),
        "members": {},
    }
    for view in views:
        own: dict[str, Any] = {
            "lines": packed(view.in_plane(np.moveaxis(pattern.lines[there], 1, 0))),
            "paths": [packed(view.in_plane(span.path)) for span in pattern.ranges],
            "ranges": [packed(view.in_plane(span.outline)) for span in pattern.ranges],
        }
        if printed is not None:
            own["print"] = packed(np.clip(gear_raster(printed.points, printed.excess, view), -1.0, 1.0))
        if light is not None:
            own["light"] = packed(pressure_raster(light, view))
        marks["members"][view.member] = own
    return marks


def pressure_fields(loaded: xr.Dataset, chosen: NDArray[Any], views: tuple[ToothView, ...]) -> dict[str, Any]:
    """Greatest pressure over the mesh cycle by member and torque."""
    return {view.member: [packed(pressure_raster(loaded.isel(torque=int(i)), view)) for i in chosen] for view in views}


def friction_fields(
    tree: xr.DataTree, chosen: NDArray[Any], speeds: NDArray[Any], at: dict[str, int], view: ToothView
) -> dict[str, Any]:
    """Fields under load on the gear flank, by name, torque and speed; ``None`` where nothing carries.

    Parameters
    ----------
    tree
        A result with friction.
    chosen, speeds
        Numbers of torques and speeds.
    at
        Numbers of temperature and roughness.
    view
        The gear's flank.
    """
    loaded = tree["loaded"].to_dataset()
    friction = tree["friction"].to_dataset().isel(at)
    names = [name for name in FRICTION_FIELDS if name in friction]
    fields: dict[str, list[list[Any]]] = {name: [] for name in names}
    for torque in chosen:
        at_torque = loaded.isel(torque=int(torque))
        carries, points = on_lines(at_torque)
        rows: dict[str, list[Any]] = {name: [] for name in names}
        for speed in speeds:
            here = friction.isel(torque=int(torque), speed=int(speed))
            tables = [here[name].transpose("mesh_position", "segment").values[carries] for name in names]
            known = np.all(np.isfinite(tables), axis=0) if tables else np.zeros(0, dtype=bool)
            if np.any(known):
                found = scattered_rasters(points[:, known], np.stack(tables)[:, known], view)
                for name, raster in zip(names, found, strict=True):
                    rows[name].append(packed(raster))
            else:
                for name in names:
                    rows[name].append(None)
        for name in names:
            fields[name].append(rows[name])
    return fields


def segments(loaded: xr.Dataset, chosen: NDArray[Any], views: tuple[ToothView, ...]) -> dict[str, Any]:
    """Loaded segments at each mesh position: place on both flanks, tooth pair, pressure and size.

    Their numbers begin, at torque i of the chosen ones and mesh position k, at ``start[i][k]``.
    """
    order = ("mesh_position", "segment")
    starts, columns = [], []
    count = 0
    for torque in chosen:
        here = loaded.isel(torque=int(torque))
        force = np.nan_to_num(ordered(here, "force", *order))
        carries = force > 0.0
        ends = count + np.cumsum(carries.sum(axis=1))
        starts.append([count, *ends.tolist()])
        count = int(ends[-1])
        edge = np.isfinite(ordered(here, "overhang", *order)) if "overhang" in here else np.zeros_like(carries)
        names = ("lengthwise", "profile", "tooth", "pressure", "half_width", "length", "force")
        columns.append(np.stack([*(ordered(here, name, *order)[carries] for name in names), edge[carries]]))
    table = np.concatenate(columns, axis=1)
    numbers = dict(zip(("pressure", "half_width", "length", "force"), map(packed, table[3:7]), strict=True))
    places = {view.member: packed(on_member(view.fields, table[:2], view.member)) for view in views}
    return {
        "start": starts,
        "places": places,
        "tooth": packed_exactly(table[2]),
        "edge": packed_exactly(table[7]),
        **numbers,
    }
