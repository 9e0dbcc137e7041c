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


def cos_sin(angle: Array) -> tuple[Array, Array]:
    """Cosine and sine of angles (...) that are real, or carry a complex step.

    For a step of 1e-30 the first-order term is exact, and far cheaper than the complex functions.
    """
    if not np.iscomplexobj(angle):
        return np.cos(angle), np.sin(angle)
    cosine, sine = np.cos(angle.real), np.sin(angle.real)
    return cosine - 1j * (sine * angle.imag), sine + 1j * (cosine * angle.imag)


def rotate_z(angle: Array, vector: Array | tuple[Array, Array, Array]) -> Array:
    """Rotate vectors (3, ...) about the z axis by angles (...) [rad]."""
    cosine, sine = cos_sin(angle)
    x, y, z = vector
    return np.stack([cosine * x - sine * y, sine * x + cosine * y, z + np.zeros_like(cosine)])


def rotate(axis: Array, angle: Array, vector: Array) -> Array:
    """Rotate vectors (3, ...) about a unit axis (3) by angles (...) [rad] (Rodrigues)."""
    unit = column(axis, vector)
    cosine, sine = cos_sin(angle)
    return np.asarray(vector * cosine + cross(unit, vector) * sine + unit * (dot(unit, vector) * (1.0 - cosine)))
