"""Files to be read: there, regular, readable, and not larger than their kind ever is.

Text is in UTF-8, with or without a byte order mark, or in UTF-16 with one, within limits of its size and of its lines;
every fault of JSON is a ``ValueError``.
"""

from __future__ import annotations

import codecs
import contextlib
import json
import os
import stat
from collections.abc import Iterator
from typing import Any

from .checks import file_path
from .errors import InputError, memory_in_words, printable, shortened

REASON_LENGTH_LIMIT = 200  # of the reason that a library gives, in a message [characters]


def named(path: str | os.PathLike[str]) -> str:
    """A path as messages show it, in one line."""
    return printable(str(file_path("path", path)))


def require_file(path: str | os.PathLike[str], limit: int | None = None) -> None:
    """Refuse a path without a file to read: a folder, a pipe, a device, or a file above the limit [byte]."""
    path = file_path("path", path)
    status = status_of(path)
    if status is None:
        raise InputError(f"{named(path)}: there is no such file")
    require_regular(status, named(path))
    if limit is not None and status.st_size > limit:
        raise too_large(path, limit)


def status_of(path: str | os.PathLike[str]) -> os.stat_result | None:
    """Status of what stands at a path, taken once: another process may replace or delete it at any time; or None.

    A name that is too long, or holds a null character, is that of nothing.
    """
    try:
        return os.stat(path)
    except (OSError, ValueError):
        return None


def require_regular(status: os.stat_result, name: str) -> None:
    """Refuse what is no regular file."""
    if stat.S_ISDIR(status.st_mode):
        raise InputError(f"{name} is a folder: give the name of a file")
    if not stat.S_ISREG(status.st_mode):
        raise InputError(f"{name} is a device or a pipe, not a file: give the name of a file")


def leads_outside(folder: str | os.PathLike[str], path: str | os.PathLike[str]) -> bool:
    """True if a path that starts in a folder leads out of it, wherever links lead."""
    try:
        start = os.path.realpath(folder)
        return os.path.commonpath([start, os.path.realpath(os.path.join(start, path))]) != start
    except (OSError, ValueError):  # another drive of Windows, or no path at all
        return True


@contextlib.contextmanager
def faults_in_words(path: str | os.PathLike[str], kind: str) -> Iterator[None]:
    """Context in which libraries read a file: whatever a damaged one of its kind makes them raise is one InputError."""
    try:
        yield
    except InputError:
        raise
    except MemoryError as error:
        raise InputError(f"{named(path)} needs more memory than there is") from error
    except Exception as error:
        raise InputError(f"{named(path)} is not {kind}, or it is damaged: {reason(error)}") from error


def reason(error: Exception) -> str:
    """Another program's words about an error, in a line."""
    why = (error.strerror if isinstance(error, OSError) else None) or str(error) or type(error).__name__
    return shortened(printable(" ".join(why.split())), REASON_LENGTH_LIMIT)


def too_large(path: str | os.PathLike[str], limit: int) -> InputError:
    """The error of a file that is larger than its kind ever is."""
    return InputError(f"{named(path)} is larger than {memory_in_words(limit)}: it is not read")


def read_bytes(path: str | os.PathLike[str], limit: int) -> bytes:
    """Content of a file of at most ``limit`` bytes."""
    require_file(path, limit)
    try:
        with file_path("path", path).open("rb") as file:
            content = file.read(limit + 1)  # some files of the system are larger than they say
    except OSError as error:
        raise InputError(f"{named(path)} cannot be read: {error.strerror or error}") from error
    if len(content) > limit:
        raise too_large(path, limit)
    return content


TOML_SIZE_LIMIT = 1_000_000  # of cases, designs and lubricants [bytes]; a case has some 5 000
SCRIPT_SIZE_LIMIT = 1_000_000  # of session scripts [bytes]
TABLE_SIZE_LIMIT = 20_000_000  # of measured grids as text [bytes]
MODEL_SIZE_LIMIT = 50_000_000  # of REXS files [bytes]
RECORD_SIZE_LIMIT = 1_000_000_000  # of checkpoints [bytes]
LINE_LENGTH_LIMIT = 50_000  # of a line of a table or script [characters]


UTF_16_MARKS = (codecs.BOM_UTF16_LE, codecs.BOM_UTF16_BE)


def read_text(path: str | os.PathLike[str], limit: int, *, line_limit: int | None = None) -> str:
    """Content of a text file, with line feeds for ends of lines; limits of its size [byte] and line length."""
    content = read_bytes(path, limit)
    try:
        text = content.decode("utf-16" if content.startswith(UTF_16_MARKS) else "utf-8-sig")
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
        for number, each in enumerate(text.split("\n"), start=1):
            if len(each) > line_limit:
                raise InputError(f"{named(path)}, line {number}: {len(each)} characters: must be at most {line_limit}")
    return text


DIGIT_COUNT_LIMIT = 300  # of a whole number; one of more may be greater than any floating-point number


def parsed_json(text: str) -> Any:
    """Value of a JSON text; ValueError also if it is nested too deeply or has a number of too many digits."""
    try:
        return json.loads(text, parse_int=_whole_number)
    except RecursionError as error:
        raise ValueError("nested too deeply") from error


def _whole_number(digits: str) -> int:
    if len(digits) > DIGIT_COUNT_LIMIT:
        raise ValueError(f"a whole number of {len(digits)} digits")
    return int(digits)
