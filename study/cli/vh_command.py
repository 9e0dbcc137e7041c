"""Command that makes a V-H check."""

from __future__ import annotations

import sys
from pathlib import Path
from typing import Any

import click

from ..terminal_bar import terminal_bar
from .analysis_options import unloaded_options, with_defaults
from .command import EXIT_UNCERTIFIED, Command, quick_start
from .result_commands import draw
from .shared_options import (
    check_folders,
    echo,
    marking_option,
    next_commands,
    opened_case,
    output_option,
    plots_option,
    reader,
    two_counts,
)

GRID_OF_PICTURES = (5, 5)


@reader
def _counts(text: str) -> tuple[int, int]:
    """Numbers of values of V and H."""
    return two_counts(text, "NUMBERxNUMBER of values of V and H, such as 5x5")


@click.command(cls=Command)
@unloaded_options
@output_option("netCDF file to write.")
@plots_option("Folder for the picture.")
@marking_option("Thickness of the marking compound in um.")
@click.option(
    "--share",
    type=float,
    default=0.25,
    help="Where the centre shall be at toe and heel: its distance from the end of the tooth over the face width.",
)
@click.option(
    "--height",
    type=float,
    default=0.5,
    help="Height of the centre on the gear flank, from 0 at the root to 1 at the tip.",
)
@click.option(
    "--largest",
    type=float,
    metavar="MM",
    show_default="a tenth of the face width",
    help="Greatest size of V and of H in mm that is tried.",
)
@click.option(
    "--grid",
    callback=_counts,
    metavar="NVxNH",
    show_default="5x5 with --plots, else none",
    help="Numbers of values of V and H at which patterns are computed besides.",
)
def vh(case: str, output: Path, plots: Path | None, **options: Any) -> None:
    """Shift the pattern of CASE to toe, middle and heel.

    This is the V-H check of the shop, without load.

    V is a displacement along the offset, positive as E: the offset grows. H is one of the pinion along its axis,
    positive as P: away from the crossing point. Both are added to the misalignment. The centre is that of the marking
    print. The exit code is 1 if it cannot be brought to one of the three places.
    """
    quick_start()
    from ..summary.sweep_report import vh_table
    from ..vh import vh_check, write_vh_check

    checked = opened_case(case, output, *options["deviations"].values())
    check_folders(output, plots)
    if plots is not None:
        options["grid"] = options["grid"] or GRID_OF_PICTURES
    with terminal_bar(desc="V-H check", unit="pattern") as bar:
        check = vh_check(checked, progress=lambda: bar.update(1), **with_defaults(options))
    write_vh_check(check, output)
    echo(vh_table(check))
    echo(f"wrote {output}")
    if plots is not None:
        draw(check, plots)
    else:
        next_commands(("plot", output, "FOLDER"))
    if check["status"].values.any():
        sys.exit(EXIT_UNCERTIFIED)
