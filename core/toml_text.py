"""TOML as people type it: a message shows the line of a mistake, and tells decimal commas."""

from __future__ import annotations

import re
import tomllib
from typing import Any

from .errors import InputError, printable, shortened

DECIMAL_COMMA = re.compile(r"=\s*\[?\s*([+-]?\d+),(\d+)")
BARE_TEXT = re.compile(r"=\s*([A-Za-z][\w-]*)\s*(?:#.*)?$")
#: Lists of values in increasing order, as a rule; two whole numbers without a blank are a number with a decimal comma.
LIST_KEYS = re.compile(r"^\s*(torques|speed|temperature|roughness)\s*=")
PAIR = re.compile(r"\[(\d+),(\d+)\]")
LINE_LENGTH_SHOWN = 60
NESTING_LIMIT = 32  # tables and lists within each other; a case has 5
KEY_PART_LIMIT = 300  # of a dotted key; on more the parser would spend minutes
KEY_ENDS = re.compile(r"[\n=,\[\]{}]")
WHOLE_NUMBER_BITS = 64


def toml_tables(text: str, origin: str) -> dict[str, Any]:
    """Tables of a TOML text that messages call ``origin``.

    Too deep a nesting, a whole number beyond 64 bits and a list that looks like a decimal comma are refused.
    """
    for part in KEY_ENDS.split(text):
        if part.count(".") > KEY_PART_LIMIT:
            raise InputError(f"{origin}: {_excerpt(part)}: more than {KEY_PART_LIMIT} points in a key")
    try:
        data = tomllib.loads(text)
    except RecursionError as error:
        raise InputError(f"{origin} is not a TOML file: tables or lists are nested too deeply") from error
    except ValueError as error:
        why = shortened(str(error).replace("; use sys.set_int_max_str_digits() to increase the limit", ""))
        raise InputError(f"{origin} is not a TOML file: {why}{_shown(text, str(error))}") from error
    _check_values(data, origin)
    for number, line in enumerate(text.splitlines(), start=1):
        for key, first, second in _pairs(line):
            # Oil at 0 and 40 degC is a list, a roughness of 0 and 8 um none; pinion and gear come in any order.
            if float(first) == 0.0 if key == "roughness" else float(first) > float(second):
                raise InputError(
                    f"{origin}, line {number}: {_excerpt(line)}: a list of two values, {first} and "
                    f"{second}; if that is meant, write {first}.0, {second}.0; if a decimal, write {first}.{second}"
                )
    return data


def _check_values(data: dict[str, Any], origin: str) -> None:
    """Refuse deep nesting, and whole numbers that TOML does not have."""
    waiting: list[tuple[str, Any, int]] = [("", data, 0)]
    while waiting:
        key, value, depth = waiting.pop()
        where = f"{origin}: {shortened(printable(key))}"
        if depth > NESTING_LIMIT:
            raise InputError(f"{where}: tables and lists are nested more than {NESTING_LIMIT} deep")
        if isinstance(value, dict):
            waiting += [(f"{key}.{name}" if key else name, entry, depth + 1) for name, entry in value.items()]
        elif isinstance(value, list):
            waiting += [(key, entry, depth + 1) for entry in value]
        elif isinstance(value, int) and value.bit_length() >= WHOLE_NUMBER_BITS:
            raise InputError(f"{where}: must be a whole number of at most {WHOLE_NUMBER_BITS} bits")


def _excerpt(line: str) -> str:
    """Beginning of a line, in quotes."""
    return repr(line.strip()[:LINE_LENGTH_SHOWN])


def _pairs(line: str) -> list[tuple[str, str, str]]:
    """Key and both numbers of the lists of two whole numbers without a blank in a line."""
    key = LIST_KEYS.match(line)
    return [(key[1], pair[1], pair[2]) for pair in PAIR.finditer(line.split("#")[0])] if key else []


def _shown(text: str, message: str) -> str:
    """The line that a message of ``tomllib`` names, and what is wrong with it: a decimal comma, text without quotes."""
    lines = text.splitlines()
    named = re.search(r"\(at line (\d+)", message)
    if named is None or int(named[1]) > len(lines):
        return ""
    line = lines[int(named[1]) - 1].strip()
    decimal = DECIMAL_COMMA.search(line)
    bare = BARE_TEXT.search(line)
    hint = f": a decimal has a point: {decimal[1]}.{decimal[2]}" if decimal else ""
    hint = hint or (f': text needs quotes: "{bare[1]}"' if bare else "")
    return f": {_excerpt(line)}{hint}"
