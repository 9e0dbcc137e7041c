"""Small vector operations on arrays whose first axis holds the three components."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

Array = NDArray[Any]


def dot(a: Array, b: Array) -> Array:
    """Scalar product of (3, ...) and (3, ...)."""
    return np.asarray(a[0] * b[0] + a[1] * b[1] + a[2] * b[2])


def cross(a: Array, b: Array) -> Array:
    """Vector product of (3, ...) and (3, ...)."""
    return np.stack([a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]])


def column(vector: Array, like: Array) -> Array:
    """One vector (3) shaped to broadcast against an array (3, ...)."""
    return np.asarray(vector).reshape((3,) + (1,) * (like.ndim - 1))


def rotate(axis: Array, angle: Array, vector: Array) -> Array:
    """Rotate vectors (3, ...) about a unit axis (3) by angles (...) [rad] (Rodrigues)."""
    unit = column(axis, vector)
    along = dot(unit, vector)
    cosine, sine = np.cos(angle), np.sin(angle)
    return np.asarray(vector * cosine + cross(np.broadcast_to(unit, vector.shape), vector) * sine
                      + unit * (along * (1.0 - cosine)))
