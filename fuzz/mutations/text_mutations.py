"""Mutations of any text: characters, lines, numbers and the encoding."""

from __future__ import annotations

import random
import re
from collections.abc import Callable

TextMutation = Callable[[random.Random, str], str]

#: What may stand where a number is wanted.
ODD_NUMBERS = (
    "nan", "inf", "-inf", "NaN", "0", "-0.0", "-1", "1e300", "-1e300", "1e-300", "1e309", "9" * 400, "9" * 5000,
    "1,5", "0,5",
    "1.5.2", "1e", "+5", "5.", ".5", "0x10", "1_000", "٥٠", "½", "−5", "", "x", "true", "90.0", "180.0", "999",
    "1979-05-27",
)  # fmt: skip
#: Characters that terminals, parsers and encodings take for something else.
ODD_CHARACTERS = (
    "\x00", "\ufeff", "é", "\x1b[2J", "\x1b]0;title\x07", "\x9b31m", "\u2028", "\u202e", "\x85", "\r", "\x08", "\x7f",
    "\U0001f600", "\udcff",
    "'", '"', '"""', "\\", "\\u0000", "\\x1b", "[", "]", "{", "}", "<", ">", "&", "#", "=", ":", ";", ",", "\t",
    "\n\n", "%s", "{0}", "$HOME",
)  # fmt: skip
NUMBER = re.compile(r"(?<![\w.])-?\d+(?:\.\d*)?(?:e[-+]?\d+)?(?![\w.])", re.IGNORECASE)


def number(rng: random.Random, text: str) -> str:
    """Write something odd in place of a number."""
    return _at_number(rng, text, lambda _: rng.choice(ODD_NUMBERS))


def scale(rng: random.Random, text: str) -> str:
    """Multiply a number: mm for inches, degrees for radians, thousandths."""
    factor = rng.choice([1e-3, 1e3, 25.4, 1 / 25.4, 0.5, 2.0, 0.9, 1.1, 57.29578, 1 / 57.29578, -1.0, 0.0, 1e12])
    return _at_number(rng, text, lambda old: repr(float(old) * factor))


def _at_number(rng: random.Random, text: str, new: Callable[[str], str]) -> str:
    found = list(NUMBER.finditer(text))
    if not found:
        return text
    match = rng.choice(found)
    return text[: match.start()] + new(match.group()) + text[match.end() :]


def insert(rng: random.Random, text: str) -> str:
    """Insert an odd character, or many."""
    at = rng.randrange(len(text) + 1)
    return text[:at] + rng.choice(ODD_CHARACTERS) * rng.choice([1, 1, 1, 3, 2000]) + text[at:]


def remove(rng: random.Random, text: str) -> str:
    """Remove some characters."""
    at = rng.randrange(len(text) + 1)
    return text[:at] + text[at + rng.choice([1, 2, 5, 50]) :]


def change_case(rng: random.Random, text: str) -> str:
    """Swap upper and lower case in some characters."""
    at = rng.randrange(len(text) + 1)
    end = at + rng.choice([1, 8, 80])
    return text[:at] + text[at:end].swapcase() + text[end:]


def truncate(rng: random.Random, text: str) -> str:
    """Cut off the rest, as an interrupted copy does."""
    return text[: rng.randrange(len(text) + 1)]


def remove_line(rng: random.Random, text: str) -> str:
    """Remove some lines."""
    lines = text.split("\n")
    at = rng.randrange(len(lines))
    del lines[at : at + rng.choice([1, 1, 1, 3, 10])]
    return "\n".join(lines)


def repeat_line(rng: random.Random, text: str) -> str:
    """Repeat a line, here or elsewhere, or a thousand times."""
    lines = text.split("\n")
    at = rng.choice([None, rng.randrange(len(lines))])
    line = rng.choice(lines)
    where = lines.index(line) if at is None else at
    lines[where:where] = [line] * rng.choice([1, 1, 1, 2, 1000])
    return "\n".join(lines)


def swap_lines(rng: random.Random, text: str) -> str:
    """Exchange two lines."""
    lines = text.split("\n")
    i, j = rng.randrange(len(lines)), rng.randrange(len(lines))
    lines[i], lines[j] = lines[j], lines[i]
    return "\n".join(lines)


def long_line(rng: random.Random, text: str) -> str:
    """Make a line very long."""
    lines = text.split("\n")
    at = rng.randrange(len(lines))
    lines[at] += rng.choice(["x", " ", "1,", "9", "\x1b[31m", "[", "é"]) * rng.choice([5_000, 200_000])
    return "\n".join(lines)


MUTATIONS: tuple[TextMutation, ...] = (
    number, number, number, scale, scale, insert, insert, remove, change_case, truncate, remove_line, remove_line,
    repeat_line, swap_lines, long_line,
)  # fmt: skip


def mutated(rng: random.Random, text: str, mutations: tuple[TextMutation, ...] = MUTATIONS) -> str:
    """Text after one to four mutations."""
    for _ in range(rng.choice([1, 1, 1, 2, 2, 4])):
        text = rng.choice(mutations)(rng, text)
    return text


def encoded(rng: random.Random, text: str) -> bytes:
    """Bytes of a text, now and then in another encoding or with a wrong byte."""
    data = text.encode("utf-8", "surrogateescape" if rng.random() < 0.5 else "replace")
    kind = rng.choices(
        ["plain", "utf-16", "mark", "latin", "windows", "byte", "empty", "padded"], [88, 2, 2, 1, 2, 3, 1, 1]
    )[0]
    if kind == "utf-16":
        return text.encode("utf-16", "replace")
    if kind == "mark":
        return b"\xef\xbb\xbf" + data
    if kind == "latin":
        return text.replace("a", "ä", 1).encode("latin-1", "replace")
    if kind == "windows":
        return data.replace(b"\n", b"\r\n")
    if kind == "byte":
        at = rng.randrange(len(data) + 1)
        return data[:at] + bytes([rng.randrange(256)]) + data[at + 1 :]
    if kind == "empty":
        return b""
    return data + b"\x00" * 4096 if kind == "padded" else data
