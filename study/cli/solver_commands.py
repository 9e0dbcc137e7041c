"""Commands for contact problems and their solvers: problems of a case, library of problems, comparison of solvers."""

from __future__ import annotations

import os
from collections import Counter
from functools import partial
from pathlib import Path
from typing import Any

import click

from ..progress import count, terminal_bar
from . import option
from .case_run import check_cost, opened_case, progress_bar
from .command import Command, echo, end_uncertified, next_commands
from .option_values import number_list, reader, with_defaults
from .word_completion import solver_list

#: Attributes of an analysis that files of its contact problems have as well.
PROBLEM_ATTRIBUTES = (
    "title",
    "case",
    "supports_name",
    "flank",
    "deflections",
    "modification_um",
    "compliance_model",
    "edge_contact",
    "solver",
    "easeoff_version",
)


@reader
def solvers(text: str) -> list[str]:
    """Names of solvers, each once."""
    names = [name.strip() for name in text.split(",")]
    for name in names:
        if name and names.count(name) > 1:
            raise click.BadParameter(f"{text!r}: {name} comes twice")
    return names


@reader
def problem_files(paths: tuple[Path, ...]) -> tuple[Path, ...]:
    """Files of contact problems, each once."""
    whole = [os.path.realpath(path) for path in paths]
    for path, real_path in zip(paths, whole, strict=True):
        if whole.count(real_path) > 1:
            raise click.BadParameter(f"{path} comes twice")
        if os.path.isdir(path):
            raise click.BadParameter(
                f"{path} is a folder: give a file; 'easeoff convert {path} -o problems.nc' makes one of its problems"
            )
    return paths


def tolerances(_ctx: click.Context, _param: click.Parameter, text: str | None) -> list[float]:
    """Tolerances of a sweep; none if it is not wanted."""
    return [] if text is None else number_list(text, "tolerances separated by commas, such as 1e-3,1e-6,1e-9")


@click.command(cls=Command)
@option.analysis
@option.output("File to write, .nc or .mat; or, with --format, folder with a file for each problem.")
@option.problem_format
def problems(
    case: str, output: Path, format: str | None, form: str | None, supports: str | None, **options: Any
) -> None:
    """Write the contact problems of CASE to a file or folder.

    There is one for each torque and mesh position. Their solutions are written, too, where the format has a place for
    them.
    """
    import numpy as np

    from ...contact.problem.exchange.problem_file import ProblemSet
    from ...contact.solvers import require_solver
    from ..analysis.contact_analysis import contact_analysis
    from ..analysis.operating import Operating, analysis_size
    from ..case_in_mesh import CaseInMesh
    from ..compare.problem_export import check_problem_output, write_problem_set

    support_files = [] if supports is None else [supports]
    check_problem_output(output, format, form, case, *support_files, *options["deviations"].values(), count=2)
    checked = opened_case(case, None, supports=supports)
    operating = Operating.of(**with_defaults(options))
    require_solver(operating.solver)
    load = operating.load(checked)
    check_cost(checked, analysis_size(checked, load.size, None))
    with progress_bar(checked, load.size) as shown:
        state = CaseInMesh.meshed(checked, operating.flanks, shown.stage)
        shown.stage("loaded contact")
        analysis = contact_analysis(state, load, **operating.contact, progress=shown.step)
    solved = analysis.cases
    loaded = analysis.tree["loaded"].to_dataset()
    torque, position = loaded["torque"].values, loaded["mesh_position"].values
    stem = checked.name or Path(case).stem
    digits = len(str(position.size - 1))
    names = [f"{stem}-{state.flank}-{torque[item.torque]:g}-{item.mesh_position:0{digits}d}" for item in solved]
    described = {
        str(name): value
        for name, value in analysis.tree.attrs.items()
        if name in PROBLEM_ATTRIBUTES or str(name).startswith("misalignment_")
    }
    problem_set = ProblemSet(
        [item.problem for item in solved],
        {
            "name": np.array(names),
            "pinion_torque": torque[[item.torque for item in solved]],
            "mesh_position": position[[item.mesh_position for item in solved]],
        },
        [item.solution.answer for item in solved],
        {"case_name": stem, **described},
    )
    echo(write_problem_set(problem_set, output, format, form))
    if output.suffix == ".nc":
        next_commands(("compare", output))


@click.command(cls=Command)
@option.output("Folder to write.", required=False, metavar="FOLDER", default="library")
@click.option(
    "--parts",
    metavar="A,B,...",
    show_default="small,medium,large",
    help="Parts to make, of small, medium, large, sequences, pairs, huge and giant; or all.",
)
def library(output: Path, parts: str | None) -> None:
    """Make the library of contact problems, a file a part.

    Every problem is solved, and its solution compared with the reference answer.
    """
    from ..library import entries
    from ..library.library_entries import PARTS, USUAL_PARTS
    from ..library.library_files import write_library

    chosen = list(USUAL_PARTS) if parts is None else [part.strip() for part in parts.split(",")]
    if chosen == ["all"]:
        chosen = list(PARTS)
    total = sum(entry.part in chosen for entry in entries())
    with terminal_bar(total=total, desc="library", unit="problem") as bar:
        written = write_library(output, chosen, progress=bar.update)
    for one in written:
        echo(
            f"wrote {one.path}: {one.problems} contact problems, worst certificate {one.worst_certificate:.1e}, "
            f"rotations as the reference within {one.worst_difference:.1e}"
        )
    next_commands(("compare", *(one.path for one in written)))
    end_uncertified([fault for one in written for fault in one.faults])


@click.command(cls=Command)
@click.argument("problems", type=click.Path(path_type=Path), nargs=-1, required=True, callback=problem_files)
@option.output("Folder to write.", required=False, metavar="FOLDER", default="comparison")
@click.option(
    "--solvers",
    callback=solvers,
    shell_complete=solver_list,
    metavar="A,B,...",
    show_default="all installed ones",
    help="Solvers to compare; MODULE:FUNCTION for one of your own.",
)
@click.option("--repetitions", metavar="N", default=3, help="Attempts with the same solver, settings and start.")
@click.option("--time-limit", metavar="S", default=10.0, help="Time limit of an attempt in s.")
@click.option("--tolerance", metavar="X", default=1e-5, help="Largest violation of a condition in a certified answer.")
@click.option("--polish", is_flag=True, help="Also run the backends with one linear solve on the set they found.")
@click.option("--defaults", is_flag=True, help="Also run the backends with their own settings.")
@click.option("--raw", is_flag=True, help="Also run the backends in mm and N, with their own settings.")
@click.option(
    "--tolerances",
    callback=tolerances,
    metavar="X,Y,...",
    help="Also run the backends with these tolerances: time over certified accuracy.",
)
@click.option("--threads", metavar="N", default=1, help="Threads for linear algebra of each solver.")
@option.choice("--time", ("wall", "processor"), "Time of a call that order, tables and profiles go by.")
@click.option("--fresh", is_flag=True, help="Replace earlier measurements in the folder.")
@click.option("--test-set", is_flag=True, help="Write the problems as a test set of qpbenchmark, too.")
def compare(problems: tuple[Path, ...], output: Path, test_set: bool, **options: Any) -> None:
    """Compare solvers on the contact problems in PROBLEMS.

    PROBLEMS are files of 'easeoff problems' or 'easeoff library'. A solver that fails, hangs or crashes is a line in
    the report: the exit code is 0. An interrupted comparison resumes where it stopped.
    """
    from ..compare import compare as run_comparison
    from ..compare.problem_export import write_test_set
    from ..report.comparison_report import waiting_note
    from ..report.written_comparison import is_of_another_study, write_comparison

    with terminal_bar(desc="comparison", unit="measurement") as bar:
        table = run_comparison(problems, output, progress=partial(count, bar), **options)
    replaced = is_of_another_study(table, output)
    written = write_comparison(table, output)
    for path in written:
        if path.parent == output:
            echo(f"wrote {path}")
    for folder, files in Counter(path.parent for path in written if path.parent != output).items():
        echo(f"wrote {folder}: {files} files")
    if replaced:
        echo(f"replaced the report of a former comparison in {output}, of other problems, solvers or settings")
    waited = waiting_note(table)
    if waited is not None:
        echo(waited, err=True)
    if test_set:
        from ...contact.problem.exchange.problem_file import joined
        from ...contact.problem.exchange.problem_formats import import_problems

        for path in write_test_set(joined([import_problems(file) for file in problems]), output / "test_set"):
            echo(f"wrote {path}")
    echo(f"next: read {output / 'report.md'}")
