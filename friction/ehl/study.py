"""Running the parameter study: one row a combination, kept on disk as soon as it is known, labelled at the end."""

from __future__ import annotations

import importlib
import json
import math
import os
import time
from collections.abc import Callable, Iterable, Iterator
from dataclasses import asdict
from pathlib import Path
from typing import Any

import numpy as np
import xarray as xr

from ...core.attributes import labelled
from ...core.errors import InputError, MissingPackageError
from ...core.files import check_writable, whole_file
from .cases import NUMBERS, Resolution, Row, run_case
from .certificate import Status
from .design import Condition, Design, numbers


def run_study(
    path: str | os.PathLike[str],
    wanted: Iterable[int] | int | None = None,
    *,
    design: Design | None = None,
    resolution: Resolution | None = None,
    dask: bool = False,
    seconds: float = math.inf,
    progress: Callable[[int, int], None] | None = None,
) -> xr.Dataset:
    """Run combinations of the study that are not known yet, and write the dataset.

    Parameters
    ----------
    path
        The netCDF file. What is known is kept beside it, in a file of one JSON object a line with the ending
        ``.rows``: a study that was interrupted goes on where it stopped.
    wanted : iterable of int, int, or None
        Numbers of combinations; the size of a space-filling subset; or all of them.
    design, resolution
        Those of the dissertation and the defaults if not given. Rows of another resolution are not used.
    dask : bool
        Spread the cases over dask: over the client that is active, or else the processes of this machine.
    seconds : float
        Begin no case after as many; the rest are rows with the status `NOT_RUN`.
    progress : callable, optional
        Called with the number of cases done and of all that were missing.

    Returns
    -------
    xarray.Dataset
        What was written; see `study_dataset`.

    Raises
    ------
    InputError
        The file cannot be written or a number is not in the design.
    MissingPackageError
        dask is asked for and not installed.
    """
    design, resolution = design or Design(), resolution or Resolution()
    target = Path(path)
    check_writable(target)
    order = numbers(design, wanted)
    conditions = {int(number): design.condition(int(number)) for number in order}
    store = target.with_name(target.name + ".rows")
    key = json.dumps({"design": asdict(design), "resolution": asdict(resolution)}, sort_keys=True)
    known = _read(store, key)
    missing = [number for number in conditions if number not in known]
    deadline = time.monotonic() + seconds
    run = _with_dask if dask else _one_by_one
    for done, (number, row) in enumerate(run({n: conditions[n] for n in missing}, resolution, deadline), start=1):
        known[number] = row
        _append(store, {"key": key, "number": number, "row": row})
        if progress is not None:
            progress(done, len(missing))
    not_run: Row = {**dict.fromkeys(NUMBERS, math.nan), "status": float(Status.NOT_RUN)}
    rows = {number: known.get(number, not_run) for number in conditions}
    dataset = study_dataset(design, rows)
    dataset.attrs |= {name: int(v) if isinstance(v, bool) else v for name, v in asdict(resolution).items()}
    with whole_file(target) as temporary:
        packed = {name: {"zlib": True} for name in dataset.data_vars}
        dataset.to_netcdf(temporary, engine="netcdf4", encoding=packed)
    return dataset


def study_dataset(design: Design, rows: dict[int, Row]) -> xr.Dataset:
    """Return rows as a labelled dataset over the dimension `combination`, failed ones included.

    Variables: the condition, `status`, `friction_coefficient` and its parts by film and asperities, `asperity_share`,
    `mean_film`, `smooth_film` (smallest of the smooth surfaces), `lambda_ratio`, `certified_share`, and the cost.
    """
    cases = [asdict(design.condition(number)) for number in rows]
    names = list(asdict(design.condition(0)))
    renamed = {"hertz_pressure": "contact_pressure", "radius": "contact_radius"}
    data: dict[str, Any] = {
        renamed.get(name, name): ("combination", np.array([case[name] for case in cases], dtype=float))
        for name in names
    }
    for name in NUMBERS:
        data[name] = ("combination", np.array([row[name] for row in rows.values()], dtype=float))
    friction = data["film_friction"][1] + data["asperity_friction"][1]
    data["friction_coefficient"] = ("combination", friction)
    status = np.array([row["status"] for row in rows.values()]).astype(np.int8)
    data["status"] = ("combination", status, Status.flag_attributes())
    return labelled(xr.Dataset(data, coords={"combination": np.array(list(rows), dtype=int)}))


def _one_by_one(conditions: dict[int, Condition], resolution: Resolution, deadline: float) -> Iterator[tuple[int, Row]]:
    for number, condition in conditions.items():
        if time.monotonic() > deadline:
            return
        yield number, run_case(condition, resolution)


def _with_dask(conditions: dict[int, Condition], resolution: Resolution, deadline: float) -> Iterator[tuple[int, Row]]:
    try:
        engine: Any = importlib.import_module("dask")
    except ImportError as error:
        raise MissingPackageError("dask is not installed: pip install 'easeoff[dask]', or run without it") from error
    batch = 8 * (os.cpu_count() or 1)
    todo = list(conditions)
    # With a distributed client its scheduler is the default; without one, processes: the work holds the interpreter.
    scheduler = {} if engine.config.get("scheduler", None) else {"scheduler": "processes"}
    for at in range(0, len(todo), batch):
        if time.monotonic() > deadline:
            return
        part = todo[at : at + batch]
        tasks = [engine.delayed(run_case)(conditions[number], resolution) for number in part]
        yield from zip(part, engine.compute(*tasks, **scheduler), strict=True)


def _read(store: Path, key: str) -> dict[int, Row]:
    """Rows on disk of the same design and resolution; half-written lines are skipped."""
    known: dict[int, Row] = {}
    if not store.exists():
        return known
    for line in store.read_text(encoding="utf-8", errors="replace").splitlines():
        try:
            entry = json.loads(line)
            if entry["key"] == key:
                known[int(entry["number"])] = {**dict.fromkeys(NUMBERS, math.nan), **entry["row"]}
        except (ValueError, KeyError, TypeError):
            continue
    return known


def _append(store: Path, entry: dict[str, Any]) -> None:
    try:
        # The line feed in front ends a line that an interruption may have left half-written.
        with store.open("a", encoding="utf-8") as file:
            file.write(f"\n{json.dumps(entry)}")
            file.flush()
            os.fsync(file.fileno())
    except OSError as error:
        raise InputError(f"{store} cannot be written: {error.strerror or error}") from error
