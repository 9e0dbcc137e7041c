"""Command that analyses a case.

Run of a case over load cases, for the command ``run``.
"""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click
from click.core import ParameterSource

from .analysis_options import analysis_options, check_cost, friction_options, given_model, progress_bar, with_defaults
from .command import Command, quick_start
from .result_commands import end_with
from .shared_options import check_folders, echo, marking_option, opened_case, output_option, plots_option

if TYPE_CHECKING:
    from ...cases import Case, LoadCase

OF_THE_CASE = "case"  # instead of a file: the load cases of the case itself
SINGLE_CONDITIONS = ("temperature", "roughness")


def run_load_cases(case: Case, load_cases: str, output: Path, plots: Path | None, options: dict[str, Any]) -> None:
    """Analyse a case over a table of load cases, or ``case`` for its own, write the result, and show its table."""
    from ...cases import Deflections, read_load_cases
    from ...cases.analysis_size import AnalysisSize
    from ..load_case_analysis import analyze_load_cases
    from ..result import write_result
    from ..summary.load_case_summary import load_case_summary

    if options.pop("speed") is not None:
        raise click.UsageError("--speed: must not go with --load-cases, which have their own speeds")
    constant = None if isinstance(options["misalignment"], Deflections) else options["misalignment"]
    for name, value in (("--torque", options.pop("torques")), ("--misalignment", constant)):
        if value is not None:
            raise click.UsageError(f"{name}: must not go with --load-cases, which have their own")
    rows = None
    if load_cases != OF_THE_CASE:
        rows = read_load_cases(load_cases)
    elif not case.load_cases:
        raise click.UsageError("--load-cases = 'case': the case has no tables [[load_cases]]; give a file")
    _refuse_flank(rows or case.load_cases)
    check_cost(case, AnalysisSize.of(case, 1))
    for name in SINGLE_CONDITIONS:
        values = options[name]
        if values is not None and len(values) != 1:
            raise click.UsageError(f"--{name}: must be one value with --load-cases")
        options[name] = None if values is None else values[0]
    with progress_bar(case, len(rows or case.load_cases)) as shown:
        tree = analyze_load_cases(case, rows, **with_defaults(options), progress=shown.step, stage=shown.stage)
    write_result(tree, output)
    echo(load_case_summary(tree))
    echo(f"wrote {output}")
    end_with(tree, output, plots, certified=not tree["load_cases"].to_dataset()["status"].values.any())


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
@output_option("netCDF file to write.")
@plots_option()
@marking_option()
@click.option(
    "--load-cases",
    metavar="FILE|case",
    help="Analyse over load cases instead of torques, each in its own misalignment: those of a table with the columns "
    "torque, E, P, G, Sigma, speed, share, flank and name, or those of the case itself.",
)
@friction_options
def run(
    case: str, output: Path, plots: Path | None, load_cases: str | None, supports: str | None, **options: Any
) -> None:
    """Analyse the contact of CASE and write the result.

    The result holds unloaded and loaded contact, and friction and efficiency if a speed is given. With --load-cases it
    holds that of every load case, a table of the numbers of all, and means over their shares of time.
    """
    if load_cases is None:
        quick_start(alone=options["solver"] == "auto")
    from ..analysis.case_analysis import analyze
    from ..analysis.operating import Operating, analysis_size
    from ..result import write_result
    from ..summary.result_summary import outcome, result_notes, uncertified

    tables = None if load_cases == OF_THE_CASE else load_cases
    checked = opened_case(case, output, tables, options["oil"], *options["deviations"].values(), supports=supports)
    check_folders(output, plots)
    models = any(options[name] is not None for name in ("friction_model", "film_heating"))
    models |= bool(options["clamp_temperature"] or options["friction_feedback"])
    options["friction_model"] = given_model(checked, options)
    if load_cases is not None:
        run_load_cases(checked, load_cases, output, plots, options)
        return
    if checked.load_cases:
        echo(f"{case} has {len(checked.load_cases)} load cases: --load-cases case analyses them", err=True)
    if checked.friction is None and all(options[name] is None for name in ("speed", "oil", *SINGLE_CONDITIONS)):
        if models:
            raise click.UsageError(
                "--friction-model, --film-heating, --clamp-temperature and --friction-feedback must go with --speed or "
                "a table [friction]"
            )
        options["friction_model"] = None
    options = with_defaults(options)
    operating = Operating.of(**options)
    load = operating.load(checked)
    check_cost(checked, analysis_size(checked, load.size, operating.friction.of_case(checked)))
    with progress_bar(checked, load.size) as shown:
        tree = analyze(checked, **options, progress=shown.step, stage=shown.stage)
    write_result(tree, output)
    echo(f"wrote {output}: {outcome(tree)}")
    end_with(tree, output, plots, result_notes(tree), certified=not uncertified(tree))
