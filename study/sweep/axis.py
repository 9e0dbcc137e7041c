"""Axes of a sweep: a coordinate over its values, or coordinates that go together, as of samples and load cases."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ...core.checks import frozen_arrays, shown
from ...core.errors import InputError
from .distribution import Distribution
from .swept_quantity import Stage, SweptQuantity, swept_quantity

VALUE_COUNT_LIMIT = 10_000_000
DIGIT_COUNT = 14  # of the greatest value of an even grid


@frozen_arrays
@dataclass(frozen=True)
class Axis:
    """A dimension of a sweep with its coordinates.

    Parameters
    ----------
    name
        Name of the dimension: that of its coordinate, ``sample`` or ``load_case``.
    columns
        Values (n) of every coordinate: numbers, or words.

    Examples
    --------
    >>> axis = grid_axis("E", "-0.1:0.1:3")
    >>> axis.name, axis.columns["E"].tolist()
    ('E', [-0.1, 0.0, 0.1])
    """

    name: str
    columns: Mapping[str, NDArray[Any]]

    @property
    def size(self) -> int:
        """Number of points along the axis."""
        return next(iter(self.columns.values())).size


def is_distribution(values: Any) -> bool:
    """Whether the values of a coordinate are a distribution, or the text of one."""
    return isinstance(values, Distribution) or (isinstance(values, str) and "(" in values)


def column(quantity: SweptQuantity, values: Sequence[Any] | NDArray[Any]) -> NDArray[Any]:
    """Values of a quantity as an array.

    Raises
    ------
    InputError
        If there are none, too many, or one is not possible.
    """
    if not 1 <= len(values) <= VALUE_COUNT_LIMIT:
        raise InputError(f"{quantity.name}: must have from 1 to {VALUE_COUNT_LIMIT} values, has {len(values)}")
    return np.array([quantity.checked(value) for value in values])


def grid_axis(name: str, values: Any) -> Axis:
    """Axis of one coordinate.

    Parameters
    ----------
    name
        As of ``swept_quantity``.
    values
        Numbers or words in a row; or a text: FROM:TO:COUNT, evenly spaced, or values separated by commas.

    Raises
    ------
    InputError
        If there is no such quantity, a value is not possible or comes twice.

    Examples
    --------
    >>> grid_axis("torque", "50,100,200").columns["torque"].tolist()
    [50.0, 100.0, 200.0]
    """
    quantity = swept_quantity(name)
    if quantity.stage == Stage.NOTHING:
        raise InputError(f"{name}: is a column of load cases and cannot be swept")
    listed = _listed(quantity, values) if isinstance(values, str) else np.atleast_1d(np.asarray(values, dtype=object))
    if np.ndim(listed) != 1:
        raise InputError(f"{name} = {shown(values)}: must be values in a row")
    found = column(quantity, listed)
    different, counts = np.unique(found, return_counts=True)
    if different.size != found.size:
        raise InputError(f"{name}: {shown(different[counts > 1][0].item())} comes twice")
    return Axis(name, {name: found})


def _listed(quantity: SweptQuantity, text: str) -> Sequence[Any]:
    """Values of a text."""
    parts = [part.strip() for part in text.split(",")]
    if quantity.words:
        return parts
    if ":" in text:
        wanted = "FROM:TO:COUNT, such as -0.1:0.1:9"
        try:
            first, last, count = text.split(":")
            start, stop, steps = float(first), float(last), int(count)
        except ValueError:
            raise InputError(f"{quantity.name} = {shown(text)}: must be {wanted}") from None
        if not 2 <= steps <= VALUE_COUNT_LIMIT:
            raise InputError(f"{quantity.name} = {shown(text)}: COUNT must lie between 2 and {VALUE_COUNT_LIMIT}")
        for end in (start, stop):
            quantity.checked(end)
        # Decimal numbers as they would be typed: -0.2:0.2:9 has 0.05 in it, not 0.05000000000000002.
        digits = DIGIT_COUNT - math.ceil(math.log10(max(abs(start), abs(stop), 1e-300)))
        return [round(value, digits) for value in np.linspace(start, stop, steps).tolist()]
    try:
        return [float(part) for part in parts]
    except ValueError:
        raise InputError(
            f"{quantity.name} = {shown(text)}: must be numbers separated by commas, FROM:TO:COUNT, or a distribution "
            "such as normal(0,0.03)"
        ) from None
