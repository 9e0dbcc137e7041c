"""The command that writes teeth as points, surfaces or meshes."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import click

from .options import margins, nodes, teeth


@click.command()
@click.argument("case")
@click.option(
    "-o",
    "--output",
    type=click.Path(path_type=Path),
    required=True,
    help="File to write: .csv, .nc (measuring points), .step, .stp, .stl, .vtk, .vtu (surfaces).",
)
@click.option("--member", type=click.Choice(["pinion", "gear"]), default="pinion", show_default=True)
@click.option("--flank", type=click.Choice(["concave", "convex", "both"]), default="both", show_default=True)
@click.option("--rows", type=click.IntRange(2, 1001), help="Points: rows from root to tip.  [default: 5]")
@click.option("--columns", type=click.IntRange(2, 1001), help="Points: columns from toe to heel.  [default: 9]")
@click.option(
    "--margins",
    callback=margins,
    metavar="toe=..,heel=..,root=..,tip=..",
    help="Points: strips left out at the edges in mm.  [default: a tenth of face width and depth]",
)
@click.option("--teeth", callback=teeth, metavar="N|all", help="Surfaces: number of teeth.  [default: 1]")
@click.option("--nodes", callback=nodes, metavar="LxP", help="Surfaces: nodes of a flank.  [default: 61x31]")
def export(case: str, output: Path, member: Any, flank: Any, **options: Any) -> None:
    """Write the teeth of CASE as measuring points, CAD surfaces or a mesh; the suffix decides."""
    from ...cases import read_case
    from ...core.files import check_writable
    from ...geometry.formats import EdgeMargins
    from ..geometry_export import export as write

    check_writable(output, case)
    given = {name: value for name, value in options.items() if value is not None}
    if "margins" in given:
        given["margins"] = EdgeMargins(**given["margins"])
    if given.get("teeth") == "all":
        given["teeth"] = None
    written = write(read_case(case), output, member, flank, given)
    click.echo(f"wrote {output}: {written}")
