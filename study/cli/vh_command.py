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
from .shared_options import echo, marking, next_commands, output_option, outside_allowed, refuse_name_of_output

GRID_OF_PICTURES = (5, 5)


def _counts(_ctx: click.Context, _param: click.Parameter, text: str | None) -> tuple[int, int] | None:
    """Numbers of values of V and H."""
    if text is None:
        return None
    first, _, second = text.lower().partition("x")
    try:
        return int(first), int(second)
    except ValueError as error:
        raise click.BadParameter(f"{text!r}: must be NUMBERxNUMBER of values of V and H, such as 5x5") from error


@click.command(cls=Command)
@unloaded_options
@output_option("netCDF file to write.")
@click.option(
    "--plots", type=click.Path(path_type=Path, file_okay=False), metavar="FOLDER", help="Folder for the picture."
)
@click.option(
    "--marking",
    type=float,
    callback=marking,
    metavar="THICKNESS",
    show_default="contact.separation of the case",
    help="Thickness of the marking compound in um.",
)
@click.option(
    "--share",
    type=float,
    default=0.25,
    show_default=True,
    help="Where the centre shall be at toe and heel: its distance from the end of the tooth over the face width.",
)
@click.option(
    "--height",
    type=float,
    default=0.5,
    show_default=True,
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
def vh(
    case: str,
    output: Path,
    plots: Path | None,
    marking: float | None,
    share: float,
    height: float,
    largest: float | None,
    grid: tuple[int, int] | None,
    **options: Any,
) -> None:
    """Shift the pattern of CASE to toe, middle and heel.

    This is the V-H check of the shop, without load.

    V is a displacement along the offset, positive as E: the offset grows. H is one of the pinion along its axis,
    positive as P: away from the crossing point. Both are added to the misalignment. The centre is that of the marking
    print. The exit code is 1 if it cannot be brought to one of the three places.
    """
    quick_start()
    from ...cases import read_case
    from ...core.output_file import check_folder, check_writable
    from ..summary.sweep_report import vh_table
    from ..vh import vh_check, write_vh_check

    checked = read_case(case, allow_outside=outside_allowed())
    check_writable(output, case, *options["deviations"].values(), suffix=".nc")
    refuse_name_of_output(output, plots=plots)
    if plots is not None:
        check_folder(plots, "pictures")
        grid = grid or GRID_OF_PICTURES
    options = with_defaults(options)
    with terminal_bar(desc="V-H check", unit="pattern") as bar:
        check = vh_check(
            checked,
            marking=marking,
            share=share,
            height=height,
            largest=largest,
            grid=grid,
            progress=lambda: bar.update(1),
            **options,
        )
    write_vh_check(check, output)
    echo(vh_table(check))
    echo(f"wrote {output}")
    if plots is not None:
        draw(check, plots)
    else:
        next_commands(("plot", output, "FOLDER"))
    if check["status"].values.any():
        sys.exit(EXIT_UNCERTIFIED)
