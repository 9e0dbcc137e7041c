"""Options that several commands share, as decorators: ``@option.torque()``."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from functools import partial, reduce
from pathlib import Path
from typing import Any, TypeVar

import click

from .case_run import ALLOW_OUTSIDE
from .command import echo
from .option_values import assembly_errors, deviation_files, machine_resolution, numbers, reader, roughnesses, torques
from .word_completion import case_names, deviation_names, friction_models, oil_names, solver_names, support_names

Command = TypeVar("Command", bound=Callable[..., Any])

MISALIGNMENT = "E=..,P=..,G=..,Sigma=..|FILE"
THINNEST_COMPOUND = 0.5  # [um]; below it a thickness looks like mm
DEFLECTION_FILE = "or a table of deflections over the torque, with the columns torque, E, P, G, Sigma, flank"


def adding(*options: Any) -> Callable[[Any], Any]:
    """Decorator that adds options to a command, in their order."""

    def added(command: Any) -> Any:
        return reduce(lambda so_far, option: option(so_far), reversed(options), command)

    return added


def choice(name: str, words: Sequence[str], text: str, usual: str | None = None) -> Callable[[Command], Command]:
    """Option of a command: one of some words, the first or the usual one if it is left out."""
    return click.option(name, type=click.Choice(words), default=usual or words[0], help=text)


#: Option ``--flank`` of a command: drive or coast.
flank = choice("--flank", ("drive", "coast"), "Flanks in mesh: drive (concave pinion, convex gear) or coast.")
#: Option ``--force`` of a command that writes a case file.
force = click.option("--force", is_flag=True, help="Replace a case file that was edited or written by hand.")
#: Options ``--format`` and ``--form`` of a command that writes contact problems.
problem_format = adding(
    click.option(
        "--format",
        type=click.Choice(["nc", "mat", "npz", "qps", "mps", "hdf5", "qpbenchmark"]),
        show_default="suffix of the file",
        help="Format of contact problems: nc (netCDF), mat (MATLAB), npz (qpsolvers), qps or mps "
        "(Maros-Meszaros; HiGHS wants mps), hdf5 (FCLib), qpbenchmark (test set). From npz on the output is a folder.",
    ),
    click.option(
        "--form",
        type=click.Choice(["dense", "lifted", "dual"]),
        help="Form of the quadratic programme in npz, qps and mps.  [default: dense in npz, lifted in qps]",
    ),
)


def file(*names: str, text: str, folder: bool = False, **settings: Any) -> Callable[[Command], Command]:
    """Option of a command by its names: a file, or a folder that need not exist."""
    kind = click.Path(path_type=Path, file_okay=not folder)
    return click.option(*names, type=kind, help=text, **{"metavar": "FOLDER" if folder else "FILE", **settings})


def value(
    name: str, metavar: str, text: str, usual: str | None = None, **settings: Any
) -> Callable[[Command], Command]:
    """Option of a command: its value, its description, and in words what is taken without it."""
    return click.option(name, metavar=metavar, help=text, show_default=usual, **settings)


#: Option of a command: a number; arguments as of ``value``.
number = partial(value, type=float)


def output(text: str, *, required: bool = True, **settings: Any) -> Callable[[Command], Command]:
    """Option ``--output`` of a command: a file, described by a text; or a folder, by its ``metavar``."""
    return file("-o", "--output", text=text, required=required, **settings)


def plots(text: str = "Folder for pictures.") -> Callable[[Command], Command]:
    """Option ``--plots`` of a command that draws what it has computed."""
    return file("--plots", text=text, folder=True)


def torque(text: str = "Torques at the pinion in N m.", default: str = "from the case") -> Callable[[Command], Command]:
    """Option ``--torque`` of a command: torques, which are the argument ``torques``."""
    return click.option("--torque", "torques", callback=torques, metavar="T1,T2,...", show_default=default, help=text)


def misalignment(command: Command) -> Command:
    """Option ``--misalignment`` of a command: assembly errors, or deflections."""
    return click.option(
        "--misalignment",
        callback=reader(assembly_errors),
        metavar=MISALIGNMENT,
        show_default="from the case",
        help=f"Assembly errors in mm, Sigma in degrees; {DEFLECTION_FILE}.",
    )(command)


def further_misalignments(text: str, metavar: str) -> Callable[[Command], Command]:
    """Option ``--misalignment`` of a search, which may be repeated: further assemblies."""
    return click.option(
        "--misalignment",
        "misalignments",
        callback=reader(lambda texts: [assembly_errors(text) for text in texts]),
        multiple=True,
        metavar=metavar,
        help=f"{text} May be repeated.",
    )


def marking(
    text: str = "Thickness of the marking compound of the unloaded pattern in um.",
    default: str = "contact.separation of the case",
) -> Callable[[Command], Command]:
    """Option ``--marking`` of a command: thickness of the marking compound."""
    return number("--marking", "THICKNESS", text, default, callback=reader(_thickness))


def _thickness(value: float) -> float:
    """Thickness of the marking compound [um]; a line says so of one that looks like mm."""
    if 0.0 < value < THINNEST_COMPOUND:
        echo(f"--marking = {value:g}: thinner than any marking compound; um are meant, not mm?", err=True)
    return value


def solver(text: str = "Contact solver; MODULE:FUNCTION for one of your own.") -> Callable[[Command], Command]:
    """Option ``--solver`` of a command: a contact solver."""
    return click.option("--solver", metavar="NAME", shell_complete=solver_names, default="auto", help=text)


def deviation(text: str, **settings: Any) -> Callable[[Command], Command]:
    """Option ``--deviation`` of a command: files by member, described by a text."""
    return click.option(
        "--deviation",
        "deviations",
        multiple=True,
        shell_complete=deviation_names,
        metavar="MEMBER=FILE",
        help=text,
        **{"callback": reader(deviation_files), **settings},
    )


def case(name: str = "case", *, complete: Any = case_names, **settings: Any) -> Callable[[Any], Any]:
    """Argument of a command that reads a case or design, with ``--allow-outside``; see ``outside_allowed``."""
    allow_outside = click.option(
        "--allow-outside",
        is_flag=True,
        expose_value=False,
        callback=lambda ctx, _param, value: ctx.meta.update({ALLOW_OUTSIDE: value}),
        help="Open files outside the folder of the case, too, if the case names them, such as that of an oil.",
    )
    return adding(click.argument(name, shell_complete=complete, **settings), allow_outside)


_PAIR: tuple[Any, ...] = (
    case(),
    flank,
    misalignment,
    deviation(
        "Deviation of a member's flank from the designed one: a measured grid (a file, or the name of a shipped one) "
        "or a file of 'easeoff wear'. May be given for both members."
    ),
    click.option(
        "--interpolation",
        type=click.Choice(["spline", "smooth", "weighted_average"]),
        show_default="spline",
        help="Interpolation between the nodes of measured grids; smooth evens out their scatter.",
    ),
)
_DEVIATED = click.option(
    "--deviated",
    type=click.Choice(["ease_off", "surface"]),
    show_default="ease_off",
    help="How deviations are taken in: the ease-off is updated, or the deviating surfaces are computed.",
)
supports = click.option(
    "--supports",
    metavar="NAME|FILE",
    show_default="from the case",
    shell_complete=support_names,
    help="Shafts, bearings and housing that hold pinion and gear: a file, or the name of shipped ones.",
)
#: The argument CASE and the options of its pair: flank, misalignment, deviations; with a solver, without load, and of
#: a whole analysis.
pair = adding(*_PAIR, solver())
unloaded = adding(*_PAIR, _DEVIATED)
analysis = adding(
    *_PAIR,
    solver(),
    click.option(
        "--edge-contact/--lines-only",
        "edge_contact",
        default=None,
        show_default="edges, unless the case says lines only",
        help="Contact of tooth edges beside the contact lines, or of the lines only.",
    ),
    torque(),
    supports,
    _DEVIATED,
)
#: Options of friction: operating conditions and models.
friction = adding(
    click.option(
        "--speed",
        callback=reader(numbers),
        metavar="N1,N2,...",
        help="Speeds of the pinion in 1/min, or FROM:TO:COUNT; adds friction, power loss and efficiency. The table "
        "[friction] of the case replaces the defaults of this and the following options.",
    ),
    value("--oil", "OIL", "Lubricant: the name of a shipped one, or a TOML file.", "75w90", shell_complete=oil_names),
    click.option(
        "--temperature",
        callback=reader(lambda text: numbers(text, from_zero=True)),
        metavar="T1,T2,...",
        show_default="90",
        help="Oil temperatures in degC, or FROM:TO:COUNT.",
    ),
    click.option(
        "--roughness",
        callback=reader(roughnesses),
        metavar="R1,R2,...",
        show_default="0.8",
        help="RMS roughnesses Rq of the flanks in um, each a number or PINION/GEAR.",
    ),
    click.option(
        "--friction-model",
        metavar="MODEL",
        shell_complete=friction_models,
        show_default="kolivand_blended",
        help="Friction coefficient: a model (kolivand_blended, kolivand, mixed_lubrication, xu_kahraman, "
        "benedict_kelly), or a number from 0 to 1.",
    ),
    value("--film-heating", "FACTOR", "Heat of the inlet thins the film: none, gupta_cheng or murch_wilson.", "none"),
    click.option(
        "--clamp-temperature/--no-clamp-temperature",
        default=None,
        show_default="no",
        help="Beyond the oil's data, take the last value and flag it.",
    ),
    click.option(
        "--friction-feedback/--no-friction-feedback",
        default=None,
        show_default="no",
        help="Include friction in the balance of torque, which changes the normal forces.",
    ),
)
#: Option ``--resolution``: steps of the settings on the machine.
resolution = click.option(
    "--resolution",
    callback=machine_resolution,
    metavar="STEP=VALUE,...",
    help="Steps of the settings in mm and degrees: length, angle, roll, modified_roll, motion, blade_radius, "
    "blade_angle, edge_radius.  [default: 0.001 mm, 0.001 deg, ...]",
)
