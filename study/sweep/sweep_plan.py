"""Plan of a sweep: its points, what is the same at all of them, and how the samples were drawn."""

from __future__ import annotations

import hashlib
import json
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any, cast

import numpy as np

from ...cases.analysis_size import AnalysisSize
from ...cases.deflection_table import misalignment_of
from ...cases.reading import shipped_deviations
from ...cases.schema.case_schema import Case
from ...contact.evaluation.marking_print import checked_thickness
from ...contact.solvers import require_solver
from ...core.checks import instance, shown
from ...core.errors import InputError
from ...core.memory import require_memory
from ...core.regular_file import require_file
from ...friction.lubricants.lubricant import lubricant
from ..analysis.contact_analysis import case_torques
from ..analysis.friction_analysis import friction_settings, operation_of
from ..case_in_mesh import checked_case, prepared_pair, require_kinds
from ..deviations.deviation_source import flank_deviations
from .axis import Axis, grid_axis, is_distribution
from .distribution import Distribution, Sampler, sample_values
from .load_case_axis import load_case_axis, read_load_case_axis
from .point_table import PointTable
from .sweep_setup import SweepSetup
from .swept_quantity import CONDITIONS, Stage, swept_quantity

if TYPE_CHECKING:
    from ...friction import Operation

SAMPLE = "sample"
POINT_NUMBERS = 60  # of an analysis at one load, without friction
CONDITION_NUMBERS = 16  # at one operating condition
NUMBER_SIZE = 24.0  # of a number with the copy that is written [byte]
REASON_SIZE = 500.0  # of a text at every point, as failures make it [byte]


@dataclass(frozen=True)
class SweepPlan:
    """Plan of a sweep.

    Parameters
    ----------
    setup
        What is the same at every point.
    axes
        All axes in the order given, with those over which one analysis goes.
    sampling
        Distributions, seed and sampler, as attributes of the dataset; empty without samples.

    Examples
    --------
    >>> plan = planned_sweep("nasa-12x36", {"E": "-0.1:0.1:3", "torque": "50,100"})
    >>> plan.table.count, plan.setup.torques
    (3, (50.0, 100.0))
    """

    setup: SweepSetup
    axes: tuple[Axis, ...]
    sampling: Mapping[str, Any]

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
        found = hashlib.sha256(self.setup.digest.encode())
        for axis in self.axes:
            for name, values in axis.columns.items():
                found.update(f"{axis.name}/{name}/{values.dtype.kind}/{values.size}/".encode())
                found.update(values.tobytes() if values.dtype.kind == "f" else "\0".join(values.tolist()).encode())
        return found.hexdigest()

    @property
    def operation(self) -> Operation | None:
        """Operating conditions of the first point; none without friction."""
        first = self.table.values(0)
        own = {name: first[name] for name in (*CONDITIONS, "oil") if name in first}
        return operation_of(self.setup.case.friction, **{**self.setup.conditions, **own})

    @property
    def size(self) -> AnalysisSize:
        """Size of the analysis at one point."""
        setup, operation = self.setup, self.operation
        _, feedback = friction_settings(setup.case, operation, setup.friction_model, setup.friction_feedback)
        shape = (0, 0, 0) if operation is None else operation.shape
        return AnalysisSize.of(setup.case, self.loads, shape, feedback=feedback)

    @property
    def loads(self) -> int:
        """Number of torques of the analysis at one point."""
        return 1 if self.setup.torques is None else len(self.setup.torques)

    @property
    def points(self) -> int:
        """Number of points with a status: every torque of every analysis."""
        return self.table.count * self.loads

    def require_memory(self, processes: int) -> None:
        """Refuse a sweep that needs more memory than is free.

        Parameters
        ----------
        processes
            Number of processes on this machine.

        Raises
        ------
        InputError
            With the numbers to lower, what is needed and what is free.
        """
        size = self.size
        size.require_memory()
        conditions = size.speeds * size.temperatures * size.roughnesses
        each = self.loads * (NUMBER_SIZE * (POINT_NUMBERS + CONDITION_NUMBERS * conditions) + REASON_SIZE)
        needed = processes * size.memory + self.table.count * each
        require_memory(f"{self.table.count} points x {processes} workers", needed, "the sweep")


def planned_sweep(
    case: Case | str | Path,
    over: Mapping[str, Any] | None = None,
    *,
    load_cases: str | Path | Mapping[str, Sequence[Any]] | None = None,
    samples: int | None = None,
    seed: int = 0,
    sampler: Sampler = "sobol",
    torques: float | Sequence[float] | None = None,
    speed: Any = None,
    temperature: Any = None,
    roughness: Any = None,
    oil: Any = None,
    deviations: Mapping[Any, Any] | None = None,
    allow_outside: bool = False,
    **options: Any,
) -> SweepPlan:
    """Plan a sweep; arguments and raises as of ``sweep``.

    Parameters
    ----------
    allow_outside
        Whether a file of load cases may name files outside its folder.
    case, over, load_cases, samples, seed, sampler, torques, speed, temperature, roughness, oil, deviations, **options
        As of ``sweep``.
    """
    checked = checked_case(case)
    solver = options.get("solver", "auto")
    if not isinstance(solver, str):
        raise InputError(f"solver = {shown(solver)}: must be a name or MODULE:FUNCTION, which every process can find")
    require_solver(solver)
    if options.get("marking") is not None:
        checked_thickness(options["marking"])
    if options.get("misalignment") is not None:
        options["misalignment"] = misalignment_of(options["misalignment"])
    instance("over", over, Mapping | None)
    require_kinds(deviations=deviations, **options)
    axes, sampling = _axes(over or {}, load_cases, samples, seed, sampler, allow_outside=allow_outside)
    single = {"torque": torques, "speed": speed, "temperature": temperature, "roughness": roughness, "oil": oil}
    single |= {f"deviation.{member}": source for member, source in (deviations or {}).items()}
    for name in (name for axis in axes for name in axis.columns):
        if single.get(name) is not None:
            raise InputError(f"{name} = {shown(single[name])}: must be left out, as {name} is swept")
    inner = {axis.name: axis.columns[axis.name].tolist() for axis in axes if _is_inner(axis)}
    table = _table(axes)
    own_torques = case_torques(checked, inner.get("torque", torques))
    given = {name: single[name] for name in (*CONDITIONS, "oil")} | inner
    setup = SweepSetup(
        checked,
        None if "torque" in table.names else tuple(own_torques.tolist()),
        {name: value for name, value in given.items() if value is not None and name not in (*table.names, "torque")},
        deviations={str(name): source for name, source in (deviations or {}).items()},
        **options,
    )
    _require_files(table)
    if "flank" not in table.names:
        pair = prepared_pair(checked, setup.flank, setup.misalignment)
        if not any(swept_quantity(name).stage == Stage.PAIR for name in table.names):
            flank_deviations(pair, cast(Any, setup.deviations), setup.interpolation)  # a mistake shows before the work
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
        texts = {name: found.text for name, found in distributions.items()}
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
    """Whether one analysis goes over an axis."""
    return axis.name in ("torque", *CONDITIONS)
