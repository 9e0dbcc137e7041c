"""Values of a dataset's variables with their dimensions in a given order."""

from __future__ import annotations

from typing import Any

import numpy as np
import xarray as xr
from numpy.typing import NDArray


def ordered(dataset: xr.Dataset, name: str, *dimensions: str) -> NDArray[Any]:
    """Values of a variable; as quick as they can be read, without coordinates.

    Parameters
    ----------
    dataset
        The dataset.
    name
        Of the variable.
    *dimensions
        All of its dimensions, in the order that is wanted.

    Examples
    --------
    >>> ordered(xr.Dataset({"force": (("segment", "torque"), [[1.0], [2.0]])}), "force", "torque", "segment")
    array([[1., 2.]])
    """
    variable = dataset.variables[name]
    if variable.dims != dimensions:
        variable = variable.transpose(*dimensions)
    return np.asarray(variable.values)
