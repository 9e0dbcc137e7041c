"""Arrays: their types in annotations, and records that hold them read-only."""

from __future__ import annotations

from dataclasses import dataclass, fields
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from .checks import frozen_arrays

if TYPE_CHECKING:
    from collections.abc import Callable
    from dataclasses import dataclass as record
else:

    def record(**options: Any) -> Callable[[type], type]:
        """Class decorator: a dataclass by its options, whose arrays are read-only as by ``frozen_arrays``."""
        return lambda made: frozen_arrays(dataclass(**options)(made))


__all__ = ["Array", "Bools", "Integers", "RealArray", "record", "shared_fields"]


def shared_fields(kind: type[Any], *records: Any) -> dict[str, Any]:
    """Values of those fields of a dataclass that records have under the same name."""
    return {one.name: getattr(each, one.name) for each in records for one in fields(kind) if hasattr(each, one.name)}


#: Of any numbers.
Array = NDArray[Any]
RealArray = NDArray[np.float64]
Bools = NDArray[np.bool_]
Integers = NDArray[np.int64]
