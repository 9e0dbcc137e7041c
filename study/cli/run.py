"""The command that analyses a case."""

from __future__ import annotations

import sys
from pathlib import Path
from typing import Any

import click

from .analysing import analysed, analysis_options
from .exit_codes import EXIT_UNCERTIFIED


@click.command()
@analysis_options
@click.option("-o", "--output", type=click.Path(path_type=Path), required=True, help="netCDF file to write.")
@click.option("--plots", type=click.Path(path_type=Path, file_okay=False), help="Folder for pictures.")
def run(case: str, output: Path, plots: Path | None, **options: Any) -> None:
    """Analyse CASE, a shipped name or a file, and write the result."""
    from ...core.files import check_writable
    from ..result import write_result
    from ..show import uncertified

    check_writable(output)
    if plots is not None:
        check_writable(plots / "picture.png")
    analysis = analysed(case, **options)
    write_result(analysis.tree, output)
    click.echo(f"wrote {output}")
    if plots is not None:
        from ..plot import write_pictures

        for picture in write_pictures(analysis.tree, plots):
            click.echo(f"wrote {picture}")
    failures = uncertified(analysis.tree)
    if failures:
        click.echo("\n".join(failures), err=True)
        sys.exit(EXIT_UNCERTIFIED)
