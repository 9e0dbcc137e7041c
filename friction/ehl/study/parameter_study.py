"""Parameter study of friction with the film model: one row a combination, from a checkpoint, as a labelled dataset."""

from __future__ import annotations

import importlib
import math
import os
import time
from collections.abc import Callable, Iterable, Iterator
from contextlib import suppress
from dataclasses import asdict
from pathlib import Path
from typing import Any

import numpy as np
import xarray as xr

from ....core import checks
from ....core.attributes import labelled
from ....core.checkpoint import Checkpoint, digest
from ....core.errors import InputError, MissingPackageError, how_to_install
from ....core.processes.child_environment import child_environment
from ....core.reading.netcdf_file import read_dataset
from ....core.writing.netcdf_output import write_netcdf
from ....core.writing.output_file import check_writable
from ..equations.film_certificate import Status
from ..rolling_contact.asperities import Asperities
from .study_case import MODEL_VERSION, NUMBERS, Resolution, Row, run_case
from .study_design import Condition, Design, numbers


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
        The netCDF file; missing folders are made. Rows are kept in a checkpoint beside it, whose name ends in
        ``.rows``: an interrupted study resumes from it. An earlier study is replaced; any other file is refused.
    wanted
        Numbers of combinations; the size of a space-filling subset; or all of them.
    design, resolution
        Those of the dissertation and the defaults if not given. Rows of another design, resolution or version of the
        model (``MODEL_VERSION``) are not used.
    dask
        Spread the cases over dask: over the client that is active, or else the processes of this machine. Each process
        imports the program that called: a script must call from below ``if __name__ == "__main__":``, or else it
        begins anew in each of them, which ends in a BrokenProcessPool.
    seconds
        Begin no case after as many; the rest are rows with the status ``NOT_RUN``.
    progress
        Called with the number of cases done and of all that were missing.

    Returns
    -------
    xarray.Dataset
        The dataset written; see ``study_dataset``.

    Raises
    ------
    InputError
        If the file cannot be written or is no study, an argument cannot be used, or a number is not in the design; all
        before the first case.
    MissingPackageError
        If dask is asked for and not installed.

    Examples
    --------
    >>> from tempfile import TemporaryDirectory
    >>> with TemporaryDirectory() as folder:
    ...     study = run_study(f"{folder}/study.nc", [31499], resolution=Resolution(fewest=97))
    >>> study["status"].values
    array([0], dtype=int8)
    """
    design = Design() if design is None else design
    resolution = Resolution() if resolution is None else resolution
    checks.instance("design", design, Design)
    checks.instance("resolution", resolution, Resolution)
    checks.number("seconds", seconds, "s", infinite=True)
    checks.truth("dask", dask)
    checks.instance("progress", progress, Callable | None)
    target = checks.file_path("path", path)
    check_writable(target)
    _check_is_study(target)
    order = numbers(design, wanted)
    conditions = {int(number): design.condition(int(number)) for number in order}
    roughest = max(condition.composite_roughness for condition in conditions.values())
    Asperities(roughest, resolution.correlation_length)  # refuses what is too steep
    store = target.with_name(target.name + ".rows")
    checkpoint: Checkpoint[Row] = Checkpoint(store, "parameter study of friction", encode=dict, decode=dict)
    contents = digest(version=MODEL_VERSION, design=asdict(design), resolution=asdict(resolution))
    known = {number: row for number in conditions if (row := checkpoint.get(f"{contents}/{number}")) is not None}
    missing = {number: condition for number, condition in conditions.items() if number not in known}
    run = _with_dask if dask else _one_by_one
    checkpoint.begin()
    for done, (number, row) in enumerate(run(missing, resolution, time.monotonic() + seconds), start=1):
        known[number] = row
        checkpoint.add(f"{contents}/{number}", row)
        if progress is not None:
            progress(done, len(missing))
    not_run: Row = {**dict.fromkeys(NUMBERS, math.nan), "status": float(Status.NOT_RUN)}
    dataset = study_dataset(design, {number: known.get(number, not_run) for number in conditions})
    dataset.attrs |= {name: int(v) if isinstance(v, bool) else v for name, v in asdict(resolution).items()}
    dataset.attrs["model_version"] = MODEL_VERSION
    write_netcdf(dataset, target, {str(name): {"zlib": True} for name in dataset.data_vars})
    return dataset


def study_dataset(design: Design, rows: dict[int, Row]) -> xr.Dataset:
    """Return rows as a labelled dataset over the dimension ``combination``, failed ones included.

    Variables: the condition, ``status``, ``friction_coefficient`` and its parts by film and asperities,
    ``asperity_share``, ``mean_film``, ``smooth_film`` (smallest of the smooth surfaces), ``lambda_ratio``,
    ``certified_share``, and the cost; ``failure``, what went wrong, if a case has failed.

    Examples
    --------
    >>> row = run_case(Design().condition(31499), Resolution(fewest=97))
    >>> study = study_dataset(Design(), {31499: row})
    >>> dict(study.sizes), study["temperature"].item()
    ({'combination': 1}, 100.0)
    """
    cases = [asdict(design.condition(number)) for number in rows]
    names = list(asdict(design.condition(0)))
    renamed = {"hertz_pressure": "contact_pressure", "equivalent_radius": "contact_radius"}
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
    messages = np.array([str(row.get("message", "")) for row in rows.values()])
    if any(messages):
        data["failure"] = ("combination", messages)
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
        message = f"dask is not installed: {how_to_install('easeoff[dask]')}; or run without it"
        raise MissingPackageError(message) from error
    batch = 8 * (os.cpu_count() or 1)
    todo = list(conditions)
    # With a distributed client its scheduler is the default; without one, processes: the work holds the interpreter.
    scheduler = {} if engine.config.get("scheduler", None) else {"scheduler": "processes"}
    for at in range(0, len(todo), batch):
        if time.monotonic() > deadline:
            return
        part = todo[at : at + batch]
        tasks = [engine.delayed(run_case)(conditions[number], resolution) for number in part]
        with child_environment():
            rows = engine.compute(*tasks, **scheduler)
        yield from zip(part, rows, strict=True)


def _check_is_study(target: Path) -> None:
    """Refuse to overwrite a file that is something else."""
    if not target.exists():
        return
    with suppress(InputError):
        if {"combination", "status", "friction_coefficient"} <= set(read_dataset(target).variables):
            return
    raise InputError(f"{target} exists and is no study: it would be overwritten; give another name, or remove it")
