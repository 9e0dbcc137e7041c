"""Command that makes a lubricant's file from a data sheet."""

from __future__ import annotations

from pathlib import Path

import click

from ..command import Command
from ..options.shared_options import echo, next_commands, output_option


@click.command(cls=Command)
@click.option("--viscosity-40", type=float, required=True, metavar="V", help="Kinematic viscosity at 40 degC in mm2/s.")
@click.option(
    "--viscosity-100", type=float, required=True, metavar="V", help="Kinematic viscosity at 100 degC in mm2/s."
)
@click.option("--density", type=float, required=True, metavar="RHO", help="Density at 15 degC in kg/m3.")
@click.option("--base-oil", required=True, metavar="BASE", help="mineral, pao, pag or ester.")
@click.option("--title", metavar="TEXT", help="What the oil is.  [default: from the numbers]")
@click.option(
    "--source", metavar="TEXT", default="its data sheet", show_default=True, help="Where the numbers are from."
)
@output_option("TOML file to write, for --oil and the table [friction].")
def oil(
    viscosity_40: float,
    viscosity_100: float,
    density: float,
    base_oil: str,
    title: str | None,
    source: str,
    output: Path,
) -> None:
    """Make a lubricant's file from the numbers of a data sheet.

    The pressure-viscosity coefficient is estimated from viscosity and base oil; if you have measured values, write them
    into the file.
    """
    from ....core.errors import InputError
    from ....core.output_file import check_writable
    from ....friction import data_sheet_lubricant, write_lubricant

    check_writable(output)
    if output.suffix.lower() != ".toml":
        raise InputError(f"{output}: must be a name that ends in .toml")
    made = data_sheet_lubricant(
        output.stem,
        viscosity_40=viscosity_40,
        viscosity_100=viscosity_100,
        density=density,
        base_oil=base_oil,
        title=title,
        source=source,
    )
    write_lubricant(made, output)
    for temperature in (40.0, 70.0, 100.0):
        state = made.at(temperature)
        echo(
            f"{temperature:3.0f} degC: {1e3 * float(state.viscosity):.4g} mPa s, pressure-viscosity coefficient "
            f"{1e9 * float(state.pressure_viscosity):.3g} / GPa (estimated)"
        )
    echo(f"wrote {output}")
    next_commands(("run", "CASE", "-o", "RESULT.nc", "--speed", "SPEED", "--oil", output))
