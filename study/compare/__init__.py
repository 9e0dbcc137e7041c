"""Comparison of solvers on contact problems: attempts, table, report and test set."""

from __future__ import annotations

import os
from pathlib import Path

import xarray as xr

from ...core.checks import file_path
from ...core.errors import InputError
from .comparison import compare
from .comparison_table import write_table

__all__ = ["compare", "write_comparison"]


def write_comparison(dataset: xr.Dataset, folder: str | os.PathLike[str]) -> list[Path]:
    """Write the report, tables and figures of a comparison into a folder.

    Parameters
    ----------
    dataset
        Result of ``compare``.
    folder
        Folder for the files; made if it does not exist.

    Returns
    -------
    list of Path
        ``report.md`` first, then its tables as CSV and LaTeX in ``tables``, the table of all attempts as ``results.nc``
        and ``results.csv``, and the figures as PNG, PDF and SVG in ``figures``. Tables and figures of a former report
        in the folder that this one does not have are removed.

    Raises
    ------
    InputError
        If a file cannot be written.

    Examples
    --------
    >>> from tempfile import TemporaryDirectory
    >>> from easeoff.contact import ContactProblem, write_problems
    >>> problem = ContactProblem([0.0, 1e-3], [50.0, 50.0], 1e4, ([1e-5, 1e-5], [[1e-3], [2e-3]]))
    >>> with TemporaryDirectory() as folder:
    ...     write_problems([problem], f"{folder}/problems.nc")
    ...     table = compare([f"{folder}/problems.nc"], folder, solvers=["native"], repetitions=1)
    ...     [path.name for path in write_comparison(table, folder)][:3]
    ['report.md', 'answers_scaled.csv', 'answers_scaled.tex']
    """
    # The drawing library is slow to load, and the processes of the solvers import this package too.
    from ..plot.drawing_style import drawing
    from .presentation.comparison_report import write_report

    target = file_path("folder", folder)
    attempts = write_table(dataset, target)
    with drawing(None):
        from .presentation.comparison_figures import write_figures

        figures, pictures = write_figures(dataset, target)
        from .presentation.former_report import remove_left_files

    written = [*write_report(dataset, target, pictures), *attempts, *figures]
    try:
        remove_left_files(target, written)
    except OSError as error:
        raise InputError(f"{target}: a file of a former report cannot be removed: {error.strerror or error}") from error
    return written
