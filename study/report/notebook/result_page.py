"""Short summary of a result as HTML, for a notebook."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import xarray as xr

from ....core.netcdf_file import in_memory
from ..contact_report.report_tables import loaded_numbers, misalignment_rows, supports_rows
from ..key_numbers import key_numbers
from ..summary.contact_tables import unloaded_rows
from ..summary.load_case_summary import input_columns, load_case_notes, result_columns
from ..summary.result_summary import CLAMPED_NOTE, ROUGH_NOTE, head_rows, is_rough, result_notes
from .html_table import html_table, html_text

TORQUE_COUNT_LIMIT = 8  # side by side
ROW_COUNT_LIMIT = 12  # operating conditions of friction, or load cases
#: Numbers of the loaded contact that are shown, by the variable that the report names; the rest are in the text.
SHOWN_NUMBERS = (
    "loaded/mean_level",
    "loaded/peak_to_peak",
    "loaded/mean_mesh_stiffness",
    "loaded/contact_ratio",
    "loaded/max_load_share",
    "loaded/edge_share",
    "loaded/pattern_centre_lengthwise",
    "loaded/pattern_centre_profile",
    "loaded/pattern_length",
    "loaded/pattern_height",
    "loaded/max_pressure",
    "loaded/max_pressure_lengthwise",
    "loaded/max_pressure_profile",
    "loaded/max_pressure_line_end",
    "root_stress/max_root_stress",
    "loaded/status",
)

MISALIGNMENT = ("torque [N m]", "E [mm]", "P [mm]", "G [mm]", "Sigma [°]")
#: Heads of the columns of friction: operating conditions, then numbers with their variable, factor and formats, the
#: usual one, and that where much of the loss is outside the range of the friction formula.
CONDITIONS = {"torque": "torque [N m]", "speed": "speed [1/min]", "temperature": "oil [°C]", "roughness": "Rq [µm]"}
FRICTION = {
    "friction coefficient": ("mean_friction_coefficient", 1.0, (".4f", ".3f")),
    "power loss [W]": ("mean_power_loss", 1.0, (".1f", ".0f")),
    "efficiency [%]": ("efficiency", 100.0, (".2f", ".1f")),
    "least film [µm]": ("min_film_thickness", 1.0, (".3f", ".3f")),
    "greatest flash temperature [K]": ("max_flash_temperature", 1.0, (".0f", ".0f")),
}


def result_page(tree: xr.DataTree) -> str:
    """Short summary of a result: pair, contact under load, friction and notes, in HTML without a style of its own.

    Parameters
    ----------
    tree
        A result.

    Examples
    --------
    >>> import easeoff
    >>> "greatest pressure [MPa]" in result_page(easeoff.analyze("nasa-12x36", torques=[100.0]))
    True
    """
    tree = in_memory(tree)
    parts = [f"<h4>{html_text(tree.attrs['title'])}</h4>"]
    if "load_cases" in tree.children:
        numbers = tree["load_cases"].to_dataset()
        for columns in (input_columns(numbers), result_columns(numbers)):
            rows = list(zip(*columns.values(), strict=True))
            heads = [head.replace("\n", " ") for head in columns]
            parts += [html_table(heads, rows[:ROW_COUNT_LIMIT]), _left(len(rows), "load_cases")]
        notes = load_case_notes(tree)
    else:
        parts.append(html_table([], [list(row) for row in head_rows(tree)]))
        parts += [*_assembly(tree), "<p><b>Without load</b></p>"]
        parts.append(html_table([], [[name.strip(), words] for name, words in unloaded_rows(key_numbers(tree))]))
        parts += ["<p><b>Under load</b></p>", _loaded(tree), *_friction(tree)]
        notes = result_notes(tree)
    if notes:
        told = "".join(f"<li>{html_text(note.removeprefix('Note: '))}</li>" for note in notes)
        word = "note" if len(notes) == 1 else "notes"
        parts.append(f"<details open><summary>{len(notes)} {word}</summary><ul>{told}</ul></details>")
    return "<div>\n" + "\n".join(part for part in parts if part) + "\n</div>"


def _loaded(tree: xr.DataTree) -> str:
    """Table of the contact under load, a column a torque."""
    numbers = loaded_numbers(tree)
    torques = numbers["torques"][:TORQUE_COUNT_LIMIT]
    rows = [
        [f"{name} [{unit}]" if unit else name, *values[:TORQUE_COUNT_LIMIT]]
        for name, unit, variable, *values in numbers["rows"]
        if variable in SHOWN_NUMBERS
    ]
    left = _left(len(numbers["torques"]), "loaded", TORQUE_COUNT_LIMIT)
    return html_table(["torque at the pinion [N m]", *torques], rows) + left


def _assembly(tree: xr.DataTree) -> list[str]:
    """Tables of the misalignment over the torque, and of the supports, if the result has them."""
    parts = []
    if rows := misalignment_rows(tree):
        parts.append(
            _titled("Misalignment over the torque, mean over the mesh cycle", MISALIGNMENT, rows, "misalignment")
        )
    for table in supports_rows(tree):
        parts.append(_titled(table["title"], table["heads"], table["rows"], "supports"))
    return parts


def _titled(title: str, heads: Sequence[str], rows: Sequence[Sequence[str]], name: str) -> str:
    """A table under its title."""
    return f"<p><b>{html_text(title)}</b></p>" + html_table(heads, rows[:ROW_COUNT_LIMIT]) + _left(len(rows), name)


def _friction(tree: xr.DataTree) -> list[str]:
    """Table of friction and efficiency, a row an operating condition, if the result has it."""
    if "friction" not in tree.children:
        return []
    friction = tree["friction"].to_dataset()
    names = tuple(CONDITIONS)
    shown = {head: row for head, row in FRICTION.items() if row[0] in friction}
    values = {head: factor * friction[name].transpose(*names).values for head, (name, factor, _) in shown.items()}
    conditions = list(np.ndindex(*(friction.sizes[name] for name in names)))
    rough, clamped = is_rough(friction), friction["temperature_clamped"].values
    rows = []
    for at in conditions[:ROW_COUNT_LIMIT]:
        words = [f"{friction[name].values[i]:g}" for name, i in zip(names, at, strict=True)]
        words[2] += "*" if clamped[at[2]] else ""
        rows.append(words + [format(values[head][at], forms[int(rough[at])]) for head, (_, _, forms) in shown.items()])
    notes = [ROUGH_NOTE] * bool(rough.any()) + [CLAMPED_NOTE] * bool(clamped.any())
    told = [f"<p>{html_text(note)}</p>" for note in notes]
    return [html_table([*CONDITIONS.values(), *shown], rows), _left(len(conditions), "friction"), *told]


def _left(count: int, name: str, limit: int = ROW_COUNT_LIMIT) -> str:
    """How many rows or columns of a table are not shown, and where they are."""
    return (
        f"<p>and {count - limit} more: <code>summary().tables[&quot;{name}&quot;]</code></p>" if count > limit else ""
    )
