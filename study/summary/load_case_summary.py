"""Summary of an analysis over load cases: a row a load case, means over the duty cycle, and notes.

Summary of a file of contact problems: what they are of, how many, how large, and their names.
"""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np
import xarray as xr

from ...core.errors import printable, shortened
from .assembly import ERRORS, error_values
from .plausibility import doubts, executed_settings
from .quantities import FRICTION, LOADED, ROOT_STRESS, TABLES, Quantity
from .result_summary import uncertified
from .table import Table, summary_text, underlined

#: What load cases are, and their main numbers, by their variables.
INPUTS = {
    "torque": Quantity("torque", "N m", "g", column="torque\nN m"),
    **{f"misalignment_{error.name}": error.quantity("+.4g") for error in ERRORS},
    "speed": Quantity("speed", "1/min", ".4g", column="speed\n1/min"),
    "share": Quantity("share", "%", ".4g", 100.0, "share\n%"),
}
RESULTS = {
    **{name: LOADED[name] for name in ("peak_to_peak", "contact_ratio", "pattern_centre_lengthwise", "pattern_length")},
    **{"max_pressure": LOADED["max_pressure"], "max_root_stress": ROOT_STRESS},
    **{name: FRICTION[name] for name in ("mean_power_loss", "efficiency")},
}


def load_case_summary(tree: xr.DataTree) -> str:
    """Summary of an analysis over load cases."""
    tables = load_case_tables(tree["load_cases"].to_dataset())
    parts = [underlined(str(tree.attrs["title"])), *(table.text() for table in tables)]
    if "duty" in tree.children:
        parts.append(duty_lines(tree["duty"].to_dataset()))
    return summary_text(parts, load_case_notes(tree))


def load_case_tables(numbers: xr.Dataset) -> list[Table]:
    """Tables of what the load cases are, and of their main numbers, a row a load case."""
    return [_table(numbers, ("load_case", "flank"), INPUTS), _table(numbers, ("load_case",), RESULTS)]


def _table(numbers: xr.Dataset, names: tuple[str, ...], quantities: Mapping[str, Quantity]) -> Table:
    """Names of the load cases, then those of the numbers that one of them has."""
    known = [name for name in quantities if name in numbers and not np.all(np.isnan(numbers[name].values))]
    columns = [[str(one) for one in numbers[name].values] for name in names]
    columns += [[quantities[name].written(value) for value in _greatest(numbers[name])] for name in known]
    return Table(
        [*(name.replace("_", " ") for name in names), *(quantities[name] for name in known)],
        list(zip(*columns, strict=True)),
        len(names),
        variables=tuple(f"load_cases/{name}" for name in (*names, *known)),
        form="plain",
    )


def _greatest(variable: xr.DataArray) -> Any:
    """Values over the load cases: of both members the greater one."""
    others = [name for name in variable.dims if name != "load_case"]
    return variable.max(others).values


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
    """Reasons why load cases are not analysed or not certified, and the notes on each, with its name before them."""
    numbers = tree["load_cases"].to_dataset()
    notes = executed_settings(tree)
    for name, reason in zip(numbers["load_case"].values, numbers["reason"].values, strict=True):
        if str(reason):
            notes.append(f"{name}: not analysed: {reason}")
            continue
        result = tree["results"].children[str(name)]
        notes += [f"{name}: {note}" for note in (*uncertified(result), *doubts(result))]
    return notes


#: Attributes that a summary names, in words, and the longest text of one.
WORDS: dict[str, str] = TABLES["problem_words"]
TEXT_LIMIT = 100


def holds_problems(dataset: xr.Dataset) -> bool:
    """True if a dataset is that of a file of contact problems."""
    if "format" not in dataset.attrs:  # no result has one
        return False
    from ...contact.problem.exchange.problem_file import FORMAT

    return str(dataset.attrs["format"]) == FORMAT


def problem_summary(path: Path) -> str:
    """Content of a file of contact problems, in lines."""
    from ...contact.problem.exchange.problem_file import read_attributes, read_labels, read_problems

    problems, labels, attributes = read_problems(path), read_labels(path), read_attributes(path)
    count, sizes = len(problems), [problem.size for problem in problems]
    structured = sum(problem.is_structured for problem in problems)
    forms = {0: "dense matrix", count: "diagonal + columns"}
    form = forms.get(structured, f"diagonal + columns in {structured}, dense matrix in {count - structured}")
    head = f"{count} contact problem{'' if count == 1 else 's'} of {_range(sizes)} segments, compliance: {form}"
    rows = [(word, _text(attributes[name])) for name, word in WORDS.items() if name in attributes]
    errors = _misalignment(attributes)
    rows += [("misalignment", errors)] if errors else []
    if "pinion_torque" in labels:
        rows.append(("torque at the pinion", f"{_range(labels['pinion_torque'])} N m"))
    rows.append(("torque about the gear axis", f"{_range([1e-3 * problem.torque for problem in problems])} N m"))
    if "kind" in labels:
        kinds, numbers = np.unique(labels["kind"].astype(str), return_counts=True)
        rows.append(
            ("kinds", ", ".join(f"{_text(kind)} {number}" for kind, number in zip(kinds, numbers, strict=True)))
        )
    if "name" in labels:
        names = [_text(name) for name in labels["name"]]
        rows.append(("names", names[0] if count == 1 else f"{names[0]} to {names[-1]}"))
    width = max(len(word) for word, _ in rows)
    return "\n".join([head, *(f"{word:<{width}}  {said}" for word, said in rows)])


def _misalignment(attributes: dict[str, Any]) -> str:
    """Assembly errors in words; empty if the file does not tell them."""
    if "deflections" in attributes:
        return _text(attributes["deflections"])
    known = {key: value for key, value in attributes.items() if isinstance(value, int | float | np.number)}
    if not all(error.attribute in attributes for error in ERRORS):
        return ""
    return ", ".join(error.words(value, "g") for error, value in error_values(known).items() if value) or "none"


def _text(value: Any) -> str:
    return shortened(printable(str(value)), TEXT_LIMIT)


def _range(values: Any) -> str:
    least, most = float(np.min(values)), float(np.max(values))
    return f"{least:g}" if least == most else f"{least:g} to {most:g}"
