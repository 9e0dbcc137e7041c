"""Reading of option texts: lists of numbers, numbers by member, and KEY=NUMBER pairs."""

from __future__ import annotations

import re
from collections.abc import Sequence
from itertools import pairwise

import click

WHOLE_NUMBER = re.compile(r"[+-]?\d+")


def number_list(text: str, wanted: str, *, from_zero: bool = True) -> list[float]:
    """Numbers separated by commas.

    Parameters
    ----------
    text
        The text; blanks around the numbers are allowed.
    wanted
        What the text must be, for messages.
    from_zero
        Whether 0 may stand before another whole number; else that is a decimal comma.

    Raises
    ------
    click.BadParameter
        If it is no such list, or looks like a number with a decimal comma.

    Examples
    --------
    >>> number_list("50, 250", "numbers")
    [50.0, 250.0]
    """
    try:
        values = [float(part) for part in text.split(",")]
    except ValueError as error:
        raise click.BadParameter(f"{text!r}: must be {wanted}") from error
    refuse_decimal_commas(text, from_zero=from_zero)
    return values


def refuse_decimal_commas(text: str, *, from_zero: bool = True) -> None:
    """Refuse a list of whole numbers that do not increase: a decimal comma is the likely reason.

    ``50,5`` would be the two values 50 and 5, and ``0,8`` the values 0 and 8. A list with a decimal point somewhere was
    written by somebody who knows, and may be in any order; three and more numbers may fall from the first to the last,
    as no decimal comma makes them.

    Parameters
    ----------
    text
        Numbers separated by commas.
    from_zero
        As for ``number_list``.

    Raises
    ------
    click.BadParameter
        With the number that may have been meant.

    Examples
    --------
    >>> refuse_decimal_commas("50,250")
    >>> refuse_decimal_commas("50.5,5")
    >>> refuse_decimal_commas("800,400,100")
    >>> try:
    ...     refuse_decimal_commas("50,5")
    ... except click.BadParameter as error:
    ...     print(error.message)
    '50,5': whole numbers in a list must increase, as in 5,50; a decimal has a point: 50.5
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
        found = [float(part) for part in text.split("/")]
    except ValueError:
        found = []
    if len(found) not in (1, 2):
        point = "; a decimal has a point" if "," in text else ""
        raise click.BadParameter(f"{text!r}: must be {quantity}, or PINION/GEAR, such as {example}{point}")
    return found


def keyed_numbers(text: str, keys: Sequence[str], example: str) -> dict[str, float]:
    """Numbers by key, from KEY=NUMBER separated by commas.

    Examples
    --------
    >>> keyed_numbers("E=0.1, P=-0.2", ("E", "P"), "E=0.15")
    {'E': 0.1, 'P': -0.2}
    """
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
