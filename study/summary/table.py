"""Table of texts: for a terminal, in HTML for a notebook, and for the page of the report."""

from __future__ import annotations

import html
import re
import textwrap
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from typing import Any

from tabulate import tabulate

from ...core.errors import printable
from .quantities import NO_VALUE, Quantity

WIDTH = 100  # [characters] of texts
ROW_COUNT_LIMIT = 40  # of a table as text, where a group of the result has the rest
#: Signs of units, which terminals may lack.
SIGNS = {"urad": "µrad", "um": "µm", "degC": "°C"}
PLAIN_NO_VALUE = "-"  # in a terminal


@dataclass(frozen=True)
class Table:
    """Heads and rows of texts, for a terminal, a notebook and the page of the report."""

    heads: Sequence[str | Quantity]  # in a text a unit may stand after a line break
    rows: Sequence[Sequence[str]]
    left: int = 1  # columns that name the row; the others are numbers
    title: str = ""
    note: str = ""
    variables: tuple[str, ...] = ()  # of the result, a column each or of the whole
    group: str = ""  # of the result, which has the rows that a text leaves out
    form: str = "simple"  # of a text, as ``tabulate`` calls it

    def text(self) -> str:
        """Title, table, note and number of rows left out as text."""
        shown = self.rows[:ROW_COUNT_LIMIT] if self.group else self.rows
        parts = [*([self.title, ""] if self.title else []), self.in_form(self.form, shown)]
        parts += [filled(self.note.splitlines())] if self.note else []
        left_out = len(self.rows) - len(shown)
        return "\n".join([*parts, *([f"... and {left_out} more in the group {self.group}"] if left_out else [])])

    def in_form(self, form: str, rows: Sequence[Sequence[str]] | None = None) -> str:
        """The table alone in a form of ``tabulate``, names on the left and numbers on the right."""
        sides = ("left",) * self.left + ("right",) * (len(self.heads) - self.left)
        options: dict[str, Any] = {"disable_numparse": True, "preserve_whitespace": True}
        heads = [one if isinstance(one, str) else one.column or one.head for one in self.heads]
        cells = [
            [PLAIN_NO_VALUE if cell == NO_VALUE else cell for cell in row]
            for row in (self.rows if rows is None else rows)
        ]
        return tabulate(cells, headers=heads, tablefmt=form, colalign=sides, **options)

    def page(self) -> dict[str, Any]:
        """The table for the page of the report: heads in one line, units in brackets, signs of units."""
        rows = [[NO_VALUE if cell == PLAIN_NO_VALUE else cell for cell in row] for row in self.rows]
        heads = [_headed(head) if isinstance(head, str) else head.head for head in self.heads]
        title = {"title": self.title} if self.title else {}
        return {**title, "heads": heads, "rows": rows, "variables": list(self.variables)}

    def html(self, most: int | None = None, place: str = "") -> str:
        """Title, table and note for a notebook; of the rows the first ``most``, and the place of the others."""
        page, place = self.page(), place or self.group
        parts = [f"<p><b>{html_text(self.title)}</b></p>"] if self.title else []
        parts.append(html_table(page["heads"], page["rows"][:most]))
        parts += [left_out(len(self.rows), most, place)] if most else []
        return "".join([*parts, *(f"<p>{html_text(line)}</p>" for line in self.note.splitlines())])


def _headed(head: str) -> str:
    """Head of a column in one line, with the unit in brackets and its signs."""
    words = head.replace("\n", " ").replace("urad", "µrad").replace("deg", "°")
    return re.sub(r"(?<!\d) (N m|mm|%|µrad|°|MPa|W|1/min)$", r" [\1]", words)


def with_signs(text: str) -> str:
    """Text with the signs of its units, which terminals may lack."""
    for word, sign in SIGNS.items():
        text = text.replace(f" {word}", f" {sign}")
    return text


def underlined(title: str) -> str:
    """Title of a summary, wrapped, above a line as long as it."""
    lines = textwrap.wrap(title, WIDTH) or ["untitled"]
    return "\n".join([*lines, "=" * max(map(len, lines))])


def filled(lines: Iterable[str]) -> str:
    """Lines, each wrapped."""
    return "\n".join(textwrap.fill(line, WIDTH) for line in lines)


def summary_text(parts: Sequence[str], notes: Sequence[str]) -> str:
    """Parts of a summary with a blank line between them, and its notes, wrapped."""
    return "\n\n".join([*parts, *([filled(notes)] if notes else [])])


def left_out(count: int, most: int, place: str) -> str:
    """Number of rows or columns of a table that a notebook does not show, and where they are, in HTML."""
    return f"<p>and {count - most} more: <code>summary().tables[&quot;{place}&quot;]</code></p>" if count > most else ""


def html_table(heads: Sequence[str], rows: Sequence[Sequence[str]]) -> str:
    """Table in HTML; the first column names the rows, others are on the right if they have heads."""
    head = "".join(_cell("th", text, left=not at) for at, text in enumerate(heads))
    body = ["".join(_cell("td", text, left=not (at and heads)) for at, text in enumerate(row)) for row in rows]
    lines = "".join(f"<tr>{cells}</tr>" for cells in body)
    return f"<table>{f'<thead><tr>{head}</tr></thead>' if heads else ''}<tbody>{lines}</tbody></table>"


def html_text(text: object) -> str:
    """Text for HTML with the signs of its units."""
    return html.escape(with_signs(printable(str(text))).replace(" deg", " °"))


def _cell(kind: str, text: str, *, left: bool) -> str:
    """A cell: the names of rows are on the left, numbers on the right, whatever the notebook's own style."""
    return f'<{kind} style="text-align:{"left" if left else "right"}">{html_text(text)}</{kind}>'
