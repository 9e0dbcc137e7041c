"""The command that turns one format of case file into another."""

from __future__ import annotations

from pathlib import Path

import click

from ...core.errors import InputError


@click.command()
@click.argument("source", metavar="INPUT")
@click.option(
    "-o", "--output", type=click.Path(path_type=Path), required=True, help="File to write: .toml, .rexs, .xml."
)
def convert(source: str, output: Path) -> None:
    """Turn INPUT into another format, and say what does not go over.

    INPUT is a shipped case, a case file (.toml), a REXS file (.rexs, .xml) or a session script of Transmission3D or
    HypoidFaceMilled (.ses, .txt). The suffix of the output says what is written: a case file or a REXS file.
    """
    from ...cases import read_case, read_rexs, read_session_script, write_case, write_rexs
    from ...core.files import check_writable

    suffix, target = Path(source).suffix.lower(), output.suffix.lower()
    if target not in (".toml", ".rexs", ".xml"):
        raise InputError(
            f"{output}: its suffix {target!r} is none that can be written; known are .toml, .rexs and .xml"
        )
    check_writable(output, source)
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
