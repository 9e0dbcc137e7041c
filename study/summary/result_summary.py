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
from ...core.netcdf_file import in_memory
from ..analysis.key_numbers import deviations, key_numbers, model_name, modification
from ..result_layout import PATTERN
from .deflection_report import deflection_notes, deflection_tables, misalignment_over_torque, misalignment_words
from .plausibility import (
    edge_notes,
    end_notes,
    executed_settings,
    jump_notes,
    plausibility,
    range_notes,
    supports_notes,
)
from .supports_report import added_notes, supports_tables, supports_words
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

    def row(
        name: str, words: str, *variables: str, factor: float = 1.0, missing: str | None = None
    ) -> tuple[str, list[str]]:
        if any(variable not in numbers for variable in variables):
            return name, []
        values = zip(*(factor * numbers[variable].values for variable in variables), strict=True)
        return name, [missing if missing and any(map(math.isnan, each)) else words.format(*each) for each in values]

    rows = [
        row("transmission error, mean [urad]", "{:.1f}", "mean_level"),
        row("  peak to peak", "{:.2f}", "peak_to_peak"),
        *(
            (f"  harmonic {order}", [f"{value:.2f}" for value in numbers["harmonic"].sel(order=order).values])
            for order in numbers["order"].values
        ),
        row("  of the pinion, mean", "{:.1f}", "pinion_mean_level"),
        row("  of the pinion, peak to peak", "{:.2f}", "pinion_peak_to_peak"),
        row("mesh stiffness, mean [N m/urad]", "{:.3f}", "mean_mesh_stiffness"),
        row("contact ratio, with edges" if with_edges(numbers) else "contact ratio", "{:.2f}", "contact_ratio"),
        row("greatest share of a pair [%]", "{:.1f}", "max_load_share", factor=100.0),
        row("share on edges up to [%]", "{:.1f}", "max_edge_share", factor=100.0),
        row("pattern, centre from toe, root [%]", "{:.0f}, {:.0f}", *PATTERN[:2], factor=100.0, missing=NO_AREA),
        row("  length, height [%]", "{:.0f}, {:.0f}", *PATTERN[2:], factor=100.0, missing=NO_AREA),
        row("greatest pressure [MPa]", "{:.0f}", "max_pressure", missing="-"),
        row(
            "  from toe, root [%]",
            "{:.0f}, {:.0f}",
            *(f"max_pressure_{n}" for n in FRACTIONS),
            factor=100.0,
            missing="-",
        ),
        row("  mesh position, pair", "{:.2f}, {:.0f}", "max_pressure_position", "max_pressure_pair", missing="-"),
    ]
    if "max_pressure_line_end" in numbers:
        ends = [end_name(value) for value in numbers["max_pressure_line_end"].values]
        rows.append(("  inside, or where its line ends", ends))
    if "max_root_stress" in numbers:
        for member in numbers["member"].values:
            values = numbers["max_root_stress"].sel(member=member).values
            rows.append((f"greatest root stress, {member} [MPa]", [f"{value:.0f}" for value in values]))
    rows.append(row("certified mesh positions", f"{{:.0f}} of {positions}", "certified_positions"))
    rows.append(row("worst residual", "{:.0e}", "worst_certificate"))
    return [(name, texts) for name, texts in rows if texts]


def end_name(value: int) -> str:
    """End of the contact line at which the greatest pressure is, as text."""
    end = LineEnd(int(value))
    return "-" if end == LineEnd.UNKNOWN else end.name.lower().replace("_", " ")


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
CONDITIONS = ("torque\nN m", "speed\n1/min", "oil\ndegC", "Rq\num")
#: Torques that the outcome names; of more it names the range.
TORQUE_COUNT_LIMIT = 8


def efficiencies(friction: xr.Dataset) -> str:
    """Table of power loss and efficiency, a row an operating condition, with the extremes if there are many."""
    names = ("torque", "speed", "temperature", "roughness")
    films = _with_place(friction, names, "min_film", "thickness", 3)
    values = [friction[n].transpose(*names).values for n in ("efficiency", "mean_power_loss", "mean_rolling_loss")]
    coefficient = friction["mean_friction_coefficient"].transpose(*names).values
    beyond = is_rough(friction)
    rows = []
    for at in np.ndindex(coefficient.shape):
        efficiency, loss, rolling = (v[at] for v in values)
        conditions = _conditions(friction, names, at)
        share = 100.0 * rolling / loss if loss else np.nan
        digits = (3, 0, 0, 1) if beyond[at] else (4, 1, 1, 2)
        values_of = (coefficient[at], loss, share, 100 * efficiency)
        cells = tuple(f"{value:.{count}f}" for value, count in zip(values_of, digits, strict=True))
        rows.append((*conditions, *cells, *films.get(at, ())))
    headers = [
        *CONDITIONS,
        "mean\nmu",
        "power\nloss W",
        "rolling\npart %",
        "efficiency\n%",
        *(["least\nfilm um", "at toe,\nroot %"] if films else []),
    ]
    notes = [ROUGH_NOTE] * bool(np.any(beyond)) + [CLAMPED_NOTE] * bool(np.any(friction["temperature_clamped"].values))
    table = Table(headers, rows, 0, note="\n".join(notes), group="friction").text()
    if len(rows) > ROW_COUNT_LIMIT:
        known = sorted((row for row in rows if row[7] != "nan"), key=lambda row: float(row[7]))
        for word, row in zip(("least", "greatest"), known[:1] + known[-1:], strict=False):
            table += f"\n{word} efficiency: {row[7]} % at {row[0]} N m, {row[1]} 1/min, {row[2]} degC, {row[3]} um"
    return table


def is_rough(friction: xr.Dataset) -> NDArray[np.bool_]:
    """True where much of the power loss is outside the range of the formula, over the operating conditions."""
    names = ("torque", "speed", "temperature", "roughness")
    if "extrapolated_share" not in friction:
        return np.zeros([friction.sizes[name] for name in names], dtype=bool)
    rough: NDArray[np.bool_] = np.nan_to_num(friction["extrapolated_share"].transpose(*names).values) >= ROUGH_SHARE
    return rough


def contact_temperatures(friction: xr.Dataset) -> str:
    """Table of the greatest flash temperatures, a row an operating condition; empty if the result has none."""
    names = ("torque", "speed", "temperature", "roughness")
    flash = _with_place(friction, names, "max_flash", "temperature", 1)
    if not flash:
        return ""
    whole, product = (
        friction[name].transpose(*names).values for name in ("max_contact_temperature", "max_pressure_velocity")
    )
    rows = [
        (*_conditions(friction, names, at), rise, f"{whole[at]:.1f}", place, f"{product[at]:.0f}")
        for at, (rise, place) in flash.items()
    ]
    heads = [*CONDITIONS, "flash\nK", "contact\ndegC", "at toe,\nroot %", "greatest p v\nMPa m/s"]
    return Table(heads, rows, 0, "Contact temperature", group="friction").text()


def _conditions(friction: xr.Dataset, names: tuple[str, ...], at: tuple[int, ...]) -> list[str]:
    """Operating condition in words: torque, speed, temperature and roughness."""
    words = [f"{friction[name].values[i]:g}" for name, i in zip(names, at, strict=True)]
    rough = [friction[f"roughness_{member}"].values[at[3]] for member in ("pinion", "gear")]
    words[2] += "*" if friction["temperature_clamped"].values[at[2]] else ""
    words[3] = f"{rough[0]:g}" if rough[0] == rough[1] else f"{rough[0]:g}/{rough[1]:g}"
    return words


def _with_place(
    friction: xr.Dataset, names: tuple[str, ...], extreme: str, quantity: str, digits: int
) -> dict[tuple[int, ...], tuple[str, str]]:
    """An extreme over the mesh cycle and its place by operating condition; empty if the result has none."""
    variables = [f"{extreme}_{name}" for name in (quantity, "lengthwise", "profile")]
    if variables[0] not in friction:
        return {}
    whole = [friction[n].transpose(*names).values for n in variables]
    return {
        at: (f"{whole[0][at]:.{digits}f}", f"{100 * whole[1][at]:.0f}, {100 * whole[2][at]:.0f}")
        for at in np.ndindex(whole[0].shape)
    }


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


def doubts(tree: xr.DataTree) -> list[str]:
    """Notes on implausible numbers, extrapolation, supports, edges and line ends, pressures that jump, and friction."""
    ranges = range_notes(tree["friction"].to_dataset()) if "friction" in tree.children else []
    loaded = tree["loaded"].to_dataset()
    contact = [*edge_notes(loaded), *end_notes(loaded), *jump_notes(loaded)]
    supported = [*added_notes(tree), *deflection_notes(tree), *supports_notes(tree)]
    return [*plausibility(tree), *supported, *contact, *_searched(loaded), *ranges]


def _searched(loaded: xr.Dataset) -> list[str]:
    """Note on segments whose closest approach was searched for."""
    searched = int(loaded.attrs.get("searched_segments", 0))  # older results lack the attribute
    if not searched:
        return []
    lines = int((loaded["length"].notnull() & loaded["overhang"].isnull()).sum(["mesh_position", "segment"]).max())
    return [
        f"Note: at {searched} of {lines} segments the curvature of the flanks changes so quickly that the closest "
        "approach was searched for; forces and pressures there are approximate."
    ]


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
    head = [
        ("pair", f"{pair}, {attrs['flank']} flanks"),
        ("misalignment", misaligned),
        ("deflections", str(attrs.get("deflections", ""))),
        ("supports", supports_words(tree)),
        ("deviating flanks", deviations(attrs)),
        ("modified ease-off", modification(attrs)),
        ("common flank", f"{shared}, ease-off up to {numbers['max_ease_off'].item():.1f} um"),
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
        parts += [name, efficiencies(friction)]
        if temperatures := contact_temperatures(friction):
            parts.append(temperatures)
    return summary_text(parts, result_notes(tree))
