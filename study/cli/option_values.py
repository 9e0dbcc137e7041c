"""Values of options from their texts: lists of numbers, numbers by member, KEY=NUMBER pairs, names and files.

Everything heavy is imported where it is needed: ``easeoff --help`` stays quick.
"""

from __future__ import annotations

import os
import re
from collections.abc import Callable, Sequence
from contextlib import suppress
from itertools import pairwise
from typing import TYPE_CHECKING, Any, TypeVar

import click

from .command import echo

if TYPE_CHECKING:
    from ...cases import Case
    from ...cases.deflections import Deflections
    from ...friction import FrictionModel
    from ...geometry.cutting.named_settings import MachineResolution
    from ...geometry.pair.assembly import Misalignment

Given = TypeVar("Given")
Value = TypeVar("Value")
WHOLE_NUMBER = re.compile(r"[+-]?\d+")
MEMBER_FILE = re.compile(r"(pinion|gear)\s*=\s*(.+)", re.DOTALL)
MISALIGNMENT_KEYS = ("E", "P", "G", "Sigma")
#: Kinds of steps of a machine's settings.
STEPS = ("length", "angle", "roll", "modified_roll", "motion", "blade_radius", "blade_angle", "edge_radius")
DEVIATING = {"interpolation": "spline", "deviated": "ease_off"}


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


def keyed_texts(texts: tuple[str, ...], pattern: re.Pattern[str], wanted: str) -> dict[str, re.Match[str]]:
    """Texts of an option that may be repeated as a pattern finds them, by its first group, which comes once."""
    found: dict[str, re.Match[str]] = {}
    for text in texts:
        parts = pattern.fullmatch(text.strip())
        if parts is None:
            raise click.BadParameter(f"{text!r}: must be {wanted}")
        if parts[1] in found:
            raise click.BadParameter(f"{text!r}: {parts[1]} comes twice")
        found[parts[1]] = parts
    return found


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


def assembly_errors(text: str) -> Misalignment | Deflections:
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


def deviation_files(texts: tuple[str, ...]) -> dict[str, str]:
    """Files of deviations by member."""
    found = keyed_texts(texts, MEMBER_FILE, "pinion=FILE or gear=FILE")
    return {member: parts[2] for member, parts in found.items()}


def two_counts(text: str, wanted: str) -> tuple[int, int]:
    """Two whole numbers with an x between them; ``wanted`` says in messages what the text must be."""
    first, _, second = text.lower().partition("x")
    try:
        return int(first), int(second)
    except ValueError as error:
        raise click.BadParameter(f"{text!r}: must be {wanted}") from error


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


def with_defaults(options: dict[str, Any]) -> dict[str, Any]:
    """Options with the defaults of ``--interpolation`` and ``--deviated``, which must go with ``--deviation``."""
    defaults = {name: value for name, value in DEVIATING.items() if name in options}
    for name in defaults:
        if options[name] is not None and not options["deviations"]:
            raise click.UsageError(f"--{name} = {options[name]}: must go with --deviation")
    return options | {name: value for name, value in defaults.items() if options[name] is None}


def given_model(case: Case, options: dict[str, Any]) -> FrictionModel | None:
    """Friction models of the case with what options say of them, which is taken out; ``None`` if nothing is said."""
    name, film_heating, clamp = (options.pop(key) for key in ("friction_model", "film_heating", "clamp_temperature"))
    if name is None and film_heating is None and clamp is None:
        return None
    from ...friction import FrictionModel

    changed: dict[str, Any] = {}
    if name is not None:
        changed["coefficient"] = name
        with suppress(ValueError):
            changed["coefficient"] = float(name)
    if film_heating is not None:
        changed["film_heating"] = film_heating
    if clamp is not None:
        changed["out_of_range"] = "clamp" if clamp else "error"
    return FrictionModel(**changed) if case.friction is None else case.friction.model(**changed)


@reader
def machine_resolution(text: str) -> MachineResolution:
    """Resolution of settings from an option."""
    from ...geometry.cutting.named_settings import MachineResolution

    return MachineResolution(**keyed_numbers(text, STEPS, "length=0.01,angle=0.01"))
