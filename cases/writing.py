"""Writing case files."""

from __future__ import annotations

import os
import re
from pathlib import Path

import tomli_w

from ..core.files import check_writable, whole_file
from .schema.case_schema import Case


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
    lines = (re.sub(r"[\x00-\x08\x0b-\x1f\x7f]", " ", line) for line in comment.splitlines())
    head = "".join(f"# {line}".rstrip() + "\n" for line in lines)
    # Lines of text stay lines, unless they end in a way that TOML would turn into plain line feeds.
    readable = "\r" not in case.title + case.description
    return head + tomli_w.dumps(case.model_dump(exclude_defaults=True), multiline_strings=readable)


def write_case(case: Case, path: str | os.PathLike[str], comment: str = "") -> None:
    """Write a case file, whole or not at all; see ``case_toml``.

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
    if case.friction is not None:
        check_writable(path, case.friction.oil_file)
        case = case.model_copy(update={"friction": case.friction.seen_from(Path(path).parent)})
    with whole_file(path) as temporary:
        temporary.write_text(case_toml(case, comment), encoding="utf-8", newline="\n")
