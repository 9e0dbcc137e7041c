"""Short summary of a sweep as HTML, for a notebook."""

from __future__ import annotations

import xarray as xr

from ..sweep_report import failure_reasons, outcome, sweep_head, sweep_tables, sweep_title
from .html_table import html_table, html_text


def sweep_page(dataset: xr.Dataset) -> str:
    """Summary of a sweep in HTML without a style of its own: what the text of ``easeoff show`` says.

    Parameters
    ----------
    dataset
        A sweep.

    Examples
    --------
    >>> import easeoff
    >>> page = sweep_page(easeoff.sweep("nasa-12x36", {"E": [0.0, 0.02, 0.04]}, torques=[100.0]))
    >>> "3 values from 0 to 0.04 mm</td>" in page
    True
    """
    parts = [f"<h4>{html_text(sweep_title(dataset))}</h4>"]
    parts.append(html_table([], [list(row) for row in sweep_head(dataset)]))
    parts += [f"<p>{html_text(line)}</p>" for line in (outcome(dataset), *failure_reasons(dataset))]
    for table in sweep_tables(dataset):
        parts += [f"<p><b>{html_text(table.title)}</b></p>", html_table(table.heads, table.rows)]
        if table.note:
            parts.append(f"<p>{html_text(table.note)}</p>")
    return "<div>\n" + "\n".join(parts) + "\n</div>"
