"""Exceptions of the package, one tree to catch all of them at once, and the words of their messages.

Foreign text is made harmless to a terminal and of bounded length, a known name is suggested for one that is misspelt,
sizes of memory and times are told to two figures.
"""

from __future__ import annotations

import contextlib
import difflib
import importlib.util
import re
import shlex
import sys
import unicodedata
from collections.abc import Iterable, Iterator
from pathlib import Path

VALUE_LENGTH_LIMIT = 120  # of a value in a message [characters]
WORD_LENGTH_LIMIT = 500  # of a word of a message, such as a path [characters]
LINE_LENGTH_LIMIT = 2000  # of a line of a message [characters]
LINE_COUNT_LIMIT = 200  # of the lines of a message
ELLIPSIS = " ... "
_LONG_WORD = re.compile(rf"\S{{{WORD_LENGTH_LIMIT},}}")
_PRINTABLE_ASCII = re.compile(r"[ -~]*")


def printable(text: str) -> str:
    """A foreign text in one line, with ``?`` for controls and code points that are no characters."""
    if _PRINTABLE_ASCII.fullmatch(text):
        return text
    return "".join(
        character if character.isprintable() else " " if unicodedata.category(character) == "Zs" else "?"
        for character in text
    )


def printable_lines(text: str) -> str:
    """Text as by ``printable``, with the line feeds kept."""
    return "\n".join(map(printable, text.split("\n")))


def shortened(text: str, limit: int = VALUE_LENGTH_LIMIT) -> str:
    """A text of at most ``limit`` characters: of a longer one the beginning and the end."""
    if len(text) <= limit:
        return text
    left = limit - len(ELLIPSIS)
    return f"{text[: left - left // 2]}{ELLIPSIS}{text[len(text) - left // 2 :]}"


def message(text: str) -> str:
    """A message as it is shown: printable, its lines shortened, and of very many the first."""
    lines = text.split("\n", LINE_COUNT_LIMIT)
    if len(lines) > LINE_COUNT_LIMIT:
        lines[LINE_COUNT_LIMIT:] = [f"and {lines[LINE_COUNT_LIMIT].count(chr(10)) + 1} more lines"]
    words = [_LONG_WORD.sub(lambda match: shortened(match[0]), line) for line in lines]
    return "\n".join(printable(shortened(line, LINE_LENGTH_LIMIT)) for line in words)


class EaseoffError(Exception):
    """Anything this package raises on purpose.

    Its text is harmless to a terminal, and values of any length are shortened in it.

    Examples
    --------
    >>> import easeoff
    >>> try:
    ...     easeoff.read_case("no-such-case")
    ... except easeoff.EaseoffError as error:
    ...     print(type(error).__name__)
    InputError
    """

    def __str__(self) -> str:
        return message(super().__str__())


class InputError(EaseoffError, ValueError):
    """A value given by the user that cannot be used; the message names it and says what is allowed.

    Examples
    --------
    >>> from easeoff.contact import Material
    >>> try:
    ...     Material(-1.0, 0.3)
    ... except InputError as error:
    ...     print(error)
    elastic_modulus = -1: must be a finite number above 0 [MPa]
    """


@contextlib.contextmanager
def errors_about(place: str) -> Iterator[None]:
    """Context whose errors begin with the place that they are about, as ``[pair]`` or the name of a file."""
    try:
        yield
    except EaseoffError as error:
        raise type(error)(f"{place} {error}") from error


class GeometryError(EaseoffError):
    """Settings that describe no tooth: no flank in the blank, no conjugate position, no overlap.

    Examples
    --------
    >>> from easeoff.cases import gear_pair, read_case
    >>> from easeoff.geometry import Misalignment, ease_off
    >>> pair = gear_pair(read_case("nasa-12x36"))
    >>> try:
    ...     ease_off(pair.misaligned(Misalignment(offset=100.0)), (7, 7))
    ... except GeometryError:
    ...     print("no conjugate position")
    no conjugate position
    """


class MissingSolverError(EaseoffError, ImportError):
    """A solver was asked for whose package is not installed; the message says which extra installs it.

    Examples
    --------
    >>> issubclass(MissingSolverError, EaseoffError), issubclass(MissingSolverError, ImportError)
    (True, True)
    """


class MissingPackageError(EaseoffError, ImportError):
    """A file format was asked for whose package is not installed; the message says which extra installs it.

    Examples
    --------
    >>> issubclass(MissingPackageError, EaseoffError), issubclass(MissingPackageError, ImportError)
    (True, True)
    """


def how_to_install(requirement: str) -> str:
    """Command that installs a requirement such as ``easeoff[cad]`` in this environment, activated or not."""
    root = Path(__file__).resolve().parents[1]
    checkout = requirement.startswith("easeoff[") and (root / "pyproject.toml").is_file()
    what = ["-e", f"{root}{requirement.removeprefix('easeoff')}"] if checkout else [requirement]
    if importlib.util.find_spec("pip") is not None:
        pip = [sys.executable, "-m", "pip"]
    else:
        pip = [getattr(sys, "_base_executable", sys.executable), "-m", "pip", "--python", sys.prefix]
    return f"{requirement} installs it: {shlex.join([*pip, 'install', *what])}"


SIMILARITY = 0.6  # least ratio of difflib
BEGINNING_LENGTH = 4  # least of a beginning that stands for the whole name [characters]
NAME_LENGTH_LIMIT = 100  # of a name that is compared [characters]


def suggestion(name: str, known: Iterable[str]) -> str:
    """Nearest known name, or one that begins so, as the end of a phrase; empty if none. Case does not count."""
    lower = {word.lower(): word for word in known}
    given = str(name)[:NAME_LENGTH_LIMIT].lower()
    matches = difflib.get_close_matches(given, lower, n=1, cutoff=SIMILARITY)
    if not matches and len(given) >= BEGINNING_LENGTH:
        matches = [word for word in lower if word.startswith(given)]
    return f"; did you mean {lower[matches[0]]!r}?" if matches else ""


MEMORY_UNITS = {"TB": 1e12, "GB": 1e9, "MB": 1e6}  # [byte]
TIME_UNITS = {"years": 3.15576e7, "days": 86400.0, "h": 3600.0, "min": 60.0}  # [s]


def memory_in_words(size: float) -> str:
    """A size of memory [byte] in words."""
    unit, factor = next((pair for pair in MEMORY_UNITS.items() if size >= pair[1]), ("MB", 1e6))
    value = float(f"{max(size / factor, 1.0):.1e}")
    if value >= 1e6:
        return f"over a million {unit}"
    return f"{value:.1f} {unit}" if value < 10.0 and value % 1.0 else f"{value:.0f} {unit}"


def time_in_words(seconds: float) -> str:
    """A time [s] in words."""
    if seconds >= 1e6 * TIME_UNITS["years"]:
        return "over a million years"
    unit, size = next((pair for pair in TIME_UNITS.items() if seconds >= 2.0 * pair[1]), ("s", 1.0))
    return f"about {float(f'{max(seconds / size, 1.0):.1e}'):.0f} {unit}"
