"""The command line. Exit code 0: done; 1: an analysis has uncertified results; 2: a mistake in what was asked for."""

from __future__ import annotations

import sys
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from ..core.errors import EaseoffError, InputError
from .cli_options import margins, misalignment, nodes, solvers, teeth, torques

# Everything heavy is imported by the command that needs it: `easeoff --help` stays quick.
if TYPE_CHECKING:
    from .analysis import Analysis

EXIT_UNCERTIFIED = 1
EXIT_MISTAKE = 2


class _Mistake(click.ClickException):
    """What the user can put right."""

    exit_code = EXIT_MISTAKE


class _Group(click.Group):
    """Turns the package's own exceptions into one message and exit code 2."""

    def invoke(self, ctx: click.Context) -> Any:
        try:
            return super().invoke(ctx)
        except EaseoffError as error:
            raise _Mistake(str(error)) from error


@click.group(cls=_Group, context_settings={"help_option_names": ["-h", "--help"]})
@click.version_option(package_name="easeoff")
def main() -> None:
    """Contact of spiral bevel and hypoid gears: from machine settings to certified loaded contact."""


def _analysis_options(command: Any) -> Any:
    for option in reversed(
        (
            click.argument("case"),
            click.option(
                "--flank",
                type=click.Choice(["drive", "coast"]),
                default="drive",
                show_default=True,
                help="Which flanks mesh: drive is pinion concave with gear convex.",
            ),
            click.option(
                "--torque",
                "torques",
                callback=torques,
                metavar="T1,T2,...",
                help="Torques at the pinion in N m; the case's own if left out.",
            ),
            click.option(
                "--misalignment",
                callback=misalignment,
                metavar="E=..,P=..,G=..,Sigma=..",
                help="Assembly errors in mm (Sigma in degrees); the case's own if left out.",
            ),
            click.option("--solver", default="auto", show_default=True, help="Contact solver."),
        )
    ):
        command = option(command)
    return command


def _step(bar: Any) -> None:
    bar.update(1)


def _run(case: str, flank: Any, torques: Any, misalignment: Any, solver: str) -> Analysis:
    """Analyse a case with a progress bar, which keeps quiet when the output is not a terminal."""
    from tqdm import tqdm

    from ..cases import read_case
    from .analysis import analyze_in_full

    checked = read_case(case)
    total = len(torques or checked.contact.torques) * checked.contact.mesh_positions
    with tqdm(total=total, desc="loaded contact", unit="solve", disable=None, leave=False) as bar:
        return analyze_in_full(
            checked,
            flank=flank,
            torques=torques,
            misalignment=misalignment,
            solver=solver,
            progress=lambda: _step(bar),
        )


@main.command()
@_analysis_options
@click.option("-o", "--output", type=click.Path(path_type=Path), required=True, help="netCDF file to write.")
@click.option("--plots", type=click.Path(path_type=Path, file_okay=False), help="Folder for pictures.")
def run(case: str, flank: Any, torques: Any, misalignment: Any, solver: str, output: Path, plots: Path | None) -> None:
    """Analyse CASE, a shipped name or a file, and write the result."""
    from ..core.files import check_writable
    from .result import write_result
    from .show import uncertified

    check_writable(output)
    if plots is not None:
        check_writable(plots / "picture.png")
    analysis = _run(case, flank, torques, misalignment, solver)
    write_result(analysis.tree, output)
    click.echo(f"wrote {output}")
    if plots is not None:
        from .plot import write_pictures

        for picture in write_pictures(analysis.tree, plots):
            click.echo(f"wrote {picture}")
    failures = uncertified(analysis.tree)
    if failures:
        click.echo("\n".join(failures), err=True)
        sys.exit(EXIT_UNCERTIFIED)


@main.command()
@click.argument("result", type=click.Path(path_type=Path))
def show(result: Path) -> None:
    """Print the numbers an engineer asks for first."""
    from .result import read_result
    from .show import summary

    click.echo(summary(read_result(result)))


@main.command()
@click.argument("result", type=click.Path(path_type=Path))
@click.argument("folder", type=click.Path(path_type=Path))
def plot(result: Path, folder: Path) -> None:
    """Draw the pictures of RESULT into FOLDER."""
    from ..core.files import check_writable
    from .plot import write_pictures
    from .result import read_result

    tree = read_result(result)
    if folder.exists() and not folder.is_dir():
        raise InputError(f"{folder} is a file: give a folder for the pictures")
    check_writable(folder / "picture.png")
    for picture in write_pictures(tree, folder):
        click.echo(f"wrote {picture}")


@main.command()
@click.argument("design")
@click.option("-o", "--output", type=click.Path(path_type=Path), required=True, help="Case file to write.")
@click.option("--report", is_flag=True, help="Print blanks, moved settings and what is left of the target.")
def design(design: str, output: Path, report: bool) -> None:
    """Make a case file from DESIGN, a shipped name or a file: blanks, Formate gear, fitted pinion."""
    from ..cases import read_design, write_case
    from ..core.files import check_writable
    from .design import design_case
    from .design_report import design_text, summary_lines

    check_writable(output)
    case, found = design_case(read_design(design))
    write_case(case, output, f"Made by easeoff from the design {Path(design).name}.")
    click.echo(f"wrote {output}")
    click.echo(design_text(found) if report else "\n".join(summary_lines(found)))


@main.command()
def cases() -> None:
    """List the shipped cases."""
    from ..cases import shipped_cases

    shipped = shipped_cases()
    width = max(len(name) for name in shipped)
    for name, title in shipped.items():
        click.echo(f"{name:<{width}}  {title}")


@main.command()
@_analysis_options
@click.option("-o", "--output", type=click.Path(path_type=Path), required=True, help="netCDF file to write.")
def problems(case: str, flank: Any, torques: Any, misalignment: Any, solver: str, output: Path) -> None:
    """Write the contact problems of every torque and mesh position of CASE, for other solvers."""
    from ..contact.exchange import write_problems
    from ..core.files import check_writable

    check_writable(output)
    analysis = _run(case, flank, torques, misalignment, solver)
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


@main.command()
@click.argument("problems", type=click.Path(path_type=Path), nargs=-1, required=True)
@click.option(
    "-o", "--output", type=click.Path(path_type=Path), default="comparison", show_default=True, help="Folder."
)
@click.option(
    "--solvers",
    callback=solvers,
    metavar="A,B,...",
    help="Solvers, or MODULE:FUNCTION for one of your own; all that are installed if left out.",
)
@click.option("--repetitions", type=int, default=3, show_default=True, help="Attempts of each kind.")
@click.option("--time-limit", type=float, default=10.0, show_default=True, help="Of one attempt, in seconds.")
@click.option("--tolerance", type=float, default=1e-5, show_default=True, help="Of the certificate, for all solvers.")
@click.option("--raw", is_flag=True, help="Run backends without polish, and without our scaling and settings, as well.")
@click.option("--fresh", is_flag=True, help="Forget earlier measurements in the folder.")
@click.option("--test-set", is_flag=True, help="Write the problems as a test set of qpbenchmark as well.")
def compare(problems: tuple[Path, ...], output: Path, test_set: bool, **options: Any) -> None:
    """Compare solvers on the contact problems of one or more files written by 'easeoff problems'.

    A solver that fails, hangs or crashes is a line in the report: the exit code is 0. A comparison that was
    interrupted goes on where it stopped.
    """
    from tqdm import tqdm

    from .compare import compare as run_comparison
    from .compare import write_comparison

    with tqdm(desc="comparison", unit="measurement", disable=None, leave=False) as bar:

        def progress(done: int, total: int) -> None:
            bar.total = total
            bar.update(done - bar.n)

        table = run_comparison(problems, output, progress=progress, **options)
    for path in write_comparison(table, output):
        click.echo(f"wrote {path}")
    if test_set:
        from ..contact.exchange import read_problems
        from .compare.test_set import write_test_set

        for path in write_test_set([item for file in problems for item in read_problems(file)], output / "test_set"):
            click.echo(f"wrote {path}")


@main.command()
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
    from ..cases import read_case
    from ..geometry.formats import EdgeMargins
    from .export import export as write

    given = {name: value for name, value in options.items() if value is not None}
    if "margins" in given:
        given["margins"] = EdgeMargins(**given["margins"])
    if given.get("teeth") == "all":
        given["teeth"] = None
    written = write(read_case(case), output, member, flank, given)
    click.echo(f"wrote {output}: {written}")


@main.command()
@click.argument("source", metavar="INPUT")
@click.option(
    "-o", "--output", type=click.Path(path_type=Path), required=True, help="File to write: .toml, .rexs, .xml."
)
def convert(source: str, output: Path) -> None:
    """Turn INPUT into another format, and say what does not go over.

    INPUT is a shipped case, a case file (.toml), a REXS file (.rexs, .xml) or a session script of Transmission3D or
    HypoidFaceMilled (.ses, .txt). The suffix of the output says what is written: a case file or a REXS file.
    """
    from ..cases import read_case, read_rexs, read_session_script, write_case, write_rexs
    from ..core.files import check_writable

    suffix, target = Path(source).suffix.lower(), output.suffix.lower()
    if target not in (".toml", ".rexs", ".xml"):
        raise InputError(
            f"{output}: its suffix {target!r} is none that can be written; known are .toml, .rexs and .xml"
        )
    check_writable(output)
    notes: list[str] = []
    if suffix in ("", ".toml"):
        case = read_case(source)
    elif suffix in (".rexs", ".xml"):
        case, notes = read_rexs(source)
    elif suffix in (".ses", ".txt"):
        case, notes = read_session_script(source)
    else:
        raise InputError(
            f"{source}: its suffix {suffix!r} is none that can be read; known are .toml, .rexs, .xml, .ses and .txt"
        )
    if target == ".toml":
        write_case(case, output, "\n".join([f"Made by easeoff from {Path(source).name}.", *notes]))
    else:
        notes = notes + write_rexs(case, output)
    for note in notes:
        # What stands in somebody else's file must not steer the terminal.
        click.echo("".join(c if c.isprintable() else "?" for c in note))
    click.echo(f"wrote {output}")
