"""Charts of the report's page: curves of a result, numbers over torque, and the map of efficiencies.

Arrays as text for the report's page: numbers of 16 or 32 bits in base64.
"""

from __future__ import annotations

import base64
from typing import Any

import numpy as np
import xarray as xr
from numpy.typing import ArrayLike

from ...core.arrays import Array
from ..plot.panel_grid import middle
from ..summary.curves import CYCLE, Chart, capital
from ..summary.plausibility import TOLD_SHARE
from ..summary.quantities import FRICTION, LOADED, value_name

#: Numbers of the loaded contact that results are compared by over torque.
OVER_TORQUE = ("peak_to_peak", "max_pressure", "contact_ratio", "mean_mesh_stiffness")


def packed_chart(chart: Chart) -> dict[str, Any]:
    """Chart for the page, without curves that have no finite value."""
    kind, member = chart.kind, chart.member
    curves = [
        {"name": one.name, "x": packed_exactly(one.x), "y": packed_exactly(one.y), "number": number}
        for number, one in enumerate(chart.curves)
        if np.any(np.isfinite(one.y))
    ]
    further = {"per": chart.per, "second": chart.second}
    return {
        "id": f"{chart.name}_{member}" if member else chart.name,
        "title": f"{kind.title}, {member}" if member else kind.title,
        "x": chart.abscissa or kind.x,
        "y": kind.y,
        "source": kind.source,
        "series": curves,
        "by": kind.by,
        "cycle": kind.x == CYCLE,
        **{name: value for name, value in further.items() if value is not None},
    }


def over_torque(tree: xr.DataTree) -> dict[str, Any]:
    """Courses of the main numbers over torque, by name; efficiency at the middle speed, temperature and roughness."""
    groups = {name: tree[name].to_dataset() for name in ("loaded", "friction") if name in tree.children}
    courses = {}
    for group, variable, quantity in (
        *(("loaded", name, LOADED[name]) for name in OVER_TORQUE),
        ("friction", "efficiency", FRICTION["efficiency"]),
    ):
        if group not in groups or variable not in groups[group]:
            continue
        values = groups[group][variable].sortby("torque")
        conditions = []
        for name in map(str, values.dims):
            if name != "torque":
                number = middle(values[name].values)
                values = values.isel({name: number})
                conditions += [value_name(groups[group], name, number)]
        if np.any(np.isfinite(values.values)):
            courses[variable] = {
                "title": capital(quantity) + "," * ("," in quantity.label),
                "at": ", ".join(conditions),
                "unit": quantity.unit,
                "source": f"{group}/{variable}",
                "x": packed_exactly(values["torque"].values),
                "y": packed_exactly(quantity.factor * values.values),
            }
    return courses


def efficiency_map(friction: xr.Dataset, at: dict[str, int]) -> dict[str, Any] | None:
    """Efficiency [%] over torque and speed, and the share of the loss beyond the formula; ``None`` unless several."""
    if min(friction.sizes["torque"], friction.sizes["speed"]) < 2:
        return None
    subset = friction.isel(temperature=at["temperature"], roughness=at["roughness"])
    subset = subset.sortby("torque").sortby("speed")
    outside = (
        subset["extrapolated_share"].transpose("torque", "speed").values if "extrapolated_share" in subset else None
    )
    return {
        "torques": subset["torque"].values.tolist(),
        "speeds": subset["speed"].values.tolist(),
        "values": packed_exactly(100.0 * subset["efficiency"].transpose("torque", "speed").values),
        "outside": None if outside is None else packed_exactly(outside),
        "told": TOLD_SHARE,
    }


STEP_COUNT = 65534  # of 16 bits between the least and the greatest value; the code after the last one is NaN


def packed(values: ArrayLike) -> dict[str, Any]:
    """Array in 16 bits: rounded to 1/131068 of the distance from its least to its greatest value; NaN is kept."""
    array = np.asarray(values, dtype=float)
    finite = np.isfinite(array)
    low, high = (float(np.min(array[finite])), float(np.max(array[finite]))) if np.any(finite) else (0.0, 0.0)
    step = (high - low) / STEP_COUNT
    codes = np.full(array.shape, STEP_COUNT + 1)
    codes[finite] = np.rint((array[finite] - low) / (step or 1.0)).astype(int)
    return {"shape": list(array.shape), "low": low, "step": step, "data": _text(codes.astype("<u2"))}


def packed_exactly(values: ArrayLike) -> dict[str, Any]:
    """Array in single precision, seven digits."""
    array = np.asarray(values, dtype="<f4")
    return {"shape": list(array.shape), "data": _text(array)}


def _text(array: Array) -> str:
    return base64.b64encode(np.ascontiguousarray(array).tobytes()).decode("ascii")
