"""Tables and texts in HTML, without a style of their own, for a notebook."""

from __future__ import annotations

import html
from collections.abc import Sequence

from ....core.errors import printable


def html_table(heads: Sequence[str], rows: Sequence[Sequence[str]]) -> str:
    """A table; the first column names the rows.

    Examples
    --------
    >>> html_table([], [["a"]])
    '<table><tbody><tr><td style="text-align:left">a</td></tr></tbody></table>'
    """
    head = "".join(_cell("th", text, left=not at) for at, text in enumerate(heads))
    body = ["".join(_cell("td", text, left=not (at and heads)) for at, text in enumerate(row)) for row in rows]
    lines = "".join(f"<tr>{cells}</tr>" for cells in body)
    return f"<table>{f'<thead><tr>{head}</tr></thead>' if heads else ''}<tbody>{lines}</tbody></table>"


def html_text(text: object) -> str:
    """A text with the signs of its units, which terminals may lack.

    Examples
    --------
    >>> html_text("3 um < 4 um")
    '3 µm &lt; 4 µm'
    """
    words = printable(str(text)).replace(" urad", " µrad").replace(" um", " µm").replace(" degC", " °C")
    return html.escape(words.replace(" deg", " °"))


def _cell(kind: str, text: str, *, left: bool) -> str:
    """A cell: the names of rows are on the left, numbers on the right, whatever the notebook's own style."""
    return f'<{kind} style="text-align:{"left" if left else "right"}">{html_text(text)}</{kind}>'
