"""TOML as people type it: a message shows the line of a mistake, and tells decimal commas."""

from __future__ import annotations

import re
import tomllib
from typing import Any

from .errors import InputError

DECIMAL_COMMA = re.compile(r"=\s*\[?\s*([+-]?\d+),(\d+)")
#: Lists of values in increasing order, as a rule; two whole numbers without a blank are a number with a decimal comma.
LIST_KEYS = re.compile(r"^\s*(torques|speed|temperature|roughness)\s*=")
PAIR = re.compile(r"\[(\d+),(\d+)\]")
LINE_LENGTH_SHOWN = 60


def toml_tables(text: str, origin: str) -> dict[str, Any]:
    """Tables of a TOML text that messages call ``origin``.

    Raises
    ------
    InputError
        If the text is no TOML, or a list looks like a number with a decimal comma.

    Examples
    --------
    >>> toml_tables("speed = 500.0", "mine.toml")
    {'speed': 500.0}
    >>> try:
    ...     toml_tables("speed = [500,5]", "mine.toml")
    ... except InputError as error:
    ...     print(str(error).partition(";")[0])
    mine.toml, line 1: 'speed = [500,5]': a list of two values, 500 and 5
    """
    try:
        data = tomllib.loads(text)
    except (ValueError, RecursionError) as error:
        raise InputError(f"{origin} is not a TOML file: {error}{_shown(text, str(error))}") from error
    for number, line in enumerate(text.splitlines(), start=1):
        for key, first, second in _pairs(line):
            # Oil at 0 and 40 degC is a list, a roughness of 0 and 8 um none; pinion and gear come in any order.
            comma = float(first) == 0.0 if key == "roughness" else float(first) > float(second)
            if comma:
                raise InputError(
                    f"{origin}, line {number}: {line.strip()[:LINE_LENGTH_SHOWN]!r}: a list of two values, {first} and "
                    f"{second}; if that is meant, write {first}.0, {second}.0; if a decimal, write {first}.{second}"
                )
    return data


def _pairs(line: str) -> list[tuple[str, str, str]]:
    """Key and both numbers of the lists of two whole numbers without a blank in a line."""
    key = LIST_KEYS.match(line)
    return [(key[1], pair[1], pair[2]) for pair in PAIR.finditer(line.split("#")[0])] if key else []


def _shown(text: str, message: str) -> str:
    """The line that a message of ``tomllib`` names, and the number with a decimal comma in it."""
    lines = text.splitlines()
    named = re.search(r"\(at line (\d+)", message)
    if named is None or int(named[1]) > len(lines):
        return ""
    line = lines[int(named[1]) - 1].strip()
    decimal = DECIMAL_COMMA.search(line)
    hint = f": a decimal has a point: {decimal[1]}.{decimal[2]}" if decimal else ""
    return f": {line[:LINE_LENGTH_SHOWN]!r}{hint}"
