"""The command that writes the contact problems of a case, for other solvers."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import click

from .analysis_options import analysed, analysis_options


@click.command()
@analysis_options
@click.option("-o", "--output", type=click.Path(path_type=Path), required=True, help="netCDF file to write.")
def problems(case: str, output: Path, **options: Any) -> None:
    """Write the contact problems of every torque and mesh position of CASE, for other solvers."""
    from ...contact.problem.problem_file import write_problems
    from ...core.files import check_writable

    check_writable(output, case, *options["deviations"].values(), suffix=".nc")
    analysis = analysed(case, **options)
    solved = analysis.cases
    loaded = analysis.tree["loaded"].to_dataset()
    torque, position = loaded["torque"].values, loaded["mesh_position"].values
    write_problems(
        [item.problem for item in solved],
        output,
        {
            "pinion_torque": torque[[item.torque for item in solved]],
            "mesh_position": position[[item.mesh_position for item in solved]],
        },
    )
    click.echo(f"wrote {output}: {len(solved)} contact problems")
