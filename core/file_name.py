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
    """Refuse a name of a file to write that has control characters or turns the direction of writing."""
    name = os.fspath(path)
    check_text(name)
    if any(unicodedata.category(c) in CONTROLS or unicodedata.bidirectional(c) in TURNS for c in name):
        raise InputError(f"{name!a}: must be a name without control characters")


def check_text(word: str) -> None:
    """Refuse a word with bytes that are no characters, which the netCDF library and messages cannot take."""
    code = sys.getfilesystemencoding()
    try:
        word.encode(code)
    except UnicodeEncodeError as error:
        way = "UTF-8; rename the file" if code == "utf-8" else f"{code}, as the locale says; or set PYTHONUTF8=1"
        raise InputError(f"{word.encode('utf-8', 'backslashreplace').decode()}: must be in {way}") from error
