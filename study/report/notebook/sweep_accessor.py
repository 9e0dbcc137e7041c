"""Accessor ``easeoff`` of a dataset of xarray: what one does with a sweep in a notebook."""

from __future__ import annotations

import os
from functools import cached_property, partial
from pathlib import Path
from typing import TYPE_CHECKING, Any

import xarray as xr

from ....core.errors import InputError, suggestion
from ...sweep.sweep_file import is_sweep, write_sweep
from ...sweep.sweep_layout import sweep_faults
from ..sweep_report import sweep_summary

if TYPE_CHECKING:
    from collections.abc import Callable

    import pandas as pd
    from matplotlib.figure import Figure


class SweepSummary:
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
        from .sweep_frames import sweep_frames

        return sweep_frames(self._dataset)

    def __str__(self) -> str:
        return self.text

    def __repr__(self) -> str:
        return self.text

    def _repr_html_(self) -> str:
        from .sweep_page import sweep_page

        return sweep_page(self._dataset)


class SweepPlots:
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

    def __init__(self, dataset: xr.Dataset) -> None:
        self._dataset = dataset

    def __call__(self, picture: str | None = None, **options: Any) -> Figure | None:
        """Draw a picture; arguments as of ``easeoff.plot.sweep``."""
        from ...plot.figures.study_figures import sweep

        figure: Figure | None = sweep(self._dataset, picture, **options)
        return figure

    def __dir__(self) -> list[str]:
        from ...plot.charts.sweep_chart import short_names

        return list(short_names(self._dataset))

    def __repr__(self) -> str:
        return f"pictures of a sweep: {', '.join(dir(self))}"

    def __getattr__(self, name: str) -> Callable[..., Figure | None]:
        if name.startswith("_"):
            raise AttributeError(name)
        there = dir(self)
        if name not in there:
            known = ", ".join(there)
            raise AttributeError(f"there is no picture {name!r}; there are: {known}{suggestion(name, there)}")
        return partial(self, name)


class SweepAccessor:
    """What one does with a sweep in a notebook: ``found.easeoff`` of every ``xarray.Dataset``.

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

    def __repr__(self) -> str:
        try:
            return self.summary().text
        except InputError as error:
            return str(error)

    def _repr_html_(self) -> str | None:
        try:
            return self.summary()._repr_html_()
        except InputError:
            return None  # a notebook shows the text instead

    def _sweep(self) -> xr.Dataset:
        return _checked_sweep(self._dataset)


def _checked_sweep(dataset: xr.Dataset) -> xr.Dataset:
    """A dataset, if it is a sweep."""
    if not is_sweep(dataset):
        raise InputError("dataset: must be a sweep of easeoff.sweep or easeoff.study.sweep.read_sweep")
    if faults := sweep_faults(dataset):
        raise InputError(f"dataset: a sweep that is damaged or changed: {faults[0]}")
    return dataset
