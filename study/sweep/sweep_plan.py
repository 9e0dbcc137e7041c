"""Plan of a sweep: its points, what is the same at all of them, and how the samples were drawn.

What is the same at every point of a sweep: the case, its loads and conditions, and the options of the analysis.

Points of a sweep as a table of rows, in the order in which the least is computed anew from one to the next.
"""

from __future__ import annotations

import hashlib
import json
import math
import os
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, fields, replace
from functools import cached_property
from importlib.metadata import version
from pathlib import Path
from typing import Any

import numpy as np
import xarray as xr

from ...cases.analysis_size import AnalysisSize
from ...cases.schema.case_schema import Case
from ...cases.shipped_files import shipped_deviations
from ...contact.solvers import require_solver
from ...core.arrays import Array
from ...core.checks import instance, shown
from ...core.errors import InputError
from ...core.memory import require_memory
from ...core.regular_file import require_file
from ...friction.lubricants.lubricant import lubricant
from ...geometry.deviation.deviation import Deviation
from ..analysis.contact_analysis import case_torques
from ..analysis.operating import Friction, FrictionConditions, Operating, analysis_size
from ..analysis.swept_quantity import CONDITIONS, Stage, swept_quantity
from ..case_in_mesh import FlanksInMesh, checked_case, prepared_pair
from ..deviation_source import flank_deviations
from .axis import (
    Axis,
    Distribution,
    Sampler,
    grid_axis,
    is_distribution,
    load_case_axis,
    read_load_case_axis,
    sample_values,
)


@dataclass(frozen=True, eq=False)
class SweepSetup:
    """Case and arguments of ``analyze`` that are the same at every point of a sweep; equal if the digests are."""

    case: Case
    operating: Operating
    torques: tuple[float, ...] | None  # of every analysis [N m]; None where each row has its own
    digest: str = ""

    def __post_init__(self) -> None:
        if not self.digest:
            known = {one.name: _stable(getattr(self, one.name)) for one in fields(self) if one.name != "digest"}
            known["easeoff"] = version("easeoff")
            text = json.dumps(known, sort_keys=True)
            object.__setattr__(self, "digest", hashlib.sha256(text.encode()).hexdigest())

    @property
    def loads(self) -> tuple[int, ...]:
        """Shape of the loads of one analysis: the number of its torques, or nothing where each row has its own."""
        return () if self.torques is None else (len(self.torques),)

    def friction(self, values: Mapping[str, Any]) -> Friction | None:
        """Friction at a point with these values of its coordinates."""
        conditions = {name: values[name] for name in (*CONDITIONS, "oil") if name in values}
        return replace(self.operating.friction, **conditions).of_case(self.case)

    def __hash__(self) -> int:
        return hash(self.digest)

    def __eq__(self, other: object) -> bool:
        return isinstance(other, SweepSetup) and self.digest == other.digest


def _stable(value: Any) -> Any:
    """Value as a digest takes it, alike in every process."""
    if isinstance(value, Case):
        return value.model_dump_json()
    if isinstance(value, np.ndarray):
        return [str(value.dtype), list(value.shape), hashlib.sha256(np.ascontiguousarray(value).tobytes()).hexdigest()]
    if isinstance(value, xr.Dataset):
        return {str(name): _stable(variable.values) for name, variable in value.variables.items()}
    if isinstance(value, Deviation | Operating | FlanksInMesh | FrictionConditions):
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


@dataclass(frozen=True)
class PointTable:
    """Rows of a sweep: every combination of the points along its axes, without those inside one analysis."""

    axes: tuple[Axis, ...]

    @property
    def shape(self) -> tuple[int, ...]:
        """Numbers of points along the axes."""
        return tuple(axis.size for axis in self.axes)

    @property
    def count(self) -> int:
        """Number of rows."""
        return int(np.prod(self.shape, dtype=np.int64))

    @property
    def names(self) -> tuple[str, ...]:
        """Names of the coordinates of a row."""
        return tuple(name for axis in self.axes for name in axis.columns)

    def columns(self, rows: Array) -> dict[str, Array]:
        """Values of every coordinate in some rows."""
        places = np.unravel_index(rows, self.shape) if self.axes else ()
        return {
            name: values[place]
            for axis, place in zip(self.axes, places, strict=True)
            for name, values in axis.columns.items()
        }

    def values(self, row: int) -> dict[str, Any]:
        """Values of every coordinate in one row."""
        return {name: column[0].item() for name, column in self.columns(np.array([row])).items()}

    @cached_property
    def order(self) -> Array:
        """Rows in the order of the work: those of one pair together, within them those of one assembly."""
        codes = self._codes
        return np.lexsort([codes[name] for name in reversed(self._by_stage)]) if codes else np.arange(self.count)

    @cached_property
    def starts(self) -> Array:
        """Places in the order of the work at which another assembly begins."""
        return _beginnings({name: codes[self.order] for name, codes in self._codes.items()}, self.count)

    def bound(self, first: int, size: int) -> int:
        """End of a batch of about ``size`` rows from ``first`` on: between assemblies where possible."""
        wanted = first + max(size, 1)
        if wanted >= self.count:
            return self.count
        whole = int(self.starts[np.searchsorted(self.starts, wanted, side="right") - 1])
        return whole if whole > first else wanted

    @property
    def _by_stage(self) -> Sequence[str]:
        return sorted(self.names, key=lambda name: swept_quantity(name).stage)

    @cached_property
    def _codes(self) -> dict[str, Array]:
        """The value of every coordinate in every row as its number among those that there are."""
        places = np.unravel_index(np.arange(self.count), self.shape) if self.axes else ()
        return {
            name: np.unique(values, return_inverse=True)[1][place]
            for axis, place in zip(self.axes, places, strict=True)
            for name, values in axis.columns.items()
        }


def _beginnings(columns: Mapping[str, Array], count: int) -> Array:
    """Places among rows (count) at which another assembly begins, from 0 on."""
    changed = np.zeros(count, dtype=bool)
    changed[0] = True
    for name, values in columns.items():
        if swept_quantity(name).stage <= Stage.ASSEMBLY:
            changed[1:] |= values[1:] != values[:-1]
    return np.flatnonzero(changed)


def assemblies(columns: Mapping[str, Array], count: int) -> list[Array]:
    """Places of neighbouring rows that have the pair and the assembly in common."""
    return np.split(np.arange(count), _beginnings(columns, count)[1:])


SAMPLE = "sample"
POINT_NUMBERS = 60  # of an analysis at one load, without friction
CONDITION_NUMBERS = 16  # at one operating condition
NUMBER_SIZE = 24.0  # of a number with the copy that is written [byte]
REASON_SIZE = 500.0  # of a text at every point, as failures make it [byte]


@dataclass(frozen=True)
class SweepPlan:
    """Plan of a sweep."""

    setup: SweepSetup
    axes: tuple[Axis, ...]  # all in the order given, with those over which one analysis goes
    sampling: Mapping[str, Any]  # distributions, seed and sampler as attributes; empty without samples

    @property
    def table(self) -> PointTable:
        """Points that are analysed apart."""
        return _table(self.axes)

    @property
    def description(self) -> str:
        """The sweep in words: its case and the sizes of its axes."""
        sizes = [
            f"{axis.size} {axis.name}"
            if axis.name in axis.columns
            else f"{axis.size} {axis.name}s of {', '.join(axis.columns)}"
            for axis in self.axes
        ]
        return f"{self.setup.case.title}: {' x '.join(sizes)}"

    @property
    def digest(self) -> str:
        """Digest of everything that the numbers depend on."""
        digest = hashlib.sha256(self.setup.digest.encode())
        for axis in self.axes:
            for name, values in axis.columns.items():
                digest.update(f"{axis.name}/{name}/{values.dtype.kind}/{values.size}/".encode())
                digest.update(values.tobytes() if values.dtype.kind == "f" else "\0".join(values.tolist()).encode())
        return digest.hexdigest()

    @property
    def friction(self) -> Friction | None:
        """Friction of the first point."""
        return self.setup.friction(self.table.values(0))

    @property
    def size(self) -> AnalysisSize:
        """Size of the analysis at one point."""
        return analysis_size(self.setup.case, self.loads, self.friction)

    @property
    def loads(self) -> int:
        """Number of torques of the analysis at one point."""
        return math.prod(self.setup.loads)

    @property
    def points(self) -> int:
        """Number of points with a status: every torque of every analysis."""
        return self.table.count * self.loads

    def require_memory(self, processes: int) -> None:
        """Refuse a sweep that needs more memory than is free, with the numbers to lower."""
        size = self.size
        size.require_memory()
        conditions = size.speeds * size.temperatures * size.roughnesses
        each = self.loads * (NUMBER_SIZE * (POINT_NUMBERS + CONDITION_NUMBERS * conditions) + REASON_SIZE)
        needed = processes * size.memory + self.table.count * each
        require_memory(f"{self.table.count} points x {processes} workers", needed, "the sweep")


def planned_sweep(
    case: Case | str | Path,
    over: Mapping[str, Any] | None,
    operating: Operating,
    *,
    load_cases: str | Path | Mapping[str, Sequence[Any]] | None = None,
    samples: int | None = None,
    seed: int = 0,
    sampler: Sampler = "sobol",
    allow_outside: bool = False,
) -> SweepPlan:
    """Plan a sweep, as of ``sweep``; only with ``allow_outside`` may load cases name files outside their folder."""
    checked, given = checked_case(case), operating
    if not isinstance(given.solver, str):
        raise InputError(
            f"solver = {shown(given.solver)}: must be a name or MODULE:FUNCTION, which every process can find"
        )
    require_solver(given.solver)
    instance("over", over, Mapping | None)
    axes, sampling = _axes(over or {}, load_cases, samples, seed, sampler, allow_outside=allow_outside)
    single = {
        "torque": given.torques,
        **{one.name: getattr(given.friction, one.name) for one in fields(given.friction)},
    }
    single |= {f"deviation.{member}": source for member, source in (given.flanks.deviations or {}).items()}
    for name in (name for axis in axes for name in axis.columns):
        if single.get(name) is not None:
            raise InputError(f"{name} = {shown(single[name])}: must be left out, as {name} is swept")
    inner = {axis.name: axis.columns[axis.name].tolist() for axis in axes if _is_inner(axis)}
    table = _table(axes)
    torques = case_torques(checked, inner.pop("torque", given.torques))
    given = replace(given, torques=None, friction=replace(given.friction, **inner))
    setup = SweepSetup(checked, given, None if "torque" in table.names else tuple(torques.tolist()))
    _require_files(table)
    if "flank" not in table.names:
        pair = prepared_pair(checked, given.flanks.flank, given.flanks.misalignment)
        if not any(swept_quantity(name).stage == Stage.PAIR for name in table.names):
            # a mistake shows before the work
            flank_deviations(pair, given.flanks.deviations, given.flanks.interpolation)
    return SweepPlan(setup, tuple(axes), sampling)


def _require_files(table: PointTable) -> None:
    """Refuse names of oils and deviations that are none: mistakes that show before the work."""
    for axis in table.axes:
        for name, values in axis.columns.items():
            for value in np.unique(values).tolist() if swept_quantity(name).words else ():
                if name == "oil":
                    lubricant(value)
                elif name.startswith("deviation.") and value not in shipped_deviations():
                    require_file(value)


def _table(axes: Sequence[Axis]) -> PointTable:
    return PointTable(tuple(axis for axis in axes if not _is_inner(axis)))


def _axes(
    over: Mapping[str, Any],
    load_cases: str | Path | Mapping[str, Sequence[Any]] | None,
    count: int | None,
    seed: int,
    sampler: Sampler,
    *,
    allow_outside: bool,
) -> tuple[list[Axis], dict[str, Any]]:
    """Axes of a sweep in the order given, and how the samples were drawn."""
    distributions: dict[str, Distribution] = {}
    axes: list[Axis] = []
    for name, values in over.items():
        if not is_distribution(values):
            axes.append(grid_axis(name, values))
            continue
        if swept_quantity(name).words:
            raise InputError(f"{name}: must be given as a list; words have no distribution")
        distributions[name] = values if isinstance(values, Distribution) else Distribution.parsed(values)
        if len(distributions) == 1:
            axes.append(Axis(SAMPLE, {}))  # its place in the order
    sampling: dict[str, Any] = {}
    if distributions:
        if count is None:
            raise InputError(f"samples = None: must be given, as {', '.join(distributions)} have distributions")
        drawn = Axis(SAMPLE, sample_values(distributions, count, seed=seed, sampler=sampler))
        axes = [drawn if axis.name == SAMPLE else axis for axis in axes]
        texts = {name: distribution.text for name, distribution in distributions.items()}
        sampling = {"distributions": json.dumps(texts), "seed": seed, "sampler": sampler}
    elif count is not None:
        raise InputError(f"samples = {shown(count)}: must go with a distribution, such as E~normal(0,0.03)")
    if load_cases is not None:
        if isinstance(load_cases, Mapping):
            axes.append(load_case_axis(load_cases))
        else:
            axes.append(read_load_case_axis(load_cases, allow_outside=allow_outside))
    names = [name for axis in axes for name in axis.columns]
    for name in names:
        if names.count(name) > 1:
            raise InputError(f"{name}: is swept twice")
    if not names:
        raise InputError("over = {}: must name at least one coordinate to sweep, such as E or torque")
    return axes, sampling


def _is_inner(axis: Axis) -> bool:
    """True if one analysis goes over an axis."""
    return axis.name in ("torque", *CONDITIONS)
