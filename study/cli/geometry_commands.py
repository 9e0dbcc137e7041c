"""Commands that export teeth and correct machine settings: geometry without loads."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import click
from click.core import ParameterSource

from ..progress import working
from . import option
from .case_run import check_folders, check_output, outside_allowed
from .command import Command, echo
from .option_values import deviation_files, keyed_numbers, names, number_list, reader, two_counts

#: Options of ``export`` that go with a result, and those that go with a case.
CONTACT_OPTIONS = ("torque", "mesh_position")
GEOMETRY_OPTIONS = ("member", "flank", "rows", "columns", "margins", "tolerance", "teeth")
EDGES = ("toe", "heel", "root", "tip")
THICKNESS_LIMIT = 1000.0  # of a measured departure [um]


@reader
def flank_files(texts: tuple[str, ...]) -> dict[str, tuple[str, ...]]:
    """Files of measured flanks by member, at most one a flank."""
    values: dict[str, tuple[str, ...]] = {}
    for text in texts:
        for member, file in deviation_files((text,)).items():
            values[member] = (*values.get(member, ()), file)
            if len(values[member]) > 2:
                raise click.BadParameter(f"{text!r}: {member} comes more than twice; it has two flanks")
    return values


@reader
def thicknesses(text: str) -> dict[str, float]:
    """Measured excess of the tooth thickness by member [um]."""
    values = keyed_numbers(text, ("pinion", "gear"), "gear=12.5")
    for member, value in values.items():
        if not abs(value) <= THICKNESS_LIMIT:
            raise click.BadParameter(
                f"{member}={value:g}: must lie between -{THICKNESS_LIMIT:g} and {THICKNESS_LIMIT:g} um"
            )
    return values


@reader
def nodes(text: str) -> tuple[int, int]:
    """Numbers of nodes, lengthwise and along the profile."""
    nodes = two_counts(text, "LENGTHWISExPROFILE, such as 61x31")
    if min(nodes) < 5 or max(nodes) > 1001:
        raise click.BadParameter(f"{text!r}: both numbers must lie between 5 and 1001")
    return nodes


@reader
def teeth(text: str) -> int | str:
    """Number of teeth, or ``all``."""
    try:
        return text if text == "all" else int(text)
    except ValueError as error:
        raise click.BadParameter(f"{text!r}: must be a number of teeth, or all") from error


@reader
def margins(text: str) -> dict[str, float]:
    """Margins of a measuring grid [mm], by edge of the flank."""
    return keyed_numbers(text, EDGES, "toe=3,root=1.2")


@reader
def tolerance(text: str) -> tuple[float, float]:
    """Lower and upper limit of the deviation [um], of one number that number to both sides."""
    values = number_list(text, wanted := "a tolerance in um, or its lower and upper limit, such as 10 or -5,10")
    if len(values) > 2:
        raise click.BadParameter(f"{text!r}: must be {wanted}")
    return (0.0 - values[0], values[0]) if len(values) == 1 else (values[0], values[1])


@click.command(cls=Command)
@option.case("source", metavar="CASE|RESULT")
@option.output(
    "File to write; its suffix decides: .csv, .nc (measuring points), .step, .stp (CAD surfaces), .stl, .vtk, .vtu "
    "(meshes). Of a RESULT: .vtu, .rexs."
)
@option.choice("--member", ("pinion", "gear"), "Member to export.")
@option.choice("--flank", ("concave", "convex", "both"), "Flank of the member to export.", "both")
@option.value("--rows", "N", "Points: rows from root to tip.", "5", type=click.IntRange(2, 1001))
@option.value("--columns", "N", "Points: columns from toe to heel.", "9", type=click.IntRange(2, 1001))
@click.option(
    "--margins",
    callback=margins,
    metavar="toe=..,heel=..,root=..,tip=..",
    show_default="a tenth of face width and depth",
    help="Points: margins of the grid at the edges of the flank, in mm.",
)
@click.option(
    "--tolerance",
    callback=tolerance,
    metavar="T|LOWER,UPPER",
    show_default="no limits",
    help="Points: limits of the deviation in um, along the normal, one number for both sides; columns of the file.",
)
@option.value("--teeth", "N|all", "Surfaces and meshes: number of teeth.", "1", callback=teeth)
@option.value("--nodes", "LxP", "Surfaces and meshes: nodes of a flank, lengthwise x profile.", "61x31", callback=nodes)
@option.number("--torque", "T", "Result: torque at the pinion in N m, one of those of the result.", "the greatest")
@option.number(
    "--mesh-position", "Q", "Result: mesh position, from 0 to 1 over a pinion pitch, one of those of the result.", "0"
)
def export(source: str, output: Path, member: Any, flank: Any, **options: Any) -> None:
    """Export teeth or contact to other programs.

    Of CASE the teeth, as points, CAD surfaces or a mesh; of RESULT the contact on its teeth.

    RESULT is a file of 'easeoff run'. Its .vtu file, for ParaView and other programs that read VTK, holds the teeth of
    both members in mesh position with ease-off, contact pattern and pressure, and a strip for every loaded segment with
    its load, film, friction and temperature. Its .rexs file holds the case, and the contact points of the mesh cycle
    with ease-off, pressure, load and friction.
    """
    contact = {name: options.pop(name) for name in CONTACT_OPTIONS}
    if Path(source).suffix.lower() == ".nc":
        _export_contact(source, output, contact, options["nodes"])
        return
    given = [name for name, value in contact.items() if value is not None]
    if given:
        raise click.UsageError(f"--{given[0].replace('_', '-')}: must go with a RESULT, not with a case")
    _export_geometry(source, output, member, flank, options)


def _export_contact(source: str, output: Path, contact: dict[str, Any], nodes: tuple[int, int] | None) -> None:
    from ...core.errors import InputError
    from ...core.regular_file import named
    from ..report.contact_mesh import REXS_SUFFIX, export_contact
    from ..result import read_result

    context = click.get_current_context()
    foreign = [name for name in GEOMETRY_OPTIONS if context.get_parameter_source(name) == ParameterSource.COMMANDLINE]
    if foreign:
        raise click.UsageError(f"--{foreign[0]}: must go with a CASE, not with a result")
    check_output(output, source)
    chosen = {name: value for name, value in {**contact, "nodes": nodes}.items() if value is not None}
    of_vtu = sorted(set(chosen) - {"torque"})
    if of_vtu and output.suffix.lower() == REXS_SUFFIX:
        raise click.UsageError(f"--{of_vtu[0].replace('_', '-')}: must go with a .vtu file")
    tree = read_result(source)
    try:
        with working("contact on the teeth"):
            written = export_contact(tree, output, **chosen)
    except InputError as error:
        raise InputError(f"{named(source)}: {str(error).removeprefix('tree: ')}") from error
    echo(f"wrote {output}: {written}")


def _export_geometry(case: str, output: Path, member: Any, flank: Any, options: dict[str, Any]) -> None:
    from ...cases import read_case
    from ...geometry.formats import EdgeMargins
    from ..geometry_export import export as write

    check_output(output, case)
    given = {name: value for name, value in options.items() if value is not None}
    if "margins" in given:
        given["margins"] = EdgeMargins(**given["margins"])
    if given.get("teeth") == "all":
        given["teeth"] = None
    checked = read_case(case, allow_outside=outside_allowed())
    with working(f"teeth of the {member}"):
        written = write(checked, output, member, flank, given)
    echo(f"wrote {output}: {written}")


@click.command(cls=Command)
@option.case()
@click.option(
    "--flank",
    type=click.Choice(["drive", "coast"]),
    show_default="all that the files hold",
    help="Correct these flanks only: drive (concave pinion, convex gear) or coast.",
)
@option.deviation(
    "Measured grid of a member: a file, or the name of a shipped one. May be given for both members, and once for "
    "each flank of a member.",
    required=True,
    callback=flank_files,
)
@click.option(
    "--free",
    callback=names,
    metavar="NAME,...",
    show_default="those of the machine, no blades",
    help="Settings that may change, such as radial_distance,machine_root_angle; the message to a wrong one lists them.",
)
@option.choice(
    "--set-up",
    ("auto", "shared", "own"),
    "Whether both flanks of a member are cut in one set-up: auto, if their settings are equal.",
)
@click.option(
    "--thickness",
    callback=thicknesses,
    metavar="MEMBER=UM,...",
    show_default="not measured",
    help="By how much the normal thickness of the tooth was measured to be above the one designed, in um; of a shared "
    "set-up with both flanks measured.",
)
@option.output("Case file to write with the corrected settings.", required=False)
@option.force
@option.plots("Folder for topographies before and after.")
def correct(
    case: str, deviations: Any, set_up: str, output: Path | None, force: bool, plots: Path | None, **options: Any
) -> None:
    """Correct the machine settings of CASE for measured flanks.

    Flanks that share a set-up are corrected together. Printed are the global errors of the flanks, the settings to be
    set, rounded to what the machine can be set to, and the deviations predicted on the flanks cut with them.
    """
    from ...cases import read_case, write_case
    from ..case_correction import correct_case
    from ..summary.settings_report import correction_report

    if force and output is None:
        raise click.UsageError("--force: must go with --output")
    check_output(output, case, *(file for files in deviations.values() for file in files), suffix=".toml", force=force)
    check_folders(output, plots)
    shared = {"auto": None, "shared": True, "own": False}[set_up]
    checked = read_case(case, allow_outside=outside_allowed())
    with working("settings fitted to the measured flanks"):
        case_correction = correct_case(checked, deviations, shared=shared, **options)
    echo(correction_report(case_correction))
    if output is not None:
        write_case(case_correction.case, output, _executed(case, case_correction.corrections))
        echo(f"wrote {output}")
    if plots is not None:
        from ..plot.topography_chart import write_topographies

        for path in write_topographies(case_correction, plots, Path(case).stem):
            echo(f"wrote {path}")


def _executed(case: str, corrections: Any) -> str:
    """Comment of a corrected case."""
    from ..summary.settings_report import root_warnings

    flanks = "; ".join(
        f"{name} {' and '.join(flank.side for correction in member_corrections for flank in correction.flanks)}"
        for name, member_corrections in corrections.items()
    )
    set_ups = [(name, correction) for name, of_set_up in corrections.items() for correction in of_set_up]
    unchanged = [
        f"\nNothing to correct, {name}: {' and '.join(flank.side for flank in one.flanks)}; as designed."
        for name, one in set_ups
        if one.nothing
    ]
    warned = [f"\nWarning, {name}: {warning}" for name, one in set_ups for warning in root_warnings(one)]
    return (
        f"Settings to execute, by easeoff correct from {Path(case).name} for measured flanks: {flanks}.\n"
        "On the machine that cut the measured flanks they come near the flanks designed; on one without errors they "
        "cut others." + "".join(unchanged + warned)
    )
