"""Run of a case over load cases, for the command ``run``."""

from __future__ import annotations

import sys
from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click
from click.core import ParameterSource

from .exit_codes import EXIT_UNCERTIFIED
from .options.analysis_options import check_cost, progress_bar, with_defaults
from .options.shared_options import echo, next_commands
from .result_commands import draw

if TYPE_CHECKING:
    from ...cases import Case, LoadCase

OF_THE_CASE = "case"  # instead of a file: the load cases of the case itself
SINGLE_CONDITIONS = ("temperature", "roughness")


def run_load_cases(
    case: Case,
    source: str,
    load_cases: str,
    output: Path,
    plots: Path | None,
    conditions: dict[str, Any],
    options: dict[str, Any],
) -> None:
    """Analyse a case over load cases, write the result, and show its table.

    Parameters
    ----------
    case, source
        The checked case, and its name or path.
    load_cases
        Path of a table of load cases, or ``case`` for those of the case.
    output, plots
        File of the result, and folder for pictures.
    conditions
        Conditions and models of friction, and thickness of the marking compound.
    options
        Of the analysis.
    """
    from ...cases import Deflections, read_load_cases
    from ...cases.analysis_size import AnalysisSize
    from ...core.output_file import check_writable
    from ..load_cases.load_case_analysis import analyze_load_cases
    from ..report.summary.load_case_summary import load_case_summary
    from ..result import write_result

    constant = None if isinstance(options["misalignment"], Deflections) else options["misalignment"]
    for name, value in (("--torque", options.pop("torques")), ("--misalignment", constant)):
        if value is not None:
            raise click.UsageError(f"{name}: must not go with --load-cases, which have their own")
    rows = None
    if load_cases != OF_THE_CASE:
        check_writable(output, source, load_cases, suffix=".nc")
        rows = read_load_cases(load_cases)
    elif not case.load_cases:
        raise click.UsageError("--load-cases = 'case': the case has no tables [[load_cases]]; give a file")
    _refuse_flank(rows or case.load_cases)
    torques = [row.torque for row in (rows or case.load_cases)]
    check_cost(case, AnalysisSize.of(case, 1))
    single = {name: conditions.pop(name) for name in SINGLE_CONDITIONS}
    for name, values in single.items():
        if values is not None and len(values) != 1:
            raise click.UsageError(f"--{name}: must be one value with --load-cases")
    given: dict[str, Any] = with_defaults(options) | conditions
    given |= {name: None if values is None else values[0] for name, values in single.items()}
    with progress_bar(case, torques) as shown:
        tree = analyze_load_cases(case, rows, **given, progress=shown.step, stage=shown.stage)
    write_result(tree, output)
    echo(load_case_summary(tree))
    echo(f"wrote {output}")
    if plots is not None:
        draw(tree, plots)
    next_commands(("show", output), *([] if plots is not None else [("plot", output, "FOLDER")]))
    if tree["load_cases"].to_dataset()["status"].values.any():
        sys.exit(EXIT_UNCERTIFIED)


def _refuse_flank(rows: Sequence[LoadCase]) -> None:
    """Refuse ``--flank`` beside load cases that name theirs."""
    given = click.get_current_context().get_parameter_source("flank") == ParameterSource.COMMANDLINE
    named = [at for at, row in enumerate(rows, start=1) if row.flank is not None]
    if given and named:
        raise click.UsageError(
            f"--flank: must not go with load cases that name their flank, as number {named[0]} does; change the table"
        )
