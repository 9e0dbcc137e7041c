"""Running the parameter study: one row a combination, kept on disk as soon as it is known, labelled at the end."""

from __future__ import annotations

import importlib
import json
import math
import os
import time
from collections.abc import Callable, Iterable, Iterator
from dataclasses import asdict, dataclass
from functools import lru_cache
from pathlib import Path
from typing import Any, Literal

import numpy as np
import xarray as xr

from ...core.attributes import labelled
from ...core.errors import InputError, MissingPackageError
from ...core.files import check_writable, whole_file
from .certificate import Status
from .conditions import LineContact
from .design import Condition, Design, numbers
from .load_sharing import Asperities
from .moving import FLOODED, TOUCHING_FILM, rough_passage
from .roughness import generated_profile
from .shear import BOUNDARY_FRICTION, traction
from .steady import Film, domain, mixed_film, smooth_film

#: A case whose certified steps are fewer than this share is not converged.
ENOUGH_STEPS = 0.9
_RAMP = 20


@dataclass(frozen=True)
class Resolution:
    """What the study assumes beyond the conditions, and how finely it computes.

    Attributes
    ----------
    model : {"load_sharing", "passage"}
        Roughness by its statistics, see `load_sharing`, or profiles that move through the contact, see `moving`. The
        former needs `correlation_length`, `fewest`, `boundary_friction` and `thermal` alone of what follows.
    correlation_length : float
        Of the roughness of both surfaces [m].
    points : float
        Grid spacings in a correlation length.
    fewest, most : int
        Bounds of the number of nodes. Where the upper one cuts in, the profile is coarser.
    travel : float
        How far the mean flow moves while averages are taken: as many correlation lengths, or one half width of the
        contact if that is more. Before, it moves from the inlet to the middle.
    smooth_from : float
        Lambda ratio from which on the smooth film stands for the rough one.
    flooded : float
        See `steady.domain`.
    order : int
        Of the differences in space and time, see `moving.rough_passage`.
    seed : int
        Of the profiles; the surfaces have different ones.
    touching_film, boundary_friction : float
        [m], [1].
    thermal : bool
        Lower the viscosity in the shear stress by the film's own heat.
    """

    model: Literal["load_sharing", "passage"] = "load_sharing"
    correlation_length: float = 20e-6
    points: float = 3.0
    fewest: int = 257
    most: int = 1025
    travel: float = 30.0
    smooth_from: float = 3.0
    flooded: float = FLOODED
    order: int = 2
    seed: int = 1
    touching_film: float = TOUCHING_FILM
    boundary_friction: float = BOUNDARY_FRICTION
    thermal: bool = True


Row = dict[str, float]

#: Numbers of a row besides the condition and the status; NaN where there is no answer.
_NUMBERS = (
    "film_friction",
    "asperity_friction",
    "asperity_share",
    "mean_film",
    "smooth_film",
    "lambda_ratio",
    "certified_share",
    "newton_steps",
    "nodes",
    "run_time",
)


def run_case(condition: Condition, resolution: Resolution | None = None) -> Row:
    """Compute one combination.

    Returns
    -------
    dict
        `status` and the numbers of the dataset, in its units. A case that fails is a row with its status.
    """
    resolution = resolution or Resolution()
    start = time.perf_counter()
    row: Row = {**dict.fromkeys(_NUMBERS, math.nan), "status": float(Status.FAILED)}
    try:
        row.update(_computed(condition, resolution))
    except Exception as error:  # the study goes on; what went wrong is in the row
        row["message"] = f"{type(error).__name__}: {error}"  # type: ignore[assignment]
    row["run_time"] = time.perf_counter() - start
    return row


def _computed(condition: Condition, resolution: Resolution) -> Row:
    contact = condition.contact
    smooth = _smooth_film(contact)
    film = smooth.minimum_film if smooth.certified else math.nan
    row = {"smooth_film": 1e6 * film, "lambda_ratio": film / condition.composite_roughness}
    if resolution.model == "load_sharing":
        roughness = Asperities(condition.composite_roughness, resolution.correlation_length)
        return row | _steady(mixed_film(contact, roughness, nodes=resolution.fewest), resolution)
    if row["lambda_ratio"] >= resolution.smooth_from:
        return row | _steady(smooth, resolution)
    return row | _rough(condition, contact, resolution)


#: Cases in a row often differ by the roughness alone.
_smooth_film = lru_cache(maxsize=8)(smooth_film)


def _steady(film: Film, resolution: Resolution) -> Row:
    shear = traction(
        film.contact,
        film.position,
        film.pressure - film.asperity_pressure,
        film.film,
        asperity_pressure=film.asperity_pressure,
        boundary_friction=resolution.boundary_friction,
        thermal=resolution.thermal,
    )
    settled = film.certified and math.isfinite(shear.film)
    within = np.abs(film.position) < film.contact.half_width
    numbers = {
        "film_friction": shear.film,
        "asperity_friction": shear.asperities,
        "asperity_share": film.asperity_share,
        "mean_film": 1e6 * float(film.film[within].mean()),
    }
    return (numbers if settled else {}) | {
        "status": float(Status.CERTIFIED if settled else Status.NOT_CONVERGED),
        "certified_share": float(settled),
        "newton_steps": float(film.iterations),
        "nodes": float(film.position.size),
    }


def _rough(condition: Condition, contact: LineContact, resolution: Resolution) -> Row:
    span = domain(contact, resolution.flooded)
    length = (span[1] - span[0]) * contact.half_width
    wanted = math.ceil(resolution.points * length / resolution.correlation_length) + 1
    nodes = min(max(wanted, resolution.fewest), resolution.most)
    spacing = length / (nodes - 1)
    settle = max(_RAMP, math.ceil(-span[0] * contact.half_width / spacing))
    averaged = math.ceil(max(resolution.travel * resolution.correlation_length, contact.half_width) / spacing)
    period = max(2.0 * length, 50.0 * resolution.correlation_length)
    first, second = (
        generated_profile(1e-6 * rms, resolution.correlation_length, period, seed)
        for rms, seed in (
            (condition.roughness_1, 2 * resolution.seed),
            (condition.roughness_2, 2 * resolution.seed + 1),
        )
    )
    passage = rough_passage(
        contact,
        first,
        second,
        steps=settle + averaged,
        nodes=nodes,
        ramp=_RAMP,
        settle=settle,
        span=span,
        touching_film=resolution.touching_film,
        order=resolution.order,
        boundary_friction=resolution.boundary_friction,
        thermal=resolution.thermal,
    )
    friction = passage.friction_coefficient
    enough = passage.certified_share >= ENOUGH_STEPS and math.isfinite(friction)
    return {
        "status": float(Status.CERTIFIED if enough else Status.NOT_CONVERGED),
        "film_friction": passage.average("film_friction"),
        "asperity_friction": passage.average("asperity_friction"),
        "asperity_share": passage.average("asperity_share"),
        "mean_film": 1e6 * passage.average("mean_film"),
        "certified_share": passage.certified_share,
        "newton_steps": float(passage.iterations.mean()),
        "nodes": float(nodes),
    }


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
    not_run: Row = {**dict.fromkeys(_NUMBERS, math.nan), "status": float(Status.NOT_RUN)}
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
    for name in _NUMBERS:
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
                known[int(entry["number"])] = {**dict.fromkeys(_NUMBERS, math.nan), **entry["row"]}
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
