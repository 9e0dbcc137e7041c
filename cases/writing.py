"""Writing case files."""

from __future__ import annotations

import hashlib
import os
import re
from pathlib import Path

import tomli_w

from ..core.checks import instance
from ..core.errors import InputError
from ..core.reading.regular_file import read_bytes
from ..core.reading.text_file import TOML_SIZE_LIMIT
from ..core.writing.output_file import check_writable, whole_file
from .schema.case_schema import Case

SEAL = "# checksum of the lines above, as easeoff wrote them:"
SEAL_LENGTH = 12  # of the checksum [digits]


def case_toml(case: Case, comment: str = "") -> str:
    """Text of a case file that reads as the given case.

    Only the keys that must be given and those that differ from their defaults are written, in the order of the schema.
    Numbers are written with enough digits to read the same number again.

    Parameters
    ----------
    case
        A checked case.
    comment
        Lines to stand before everything else, without the comment sign.

    Examples
    --------
    >>> from easeoff.cases import parse_case, read_case
    >>> case = read_case("nasa-12x36")
    >>> parse_case(case_toml(case)).model_dump() == case.model_dump()
    True
    """
    # TOML forbids control characters other than the tab in comments.
    instance("case", case, Case)
    instance("comment", comment, str)
    lines = (re.sub(r"[\x00-\x08\x0b-\x1f\x7f]", " ", line) for line in comment.splitlines())
    head = "".join(f"# {line}".rstrip() + "\n" for line in lines)
    # Lines of text stay lines, unless they end in a way that TOML would turn into plain line feeds.
    readable = "\r" not in case.title + case.description
    return head + tomli_w.dumps(case.model_dump(exclude_defaults=True), multiline_strings=readable)


def _sealed(text: str) -> str:
    """Text of an input file with a last line by which ``require_replaceable`` knows that nobody edited it."""
    return f"{text}{SEAL} {hashlib.sha256(text.encode()).hexdigest()[:SEAL_LENGTH]}\n"


def write_sealed(text: str, path: str | os.PathLike[str]) -> None:
    r"""Write an input file, whole or not at all, with a last line by which it is known that nobody edited it.

    Parameters
    ----------
    text
        The text, which ends with a line feed.
    path
        The file.

    Raises
    ------
    InputError
        If the file cannot be written.

    Examples
    --------
    >>> import tempfile
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     write_sealed("easeoff_case = 2\n", f"{folder}/mine.toml")
    ...     require_replaceable(f"{folder}/mine.toml")
    """
    with whole_file(path) as temporary:
        temporary.write_text(_sealed(text), encoding="utf-8", newline="\n")


def require_replaceable(path: str | os.PathLike[str], force: bool = False) -> None:
    """Refuse to replace an input file that somebody edited after easeoff wrote it, or wrote by hand.

    Parameters
    ----------
    path
        The file; it need not exist.
    force
        Whether it may be replaced all the same.

    Raises
    ------
    InputError
        If it may not be replaced.

    Examples
    --------
    >>> require_replaceable("no such file.toml")
    """
    if force or not os.path.exists(path):
        return
    try:
        head, seal, _ = (text := read_bytes(path, TOML_SIZE_LIMIT).decode()).rpartition(SEAL)
    except (InputError, UnicodeDecodeError):
        head, seal, text = "", "", ""
    if not seal or _sealed(head) != text:
        why = "was edited after easeoff wrote it" if seal else "was not written by easeoff"
        raise InputError(f"{path} {why}: give another name, or --force to replace it")


def write_case(case: Case, path: str | os.PathLike[str], comment: str = "") -> None:
    """Write a case file, whole or not at all; see ``case_toml``.

    Its last line is a checksum, a comment: the command line does not replace a file that was edited since.

    If the case takes its oil from a file by a relative path, the path is written as it is from the new file's folder.

    Raises
    ------
    InputError
        If the file cannot be written, or is the case's own file of an oil.

    Examples
    --------
    >>> import tempfile
    >>> from easeoff.cases import read_case
    >>> case = read_case("nasa-12x36")
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     write_case(case, f"{folder}/mine.toml", comment="My pair")
    ...     print(read_case(f"{folder}/mine.toml").text.splitlines()[0])
    # My pair
    """
    instance("case", case, Case)
    if case.friction is not None:
        check_writable(path, case.friction.oil_file)
        case = case.model_copy(update={"friction": case.friction.seen_from(Path(path).parent)})
    write_sealed(case_toml(case, comment), path)
