"""The command that makes the library of contact problems."""

from __future__ import annotations

import sys
from pathlib import Path

import click

from .exit_codes import EXIT_UNCERTIFIED


@click.command()
@click.option(
    "-o", "--output", type=click.Path(path_type=Path), default="library", show_default=True, help="Folder to write to."
)
@click.option("--parts", metavar="A,B,...", help="Of small, medium, large; all of them if left out.")
def library(output: Path, parts: str | None) -> None:
    """Make the library of contact problems: one file of problems a part, for solvers to be tried on.

    Every problem is solved and compared with its reference answer.
    """
    from tqdm import tqdm

    from ..library import entries, write_library

    chosen = None if parts is None else [part.strip() for part in parts.split(",")]
    total = sum(chosen is None or entry.part in chosen for entry in entries())
    with tqdm(total=total, desc="library", unit="problem", disable=None, leave=False) as bar:

        def progress() -> None:
            bar.update(1)

        written = write_library(output, chosen, progress=progress)
    for one in written:
        click.echo(
            f"wrote {one.path}: {one.problems} contact problems, worst certificate {one.worst_certificate:.1e}, "
            f"rotations as the reference within {one.worst_difference:.1e}"
        )
    faults = [fault for one in written for fault in one.faults]
    if faults:
        click.echo("\n".join(faults), err=True)
        sys.exit(EXIT_UNCERTIFIED)
