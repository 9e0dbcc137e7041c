"""Checks of the data of a contact problem: each returns a read-only array ready for use, or says what is wrong."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from ...core.errors import InputError

#: Largest difference between C and its transpose, relative to the largest entry, that is taken for rounding.
ASYMMETRY_TOLERANCE = 1e-10


def finite_array(value: Any, name: str, ndim: int) -> NDArray[np.float64]:
    """Return a read-only float64 copy of a value with the given number of dimensions.

    Raises
    ------
    InputError
        It is no array of finite numbers of that shape; the message names it.
    """
    try:
        array = np.array(value, dtype=np.float64, order="C")
    except (TypeError, ValueError) as error:
        raise InputError(f"{name} is not an array of numbers: {error}") from error
    if array.ndim != ndim:
        raise InputError(f"{name} has {array.ndim} dimensions, expected {ndim}")
    if not np.isfinite(array).all():
        raise InputError(f"{name} has {np.count_nonzero(~np.isfinite(array))} entries that are not finite")
    return read_only(array)


def segment_array(value: Any, name: str, size: int) -> NDArray[np.float64]:
    """Return a finite array with one entry a segment; InputError otherwise."""
    array = finite_array(value, name, 1)
    if array.size != size:
        raise InputError(f"{name} has {array.size} segments, expected {size}")
    return array


def compliance_array(value: Any, name: str, size: int) -> NDArray[np.float64]:
    """Return a finite array with one entry a segment, none negative [mm/N]; InputError otherwise."""
    array = segment_array(value, name, size)
    if array.min() < 0.0:
        raise InputError(f"{name} has a negative entry ({array.min():g} mm/N)")
    return array


def nonnegative_torque(value: Any) -> float:
    """Return a finite torque that is not negative [N mm]; InputError otherwise."""
    torque = float(finite_array(value, "torque", 0))
    if torque < 0.0:
        raise InputError(
            f"torque is {torque:g} N mm: it must not be negative (for the other flank, reverse the lever arms)"
        )
    return torque


def symmetric_compliance(value: Any, size: int) -> NDArray[np.float64]:
    """Return a symmetric (n, n) matrix without negative diagonal; asymmetry of the size of rounding is averaged out.

    Raises
    ------
    InputError
        A wrong shape, a negative diagonal, or asymmetry beyond rounding.
    """
    compliance = finite_array(value, "compliance", 2)
    if compliance.shape != (size, size):
        raise InputError(f"compliance has the shape {compliance.shape}, expected ({size}, {size})")
    if compliance.diagonal().min() < 0.0:
        raise InputError(f"compliance has a negative diagonal entry ({compliance.diagonal().min():g} mm/N)")
    if np.array_equal(compliance, compliance.T):
        return compliance
    asymmetry = float(np.abs(compliance - compliance.T).max()) / float(np.abs(compliance).max())
    if asymmetry > ASYMMETRY_TOLERANCE:
        raise InputError(
            f"compliance is not symmetric (relative difference {asymmetry:.1e}): by reciprocity it must be, "
            "and a solver would read one triangle or the other"
        )
    return read_only(0.5 * (compliance + compliance.T))


def read_only(array: NDArray[np.float64]) -> NDArray[np.float64]:
    """Forbid writing to an array and return it."""
    array.setflags(write=False)
    return array
