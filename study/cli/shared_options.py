"""Options that several commands share, and the values of options.

Reading of option texts: lists of numbers, numbers by member, and KEY=NUMBER pairs.
"""

from __future__ import annotations

import os
import re
import shlex
import sys
from collections.abc import Callable, Sequence
from functools import reduce
from itertools import pairwise
from pathlib import Path
from typing import TYPE_CHECKING, Any, TypeVar

import click

from ...core.errors import printable_lines
from .command import EXIT_UNCERTIFIED, as_given
from .word_completion import case_names, deviation_names, solver_names

if TYPE_CHECKING:
    from ...cases import Case
    from ...cases.deflections import Deflections
    from ...geometry.pair.assembly import Misalignment

WHOLE_NUMBER = re.compile(r"[+-]?\d+")


def reader(read: Callable[[Given], Value]) -> Callable[[click.Context, click.Parameter, Given | None], Value | None]:
    """Callback of an option by the function that reads what is given; ``None`` where the option is left out."""

    def callback(_ctx: click.Context, _param: click.Parameter, given: Given | None) -> Value | None:
        return None if given is None else read(given)

    return callback


def number_list(text: str, wanted: str, *, from_zero: bool = True) -> list[float]:
    """Numbers separated by commas, blanks allowed; ``wanted`` says in messages what the text must be.

    Unless ``from_zero``, a 0 before another whole number is taken for a decimal comma and refused.
    """
    try:
        values = [float(part) for part in text.split(",")]
    except ValueError as error:
        raise click.BadParameter(f"{text!r}: must be {wanted}") from error
    refuse_decimal_commas(text, from_zero=from_zero)
    return values


def refuse_decimal_commas(text: str, *, from_zero: bool = True) -> None:
    """Refuse a list of whole numbers that looks like a number with a decimal comma, as ``50,5`` or ``0,8``.

    A list with a decimal point may be in any order; three or more whole numbers may fall from the first to the last.
    """
    parts = [part.strip() for part in text.split(",")]
    if len(parts) < 2 or not all(WHOLE_NUMBER.fullmatch(part) for part in parts):
        return
    numbers = [float(part) for part in parts]
    # Of a value that comes twice the caller says so.
    steps = [second - first for first, second in pairwise(numbers)]
    falling = len(set(numbers)) == len(numbers) and any(step < 0.0 for step in steps)
    falling &= len(steps) == 1 or any(step > 0.0 for step in steps)
    padded = any(re.fullmatch(r"0\d+", part) for part in parts[1:])
    zero = min(numbers) == 0.0 and not from_zero
    if not (falling or padded or zero):
        return
    listed = ",".join(f"{value:g}" for value in sorted(set(numbers)))
    order = f"whole numbers in a list must increase, as in {listed}; " if falling and not (padded or zero) else ""
    raise click.BadParameter(f"{text!r}: {order}a decimal has a point: {parts[0]}.{parts[1].lstrip('+-')}")


def by_member(text: str, quantity: str, example: str) -> list[float]:
    """A number for both members, or one each, from PINION/GEAR."""
    try:
        entries = [float(part) for part in text.split("/")]
    except ValueError:
        entries = []
    if len(entries) not in (1, 2):
        point = "; a decimal has a point" if "," in text else ""
        raise click.BadParameter(f"{text!r}: must be {quantity}, or PINION/GEAR, such as {example}{point}")
    return entries


def keyed_numbers(text: str, keys: Sequence[str], example: str) -> dict[str, float]:
    """Numbers by key, from KEY=NUMBER separated by commas."""
    values: dict[str, float] = {}
    for part in text.split(","):
        key, equals, number = (piece.strip() for piece in part.partition("="))
        if not equals and values and WHOLE_NUMBER.fullmatch(key):
            raise click.BadParameter(
                f"{text!r}: {key!r} has no key; a decimal has a point, and pairs are separated by commas: {example}"
            )
        try:
            value = float(number)
        except ValueError as error:
            raise click.BadParameter(f"{part.strip()!r}: must be KEY=NUMBER, such as {example}") from error
        if key not in keys:
            raise click.BadParameter(f"{key!r}: must be one of {', '.join(keys)}")
        if key in values:
            raise click.BadParameter(f"{text!r}: {key} comes twice")
        values[key] = value
    return values


THINNEST_COMPOUND = 0.5  # [um]; below it a thickness looks like mm

# Everything heavy is imported where it is needed: ``easeoff --help`` stays quick.

Command = TypeVar("Command", bound=Callable[..., Any])
Given = TypeVar("Given")
Value = TypeVar("Value")

MISALIGNMENT_KEYS = ("E", "P", "G", "Sigma")
MISALIGNMENT = "E=..,P=..,G=..,Sigma=..|FILE"
DEFLECTION_FILE = "or a table of deflections over the torque, with the columns torque, E, P, G, Sigma, flank"
THICKNESS_LIMIT = 1000.0  # of a measured departure [um]
EDGES = ("toe", "heel", "root", "tip")
ALLOW_OUTSIDE = "easeoff.allow_outside"


def adding(*options: Any) -> Callable[[Any], Any]:
    """Decorator that adds options to a command, in their order."""

    def added(command: Any) -> Any:
        return reduce(lambda so_far, option: option(so_far), reversed(options), command)

    return added


#: Option ``--flank`` of a command: drive or coast.
flank_option = click.option(
    "--flank",
    type=click.Choice(["drive", "coast"]),
    default="drive",
    help="Flanks in mesh: drive (concave pinion, convex gear) or coast.",
)
#: Option ``--force`` of a command that writes a case file.
force_option = click.option("--force", is_flag=True, help="Replace a case file that was edited or written by hand.")
#: Options ``--format`` and ``--form`` of a command that writes contact problems.
problem_format_options = adding(
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


def output_option(text: str, *, required: bool = True, **settings: Any) -> Callable[[Command], Command]:
    """Option ``--output`` of a command: a file, described by a text; or a folder, by its ``metavar``."""
    return click.option(
        *("-o", "--output"),
        type=click.Path(path_type=Path),
        required=required,
        help=text,
        **{"metavar": "FILE", **settings},
    )


def plots_option(text: str = "Folder for pictures.") -> Callable[[Command], Command]:
    """Option ``--plots`` of a command that draws what it has computed."""
    return click.option("--plots", type=click.Path(path_type=Path, file_okay=False), metavar="FOLDER", help=text)


def torque_option(
    text: str = "Torques at the pinion in N m.", default: str = "from the case"
) -> Callable[[Command], Command]:
    """Option ``--torque`` of a command: torques, which are the argument ``torques``."""
    return click.option("--torque", "torques", callback=torques, metavar="T1,T2,...", show_default=default, help=text)


def misalignment_option(command: Command) -> Command:
    """Option ``--misalignment`` of a command: assembly errors, or deflections."""
    return click.option(
        "--misalignment",
        callback=reader(misalignment),
        metavar=MISALIGNMENT,
        show_default="from the case",
        help=f"Assembly errors in mm, Sigma in degrees; {DEFLECTION_FILE}.",
    )(command)


def further_misalignments_option(text: str, metavar: str) -> Callable[[Command], Command]:
    """Option ``--misalignment`` of a search, which may be repeated: further assemblies."""
    return click.option(
        "--misalignment",
        "misalignments",
        callback=reader(lambda texts: [misalignment(text) for text in texts]),
        multiple=True,
        metavar=metavar,
        help=f"{text} May be repeated.",
    )


def marking_option(
    text: str = "Thickness of the marking compound of the unloaded pattern in um.",
    default: str = "contact.separation of the case",
) -> Callable[[Command], Command]:
    """Option ``--marking`` of a command: thickness of the marking compound."""
    return click.option(
        "--marking", type=float, callback=reader(_thickness), metavar="THICKNESS", show_default=default, help=text
    )


def solver_option(text: str = "Contact solver; MODULE:FUNCTION for one of your own.") -> Callable[[Command], Command]:
    """Option ``--solver`` of a command: a contact solver."""
    return click.option("--solver", metavar="NAME", shell_complete=solver_names, default="auto", help=text)


def deviation_option(text: str, **settings: Any) -> Callable[[Command], Command]:
    """Option ``--deviation`` of a command: files by member, described by a text."""
    return click.option(
        *("--deviation", "deviations"),
        multiple=True,
        shell_complete=deviation_names,
        metavar="MEMBER=FILE",
        help=text,
        **{"callback": reader(deviations), **settings},
    )


def case_argument(name: str = "case", *, complete: Any = case_names, **settings: Any) -> Callable[[Any], Any]:
    """Argument of a command that reads a case or design, with ``--allow-outside``; see ``outside_allowed``."""
    allow_outside = click.option(
        "--allow-outside",
        is_flag=True,
        expose_value=False,
        callback=_keep_allowed,
        help="Open files outside the folder of the case, too, if the case names them, such as that of an oil.",
    )
    return adding(click.argument(name, shell_complete=complete, **settings), allow_outside)


def _keep_allowed(ctx: click.Context, _param: click.Parameter, value: bool) -> None:
    ctx.meta[ALLOW_OUTSIDE] = value


def outside_allowed() -> bool:
    """True if ``--allow-outside`` was given to the command that runs."""
    return bool(click.get_current_context().meta.get(ALLOW_OUTSIDE, False))


def check_output(output: Path | None, *sources: object, suffix: str | None = None, force: bool | None = None) -> None:
    """Refuse a file to write, if there is one, that cannot be written or is one of the files read.

    With ``force`` false a case file that was edited by hand, too.
    """
    from ...core.output_file import check_writable

    if output is None:
        return
    check_writable(output, *(str(source) for source in sources if source is not None), suffix=suffix)
    if force is not None:
        from ...cases.writing import require_replaceable

        require_replaceable(output, force)


def opened_case(case: str, output: Path | None, *sources: object, supports: str | None = None) -> Case:
    """The case of a name or path, on the supports of ``--supports``, for a netCDF file to write; see `check_output`."""
    from ...cases import read_case, with_supports

    checked = read_case(case, allow_outside=outside_allowed())
    oil = None if checked.friction is None else checked.friction.oil_file
    check_output(output, case, supports, oil, *sources, suffix=".nc")
    return checked if supports is None else with_supports(checked, supports)


def end_uncertified(failures: Sequence[str]) -> None:
    """End by the exit code of an uncertified result if there are failures, and say them."""
    if failures:
        echo("\n".join(failures), err=True)
        sys.exit(EXIT_UNCERTIFIED)


def check_folders(output: Path | None, plots: Path | None, **folders: Path | None) -> None:
    """Refuse folders, by the names of their options, with the name of the output, and pictures that have no place."""
    from ...core.output_file import check_folder

    for option, folder in {**folders, "plots": plots}.items():
        if folder is not None and output is not None and os.path.abspath(folder) == os.path.abspath(output):
            raise click.UsageError(f"--{option} = {str(folder)!r}: must be another name than that of the file")
    if plots is not None:
        check_folder(plots, "pictures")


def echo(text: str, *, err: bool = False) -> None:
    """Print lines with foreign text in them, which must not steer the terminal."""
    click.echo(printable_lines(as_given(text)), err=err)


def next_commands(*commands: Sequence[object]) -> None:
    """Say which commands take what was written; each is given by its words after ``easeoff``."""
    words = (shlex.join(["easeoff", *map(str, command)]) for command in commands)
    echo(f"next: {', or '.join(words)}")


@reader
def torques(text: str) -> tuple[float, ...]:
    """Torques at the pinion [N m], rising; a line says so of those that were given otherwise."""
    values = number_list(text, "numbers in N m separated by commas, such as 50,250,500", from_zero=False)
    for value in values:
        if not 0.0 < value < 1e7:
            coast = "; --flank coast analyses the flanks of the other sense of the torque" if value < 0.0 else ""
            raise click.BadParameter(f"{value:g}: must be greater than 0 and below 1e7 N m{coast}")
        if values.count(value) > 1:
            raise click.BadParameter(f"{text!r}: {value:g} comes twice")
    if values != sorted(values):
        echo(f"torques in rising order: {', '.join(f'{value:g}' for value in sorted(values))} N m", err=True)
    return tuple(sorted(values))


def _thickness(value: float) -> float:
    """Thickness of the marking compound [um]; a line says so of one that looks like mm."""
    if 0.0 < value < THINNEST_COMPOUND:
        echo(f"--marking = {value:g}: thinner than any marking compound; um are meant, not mm?", err=True)
    return value


def misalignment(text: str) -> Misalignment | Deflections:
    """Assembly errors [mm, rad], from mm and degrees, or from the file of a table over the torque."""
    import math

    if os.path.isfile(text):
        from ...cases.deflection_table import read_deflections

        return read_deflections(text)

    from ...geometry.pair.assembly import Misalignment

    if "=" not in text:
        wanted = "E=0.15,P=-0.12, or the file of a table of deflections; there is no file of this name"
        raise click.BadParameter(f"{text!r}: must be KEY=NUMBER, such as {wanted}")
    values = keyed_numbers(text, MISALIGNMENT_KEYS, "E=0.15,P=-0.12")
    for key, value in values.items():
        if not abs(value) < 10.0:
            raise click.BadParameter(f"{key}={value:g}: must lie between -10 and 10 (mm, Sigma in degrees)")
    offset, pinion_axial, gear_axial, shaft_angle = (values.get(key, 0.0) for key in MISALIGNMENT_KEYS)
    return Misalignment(offset, pinion_axial, gear_axial, math.radians(shaft_angle))


def deviations(texts: tuple[str, ...]) -> dict[str, str]:
    """Files of deviations by member."""
    values: dict[str, str] = {}
    for text in texts:
        member, equals, file = (part.strip() for part in text.partition("="))
        if not equals or not file or member not in ("pinion", "gear"):
            raise click.BadParameter(f"{text!r}: must be pinion=FILE or gear=FILE")
        if member in values:
            raise click.BadParameter(f"{text!r}: {member} comes twice")
        values[member] = file
    return values


@reader
def flank_files(texts: tuple[str, ...]) -> dict[str, tuple[str, ...]]:
    """Files of measured flanks by member, at most one a flank."""
    values: dict[str, tuple[str, ...]] = {}
    for text in texts:
        for member, file in deviations((text,)).items():
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


def two_counts(text: str, wanted: str) -> tuple[int, int]:
    """Two whole numbers with an x between them; ``wanted`` says in messages what the text must be."""
    first, _, second = text.lower().partition("x")
    try:
        return int(first), int(second)
    except ValueError as error:
        raise click.BadParameter(f"{text!r}: must be {wanted}") from error


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
def solvers(text: str) -> list[str]:
    """Names of solvers, each once."""
    names = [name.strip() for name in text.split(",")]
    for name in names:
        if name and names.count(name) > 1:
            raise click.BadParameter(f"{text!r}: {name} comes twice")
    return names


@reader
def names(text: str) -> tuple[str, ...]:
    """Names separated by commas, each once."""
    words = tuple(name.strip() for name in text.split(","))
    for name in words:
        if not name:
            raise click.BadParameter(f"{text!r}: must be names separated by commas")
        if words.count(name) > 1:
            raise click.BadParameter(f"{text!r}: {name} comes twice")
    return words


@reader
def problem_files(paths: tuple[Path, ...]) -> tuple[Path, ...]:
    """Files of contact problems, each once."""
    whole = [os.path.realpath(path) for path in paths]
    for path, real_path in zip(paths, whole, strict=True):
        if whole.count(real_path) > 1:
            raise click.BadParameter(f"{path} comes twice")
        if os.path.isdir(path):
            raise click.BadParameter(
                f"{path} is a folder: give a file; 'easeoff convert {path} -o problems.nc' makes one of its problems"
            )
    return paths


def tolerances(_ctx: click.Context, _param: click.Parameter, text: str | None) -> list[float]:
    """Tolerances of a sweep; none if it is not wanted."""
    return [] if text is None else number_list(text, "tolerances separated by commas, such as 1e-3,1e-6,1e-9")


def numbers(text: str, *, from_zero: bool = False) -> list[float]:
    """Numbers separated by commas, or FROM:TO:COUNT, evenly spaced."""
    wanted = "numbers separated by commas, such as 500,1500, or FROM:TO:COUNT, such as 250:3000:12"
    if ":" not in text:
        return number_list(text, wanted, from_zero=from_zero)
    try:
        first, last, count = text.split(":")
        start, span, steps = float(first), float(last) - float(first), int(count) - 1
    except ValueError as error:
        raise click.BadParameter(f"{text!r}: must be {wanted}") from error
    if not 1 <= steps < 10_000:
        raise click.BadParameter(f"{text!r}: COUNT = {count}: must lie between 2 and 10000")
    return [start + span * i / steps for i in range(steps + 1)]


def roughnesses(text: str) -> Sequence[float | tuple[float, float]]:
    """RMS roughnesses [um] separated by commas, each a number or PINION/GEAR."""
    if "/" not in text:
        return numbers(text)
    for member in text.split("/"):
        refuse_decimal_commas(member, from_zero=False)
    members = [by_member(part, "a roughness in um", "0.8/0.5") for part in text.split(",")]
    return [entries[0] if len(entries) == 1 else (entries[0], entries[1]) for entries in members]


@reader
def duty_cycle(text: str) -> dict[float, float]:
    """Shares of the revolutions by torque [N m], from a torque alone or TORQUE=SHARE separated by commas."""
    wanted = "a torque in N m, or TORQUE=SHARE,..., such as 100=0.7,300=0.3; a decimal has a point"
    shares: dict[float, float] = {}
    parts = text.split(",")
    for part in parts:
        torque, equals, share = part.partition("=")
        if len(parts) > 1 and not equals:
            raise click.BadParameter(f"{text!r}: {part.strip()!r} has no share: must be {wanted}")
        try:
            key, value = float(torque), float(share) if equals else 1.0
        except ValueError as error:
            raise click.BadParameter(f"{part!r}: must be {wanted}") from error
        if key in shares:
            raise click.BadParameter(f"{text!r}: {key:g} comes twice")
        shares[key] = value
    return shares


@reader
def coefficients(text: str) -> tuple[float, float]:
    """Wear coefficients of pinion and gear [mm^2/N]."""
    entries = by_member(text, "a coefficient in mm^2/N", "1e-12/2e-12")
    if not any(entries):
        raise click.BadParameter(
            f"{text!r}: nothing wears; must be greater than zero in mm^2/N, or PINION/GEAR, one of which may be 0"
        )
    return entries[0], entries[-1]
