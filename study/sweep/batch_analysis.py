"""Batches of a sweep: every number of ``easeoff show`` at their points, failures included, and their files on disk."""

from __future__ import annotations

import hashlib
import io
import json
import math
import os
import re
import shutil
from collections.abc import Iterator, Mapping
from contextlib import suppress
from dataclasses import dataclass, replace
from functools import cached_property, lru_cache
from itertools import pairwise
from pathlib import Path
from typing import Any

import numpy as np
import xarray as xr
from numpy.typing import NDArray

from ...cases.deflection_table import MisalignmentSource
from ...cases.deflections import Deflections, with_errors
from ...cases.writing import changed_case
from ...contact.solvers import Status
from ...core.array_file import read_arrays
from ...core.arrays import Array, record
from ...core.attributes import ordered
from ...core.checkpoint import DAMAGED, Checkpoint, digest
from ...core.errors import EaseoffError, GeometryError, InputError, printable, shortened
from ...core.output_file import NAME as PRIVATE_NAME, check_folder, clear_remains, whole_file
from ...core.process_settings import without_garbage_collection
from ...core.regular_file import TABLE_SIZE_LIMIT, parsed_json, read_text
from ...geometry.pair.assembly import Misalignment
from ...geometry.pair.modification import Modification
from ..analysis.case_analysis import with_friction
from ..analysis.contact_analysis import Analysis, case_torques, contact_analysis
from ..analysis.key_numbers import key_numbers
from ..analysis.swept_quantity import ASSEMBLY, CONDITIONS, Stage, swept_quantity
from ..case_in_mesh import CaseInMesh
from .sweep_file import PointStatus
from .sweep_plan import SweepSetup, assemblies

REASON_LENGTH_LIMIT = 200  # of the reason of a failure [characters]
KEPT_PAIRS = 2  # that a process keeps in mesh


@dataclass(frozen=True)
class Batch:
    """Points (n) to analyse in one go, by one process."""

    setup: SweepSetup
    number: int
    rows: Array
    columns: Mapping[str, Array]  # values (n) of every coordinate


@record(frozen=True)
class Block:
    """Numbers of the points (n) of a batch; over torques, too, where one analysis has several."""

    rows: Array
    status: Array
    reason: Array  # (n, ...), empty where a point did not fail
    numbers: Mapping[str, Array]
    layout: str  # dimensions with values, attributes and kinds of numbers, as JSON; empty if all failed


@without_garbage_collection()
def analyze_batch(batch: Batch) -> Block:
    """Numbers of every point of a batch; a failure is a row with a reason.

    Common parts of points are computed once; no number depends on their division into batches.
    """
    loads = math.prod(batch.setup.loads)
    point_numbers: dict[int, xr.Dataset] = {}
    status = np.full((batch.rows.size, loads), PointStatus.FAILED, dtype=np.int8)
    reasons = [[""] * loads for _ in batch.rows]
    for together in assemblies(batch.columns, batch.rows.size):
        assembly = _Assembly(batch.setup, {name: values[together[0]].item() for name, values in batch.columns.items()})
        for place in together.tolist():
            values = {name: column[place].item() for name, column in batch.columns.items()}
            try:
                numbers, status[place], reasons[place] = assembly.numbers(values)
            except EaseoffError as error:
                kind = {InputError: PointStatus.NOT_POSSIBLE, GeometryError: PointStatus.NO_CONTACT}
                status[place] = kind.get(type(error), PointStatus.FAILED)
                reasons[place] = [_reason(str(error))] * loads
            except MemoryError:
                raise
            except Exception as error:  # a sweep of many hours goes on, and says what happened
                reasons[place] = [_reason(f"{type(error).__name__}: {error}")] * loads
            else:
                point_numbers[place] = numbers
    shape = (batch.rows.size, *batch.setup.loads)
    reason = np.array(reasons, dtype=str).reshape(shape)
    return Block(batch.rows, status.reshape(shape), reason, *_stacked(point_numbers, batch.rows.size))


def point_tree(setup: SweepSetup, values: Mapping[str, Any]) -> xr.DataTree:
    """The whole analysis at one point of a sweep, as of ``analyze``; EaseoffError if the point cannot be analysed."""
    return _Assembly(setup, values).analysis(values).tree


class _Assembly:
    """A pair in one assembly, at every load and condition."""

    def __init__(self, setup: SweepSetup, values: Mapping[str, Any]) -> None:
        self.setup = setup
        self._first = dict(values)
        self._loaded: dict[tuple[Any, ...], Analysis] = {}

    def analysis(self, values: Mapping[str, Any]) -> Analysis:
        """The whole analysis at a point, as of ``analyze``."""
        friction = self.setup.friction(values)  # refused before the contact is solved
        return with_friction(self._contact(values), friction, self.setup.operating.solver)

    def numbers(self, values: Mapping[str, Any]) -> tuple[xr.Dataset, list[int], list[str]]:
        """Key numbers at a point, and for every load its status and why it is not certified."""
        groups = self.analysis(values).groups
        numbers = key_numbers(groups)
        single = [name for name in ("torque", *CONDITIONS) if name in values and name in numbers.dims]
        numbers = numbers.isel(dict.fromkeys(single, 0)).drop_vars(single)
        return numbers, *_outcome(groups)

    def _contact(self, values: Mapping[str, Any]) -> Analysis:
        """Analysis without friction at a point."""
        setup = self.setup
        terms = {name: value for name, value in values.items() if swept_quantity(name).stage == Stage.EASE_OFF}
        torques = case_torques(setup.case, [values["torque"]]) if setup.torques is None else setup.torques
        key = (*terms.items(), *torques)
        if key not in self._loaded:
            state = self._state
            if isinstance(state, EaseoffError):
                raise state
            if terms:
                modification = setup.operating.flanks.modification
                given = {} if modification is None else dict(modification.coefficients)
                coefficients = {name.removeprefix("modification."): value for name, value in terms.items()}
                state = state.modified(Modification(given | coefficients))
            # Of the last load alone: rows are sorted, and an analysis is large.
            self._loaded = {key: contact_analysis(state, torques, **setup.operating.contact)}
        return self._loaded[key]

    @cached_property
    def _state(self) -> CaseInMesh | EaseoffError:
        """The pair in its assembly, or why there is none."""
        try:
            return _assembled(self.setup, self._first)
        except EaseoffError as error:
            return error


def _assembled(setup: SweepSetup, values: Mapping[str, Any]) -> CaseInMesh:
    """The pair of a point in its assembly, without what is modified from point to point."""
    pair = tuple((name, value) for name, value in values.items() if swept_quantity(name).stage == Stage.PAIR)
    errors = {name: value for name, value in values.items() if name in ASSEMBLY}
    state = _pair_in_mesh(setup, pair)
    if isinstance(state, GeometryError) and errors:
        return _made(setup, pair, assembly_errors(setup, errors))  # elsewhere the flanks may well meet
    if isinstance(state, EaseoffError):
        raise state
    return state.misaligned(assembly_errors(setup, errors)) if errors else state


def assembly_errors(setup: SweepSetup, errors: Mapping[str, float]) -> Misalignment | Deflections:
    """The assembly of a point: that of the setup with some errors in place of its constant ones."""
    given = setup.operating.flanks.errors(setup.case)
    base = given.constant if isinstance(given, Deflections) else given
    misalignment = with_errors(base, errors)
    return given.with_constant(misalignment) if isinstance(given, Deflections) else misalignment


@lru_cache(maxsize=KEPT_PAIRS)
def _pair_in_mesh(setup: SweepSetup, pair: tuple[tuple[str, Any], ...]) -> CaseInMesh | EaseoffError:
    """The pair of a point in the assembly of the setup, kept by the process; or why there is none."""
    try:
        return _made(setup, pair, setup.operating.flanks.misalignment)
    except EaseoffError as error:
        return error


def _made(setup: SweepSetup, pair: tuple[tuple[str, Any], ...], misalignment: MisalignmentSource | None) -> CaseInMesh:
    """The pair in mesh from its case: settings, flanks and deviations of a point."""
    values, given = dict(pair), setup.operating.flanks
    deviations: dict[Any, Any] = dict(given.deviations or {})
    for member in ("pinion", "gear"):
        if f"deviation.{member}" in values:
            deviations[member] = values.pop(f"deviation.{member}")
    flank = values.pop("flank", given.flank)
    flanks = replace(given, flank=flank, misalignment=misalignment, deviations=deviations)
    return CaseInMesh.meshed(changed_case(setup.case, values) if values else setup.case, flanks)


def _outcome(groups: Mapping[str, xr.Dataset]) -> tuple[list[int], list[str]]:
    """Status of every load, and why it is not certified."""
    codes: list[int] = []
    reasons = []
    light = ordered(groups["light_load"], "status", "torque", "mesh_position")
    friction = groups.get("friction")
    statuses = ordered(groups["loaded"], "status", "torque", "mesh_position")
    for load, status in enumerate(statuses):
        parts = [("mesh positions", status), ("mesh positions at light load", light)]
        if friction is not None and "status" in friction:
            fed_back = friction["status"].isel(torque=load).values
            parts.append(("mesh positions and conditions with friction fed back", fed_back))
        said = []
        for what, values in parts:
            bad = values[values != Status.CERTIFIED]
            if bad.size:
                names = ", ".join(sorted({Status(int(value)).name.lower() for value in bad}))
                said.append(f"{bad.size} of {values.size} {what} have no certified solution ({names})")
        if said and "first_failure" in groups["loaded"].attrs:
            said.append(_reason(groups["loaded"].attrs["first_failure"]))
        codes.append(int(PointStatus.UNCERTIFIED if said else PointStatus.CERTIFIED))
        reasons.append("; ".join(said))
    return codes, reasons


def _reason(text: str) -> str:
    return shortened(printable(" ".join(text.split())), REASON_LENGTH_LIMIT)


def _stacked(results: Mapping[int, xr.Dataset], count: int) -> tuple[dict[str, Array], str]:
    """Numbers of all points in one array each, and their layout."""
    numbers: dict[str, Array] = {}
    layout: dict[str, Any] = {"variables": {}, "coordinates": {}}
    for place, dataset in results.items():
        for name in dataset.dims:
            if name in dataset.coords:
                layout["coordinates"][str(name)] = dataset[name].values.tolist()
        for name, variable in dataset.variables.items():
            if name in dataset.dims:
                continue
            if name not in numbers:
                numbers[str(name)] = np.full((count, *variable.shape), np.nan)
                flags = {
                    key: np.asarray(value).tolist() for key, value in variable.attrs.items() if key.startswith("flag_")
                }
                layout["variables"][str(name)] = {"dimensions": list(map(str, variable.dims)), "flags": flags}
            numbers[str(name)][place] = variable.values
    return numbers, json.dumps(layout) if results else ""


#: File that says which sweep a store is of, and the map of its batches.
PLAN_NAME, MAP_NAME = "sweep.json", "batches.jsonl"
OWN_DIGEST = "own_digest"  # in the plan, of the rest of it
STUDY = "parameter sweep"
BATCH_NAME = re.compile(r"batch-\d+\.npz")
NUMBER = "number."  # before the name of a number in a file of a batch


class BatchStore:
    """Batches of one sweep in a folder, from which an interrupted sweep resumes; ``fresh`` replaces them.

    A batch is written whole and is on the disk before it enters the map with the digest of its content. A batch that is
    not in the map, whose file has other content, or in which a point failed unexpectedly, is computed anew.
    """

    def __init__(self, folder: Path, digest: str, description: str, count: int, *, fresh: bool = False) -> None:
        check_folder(folder, "batches of the sweep")
        self.folder, self._digest, self._description = folder, digest, description
        plan = None if fresh else self._plan()
        if fresh:
            self.remove()
        elif plan is None:
            self._refuse_other_files()
        elif plan.get("digest") != digest:
            raise InputError(
                f"{printable(str(folder))}: must hold the batches of this sweep ({description}), but holds those of "
                f"another ({printable(str(plan.get('description')))}); give another folder, remove it, or begin anew "
                "with --fresh"
            )
        self._refuse_folders()
        self.bounds: list[int] | None = _bounds(plan, count)
        self._map: Checkpoint[str] | None = None
        if os.path.isdir(folder):  # a map that cannot be used shows before anything is written
            self._map = self._completed

    def divide(self, bounds: list[int]) -> None:
        """Record how the points are divided into batches; with what was recorded before, it stays so."""
        plan = {"digest": self._digest, "description": self._description, "bounds": bounds}
        text = json.dumps(plan | {OWN_DIGEST: digest(**plan)})
        with whole_file(self.folder / PLAN_NAME) as temporary:
            temporary.write_text(text, encoding="utf-8")
        self.bounds = bounds
        self._completed.begin()

    def add(self, number: int, block: Block) -> None:
        """Keep a batch: it is on the disk when this returns."""
        content = io.BytesIO()
        arrays: dict[str, Any] = {"rows": block.rows, "status": block.status, "reason": block.reason}
        arrays |= {"layout": block.layout, **{f"{NUMBER}{name}": values for name, values in block.numbers.items()}}
        np.savez(content, **arrays)
        data = content.getvalue()
        with whole_file(self._path(number)) as temporary:
            temporary.write_bytes(data)
        self._completed.add(str(number), hashlib.sha256(data).hexdigest())

    def complete(self, order: NDArray[Any]) -> Iterator[tuple[int, Block]]:
        """The batches that are complete, by their numbers; ``order`` has rows (n) as the bounds divide them."""
        for number, (first, last) in enumerate(pairwise(self.bounds or [])):
            block = self._read(number)
            # Another run of the same sweep may have divided it otherwise.
            same_rows = block is not None and np.array_equal(block.rows, order[first:last])
            # What failed unexpectedly, as for want of memory, may succeed now.
            if block is not None and same_rows and not np.any(block.status == PointStatus.FAILED):
                yield number, block

    def _read(self, number: int) -> Block | None:
        """A batch from its file, if the map has it with that content."""
        recorded = self._completed.get(str(number))
        if recorded is None:
            return None
        try:
            intact = hashlib.sha256(self._path(number).read_bytes()).hexdigest() == recorded
            return _block(self._path(number)) if intact else None
        except (OSError, InputError, KeyError, ValueError):
            return None

    def remove(self) -> None:
        """Remove the batches, and the folder if nothing else is in it."""
        clear_remains(self.folder)
        with suppress(FileNotFoundError), os.scandir(self.folder) as entries:
            for entry in entries:
                # A private folder that is left is that of another run, which writes into it at this moment.
                if _is_own(entry.name) and not PRIVATE_NAME.fullmatch(entry.name):
                    with suppress(FileNotFoundError):
                        shutil.rmtree(entry.path) if entry.is_dir(follow_symlinks=False) else os.unlink(entry.path)
        with suppress(OSError):
            self.folder.rmdir()

    @property
    def _completed(self) -> Checkpoint[str]:
        """Map from the number of a batch to the digest of its file."""
        if self._map is None:
            self._map = Checkpoint(self.folder / MAP_NAME, f"{STUDY} {self._digest}", encode=str, decode=str)
        return self._map

    def _path(self, number: int) -> Path:
        return self.folder / f"batch-{number:06d}.npz"

    def _plan(self) -> dict[str, Any] | None:
        """Record of the folder's sweep; nothing if there is none, or it is damaged."""
        if not os.path.isfile(self.folder / PLAN_NAME):
            return None
        try:
            plan = parsed_json(read_text(self.folder / PLAN_NAME, TABLE_SIZE_LIMIT))
            checksum = plan.pop(OWN_DIGEST)
            return plan if checksum == digest(**plan) else None
        except (ValueError, AttributeError, KeyError, TypeError):
            return None

    def _refuse_folders(self) -> None:
        """Refuse a folder where a batch shall be, before anything is written."""
        with suppress(FileNotFoundError), os.scandir(self.folder) as entries:
            for entry in entries:
                if BATCH_NAME.fullmatch(entry.name) and entry.is_dir():
                    raise InputError(f"{printable(entry.path)} is a folder: remove it, or begin anew with --fresh")

    def _refuse_other_files(self) -> None:
        if os.path.isdir(self.folder):
            foreign = [name for name in os.listdir(self.folder) if not _is_own(name)]
            if foreign:
                raise InputError(
                    f"{printable(str(self.folder))}: must be an empty folder, or not exist, to hold the batches of the "
                    f"sweep; it holds {printable(foreign[0])}"
                )


def _is_own(name: str) -> bool:
    """True if an entry of a folder is one of a store."""
    return name in (PLAN_NAME, MAP_NAME, f"{MAP_NAME}{DAMAGED}") or bool(
        BATCH_NAME.fullmatch(name) or PRIVATE_NAME.fullmatch(name)
    )


def _bounds(plan: dict[str, Any] | None, count: int) -> list[int] | None:
    """Recorded bounds of the batches, if they rise from 0 to the number of points at most."""
    bounds = plan.get("bounds") if plan else None
    if not isinstance(bounds, list) or not all(type(one) is int for one in bounds) or bounds[:1] != [0]:
        return None
    return bounds if all(one < two for one, two in pairwise(bounds)) and bounds[-1] <= count else None


def _block(path: Path) -> Block:
    """A batch from its file."""
    arrays = {name: array for name, array in read_arrays(path).items() if array is not None}
    numbers = {name.removeprefix(NUMBER): values for name, values in arrays.items() if name.startswith(NUMBER)}
    return Block(arrays["rows"], arrays["status"], arrays["reason"], numbers, str(arrays["layout"].item()))
