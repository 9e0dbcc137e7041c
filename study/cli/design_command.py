"""The command that makes a case from basic data and a wanted ease-off."""

from __future__ import annotations

from pathlib import Path

import click


@click.command()
@click.argument("design")
@click.option("-o", "--output", type=click.Path(path_type=Path), required=True, help="Case file to write.")
@click.option("--report", is_flag=True, help="Print blanks, moved settings and what is left of the target.")
def design(design: str, output: Path, report: bool) -> None:
    """Make a case file from DESIGN, a shipped name or a file: blanks, Formate or generated gear, fitted pinion."""
    from ...cases import read_design, write_case
    from ...core.files import check_writable
    from ..case_design import design_case
    from ..report.design_report import design_text, summary_lines

    check_writable(output, design)
    case, found = design_case(read_design(design))
    write_case(case, output, f"Made by easeoff from the design {Path(design).name}.")
    click.echo(f"wrote {output}")
    click.echo(design_text(found) if report else "\n".join(summary_lines(found)))
