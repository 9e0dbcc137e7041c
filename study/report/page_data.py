"""Data of the report's page: curves, numbers over torque, flank pictures, and arrays as text in base64.

Flanks: outlines, rasters over the mesh cycle, and the loaded segments at each mesh position.
"""

from __future__ import annotations

import base64
import math
from collections.abc import Sequence
from typing import Any, get_args

import numpy as np
import xarray as xr
from numpy.typing import ArrayLike, NDArray

from ...cases.conversion import gear_pair
from ...cases.schema.case_schema import Case
from ...contact.evaluation.flank_region import ProjectionPlane
from ...contact.evaluation.marking_print import MarkingPrint
from ...contact.evaluation.pressure_map import pressure_map
from ...contact.evaluation.tooth_passage import CarryingError
from ...contact.lines.contact_lines import boundary_distance
from ...core.arrays import Array, Bools, Integers
from ...core.attributes import ordered
from ...core.errors import EaseoffError
from ...friction.loaded_contacts import action_splines, axes_of, surface_velocities
from ...geometry.pair.gear_pair import MEMBERS
from ...geometry.tooth.tooth_flanks import MemberName, named_member
from ..plot.contact_pattern_chart import unloaded_pattern
from ..plot.panel_grid import evenly_chosen, middle
from ..plot.tooth_view import ToothView, fine_grid
from ..result import GRID
from ..summary.curves import CYCLE, Chart, capital, torque_name, wear_charts
from ..summary.plausibility import TOLD_SHARE
from ..summary.quantities import FRICTION, LOADED, value_name, written

#: Numbers of the loaded contact that results are compared by over torque.
OVER_TORQUE = ("peak_to_peak", "max_pressure", "contact_ratio", "mean_mesh_stiffness")


def packed_chart(chart: Chart) -> dict[str, Any]:
    """Chart for the page, without curves that have no finite value."""
    kind, member = chart.kind, chart.member
    curves = [
        {"name": one.name, "x": packed_exactly(one.x), "y": packed_exactly(one.y), "number": number}
        for number, one in enumerate(chart.curves)
        if np.any(np.isfinite(one.y))
    ]
    further = {"per": chart.per, "second": chart.second}
    return {
        "id": f"{chart.name}_{member}" if member else chart.name,
        "title": f"{kind.title}, {member}" if member else kind.title,
        "x": chart.abscissa or kind.x,
        "y": kind.y,
        "source": kind.source,
        "series": curves,
        "by": kind.by,
        "cycle": kind.x == CYCLE,
        "down": kind.down,
        **{name: value for name, value in further.items() if value is not None},
    }


def over_torque(tree: xr.DataTree) -> dict[str, Any]:
    """Courses of the main numbers over torque, by name; efficiency at the middle speed, temperature and roughness."""
    groups = {name: tree[name].to_dataset() for name in ("loaded", "friction") if name in tree.children}
    courses = {}
    for group, variable, quantity in (
        *(("loaded", name, LOADED[name]) for name in OVER_TORQUE),
        ("friction", "efficiency", FRICTION["efficiency"]),
    ):
        if group not in groups or variable not in groups[group]:
            continue
        values = groups[group][variable].sortby("torque")
        conditions = []
        for name in map(str, values.dims):
            if name != "torque":
                number = middle(values[name].values)
                values = values.isel({name: number})
                conditions += [value_name(groups[group], name, number)]
        if np.any(np.isfinite(values.values)):
            courses[variable] = {
                "title": capital(quantity) + "," * ("," in quantity.label),
                "at": ", ".join(conditions),
                "unit": quantity.unit,
                "source": f"{group}/{variable}",
                "x": packed_exactly(values["torque"].values),
                "y": packed_exactly(quantity.factor * values.values),
            }
    return courses


def efficiency_map(friction: xr.Dataset, at: dict[str, int]) -> dict[str, Any] | None:
    """Efficiency [%] over torque and speed, and the share of the loss beyond the formula; ``None`` unless several."""
    if min(friction.sizes["torque"], friction.sizes["speed"]) < 2:
        return None
    subset = friction.isel(temperature=at["temperature"], roughness=at["roughness"])
    subset = subset.sortby("torque").sortby("speed")
    outside = (
        subset["extrapolated_share"].transpose("torque", "speed").values if "extrapolated_share" in subset else None
    )
    return {
        "torques": subset["torque"].values.tolist(),
        "speeds": subset["speed"].values.tolist(),
        "values": packed_exactly(100.0 * subset["efficiency"].transpose("torque", "speed").values),
        "outside": None if outside is None else packed_exactly(outside),
        "told": TOLD_SHARE,
    }


STEP_COUNT = 65534  # of 16 bits between the least and the greatest value; the code after the last one is NaN


def packed(values: ArrayLike) -> dict[str, Any]:
    """Array in 16 bits: rounded to 1/131068 of the distance from its least to its greatest value; NaN is kept."""
    array = np.asarray(values, dtype=float)
    finite = np.isfinite(array)
    low, high = (float(np.min(array[finite])), float(np.max(array[finite]))) if np.any(finite) else (0.0, 0.0)
    step = (high - low) / STEP_COUNT
    codes = np.full(array.shape, STEP_COUNT + 1)
    codes[finite] = np.rint((array[finite] - low) / (step or 1.0)).astype(int)
    return {"shape": list(array.shape), "low": low, "step": step, "data": _text(codes.astype("<u2"))}


def packed_exactly(values: ArrayLike) -> dict[str, Any]:
    """Array in single precision, seven digits."""
    array = np.asarray(values, dtype="<f4")
    return {"shape": list(array.shape), "data": _text(array)}


def _text(array: Array) -> str:
    return base64.b64encode(np.ascontiguousarray(array).tobytes()).decode("ascii")


RASTER = (121, 49)  # points along the face and the profile
CORNER_TOLERANCE = 1e-9  # of a barycentric coordinate
AREA_MINIMUM = 1e-9  # of a triangle, twice, in meshes of the raster


def rasterised(points: Array, values: Array, triangles: Integers, shape: tuple[int, int] = RASTER) -> Array:
    """Values (*shape) on an even grid, linear in triangles (m, 3) of points (2, n), as fractions; NaN beside them.

    Where triangles overlap the greatest value counts.
    """
    grid = np.full(shape[0] * shape[1], np.nan)
    corners = (points.T * (np.array(shape) - 1))[triangles]  # (m, 3, 2), in nodes
    known = np.all(np.isfinite(corners), axis=(1, 2)) & np.all(np.isfinite(values[triangles]), axis=1)
    known &= np.abs(_cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])) > AREA_MINIMUM
    corners, at_corners = corners[known], values[triangles][known]
    low = np.clip(np.ceil(corners.min(axis=1) - 1e-9).astype(int), 0, None)
    high = np.minimum(np.floor(corners.max(axis=1) + 1e-9).astype(int), np.array(shape) - 1)
    count = np.clip(high - low + 1, 0, None)
    each = count.prod(axis=1)
    owner = np.repeat(np.arange(each.size), each)
    number = np.arange(owner.size) - np.repeat(np.cumsum(each) - each, each)
    rows = count[owner, 1]
    node = low[owner] + np.stack([number // np.maximum(rows, 1), number % np.maximum(rows, 1)], axis=1)
    a, b, c = np.moveaxis(corners[owner], 1, 0)
    area = _cross(b - a, c - a)
    second, third = _cross(node - a, c - a) / area, _cross(b - a, node - a) / area
    weight = np.stack([1.0 - second - third, second, third], axis=1)
    within = np.all(weight >= -CORNER_TOLERANCE, axis=1)
    node_values = np.sum(weight * at_corners[owner], axis=1)[within]
    index = (node[:, 0] * shape[1] + node[:, 1])[within]
    np.fmax.at(grid, index, node_values)
    return grid.reshape(shape)


def _cross(a: Array, b: Array) -> Array:
    return np.asarray(a[:, 0] * b[:, 1] - a[:, 1] * b[:, 0])


def pressure_raster(at_torque: xr.Dataset, view: ToothView) -> Array:
    """Greatest pressure [MPa] over the mesh cycle on a flank; zero where there is no load."""
    surface = pressure_map(at_torque)
    points = view.fractions(surface.points)
    return np.nan_to_num(rasterised(points, surface.pressure, surface.triangles))


def gear_raster(grid: Array, values: Array, view: ToothView, shape: tuple[int, int] = RASTER) -> Array:
    """Values (nt, nh) at a grid of fractions (2, nt, nh) of the gear's flank, on the flank of a view; NaN elsewhere."""
    node = np.arange(values.size).reshape(values.shape)
    first = np.stack([node[:-1, :-1], node[1:, :-1], node[1:, 1:]], axis=-1).reshape(-1, 3)
    second = np.stack([node[:-1, :-1], node[1:, 1:], node[:-1, 1:]], axis=-1).reshape(-1, 3)
    points = view.fractions(grid.reshape(2, -1))
    return rasterised(points, values.ravel(), np.concatenate([first, second]), shape)


def on_lines(at_torque: xr.Dataset) -> tuple[Bools, Array]:
    """True for segments (mesh_position, segment) of contact lines under load, and the fractions (2, n) of those."""
    order = ("mesh_position", "segment")
    loaded = np.nan_to_num(ordered(at_torque, "pressure", *order)) > 0.0
    return loaded, np.stack([ordered(at_torque, name, *order)[loaded] for name in ("lengthwise", "profile")])


def scattered_rasters(points: Array, values: Array, view: ToothView) -> Array:
    """Values (k, n) at points (2, n) of the gear flank, on its raster (k, *RASTER): linear between, else nearest.

    The page shows them where there is load; beyond, they keep the border even.
    """
    from scipy.interpolate import LinearNDInterpolator
    from scipy.spatial import Delaunay, QhullError, cKDTree

    sites, wanted = view.plane(points).T, view.plane(fine_grid(RASTER)).reshape(2, -1).T
    nearest = values[:, cKDTree(sites).query(wanted)[1]]
    try:
        between = LinearNDInterpolator(Delaunay(sites), values.T)(wanted).T
    except QhullError:  # fewer than three points, or all on one line
        between = np.full_like(nearest, np.nan)
    return np.where(np.isfinite(between), between, nearest).reshape(-1, *RASTER)


#: Fields of ``/friction`` over the loaded segments that have a picture, with their names.
FRICTION_FIELDS = {
    "film_thickness": "film thickness [µm]",
    "lambda_ratio": "lambda ratio",
    "friction_coefficient": "friction coefficient",
    "flash_temperature": "flash temperature [K]",
}
COMMON_MARGIN = 0.03  # beyond the common flank, as a fraction, to which rasters reach; the page cuts them at its border
UNIT_SPEED = 2.0 * math.pi / 60.0  # [rad/s] of one revolution a minute


def outlines(views: Sequence[ToothView]) -> dict[str, Any]:
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
        velocities = surface_velocities(axes_of(ease_off), action_splines(ease_off), grid.reshape(2, -1))
        sliding = UNIT_SPEED * velocities.sliding_speed.reshape(RASTER)
        fields["sliding_velocity"] = packed(np.where(beyond, np.nan, sliding))
    return fields


def unloaded_marks(tree: xr.DataTree, views: tuple[ToothView, ...]) -> dict[str, Any]:
    """Contact lines, path of contact and marking print without load, and the pattern at light load."""
    unloaded = tree["unloaded"].to_dataset()
    pattern = unloaded_pattern(unloaded, views[0].fields)
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
        member_marks: dict[str, Any] = {
            "lines": packed(view.in_plane(np.moveaxis(pattern.lines[there], 1, 0))),
            "paths": [packed(view.in_plane(span.path)) for span in pattern.ranges],
            "ranges": [packed(view.in_plane(span.outline)) for span in pattern.ranges],
        }
        if printed is not None:
            member_marks["print"] = packed(np.clip(gear_raster(printed.points, printed.excess, view), -1.0, 1.0))
        if light is not None:
            member_marks["light"] = packed(pressure_raster(light, view))
        marks["members"][view.member] = member_marks
    return marks


def pressure_fields(loaded: xr.Dataset, chosen: NDArray[Any], views: tuple[ToothView, ...]) -> dict[str, Any]:
    """Greatest pressure over the mesh cycle by member and torque."""
    return {view.member: [packed(pressure_raster(loaded.isel(torque=int(i)), view)) for i in chosen] for view in views}


def friction_fields(
    tree: xr.DataTree, chosen: NDArray[Any], speeds: NDArray[Any], at: dict[str, int], view: ToothView
) -> dict[str, Any]:
    """Fields under load on the gear flank, by name, torque and speed; ``None`` where nothing carries.

    Torques and speeds are given by number, as are temperature and roughness in ``at``.
    """
    loaded = tree["loaded"].to_dataset()
    friction = tree["friction"].to_dataset().isel(at)
    names = [name for name in FRICTION_FIELDS if name in friction]
    fields: dict[str, list[list[Any]]] = {name: [] for name in names}
    for torque in chosen:
        at_torque = loaded.isel(torque=int(torque))
        carries, points = on_lines(at_torque)
        for rows in fields.values():
            rows.append([])
        for speed in speeds:
            subset = friction.isel(torque=int(torque), speed=int(speed))
            tables = [subset[name].transpose("mesh_position", "segment").values[carries] for name in names]
            known = np.all(np.isfinite(tables), axis=0) if tables else np.zeros(0, dtype=bool)
            rasters: list[Any] = [None] * len(names)
            if np.any(known):
                rasters = [*map(packed, scattered_rasters(points[:, known], np.stack(tables)[:, known], view))]
            for rows, raster in zip(fields.values(), rasters, strict=True):
                rows[-1].append(raster)
    return fields


def segments(loaded: xr.Dataset, chosen: NDArray[Any], views: tuple[ToothView, ...]) -> dict[str, Any]:
    """Loaded segments at each mesh position: place on both flanks, tooth pair, pressure and size.

    Those at torque i of the chosen ones and mesh position k begin with number ``start[i][k]``.
    """
    order = ("mesh_position", "segment")
    starts, columns = [], []
    count = 0
    for torque in chosen:
        at_torque = loaded.isel(torque=int(torque))
        force = np.nan_to_num(ordered(at_torque, "force", *order))
        carries = force > 0.0
        ends = count + np.cumsum(carries.sum(axis=1))
        starts.append([count, *ends.tolist()])
        count = int(ends[-1])
        edge = (
            np.isfinite(ordered(at_torque, "overhang", *order)) if "overhang" in at_torque else np.zeros_like(carries)
        )
        names = ("lengthwise", "profile", "tooth", "pressure", "half_width", "length", "force")
        columns.append(np.stack([*(ordered(at_torque, name, *order)[carries] for name in names), edge[carries]]))
    table = np.concatenate(columns, axis=1)
    numbers = dict(zip(("pressure", "half_width", "length", "force"), map(packed, table[3:7]), strict=True))
    places = {view.member: packed(view.fractions(table[:2])) for view in views}
    whole = {"tooth": packed_exactly(table[2]), "edge": packed_exactly(table[7])}
    return {"start": starts, "places": places, **whole, **numbers}


STEP_COUNT_LIMIT, TORQUE_COUNT_LIMIT = 12, 3  # rows of the table of wear, and columns of it


def deviation_fields(tree: xr.DataTree, case: Case | None, views: tuple[ToothView, ...]) -> dict[str, Any]:
    """Deviations [um of metal] of the flanks by member, and the variable each comes from; empty without any."""
    ease_off = tree["ease_off"].to_dataset()
    fields: dict[str, Any] = {}
    for view in views:
        name = f"{view.member}_deviation"
        if f"largest_deviation_{view.member}_um" not in tree.attrs:
            continue
        if name in ease_off:
            raster = gear_raster(fine_grid(RASTER), _fine(ordered(ease_off, name, *GRID)), view)
            fields[view.member] = {"raster": packed(raster), "source": f"ease_off/{name}"}
        elif tree.attrs.get("deviated") == "surface" and case is not None:
            distance = _from_design(tree, case, view.member)
            if distance is not None:
                fields[view.member] = {"raster": packed(_fine(distance)), "source": "flanks/position, case"}
    return fields


def _from_design(tree: xr.DataTree, case: Case, member: MemberName) -> Array | None:
    """Distance [um] of a result's flank from the designed one along its normal, at the nodes of the result."""
    flanks = tree["flanks"].to_dataset()
    try:
        designed = named_member(gear_pair(case, tree.attrs["flank"]), member).flank(
            *(ordered(flanks, name, name) for name in GRID)
        )
    except EaseoffError:
        return None
    stored = np.moveaxis(ordered(flanks, "position", "member", *GRID, "xyz")[MEMBERS.index(member)], -1, 0)
    position, normal = (np.reshape(values, stored.shape) for values in (designed.position, designed.normal))
    return np.asarray(1e3 * np.sum((stored - position) * normal, axis=0))


def _fine(values: Array) -> Array:
    """Values at an even grid of a flank, linear between those at even nodes; NaN beside them."""
    from scipy.interpolate import RegularGridInterpolator

    axes = tuple(np.linspace(0.0, 1.0, n) for n in values.shape)
    return np.asarray(RegularGridInterpolator(axes, values)(np.moveaxis(fine_grid(RASTER), 0, -1)))


def modification_part(tree: xr.DataTree) -> dict[str, Any] | None:
    """Modification of the ease-off as a raster and a table, and what an optimization reached; ``None`` without one."""
    if "modification" not in tree.children:
        return None
    from ..summary.settings_report import assembly_rows, assembly_title, terms  # most results have none

    surface = tree["modification"].to_dataset()
    part: dict[str, Any] = {
        "raster": packed(_fine(ordered(surface, "modification", *GRID))),
        "terms": [[name.replace("_", " "), value] for name, value in terms(surface)],
        "stages": [],
    }
    if "optimization" in tree.children:
        record = tree["optimization"].to_dataset()
        for number in range(record.sizes["assembly"]):
            assembly = record.isel(assembly=number)
            part["stages"].append(
                {
                    "title": f"Before → after, {assembly_title(assembly, number)}",
                    "heads": ["", *(f"{torque:g} N m" for torque in record["torque"].values), "variable"],
                    "rows": [
                        [label, *changes, f"optimization/{name}"]
                        for name, label, changes in assembly_rows(assembly, " → ")
                    ],
                }
            )
    return part


def wear_part(name: str, worn: xr.Dataset) -> dict[str, Any]:
    """Wear for the page: depths on both flanks at the end, numbers over the steps, and charts over the revolutions."""
    turned = worn["revolutions"].values.astype(float)
    torques = [torque_name(float(torque)) for torque in worn["torque"].values]
    depth = ordered(worn.isel(step=-1), "wear_depth", "member", *GRID)
    members = [str(member) for member in worn["member"].values]
    both: tuple[MemberName, ...] = get_args(MemberName)
    over = {"largest_depth": "member", "peak_to_peak": "torque", "max_pressure": "torque"}
    depths, *others = (ordered(worn, variable, "step", dimension) for variable, dimension in over.items())
    heads = ["revolutions", *(f"depth, {member} [µm]" for member in members)]
    several = len(torques) > TORQUE_COUNT_LIMIT
    at = ["greatest of all torques"] if several else torques
    errors, pressures = (np.max(values, axis=1, keepdims=True) if several else values for values in others)
    heads += [f"transmission error, {words} [µrad]" for words in at]
    heads += [f"greatest pressure, {words} [MPa]" for words in at]
    rows = []
    for step in evenly_chosen(np.arange(turned.size), STEP_COUNT_LIMIT):
        cells = [*(f"{v:.2f}" for v in depths[step]), *(written(v, ".2f") for v in errors[step])]
        rows.append([f"{turned[step]:.0f}", *cells, *(written(v, ".0f") for v in pressures[step])])
    return {
        "name": name,
        "title": str(worn.attrs.get("title", "")),
        "stop": str(worn.attrs.get("stop", "")),
        "flanks": outlines([ToothView(ProjectionPlane.of(worn, one), None, (), one) for one in both]),  # type: ignore[arg-type]
        "depth": {member: packed(_fine(depth[members.index(member)])) for member in both},
        "table": {"heads": heads, "rows": rows, "variables": ["revolutions", *over]},
        "charts": [packed_chart(one) for one in wear_charts(worn)],
    }
