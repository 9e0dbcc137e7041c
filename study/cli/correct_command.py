"""The command that names global errors and corrects machine settings."""

from __future__ import annotations

from typing import Any

import click

from .options import deviations


@click.command()
@click.argument("case")
@click.option(
    "--flank", type=click.Choice(["drive", "coast"]), default="drive", show_default=True, help="Which flanks mesh."
)
@click.option(
    "--deviation",
    "deviations",
    multiple=True,
    required=True,
    callback=deviations,
    metavar="MEMBER=FILE",
    help="Measured grid of the pinion or the gear, a file or a shipped one; may be given for both.",
)
def correct(case: str, flank: Any, deviations: Any) -> None:
    """Name the global errors of measured flanks of CASE, and the machine settings that cancel them."""
    from ...cases import gear_pair, read_case
    from ...geometry.tooth.tooth_flanks import named_member
    from ..flank_deviations import flank_deviations
    from ..report.correction_report import correction_text

    pair = gear_pair(read_case(case), flank)
    for name, deviation in flank_deviations(pair, deviations).items():
        click.echo(correction_text(name, named_member(pair, name), deviation))
