"""Foreign text in messages and tables: harmless to a terminal, and of bounded length."""

from __future__ import annotations

import re
import unicodedata

VALUE_LENGTH_LIMIT = 120  # of a value in a message [characters]
WORD_LENGTH_LIMIT = 500  # of a word of a message, such as a path [characters]
LINE_LENGTH_LIMIT = 2000  # of a line of a message [characters]
LINE_COUNT_LIMIT = 200  # of the lines of a message
ELLIPSIS = " ... "
_LONG_WORD = re.compile(rf"\S{{{WORD_LENGTH_LIMIT},}}")
_PRINTABLE_ASCII = re.compile(r"[ -~]*")


def printable(text: str) -> str:
    r"""A text of a foreign file in one line, without what steers a terminal.

    Control characters, line ends, bidirectional controls and code points that are no characters become ``?``; blanks
    of every width become a blank.

    Examples
    --------
    >>> printable("PAINT \x1b[2J")
    'PAINT ?[2J'
    """
    if _PRINTABLE_ASCII.fullmatch(text):
        return text
    return "".join(
        character if character.isprintable() else " " if unicodedata.category(character) == "Zs" else "?"
        for character in text
    )


def printable_lines(text: str) -> str:
    r"""As ``printable``, with the line feeds kept.

    Examples
    --------
    >>> printable_lines("title\r\nPAINT \x1b[2J")
    'title?\nPAINT ?[2J'
    """
    return "\n".join(map(printable, text.split("\n")))


def shortened(text: str, limit: int = VALUE_LENGTH_LIMIT) -> str:
    """A text of at most ``limit`` characters: of a longer one the beginning and the end.

    Examples
    --------
    >>> shortened("0123456789" * 3, 15)
    '01234 ... 56789'
    """
    if len(text) <= limit:
        return text
    left = limit - len(ELLIPSIS)
    return f"{text[: left - left // 2]}{ELLIPSIS}{text[len(text) - left // 2 :]}"


def message(text: str) -> str:
    r"""A message as it is shown: printable, its lines shortened, and of very many the first.

    Examples
    --------
    >>> message("speed = \x1b[2J: must be a number")
    'speed = ?[2J: must be a number'
    """
    lines = text.split("\n", LINE_COUNT_LIMIT)
    if len(lines) > LINE_COUNT_LIMIT:
        lines[LINE_COUNT_LIMIT:] = [f"and {lines[LINE_COUNT_LIMIT].count(chr(10)) + 1} more lines"]
    return "\n".join(printable(shortened(_LONG_WORD.sub(_short_word, line), LINE_LENGTH_LIMIT)) for line in lines)


def _short_word(found: re.Match[str]) -> str:
    return shortened(found[0])
