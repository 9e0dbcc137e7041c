"""Stored status: how a computation ended, as an integer in results."""

from __future__ import annotations

from enum import EnumMeta, IntEnum
from typing import Any

from .attributes import flag_attributes
from .checks import shown
from .errors import InputError


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
    """Status stored in results as an integer; a subclass names the integers.

    It prints as its name; arrays and files hold the integer.
    """

    def __str__(self) -> str:
        return self.name

    def __format__(self, spec: str) -> str:
        return format(int(self), spec) if spec else self.name

    @classmethod
    def flag_attributes(cls) -> dict[str, Any]:
        """CF attributes ``flag_values`` and ``flag_meanings`` of a variable with this status."""
        return flag_attributes({int(status): status.name for status in cls})
