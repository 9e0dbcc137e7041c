"""Small vector operations on arrays whose first axis holds the three components."""

from __future__ import annotations

import numpy as np

from ..core.arrays import Array

_NEXT, _LAST = np.array([1, 2, 0]), np.array([2, 0, 1])


def dot(a: Array, b: Array) -> Array:
    """Scalar product of (3, ...) and (3, ...)."""
    return np.asarray(a[0] * b[0] + a[1] * b[1] + a[2] * b[2])


def cross(a: Array, b: Array) -> Array:
    """Vector product of (3, ...) and (3, ...)."""
    return np.asarray(a.take(_NEXT, 0) * b.take(_LAST, 0) - a.take(_LAST, 0) * b.take(_NEXT, 0))


def column(vector: Array, like: Array) -> Array:
    """One vector (3) shaped to broadcast against an array (3, ...)."""
    return np.asarray(vector).reshape((3,) + (1,) * (like.ndim - 1))


def cos_sin(angle: Array) -> tuple[Array, Array]:
    """Cosine and sine of angles (...) that are real or carry a complex step.

    For a step of 1e-30 the first-order term is exact, and far cheaper than the complex functions.
    """
    if not np.iscomplexobj(angle):
        return np.cos(angle), np.sin(angle)
    cosine, sine = np.cos(angle.real), np.sin(angle.real)
    results = np.empty((2, *np.shape(angle)), dtype=complex)
    results.real[0], results.real[1] = cosine, sine
    results.imag[0], results.imag[1] = -sine * angle.imag, cosine * angle.imag
    return results[0], results[1]


def rotate_z(angle: Array, vector: Array | tuple[Array, Array, Array]) -> Array:
    """Rotate vectors (3, ...) about the z axis by angles (...) [rad]."""
    return turn_z(*cos_sin(angle), vector)


def turn_z(cosine: Array, sine: Array, vector: Array | tuple[Array, Array, Array]) -> Array:
    """Rotate vectors (3, ...) about the z axis by angles of given cosine and sine (...)."""
    x, y, z = vector
    first = np.asarray(cosine * x - sine * y)
    result = np.empty((3, *first.shape), dtype=np.result_type(first, z))
    result[0], result[2] = first, z
    np.add(sine * x, cosine * y, out=result[1])
    return result


def rotate(axis: Array, angle: Array, vector: Array) -> Array:
    """Rotate vectors (3, ...) about a unit axis (3) by angles (...) [rad] (Rodrigues)."""
    unit = column(axis, vector)
    cosine, sine = cos_sin(angle)
    return np.asarray(vector * cosine + cross(unit, vector) * sine + unit * (dot(unit, vector) * (1.0 - cosine)))
