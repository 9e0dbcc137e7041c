"""The command that analyses a case."""

from __future__ import annotations

import sys
from contextlib import suppress
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from .analysis_options import analysis_options, progress_bar, with_defaults
from .exit_codes import EXIT_UNCERTIFIED
from .options import numbers, roughnesses

if TYPE_CHECKING:
    from ...cases.schema.friction_table import FrictionTable
    from ...friction import FrictionModel


@click.command()
@analysis_options
@click.option("-o", "--output", type=click.Path(path_type=Path), required=True, help="netCDF file to write.")
@click.option("--plots", type=click.Path(path_type=Path, file_okay=False), help="Folder for pictures.")
@click.option(
    "--speed",
    callback=numbers,
    metavar="N1,N2,...",
    help="Speeds of the pinion in 1/min, or FROM:TO:COUNT; adds friction, power loss and efficiency. What is "
    "not given of speed, oil, temperature, roughness and models is the case's own, from its table [friction].",
)
@click.option("--oil", help="Lubricant: a shipped name or the path of its TOML file.  [default: 75w90]")
@click.option("--temperature", callback=numbers, metavar="T1,T2,...", help="Of the oil in degC.  [default: 90]")
@click.option(
    "--roughness",
    callback=roughnesses,
    metavar="R1,R2,...",
    help="RMS roughness Rq of the flanks in um, a number or PINION/GEAR.  [default: 0.8]",
)
@click.option("--friction-model", help="Model of the friction coefficient, or a number.  [default: kolivand]")
@click.option(
    "--clamp-temperature/--no-clamp-temperature",
    default=None,
    help="Take the end of the oil's data beyond them, and flag it.  [default: no]",
)
@click.option(
    "--friction-feedback/--no-friction-feedback",
    default=None,
    help="Let friction take its part of the torque from the forces.  [default: no]",
)
def run(
    case: str,
    output: Path,
    plots: Path | None,
    speed: Any,
    oil: str | None,
    temperature: Any,
    roughness: Any,
    friction_model: str | None,
    clamp_temperature: bool | None,
    friction_feedback: bool | None,
    **options: Any,
) -> None:
    """Analyse CASE, a shipped name or a file, and write the result."""
    from ...cases import read_case
    from ...core.files import check_folder, check_writable
    from ..analysis import analyze, operation_of
    from ..report.plausibility import plausibility
    from ..report.result_summary import uncertified
    from ..result import write_result

    checked = read_case(case)
    table = checked.friction
    oils = [oil] if oil is not None else [table.oil_file] if table is not None else []
    check_writable(output, case, *options["deviations"].values(), *oils, suffix=".nc")
    if plots is not None:
        check_folder(plots, "pictures")
    conditions = {"speed": speed, "temperature": temperature, "roughness": roughness, "oil": oil}
    model = None
    if operation_of(table, **conditions) is not None:
        model = _model(table, friction_model, clamp_temperature)
    elif friction_model is not None or clamp_temperature or friction_feedback:
        raise click.UsageError(
            "--friction-model, --clamp-temperature and --friction-feedback go with --speed or a table [friction]"
        )
    friction = {**conditions, "friction_model": model, "friction_feedback": friction_feedback}
    with progress_bar(checked, options["torques"]) as step:
        tree = analyze(checked, **with_defaults(options), **friction, progress=step)
    write_result(tree, output)
    click.echo(f"wrote {output}")
    if plots is not None:
        from ..plot import write_pictures

        for picture in write_pictures(tree, plots):
            click.echo(f"wrote {picture}")
    for note in plausibility(tree):
        click.echo(note, err=True)
    failures = uncertified(tree)
    if failures:
        click.echo("\n".join(failures), err=True)
        sys.exit(EXIT_UNCERTIFIED)


def _model(table: FrictionTable | None, name: str | None, clamp: bool | None) -> FrictionModel:
    """The friction models of the case, with another coefficient by name or number and another way out of range."""
    from ...friction import FrictionModel

    changed: dict[str, Any] = {}
    if name is not None:
        changed["coefficient"] = name
        with suppress(ValueError):
            changed["coefficient"] = float(name)
    if clamp is not None:
        changed["out_of_range"] = "clamp" if clamp else "error"
    return FrictionModel(**changed) if table is None else table.model(**changed)
