"""How computations end, as it is stored in results."""

from __future__ import annotations

from enum import IntEnum
from typing import Any

from .attributes import flag_attributes


class StoredStatus(IntEnum):
    """A status whose number is stored in results; a subclass says what the numbers mean."""

    @classmethod
    def flag_attributes(cls) -> dict[str, Any]:
        """Return the attributes `flag_values` and `flag_meanings` of a stored status variable (CF conventions)."""
        return flag_attributes({int(status): status.name for status in cls})
