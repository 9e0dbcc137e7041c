"""Reductions of a sweep: percentiles, first-order sensitivities, and the worst points."""

from __future__ import annotations

import json
from collections.abc import Sequence
from typing import Any

import numpy as np
import xarray as xr

from ...core.arrays import Array
from ...core.attributes import labelled
from ...core.checks import array, one_of, truth, whole, words
from ...core.errors import InputError

PERCENTILES = (1.0, 5.0, 25.0, 50.0, 75.0, 95.0, 99.0)
ROWS = ("sample", "load_case")
LOADS = ("torque", "speed", "temperature", "roughness")
#: Samples more than coordinates that a regression needs at least.
SPARE_SAMPLES = 2


def numbers(dataset: xr.Dataset) -> list[str]:
    """Names of the numbers that vary over a sweep and can be reduced."""
    dimensions = set(reduced_dimensions(dataset))
    return [
        str(name)
        for name, variable in dataset.data_vars.items()
        if variable.dtype.kind == "f" and dimensions & set(variable.dims) and name not in ("marking",)
    ]


def swept_names(dataset: xr.Dataset) -> list[str]:
    """Names of the swept coordinates; InputError if the dataset is not that of a sweep."""
    try:
        names = json.loads(dataset.attrs["swept"])
    except (AttributeError, KeyError, ValueError, TypeError):
        names = None
    if not isinstance(names, list) or not all(isinstance(name, str) and name in dataset.coords for name in names):
        raise InputError("dataset: must be that of a sweep, with its coordinates")
    return names


def point_dimensions(dataset: xr.Dataset) -> list[str]:
    """Dimensions over which points are analysed apart: those of the sweep but torque and operating conditions."""
    dimensions = {str(dim) for name in swept_names(dataset) for dim in dataset[name].dims if dim not in LOADS}
    return [str(dim) for dim in dataset["status"].dims if dim in dimensions]


def reduced_dimensions(dataset: xr.Dataset) -> list[str]:
    """Dimensions over which numbers are reduced: those of the points, or else the loads that are swept."""
    swept = swept_names(dataset)
    return point_dimensions(dataset) or [name for name in LOADS if name in swept and name in dataset.dims]


def percentiles(
    dataset: xr.Dataset, percent: Sequence[float] = PERCENTILES, names: Sequence[str] | None = None
) -> xr.Dataset:
    """Percentiles of numbers over all points of a sweep, at each torque and operating condition.

    Parameters
    ----------
    dataset
        From ``sweep``.
    percent
        From 0 to 100.
    names
        Of the numbers; all if left out.

    Returns
    -------
    xr.Dataset
        The numbers over ``percentile`` and what is left of their dimensions; failed points are left out.

    Raises
    ------
    InputError
        If a number is unknown, or a percentage is not from 0 to 100.

    Examples
    --------
    >>> import easeoff
    >>> dataset = easeoff.sweep("nasa-12x36", {"E": [0.0, 0.02, 0.04]}, torques=[100.0])
    >>> middle = percentiles(dataset, [50.0], ["peak_to_peak"])["peak_to_peak"]
    >>> bool(middle.item() == dataset["peak_to_peak"].sel(E=0.02).item())
    True
    """
    wanted = array("percent", percent, ndim=1, least=0.0, most=100.0)
    dimensions = set(reduced_dimensions(dataset))
    data: dict[str, Any] = {}
    for name in numbers(dataset) if names is None else words("names", names):
        variable = dataset[one_of("name", name, numbers(dataset))].variable
        over = [dim for dim in variable.dims if dim in dimensions]
        rest = [dim for dim in variable.dims if dim not in dimensions]
        values = variable.transpose(*over, *rest).values.reshape(-1, *(variable.sizes[dim] for dim in rest))
        data[name] = (("percentile", *rest), _percentiles(values, wanted), variable.attrs)
    coords: dict[Any, Any] = {"percentile": ("percentile", wanted, {"units": "percent", "long_name": "percentile"})}
    coords |= {name: coordinate for name, coordinate in dataset.coords.items() if not dimensions & set(coordinate.dims)}
    return xr.Dataset(data, coords=coords)


def _percentiles(values: Array, percent: Array) -> Array:
    """Percentiles along the first axis; NaN where all values are."""
    quantiles = np.full((percent.size, *values.shape[1:]), np.nan)
    for at in np.ndindex(values.shape[1:]):
        known = values[(slice(None), *at)]
        known = known[~np.isnan(known)]
        if known.size:
            quantiles[(slice(None), *at)] = np.percentile(known, percent)
    return quantiles


def sensitivities(dataset: xr.Dataset, name: str) -> xr.Dataset:
    """First-order sensitivities of a number to the swept coordinates.

    On samples by linear regression on all sampled coordinates at once; on grids by the difference quotient at the
    middle of the grid, between the neighbours of the middle point. Load cases have none.

    Parameters
    ----------
    dataset
        From ``sweep``.
    name
        Of the number.

    Returns
    -------
    xr.Dataset
        Over ``coordinate`` and what is left of the number's dimensions: ``slope`` of the number by the coordinate,
        ``effect``, the change with one ``scale`` of the coordinate (the standard deviation of its samples, or half the
        range of its grid), and ``variance_share``, the share of the number's variance over the samples that is due to
        the coordinate alone; NaN on grids. A torque of a grid is no coordinate: there is a sensitivity at each.

    Raises
    ------
    InputError
        If there is no such number, or no coordinate with numbers and a sensitivity.

    Examples
    --------
    >>> import easeoff
    >>> dataset = easeoff.sweep("nasa-12x36", {"E": [0.0, 0.02, 0.04]}, torques=[100.0])
    >>> values = dataset["peak_to_peak"].values
    >>> bool(abs(sensitivities(dataset, "peak_to_peak")["effect"] - (values[2] - values[0]) / 2).item() < 1e-9)
    True
    """
    one_of("name", name, numbers(dataset))
    variable = dataset[name]
    dimensions = point_dimensions(dataset)
    sampled = [one for one in swept_names(dataset) if dataset[one].dims == ("sample",)]
    sampled = [one for one in sampled if dataset[one].dtype.kind in "fiu"]
    gridded = [
        one for one in dimensions if one not in ROWS and dataset[one].dtype.kind == "f" and dataset.sizes[one] > 1
    ]
    gridded = [one for one in gridded if one in variable.dims]
    middle = {dim: dataset.sizes[dim] // 2 for dim in dimensions if dim not in ROWS and dim in variable.dims}
    parts: list[tuple[str, Array, float, Array]] = []
    rest = [dim for dim in variable.dims if dim not in dimensions]
    if sampled and "sample" in variable.dims:
        values = variable.isel(middle).transpose("sample", *rest).values
        parts += _regression(np.stack([dataset[one].values for one in sampled], axis=1), values, sampled)
    if "load_case" not in variable.dims:
        for one in gridded:
            at = {dim: place for dim, place in middle.items() if dim != one}
            line = variable.isel(at)
            line = line.median("sample", keep_attrs=True) if "sample" in line.dims else line
            parts.append(_difference(one, dataset[one].values, line.transpose(one, *rest).values))
    if not parts:
        raise InputError(
            f"{name}: has no sensitivities, as no coordinate with several numbers is sampled, or a grid apart from "
            "torque and operating conditions"
        )
    units = str(variable.attrs.get("units", "1"))
    dims = ("coordinate", *rest)
    data = {
        "slope": (dims, np.stack([part[1] for part in parts]), {"units": f"{units} per unit of the coordinate"}),
        "scale": ("coordinate", np.array([part[2] for part in parts])),
        "effect": (dims, np.stack([part[1] * part[2] for part in parts]), {"units": units}),
        "variance_share": (dims, np.stack([part[3] for part in parts])),
    }
    coords: dict[Any, Any] = {"coordinate": np.array([part[0] for part in parts])}
    coords |= {key: coordinate for key, coordinate in dataset.coords.items() if key in rest}
    return labelled(xr.Dataset(data, coords=coords, attrs={"number": name}))


def _regression(inputs: Array, values: Array, names: Sequence[str]) -> list[tuple[str, Array, float, Array]]:
    """Slope, standard deviation and share of the variance of every input (n, k) to values (n, ...)."""
    shape, count = values.shape[1:], len(names)
    scales = inputs.std(axis=0)
    varied = np.ptp(inputs, axis=0) > 0.0
    slope, share = np.full((count, *shape), np.nan), np.full((count, *shape), np.nan)
    for at in np.ndindex(shape):
        output = values[(slice(None), *at)]
        known = ~np.isnan(output)
        if np.count_nonzero(known) < count + SPARE_SAMPLES or not varied.any():
            continue
        centred = (inputs[known] - inputs[known].mean(axis=0))[:, varied] / scales[varied]
        coefficients, *_ = np.linalg.lstsq(centred, output[known] - output[known].mean(), rcond=None)
        slope[(varied, *at)] = coefficients / scales[varied]
        variance = output[known].var()
        share[(varied, *at)] = (coefficients * centred.std(axis=0)) ** 2 / variance if variance > 0.0 else 0.0
    return [(name, slope[i], float(scales[i]), share[i]) for i, name in enumerate(names)]


def _difference(name: str, grid: Array, values: Array) -> tuple[str, Array, float, Array]:
    """Difference quotient of values (n, ...) at the middle of a grid (n) between the neighbours."""
    order = np.argsort(grid)
    grid, values = grid[order], values[order]
    middle = grid.size // 2
    low, high = max(middle - 1, 0), min(middle + 1, grid.size - 1)
    slope = np.asarray((values[high] - values[low]) / (grid[high] - grid[low]))
    return name, slope, float(np.ptp(grid) / 2.0), np.full(slope.shape, np.nan)


def worst_points(dataset: xr.Dataset, name: str, count: int = 3, *, least: bool = False) -> xr.Dataset:
    """Points with the greatest values of a number.

    Parameters
    ----------
    dataset
        From ``sweep``.
    name
        Of the number.
    count
        Of the points; fewer if fewer are known.
    least
        The least values in place of the greatest.

    Returns
    -------
    xr.Dataset
        The number and the coordinates over ``rank``, the worst first; ``row`` is the number of the point among those
        that are analysed apart.

    Raises
    ------
    InputError
        If there is no such number.

    Examples
    --------
    >>> import easeoff
    >>> dataset = easeoff.sweep("nasa-12x36", {"E": [0.0, 0.02, 0.04]}, torques=[100.0])
    >>> worst = int(dataset["peak_to_peak"].values.argmax())
    >>> bool(worst_points(dataset, "peak_to_peak", 1)["E"].item() == dataset["E"].values[worst])
    True
    """
    one_of("name", name, numbers(dataset))
    whole("count", count, 1)
    truth("least", least)
    variable = dataset[name]
    values = variable.values.ravel()
    known = np.flatnonzero(~np.isnan(values))
    order = known[np.argsort(values[known] if least else -values[known], kind="stable")][:count]
    places = dict(zip(map(str, variable.dims), np.unravel_index(order, variable.shape), strict=True))
    dimensions = point_dimensions(dataset)
    rows = (
        np.ravel_multi_index([places[dim] for dim in dimensions], [dataset.sizes[dim] for dim in dimensions])
        if dimensions
        else 0 * order
    )
    data: dict[str, Any] = {name: ("rank", values[order], variable.attrs)}
    data["row"] = ("rank", rows, {"long_name": "number of the point", "units": "1"})
    for one, coordinate in dataset.coords.items():
        if coordinate.ndim == 1 and coordinate.dims[0] in places:
            data[str(one)] = ("rank", coordinate.values[places[str(coordinate.dims[0])]], coordinate.attrs)
    return xr.Dataset(data).set_coords([one for one in data if one != name])
