"""Attributes of variables: units, long names and comments of everything that leaves the package.

A status, how a computation ended, is stored as an integer; values of a variable are read with dimensions in a given
order.
"""

from __future__ import annotations

import tomllib
from collections.abc import Mapping, Sequence
from enum import EnumMeta, IntEnum
from functools import cache
from importlib import resources
from types import MappingProxyType
from typing import Any

import numpy as np
import xarray as xr
from numpy.typing import NDArray

from .checks import shown
from .errors import EaseoffError, InputError

#: Of root stresses: 6 to 7 % on shipped pairs, 17 % at the gear of a 20x45 pair.
ROOT_RESOLUTION = "6 to 17 % below that of a lattice twice as fine"


@cache
def variables() -> Mapping[str, Sequence[str]]:
    """Units and long name of each variable, and where it needs one a comment that defines it."""
    text = resources.files(__package__).joinpath("variables.toml").read_text(encoding="utf-8")
    return MappingProxyType(tomllib.loads(text))


#: States of the contact that may stand before the name of a variable.
STATES: Mapping[str, str] = {"unloaded_": "without load", "light_load_": "at light load", "grid_": "in the grid"}


def labelled(dataset: xr.Dataset) -> xr.Dataset:
    """A copy with ``units``, ``long_name`` and ``comment`` on every variable; those that are there are kept."""
    result = dataset.copy()
    for name, variable in result.variables.items():
        variable.attrs = {**variable_attributes(str(name)), **variable.attrs}
    return result


def variable_attributes(name: str) -> dict[str, Any]:
    """``long_name``, ``units`` and ``comment`` of a variable; ``unloaded_`` or ``light_load_`` tells the contact."""
    for state, words in STATES.items():
        if name not in variables() and name.startswith(state):
            of_any = variable_attributes(name.removeprefix(state))
            return {**of_any, "long_name": f"{words}: {of_any['long_name']}"}
    if name not in variables():
        raise EaseoffError(f"variable = {name!r}: must have a row in the table of attributes")
    units, *words_of_it = variables()[name]
    attributes = dict(zip(("long_name", "comment"), words_of_it, strict=False))
    return {**attributes, "units": units} if units else attributes


def units_of(name: str) -> str | None:
    """Units of a variable of numbers; ``None`` where it is a text or a flag, or not in the table."""
    try:
        units: str | None = variable_attributes(name).get("units")
    except EaseoffError:
        return None
    return units


def flag_attributes(meanings: Mapping[int, str]) -> dict[str, Any]:
    """CF attributes ``flag_values`` and ``flag_meanings`` of an integer status variable."""
    return {
        "flag_values": np.array(list(meanings), dtype=np.int8),
        "flag_meanings": " ".join(name.lower() for name in meanings.values()),
    }


class _Asked(EnumMeta):
    """Class of statuses: what is none of them is an ``InputError``."""

    def __call__(cls, value: Any, *names: Any, **options: Any) -> Any:
        """The status of a number."""
        try:
            return super().__call__(value, *names, **options)
        except ValueError as error:
            known = ", ".join(f"{int(one)} ({one.name})" for one in cls)  # type: ignore[var-annotated]
            raise InputError(f"{cls.__name__} = {shown(value)}: must be one of {known}") from error


class StoredStatus(IntEnum, metaclass=_Asked):
    """Status that prints as its name; arrays and files hold the integer."""

    def __str__(self) -> str:
        return self.name

    def __format__(self, spec: str) -> str:
        return format(int(self), spec) if spec else self.name

    @classmethod
    def flag_attributes(cls) -> dict[str, Any]:
        """CF attributes ``flag_values`` and ``flag_meanings`` of a variable with this status."""
        return flag_attributes({int(status): status.name for status in cls})


def ordered(dataset: xr.Dataset, name: str, *dimensions: str) -> NDArray[Any]:
    """Values of a variable by all of its dimensions in the wanted order, read fast, without coordinates."""
    variable = dataset.variables[name]
    if variable.dims != dimensions:
        variable = variable.transpose(*dimensions)
    return np.asarray(variable.values)
