"""Command that writes commented templates of input files."""

from __future__ import annotations

from pathlib import Path

import click

from ..command import Command
from ..options.shared_options import echo, next_commands
from ..terminal.word_completion import template_names

KINDS = ("case", "design", "supports", "oil", "load-cases")
#: The command that takes a file of each kind; ``FILE`` stands for it.
TAKEN_BY = {
    "case": ("run", "FILE", "-o", "RESULT.nc"),
    "design": ("design", "FILE", "-o", "CASE.toml"),
    "supports": ("run", "CASE", "-o", "RESULT.nc", "--supports", "FILE"),
    "oil": ("run", "CASE", "-o", "RESULT.nc", "--speed", "SPEED", "--oil", "FILE"),
    "load-cases": ("run", "CASE", "-o", "RESULT.nc", "--load-cases", "FILE"),
}


@click.command(cls=Command)
@click.argument("kind", type=click.Choice(KINDS))
@click.argument("name", required=False, shell_complete=template_names)
@click.option(
    "-o",
    "--output",
    type=click.Path(path_type=Path),
    metavar="FILE",
    show_default="NAME, if it is that of a file",
    help="File to write: .toml, of load cases .csv.",
)
@click.option("--force", is_flag=True, help="Replace a file that was edited or written by hand.")
def new(kind: str, name: str | None, output: Path | None, force: bool) -> None:
    """Write a commented template of an input file of a KIND.

    The template can be used as it is: its numbers are those of an example. Keys that the example does not give are in
    it, too, switched off by a comment sign, with their meaning, unit and default.

    NAME is what the numbers are taken from: of a case or design face-milled (the default), face-hobbed, or the name of
    a shipped one; of supports and oil the name of a shipped one; of load cases the shipped case whose torques they
    take. 'easeoff new KIND FILE' is short for 'easeoff new KIND -o FILE'.
    """
    from ....cases.schema.file_templates import TEMPLATE_KINDS, template
    from ....cases.writing import require_replaceable, write_sealed
    from ....core.output_file import check_writable

    if output is None and name is not None and Path(name).suffix == TEMPLATE_KINDS[kind].suffix:
        output, name = Path(name), None
    if output is None:
        raise click.UsageError(
            f"-o: must be given, as in 'easeoff new {kind} -o my{TEMPLATE_KINDS[kind].suffix}', or short 'easeoff new "
            f"{kind} my{TEMPLATE_KINDS[kind].suffix}'"
        )
    check_writable(output, suffix=TEMPLATE_KINDS[kind].suffix)
    require_replaceable(output, force)
    write_sealed(template(kind, name), output)
    echo(f"wrote {output}")
    next_commands([output if word == "FILE" else word for word in TAKEN_BY[kind]])
