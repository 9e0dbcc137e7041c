"""Table of a verification as text, row by row: widths do not depend on the rows that come."""

from __future__ import annotations

import textwrap
from collections.abc import Sequence

from .row_meaning import meaning
from .verification_row import RowStatus, VerificationRow

HEADS = ("quantity", "compared with", "difference", "limit", "unit", "within")
WIDTHS = (36, 46, 10, 7, 4, 6)  # characters
GAP = "  "
WORDS = {RowStatus.WITHIN: "yes", RowStatus.OUTSIDE: "NO", RowStatus.NOT_APPLICABLE: "-"}


def cells(row: VerificationRow) -> tuple[str, ...]:
    """Cells of a row.

    Examples
    --------
    >>> cells(VerificationRow("path", "another method", 1.0, 2.0, "um"))
    ('path', 'another method', '1', '2', 'um', 'yes')
    """
    if not row.applicable:
        return row.quantity, f"not applicable: {row.compared}", "", "", "", WORDS[row.status]
    unit = "" if row.unit == "1" else row.unit
    return (
        row.quantity,
        row.compared,
        difference_text(row.difference, row.limit),
        f"{row.limit:.2g}",
        unit,
        WORDS[row.status],
    )


def difference_text(difference: float, limit: float) -> str:
    """A difference, to as many digits as tell it from its limit.

    Examples
    --------
    >>> difference_text(0.1034, 0.1), difference_text(0.0834, 0.1)
    ('0.103', '0.083')
    """
    text = f"{difference:.2g}"
    for digits in range(3, 6):
        if difference <= limit or float(text) > limit:
            break
        text = f"{difference:.{digits}g}"
    return text


def head_lines() -> str:
    """Heads of the table, underlined.

    Examples
    --------
    >>> head_lines().splitlines()[0].split()[-3:]
    ['limit', 'unit', 'within']
    """
    return f"{_line(HEADS)}\n{GAP.join('-' * width for width in WIDTHS)}"


def row_lines(row: VerificationRow) -> str:
    """Lines of a row, with what it means if it is outside its limit.

    Examples
    --------
    >>> print(row_lines(VerificationRow("mesh positions: shares", "32 against 64", 3.0, 2.0, "%")).splitlines()[1])
      -> numbers of this kind may be off by 3 %; set more mesh_positions under [contact]
    """
    found = cells(row)
    wrapped = [textwrap.wrap(cell, width) or [""] for cell, width in zip(found, WIDTHS, strict=True)]
    height = max(map(len, wrapped))
    lines = [_line([cell[at] if at < len(cell) else "" for cell in wrapped]) for at in range(height)]
    if said := meaning(row):
        width = sum(WIDTHS) + len(GAP) * (len(WIDTHS) - 1)
        lines += textwrap.wrap(f"-> {said}", width, initial_indent=GAP, subsequent_indent=" " * 5)
    return "\n".join(lines)


def _line(texts: Sequence[str]) -> str:
    return GAP.join(text.ljust(width) for text, width in zip(texts, WIDTHS, strict=True)).rstrip()
