"""What a row outside its limit means, and what to do, in one line."""

from __future__ import annotations

import math
from collections.abc import Sequence

from .verification_row import RowStatus, VerificationRow

REPORT_IT = "report it with the case file"
FINER_GRID = "try more lengthwise_nodes and profile_nodes"
#: Beginnings of rows that compare contact lines one by one; the largest differences are near the ends of the path.
LINE_ROWS = ("relative curvature", "direction of the contact line", "length of the contact line")
#: By the beginning of a row's quantity. {0} stands for the difference, {1} for half of it, each with its unit.
MEANINGS = {
    "certificates": "at these positions there is no result; try another --solver, or less torque",
    "flank position": f"the flank is off by {{0}} from what the settings cut; {REPORT_IT}",
    "flank normal": f"the flank is off by {{0}} from what the settings cut; {REPORT_IT}",
    "envelope condition": f"the flank is off by up to {{0}} from what the settings cut; {REPORT_IT}",
    "principal curvatures": f"curvatures, and with them pressures, are off by this part; {REPORT_IT}",
    "conventional analysis": "for these rotations the other method found no contact; look at the ease-off first",
    "transmission error of a tooth pair": f"the unloaded transmission error may be off by {{0}}; {FINER_GRID}",
    "path of contact": f"the path of contact may be off by {{0}}, transmission errors hardly; {FINER_GRID}",
    "relative curvature": "pressures may be off by about half of it, {1}; transmission error and load shares are not "
    "affected",
    "direction of the contact line": f"the lines may be turned by {{0}}, pressures at their ends most; {FINER_GRID}",
    "length of the contact line": f"lengths of the unloaded pattern may be off by {{0}}; {FINER_GRID}",
    "unloaded transmission error": f"it may be off by {{0}} where an edge touches; {FINER_GRID}",
    "loaded transmission error by its gaps": "it may be off by {0}; try more segments_per_line, see edges in the notes",
    "solver": "the other solver, not the result, is off, as its answers are less exact: do not choose it for this pair",
    "contact without the split": "the elastic model may be off by {0} in this number; compare compliance model 'fe'",
    "transmission error": "the elastic model may be off by {0} in this number; compare compliance model 'fe'",
    "load share of a tooth pair": "the elastic model may be off by {0} in this number; compare compliance model 'fe'",
    "greatest line load": "line loads may be off by {0}, pressures by half of it; most where edges carry",
    "grid of the flank": "numbers of this kind may be off by {0}; set more lengthwise_nodes and profile_nodes",
    "segments of a line": "numbers of this kind may be off by {0}; set more segments_per_line under [contact]",
    "mesh positions": "numbers of this kind may be off by {0}; set more mesh_positions under [contact]",
    "fineness of the teeth": "numbers of this kind may be off by {0}; set a greater fineness under [compliance]",
    "shell modes": "numbers of this kind may be off by {0}; set more modes under [compliance]",
}


def closing(outside: Sequence[VerificationRow]) -> str:
    """What it means that these rows alone are outside their limits; empty if their own meanings say it.

    Examples
    --------
    >>> row = VerificationRow("relative curvature across the line", "both members' curvatures", 4.7, 4.0, "%")
    >>> closing([row])[:40]
    'these are curvature and direction of con'
    """
    if not outside or not all(row.quantity.startswith(LINE_ROWS) for row in outside):
        return ""
    return (
        "these are curvature and direction of contact lines, farthest off near the ends of the path: pressures may be "
        "off there as told above, transmission error and load shares are not"
    )


def meaning(row: VerificationRow) -> str:
    """What it means that a row is outside its limit; empty for one that is not.

    Examples
    --------
    >>> row = VerificationRow("relative curvature across the line", "both members' curvatures", 4.7, 4.0, "%")
    >>> meaning(row)
    'pressures may be off by about half of it, 2.4 %; transmission error and load shares are not affected'
    """
    if row.status != RowStatus.OUTSIDE:
        return ""
    if math.isnan(row.difference):
        return "the other method found no answer for this pair, so this is not checked"
    unit = "" if row.unit == "1" else f" {row.unit}"
    whole, half = (f"{abs(value):.2g}{unit}" for value in (row.difference, 0.5 * row.difference))
    found = max((start for start in MEANINGS if row.quantity.startswith(start)), key=len, default="")
    return MEANINGS.get(found, "numbers of this kind may be off by {0}").format(whole, half)
