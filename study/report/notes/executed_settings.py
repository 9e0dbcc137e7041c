"""Note on settings that were corrected for measured flanks, and so are those of one machine alone."""

from __future__ import annotations

import tomllib
from collections.abc import Sequence
from typing import get_args

import xarray as xr


def execution_note(flanks: Sequence[str]) -> list[str]:
    """Note, in one line or none, on flanks with settings to execute.

    Parameters
    ----------
    flanks
        ``corrected_flanks`` of a case.

    Examples
    --------
    >>> execution_note(["gear convex"])[0].partition(":")[0]
    'Note'
    >>> execution_note([])
    []
    """
    if not flanks:
        return []
    return [
        f"Note: the settings of {', '.join(flanks)} are corrected for measured flanks, to execute on the machine that "
        "cut those; what is computed from them is of a machine without errors, on which they cut others."
    ]


def executed_settings(tree: xr.DataTree) -> list[str]:
    """The note for a result, from the case that it keeps.

    Examples
    --------
    >>> import easeoff
    >>> executed_settings(easeoff.analyze("nasa-12x36", torques=[100.0]))
    []
    """
    try:
        named = tomllib.loads(str(tree.attrs.get("case", ""))).get("corrected_flanks")
    except tomllib.TOMLDecodeError:  # a case that was changed by hand
        return []
    if not isinstance(named, list):
        return []
    from ....cases.schema.case_schema import FlankOfMember  # most cases have none

    return execution_note([flank for flank in get_args(FlankOfMember) if flank in named])
