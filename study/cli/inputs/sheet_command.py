"""Command that writes the summary sheet of a case."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

import click

from ..command import Command, quick_start
from ..options.number_lists import keyed_numbers
from ..options.shared_options import allow_outside_option, echo, output_option, outside_allowed
from ..terminal.word_completion import case_names

if TYPE_CHECKING:
    from ....geometry.cutting.named_settings import MachineResolution

STEPS = ("length", "angle", "roll", "modified_roll", "motion", "blade_radius", "blade_angle", "edge_radius")


def resolution(_ctx: click.Context, _param: click.Parameter, text: str | None) -> MachineResolution | None:
    """Resolution of settings from an option."""
    from ....geometry.cutting.named_settings import MachineResolution

    return None if text is None else MachineResolution(**keyed_numbers(text, STEPS, "length=0.01,angle=0.01"))


resolution_option = click.option(
    "--resolution",
    callback=resolution,
    metavar="STEP=VALUE,...",
    help="Steps of the settings in mm and degrees: length, angle, roll, modified_roll, motion, blade_radius, "
    "blade_angle, edge_radius.  [default: 0.001 mm, 0.001 deg, ...]",
)


@click.command(cls=Command)
@click.argument("case", shell_complete=case_names)
@allow_outside_option
@output_option("Sheet to write, .txt, .html or .rexs.")
@resolution_option
def sheet(case: str, output: Path, resolution: MachineResolution | None) -> None:
    """Write the summary sheet of a case: what an operator sets.

    Blanks, cutters and machine settings of every flank, rounded to the resolution of the machine, with what rounding
    changes of the ease-off, and what is doubtful of teeth and set-ups; as REXS blanks and rounded settings alone. The
    case stays as it is; 'easeoff design --round' writes rounded settings into a case.
    """
    quick_start()
    from ....cases import read_case, write_rexs
    from ....cases.writing import with_blanks
    from ....core.errors import InputError
    from ....core.output_file import check_writable, whole_file
    from ...design.rounded_settings import rounded_case
    from ...report.summary_sheet import summary_sheet

    check_writable(output, case)
    suffix = output.suffix.lower()
    if suffix not in (".txt", ".html", ".rexs"):
        raise InputError(f"{output}: suffix = {output.suffix!r}: must be .txt, .html or .rexs")
    checked = read_case(case, allow_outside=outside_allowed())
    made = summary_sheet(checked, resolution)
    if suffix == ".rexs":
        for note in write_rexs(with_blanks(rounded_case(checked, resolution)), output):
            echo(note)
    else:
        with whole_file(output) as temporary:
            _ = temporary.write_text(made.page() if suffix == ".html" else made.text(), encoding="utf-8")
    echo(f"wrote {output}")
    for note in made.notes:
        echo(note, err=True)
    for line in made.effects:
        echo(line)
