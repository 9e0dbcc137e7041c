"""Comparison report in Markdown: what each solver claimed and what held, run times, residuals, failures, versions."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import xarray as xr

from ....core.checks import shown
from ....core.errors import InputError
from ....core.output_file import whole_file
from ....core.regular_file import parsed_json
from ..statistics.method_statistics import MethodName, by_problem, methods
from ..statistics.work_precision import has_sweep
from .answer_tables import failure_table, kind_table, residual_tables, success_note, success_tables
from .report_table import ReportTable
from .time_tables import (
    LARGEST_SIZE_STEP,
    SIZE_SPAN_MINIMUM,
    growth_table,
    own_polish_note,
    pair_table,
    run_time_summary,
    size_groups,
    start_table,
    time_parts,
    time_sources,
    waiting_note,
    work_precision_tables,
)

#: Folder of the tables beside the report.
TABLE_FOLDER = "tables"
NO_GROWTH = (
    "Neither tabulated nor drawn: no kind of problem has three sizes or more that span a factor of "
    f"{SIZE_SPAN_MINIMUM:g}, each within a factor of {LARGEST_SIZE_STEP:g} of the next.\n"
)


@dataclass(frozen=True)
class Picture:
    """A picture of the report.

    Attributes
    ----------
    section
        Heading under which it stands.
    file
        Its PNG file, from the folder of the report.
    caption
        Line below it.
    """

    section: str
    file: str
    caption: str


@dataclass(frozen=True, eq=False)
class Section:
    """A section of the report: a heading, then tables and texts in their order."""

    heading: str
    parts: Sequence[ReportTable | str | None]


def report_sections(dataset: xr.Dataset) -> list[Section]:
    """Sections of the report, without those that have nothing to tell."""
    problems = by_problem(dataset)
    named = methods(problems, float(dataset.attrs["time_limit_s"]))
    failures = failure_table(dataset, named)
    sections = [
        Section(
            "Answers", [*success_tables(dataset, problems, named), success_note(dataset), kind_table(problems, named)]
        ),
        Section("Run time", [_paragraph(waiting_note(dataset)), run_time_summary(dataset, problems, named)]),
        Section("Parts of the run time", [time_parts(problems, named, time_sources(dataset, named))]),
        Section("Cold and warm starts", [start_table(problems, named)]),
        Section("Pairs of solvers", [pair_table(problems, named)]),
        Section("Work and precision", _work_and_precision(dataset, named)),
        Section("Growth", [growth_table(problems, named) if size_groups(problems) else NO_GROWTH]),
        Section("Residuals", residual_tables(dataset, named)),
        Section("Failures", [failures if failures is not None else "None: every attempt is certified.\n"]),
        Section("Made with", [_made_with(dataset)]),
    ]
    return [section for section in sections if any(part is not None for part in section.parts)]


def _work_and_precision(dataset: xr.Dataset, named: list[MethodName]) -> list[ReportTable | str | None]:
    return [*work_precision_tables(dataset, named), own_polish_note(named)] if has_sweep(dataset) else []


def comparison_report(dataset: xr.Dataset, pictures: Sequence[Picture] = ()) -> str:
    """Report of a comparison, in Markdown.

    Parameters
    ----------
    dataset
        Result of ``compare``.
    pictures
        The pictures.
    """
    lines = ["# Comparison of solvers\n", _subject(dataset, by_problem(dataset))]
    for section in report_sections(dataset):
        lines.append(f"## {section.heading}\n")
        lines += [f"![{one.caption}]({one.file})\n" for one in pictures if one.section == section.heading]
        lines += [
            part.markdown if isinstance(part, ReportTable) else part for part in section.parts if part is not None
        ]
    return "\n".join(lines)


def write_report(dataset: xr.Dataset, folder: Path, pictures: Sequence[Picture] = ()) -> list[Path]:
    """Write the report as ``report.md``, and its tables as CSV and LaTeX; returns their paths, the report first."""
    path = folder / "report.md"
    with whole_file(path) as temporary:
        temporary.write_text(comparison_report(dataset, pictures), encoding="utf-8")
    tables = [part for section in report_sections(dataset) for part in section.parts if isinstance(part, ReportTable)]
    return [path, *(written for table in tables for written in table.write(folder / TABLE_FOLDER))]


def _subject(dataset: xr.Dataset, problems: Any) -> str:
    unique = problems.drop_duplicates(["problem_file", "problem"])
    sizes = unique["size"]
    lines = [
        f"- {len(group)} contact problems of `{file}`, {_range(group['size'])} segments"
        for file, group in unique.groupby("problem_file", sort=False)
    ]
    lines.append(
        f"- In all {len(unique)} problems, {_range(sizes)} segments, {_count(dataset.sizes['attempt'], 'attempt')}"
    )
    return "\n".join(lines) + "\n"


def _made_with(dataset: xr.Dataset) -> str:
    machine, versions = (_table_of(dataset, name) for name in ("machine", "solver_versions"))
    rows = [*machine.items(), *((f"solver `{solver}`", version) for solver, version in versions.items())]
    table = ReportTable("made_with", ["what", "which"], rows)
    return (
        f"{table.markdown}\nA process for each solver, up to {dataset.attrs['repetitions']} repetitions, time limit "
        f"{dataset.attrs['time_limit_s']:g} s an attempt. Each call gets the separations and the torque multiplied by "
        "another factor between 1 and 1.5 (`load_factor`), so that an answer kept from an earlier call is wrong. "
        "`native` is measured with its own answer alone, and is the reference of the error of rotation.\n"
    )


def _paragraph(text: str | None) -> str | None:
    return None if text is None else f"**{text}**\n"


def _table_of(dataset: xr.Dataset, name: str) -> dict[str, Any]:
    """Table in an attribute, as JSON; InputError if it holds none."""
    try:
        table = parsed_json(str(dataset.attrs.get(name, "{}")))
    except ValueError:
        table = None
    if not isinstance(table, dict):
        raise InputError(f"attribute {name} = {shown(dataset.attrs[name])}: must be a table in JSON")
    return table


def _range(sizes: Any) -> str:
    low, high = int(sizes.min()), int(sizes.max())
    return f"{low}" if low == high else f"{low} to {high}"


def _count(number: int, what: str) -> str:
    return f"{number} {what}" if number == 1 else f"{number} {what}s"
