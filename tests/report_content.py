"""What tests of the report share: a pair at few mesh positions, and the data of a page as the page reads them."""

from __future__ import annotations

import base64
import functools
import json
import re
from collections.abc import Mapping
from typing import Any

import numpy as np
import xarray as xr
from numpy.typing import NDArray

from easeoff import analyze, read_case
from easeoff.cases import LoadCase
from easeoff.cases.changes import changed_case
from easeoff.cases.schema.case_schema import Case
from easeoff.core.compiled.compiled_use import without_compiled_code
from easeoff.study import WearLaw, analyze_load_cases, vh_check, wear


def coarse(**changes: float) -> Case:
    """The pair 11 x 41 at few mesh positions."""
    size = {"mesh_positions": 8, "segments_per_line": 15, "lengthwise_nodes": 21, "profile_nodes": 15} | changes
    return changed_case(read_case("fm-11x41"), {f"contact.{key}": value for key, value in size.items()})


@functools.cache
def strength_result() -> xr.DataTree:
    """With friction and root stress."""
    case = coarse(mesh_positions=4, segments_per_line=9)
    model = case.compliance.model_copy(update={"model": "fe", "fineness": 0.2})
    with without_compiled_code():
        return analyze(case.model_copy(update={"compliance": model}), torques=[40.0, 400.0], speed=[1000.0, 3000.0])


@functools.cache
def supported_result() -> xr.DataTree:
    """On shafts and bearings, with torques that do not rise."""
    with without_compiled_code():
        return analyze(coarse(mesh_positions=4), torques=[200.0, 50.0], supports="axle-fm-11x41")


@functools.cache
def duty_result() -> xr.DataTree:
    """Of two load cases with shares and speeds."""
    size = {"mesh_positions": 3, "segments_per_line": 9, "lengthwise_nodes": 9, "profile_nodes": 7}
    rows = [
        LoadCase(name="cruise", torque=50.0, speed=2000.0, share=0.8),
        LoadCase(name="climb", torque=250.0, speed=1000.0, share=0.2, E=0.05, Sigma=0.03),
    ]
    with without_compiled_code():
        return analyze_load_cases(coarse(**size), rows)


@functools.cache
def checked_pattern() -> xr.Dataset:
    """A V-H check with a grid."""
    with without_compiled_code():
        return vh_check(coarse(lengthwise_nodes=11, profile_nodes=7), grid=(3, 2))


@functools.cache
def worn_flanks() -> xr.Dataset:
    """Wear of both members."""
    with without_compiled_code():
        return wear(coarse(), WearLaw(1e-11, 1e-11, revolutions=1e5), torque=100.0)


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
