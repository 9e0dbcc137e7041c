"""Key numbers of a result as tables of pandas, in the units in which people read them."""

from __future__ import annotations

import math
from itertools import product
from typing import TYPE_CHECKING, Any

import numpy as np
import xarray as xr

from ..key_numbers import key_numbers

if TYPE_CHECKING:
    import pandas as pd

CONDITIONS = ("torque", "speed", "temperature", "roughness")
#: Units of the data that nobody reads, and what they are shown in: unit and factor.
READ_UNITS = {"rad": ("deg", math.degrees(1.0)), "N mm": ("N m", 1e-3), "1": ("", 1.0), "": ("", 1.0)}


def summary_frames(tree: xr.DataTree) -> dict[str, pd.DataFrame]:
    """Key numbers of a result as tables; a column bears the name of its variable and the unit.

    Parameters
    ----------
    tree
        A result.

    Returns
    -------
    dict of str to pandas.DataFrame
        ``unloaded``: one row. ``loaded``: a row a torque [N m]. ``friction``, if the result has it: a row an operating
        condition. Of load cases: ``load_cases`` with a row each.

    Examples
    --------
    >>> import easeoff
    >>> frames = summary_frames(easeoff.analyze("nasa-12x36", torques=[100.0]))
    >>> list(frames), frames["loaded"].index.tolist(), round(frames["loaded"]["harmonic 1 [urad]"].iloc[0])
    (['unloaded', 'loaded'], [100.0], 110)
    """
    if "load_cases" in tree.children:
        return {"load_cases": _frame(tree["load_cases"].to_dataset(), ("load_case",))}
    numbers = key_numbers(tree)
    parts: dict[str, list[str]] = {"unloaded": [], "loaded": [], "friction": []}
    for name, variable in numbers.data_vars.items():
        part = "friction" if "speed" in variable.dims else "loaded" if "torque" in variable.dims else "unloaded"
        parts[part].append(str(name))
    indices: dict[str, tuple[str, ...]] = {"unloaded": (), "loaded": CONDITIONS[:1], "friction": CONDITIONS}
    return {part: _frame(numbers[names], indices[part]) for part, names in parts.items() if names}


def _frame(numbers: xr.Dataset, index: tuple[str, ...]) -> pd.DataFrame:
    """Variables as columns over some dimensions; one with further dimensions takes a column for each of theirs."""
    import pandas as pd

    columns: dict[str, Any] = {}
    for name, variable in numbers.data_vars.items():
        others = [str(dim) for dim in variable.dims if dim not in index]
        whole = variable.transpose(*index, *others)
        flat = whole.values.reshape(*whole.shape[: len(index)], -1)
        # A dimension without values of its own, such as the orders of harmonics, counts from 1.
        along = [numbers[dim].values if dim in numbers.coords else range(1, whole.sizes[dim] + 1) for dim in others]
        for number, place in enumerate(product(*along)):
            head, values = _read(" ".join([str(name), *map(str, place)]), variable, flat[..., number])
            columns[head] = np.ravel(values)
    if not index:
        return pd.DataFrame(columns)
    labels = [_read(name, numbers[name], numbers[name].values) for name in index]
    known = [pd.Index(values, name=head) for head, values in labels]
    return pd.DataFrame(columns, index=known[0] if len(known) == 1 else pd.MultiIndex.from_product(known))


def _read(name: str, variable: xr.DataArray, values: Any) -> tuple[str, Any]:
    """Head and values of a quantity in the unit in which people read it."""
    unit = str(variable.attrs.get("units", ""))
    told, factor = READ_UNITS.get(unit, (unit, 1.0))
    return (f"{name} [{told}]" if told else name), values if factor == 1.0 else factor * values
