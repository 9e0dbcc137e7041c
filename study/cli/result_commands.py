"""Commands that show and plot results."""

from __future__ import annotations

from pathlib import Path

import click


@click.command()
@click.argument("result", type=click.Path(path_type=Path))
def show(result: Path) -> None:
    """Show the main numbers of RESULT, a file of 'easeoff run'."""
    from ..report.result_summary import result_summary
    from ..result import read_result

    click.echo(result_summary(read_result(result)))


@click.command()
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
    """Plot RESULT, a file of 'easeoff run', as PNG files in FOLDER."""
    from ...core.files import check_folder
    from ..plot import write_pictures
    from ..result import read_result

    tree = read_result(result)
    check_folder(folder, "pictures")
    for picture in write_pictures(tree, folder, marking=marking):
        click.echo(f"wrote {picture}")
