"""Parameter sweep of a case: from swept coordinates to one dataset, on an engine, resumable.

Dataset of a sweep, filled batch by batch: key numbers and status over the swept coordinates.
"""

from __future__ import annotations

import contextlib
import json
import os
import time
from collections.abc import Callable, Generator, Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
import xarray as xr

from ...cases.deflection_table import MisalignmentSource
from ...cases.deflections import Deflections, misalignment_at
from ...cases.schema.case_schema import Case
from ...core.arrays import Array
from ...core.attributes import variable_attributes
from ...core.checks import file_path, whole
from ...geometry.deviation.deviation import Method
from ...geometry.pair.gear_pair import FlankName
from ...geometry.pair.modification import Modification
from ...geometry.tooth.tooth_flanks import MemberName
from ..analysis.operating import FrictionConditions, Operating
from ..analysis.swept_quantity import ASSEMBLY, Stage, swept_quantity
from ..case_in_mesh import FlanksInMesh, case_attributes, deflection_attributes, misalignment_attributes, prepared_pair
from ..deviations import Deviated, Source, deviation_attributes, flank_deviations
from ..progress import callback, shows_progress
from .batch_analysis import Batch, BatchStore, Block, analyze_batch, assembly_errors
from .engine import cluster_client, in_processes, in_this_process, on_cluster
from .sweep_file import SWEEP_SCHEMA_VERSION, PointStatus
from .sweep_plan import PointTable, Sampler, SweepPlan, SweepSetup, planned_sweep

if TYPE_CHECKING:
    from ...friction import FrictionModel, Lubricant
    from ...friction.operation import Numbers, Roughness

WORKER_COUNT_LIMIT = 1024
BATCH_TIME = 4.0  # [s]; a scheduler stalls on many short tasks, and a kill loses a batch
POOL_TIME = 8.0  # [s]; less work than this is done before the processes of a pool are ready
TRIAL_COUNT = 2  # batches of one point: in the first much is loaded and compiled, the second is timed


def usable_cores() -> int:
    """Number of processor cores that this process may use."""
    if hasattr(os, "sched_getaffinity"):
        return len(os.sched_getaffinity(0))
    return os.cpu_count() or 1


@shows_progress("sweep", "point")
def sweep(
    case: Case | str | Path,
    over: Mapping[str, Any] | None = None,
    *,
    load_cases: str | Path | Mapping[str, Sequence[Any]] | None = None,
    samples: int | None = None,
    seed: int = 0,
    sampler: Sampler = "sobol",
    flank: FlankName = "drive",
    torques: float | Sequence[float] | None = None,
    misalignment: MisalignmentSource | None = None,
    deviations: Mapping[MemberName, Source] | None = None,
    deviated: Deviated = "ease_off",
    interpolation: Method = "spline",
    modification: Modification | None = None,
    edge_contact: bool | None = None,
    marking: float | None = None,
    solver: str = "auto",
    speed: Numbers | None = None,
    temperature: Numbers | None = None,
    roughness: Roughness | list[Roughness] | Array | None = None,
    oil: str | Lubricant | None = None,
    friction_model: FrictionModel | None = None,
    friction_feedback: bool | None = None,
    workers: int | None = None,
    scheduler: str | None = None,
    store: str | os.PathLike[str] | None = None,
    fresh: bool = False,
    progress: Callable[[int, int], None] | bool | None = None,
) -> xr.Dataset:
    """Analyse a case at every point of a sweep.

    Parameters
    ----------
    case
        A checked case, or what ``read_case`` takes.
    over
        What is swept, by name: ``torque``, ``E``, ``P``, ``G``, ``Sigma`` [deg], ``speed``, ``temperature``,
        ``roughness``, ``oil``, ``flank``, ``deviation.MEMBER``, ``modification.TERM``, or the dotted key of a number of
        the case file. Values in a row, a text (``-0.1:0.1:9``, ``50,100``), or a ``Distribution`` or its text
        (``normal(0,0.03)``). Every combination is analysed; distributed ones are sampled together.
    load_cases
        Coordinates that go together, a row a point: the path of a CSV file, or columns by name.
    samples
        Number of samples of what is distributed.
    seed, sampler
        Of the samples: ``sobol`` or ``latin_hypercube``.
    flank, torques, misalignment, deviations, deviated, interpolation, modification, edge_contact, marking, solver
        As of ``analyze``, for what is not swept. E, P, G and Sigma that are swept take the place of the constant
        misalignment's; deflections over the torque are added to them.
    speed, temperature, roughness, oil, friction_model, friction_feedback
        As of ``analyze``, for what is not swept.
    workers
        Number of processes, one a core if left out; 1: this process alone.
    scheduler
        Address of the scheduler of a dask cluster, in place of processes of this machine.
    store
        Folder that keeps the batches as they are computed, from which an interrupted sweep resumes.
    fresh
        Ignore and replace what the folder has.
    progress
        ``True`` for a line that shows it; or a function, called with the numbers of points done and of all; every
        torque of an analysis is a point.

    Returns
    -------
    xr.Dataset
        Key numbers (``study.key_numbers``) over the swept coordinates, with ``status`` and ``reason`` of every point.

    Raises
    ------
    InputError
        If a coordinate or value is not possible, the store is of another sweep, or more memory is needed than is free.
    MissingSolverError, MissingPackageError
        If the package of the solver, or dask.distributed, is not installed.

    Notes
    -----
    Processes are started afresh, not forked: a script that calls this needs ``if __name__ == "__main__":``.

    Examples
    --------
    >>> from easeoff.cases import read_case
    >>> case = read_case("nasa-12x36")
    >>> case = case.model_copy(update={"contact": case.contact.model_copy(update={"mesh_positions": 3})})
    >>> dataset = sweep(case, {"E": [-0.05, 0.05], "torque": "100,200"}, workers=1)
    >>> dataset["peak_to_peak"].dims, dataset["status"].values.tolist()
    (('E', 'torque'), [[0, 0], [0, 0]])
    """
    flanks = FlanksInMesh(flank, misalignment, deviations, deviated, interpolation, modification)
    friction = FrictionConditions(speed, temperature, roughness, oil, friction_model, friction_feedback)
    operating = Operating(flanks, torques, edge_contact, marking, solver, friction)
    plan = planned_sweep(case, over, operating, load_cases=load_cases, samples=samples, seed=seed, sampler=sampler)
    return run_plan(plan, workers=workers, scheduler=scheduler, store=store, fresh=fresh, progress=callback(progress))


def run_plan(
    plan: SweepPlan,
    *,
    workers: int | None = None,
    scheduler: str | None = None,
    store: str | os.PathLike[str] | None = None,
    fresh: bool = False,
    progress: Callable[[int, int], None] | None = None,
) -> xr.Dataset:
    """Analyse every point of a plan; arguments, returns and raises as of ``sweep``."""
    worker_count = usable_cores() if workers is None else workers
    processes = 1 if scheduler is not None else whole("workers", worker_count, 1, WORKER_COUNT_LIMIT)
    plan.require_memory(processes)
    numbers, done, table = SweepNumbers(plan.table, plan.setup), 0, plan.table
    with contextlib.ExitStack() as context:
        client = None if scheduler is None else context.enter_context(cluster_client(scheduler))
        kept = None if store is None else batch_store(plan, store, fresh=fresh)
        for block in context.enter_context(contextlib.closing(_blocks(plan.setup, table, kept, processes, client))):
            numbers.add(block)
            done += block.rows.size
            if progress is not None:
                progress(done * plan.loads, plan.points)
    result = numbers.dataset()
    result.attrs = _attributes(plan)
    return result


def batch_store(plan: SweepPlan, folder: str | os.PathLike[str], *, fresh: bool = False) -> BatchStore:
    """The batches of a plan in a folder."""
    return BatchStore(file_path("store", folder), plan.digest, plan.description, plan.table.count, fresh=fresh)


def _blocks(
    setup: SweepSetup, table: PointTable, store: BatchStore | None, processes: int, client: Any
) -> Generator[Block]:
    """Numbers of all points, batch by batch: first those that are kept, then those that are computed."""
    bounds = (store.bounds if store is not None else None) or [0]
    done = set()
    for number, block in store.complete(table.order) if store is not None else ():
        done.add(number)
        yield block
    seconds = None
    # Once more where it resumes from trials whose time is not known.
    while bounds[-1] < table.count and (len(bounds) <= TRIAL_COUNT or seconds is None):
        bounds.append(table.bound(bounds[-1], 1))
        number = len(bounds) - 2
        start = time.perf_counter()
        block = analyze_batch(_batch(setup, table, bounds, number))
        seconds = (time.perf_counter() - start) / block.rows.size
        if store is not None:
            store.divide(bounds)
            store.add(number, block)
        done.add(number)
        yield block
    if bounds[-1] < table.count:
        share = -(-(table.count - bounds[-1]) // (2 * processes))
        size = max(1, min(int(BATCH_TIME / max(seconds or 0.0, 1e-6)), share))
        while bounds[-1] < table.count:
            bounds.append(table.bound(bounds[-1], size))
        if store is not None:
            store.divide(bounds)
    missing = [number for number in range(len(bounds) - 1) if number not in done]
    left = sum(bounds[number + 1] - bounds[number] for number in missing)
    batches = (_batch(setup, table, bounds, number) for number in missing)
    if client is not None:
        engine = on_cluster(batches, client)
    elif processes == 1 or (seconds is not None and seconds * left < POOL_TIME):
        engine = in_this_process(batches)
    else:
        engine = in_processes(batches, processes)
    with contextlib.closing(engine):
        for number, block in engine:
            if store is not None:
                store.add(number, block)
            yield block


def _batch(setup: SweepSetup, table: PointTable, bounds: list[int], number: int) -> Batch:
    rows = table.order[bounds[number] : bounds[number + 1]]
    return Batch(setup, number, rows, table.columns(rows))


def _attributes(plan: SweepPlan) -> dict[str, Any]:
    """Origin of the dataset, as netCDF attributes."""
    operating, case = plan.setup.operating, plan.setup.case
    return {
        **case_attributes(case, "sweep"),
        "sweep_schema_version": SWEEP_SCHEMA_VERSION,
        "sweep": plan.description,
        "swept": json.dumps(
            [name for axis in plan.axes for name in axis.columns if swept_quantity(name).stage < Stage.NOTHING]
        ),
        "solver": operating.solver,
        "flank": operating.flanks.flank,
        "compliance_model": case.compliance.model,
        "pinion_teeth": case.pinion.number_of_teeth,
        "gear_teeth": case.gear.number_of_teeth,
        "edge_contact": int(case.contact.edge_contact if operating.edge_contact is None else operating.edge_contact),
        **_misalignment(plan),
        **_departures(plan),
        **plan.sampling,
    }


def _misalignment(plan: SweepPlan) -> dict[str, Any]:
    """Assembly errors of every point that are not swept, without torque; and the torques of deflections."""
    given, flank = assembly_errors(plan.setup, {}), plan.setup.operating.flanks.flank
    if isinstance(given, Deflections) and given.flank and "flank" in plan.table.names:
        return {}
    errors = misalignment_attributes(misalignment_at(given, 0.0, flank)).items()
    constant = dict(one for name, one in zip(ASSEMBLY, errors, strict=True) if name not in plan.table.names)
    swept = [axis.columns["torque"].tolist() for axis in plan.axes if "torque" in axis.columns]
    return constant | deflection_attributes(given, flank, swept[0] if swept else plan.setup.torques or ())


def _departures(plan: SweepPlan) -> dict[str, Any]:
    """Modification and deviations of every point that are not swept."""
    given, swept = plan.setup.operating.flanks, plan.table.names
    coefficients = {} if given.modification is None else given.modification.coefficients
    terms = {name: value for name, value in coefficients.items() if f"modification.{name}" not in swept}
    sources = {member: one for member, one in (given.deviations or {}).items() if f"deviation.{member}" not in swept}
    attributes: dict[str, Any] = {"modification_um": json.dumps(terms)} if terms else {}
    if sources and "flank" not in swept:
        pair = prepared_pair(plan.setup.case, given.flank, given.misalignment)
        attributes |= deviation_attributes(flank_deviations(pair, sources, given.interpolation), given.deviated)
    return attributes


NOT_COMPUTED = -1  # value of a number with meanings where a point failed
ROW_NAMES = {"sample": "number of the sample", "load_case": "number of the load case"}


class SweepNumbers:
    """Numbers of a sweep as they arrive."""

    def __init__(self, table: PointTable, setup: SweepSetup) -> None:
        self.table, self.setup = table, setup
        self.status = np.full((table.count, *setup.loads), PointStatus.FAILED, dtype=np.int8)
        self.reason = np.full(self.status.shape, "", dtype=object)
        self._numbers: dict[str, Array] = {}
        self._variables: dict[str, Any] = {}
        self._coordinates: dict[str, list[Any]] = {}

    def add(self, block: Block) -> None:
        """Take in the numbers of a batch."""
        self.status[block.rows] = block.status
        self.reason[block.rows] = block.reason
        if not block.layout:
            return
        layout = json.loads(block.layout)
        for name, values in layout["coordinates"].items():
            self._coordinates.setdefault(name, values)
        for name, variable in layout["variables"].items():
            if name not in self._numbers:
                self._numbers[name] = np.full((self.table.count, *block.numbers[name].shape[1:]), np.nan)
                self._variables[name] = variable
            self._numbers[name][block.rows] = block.numbers[name]

    def dataset(self) -> xr.Dataset:
        """The dataset over the swept coordinates."""
        shape, outer = self.table.shape, tuple(axis.name for axis in self.table.axes)
        loads = () if self.setup.torques is None else ("torque",)
        data: dict[str, Any] = {}
        for name, values in self._numbers.items():
            variable = self._variables[name]
            dims = (*outer, *variable["dimensions"])
            data[name] = self._variable(name, dims, values.reshape((*shape, *values.shape[1:])), variable["flags"])
        status = self.status.reshape((*shape, *self.status.shape[1:]))
        meanings = PointStatus.flag_attributes() | {"long_name": "how the analysis of a point ended"}
        data["status"] = xr.Variable((*outer, *loads), status, meanings)
        reason, words = self.reason.astype(str).reshape(status.shape), "why a point is not certified; empty where it is"
        data["reason"] = xr.Variable((*outer, *loads), reason, {"long_name": words})
        return xr.Dataset(data, coords=self._coords(outer))

    def _coords(self, outer: tuple[str, ...]) -> dict[str, Any]:
        coords: dict[str, Any] = {}
        for axis in self.table.axes:
            for name, values in axis.columns.items():
                quantity = swept_quantity(name)
                attributes = {"long_name": quantity.long_name} | ({"units": quantity.units} if quantity.units else {})
                coords[name] = xr.Variable((axis.name,), values, attributes)
            if axis.name not in axis.columns:
                attributes = {"long_name": ROW_NAMES[axis.name], "units": "1"}
                coords[axis.name] = xr.Variable((axis.name,), np.arange(axis.size), attributes)
        if self.setup.torques is not None:
            self._coordinates.setdefault("torque", list(self.setup.torques))
        for name, along in self._coordinates.items():
            if name not in outer:
                coords[name] = self._variable(name, (name,), np.asarray(along), {})
        return coords

    @staticmethod
    def _variable(name: str, dims: tuple[str, ...], values: Array, flags: dict[str, Any]) -> xr.Variable:
        attributes = variable_attributes(name)
        if flags:
            whole = np.where(np.isnan(values), NOT_COMPUTED, values).astype(np.int8)
            meanings = {
                "flag_values": np.array([*flags["flag_values"], NOT_COMPUTED], dtype=np.int8),
                "flag_meanings": f"{flags['flag_meanings']} not_computed",
            }
            return xr.Variable(dims, whole, attributes | meanings)
        return xr.Variable(dims, values, attributes)
