"""Commands that export teeth and correct machine settings: geometry without loads."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import click

from .command import Command
from .options.shared_options import (
    allow_outside_option,
    deviation_option,
    echo,
    flank_option,
    margins,
    nodes,
    output_option,
    outside_allowed,
    teeth,
)
from .terminal.terminal_bar import working
from .terminal.word_completion import case_names


@click.command(cls=Command)
@click.argument("case", shell_complete=case_names)
@allow_outside_option
@output_option(
    "File to write; its suffix decides: .csv, .nc (measuring points), .step, .stp (CAD surfaces), .stl, .vtk, .vtu "
    "(meshes)."
)
@click.option(
    "--member", type=click.Choice(["pinion", "gear"]), default="pinion", show_default=True, help="Member to export."
)
@click.option(
    "--flank",
    type=click.Choice(["concave", "convex", "both"]),
    default="both",
    show_default=True,
    help="Flank of the member to export.",
)
@click.option(
    "--rows", type=click.IntRange(2, 1001), metavar="N", show_default="5", help="Points: rows from root to tip."
)
@click.option(
    "--columns", type=click.IntRange(2, 1001), metavar="N", show_default="9", help="Points: columns from toe to heel."
)
@click.option(
    "--margins",
    callback=margins,
    metavar="toe=..,heel=..,root=..,tip=..",
    show_default="a tenth of face width and depth",
    help="Points: margins of the grid at the edges of the flank, in mm.",
)
@click.option(
    "--teeth", callback=teeth, metavar="N|all", show_default="1", help="Surfaces and meshes: number of teeth."
)
@click.option(
    "--nodes",
    callback=nodes,
    metavar="LxP",
    show_default="61x31",
    help="Surfaces and meshes: nodes of a flank, lengthwise x profile.",
)
def export(case: str, output: Path, member: Any, flank: Any, **options: Any) -> None:
    """Export teeth of CASE as points, CAD surfaces or a mesh."""
    from ...cases import read_case
    from ...core.writing.output_file import check_writable
    from ...geometry.formats import EdgeMargins
    from ..geometry_export import export as write

    check_writable(output, case)
    given = {name: value for name, value in options.items() if value is not None}
    if "margins" in given:
        given["margins"] = EdgeMargins(**given["margins"])
    if given.get("teeth") == "all":
        given["teeth"] = None
    checked = read_case(case, allow_outside=outside_allowed())
    with working(f"teeth of the {member}"):
        written = write(checked, output, member, flank, given)
    echo(f"wrote {output}: {written}")


@click.command(cls=Command)
@click.argument("case", shell_complete=case_names)
@allow_outside_option
@flank_option
@deviation_option(
    "Measured grid of a member: a file, or the name of a shipped one. May be given for both members.", required=True
)
def correct(case: str, flank: Any, deviations: Any) -> None:
    """Print corrective settings for measured flanks of CASE.

    The global errors of the flanks are printed too.
    """
    from ...cases import gear_pair, read_case
    from ...geometry.tooth.tooth_flanks import named_member
    from ..deviation_source import flank_deviations
    from ..report.correction_report import correction_report

    pair = gear_pair(read_case(case, allow_outside=outside_allowed()), flank)
    with working("settings fitted to the measured flanks"):
        reports = [
            correction_report(name, named_member(pair, name), deviation)
            for name, deviation in flank_deviations(pair, deviations).items()
        ]
    echo("\n\n".join(reports))
