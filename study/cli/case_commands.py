"""Commands that list, design and convert cases, and write templates, summary sheets and files of lubricants."""

from __future__ import annotations

import os
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from ...core.errors import EaseoffError, InputError
from ..progress import working
from . import option
from .case_run import check_output, outside_allowed
from .command import Command, echo, end_uncertified, next_commands, quick_start
from .word_completion import design_names, template_names

if TYPE_CHECKING:
    from ...geometry.cutting.named_settings import MachineResolution

#: The command that takes a file of each kind; ``FILE`` stands for it.
TAKEN_BY = {
    "case": ("run", "FILE", "-o", "RESULT.nc"),
    "design": ("design", "FILE", "-o", "CASE.toml"),
    "supports": ("run", "CASE", "-o", "RESULT.nc", "--supports", "FILE"),
    "oil": ("run", "CASE", "-o", "RESULT.nc", "--speed", "SPEED", "--oil", "FILE"),
    "load-cases": ("run", "CASE", "-o", "RESULT.nc", "--load-cases", "FILE"),
}


@click.command(cls=Command)
@click.argument("kind", type=click.Choice(list(TAKEN_BY)))
@click.argument("name", required=False, shell_complete=template_names)
@option.output(
    "File to write: .toml, of load cases .csv.", required=False, show_default="NAME, if it is that of a file"
)
@click.option("--force", is_flag=True, help="Replace a file that was edited or written by hand.")
@option.number("--ratio", "R", "Of a design, with --torque: size a pair of this ratio, 1 to 10.")
@click.option("--torque", type=float, metavar="T", help="Torque at the pinion in N m: of vehicles peak, else lasting.")
@click.option("--speed", type=float, metavar="N", help="Speed of the pinion in 1/min, for the dynamic factor.")
@click.option("--shaft-angle", type=float, metavar="ANGLE", help="In degrees, 60 to 120.  [default: 90]")
@click.option("--offset", type=float, metavar="E", help="Hypoid offset in mm.  [default: 0]")
@click.option("--use", metavar="USE", help="industrial, automotive, truck or aircraft.  [default: industrial]")
def new(kind: str, name: str | None, output: Path | None, force: bool, **sizing: Any) -> None:
    """Write a commented template of an input file of a KIND.

    The template can be used as it is: its numbers are those of an example. Keys that the example does not give are in
    it, too, switched off by a comment sign, with their meaning, unit and default.

    NAME is what the numbers are taken from: of a case or design face-milled (the default), face-hobbed, or the name of
    a shipped one; of supports and oil the name of a shipped one; of load cases the shipped case whose torques they
    take. 'easeoff new KIND FILE' is short for 'easeoff new KIND -o FILE'.

    With --ratio and --torque a design is a first size by published rules, which are told: teeth, diameter, face width,
    spiral angle, cutter.
    """
    from ...cases.schema.file_templates import TEMPLATE_KINDS, sized_design, template
    from ...cases.writing import write_sealed

    if output is None and name is not None and Path(name).suffix == TEMPLATE_KINDS[kind].suffix:
        output, name = Path(name), None
    if output is None:
        raise click.UsageError(
            f"-o: must be given, as in 'easeoff new {kind} -o my{TEMPLATE_KINDS[kind].suffix}', or short 'easeoff new "
            f"{kind} my{TEMPLATE_KINDS[kind].suffix}'"
        )
    check_output(output, suffix=TEMPLATE_KINDS[kind].suffix, force=force)
    given = {word: value for word, value in sizing.items() if value is not None}
    if given and not (kind == "design" and {"ratio", "torque"} <= set(given)):
        raise click.UsageError(f"--{min(given).replace('_', '-')}: belongs to a design with both --ratio and --torque")
    text, values = sized_design(name, **given) if given else (template(kind, name), ())
    write_sealed(text, output)
    echo("\n".join([*values, f"wrote {output}"]))
    next_commands([output if word == "FILE" else word for word in TAKEN_BY[kind]])


@click.command(cls=Command)
@click.option("--viscosity-40", type=float, required=True, metavar="V", help="Kinematic viscosity at 40 degC in mm2/s.")
@option.number("--viscosity-100", "V", "Kinematic viscosity at 100 degC in mm2/s.", required=True)
@click.option("--density", type=float, required=True, metavar="RHO", help="Density at 15 degC in kg/m3.")
@click.option("--base-oil", required=True, metavar="BASE", help="mineral, pao, pag or ester.")
@click.option("--title", metavar="TEXT", help="What the oil is.  [default: from the numbers]")
@click.option("--source", metavar="TEXT", default="its data sheet", help="Where the numbers are from.")
@option.output("TOML file to write, for --oil and the table [friction].")
def oil(output: Path, **numbers: Any) -> None:
    """Make a lubricant's file from the numbers of a data sheet.

    The pressure-viscosity coefficient is estimated from viscosity and base oil; if you have measured values, write them
    into the file.
    """
    from ...friction import data_sheet_lubricant, write_lubricant

    check_output(output)
    if output.suffix.lower() != ".toml":
        raise InputError(f"{output}: must be a name that ends in .toml")
    made = data_sheet_lubricant(output.stem, **numbers)
    write_lubricant(made, output)
    for temperature in (40.0, 70.0, 100.0):
        state = made.at(temperature)
        echo(
            f"{temperature:3.0f} degC: {1e3 * float(state.viscosity):.4g} mPa s, pressure-viscosity coefficient "
            f"{1e9 * float(state.pressure_viscosity):.3g} / GPa (estimated)"
        )
    echo(f"wrote {output}")
    next_commands(("run", "CASE", "-o", "RESULT.nc", "--speed", "SPEED", "--oil", output))


@click.command(cls=Command)
@option.case()
@option.output("Sheet to write, .txt, .html or .rexs.")
@option.resolution
@click.option("--without-vh", is_flag=True, help="Leave out the V-H check of both sides, which takes some seconds.")
def sheet(case: str, output: Path, resolution: MachineResolution | None, without_vh: bool) -> None:
    """Write the summary sheet of a case, for the shop.

    What it makes, inspects and sets: blanks, teeth, backlash, tolerances by the accuracy grade in [drawing], cutters
    and machine settings of every flank, rounded to the resolution of the machine, with what rounding changes of the
    ease-off, what is doubtful of teeth and set-ups, and the V-H check of both sides; as REXS blanks and rounded
    settings alone. The case stays as it is; 'easeoff design --round' writes rounded settings into a case.
    """
    quick_start()
    from ...cases import read_case, write_rexs
    from ...cases.writing import with_blanks
    from ...core.output_file import whole_file
    from ..design.rounded_settings import rounded_case
    from ..summary.summary_sheet import summary_sheet
    from ..vh import vh_check

    check_output(output, case)
    suffix = output.suffix.lower()
    if suffix not in (".txt", ".html", ".rexs"):
        raise InputError(f"{output}: suffix = {output.suffix!r}: must be .txt, .html or .rexs")
    checked = read_case(case, allow_outside=outside_allowed())
    vh_checks = {}
    if not without_vh and suffix != ".rexs":
        for flank in checked.flanks:
            vh_checks[flank] = vh_check(checked, flank=flank, progress=True)
    made = summary_sheet(checked, resolution, vh_checks=vh_checks)
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


@click.command(cls=Command)
def cases() -> None:
    """List shipped cases and other shipped files.

    Cases, designs, supports, lubricants and measured flanks. Each is given by its name, in place of a file.
    """
    quick_start()
    from ...cases.shipped_files import shipped_cases, shipped_designs, shipped_deviations, shipped_supports, titles
    from ...friction import lubricants

    groups = {
        "cases: easeoff run CASE -o RESULT.nc": shipped_cases(),
        "designs: easeoff design DESIGN -o CASE.toml": shipped_designs(),
        "supports: --supports NAME": shipped_supports(),
        "lubricants: --oil NAME": titles(Path(lubricants.__path__[0])),
        "measured flanks: --deviation MEMBER=NAME": {name: _measured_title(name) for name in shipped_deviations()},
    }
    width = max(len(name) for group in groups.values() for name in group)
    parts = [
        "\n".join([head, *(f"  {name:<{width}}  {title}" for name, title in group.items())])
        for head, group in groups.items()
    ]
    echo("\n\n".join(parts))


def _measured_title(name: str) -> str:
    """Title of a shipped file of measured flanks, from its name CASE-STATE-MEMBER."""
    case, state, member = name.rsplit("-", 2)
    return f"{state} {member} flank of the case {case}"


@click.command(cls=Command)
@option.case("design", complete=design_names)
@option.output("Case file to write, .toml.")
@option.force
@click.option("--report", is_flag=True, help="Print the blanks, the moved settings and the remaining ease-off.")
@click.option("--round", "rounding", is_flag=True, help="Write settings rounded to the resolution of the machine.")
@option.resolution
def design(
    design: str, output: Path, force: bool, report: bool, rounding: bool, resolution: MachineResolution | None
) -> None:
    """Design a pair and write it as a case file.

    DESIGN is the name of a shipped design or the path of a design file: basic data and the wanted ease-off. The blanks
    follow from the basic data; the pinion is fitted to the ease-off.
    """
    quick_start()
    from ...cases import read_design, write_case
    from ...cases.conversion import machine_resolution
    from ..design.case_design import design_case
    from ..design.design_check import rounding_limits
    from ..design.rounded_settings import rounded_case, rounding_effect
    from ..summary.settings_report import design_report, summary_lines
    from ..summary.summary_sheet import effect_line

    if resolution is not None and not rounding:
        raise InputError("--resolution: must go with --round")
    check_output(output, design, suffix=".toml", force=force)
    checked = read_design(design, allow_outside=outside_allowed())
    with working("blanks, gear, and a pinion fitted to the ease-off"):
        case, findings = design_case(checked)
    effects = {}
    if rounding:
        exact, steps = case, resolution or machine_resolution(checked.resolution)
        case = rounded_case(case, steps, *rounding_limits(checked, findings, case))
        effects = rounding_effect(exact, case)
    write_case(case, output, f"Made by easeoff from the design {Path(design).name}.")
    echo(f"wrote {output}")
    echo(design_report(findings) if report else "\n".join(summary_lines(findings)))
    for side, effect in effects.items():
        echo(effect_line(side, effect))
    if not findings.analysable:
        end_uncertified(["no analysis can take this case yet: a member has no whole tooth, see above"])
    table = case.friction
    outside = table is not None and table.seen_from(output.parent).is_outside
    next_commands(("run", output, "-o", output.with_suffix(".nc"), *(["--allow-outside"] if outside else [])))


@click.command(cls=Command)
@option.case("source", metavar="INPUT")
@option.output(
    "File to write: case file (.toml) or REXS file (.rexs, .xml); or contact problems (.nc, .mat, or a folder)."
)
@option.force
@option.problem_format
def convert(source: str, output: Path, force: bool, format: str | None, form: str | None) -> None:
    """Convert cases or contact problems to another format.

    INPUT is the name of a shipped case, a case file (.toml), a REXS file (.rexs, .xml), or a session script of
    Transmission3D or HypoidFaceMilled (.ses, .txt). What the output cannot hold is listed. Or it is a file of contact
    problems (.nc, .mat, .npz, .qps, .mps, .hdf5), or a folder of such files with one problem each.
    """
    from ...cases import read_case, read_rexs, read_session_script, write_case, write_rexs
    from ...cases.conversion import given_pair
    from ...geometry.pair.tooth_thickness import contradictions
    from ..compare.problem_export import SUFFIXES as PROBLEM_SUFFIXES, convert_problems

    suffix, target = Path(source).suffix.lower(), output.suffix.lower()
    if suffix in PROBLEM_SUFFIXES or os.path.isdir(source):
        echo(convert_problems(Path(source), output, format, form))
        return
    if format is not None or form is not None:
        raise InputError(f"{source}: suffix = {suffix!r}: must be that of contact problems, with --format or --form")
    if target not in (".toml", ".rexs", ".xml"):
        raise InputError(f"{output}: suffix = {target!r}: must be .toml, .rexs or .xml")
    check_output(output, source, force=force if target == ".toml" else None)
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
