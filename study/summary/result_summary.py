"""Result summary: pair, unloaded and loaded contact, friction and certificates, as text.

Tables of the contact in a result's summary: without load, and under load with a column a torque.
"""

from __future__ import annotations

import math
import textwrap
from typing import Any

import numpy as np
import xarray as xr
from numpy.typing import NDArray

from ...contact.outcomes import LineEnd, Status
from ...core.arrays import Bools
from ...core.netcdf_file import in_memory
from ..analysis.key_numbers import deviations, key_numbers, model_name, modification
from ..result import CONDITIONS, PATTERN
from .assembly import (
    backlash_words,
    deflection_tables,
    misalignment_over_torque,
    misalignment_words,
    stored_table,
    supports_tables,
    supports_words,
)
from .plausibility import doubts, executed_settings
from .quantities import FRICTION, LOADED_ROWS, NO_VALUE, ROLLING_SHARE, ROOT_STRESS, Quantity, roughness_words, written
from .table import ROW_COUNT_LIMIT, WIDTH, Table, summary_text, underlined

COLUMN_COUNT_LIMIT = 5  # torques side by side
FRACTIONS = ("lengthwise", "profile")
NO_AREA = "no area"  # of a pattern: contact at single points, on a single line, or none that is certified


def unloaded_table(numbers: xr.Dataset) -> str:
    """Table of the unloaded contact and of that at light load."""
    return aligned(unloaded_rows(numbers))


def unloaded_rows(numbers: xr.Dataset) -> list[tuple[str, str]]:
    """Names and words of the unloaded contact and of that at light load; an older result has its error alone."""
    harmonics = " / ".join(f"{amplitude:.2f}" for amplitude in numbers["unloaded_harmonic"].values)
    rows = [("transmission error", f"{numbers['unloaded_peak_to_peak'].item():.2f} urad peak to peak")]
    if "unloaded_pinion_peak_to_peak" in numbers:
        rows.append(("  of the pinion", f"{numbers['unloaded_pinion_peak_to_peak'].item():.2f} urad peak to peak"))
    rows.append(("  harmonics", f"{harmonics} urad"))
    states = [("unloaded", f"print of {numbers['marking'].item():g} um")]
    if "light_load_torque" in numbers:
        states.append(("light_load", f"pattern at {numbers['light_load_torque'].item():.4g} N m"))
    for state, name in states:
        if f"{state}_pattern_length" in numbers:
            values = [100.0 * numbers[f"{state}_{what}"].item() for what in PATTERN]
            ratio = numbers[f"{state}_contact_ratio"].item()
            words = "centre {:.0f}, {:.0f} % from toe, root; length, height {:.0f}, {:.0f} %"
            place = NO_AREA if any(map(math.isnan, values)) else words.format(*values)
            rows.append((name, f"{place}; contact ratio {ratio:.2f}"))
    if "geometric_contact_ratio" in numbers:
        words = f"{numbers['geometric_contact_ratio'].item():.2f}"
        beside = ", of contact lines alone; under load edges beside them count, too" if with_edges(numbers) else ""
        rows.append(("geometric contact ratio", words + beside))
    return rows


def with_edges(numbers: xr.Dataset) -> bool:
    """True if edges beside the lines carry: a pair is then in contact longer than it has contact lines."""
    return "max_edge_share" in numbers and bool((numbers["max_edge_share"].values > 0.0).any())


def aligned(rows: list[tuple[str, str]]) -> str:
    """Names and words in two columns, wrapped."""
    wide = max(len(name) for name, _ in rows) + 2
    lines = []
    for name, words in rows:
        lines += textwrap.wrap(words, WIDTH, initial_indent=f"{name:{wide}}", subsequent_indent=" " * wide)
    return "\n".join(lines)


def _loaded_rows(numbers: xr.Dataset, positions: int) -> list[tuple[str, list[str]]]:
    """Rows of the table of the loaded contact: name, and a text for every torque."""

    def row(name: str, *variables: str, missing: str = "") -> tuple[str, list[str]]:
        if any(variable not in numbers for variable in variables):
            return name, []
        values = zip(*(numbers[variable].values for variable in variables), strict=True)
        quantities = [LOADED_ROWS[variable] for variable in variables]
        return name, [
            missing
            if missing and any(map(math.isnan, each))
            else ", ".join(one.written(value) for one, value in zip(quantities, each, strict=True))
            for each in values
        ]

    rows = [
        row("transmission error, mean [urad]", "mean_level"),
        row("  peak to peak", "peak_to_peak"),
        *(
            (f"  harmonic {order}", [written(value, ".2f") for value in numbers["harmonic"].sel(order=order).values])
            for order in numbers["order"].values
        ),
        row("  of the pinion, mean", "pinion_mean_level"),
        row("  of the pinion, peak to peak", "pinion_peak_to_peak"),
        row("mesh stiffness, mean [N m/urad]", "mean_mesh_stiffness"),
        row("contact ratio, with edges" if with_edges(numbers) else "contact ratio", "contact_ratio"),
        row("greatest share of a pair [%]", "max_load_share"),
        row("greatest share on edges [%]", "max_edge_share"),
        row("pattern, centre from toe, root [%]", *PATTERN[:2], missing=NO_AREA),
        row("  length, height [%]", *PATTERN[2:], missing=NO_AREA),
        row("greatest pressure [MPa]", "max_pressure"),
        row("  from toe, root [%]", *(f"max_pressure_{name}" for name in FRACTIONS), missing=NO_VALUE),
        row("  mesh position, pair", "max_pressure_position", "max_pressure_pair", missing=NO_VALUE),
    ]
    if "max_pressure_line_end" in numbers:
        ends = [end_name(value) for value in numbers["max_pressure_line_end"].values]
        rows.append(("  inside, or where its line ends", ends))
    if "max_root_stress" in numbers:
        for member in numbers["member"].values:
            values = numbers["max_root_stress"].sel(member=member).values
            rows.append((f"greatest root stress, {member} [MPa]", [ROOT_STRESS.written(value) for value in values]))
    certified = [f"{value:.0f} of {positions}" for value in numbers["certified_positions"].values]
    rows.append(("certified mesh positions", certified))
    rows.append(("worst residual", [f"{value:.0e}" for value in numbers["worst_certificate"].values]))
    return [(name, texts) for name, texts in rows if texts]


def end_name(value: int) -> str:
    """End of the contact line at which the greatest pressure is, as text."""
    end = LineEnd(int(value))
    return NO_VALUE if end == LineEnd.UNKNOWN else end.name.lower().replace("_", " ")


def loaded_table(numbers: xr.Dataset, positions: int) -> str:
    """Table of the loaded contact, a column a torque, in as many parts as the width asks for."""
    rows, torques = _loaded_rows(numbers, positions), numbers["torque"].values
    parts = []
    for first in range(0, torques.size, COLUMN_COUNT_LIMIT):
        columns = slice(first, first + COLUMN_COUNT_LIMIT)
        heads = ["torque at the pinion [N m]", *(f"{torque:g}" for torque in torques[columns])]
        parts.append(Table(heads, [(name, *texts[columns]) for name, texts in rows]).text())
    return "\n\n".join(parts)


#: Share of the power loss outside the range of the friction formula from which numbers have fewer digits.
ROUGH_SHARE = 0.4
ROUGH_NOTE = f"with fewer digits: {100 * ROUGH_SHARE:.0f} % and more of the loss are outside the formula's range"
CLAMPED_NOTE = "* beyond the oil's data: the last value was taken"
#: Heads of the columns that name an operating condition.
CONDITION_HEADS = ("torque\nN m", "speed\n1/min", "oil\ndegC", "Rq\num")
#: Torques that the outcome names; of more it names the range.
TORQUE_COUNT_LIMIT = 8


def efficiencies(friction: xr.Dataset) -> str:
    """Table of power loss and efficiency, a row an operating condition, with the extremes if there are many."""
    table = efficiency_table(friction)
    text, at = table.text(), table.heads.index(FRICTION["efficiency"])
    if len(table.rows) > ROW_COUNT_LIMIT:
        known = sorted((row for row in table.rows if row[at] != NO_VALUE), key=lambda row: float(row[at]))
        for word, row in zip(("least", "greatest"), known[:1] + known[-1:], strict=False):
            text += f"\n{word} efficiency: {row[at]} % at {row[0]} N m, {row[1]} 1/min, {row[2]} degC, {row[3]} um"
    return text


def efficiency_table(friction: xr.Dataset) -> Table:
    """Table of power loss and efficiency, a row an operating condition."""
    loss, rolling = (over_conditions(friction, name) for name in ("mean_power_loss", "mean_rolling_loss"))
    columns = {FRICTION["mean_friction_coefficient"]: over_conditions(friction, "mean_friction_coefficient")}
    columns |= {FRICTION["mean_power_loss"]: loss}
    columns |= {ROLLING_SHARE: np.divide(rolling, loss, out=np.full(loss.shape, np.nan), where=loss != 0.0)}
    columns |= {FRICTION["efficiency"]: over_conditions(friction, "efficiency")}
    rough, places = is_rough(friction), _places(friction, "min_film")
    heads: list[str | Quantity] = [*CONDITION_HEADS, *columns]
    if places:
        heads += [FRICTION["min_film_thickness"], "at toe,\nroot %"]
        films = over_conditions(friction, "min_film_thickness")
    rows = [
        (
            *_marked_condition(friction, at),
            *(quantity.written(float(values[at]), rough=bool(rough[at])) for quantity, values in columns.items()),
            *((FRICTION["min_film_thickness"].written(float(films[at])), places[at]) if places else ()),
        )
        for at in np.ndindex(loss.shape)
    ]
    notes = [ROUGH_NOTE] * bool(rough.any()) + [CLAMPED_NOTE] * bool(friction["temperature_clamped"].values.any())
    return Table(heads, rows, 0, note="\n".join(notes), group="friction")


def contact_temperatures(friction: xr.Dataset) -> list[Table]:
    """Table of the greatest flash temperatures, a row an operating condition, if the result has them."""
    places = _places(friction, "max_flash")
    if not places:
        return []
    names = ("max_flash_temperature", "max_contact_temperature", "max_pressure_velocity")
    flash, contact, product = (FRICTION[name] for name in names)
    values = [over_conditions(friction, name) for name in names]
    rows = []
    for at, place in places.items():
        texts = [one.written(float(value[at])) for one, value in zip((flash, contact, product), values, strict=True)]
        rows.append((*_marked_condition(friction, at), *texts[:2], place, texts[2]))
    heads: list[str | Quantity] = [*CONDITION_HEADS, flash, contact, "at toe,\nroot %", product]
    return [Table(heads, rows, 0, "Contact temperature", group="friction")]


def over_conditions(friction: xr.Dataset, name: str) -> NDArray[Any]:
    """Values of a variable over torque, speed, temperature and roughness."""
    return friction[name].transpose(*CONDITIONS).values


def is_rough(friction: xr.Dataset) -> Bools:
    """True where much of the power loss is outside the range of the formula, over the operating conditions."""
    if "extrapolated_share" not in friction:
        return np.zeros([friction.sizes[name] for name in CONDITIONS], dtype=bool)
    rough: Bools = np.nan_to_num(over_conditions(friction, "extrapolated_share")) >= ROUGH_SHARE
    return rough


def condition_words(friction: xr.Dataset, at: tuple[int, ...]) -> list[str]:
    """Operating condition in words: torque, speed, temperature, and roughness, of both flanks if they differ."""
    words = [f"{friction[name].values[i]:g}" for name, i in zip(CONDITIONS[:3], at, strict=False)]
    return [*words, roughness_words(friction, at[3])]


def _marked_condition(friction: xr.Dataset, at: tuple[int, ...]) -> list[str]:
    """The same with a mark where the temperature is beyond the oil's data."""
    torque, speed, temperature, rough = condition_words(friction, at)
    return [torque, speed, temperature + "*" * bool(friction["temperature_clamped"].values[at[2]]), rough]


def _places(friction: xr.Dataset, extreme: str) -> dict[tuple[int, ...], str]:
    """Place of an extreme over the mesh cycle by operating condition; empty if the result has none."""
    names = [f"{extreme}_{name}" for name in FRACTIONS]
    if names[0] not in friction:
        return {}
    along, up = (100.0 * over_conditions(friction, name) for name in names)
    return {at: f"{along[at]:.0f}, {up[at]:.0f}" for at in np.ndindex(along.shape)}


def uncertified(tree: xr.DataTree) -> list[str]:
    """Lines on uncertified solutions: one a torque that has some, their first reason, and one for friction fed back."""
    lines = []
    for loaded in (tree[name].to_dataset() for name in ("light_load", "loaded") if name in tree.children):
        lines += [
            f"{torque:g} N m: {some} of {status.size} mesh positions have no certified solution {reasons}"
            for torque, status in zip(loaded["torque"].values, loaded["status"].values, strict=True)
            for some, reasons in _failures(status)
        ]
        if "first_failure" in loaded.attrs:
            lines.append(f"the first of them: {loaded.attrs['first_failure']}")
    if "friction" in tree.children and "status" in tree["friction"]:
        status = tree["friction"].to_dataset()["status"].values
        what = "mesh positions and conditions have no load distribution"
        lines += [f"friction fed back: {some} of {status.size} {what} {reasons}" for some, reasons in _failures(status)]
    return lines


def outcome(tree: xr.DataTree) -> str:
    """Outcome of an analysis in one line: certified mesh positions, torques and greatest pressure."""
    loaded = tree["loaded"].to_dataset()
    status, torques = loaded["status"].values, loaded["torque"].values
    at = ", ".join(f"{torque:g}" for torque in torques)
    if torques.size > TORQUE_COUNT_LIMIT:
        at = f"{torques.size} torques from {torques.min():g} to {torques.max():g}"
    certified = f"{np.count_nonzero(status == Status.CERTIFIED)} of {status.size} mesh positions certified at {at} N m"
    pressure = loaded["max_pressure"].values
    if np.all(np.isnan(pressure)):
        return certified
    return f"{certified}; greatest pressure {np.nanmax(pressure):.0f} MPa"


def _failures(status: Any) -> list[tuple[int, str]]:
    """Number and names of the values of ``Status`` that are not certified; empty if all are."""
    bad = status[status != Status.CERTIFIED]
    names = sorted({Status(int(value)).name.lower() for value in bad})
    return [(bad.size, f"({', '.join(names)}); their values are NaN")] if bad.size else []


def head_rows(tree: xr.DataTree) -> list[tuple[str, str]]:
    """Pair, misalignment, departures from the design and models: names and words."""
    attrs, numbers = tree.attrs, key_numbers(tree)
    misaligned = misalignment_words(attrs) or "none"
    if misalignment_over_torque(tree) is not None:
        misaligned = f"{misaligned} without torque; under load see below"
    pair = f"{attrs['pinion_teeth']} x {attrs['gear_teeth']}, {attrs['pinion_hand']}-hand pinion"
    solver = "native" if attrs["solver"] == "auto" else attrs["solver"]
    shared = f"{100 * numbers['common_flank'].item():.0f} % of the gear flank"
    drawing = stored_table(tree, "drawing")
    names = {"": drawing.get("drawing_number"), "revision ": drawing.get("revision")}
    head = [
        ("drawing", ", ".join(f"{name}{value}" for name, value in names.items() if value)),
        ("pair", f"{pair}, {attrs['flank']} flanks"),
        ("misalignment", misaligned),
        ("deflections", str(attrs.get("deflections", ""))),
        ("supports", supports_words(tree)),
        ("deviating flanks", deviations(attrs)),
        ("modified ease-off", modification(attrs)),
        ("common flank", f"{shared}, ease-off up to {numbers['max_ease_off'].item():.1f} um"),
        ("backlash", backlash_words(tree)),
        ("model", model_name(attrs)),
        ("solver", solver),
    ]
    return [(name, words) for name, words in head if words]


def result_notes(tree: xr.DataTree) -> list[str]:
    """Notes on the reliability of the numbers."""
    notes = [*executed_settings(tree), *uncertified(tree), *doubts(tree)]
    if tree.attrs["opposite_flanks"] != "given":
        notes.append(
            "Note: the case does not describe all four flanks; the missing ones were assumed to have the same "
            "settings, which affects the tooth thickness only."
        )
    return notes


def result_summary(tree: xr.DataTree) -> str:
    """Summary of a result of ``analyze`` or ``read_result``."""
    tree = in_memory(tree)
    attrs, numbers = tree.attrs, key_numbers(tree)
    parts = [underlined(attrs["title"]), aligned(head_rows(tree))]
    parts += [table.text() for table in (*deflection_tables(tree), *supports_tables(tree))]
    parts += ["Without load", unloaded_table(numbers)]
    parts += ["Under load", loaded_table(numbers, tree["loaded"].sizes["mesh_position"])]
    if "friction" in tree.children:
        friction = tree["friction"].to_dataset()
        fed_back = ", fed back to the forces" if "energy_balance" in friction else ""
        from ...friction.operation import named_models

        name = f"Friction{fed_back}: {named_models(friction.attrs)}"
        parts += [name, efficiencies(friction), *(table.text() for table in contact_temperatures(friction))]
    return summary_text(parts, result_notes(tree))
