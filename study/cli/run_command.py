"""Command that analyses a case.

Run of a case over load cases, for the command ``run``.
"""

from __future__ import annotations

import sys
from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click
from click.core import ParameterSource

from .analysis_options import (
    analysis_options,
    check_cost,
    chosen_case,
    chosen_model,
    friction_options,
    progress_bar,
    with_defaults,
)
from .command import EXIT_UNCERTIFIED, Command, quick_start
from .result_commands import draw
from .shared_options import echo, marking, next_commands, refuse_name_of_output

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
    """Analyse a case over a table of load cases, or ``case`` for its own, write the result, and show its table."""
    from ...cases import Deflections, read_load_cases
    from ...cases.analysis_size import AnalysisSize
    from ...core.output_file import check_writable
    from ..load_case_analysis import analyze_load_cases
    from ..result import write_result
    from ..summary.load_case_summary import load_case_summary

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


@click.command(cls=Command)
@analysis_options
@click.option(
    "-o", "--output", type=click.Path(path_type=Path), required=True, metavar="FILE", help="netCDF file to write."
)
@click.option(
    "--plots", type=click.Path(path_type=Path, file_okay=False), metavar="FOLDER", help="Folder for pictures."
)
@click.option(
    "--marking",
    type=float,
    callback=marking,
    metavar="THICKNESS",
    show_default="contact.separation of the case",
    help="Thickness of the marking compound of the unloaded pattern in um.",
)
@click.option(
    "--load-cases",
    metavar="FILE|case",
    help="Analyse over load cases instead of torques, each in its own misalignment: those of a table with the columns "
    "torque, E, P, G, Sigma, speed, share, flank and name, or those of the case itself.",
)
@friction_options
def run(
    case: str,
    output: Path,
    plots: Path | None,
    marking: float | None,
    load_cases: str | None,
    supports: str | None,
    speed: Any,
    oil: str | None,
    temperature: Any,
    roughness: Any,
    friction_model: str | None,
    film_heating: str | None,
    clamp_temperature: bool | None,
    friction_feedback: bool | None,
    **options: Any,
) -> None:
    """Analyse the contact of CASE and write the result.

    The result holds unloaded and loaded contact, and friction and efficiency if a speed is given. With --load-cases it
    holds that of every load case, a table of the numbers of all, and means over their shares of time.
    """
    if load_cases is None:
        quick_start(alone=options["solver"] == "auto")
    from ...cases.analysis_size import AnalysisSize
    from ...core.output_file import check_folder, check_writable
    from ..analysis.case_analysis import analyze, operation_of
    from ..analysis.contact_analysis import case_torques
    from ..result import write_result
    from ..summary.result_summary import outcome, result_notes, uncertified

    checked = chosen_case(case, supports)
    table = checked.friction
    oils = [oil] if oil is not None else [table.oil_file] if table is not None else []
    support_files = [] if supports is None else [supports]
    check_writable(output, case, *support_files, *options["deviations"].values(), *oils, suffix=".nc")
    refuse_name_of_output(output, plots=plots)
    if plots is not None:
        check_folder(plots, "pictures")
    conditions = {"speed": speed, "temperature": temperature, "roughness": roughness, "oil": oil}
    model = None
    if load_cases is not None:
        if speed is not None:
            raise click.UsageError("--speed: must not go with --load-cases, which have their own speeds")
        if any(value is not None for value in (friction_model, film_heating, clamp_temperature)) or table is not None:
            model = chosen_model(table, friction_model, film_heating, clamp_temperature)
        models = {"friction_model": model, "friction_feedback": friction_feedback, "marking": marking}
        del conditions["speed"]
        run_load_cases(checked, case, load_cases, output, plots, conditions | models, options)
        return
    if checked.load_cases:
        echo(f"{case} has {len(checked.load_cases)} load cases: --load-cases case analyses them", err=True)
    operation = operation_of(table, **conditions)
    if operation is not None:
        model = chosen_model(table, friction_model, film_heating, clamp_temperature)
    elif friction_model is not None or film_heating is not None or clamp_temperature or friction_feedback:
        raise click.UsageError(
            "--friction-model, --film-heating, --clamp-temperature and --friction-feedback must go with --speed or a "
            "table [friction]"
        )
    arguments = {**conditions, "friction_model": model, "friction_feedback": friction_feedback, "marking": marking}
    fed_back = table is not None and table.feedback if friction_feedback is None else friction_feedback
    shape = (0, 0, 0) if operation is None else operation.shape
    size = AnalysisSize.of(checked, len(case_torques(checked, options["torques"])), shape, feedback=bool(fed_back))
    check_cost(checked, size)
    with progress_bar(checked, options["torques"]) as shown:
        tree = analyze(checked, **with_defaults(options), **arguments, progress=shown.step, stage=shown.stage)
    write_result(tree, output)
    echo(f"wrote {output}: {outcome(tree)}")
    if plots is not None:
        draw(tree, plots)
    for note in result_notes(tree):
        echo(note, err=True)
    next_commands(("show", output), *([] if plots is not None else [("plot", output, "FOLDER")]))
    if uncertified(tree):
        sys.exit(EXIT_UNCERTIFIED)
