"""The written comparison in its folder: report, tables, figures, and what a former one of another study leaves."""

from __future__ import annotations

import os
from collections.abc import Collection
from pathlib import Path

import xarray as xr

from ...core.checks import file_path
from ...core.errors import InputError
from ..compare.attempt import SETTINGS
from ..compare.comparison_table import TABLE_FILE, read_table, write_table
from ..plot.matplotlib_defaults import drawing
from .comparison_report import FIGURE_FOLDER, FIGURE_FORMATS, TABLE_FOLDER, write_report

#: Names of all tables and figures that a report may have.
TABLE_NAMES = (
    *(f"answers_{settings}" for settings in SETTINGS),
    "certified_by_kind",
    "run_time",
    "time_parts",
    "starts",
    "pairs",
    "work_precision",
    "sweep",
    "growth",
    "residuals",
    "violations",
    "failures",
)
FIGURE_NAMES = ("performance_profile", "data_profile", "pairs", "work_precision", "run_time")
#: What makes two studies different: their problems, and the methods that are tried on them.
STUDY_COLUMNS = ["problem_file", "problem", "problem_name", "solver", "settings", "solver_tolerance", "start"]


def is_of_another_study(dataset: xr.Dataset, folder: Path) -> bool:
    """True if a folder holds the report of a comparison of other problems or methods."""
    if not (folder / TABLE_FILE).exists():
        return False
    try:
        former = read_table(folder / TABLE_FILE)
    except InputError:
        return True
    return _study(former) != _study(dataset)


def remove_left_files(folder: Path, written: Collection[Path]) -> list[Path]:
    """Remove tables and figures of a former report that the new one does not have; returns their paths."""
    known = [folder / TABLE_FOLDER / f"{name}.{suffix}" for name in TABLE_NAMES for suffix in ("csv", "tex")]
    known += [folder / FIGURE_FOLDER / f"{name}.{suffix}" for name in FIGURE_NAMES for suffix in FIGURE_FORMATS]
    left = [path for path in known if path not in written and path.is_file()]
    for path in left:
        path.unlink()
    return left


def _study(dataset: xr.Dataset) -> set[tuple[object, ...]]:
    return set(zip(*(dataset[name].values.tolist() for name in STUDY_COLUMNS), strict=True))


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
    >>> from easeoff.study.compare import compare
    >>> problem = ContactProblem([0.0, 1e-3], [50.0, 50.0], 1e4, ([1e-5, 1e-5], [[1e-3], [2e-3]]))
    >>> with TemporaryDirectory() as folder:
    ...     write_problems([problem], f"{folder}/problems.nc")
    ...     table = compare([f"{folder}/problems.nc"], folder, solvers=["native"], repetitions=1)
    ...     [path.name for path in write_comparison(table, folder)][:3]
    ['report.md', 'answers_scaled.csv', 'answers_scaled.tex']
    """
    target = file_path("folder", folder)
    attempts = write_table(dataset, target)
    with drawing(None):
        from .comparison_figures import write_figures  # which takes the style as it is loaded

        figures, pictures = write_figures(dataset, target)
    written = [*write_report(dataset, target, pictures), *attempts, *figures]
    try:
        remove_left_files(target, written)
    except OSError as error:
        raise InputError(f"{target}: a file of a former report cannot be removed: {error.strerror or error}") from error
    return written
