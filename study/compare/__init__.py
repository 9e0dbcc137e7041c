"""Comparison of solvers on contact problems: run, table, report."""

from __future__ import annotations

import os
from pathlib import Path

import xarray as xr

from .comparison import compare
from .comparison_table import read_table, write_table
from .test_set import write_test_set

__all__ = ["compare", "read_table", "write_comparison", "write_test_set"]


def write_comparison(dataset: xr.Dataset, folder: str | os.PathLike[str]) -> list[Path]:
    """Write table, pictures and report of a comparison into a folder; each file is complete or not there at all.

    Parameters
    ----------
    dataset
        What `compare` returned.
    folder
        Made if it does not exist.

    Returns
    -------
    list of Path
        ``report.md`` first, then ``results.nc``, ``results.csv`` and the pictures.

    Raises
    ------
    InputError
        A file cannot be written.
    """
    # The drawing library is slow to load, and the processes of the solvers import this package too.
    from .comparison_figures import write_figures
    from .comparison_report import write_report

    target = Path(folder)
    tables = write_table(dataset, target)
    pictures = write_figures(dataset, target)
    report = write_report(dataset, target, [f"{path.name}|{caption}" for path, caption in pictures])
    return [report, *tables, *(path for path, _ in pictures)]
