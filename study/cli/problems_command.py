"""The command that writes the contact problems of a case, for other solvers."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import click

from .analysis_options import analysis_options, progress_bar, with_defaults


@click.command()
@analysis_options
@click.option("-o", "--output", type=click.Path(path_type=Path), required=True, help="netCDF file to write.")
def problems(case: str, output: Path, torques: Any, edge_contact: bool | None, solver: str, **options: Any) -> None:
    """Write the contact problems of every torque and mesh position of CASE, for other solvers."""
    from ...cases import read_case
    from ...contact.problem.problem_file import write_problems
    from ...contact.solvers import require_solver
    from ...core.files import check_writable
    from ..analysis import contact_analysis
    from ..case_in_mesh import CaseInMesh

    check_writable(output, case, *options["deviations"].values(), suffix=".nc")
    checked = read_case(case)
    require_solver(solver)
    state = CaseInMesh.of(checked, **with_defaults(options))
    with progress_bar(checked, torques) as step:
        analysis = contact_analysis(state, torques, edge_contact=edge_contact, solver=solver, progress=step)
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
