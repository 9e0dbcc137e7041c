"""Tables of the report: the case, the numbers over torque with the variable each one is, and the efficiencies."""

from __future__ import annotations

import math
import re
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import replace
from typing import Any

import numpy as np
import xarray as xr
from pydantic import BaseModel

from ...cases.schema.case_schema import Case, usual_name
from ...cases.schema.schema_table import extra_of
from ...cases.writing import with_blanks
from ...core.attributes import ordered
from ...core.errors import InputError, printable, suggestion
from ...geometry.pair.member_names import MEMBERS
from ..analysis.key_numbers import key_numbers
from ..result import CONDITIONS
from ..summary import quantities
from ..summary.blank_drawing import dimension_rows
from ..summary.load_case_summary import duty_lines, load_case_notes, load_case_tables
from ..summary.quantities import Quantity, harmonic, roughness_words
from ..summary.result_summary import condition_words, end_name
from ..summary.summary_sheet import described_flanks
from ..summary.table import Table, with_signs

LIMIT = re.compile(r"\s*(\w+)\s*(<=|>=)\s*(\S+)\s*")


def limit_table(limits: Sequence[str], results: Mapping[str, xr.DataTree]) -> Table | None:
    """Table of limits, a row each, with the worst value of every result; ``None`` without limits.

    InputError if one is not of the form ``QUANTITY<=VALUE`` or ``QUANTITY>=VALUE``, with units as the report has them.
    """
    numbers = {name: key_numbers(tree) for name, tree in results.items()}
    rows = []
    for limit in limits:
        parts = LIMIT.fullmatch(limit)
        try:
            name, sign, value = parts[1], parts[2], float(parts[3])  # type: ignore[index]
        except (TypeError, ValueError):
            raise InputError(f"--limit {limit!r}: must be such as 'max_pressure<=1500' or 'efficiency>=96'") from None
        quantity = quantities.LIMITED.get(name)
        if quantity is None:
            near = suggestion(name, quantities.LIMITED)
            raise InputError(f"--limit {limit!r}: {name} is no number of a report{near}")
        worst = np.nanmax if sign == "<=" else np.nanmin
        cells = []
        for one in numbers.values():
            values = np.ravel(one[name].values) if name in one else np.full(1, np.nan)
            found = quantity.factor * float(worst(values)) if np.isfinite(values).any() else math.nan
            over = found > value if sign == "<=" else found < value
            cells.append(quantities.written(found, quantity.form) + ": beyond" * over)
        rows.append((quantity.head, f"{sign} {value:g}", *cells))
    return Table(("limit", "allowed", *numbers), rows, title="Limits") if rows else None


ROW_COUNT_LIMIT = 60  # of the table of efficiencies

#: Variables of the rows under load that come first.
FIRST_PATHS = (
    "loaded/max_pressure",
    "loaded/max_pressure_line_end",
    "loaded/peak_to_peak",
    "loaded/max_load_share",
    "loaded/contact_ratio",
    "loaded/edge_share",
    "root_stress/max_root_stress",
    "loaded/status",
)


def _row(quantity: Quantity, source: str, values: Iterable[float]) -> list[str]:
    """Row name, unit, variable and a value a torque."""
    return [quantity.label, quantity.unit, source, *map(quantity.written, values)]


def unloaded_numbers(tree: xr.DataTree) -> list[list[str]]:
    """Rows name, unit, variable and value of the contact without load."""
    numbers = key_numbers(tree)
    rows = [
        _row(quantity, path, [float(numbers[name])])
        for name, (quantity, path) in quantities.UNLOADED.items()
        if name in numbers
    ]
    orders = zip(numbers["order"].values, numbers["unloaded_harmonic"].values, strict=True)
    return rows + [_row(harmonic(order), "unloaded.harmonics", [value]) for order, value in orders]


def loaded_numbers(tree: xr.DataTree, case: Case | None = None) -> dict[str, Any]:
    """Torques, and rows name, unit, variable and a value a torque of the contact under load.

    Lengths along the pitch circle need the case.
    """
    numbers = key_numbers(tree)
    loaded = tree["loaded"].to_dataset()
    rows = [
        _row(quantity, f"loaded/{variable}", numbers[variable].values)
        for variable, quantity in quantities.LOADED.items()
        if variable in numbers
    ]
    rows += [
        _row(harmonic(order), "loaded/harmonic", numbers["harmonic"].sel(order=order).values)
        for order in numbers["order"].values
    ]
    if "max_pressure_line_end" in numbers:
        ends = [end_name(value) for value in numbers["max_pressure_line_end"].values]
        rows.append(["greatest pressure, inside or where its line ends", "", "loaded/max_pressure_line_end", *ends])
    if "max_edge_share" in numbers:
        rows.append(_row(quantities.EDGE_SHARE, "loaded/edge_share", numbers["max_edge_share"].values))
    rows += [*_along_pitch_circle(loaded, case), *_along_normal(tree, loaded)]
    if "max_root_stress" in numbers:
        for member in numbers["member"].values:
            of_member = replace(quantities.ROOT_STRESS, label=f"{quantities.ROOT_STRESS.label}, {member}")
            values = numbers["max_root_stress"].sel(member=member).values
            rows.append(_row(of_member, "root_stress/max_root_stress", values))
    positions = loaded.sizes["mesh_position"]
    certified = [f"{v:.0f} of {positions}" for v in numbers["certified_positions"].values]
    rows.append(["certified mesh positions", "", "loaded/status", *certified])
    return {"torques": [f"{torque:g}" for torque in loaded["torque"].values], "rows": rows}


def first_numbers(tree: xr.DataTree, under_load: dict[str, Any], condition: dict[str, float] | None) -> dict[str, Any]:
    """Main numbers, from ``loaded_numbers``: heads, rows, and the operating condition in words.

    Power, loss and efficiency are those at the condition (speed [1/min], temperature [°C], roughness [µm]).
    """
    torques = ordered(tree["loaded"].to_dataset(), "torque", "torque")
    ratio = float(tree.attrs["gear_teeth"]) / float(tree.attrs["pinion_teeth"])
    rows = [_row(quantities.GEAR_TORQUE, "loaded/torque × ratio", ratio * torques)]
    rows += [row for path in FIRST_PATHS for row in under_load["rows"] if row[2] == path]
    if condition is None:
        return {"torques": under_load["torques"], "rows": rows, "condition": ""}
    whole = tree["friction"].to_dataset()
    friction = whole.sel(condition)
    power = torques * condition["speed"] * math.pi / 30.0
    rows.append(_row(quantities.PINION_POWER, "loaded/torque × friction/speed", power))
    for variable in ("mean_power_loss", "efficiency"):
        rows.append(_row(quantities.FRICTION[variable], f"friction/{variable}", ordered(friction, variable, "torque")))
    speeds = f"{condition['speed']:g} 1/min of the pinion, {condition['speed'] / ratio:.4g} 1/min of the gear"
    rough = roughness_words(whole, int(np.argmax(whole["roughness"].values == condition["roughness"])))
    words = f"power, loss and efficiency at {speeds}, {condition['temperature']:g} °C, Rq {rough} µm"
    return {"torques": under_load["torques"], "rows": rows, "condition": words}


def mean_pitch_radius(case: Case) -> float | None:
    """Pitch radius of the gear in the middle of its face [mm]; ``None`` without a blank."""
    blank = with_blanks(case).gear.blank
    if blank is None:
        return None
    return (blank.outer_cone_distance - 0.5 * blank.face_width) * math.sin(math.radians(blank.pitch_angle))


def _along_pitch_circle(loaded: xr.Dataset, case: Case | None) -> list[list[str]]:
    radius = None if case is None else mean_pitch_radius(case)
    if radius is None:
        return []
    source = f"loaded/peak_to_peak × {radius:.2f} mm (mean pitch radius of the gear, from blank)"
    return [_row(quantities.ERROR_AT_RADIUS, source, radius * loaded["peak_to_peak"].values)]


def _along_normal(tree: xr.DataTree, loaded: xr.Dataset) -> list[list[str]]:
    """Transmission error as a length, and mesh stiffness by force, length and face width, along the common normal.

    With the mean lever arm a [mm] of the common flank: angle times a, and stiffness of the rotation over a squared.
    """
    ease_off = tree["ease_off"].to_dataset()
    grid = ("lengthwise", "profile")
    arm = float(np.mean(ordered(ease_off, "lever_arm", *grid)[ordered(ease_off, "inside", *grid) == 1]))
    source = f"loaded/peak_to_peak × {arm:.2f} mm (mean of ease_off/lever_arm)"
    rows = [_row(quantities.ERROR_ALONG_NORMAL, source, arm * loaded["peak_to_peak"].values)]
    if "mean_mesh_stiffness" in loaded:
        position = ordered(tree["flanks"].to_dataset(), "position", "member", *grid, "xyz")[1]
        middle = position[:, position.shape[1] // 2]
        ends = middle[[0, -1]]
        width = float(np.hypot(*np.diff(np.stack([ends[:, 2], np.hypot(ends[:, 0], ends[:, 1])]), axis=1)[:, 0]))
        source = f"loaded/mean_mesh_stiffness / ({arm:.2f} mm)² / {width:.2f} mm (flanks/position)"
        rows.append(_row(quantities.STIFFNESS_BY_WIDTH, source, loaded["mean_mesh_stiffness"].values / arm**2 / width))
    return rows


def efficiency_rows(friction: xr.Dataset, loaded: xr.Dataset) -> dict[str, Any]:
    """Table of friction: heads, variables, a row an operating condition, and the number of those left out.

    The greatest values over segments are over those that carry.
    """
    columns = {variable: quantity for variable, quantity in quantities.FRICTION.items() if variable in friction}
    carries = loaded["pressure"].fillna(0.0) > 0.0
    over = [
        friction[variable].where(carries).max(["mesh_position", "segment"])
        if "segment" in friction[variable].dims
        else friction[variable]
        for variable in columns
    ]
    shape = tuple(friction.sizes[name] for name in CONDITIONS)
    whole = xr.DataArray(np.ones(shape), dims=CONDITIONS)
    tables = [(values * whole).transpose(*CONDITIONS).values for values in over]
    rows = []
    for at in list(np.ndindex(shape))[:ROW_COUNT_LIMIT]:
        cells = [one.written(float(table[at])) for table, one in zip(tables, columns.values(), strict=True)]
        rows.append([*condition_words(friction, at), *cells])
    heads = ["torque [N m]", "speed [1/min]", "oil [°C]", "Rq [µm]", *(quantity.head for quantity in columns.values())]
    variables = [f"friction/{name}" for name in (*CONDITIONS, *columns)]
    return {"heads": heads, "variables": variables, "rows": rows, "left": math.prod(shape) - len(rows)}


def load_case_rows(tree: xr.DataTree) -> dict[str, Any]:
    """Tables of an analysis over load cases, means over the duty cycle, and notes."""
    tables = [table.page() for table in load_case_tables(tree["load_cases"].to_dataset())]
    duty = duty_lines(tree["duty"].to_dataset()).splitlines() if "duty" in tree.children else []
    notes = [with_signs(printable(note)) for note in load_case_notes(tree)]
    return {"tables": tables, "duty": duty, "notes": notes}


def case_tables(case: Case) -> list[dict[str, Any]]:
    """Tables of the case: pair, blanks, machine settings, cutters; a column a member or flank."""
    case = with_blanks(case)
    flanks = described_flanks(case).items()
    blanks = [(name, member.blank) for name, member in (("pinion", case.pinion), ("gear", case.gear)) if member.blank]
    pair = [["pinion teeth", "", "pinion.number_of_teeth", f"{case.pinion.number_of_teeth}"]]
    pair.append(["gear teeth", "", "gear.number_of_teeth", f"{case.gear.number_of_teeth}"])
    pair.append(["hand of spiral of the pinion", "", "pinion.hand_of_spiral", case.pinion.hand_of_spiral])
    pair += [[name, unit, f"pair.{key}", *values] for name, unit, key, values in _compared([("", case.pair)])]
    tables = [{"title": "Pair", "columns": ["case"], "rows": pair}]
    if dimensions := dimension_rows(case):
        tables.append(
            {"title": "What blanks, cutters and settings imply", "columns": list(MEMBERS), "rows": dimensions}
        )
    for title, part, owners in (
        ("Blanks", "blank", blanks),
        ("Machine settings", "machine", [(name, flank.machine) for name, flank in flanks]),
        ("Cutters", "cutter", [(name, flank.cutter) for name, flank in flanks]),
    ):
        if owners:
            rows = [[name, unit, f"{part}.{key}", *values] for name, unit, key, values in _compared(owners)]
            tables.append({"title": title, "columns": [name for name, _ in owners], "rows": rows})
    return tables


def _compared(owners: list[tuple[str, Any]]) -> list[tuple[str, str, str, list[str]]]:
    """Name, unit, key and value of each of some tables' numbers; those that none of them gives are left out."""
    model: BaseModel = owners[0][1]
    rows = []
    for key, field in type(model).model_fields.items():
        unit = extra_of(field, "unit")
        values = [getattr(owner, key) for _, owner in owners]
        if not all(isinstance(value, int | float | None) for value in values):
            continue
        if all(value is None or (not value and key not in model.model_fields_set) for value in values):
            continue
        display_unit = "" if unit == "1" else unit.replace("deg", "°")
        texts = ["–" if value is None else f"{value:.7g}" for value in values]
        rows.append((usual_name(key), display_unit, key, texts))
    return rows
