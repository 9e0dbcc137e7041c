"""Files of other versions of the package: what a message says of one that cannot be read, and by what it can."""

from __future__ import annotations

import os
import re
from collections.abc import Mapping, Sequence
from importlib.metadata import version
from typing import Any

import numpy as np

from .errors import InputError
from .regular_file import named

FAULT_COUNT_LIMIT = 3  # that a message names
VERSION = re.compile(r"\d{1,4}(\.\d{1,6}){1,3}[a-z0-9.]{0,12}")


def layout_fault(attributes: Mapping[Any, Any], name: str, known: int) -> list[str]:
    """Fault of a file whose attribute ``name``, the number of its layout, is beyond the known; else empty."""
    number = attributes.get(name, known)
    if not isinstance(number, int | np.integer) or number <= known:
        return []
    return [f"its layout {name} = {number} is later than {known}"]


def unreadable(
    path: str | os.PathLike[str], attributes: Mapping[Any, Any], faults: Sequence[str], remedy: str
) -> InputError:
    """Error of a file with faults: damaged, or written by another version, which is named; ``remedy`` makes it anew."""
    more = f", and {len(faults) - FAULT_COUNT_LIMIT} more" if len(faults) > FAULT_COUNT_LIMIT else ""
    what = f"{'; '.join(faults[:FAULT_COUNT_LIMIT])}{more}"
    wrote, this_version = str(attributes.get("easeoff_version", "")), version("easeoff")
    if wrote != this_version and VERSION.fullmatch(wrote):
        return InputError(
            f"{named(path)} was written by easeoff {wrote} and this is {this_version}: {what}; easeoff {wrote} reads "
            f"it ('pip install easeoff=={wrote}'), or make it anew with '{remedy}'"
        )
    return InputError(
        f"{named(path)} is damaged, changed by hand or made by another version of easeoff: {what}; make it anew with "
        f"'{remedy}'"
    )
