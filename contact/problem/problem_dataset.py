"""A contact problem as an xarray Dataset, with units; and the table of units and meanings that files share."""

from __future__ import annotations

from typing import Any

import numpy as np
import xarray as xr
from numpy.typing import NDArray

from ...core.errors import InputError

Array = NDArray[np.float64]

FORMAT = "easeoff contact problem"
FORMAT_VERSION = 1

#: Units and meaning of every variable of a stored problem.
ATTRIBUTES: dict[str, dict[str, str]] = {
    "separation": {"units": "mm", "long_name": "normal gap of the unloaded segments at zero rotation"},
    "lever_arm": {"units": "mm", "long_name": "lever arm of the contact normal about the gear axis"},
    "torque": {"units": "N mm", "long_name": "torque about the gear axis"},
    "compliance": {"units": "mm/N", "long_name": "normal deflection of a segment by a unit force on another"},
    "compliance_diagonal": {"units": "mm/N", "long_name": "diagonal part d of the compliance diag(d) + V V^T"},
    "compliance_factor": {"units": "(mm/N)^0.5", "long_name": "factor V of the compliance diag(d) + V V^T"},
}


def problem_dataset(
    separation: Array, lever_arm: Array, torque: float, compliance: Array | tuple[Array, Array]
) -> xr.Dataset:
    """Return separation, lever_arm (segment), torque, and compliance (segment, segment_other) or its two parts."""
    variables: dict[str, tuple[tuple[str, ...], Array]] = {
        "separation": (("segment",), separation),
        "lever_arm": (("segment",), lever_arm),
        "torque": ((), np.array(torque)),
    }
    if isinstance(compliance, tuple):
        variables["compliance_diagonal"] = (("segment",), compliance[0])
        variables["compliance_factor"] = (("segment", "mode"), compliance[1])
    else:
        variables["compliance"] = (("segment", "segment_other"), compliance)
    return xr.Dataset(
        {name: (dims, values.copy(), ATTRIBUTES[name]) for name, (dims, values) in variables.items()},
        attrs={"format": FORMAT, "format_version": FORMAT_VERSION},
    )


def problem_data(dataset: xr.Dataset) -> tuple[Any, Any, Any, Any]:
    """Return separation, lever arm, torque and compliance from `problem_dataset`.

    Raises
    ------
    InputError
        The Dataset lacks a variable.
    """
    structured = "compliance" not in dataset and "compliance_factor" in dataset
    parts = ("compliance_diagonal", "compliance_factor") if structured else ("compliance",)
    missing = [name for name in ("separation", "lever_arm", "torque", *parts) if name not in dataset]
    if missing:
        raise InputError(f"no contact problem in this Dataset: it lacks {', '.join(missing)}")
    compliance = tuple(dataset[name].to_numpy() for name in parts)
    return (
        dataset["separation"].to_numpy(),
        dataset["lever_arm"].to_numpy(),
        dataset["torque"].to_numpy(),
        compliance if structured else compliance[0],
    )
