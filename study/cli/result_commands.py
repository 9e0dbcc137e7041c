"""Commands that show, plot and report results."""

from __future__ import annotations

import sys
from collections.abc import Iterable
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from ...core.errors import printable
from ..progress import working
from . import option
from .case_run import check_output
from .command import EXIT_UNCERTIFIED, Command, echo, next_commands, quick_start
from .option_values import names

if TYPE_CHECKING:
    import xarray as xr


@click.command(cls=Command)
@click.argument("result", type=click.Path(path_type=Path))
def show(result: Path) -> None:
    """Show the main numbers of RESULT.

    RESULT is a file of 'easeoff run', 'modify', 'optimize', 'sweep', 'vh' or 'wear', or of contact problems.
    """
    quick_start()
    from ...core.netcdf_file import tree_or_none
    from ..result import checked_given, kind_of, read_result
    from ..summary.load_case_summary import holds_problems, load_case_summary, problem_summary
    from ..summary.result_summary import result_summary
    from ..summary.sweep_report import sweep_summary, vh_table, wear_summary
    from ..sweep.sweep_file import checked_sweep, is_sweep

    tree = tree_or_none(result)
    problems = tree_or_none(result, square=True) if tree is None else tree
    if problems is not None and holds_problems(problems.to_dataset()):
        echo(problem_summary(result))
        return
    if tree is None:
        tree = read_result(result)  # says what is wrong with the file
    if is_sweep(dataset := tree.to_dataset()):
        echo(sweep_summary(checked_sweep(dataset, result)))
        return
    given: Any = checked_given(tree, result)
    kind = kind_of(given)
    if kind in ("V-H check", "wear"):
        table = vh_table(given) if kind == "V-H check" else wear_summary(given)
        echo(f"{given.attrs['title']}, {given.attrs['flank']} flanks\n\n{table}")
        return
    echo(load_case_summary(given) if "load_cases" in given.children else result_summary(given))


@click.command(cls=Command)
@click.argument("result", type=click.Path(path_type=Path))
@click.argument("folder", type=click.Path(path_type=Path), required=False)
@option.output("Folder to write.", required=False, metavar="FOLDER")
@click.option(
    "--pictures",
    callback=names,
    metavar="NAME,...",
    show_default="all",
    help="Pictures to draw, such as pressure,transmission_error; a wrong name lists those of the result.",
)
@option.torque(
    "Torques of the result at the pinion in N m, for the pictures that show torques.", "up to six, spread evenly"
)
@click.option(
    "--flank",
    type=click.Choice(["drive", "coast"]),
    show_default="both",
    help="Flank to draw, of load cases or a sweep with both.",
)
@click.option(
    "--format", "file_format", type=click.Choice(["png", "svg", "pdf"]), default="png", help="Format of the files."
)
@option.value("--dpi", "N", "Dots per inch of PNG files.", "160", type=click.IntRange(30, 1200))
@option.marking(default="that of the result")
def plot(result: Path, folder: Path | None, output: Path | None, dpi: int | None, **options: Any) -> None:
    """Draw pictures of RESULT into FOLDER.

    RESULT is a file of 'easeoff run', 'modify', 'optimize', 'sweep', 'vh' or 'wear'. The files are named after case,
    flank and picture, as in fm-11x41-drive-pressure.png. Pictures of an earlier result of the same case and flank in
    FOLDER are replaced or removed.
    """
    quick_start()
    from ...core.output_file import check_folder
    from ..plot.written_pictures import read_drawn

    if (folder is None) == (output is None):
        raise click.UsageError("FOLDER: must be given once, as in 'easeoff plot RESULT -o FOLDER'")
    if dpi is not None and options["file_format"] != "png":
        raise click.UsageError(f"--dpi: must go with --format png; {options['file_format']} files have no dots")
    drawn = read_drawn(result)
    if options["marking"] is not None and not hasattr(drawn, "children"):
        raise click.UsageError("--marking: must go with a file of 'easeoff run'; sweeps, V-H checks and wear have none")
    place = folder or output
    assert place is not None
    check_folder(place, "pictures")
    options["names"], options["torque"] = options.pop("pictures"), options.pop("torques")
    draw(drawn, place, dpi=dpi, **options)


@click.command(cls=Command)
@click.argument("results", type=click.Path(path_type=Path), nargs=-1, required=True, metavar="RESULT...")
@option.output("HTML file to write.", required=False, show_default="RESULT.html, if there is one")
@click.option("--author", metavar="NAME", default="", show_default=False, help="Who made the report, for its head.")
@click.option(
    "--limit",
    "limits",
    multiple=True,
    metavar="'QUANTITY<=VALUE'",
    help="Limit of a number in the unit of the report, such as 'max_pressure<=1500' or 'least_backlash>=0.1'. May be "
    "repeated.",
)
def report(results: tuple[Path, ...], output: Path | None, author: str, limits: tuple[str, ...]) -> None:
    """Write the report of one or several RESULTs as one HTML file.

    RESULT is a file of 'easeoff run', 'modify', 'optimize', 'sweep', 'wear' or 'vh'; several, such as drive and coast
    or before and after a change, stand side by side under what distinguishes them, or else the names of their files.
    The report holds case, numbers, charts, pictures of the flanks that answer the pointer, and teeth in three
    dimensions; number and revision of the drawing are those of the case. It opens in any browser without a network,
    which also prints it.
    """
    quick_start()
    from ...core.errors import InputError
    from ..plot.written_pictures import read_drawn
    from ..report.report_file import by_name, write_report

    if output is None:
        if len(results) > 1:
            raise click.UsageError("-o: must be given with several results, as in -o report.html")
        output = results[0].with_suffix(".html")
    check_output(output, *results, suffix=".html")
    twice = next((path for path in results if results.count(path) > 1), None)
    if twice is not None:
        raise InputError(f"RESULT = {printable(str(twice))}: must come once, but comes {results.count(twice)} times")
    read = [read_drawn(path) for path in results]
    named = by_name(read)
    if len(read) == 1 or any(name.startswith("1: ") for name in named):  # nothing that a reader sees distinguishes them
        stems = [path.stem for path in results]
        paths = [str(path.with_suffix("")) for path in results]
        named = dict(zip(stems if len(set(stems)) == len(stems) else paths, read, strict=True))
    with working("drawing the report"):
        write_report(named, output, author=author, limits=limits)
    for name, path in zip(named, results, strict=True):
        if len(results) > 1 and name != path.stem:
            echo(f"{printable(name)}: {path}")
    echo(f"wrote {output}: {output.stat().st_size / 1e6:.1f} MB")
    echo("next: open it in a browser, which also prints it")


@click.command(cls=Command)
@click.argument("result", type=click.Path(path_type=Path), required=False)
@click.option("--bibtex", is_flag=True, help="Entries of BibTeX in place of text.")
def cite(result: Path | None, bibtex: bool) -> None:
    """Print how to cite the program, and the sources of RESULT.

    RESULT is a netCDF file of any command, such as 'easeoff run'. Named are the published sources of its friction
    formula, oil, elastic teeth and pair, of the problem library, or of the solvers of a comparison, as far as the file
    tells them.
    """
    quick_start()
    from ...core.netcdf_file import read_tree
    from ..summary.citation import citation

    echo(citation(None if result is None else read_tree(result), bibtex=bibtex))


def draw(result: xr.DataTree | xr.Dataset, folder: Path, **options: Any) -> None:
    """Write pictures, options as of ``write_pictures``, and say which were written, replaced or removed."""
    from ..plot import write_pictures
    from ..plot.written_pictures import file_prefix, pictures_of_results

    before = pictures_of_results(folder)
    with working("drawing the pictures"):
        written = write_pictures(result, folder, **options)
    for picture in written:
        echo(f"wrote {picture}")
    result_title = printable(str(result.attrs.get("title", "")))
    ours = {path: title for path, (title, _) in before.items() if path.name.startswith(f"{file_prefix(result)}-")}
    for title in sorted({title for path, title in ours.items() if title not in ("", result_title)}):
        echo(f"replaced the pictures of {printable(title)!r}")
    for picture in ours:
        if not picture.exists():
            echo(f"removed {printable(str(picture))}, a picture of an earlier result")


def end_with(
    result: xr.DataTree, output: Path, plots: Path | None, notes: Iterable[str] = (), *, certified: bool
) -> None:
    """Draw what was written if asked to, tell the notes and which commands take it, and end by the exit code."""
    if plots is not None:
        draw(result, plots)
    for note in notes:
        echo(note, err=True)
    next_commands(("show", output), *([] if plots is not None else [("plot", output, "FOLDER")]))
    if not certified:
        sys.exit(EXIT_UNCERTIFIED)
