"""Stored status: how a computation ended, as an integer in results."""

from __future__ import annotations

from enum import IntEnum
from typing import Any

from .attributes import flag_attributes


class StoredStatus(IntEnum):
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
