"""Text files in UTF-8, with or without a byte order mark, within limits of their size and of their lines."""

from __future__ import annotations

import os

from ..errors import InputError
from .regular_file import named, read_bytes

TOML_SIZE_LIMIT = 1_000_000  # of cases, designs and lubricants [bytes]; a case has some 5 000
SCRIPT_SIZE_LIMIT = 1_000_000  # of session scripts [bytes]
TABLE_SIZE_LIMIT = 20_000_000  # of measured grids as text [bytes]
MODEL_SIZE_LIMIT = 50_000_000  # of REXS files [bytes]
RECORD_SIZE_LIMIT = 1_000_000_000  # of checkpoints [bytes]
LINE_LENGTH_LIMIT = 50_000  # of a line of a table or script [characters]


def read_text(path: str | os.PathLike[str], limit: int, *, line_limit: int | None = None) -> str:
    """Content of a text file, with line feeds for ends of lines.

    Parameters
    ----------
    path
        The file.
    limit
        Greatest size [bytes].
    line_limit
        Greatest length of a line [characters]; any if left out.

    Raises
    ------
    InputError
        If there is no such file, it cannot be read, is larger, is not text in UTF-8, or has a longer line.

    Examples
    --------
    >>> read_text(__file__, 100_000).splitlines()[2]
    'from __future__ import annotations'
    """
    content = read_bytes(path, limit)
    try:
        text = content.decode("utf-8-sig")
    except UnicodeDecodeError as error:
        line = content.count(b"\n", 0, error.start) + 1
        raise InputError(
            f"{named(path)} cannot be read as text: byte {content[error.start]:#04x} in line {line} is not UTF-8; save "
            "the file as UTF-8"
        ) from error
    if "\0" in text:
        line = text.count("\n", 0, text.index("\0")) + 1
        raise InputError(f"{named(path)} cannot be read as text: line {line} holds a null character")
    text = text.replace("\r\n", "\n").replace("\r", "\n")
    if line_limit is not None:
        for number, line_text in enumerate(text.split("\n"), start=1):
            if len(line_text) > line_limit:
                raise InputError(
                    f"{named(path)}, line {number}: {len(line_text)} characters: must be at most {line_limit}"
                )
    return text
