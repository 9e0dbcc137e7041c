"""What is the same at every point of a sweep: the case, its loads and conditions, and the options of the analysis."""

from __future__ import annotations

import hashlib
import json
import os
from collections.abc import Mapping
from dataclasses import dataclass, field, fields
from importlib.metadata import version
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
import xarray as xr

from ...cases.deflections import Deflections
from ...cases.schema.case_schema import Case
from ...geometry.deviation.deviation import Deviation, Method
from ...geometry.pair.assembly import Misalignment
from ...geometry.pair.gear_pair import FlankName
from ...geometry.pair.modification import Modification
from ..deviations.deviation_source import Deviated, Source

if TYPE_CHECKING:
    from ...friction import FrictionModel


@dataclass(frozen=True, eq=False)
class SweepSetup:
    """What is the same at every point of a sweep; two are equal if their digests are.

    Parameters
    ----------
    case
        The checked case.
    torques
        Torques of every analysis [N m]; none where each row has its own.
    conditions
        Operating conditions of every analysis, arguments of ``friction.Operation``.
    flank, misalignment, deviations, deviated, interpolation, modification, edge_contact, marking, solver
        As of ``analyze``.
    friction_model, friction_feedback
        As of ``analyze``.
    digest
        Digest of all this; made from it.

    Examples
    --------
    >>> from easeoff.cases import read_case
    >>> SweepSetup(read_case("nasa-12x36"), (100.0,)) == SweepSetup(read_case("nasa-12x36"), (200.0,))
    False
    """

    case: Case
    torques: tuple[float, ...] | None
    conditions: Mapping[str, Any] = field(default_factory=dict)
    flank: FlankName = "drive"
    misalignment: Misalignment | Deflections | None = None
    deviations: Mapping[str, Source] = field(default_factory=dict)
    deviated: Deviated = "ease_off"
    interpolation: Method = "spline"
    modification: Modification | None = None
    edge_contact: bool | None = None
    marking: float | None = None
    solver: str = "auto"
    friction_model: FrictionModel | None = None
    friction_feedback: bool | None = None
    digest: str = ""

    def __post_init__(self) -> None:
        if not self.digest:
            known = {one.name: _stable(getattr(self, one.name)) for one in fields(self) if one.name != "digest"}
            known["easeoff"] = version("easeoff")
            text = json.dumps(known, sort_keys=True)
            object.__setattr__(self, "digest", hashlib.sha256(text.encode()).hexdigest())

    def __hash__(self) -> int:
        return hash(self.digest)

    def __eq__(self, other: object) -> bool:
        return isinstance(other, SweepSetup) and self.digest == other.digest


def _stable(value: Any) -> Any:
    """What a digest is made of, alike in every process."""
    if isinstance(value, Case):
        return value.model_dump_json()
    if isinstance(value, np.ndarray):
        return [str(value.dtype), list(value.shape), hashlib.sha256(np.ascontiguousarray(value).tobytes()).hexdigest()]
    if isinstance(value, xr.Dataset):
        return {str(name): _stable(variable.values) for name, variable in value.variables.items()}
    if isinstance(value, Deviation):
        return {one.name: _stable(getattr(value, one.name)) for one in fields(value)}
    if isinstance(value, Mapping):
        return {str(name): _stable(item) for name, item in value.items()}
    if isinstance(value, list | tuple):
        return [_stable(item) for item in value]
    if isinstance(value, str | Path):
        return [str(value), file_digest(str(value))]
    return repr(value)


def file_digest(name: str) -> str:
    """Digest of the content of a file; empty if there is none of that name, or a device or a pipe."""
    if not os.path.isfile(name):
        return ""
    try:
        with open(name, "rb") as file:
            return hashlib.file_digest(file, "sha256").hexdigest()
    except OSError:
        return ""
