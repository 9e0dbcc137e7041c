"""Case of a result, from the text that the result keeps."""

from __future__ import annotations

import tomllib
from typing import Any

import xarray as xr

from ...cases.reading import CASE
from ...cases.schema.case_schema import Case
from ...core.errors import EaseoffError

#: Tables that may name other files, which a report does not open.
LEFT_OUT = ("friction", "load_cases")


def stored_case(tree: xr.DataTree) -> Case | None:
    """Case of a result without some of its tables; ``None`` if the result keeps none that can be read."""
    text = str(tree.attrs.get("case", ""))
    try:
        data: dict[str, Any] = tomllib.loads(text)
        return CASE.check({key: value for key, value in data.items() if key not in LEFT_OUT}, "the case")
    except (ValueError, EaseoffError, AttributeError):
        return None
