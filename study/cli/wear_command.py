"""Command that wears a pair; lapping is wear with its own coefficient."""

from __future__ import annotations

import sys
from functools import partial
from pathlib import Path
from typing import Any

import click

from ..terminal_bar import count, terminal_bar
from .analysis_options import pair_options, show_stage, supports_option, with_defaults
from .command import EXIT_UNCERTIFIED, Command
from .shared_options import coefficients, duty_cycle, echo, next_commands, opened_case, output_option

OF_THE_LAW = ("revolutions", "largest_step", "largest_depth", "most_steps")  # options that a ``WearLaw`` takes


@click.command(cls=Command)
@pair_options
@supports_option
@click.option(
    "--torque",
    callback=duty_cycle,
    required=True,
    metavar="T|T1=SHARE1,T2=SHARE2,...",
    help="Torque at the pinion in N m, or a duty cycle: torques with their shares of the revolutions.",
)
@click.option(
    "--revolutions", type=float, required=True, metavar="N", help="Revolutions of the pinion after which to stop."
)
@click.option(
    "--coefficient",
    callback=coefficients,
    default="1e-12",
    metavar="K|PINION/GEAR",
    help="Archard's wear coefficient in mm^2/N; greater by orders of magnitude for lapping.",
)
@click.option(
    "--largest-step",
    type=float,
    metavar="UM",
    default=0.5,
    help="Wear depth in um after which the contact is computed anew.",
)
@click.option(
    "--largest-depth", type=float, metavar="UM", show_default="no limit", help="Wear depth in um at which to stop."
)
@click.option(
    "--most-steps",
    type=int,
    metavar="N",
    default=1000,
    help="The most steps to take; wear that needs more is refused before it begins.",
)
@output_option("netCDF file to write.")
def wear(case: str, coefficient: tuple[float, float], output: Path, supports: str | None, **options: Any) -> None:
    """Wear the flanks of CASE step by step.

    The file holds depth and contact of every step; the contact is that on lines alone, without tooth edges. The worn
    flanks are deviations: '--deviation pinion=FILE --deviation gear=FILE' continues the wear, or analyses the worn pair
    in 'easeoff run'.
    """
    from ...core.netcdf_file import write_netcdf
    from ..summary.sweep_report import wear_summary
    from ..wear_simulation import WearLaw, wear as worn

    checked = opened_case(case, output, *options["deviations"].values(), supports=supports)
    law = WearLaw(*coefficient, **{name: options.pop(name) for name in OF_THE_LAW})
    bar: Any
    with terminal_bar(total=law.revolutions, desc="wear", unit="revolution", unit_scale=True) as bar:
        history = worn(
            checked,
            law,
            progress=partial(count, bar),
            stage=partial(show_stage, bar),
            **with_defaults(options),
        )
    write_netcdf(history, output)
    echo(wear_summary(history))
    echo(f"wrote {output}")
    worn_flanks = [word for member in ("pinion", "gear") for word in ("--deviation", f"{member}={output}")]
    on_supports = [] if supports is None else ["--supports", supports]
    next_commands(("run", case, *on_supports, *worn_flanks, "-o", "RESULT.nc"))
    if not history.attrs["completed"]:
        share = 100 * float(history["revolutions"][-1]) / law.revolutions
        echo(
            f"the wear ended early, after {share:.3g} % of the revolutions; "
            "the file holds the steps that were solved. A smaller --largest-step may help",
            err=True,
        )
        sys.exit(EXIT_UNCERTIFIED)
