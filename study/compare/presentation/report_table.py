"""Report table: rows of texts, as Markdown for the report, as CSV and as LaTeX."""

from __future__ import annotations

import csv
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from ....core.output_file import whole_file

#: What stands for a number that there is not.
NOTHING = "-"


@dataclass(frozen=True, eq=False)
class ReportTable:
    """A table of the report.

    Attributes
    ----------
    name
        Name of its files.
    head
        Names of the columns.
    rows
        The rows, texts and whole numbers.
    note
        What the columns mean, in Markdown.
    caption
        Line above it, in Markdown; empty under a heading of its own.
    in_report
        Whether it stands in the report, or in its files alone.
    short_rows
        The rows as the report has them, where those of the files are too long for it.
    """

    name: str
    head: Sequence[str]
    rows: Sequence[Sequence[Any]]
    note: str = ""
    caption: str = ""
    in_report: bool = True
    short_rows: Sequence[Sequence[Any]] | None = None

    @property
    def markdown(self) -> str:
        """The table with caption and note, in Markdown; of one that is too long for the report the note alone."""
        if not self.in_report:
            return f"{self.note}\n"
        caption = f"{self.caption}\n\n" if self.caption else ""
        note = f"\n{self.note}\n" if self.note else ""
        rows = self.rows if self.short_rows is None else self.short_rows
        return f"{caption}{_tabulated(self.head, rows, 'github')}\n{note}"

    @property
    def latex(self) -> str:
        """The table in LaTeX, for the package booktabs."""
        return _tabulated(self.head, self.rows, "latex_booktabs") + "\n"

    def write(self, folder: Path) -> list[Path]:
        """Write the table as ``NAME.csv`` and ``NAME.tex``; returns their paths."""
        paths = [folder / f"{self.name}.csv", folder / f"{self.name}.tex"]
        with whole_file(paths[0]) as temporary, temporary.open("w", newline="", encoding="utf-8") as file:
            csv.writer(file, lineterminator="\n").writerows([self.head, *self.rows])
        with whole_file(paths[1]) as temporary:
            temporary.write_text(self.latex, encoding="utf-8")
        return paths


def _tabulated(head: Sequence[str], rows: Sequence[Sequence[Any]], form: str) -> str:
    from tabulate import tabulate

    return str(tabulate(rows, head, tablefmt=form, disable_numparse=True))


def milliseconds(seconds: float) -> str:
    """Time in milliseconds, three digits; a dash if it is not finite.

    >>> milliseconds(1.2345e-3), milliseconds(12.3456), milliseconds(float("nan"))
    ('1.23', '12346', '-')
    """
    if not np.isfinite(seconds):
        return NOTHING
    return f"{1e3 * seconds:.3g}" if seconds < 1.0 else f"{1e3 * seconds:.0f}"


def ratio(value: float) -> str:
    """Ratio with three digits; a dash if it is not finite.

    >>> ratio(1.23456), ratio(float("inf"))
    ('1.23', '-')
    """
    return f"{value:.3g}" if np.isfinite(value) else NOTHING


def residual(value: float) -> str:
    """Residual with two digits; a dash if it is not finite.

    >>> residual(1.23e-6)
    '1.2e-06'
    """
    return f"{value:.1e}" if np.isfinite(value) else NOTHING


def median(values: Any) -> float:
    """Median of the finite values of a column; NaN if there are none."""
    known = values.to_numpy(dtype=float)
    known = known[np.isfinite(known)]
    return float(np.median(known)) if known.size else float("nan")


def quantiles(values: Any, levels: Sequence[float] = (0.5, 0.9, 1.0)) -> list[float]:
    """Quantiles of the finite values of a column; NaN if there are none."""
    known = values.to_numpy(dtype=float)
    known = known[np.isfinite(known)]
    return [float(value) for value in np.quantile(known, levels)] if known.size else [float("nan")] * len(levels)
