"""Departures from the designed flanks for the report: measured or worn flanks, wear, and the modified ease-off."""

from __future__ import annotations

from typing import Any, get_args

import numpy as np
import xarray as xr
from numpy.typing import NDArray

from ....cases.conversion import gear_pair
from ....cases.schema.case_schema import Case
from ....contact.evaluation.marking_print import ProjectionPlane
from ....core.attributes import ordered
from ....core.errors import EaseoffError
from ....geometry.pair.gear_pair import MEMBERS
from ....geometry.tooth.tooth_flanks import MemberName, named_member
from ...plot.tooth_view import ToothView, fine_grid
from ..modification_report import assembly_rows, assembly_title, terms
from .cycle_charts import chart
from .flank_raster import RASTER, gear_raster
from .packed_array import packed
from .report_tables import written

Array = NDArray[Any]
GRID = ("lengthwise", "profile")
STEP_COUNT_LIMIT, TORQUE_COUNT_LIMIT = 12, 3  # rows of the table of wear, and columns of it


def deviation_fields(tree: xr.DataTree, case: Case | None, views: tuple[ToothView, ...]) -> dict[str, Any]:
    """Deviations [um of metal] of the flanks by member, with the variable each comes from; empty if there are none.

    Parameters
    ----------
    tree
        A result.
    case
        Its case.
    views
        Of gear and pinion.
    """
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
    surface = tree["modification"].to_dataset()
    part: dict[str, Any] = {
        "raster": packed(_fine(ordered(surface, "modification", *GRID))),
        "terms": [[name.replace("_", " "), value] for name, value in terms(surface)],
        "stages": [],
    }
    if "optimization" in tree.children:
        record = tree["optimization"].to_dataset()
        for number in range(record.sizes["assembly"]):
            here = record.isel(assembly=number)
            part["stages"].append(
                {
                    "title": f"Before → after, {assembly_title(here, number)}",
                    "heads": ["", *(f"{torque:g} N m" for torque in record["torque"].values), "variable"],
                    "rows": [
                        [label.replace("[urad]", "[µrad]"), *changes, f"optimization/{name}"]
                        for name, label, changes in assembly_rows(here, " → ")
                    ],
                }
            )
    return part


def wear_part(name: str, worn: xr.Dataset) -> dict[str, Any]:
    """Wear for the page: depths on both flanks at the end, numbers over the steps, and charts over the revolutions."""
    turned = worn["revolutions"].values.astype(float)
    torques = [f"{torque:g} N m" for torque in worn["torque"].values]
    depth = ordered(worn.isel(step=-1), "wear_depth", "member", *GRID)
    members = [str(member) for member in worn["member"].values]
    both: tuple[MemberName, ...] = get_args(MemberName)
    planes = {member: ProjectionPlane.of(worn, member) for member in both}
    largest, ripple, pressure = (
        ordered(worn, variable, "step", over)
        for variable, over in (("largest_depth", "member"), ("peak_to_peak", "torque"), ("max_pressure", "torque"))
    )
    label = "revolutions of the pinion"
    heads = ["revolutions", *(f"depth, {member} [µm]" for member in members)]
    several = len(torques) > TORQUE_COUNT_LIMIT
    at = ["greatest of all torques"] if several else torques
    shown_error, shown_pressure = (
        np.max(values, axis=1, keepdims=True) if several else values for values in (ripple, pressure)
    )
    heads += [f"transmission error, {words} [µrad]" for words in at]
    heads += [f"greatest pressure, {words} [MPa]" for words in at]
    rows = []
    for step in _even(turned.size):
        cells = [*(f"{v:.2f}" for v in largest[step]), *(written(v, ".2f") for v in shown_error[step])]
        rows.append([f"{turned[step]:.0f}", *cells, *(written(v, ".0f") for v in shown_pressure[step])])
    return {
        "name": name,
        "title": str(worn.attrs.get("title", "")),
        "stop": str(worn.attrs.get("stop", "")),
        "flanks": {
            member: {
                "plane": planes[member].coefficients.tolist(),
                "window": list(ToothView(planes[member], None, ()).window),  # type: ignore[arg-type]
                "common": [],
            }
            for member in both
        },
        "depth": {member: packed(_fine(depth[members.index(member)])) for member in both},
        "table": {
            "heads": heads,
            "rows": rows,
            "variables": ["revolutions", "largest_depth", "peak_to_peak", "max_pressure"],
        },
        "charts": [
            chart(
                "wear_depth",
                "Greatest depth of wear",
                label,
                "[µm]",
                "largest_depth",
                [(member, turned, largest[:, number]) for number, member in enumerate(members)],
            ),
            chart(
                "wear_error",
                "Transmission error, peak to peak",
                label,
                "[µrad]",
                "peak_to_peak",
                [(torque, turned, ripple[:, number]) for number, torque in enumerate(torques)],
            ),
            chart(
                "wear_pressure",
                "Greatest pressure",
                label,
                "[MPa]",
                "max_pressure",
                [(torque, turned, pressure[:, number]) for number, torque in enumerate(torques)],
            ),
        ],
    }


def _even(count: int) -> list[int]:
    """Numbers of evenly chosen steps, the first and the last one among them."""
    return [int(step) for step in np.unique(np.linspace(0, count - 1, min(count, STEP_COUNT_LIMIT)).round())]
