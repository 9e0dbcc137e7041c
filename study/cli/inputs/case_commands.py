"""Commands that list, design and convert cases."""

from __future__ import annotations

import os
import sys
from pathlib import Path
from typing import TYPE_CHECKING

import click

from ....core.errors import EaseoffError, InputError
from ..command import Command, quick_start
from ..exit_codes import EXIT_UNCERTIFIED
from ..options.shared_options import (
    allow_outside_option,
    echo,
    force_option,
    next_commands,
    output_option,
    outside_allowed,
    problem_format_options,
)
from ..terminal.terminal_bar import working
from ..terminal.word_completion import case_names, design_names
from .sheet_command import resolution_option

if TYPE_CHECKING:
    from ....geometry.cutting.named_settings import MachineResolution


@click.command(cls=Command)
def cases() -> None:
    """List shipped cases and other shipped files.

    Cases, designs, supports, lubricants and measured flanks. Each is given by its name, in place of a file.
    """
    quick_start()
    from ....cases.reading import shipped_cases, shipped_designs, shipped_deviations, shipped_supports
    from ....friction import available_lubricants, lubricant

    groups = {
        "cases: easeoff run CASE -o RESULT.nc": shipped_cases(),
        "designs: easeoff design DESIGN -o CASE.toml": shipped_designs(),
        "supports: --supports NAME": shipped_supports(),
        "lubricants: --oil NAME": {name: lubricant(name).title for name in available_lubricants()},
        "measured flanks: --deviation MEMBER=NAME": {name: _measured_title(name) for name in shipped_deviations()},
    }
    width = max(len(name) for group in groups.values() for name in group)
    parts = [
        "\n".join([head, *(f"  {name:<{width}}  {title}" for name, title in group.items())])
        for head, group in groups.items()
    ]
    echo("\n\n".join(parts))


def _measured_title(name: str) -> str:
    """What a shipped file of measured flanks holds, from its name: CASE-STATE-MEMBER."""
    case, state, member = name.rsplit("-", 2)
    return f"{state} {member} flank of the case {case}"


@click.command(cls=Command)
@click.argument("design", shell_complete=design_names)
@allow_outside_option
@output_option("Case file to write, .toml.")
@force_option
@click.option("--report", is_flag=True, help="Print the blanks, the moved settings and the remaining ease-off.")
@click.option("--round", "rounding", is_flag=True, help="Write settings rounded to the resolution of the machine.")
@resolution_option
def design(
    design: str, output: Path, force: bool, report: bool, rounding: bool, resolution: MachineResolution | None
) -> None:
    """Design a pair and write it as a case file.

    DESIGN is the name of a shipped design or the path of a design file: basic data and the wanted ease-off. The blanks
    follow from the basic data; the pinion is fitted to the ease-off.
    """
    quick_start()
    from ....cases import read_design, write_case
    from ....cases.conversion import machine_resolution
    from ....cases.writing import require_replaceable
    from ....core.output_file import check_writable
    from ...design.case_design import design_case
    from ...design.design_check import rounding_limits
    from ...design.rounded_settings import rounded_case, rounding_effect
    from ...report.design_report import design_report, summary_lines
    from ...report.summary_sheet import effect_line

    if resolution is not None and not rounding:
        raise InputError("--resolution: must go with --round")
    check_writable(output, design, suffix=".toml")
    require_replaceable(output, force)
    checked = read_design(design, allow_outside=outside_allowed())
    with working("blanks, gear, and a pinion fitted to the ease-off"):
        case, found = design_case(checked)
    effects = {}
    if rounding:
        exact, steps = case, resolution or machine_resolution(checked.resolution)
        case = rounded_case(case, steps, *rounding_limits(checked, found, case))
        effects = rounding_effect(exact, case)
    write_case(case, output, f"Made by easeoff from the design {Path(design).name}.")
    echo(f"wrote {output}")
    echo(design_report(found) if report else "\n".join(summary_lines(found)))
    for side, effect in effects.items():
        echo(effect_line(side, effect))
    if not found.analysable:
        echo("no analysis can take this case yet: a member has no whole tooth, see above", err=True)
        sys.exit(EXIT_UNCERTIFIED)
    table = case.friction
    outside = table is not None and table.seen_from(output.parent).is_outside
    next_commands(("run", output, "-o", output.with_suffix(".nc"), *(["--allow-outside"] if outside else [])))


@click.command(cls=Command)
@click.argument("source", metavar="INPUT", shell_complete=case_names)
@allow_outside_option
@output_option(
    "File to write: case file (.toml) or REXS file (.rexs, .xml); or contact problems (.nc, .mat, or a folder)."
)
@force_option
@problem_format_options
def convert(source: str, output: Path, force: bool, format: str | None, form: str | None) -> None:
    """Convert cases or contact problems to another format.

    INPUT is the name of a shipped case, a case file (.toml), a REXS file (.rexs, .xml), or a session script of
    Transmission3D or HypoidFaceMilled (.ses, .txt). What the output cannot hold is listed. Or it is a file of contact
    problems (.nc, .mat, .npz, .qps, .mps, .hdf5), or a folder of such files with one problem each.
    """
    from ....cases import read_case, read_rexs, read_session_script, write_case, write_rexs
    from ....cases.conversion import given_pair
    from ....cases.writing import require_replaceable
    from ....core.output_file import check_writable
    from ....geometry.pair.tooth_thickness import contradictions
    from ...compare.problem_export import SUFFIXES as PROBLEM_SUFFIXES
    from ...compare.problem_export import convert_problems

    suffix, target = Path(source).suffix.lower(), output.suffix.lower()
    if suffix in PROBLEM_SUFFIXES or os.path.isdir(source):
        echo(convert_problems(Path(source), output, format, form))
        return
    if format is not None or form is not None:
        raise InputError(f"{source}: suffix = {suffix!r}: must be that of contact problems, with --format or --form")
    if target not in (".toml", ".rexs", ".xml"):
        raise InputError(f"{output}: suffix = {target!r}: must be .toml, .rexs or .xml")
    check_writable(output, source)
    if target == ".toml":
        require_replaceable(output, force)
    notes: list[str] = []
    if suffix in ("", ".toml"):
        case = read_case(source, allow_outside=outside_allowed())
    elif suffix in (".rexs", ".xml"):
        case, notes = read_rexs(source)
    elif suffix in (".ses", ".txt"):
        case, notes = read_session_script(source)
    else:
        raise InputError(
            f"{source}: suffix = {suffix!r}: must be .toml, .rexs, .xml, .ses or .txt, or of contact problems "
            f"{', '.join(PROBLEM_SUFFIXES)}"
        )
    try:
        notes += [f"Warning: {text}" for text in contradictions(given_pair(case))]
    except EaseoffError as error:  # teeth that an analysis refuses can be converted
        notes.append(f"Warning: {error}")
    if target == ".toml":
        write_case(case, output, "\n".join([f"Made by easeoff from {Path(source).name}.", *notes]))
    else:
        notes = notes + write_rexs(case, output)
    for note in notes:
        echo(note)
    echo(f"wrote {output}")
