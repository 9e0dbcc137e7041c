"""Commands that show, plot and report results."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

import click

from ...core.printable import printable
from .command import Command
from .options.shared_options import echo

if TYPE_CHECKING:
    import xarray as xr


@click.command(cls=Command)
@click.argument("result", type=click.Path(path_type=Path))
def show(result: Path) -> None:
    """Show the main numbers of RESULT.

    RESULT is a file of 'easeoff run' or 'easeoff sweep'.
    """
    from ..report.load_case_summary import load_case_summary
    from ..report.result_summary import result_summary
    from ..result import read_result

    dataset = _sweep(result)
    if dataset is not None:
        from ..report.sweep_report import sweep_summary

        echo(sweep_summary(dataset))
        return
    tree = read_result(result)
    echo(load_case_summary(tree) if "load_cases" in tree.children else result_summary(tree))


@click.command(cls=Command)
@click.argument("result", type=click.Path(path_type=Path))
@click.argument("folder", type=click.Path(path_type=Path))
@click.option(
    "--marking",
    type=float,
    metavar="THICKNESS",
    show_default="that of the result",
    help="Thickness of the marking compound of the unloaded pattern in um.",
)
def plot(result: Path, folder: Path, marking: float | None) -> None:
    """Plot RESULT as PNG files in FOLDER.

    RESULT is a file of 'easeoff run' or 'easeoff sweep'. Pictures of another result in FOLDER are replaced or removed.
    """
    from ...core.writing.output_file import check_folder
    from ..result import read_result

    dataset = _sweep(result)
    if dataset is not None:
        from ..plot.sweep_pictures import write_sweep_pictures

        if marking is not None:
            raise click.UsageError("--marking: must go with a file of 'easeoff run'; a sweep has its own")
        check_folder(folder, "pictures")
        for picture in write_sweep_pictures(dataset, folder):
            echo(f"wrote {picture}")
        return
    tree = read_result(result)
    check_folder(folder, "pictures")
    draw(tree, folder, marking=marking)


@click.command(cls=Command)
@click.argument("results", type=click.Path(path_type=Path), nargs=-1, required=True, metavar="RESULT...")
@click.option(
    "-o", "--output", type=click.Path(path_type=Path), required=True, metavar="FILE", help="HTML file to write."
)
def report(results: tuple[Path, ...], output: Path) -> None:
    """Write the report of one or several RESULTs as one HTML file.

    RESULT is a file of 'easeoff run', 'optimize', 'wear' or 'vh'; several, such as drive and coast or before and after
    a change, stand side by side under the names of their files. The report holds case, numbers, charts, pictures of the
    flanks that answer the pointer, and teeth in three dimensions. It opens in any browser without a network, which also
    prints it.
    """
    from ...core.errors import InputError
    from ...core.writing.output_file import check_writable
    from ..report.contact_report.given_results import read_given
    from ..report.contact_report.report_file import write_report

    check_writable(output, *results, suffix=".html")
    names = [path.stem for path in results]
    if len(set(names)) < len(names):
        names = [str(path.with_suffix("")) for path in results]
    twice = next((name for name in names if names.count(name) > 1), None)
    if twice is not None:
        raise InputError(f"RESULT = {printable(twice)}: must come once, but comes {names.count(twice)} times")
    write_report(dict(zip(names, map(read_given, results), strict=True)), output)
    echo(f"wrote {output}: {output.stat().st_size / 1e6:.1f} MB")


def _sweep(path: Path) -> xr.Dataset | None:
    """The dataset of a sweep, if a file is of one; of another file its own reader says what is wrong with it."""
    from ...core.errors import InputError
    from ...core.reading.netcdf_file import read_dataset
    from ..sweep.sweep_file import checked_sweep, is_sweep

    try:
        found = read_dataset(path)
    except InputError:
        return None
    return checked_sweep(found, path) if is_sweep(found) else None


def draw(tree: xr.DataTree, folder: Path, *, marking: float | None = None) -> None:
    """Write the pictures of a result, and say which were written and whose were replaced or removed."""
    from ..load_cases.load_case_pictures import write_load_case_pictures
    from ..plot import write_pictures
    from ..plot.picture_files import pictures_of_results

    before = pictures_of_results(folder)
    write = write_load_case_pictures if "load_cases" in tree.children else write_pictures
    for picture in write(tree, folder, marking=marking):
        echo(f"wrote {picture}")
    for title in sorted({title for title in before.values() if title != printable(str(tree.attrs.get("title", "")))}):
        echo(f"replaced the pictures of {printable(title)!r}")
    for picture in before:
        if not picture.exists():
            echo(f"removed {printable(str(picture))}, a picture of an earlier result")
