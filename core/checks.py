"""Checks of what a user gives: one wording, with the argument's name, its value and what is allowed."""

from __future__ import annotations

import math
import operator
from numbers import Real
from typing import Any

import numpy as np
from numpy.typing import NDArray

from .errors import InputError


def number(name: str, value: Any, unit: str) -> float:
    """Return a finite number.

    Raises
    ------
    InputError
        It is none; a truth value, a text or an array is none either. The same goes for the other checks.
    """
    if not (_is_number(value) and math.isfinite(value)):
        raise InputError(f"{name} must be a finite number [{unit}], not {value!r}")
    return float(value)


def positive(name: str, value: Any, unit: str, *, zero: bool = False, infinite: bool = False) -> float:
    """Return a positive number; `zero` and `infinite` allow these as well."""
    valid = _is_number(value) and (value > 0.0 or (zero and value == 0.0))
    if not valid or (math.isinf(value) and not infinite):
        raise InputError(f"{name} must be {'zero or ' if zero else ''}positive [{unit}], not {value!r}")
    return float(value)


def within(name: str, value: Any, low: float, high: float, unit: str) -> float:
    """Return a number from `low` to `high`."""
    if not (_is_number(value) and low <= value <= high):
        raise InputError(f"{name} must be within [{low:g}, {high:g}] [{unit}], not {value!r}")
    return float(value)


def above(name: str, value: Any, low: float, unit: str) -> float:
    """Return a finite number above `low`."""
    if not (_is_number(value) and value > low and math.isfinite(value)):
        raise InputError(f"{name} must be finite and above {low:g} [{unit}], not {value!r}")
    return float(value)


def whole(name: str, value: Any, least: int, most: int | None = None) -> int:
    """Return a whole number from `least` to `most`."""
    try:
        counted = None if isinstance(value, bool) else operator.index(value)
    except TypeError:
        counted = None
    if counted is None or counted < least or (most is not None and counted > most):
        allowed = f"of {least} at least" if most is None else f"from {least} to {most}"
        raise InputError(f"{name} must be a whole number {allowed}, not {value!r}")
    return counted


def truth(name: str, value: Any) -> bool:
    """Return True or False."""
    if not isinstance(value, bool):
        raise InputError(f"{name} must be True or False, not {value!r}")
    return value


def one_of(name: str, value: Any, allowed: tuple[str, ...]) -> None:
    """Refuse a word that is not known."""
    if not (isinstance(value, str) and value in allowed):
        raise InputError(f"{name} {value!r} is not known: give {' or '.join(map(repr, allowed))}")


def instance(name: str, value: Any, kind: type) -> None:
    """Refuse what is not of a kind."""
    if not isinstance(value, kind):
        raise InputError(f"{name} must be of the kind {kind.__name__}, not {value!r}")


def row(name: str, values: Any, unit: str, *, fewest: int = 1, size: int | None = None) -> NDArray[np.float64]:
    """Return finite numbers in a row: `fewest` at least, or exactly `size`."""
    try:
        array = np.asarray(values, dtype=np.float64)
    except (TypeError, ValueError) as error:
        raise InputError(f"{name} must be numbers in a row [{unit}], not {values!r}") from error
    if array.ndim != 1 or array.size < fewest or (size is not None and array.size != size):
        wanted = f"at least {fewest}" if size is None else str(size)
        raise InputError(f"{name} must be {wanted} numbers in a row [{unit}], not of the shape {array.shape}")
    if not np.isfinite(array).all():
        raise InputError(f"{name} must be finite numbers [{unit}]: {np.sum(~np.isfinite(array))} of them are not")
    return array


def _is_number(value: Any) -> bool:
    return isinstance(value, Real) and not isinstance(value, bool)
