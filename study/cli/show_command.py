"""The command that prints the numbers of a result."""

from __future__ import annotations

from pathlib import Path

import click


@click.command()
@click.argument("result", type=click.Path(path_type=Path))
def show(result: Path) -> None:
    """Print the numbers an engineer asks for first."""
    from ..report.result_summary import summary
    from ..result import read_result

    click.echo(summary(read_result(result)))
