"""Tables of the contact in a result's summary: without load, and under load with a column a torque."""

from __future__ import annotations

import math
import textwrap

import xarray as xr
from tabulate import tabulate

from ....contact.evaluation.pressure_map import LineEnd
from ..key_numbers import PATTERN

WIDTH = 100  # [characters] of the text
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
    """Whether edges beside the contact lines carry: a pair is then in contact longer than it has contact lines."""
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
    """Where the contact line of the greatest pressure ends, as text."""
    end = LineEnd(int(value))
    return "-" if end == LineEnd.UNKNOWN else end.name.lower().replace("_", " ")


def loaded_table(numbers: xr.Dataset, positions: int) -> str:
    """Table of the loaded contact, a column a torque, in as many parts as the width asks for."""
    rows, torques = _loaded_rows(numbers, positions), numbers["torque"].values
    parts = []
    for first in range(0, torques.size, COLUMN_COUNT_LIMIT):
        here = slice(first, first + COLUMN_COUNT_LIMIT)
        headers = ["torque at the pinion [N m]", *(f"{torque:g}" for torque in torques[here])]
        body = [(name, *texts[here]) for name, texts in rows]
        aligned = ("left", *("right",) * (len(headers) - 1))
        parts.append(tabulate(body, headers=headers, disable_numparse=True, colalign=aligned, preserve_whitespace=True))
    return "\n\n".join(parts)
