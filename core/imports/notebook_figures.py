"""Figures that show themselves in a notebook."""

from __future__ import annotations

import sys
from contextlib import suppress
from typing import Any

FIGURE = ("matplotlib.figure", "Figure")


def show_figures_in_notebooks() -> None:
    """Have a notebook show a matplotlib ``Figure`` that is the value of a cell, unless it does so already.

    IPython does so only once ``matplotlib.pyplot`` is loaded, which figures that belong to nobody's global state do
    not need. Neither IPython nor matplotlib is imported here.

    Examples
    --------
    >>> show_figures_in_notebooks()  # nothing, but in a notebook
    """
    with suppress(Exception):  # of a shell of another kind: the figure is then shown as text
        shell = sys.modules["IPython"].get_ipython()
        formatter = shell.display_formatter.formatters["image/png"]
        try:
            formatter.lookup_by_type(".".join(FIGURE))
        except KeyError:
            formatter.for_type_by_name(*FIGURE, _png)


def _png(figure: Any) -> Any:
    """The picture of a figure, as IPython draws it."""
    from IPython.core.pylabtools import print_figure

    return print_figure(figure, "png")
