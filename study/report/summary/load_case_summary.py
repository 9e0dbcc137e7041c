"""Summary of an analysis over load cases: a row a load case, means over the duty cycle, and notes."""

from __future__ import annotations

import textwrap
from typing import Any

import numpy as np
import xarray as xr
from tabulate import tabulate

from ..notes.executed_settings import executed_settings
from .contact_tables import WIDTH
from .result_summary import doubts, uncertified

ERRORS = {
    "E\nmm": ("misalignment_offset", 1.0),
    "P\nmm": ("misalignment_pinion_axial", 1.0),
    "G\nmm": ("misalignment_gear_axial", 1.0),
    "Sigma\ndeg": ("misalignment_shaft_angle", 180.0 / np.pi),
}
OPERATION = {"speed\n1/min": ("speed", 1.0), "share\n%": ("share", 100.0)}
RESULTS = {
    "peak to\npeak urad": ("peak_to_peak", "{:.2f}", 1.0),
    "contact\nratio": ("contact_ratio", "{:.2f}", 1.0),
    "pattern at\ntoe %": ("pattern_centre_lengthwise", "{:.0f}", 100.0),
    "length\n%": ("pattern_length", "{:.0f}", 100.0),
    "pressure\nMPa": ("max_pressure", "{:.0f}", 1.0),
    "root stress\nMPa": ("max_root_stress", "{:.0f}", 1.0),
    "power\nloss W": ("mean_power_loss", "{:.1f}", 1.0),
    "efficiency\n%": ("efficiency", "{:.2f}", 100.0),
}


def load_case_summary(tree: xr.DataTree) -> str:
    """Summary of an analysis over load cases.

    Parameters
    ----------
    tree
        A result of ``analyze_load_cases`` or ``read_result``.

    Examples
    --------
    >>> from easeoff.cases import LoadCase, read_case
    >>> from easeoff.study import analyze_load_cases
    >>> case = read_case("nasa-12x36")
    >>> case = case.model_copy(update={"contact": case.contact.model_copy(update={"mesh_positions": 3})})
    >>> tree = analyze_load_cases(case, [LoadCase(name="climb", torque=100.0)])
    >>> load_case_summary(tree).splitlines()[3].split()[:4]
    ['load', 'case', 'flank', 'torque']
    """
    numbers = tree["load_cases"].to_dataset()
    title = textwrap.wrap(str(tree.attrs["title"]), WIDTH) or ["untitled"]
    parts = [
        "\n".join(title),
        "=" * max(map(len, title)),
        "",
        _table(input_columns(numbers)),
        "",
        _table(result_columns(numbers)),
    ]
    if "duty" in tree.children:
        parts += ["", duty_lines(tree["duty"].to_dataset())]
    notes = load_case_notes(tree)
    return "\n".join([*parts, *(["", *(textwrap.fill(note, WIDTH) for note in notes)] if notes else [])])


def input_columns(numbers: xr.Dataset) -> dict[str, list[str]]:
    """Columns by head of what the load cases are: flank, torque, misalignment, speed and share."""
    columns: dict[str, list[str]] = {
        "load case": [str(name) for name in numbers["load_case"].values],
        "flank": [str(name) for name in numbers["flank"].values],
        "torque\nN m": [f"{torque:g}" for torque in numbers["torque"].values],
        **{head: [f"{factor * v:+.4g}" for v in numbers[name].values] for head, (name, factor) in ERRORS.items()},
    }
    for head, (name, factor) in OPERATION.items():
        if name in numbers:
            columns[head] = [f"{factor * value:.4g}" for value in numbers[name].values]
    return columns


def variable_of(head: str) -> str:
    r"""Variable of the group ``load_cases`` that a column shows, by its head.

    >>> variable_of("load case"), variable_of("pressure\nMPa")
    ('load_case', 'max_pressure')
    """
    named = {**ERRORS, **OPERATION, **RESULTS}
    return str(named[head][0]) if head in named else head.partition("\n")[0].replace(" ", "_")


def result_columns(numbers: xr.Dataset) -> dict[str, list[str]]:
    """Columns by head of the main numbers of the load cases."""
    columns: dict[str, list[str]] = {"load case": [str(name) for name in numbers["load_case"].values]}
    for head, (name, words, factor) in RESULTS.items():
        if name in numbers and not np.all(np.isnan(numbers[name].values)):
            columns[head] = [
                "-" if np.isnan(value) else words.format(factor * value) for value in _greatest(numbers[name])
            ]
    return columns


def _greatest(variable: xr.DataArray) -> Any:
    """Values over the load cases: of both members the greater one."""
    others = [name for name in variable.dims if name != "load_case"]
    return variable.max(others).values


def _table(columns: dict[str, list[str]]) -> str:
    left = ("load case", "flank")
    return tabulate(
        list(zip(*columns.values(), strict=True)),
        headers=list(columns),
        tablefmt="plain",
        disable_numparse=True,
        colalign=tuple("left" if head in left else "right" for head in columns),
    )


def duty_lines(duty: xr.Dataset) -> str:
    """Means over a duty cycle, a line each."""
    lines = []
    if "duty_power_loss" in duty:
        loss, power, efficiency = (
            float(duty[name]) for name in ("duty_power_loss", "duty_input_power", "duty_efficiency")
        )
        said = f"power loss {loss:.1f} W of {power:.0f} W, efficiency {100.0 * efficiency:.2f} %"
        known = not np.isnan(efficiency)
        lines.append(f"mean over time: {said if known else 'unknown, as not every load case has a power loss'}")
    for flank in duty["flank"].values:
        torques = duty["equivalent_torque"].sel(flank=flank)
        said = ", ".join(
            f"{float(torque):.4g} N m (p = {float(exponent):.3g})"
            for torque, exponent in zip(torques.values, duty["damage_exponent"].values, strict=True)
        )
        lines.append(f"torque of equal damage, {flank} flanks: {said}")
    return "\n".join(lines)


def load_case_notes(tree: xr.DataTree) -> list[str]:
    """Why load cases could not be analysed or certified, and the notes on each, with its name before them."""
    numbers = tree["load_cases"].to_dataset()
    notes = executed_settings(tree)
    for name, reason in zip(numbers["load_case"].values, numbers["reason"].values, strict=True):
        if str(reason):
            notes.append(f"{name}: not analysed: {reason}")
            continue
        result = tree["results"].children[str(name)]
        notes += [f"{name}: {note}" for note in (*uncertified(result), *doubts(result))]
    return notes
