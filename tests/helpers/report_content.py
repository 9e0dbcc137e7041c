"""What tests of the report share: a pair at few mesh positions, and the data of a page as the page reads them."""

from __future__ import annotations

import base64
import functools
import json
import re
import sys
from collections.abc import Mapping
from typing import Any

import numpy as np
import pytest
import xarray as xr
from numpy.typing import NDArray
from runs import small

from easeoff import analyze
from easeoff.cases import Case, LoadCase
from easeoff.study import WearLaw, analyze_load_cases, vh_check, wear


def coarse(**changes: int) -> Case:
    """The pair 11 x 41 at few mesh positions, with teeth as shells."""
    size: dict[str, Any] = {"mesh_positions": 8, "segments_per_line": 15, "lengthwise_nodes": 21, "profile_nodes": 15}
    return small("fm-11x41", "shell", **(size | changes))


@functools.cache
def strength_result() -> xr.DataTree:
    """With friction and root stress."""
    case = coarse(mesh_positions=4, segments_per_line=9)
    model = case.compliance.model_copy(update={"model": "fe", "fineness": 0.2})
    return analyze(case.model_copy(update={"compliance": model}), torques=[40.0, 400.0], speed=[1000.0, 3000.0])


@functools.cache
def supported_result() -> xr.DataTree:
    """On shafts and bearings, with torques that do not rise."""
    return analyze(coarse(mesh_positions=4), torques=[200.0, 50.0], supports="axle-fm-11x41")


@functools.cache
def duty_result() -> xr.DataTree:
    """Of two load cases with shares and speeds."""
    rows = [
        LoadCase(name="cruise", torque=50.0, speed=2000.0, share=0.8),
        LoadCase(name="climb", torque=250.0, speed=1000.0, share=0.2, E=0.05, Sigma=0.03),
    ]
    return analyze_load_cases(small("fm-11x41", "shell"), rows)


@functools.cache
def checked_pattern() -> xr.Dataset:
    """A V-H check with a grid, whose patterns are centred to a twentieth of the face."""
    with pytest.MonkeyPatch.context() as patch:
        for name in ("CENTRE_TOLERANCE", "ESTIMATE_TOLERANCE"):
            patch.setattr(sys.modules[vh_check.__module__], name, 0.05)
        return vh_check(coarse(mesh_positions=4, lengthwise_nodes=11, profile_nodes=7), grid=(3, 2))


@functools.cache
def worn_flanks() -> xr.Dataset:
    """Wear of both members."""
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
