"""The command that analyses a case."""

from __future__ import annotations

import sys
from contextlib import suppress
from pathlib import Path
from typing import Any

import click

from .analysing import analysed, analysis_options
from .exit_codes import EXIT_UNCERTIFIED
from .options import numbers, roughnesses


@click.command()
@analysis_options
@click.option("-o", "--output", type=click.Path(path_type=Path), required=True, help="netCDF file to write.")
@click.option("--plots", type=click.Path(path_type=Path, file_okay=False), help="Folder for pictures.")
@click.option(
    "--speed",
    callback=numbers,
    metavar="N1,N2,...",
    help="Speeds of the pinion in 1/min, or FROM:TO:COUNT; adds friction, power loss and efficiency.",
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
@click.option("--clamp-temperature", is_flag=True, help="Take the end of the oil's data beyond them, and flag it.")
@click.option("--friction-feedback", is_flag=True, help="Let friction take its part of the torque from the forces.")
def run(
    case: str,
    output: Path,
    plots: Path | None,
    speed: Any,
    oil: str | None,
    temperature: Any,
    roughness: Any,
    friction_model: str | None,
    clamp_temperature: bool,
    friction_feedback: bool,
    **options: Any,
) -> None:
    """Analyse CASE, a shipped name or a file, and write the result."""
    from ...core.files import check_writable
    from ..analysis import operation_of
    from ..result import write_result
    from ..show import uncertified

    operation = operation_of(speed, temperature=temperature, roughness=roughness, oil=oil)
    if operation is None and (friction_model is not None or clamp_temperature or friction_feedback):
        raise click.UsageError("--friction-model, --clamp-temperature and --friction-feedback go with --speed")
    check_writable(output)
    if plots is not None:
        check_writable(plots / "picture.png")
    model = None if operation is None else _model(friction_model, clamp_temperature)
    friction = {"operation": operation, "friction_model": model, "friction_feedback": friction_feedback}
    analysis = analysed(case, **options, **friction)
    write_result(analysis.tree, output)
    click.echo(f"wrote {output}")
    if plots is not None:
        from ..plot import write_pictures

        for picture in write_pictures(analysis.tree, plots):
            click.echo(f"wrote {picture}")
    failures = uncertified(analysis.tree)
    if failures:
        click.echo("\n".join(failures), err=True)
        sys.exit(EXIT_UNCERTIFIED)


def _model(name: str | None, clamp: bool) -> Any:
    """The friction model of a name or a number."""
    from ...friction import FrictionModel

    coefficient: str | float = name or "kolivand"
    with suppress(ValueError):
        coefficient = float(coefficient)
    return FrictionModel(coefficient, out_of_range="clamp" if clamp else "error")
