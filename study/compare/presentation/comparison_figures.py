"""Comparison figures, each as PNG, PDF and SVG."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import Any

import xarray as xr
from matplotlib.figure import Figure

from ...plot.page import save
from ..statistics.method_statistics import by_problem, headline, methods
from ..statistics.work_precision import has_sweep
from .comparison_report import Picture
from .profile_figures import draw_data_profile, draw_pairs, draw_performance_profile
from .time_figures import draw_growth, draw_work_precision
from .time_tables import size_groups

#: Folder of the figures beside the report.
FIGURE_FOLDER = "figures"
#: Formats of every figure, by suffix.
FIGURE_FORMATS = ("png", "pdf", "svg")

Drawing = Callable[[xr.Dataset, Any], Figure]


def write_figures(dataset: xr.Dataset, folder: Path) -> tuple[list[Path], list[Picture]]:
    """Draw the figures; returns all files, and the pictures of the report.

    Raises
    ------
    InputError
        If a file cannot be written.
    """
    problems = by_problem(dataset)
    drawings: list[tuple[str, str, str, Drawing]] = [
        ("Run time", "performance_profile", "Performance profile", draw_performance_profile),
        ("Run time", "data_profile", "Data profile", draw_data_profile),
    ]
    if len(headline(methods(problems, float(dataset.attrs["time_limit_s"])))) > 1:
        drawings.append(("Pairs of solvers", "pairs", "Pairs of solvers", draw_pairs))
    if has_sweep(dataset):
        drawings.append(("Work and precision", "work_precision", "Work and precision", draw_work_precision))
    if size_groups(problems):
        drawings.append(("Growth", "run_time", "Run time against size", draw_growth))
    written, pictures = [], []
    for section, name, caption, draw in drawings:
        files = write_figure(draw(dataset, problems), folder / FIGURE_FOLDER, name)
        written += files
        pictures.append(Picture(section, f"{FIGURE_FOLDER}/{files[0].name}", caption))
    return written, pictures


def write_figure(figure: Figure, folder: Path, name: str) -> list[Path]:
    """Write a figure as ``NAME.png``, ``NAME.pdf`` and ``NAME.svg``; returns their paths.

    The same figure gives the same files: they bear no date, and the names within the SVG file come from a fixed salt.
    """
    return [save(figure, folder / f"{name}.{suffix}") for suffix in FIGURE_FORMATS]
