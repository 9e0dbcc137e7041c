"""Arrays as text for the report's page: numbers of 16 or 32 bits in base64."""

from __future__ import annotations

import base64
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from ...core.arrays import Array

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
