"""The command that draws the pictures of a result."""

from __future__ import annotations

from pathlib import Path

import click


@click.command()
@click.argument("result", type=click.Path(path_type=Path))
@click.argument("folder", type=click.Path(path_type=Path))
def plot(result: Path, folder: Path) -> None:
    """Draw the pictures of RESULT into FOLDER."""
    from ...core.files import check_folder
    from ..plot import write_pictures
    from ..result import read_result

    tree = read_result(result)
    check_folder(folder, "pictures")
    for picture in write_pictures(tree, folder):
        click.echo(f"wrote {picture}")
