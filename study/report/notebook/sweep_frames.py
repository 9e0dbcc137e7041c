"""Numbers of a sweep as tables of pandas, in the units in which people read them."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import xarray as xr

from ....core.errors import InputError
from ...sweep.reductions import LOADS, numbers, percentiles, point_dimensions, sensitivities, worst_points
from ..sweep_report import SENSITIVE_NUMBERS, SHOWN_PERCENT, WORST_COUNT, WORST_NUMBER, shown_numbers
from .summary_frames import frame_over

if TYPE_CHECKING:
    import pandas as pd


def sweep_frames(dataset: xr.Dataset) -> dict[str, pd.DataFrame]:
    """Numbers of a sweep as tables; a column bears the name of its variable and the unit.

    Parameters
    ----------
    dataset
        A sweep.

    Returns
    -------
    dict of str to pandas.DataFrame
        ``points``: all numbers, a row a point, torque and condition, also those that failed. ``percentiles`` of the
        main numbers, ``sensitivities_NAME`` of each that has some, and ``worst``, the points with the greatest
        pressure.

    Examples
    --------
    >>> import easeoff
    >>> frames = sweep_frames(easeoff.sweep("nasa-12x36", {"E": [0.0, 0.02, 0.04]}, torques=[100.0]))
    >>> list(frames)[:2], list(frames["points"].index.names)
    (['points', 'percentiles'], ['E [mm]', 'torque [N m]'])
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
            found = sensitivities(dataset, name)
        except InputError:
            continue
        frames[f"sensitivities_{name}"] = _whole(found, ("coordinate", *(one for one in loads if one in found.dims)))
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
