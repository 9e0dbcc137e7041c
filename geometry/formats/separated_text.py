"""Text in columns: comment lines ``# key: value``, the separator of the columns, and cells with a decimal point.

A spreadsheet changes what it saves: with a decimal comma it separates columns by semicolons or tabs, it pads short
lines with separators, and it quotes what holds one. All that is read.
"""

from __future__ import annotations

import re
from typing import Any

from ...core.errors import InputError

Attributes = dict[str, Any]
Lines = list[tuple[int, str]]
WHOLE_KEYS = ("format_version", "number_of_teeth")
REAL_ENDINGS = ("_mm", "_rad")
EXCERPT_LENGTH = 60  # of a line in a message [characters]


def comment(line: str) -> str | None:
    """Text of a comment line after its sign; ``None`` of any other line."""
    stripped = line.strip()
    quoted = re.fullmatch(r'"(#(?:[^"]|"")*)"[;,\t]*', stripped)
    if quoted:
        stripped = quoted[1].replace('""', '"')
    if not stripped.startswith("#"):
        return None
    unpadded = stripped[1:].rstrip(";,\t")
    return (unpadded if len(stripped) - 1 - len(unpadded) >= 2 else stripped[1:]).strip()


def separator(line: str) -> str:
    """Separator of the columns of a line: semicolon, tab, comma or blanks."""
    for mark in (";", "\t"):
        if mark in line.strip():
            return mark
    stripped = line.strip()
    decimal_commas = " " in stripped and "." not in stripped and not re.search(r",\s|,$", stripped)
    return "," if "," in stripped and not decimal_commas else " "


def cells(line: str, mark: str) -> list[str]:
    """Cells of a line, without the empty ones that pad it; a decimal comma becomes a point."""
    entries = [cell.strip().strip('"').strip() for cell in (line.split() if mark == " " else line.split(mark))]
    while entries and not entries[-1]:
        entries.pop()
    return (
        entries if mark == "," else [re.sub(r"^([+-]?\d*),(\d+(?:[eE][+-]?\d+)?)$", r"\1.\2", cell) for cell in entries]
    )


def excerpt(line: str) -> str:
    """A line as messages show it, its beginning in quotes."""
    text = line.strip()
    return repr(text if len(text) <= EXCERPT_LENGTH else f"{text[:EXCERPT_LENGTH]} ...")


def parted(content: str, source: str) -> tuple[Attributes, Lines]:
    """Comments of a text by key, and its other lines with their numbers; comments that contradict are refused."""
    attributes: Attributes = {}
    lines: Lines = []
    for number, line in enumerate(content.splitlines(), start=1):
        said = comment(line)
        if said is not None:
            key, colon, value = said.partition(":")
            if not colon:
                raise InputError(f"{source}, line {number}: '# {said}': a comment must have the form '# key: value'")
            key, where = key.strip(), f"{source}, line {number}"
            attribute = _attribute(key, value.strip(), where)
            if attributes.setdefault(key, attribute) != attribute:
                raise InputError(f"{where}: {key} = {attribute!r}: must be {attributes[key]!r}, as it is above")
        elif line.strip(' \t;,"'):
            lines.append((number, line))
    if not lines:
        raise InputError(f"{source}: there are no points in it")
    return attributes, lines


def _attribute(key: str, value: str, where: str) -> Any:
    try:
        if key in WHOLE_KEYS:
            return int(value)
        return float(value.replace(",", ".")) if key.endswith(REAL_ENDINGS) else value
    except ValueError as error:
        raise InputError(f"{where}: {key} = {value!r}: must be a number") from error
