"""A former report in the folder of a comparison: whether it is of another study, and what it leaves behind."""

from __future__ import annotations

from collections.abc import Collection
from pathlib import Path

import xarray as xr

from ....core.errors import InputError
from ..comparison_table import TABLE_FILE, read_table
from ..measurement.method import SETTINGS
from .comparison_figures import FIGURE_FOLDER, FIGURE_FORMATS
from .comparison_report import TABLE_FOLDER

#: Names of all tables and figures that a report may have.
TABLE_NAMES = (
    *(f"answers_{settings}" for settings in SETTINGS),
    *("certified_by_kind", "run_time", "time_parts", "starts", "pairs", "work_precision", "sweep", "growth"),
    *("residuals", "violations", "failures"),
)
FIGURE_NAMES = ("performance_profile", "data_profile", "pairs", "work_precision", "run_time")
#: What makes two studies different: their problems, and the methods that are tried on them.
STUDY_COLUMNS = ["problem_file", "problem", "problem_name", "solver", "settings", "solver_tolerance", "start"]


def is_of_another_study(dataset: xr.Dataset, folder: Path) -> bool:
    """Whether a folder holds the report of a comparison of other problems or methods.

    Parameters
    ----------
    dataset
        Result of ``compare``.
    folder
        Folder of its report.
    """
    if not (folder / TABLE_FILE).exists():
        return False
    try:
        former = read_table(folder / TABLE_FILE)
    except InputError:
        return True
    return _study(former) != _study(dataset)


def remove_left_files(folder: Path, written: Collection[Path]) -> list[Path]:
    """Remove the tables and figures of a former report that the new one does not have; returns their paths.

    Parameters
    ----------
    folder
        Folder of the report.
    written
        Files of the new one.
    """
    known = [folder / TABLE_FOLDER / f"{name}.{suffix}" for name in TABLE_NAMES for suffix in ("csv", "tex")]
    known += [folder / FIGURE_FOLDER / f"{name}.{suffix}" for name in FIGURE_NAMES for suffix in FIGURE_FORMATS]
    left = [path for path in known if path not in written and path.is_file()]
    for path in left:
        path.unlink()
    return left


def _study(dataset: xr.Dataset) -> set[tuple[object, ...]]:
    return set(zip(*(dataset[name].values.tolist() for name in STUDY_COLUMNS), strict=True))
