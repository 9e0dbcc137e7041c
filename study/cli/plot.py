"""The command that draws the pictures of a result."""

from __future__ import annotations

from pathlib import Path

import click

from ...core.errors import InputError


@click.command()
@click.argument("result", type=click.Path(path_type=Path))
@click.argument("folder", type=click.Path(path_type=Path))
def plot(result: Path, folder: Path) -> None:
    """Draw the pictures of RESULT into FOLDER."""
    from ...core.files import check_writable
    from ..plot import write_pictures
    from ..result import read_result

    tree = read_result(result)
    if folder.exists() and not folder.is_dir():
        raise InputError(f"{folder} is a file: give a folder for the pictures")
    check_writable(folder / "picture.png")
    for picture in write_pictures(tree, folder):
        click.echo(f"wrote {picture}")
