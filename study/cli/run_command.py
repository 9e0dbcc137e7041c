"""Command that analyses a case."""

from __future__ import annotations

import sys
from contextlib import suppress
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from .command import Command
from .exit_codes import EXIT_UNCERTIFIED
from .load_case_run import run_load_cases
from .options.analysis_options import analysis_options, check_cost, progress_bar, with_defaults
from .options.shared_options import echo, next_commands, numbers, outside_allowed, roughnesses
from .result_commands import draw

if TYPE_CHECKING:
    from ...cases.schema.friction_table import FrictionTable
    from ...friction import FrictionModel


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
@click.option(
    "--speed",
    callback=numbers,
    metavar="N1,N2,...",
    help="Speeds of the pinion in 1/min, or FROM:TO:COUNT; adds friction, power loss and efficiency. The table "
    "[friction] of the case replaces the defaults of this and the following options.",
)
@click.option(
    "--oil", metavar="OIL", show_default="75w90", help="Lubricant: the name of a shipped one, or a TOML file."
)
@click.option(
    "--temperature",
    callback=numbers,
    metavar="T1,T2,...",
    show_default="90",
    help="Oil temperatures in degC, or FROM:TO:COUNT.",
)
@click.option(
    "--roughness",
    callback=roughnesses,
    metavar="R1,R2,...",
    show_default="0.8",
    help="RMS roughnesses Rq of the flanks in um, each a number or PINION/GEAR.",
)
@click.option(
    "--friction-model",
    metavar="MODEL",
    show_default="kolivand_blended",
    help="Friction coefficient: a model (kolivand_blended, kolivand, mixed_lubrication, xu_kahraman, benedict_kelly), "
    "or a number from 0 to 1.",
)
@click.option(
    "--film-heating",
    metavar="FACTOR",
    show_default="none",
    help="Heat of the inlet thins the film: none, gupta_cheng or murch_wilson.",
)
@click.option(
    "--clamp-temperature/--no-clamp-temperature",
    default=None,
    show_default="no",
    help="Beyond the oil's data, take the last value and flag it.",
)
@click.option(
    "--friction-feedback/--no-friction-feedback",
    default=None,
    show_default="no",
    help="Include friction in the balance of torque, which changes the normal forces.",
)
def run(
    case: str,
    output: Path,
    plots: Path | None,
    marking: float | None,
    load_cases: str | None,
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
    from ...cases import read_case
    from ...cases.analysis_size import AnalysisSize
    from ...core.writing.output_file import check_folder, check_writable
    from ..analysis import analyze, case_torques, operation_of
    from ..report.result_summary import doubts, outcome, uncertified
    from ..result import write_result

    checked = read_case(case, allow_outside=outside_allowed())
    table = checked.friction
    oils = [oil] if oil is not None else [table.oil_file] if table is not None else []
    check_writable(output, case, *options["deviations"].values(), *oils, suffix=".nc")
    if plots is not None:
        check_folder(plots, "pictures")
    conditions = {"speed": speed, "temperature": temperature, "roughness": roughness, "oil": oil}
    model = None
    if load_cases is not None:
        if speed is not None:
            raise click.UsageError("--speed: must not go with --load-cases, which have their own speeds")
        if any(value is not None for value in (friction_model, film_heating, clamp_temperature)) or table is not None:
            model = _model(table, friction_model, film_heating, clamp_temperature)
        models = {"friction_model": model, "friction_feedback": friction_feedback, "marking": marking}
        del conditions["speed"]
        run_load_cases(checked, case, load_cases, output, plots, conditions | models, options)
        return
    if checked.load_cases:
        echo(f"{case} has {len(checked.load_cases)} load cases: --load-cases case analyses them", err=True)
    operation = operation_of(table, **conditions)
    if operation is not None:
        model = _model(table, friction_model, film_heating, clamp_temperature)
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
    for note in doubts(tree):
        echo(note, err=True)
    failures = uncertified(tree)
    if failures:
        echo("\n".join(failures), err=True)
    next_commands(("show", output), *([] if plots is not None else [("plot", output, "FOLDER")]))
    if failures:
        sys.exit(EXIT_UNCERTIFIED)


def _model(
    table: FrictionTable | None, name: str | None, film_heating: str | None, clamp: bool | None
) -> FrictionModel:
    """Friction models of the case, with the coefficient, film heating and rule beyond the oil's data that are given."""
    from ...friction import FrictionModel

    changed: dict[str, Any] = {}
    if name is not None:
        changed["coefficient"] = name
        with suppress(ValueError):
            changed["coefficient"] = float(name)
    if film_heating is not None:
        changed["film_heating"] = film_heating
    if clamp is not None:
        changed["out_of_range"] = "clamp" if clamp else "error"
    return FrictionModel(**changed) if table is None else table.model(**changed)
