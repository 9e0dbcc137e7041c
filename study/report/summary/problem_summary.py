"""Summary of a file of contact problems: what they are of, how many, how large, and their names."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import xarray as xr

from ....contact.problem.exchange.problem_file import FORMAT, read_attributes, read_labels, read_problems
from ....core.errors import printable, shortened

#: Attributes that a summary names, in words, and the longest text of one.
WORDS = {
    "title": "title",
    "case_name": "case",
    "flank": "flank",
    "compliance_model": "elastic teeth",
    "library_version": "library version",
    "checksum": "checksum of the content",
    "easeoff_version": "made by easeoff",
}
#: Attributes of the assembly errors, with letter, factor and unit.
MISALIGNMENT = {
    "misalignment_offset_mm": ("E", 1.0, "mm"),
    "misalignment_pinion_axial_mm": ("P", 1.0, "mm"),
    "misalignment_gear_axial_mm": ("G", 1.0, "mm"),
    "misalignment_shaft_angle_rad": ("Sigma", 180.0 / np.pi, "deg"),
}
TEXT_LIMIT = 100


def holds_problems(dataset: xr.Dataset) -> bool:
    """Whether a dataset is that of a file of contact problems."""
    return str(dataset.attrs.get("format", "")) == FORMAT


def problem_summary(path: Path) -> str:
    """Lines that say what a file of contact problems holds.

    Raises
    ------
    InputError
        If the file cannot be read.

    Examples
    --------
    >>> from tempfile import TemporaryDirectory
    >>> from easeoff.contact import ContactProblem, write_problems
    >>> problem = ContactProblem(np.zeros(2), np.full(2, 40.0), 8.0e4, np.diag([1e-6, 1e-6]))
    >>> with TemporaryDirectory() as folder:
    ...     write_problems([problem], Path(folder, "one.nc"), {"name": ["springs"]})
    ...     print(problem_summary(Path(folder, "one.nc")))
    1 contact problem of 2 segments, compliance: dense matrix
    torque about the gear axis  80 N m
    names                       springs
    """
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
    if not all(name in attributes for name in MISALIGNMENT):
        return ""
    found = [
        f"{letter} {float(attributes[name]) * factor:g} {unit}"
        for name, (letter, factor, unit) in MISALIGNMENT.items()
        if isinstance(attributes[name], int | float | np.number) and attributes[name]
    ]
    return ", ".join(found) or "none"


def _text(value: Any) -> str:
    return shortened(printable(str(value)), TEXT_LIMIT)


def _range(values: Any) -> str:
    least, most = float(np.min(values)), float(np.max(values))
    return f"{least:g}" if least == most else f"{least:g} to {most:g}"
