"""Accessor ``easeoff`` of a dataset of xarray: what one does with a sweep in a notebook.

Numbers of a sweep as tables of pandas, in the units in which people read them.

Short summary of a sweep as HTML, for a notebook.
"""

from __future__ import annotations

import os
from functools import cached_property, partial
from pathlib import Path
from typing import TYPE_CHECKING, Any

import xarray as xr

from ...core.errors import InputError
from ..summary.sweep_report import (
    SENSITIVE_NUMBERS,
    SHOWN_PERCENT,
    WORST_COUNT,
    WORST_NUMBER,
    failure_reasons,
    outcome,
    shown_numbers,
    sweep_head,
    sweep_summary,
    sweep_tables,
    sweep_title,
)
from ..summary.table import html_table, html_text
from ..sweep.reductions import LOADS, numbers, percentiles, point_dimensions, sensitivities, worst_points
from ..sweep.sweep_file import is_sweep, sweep_faults, write_sweep
from .result_accessor import ShownContent, ShownPictures, ShownSummary, frame_over

if TYPE_CHECKING:
    from collections.abc import Callable

    import pandas as pd
    from matplotlib.figure import Figure


class SweepSummary(ShownSummary):
    """Summary of a sweep: printed it is the text of ``easeoff show``, in a notebook a short page.

    Parameters
    ----------
    dataset
        A sweep.

    Examples
    --------
    >>> import easeoff
    >>> found = easeoff.sweep("nasa-12x36", {"E": [0.0, 0.02, 0.04]}, torques=[100.0])
    >>> print(str(found.easeoff.summary()).splitlines()[3])
    E             3 values from 0 to 0.04 mm
    >>> points = found.easeoff.summary().tables["points"]
    >>> points["peak_to_peak [urad]"].tolist() == found["peak_to_peak"].values.ravel().tolist()
    True
    """

    def __init__(self, dataset: xr.Dataset) -> None:
        self._dataset = _checked_sweep(dataset)
        self.text = sweep_summary(dataset)

    @cached_property
    def tables(self) -> dict[str, pd.DataFrame]:
        """Tables of pandas: ``points``, ``percentiles``, ``sensitivities_NAME`` and ``worst``.

        Columns bear names and units as in those of a result; ``points`` has all numbers, a row a point and torque.
        """
        return sweep_frames(self._dataset)

    def _repr_html_(self) -> str:
        return sweep_page(self._dataset)


class SweepPlots(ShownPictures):
    """Pictures of a sweep: ``plot()`` is the first that it has, ``plot.map()`` and so on one by its name.

    Parameters
    ----------
    dataset
        A sweep.

    Examples
    --------
    >>> import easeoff
    >>> found = easeoff.sweep("nasa-12x36", {"E": [0.0, 0.02, 0.04]}, torques=[100.0])
    >>> found.easeoff.plot
    pictures of a sweep: curves, pattern
    """

    kind = "sweep"

    def __init__(self, dataset: xr.Dataset) -> None:
        self._dataset = dataset

    def __call__(self, picture: str | None = None, **options: Any) -> Figure | None:
        """Draw a picture; arguments as of ``easeoff.plot.sweep``."""
        from ..plot.sweep_charts import sweep

        figure: Figure | None = sweep(self._dataset, picture, **options)
        return figure

    def __dir__(self) -> list[str]:
        from ..plot.sweep_charts import short_names

        return list(short_names(self._dataset))

    def _bound(self, name: str) -> Callable[..., Figure | None]:
        return partial(self, name)


class SweepAccessor(ShownContent):
    """Tables, summary and pictures of a sweep in a notebook: ``found.easeoff`` of every ``xarray.Dataset``.

    Every method raises ``InputError`` if the dataset is none of ``sweep`` or ``study.sweep.read_sweep``.

    Parameters
    ----------
    dataset
        The dataset.

    Examples
    --------
    >>> import easeoff
    >>> xr.Dataset().easeoff.summary()
    Traceback (most recent call last):
    easeoff.core.errors.InputError: dataset: must be a sweep of easeoff.sweep or easeoff.study.sweep.read_sweep
    """

    def __init__(self, dataset: xr.Dataset) -> None:
        self._dataset = dataset

    def summary(self) -> SweepSummary:
        """Swept coordinates, percentiles, sensitivities and worst points."""
        return SweepSummary(self._sweep())

    @property
    def plot(self) -> SweepPlots:
        """Pictures: ``found.easeoff.plot.map(...)`` is ``easeoff.plot.sweep(found, "map", ...)``, and so on."""
        return SweepPlots(self._sweep())

    def save(self, path: str | os.PathLike[str]) -> Path:
        """Write the sweep to a netCDF-4 file and return its path; see ``study.sweep.write_sweep``.

        Parameters
        ----------
        path
            File to write, replaced if it exists; missing folders are made.
        """
        write_sweep(self._sweep(), path)
        return Path(path)

    def _sweep(self) -> xr.Dataset:
        return _checked_sweep(self._dataset)


def _checked_sweep(dataset: xr.Dataset) -> xr.Dataset:
    """A dataset, if it is a sweep."""
    if not is_sweep(dataset):
        raise InputError("dataset: must be a sweep of easeoff.sweep or easeoff.study.sweep.read_sweep")
    if faults := sweep_faults(dataset):
        raise InputError(f"dataset: a sweep that is damaged or changed: {faults[0]}")
    return dataset


def sweep_frames(dataset: xr.Dataset) -> dict[str, pd.DataFrame]:
    """Tables of a sweep by name: points, percentiles, sensitivities of each number, and worst points.

    A column bears the name of its variable and the unit; points that failed have a row, too.
    """
    loads = [name for name in LOADS if name in dataset.dims]
    rows = (*point_dimensions(dataset), *loads)
    frames = {"points": _whole(dataset, rows)}
    known = shown_numbers(dataset)
    if not known:
        return frames
    reduced = percentiles(dataset, SHOWN_PERCENT, known)
    frames["percentiles"] = _whole(reduced, ("percentile", *(name for name in loads if name in reduced.dims)))
    for name in SENSITIVE_NUMBERS:
        try:
            sensitivity = sensitivities(dataset, name)
        except InputError:
            continue
        frames[f"sensitivities_{name}"] = _whole(
            sensitivity, ("coordinate", *(one for one in loads if one in sensitivity.dims))
        )
    if WORST_NUMBER in numbers(dataset):
        frames["worst"] = _whole(worst_points(dataset, WORST_NUMBER, WORST_COUNT), ("rank",))
    return frames


def _along(variable: Any, sizes: dict[Any, int]) -> Any:
    """A variable repeated along the dimensions that it lacks."""
    return variable.set_dims(sizes)


def _whole(dataset: xr.Dataset, index: tuple[str, ...]) -> pd.DataFrame:
    """All numbers of a dataset over some dimensions; what does not depend on one of them is repeated along it."""
    beside = [str(name) for name in dataset.coords if name not in dataset.dims and set(dataset[name].dims) <= {*index}]
    data = dataset.reset_coords(beside).assign_coords(
        {name: range(dataset.sizes[name]) for name in index if name not in dataset.coords}
    )
    sizes = {name: dataset.sizes[name] for name in index}
    repeated = {
        name: _along(variable.variable, {**sizes, **variable.sizes}) for name, variable in data.data_vars.items()
    }
    return frame_over(data.drop_vars(list(data.data_vars)).assign(repeated), index)


def sweep_page(dataset: xr.Dataset) -> str:
    """Summary of a sweep in HTML without a style, as of ``easeoff show``."""
    parts = [f"<h4>{html_text(sweep_title(dataset))}</h4>"]
    parts.append(html_table([], [list(row) for row in sweep_head(dataset)]))
    parts += [f"<p>{html_text(line)}</p>" for line in (outcome(dataset), *failure_reasons(dataset))]
    parts += [table.html() for table in sweep_tables(dataset)]
    return "<div>\n" + "\n".join(parts) + "\n</div>"
