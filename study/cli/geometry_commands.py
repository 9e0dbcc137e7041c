"""Commands that export teeth and correct machine settings: geometry without loads."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import click
from click.core import ParameterSource

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

#: Options of ``export`` that go with a result, and those that go with a case.
CONTACT_OPTIONS = ("torque", "mesh_position")
GEOMETRY_OPTIONS = ("member", "flank", "rows", "columns", "margins", "teeth")


@click.command(cls=Command)
@click.argument("source", metavar="CASE|RESULT", shell_complete=case_names)
@allow_outside_option
@output_option(
    "File to write; its suffix decides: .csv, .nc (measuring points), .step, .stp (CAD surfaces), .stl, .vtk, .vtu "
    "(meshes). Of a RESULT: .vtu."
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
@click.option(
    "--torque",
    type=float,
    metavar="T",
    show_default="the greatest",
    help="Result: torque at the pinion in N m, one of those of the result.",
)
@click.option(
    "--mesh-position",
    type=float,
    metavar="Q",
    show_default="0",
    help="Result: mesh position, from 0 to 1 over a pinion pitch, one of those of the result.",
)
def export(source: str, output: Path, member: Any, flank: Any, **options: Any) -> None:
    """Export teeth of CASE as points, CAD surfaces or a mesh, or the contact of RESULT on its teeth.

    RESULT is a file of 'easeoff run'. Its .vtu file, for ParaView and other programs that read VTK, holds the teeth of
    both members in mesh position with ease-off, contact pattern and pressure, and a strip for every loaded segment with
    its load, film, friction and temperature.
    """
    contact = {name: options.pop(name) for name in CONTACT_OPTIONS}
    if Path(source).suffix.lower() == ".nc":
        _export_contact(source, output, contact, options["nodes"])
        return
    given = [name for name, value in contact.items() if value is not None]
    if given:
        raise click.UsageError(f"--{given[0].replace('_', '-')}: must go with a RESULT, not with a case")
    _export_geometry(source, output, member, flank, options)


def _export_contact(source: str, output: Path, contact: dict[str, Any], nodes: tuple[int, int] | None) -> None:
    from ...core.writing.output_file import check_writable
    from ..export.contact_mesh import export_contact
    from ..result import read_result

    context = click.get_current_context()
    foreign = [name for name in GEOMETRY_OPTIONS if context.get_parameter_source(name) == ParameterSource.COMMANDLINE]
    if foreign:
        raise click.UsageError(f"--{foreign[0]}: must go with a CASE, not with a result")
    check_writable(output, source)
    chosen = {name: value for name, value in {**contact, "nodes": nodes}.items() if value is not None}
    with working("contact on the teeth"):
        written = export_contact(read_result(source), output, **chosen)
    echo(f"wrote {output}: {written}")


def _export_geometry(case: str, output: Path, member: Any, flank: Any, options: dict[str, Any]) -> None:
    from ...cases import read_case
    from ...core.writing.output_file import check_writable
    from ...geometry.formats import EdgeMargins
    from ..export.geometry_export import export as write

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
