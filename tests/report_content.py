"""What tests of the report share: a pair at few mesh positions, and the data of a page as the page reads them."""

from __future__ import annotations

import base64
import json
import re
from collections.abc import Mapping
from typing import Any

import numpy as np
from numpy.typing import NDArray

from easeoff import read_case
from easeoff.cases.changes import changed_case
from easeoff.cases.schema.case_schema import Case


def coarse(**changes: float) -> Case:
    """The pair 11 x 41 at few mesh positions."""
    size = {"mesh_positions": 8, "segments_per_line": 15, "lengthwise_nodes": 21, "profile_nodes": 15} | changes
    return changed_case(read_case("fm-11x41"), {f"contact.{key}": value for key, value in size.items()})


def content(page: str) -> Any:
    """Data of a page."""
    found = re.search(r'<script type="application/json" id="data">(.*?)</script>', page, re.DOTALL)
    assert found is not None
    return json.loads(found[1])


def unpacked(stored: Mapping[str, Any]) -> NDArray[Any]:
    """Array as the page reads it."""
    raw = base64.b64decode(stored["data"])
    if "step" not in stored:
        return np.frombuffer(raw, "<f4").reshape(stored["shape"])
    codes = np.frombuffer(raw, "<u2").astype(float).reshape(stored["shape"])
    return np.where(codes == 65535, np.nan, stored["low"] + stored["step"] * codes)
