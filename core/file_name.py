"""Names of files to write: text that every library can write and every message can show."""

from __future__ import annotations

import os
import sys
import unicodedata

from .errors import InputError

#: Characters that no name may have: general categories, and classes of bidirectional text.
CONTROLS = ("Cc", "Zl", "Zp")


TURNS = ("LRE", "RLE", "LRO", "RLO", "PDF", "LRI", "RLI", "FSI", "PDI")


def check_name(path: str | os.PathLike[str]) -> None:
    r"""Check that the name of a file to write is one that every library can write and every message can show.

    Raises
    ------
    InputError
        If it is no text, or has a control character or one that turns the direction of writing.

    Examples
    --------
    >>> check_name("kegelrad.nc")
    >>> try:
    ...     check_name("kegel\nrad.nc")
    ... except InputError as error:
    ...     print(error)
    'kegel\nrad.nc': must be a name without control characters
    """
    name = os.fspath(path)
    check_text(name)
    if any(unicodedata.category(c) in CONTROLS or unicodedata.bidirectional(c) in TURNS for c in name):
        raise InputError(f"{name!a}: must be a name without control characters")


def check_text(word: str) -> None:
    r"""Check that a word consists of characters, which the netCDF library and the texts that name a file ask for.

    Raises
    ------
    InputError
        If a byte of it is none of the characters that the system's encoding has.

    Examples
    --------
    >>> try:
    ...     check_text("kegelr\udce4der.nc")
    ... except InputError as error:
    ...     print(error)
    kegelr\udce4der.nc: must be in UTF-8; rename the file
    """
    encoding = sys.getfilesystemencoding()
    try:
        word.encode(encoding)
    except UnicodeEncodeError as error:
        way = (
            "UTF-8; rename the file" if encoding == "utf-8" else f"{encoding}, as the locale says; or set PYTHONUTF8=1"
        )
        raise InputError(f"{word.encode('utf-8', 'backslashreplace').decode()}: must be in {way}") from error
