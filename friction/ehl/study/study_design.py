"""Parameter study of friction with the film model: its design, its cases and its rows.

The design (the dissertation's tables 5.1 and 5.2) has levels, an oil, and space-filling subsets. A case, one set of
conditions, makes one row of a labelled dataset; rows done before are taken from a checkpoint.
"""

from __future__ import annotations

import importlib
import math
import operator
import os
import time
from collections.abc import Callable, Iterable, Iterator
from contextlib import suppress
from dataclasses import asdict, dataclass, field, fields
from functools import cached_property, lru_cache
from itertools import combinations_with_replacement
from pathlib import Path
from typing import Any, Literal

import numpy as np
import xarray as xr
from numpy.typing import NDArray
from scipy.stats import qmc

from ....core import checks
from ....core.attributes import labelled
from ....core.checkpoint import Checkpoint, digest
from ....core.checks import bounded
from ....core.errors import EaseoffError, InputError, MissingPackageError, how_to_install
from ....core.netcdf_file import read_dataset, write_netcdf
from ....core.output_file import check_writable
from ....core.process_settings import child_environment
from ...conditions import STEEL_MODULUS
from ...lubricants.lubricant import lubricant
from ..asperities import Asperities, generated_profile
from ..film import FEWEST_NODES, MOST_NODES, Film, domain, mixed_film, smooth_film
from ..lubricated_contact import PRESSURE_PARAMETER_LIMIT, LubricatedContact, Oil
from ..passage import ROUGH_INLET_GAP_RATIO, TOUCHING_FILM, rough_passage
from ..reynolds_equation import Status
from ..shear_traction import BOUNDARY_FRICTION, traction

#: Not in the dissertation: Eyring stress of a usual gear oil [Pa].
EYRING_STRESS = 5e6
#: Units of the parameters and their ranges in these units: the oil is known at these temperatures, and beyond the
#: pressure nothing is a Hertz contact of steel (``LubricatedContact`` refuses it).
LEVELS = {
    "hertz_pressure": bounded("GPa", above=0.0, most=PRESSURE_PARAMETER_LIMIT * STEEL_MODULUS * 1e-9),
    "equivalent_radius": bounded("mm", above=0.0),
    "rolling_velocity": bounded("m/s", above=0.0),
    "slide_to_roll": bounded(least=-2.0, most=2.0),
    "temperature": bounded("degC", least=25.0, most=100.0),
    "roughness": bounded("um", above=0.0),
}


def oil_75w90(temperature: float) -> Oil:
    """Oil of the dissertation (its table 5.2) at a temperature from 25 to 100 degC; refused beyond."""
    checks.number("temperature", temperature, "degC")
    return Oil.of(
        # As the stored studies have it, in which levels between the temperatures of the table count.
        lubricant("75w90").at(temperature, interpolation="log_linear"),
        eyring_stress=EYRING_STRESS,
        law="two_slope",
        inlet_temperature=temperature,
    )


@dataclass(frozen=True)
class Condition:
    """One combination of the study, in its units, checked against the range of a contact and of the oil."""

    hertz_pressure: float = field(metadata=LEVELS["hertz_pressure"])
    equivalent_radius: float = field(metadata=LEVELS["equivalent_radius"])
    rolling_velocity: float = field(metadata=LEVELS["rolling_velocity"])
    slide_to_roll: float = field(metadata=LEVELS["slide_to_roll"])
    temperature: float = field(metadata=LEVELS["temperature"])  # oil in the inlet
    roughness_1: float = field(metadata=LEVELS["roughness"])  # rms
    roughness_2: float = field(metadata=LEVELS["roughness"])

    def __post_init__(self) -> None:
        checks.check_fields(self)

    @property
    def contact(self) -> LubricatedContact:
        """The line contact between steel bodies."""
        return LubricatedContact(
            hertz_pressure=1e9 * self.hertz_pressure,
            equivalent_radius=1e-3 * self.equivalent_radius,
            rolling_velocity=self.rolling_velocity,
            oil=oil_75w90(self.temperature),
            slide_to_roll=self.slide_to_roll,
            contact_modulus=STEEL_MODULUS,
        )

    @property
    def composite_roughness(self) -> float:
        """Root of the sum of the squares of both rms heights [m]."""
        return 1e-6 * math.hypot(self.roughness_1, self.roughness_2)


@dataclass(frozen=True)
class Design:
    """Levels of a study; by default those of the dissertation, 31,500 combinations.

    Each pair of roughnesses occurs once, the smoother surface first: 15 pairs of 5 levels.

    Raises
    ------
    InputError
        If a parameter has no levels, or one that a ``Condition`` cannot have.

    Examples
    --------
    >>> Design().size, Design(temperature=(90.0,)).size
    (31500, 7875)
    """

    hertz_pressure: tuple[float, ...] = (0.5, 1.0, 1.5, 2.0, 2.5)
    equivalent_radius: tuple[float, ...] = (5.0, 20.0, 40.0)
    rolling_velocity: tuple[float, ...] = (1.0, 5.0, 10.0, 15.0, 20.0)
    slide_to_roll: tuple[float, ...] = (0.025, 0.05, 0.1, 0.25, 0.5, 0.75, 1.0)
    temperature: tuple[float, ...] = (25.0, 50.0, 75.0, 100.0)
    roughness: tuple[float, ...] = (0.1, 0.35, 0.6, 0.85, 1.0)

    def __post_init__(self) -> None:
        for name, bounds in LEVELS.items():
            levels = getattr(self, name)
            if not isinstance(levels, list | tuple | np.ndarray) or getattr(levels, "ndim", 1) != 1 or not len(levels):
                raise InputError(f"{name} = {checks.shown(levels)}: must be levels in a row, such as (1.0, 2.0)")
            object.__setattr__(self, name, tuple(checks.number(name, level, **bounds) for level in levels))

    @cached_property
    def _axes(self) -> tuple[tuple[Any, ...], ...]:
        *single, roughness = (getattr(self, name) for name in LEVELS)
        return (*single, tuple(combinations_with_replacement(roughness, 2)))

    @property
    def shape(self) -> tuple[int, ...]:
        """Number of levels of each parameter; the last is that of the pairs of roughnesses."""
        return tuple(len(axis) for axis in self._axes)

    @property
    def size(self) -> int:
        """Number of combinations."""
        return math.prod(self.shape)

    def condition(self, number: int) -> Condition:
        """Return a combination by its number, from 0; the last parameter changes fastest.

        Raises
        ------
        InputError
            If there is no such combination.
        """
        levels = np.unravel_index(checks.whole("number", number, 0, self.size - 1), self.shape)
        *single, pair = (axis[int(level)] for axis, level in zip(self._axes, levels, strict=True))
        return Condition(*single, *pair)

    def subset(self, size: int, seed: int = 0) -> NDArray[np.int_]:
        """Choose combinations that fill the space of the parameters evenly.

        Parameters
        ----------
        size
            Number of combinations.
        seed
            Of the scrambling.

        Returns
        -------
        (size) int array
            Their numbers, all different, in the order of a scrambled Sobol sequence over the levels (points that fall
            on a combination again are skipped): the first of a long subset are a good short one.

        Raises
        ------
        InputError
            If more than there are, or none; or the seed is no whole number.
        """
        size = checks.whole("size", size, 1, self.size)
        checks.whole("seed", seed, 0)
        if size == self.size:
            return np.arange(size)
        sequence = qmc.Sobol(len(self.shape), seed=seed)
        chosen: dict[int, None] = {}
        while len(chosen) < size:
            levels = (sequence.random(1024) * self.shape).astype(int)
            for number in np.ravel_multi_index(tuple(levels.T), self.shape):
                chosen.setdefault(int(number))
        return np.array(list(chosen)[:size])


#: The levels of the dissertation and others between them: what a formula needs that holds between the former as well.
REFINED = Design(
    hertz_pressure=(0.5, 0.6, 0.75, 0.9, 1.0, 1.25, 1.5, 1.75, 2.0, 2.25, 2.5),
    equivalent_radius=(5.0, 7.0, 10.0, 14.0, 20.0, 28.0, 40.0),
    rolling_velocity=(1.0, 1.5, 2.0, 3.0, 5.0, 7.0, 10.0, 12.0, 15.0, 17.0, 20.0),
    slide_to_roll=(0.025, 0.035, 0.05, 0.07, 0.1, 0.15, 0.25, 0.35, 0.5, 0.75, 1.0),
    temperature=(25.0, 30.0, 37.5, 45.0, 50.0, 55.0, 62.5, 70.0, 75.0, 82.5, 90.0, 100.0),
    roughness=(0.1, 0.15, 0.2, 0.35, 0.5, 0.6, 0.7, 0.85, 1.0),
)


def numbers(design: Design, wanted: Iterable[int] | int | None) -> NDArray[np.int_]:
    """Numbers of the wanted combinations: given ones, a subset of a size, or all."""
    if wanted is None:
        return np.arange(design.size)
    if _is_whole(wanted):
        return design.subset(operator.index(wanted))  # type: ignore[arg-type]
    try:
        given = list(wanted)  # type: ignore[arg-type]
    except TypeError:
        given = []
    if not given or not all(map(_is_whole, given)):
        raise InputError(
            f"wanted = {checks.shown(wanted)}: must be a number of cases, numbers of combinations, or None for all"
        )
    return np.array([operator.index(number) for number in given], dtype=int)


def _is_whole(value: Any) -> bool:
    return isinstance(value, int | np.integer) and not isinstance(value, bool)


#: Of the model and its numerics. To be raised with every change that changes results: rows of another version that a
#: study finds on disk are not used.
MODEL_VERSION = 2
#: A case whose certified steps are fewer than this share is not converged.
CERTIFIED_SHARE_MINIMUM = 0.9
#: Lubricant that the others may make or lose, of all that flows through.
LEAKAGE_LIMIT = 0.01
RAMP_STEPS = 20


@dataclass(frozen=True)
class Resolution:
    """Model, assumptions and grid of a study.

    Parameters
    ----------
    model
        ``load_sharing``: roughness by its statistics, see ``Asperities``, which needs ``correlation_length``,
        ``fewest``, ``boundary_friction`` and ``thermal`` alone of what follows. ``passage``: profiles that move through
        the contact, see ``rough_passage``.
    correlation_length
        Of the roughness of both surfaces [m].
    points
        Grid spacings in a correlation length.
    fewest, most
        Bounds of the number of nodes. Where the upper one cuts in, the profile is coarser.
    travel
        How far the mean flow moves while averages are taken: as many correlation lengths, or one half width of the
        contact if that is more. Before, it moves from the inlet to the middle.
    smooth_from
        Lambda ratio from which on the smooth film stands for the rough one.
    flooded
        See ``domain``.
    order
        Of the differences in space and time, see ``rough_passage``.
    seed
        Of the profiles; the surfaces have different ones.
    touching_film, boundary_friction
        [m], [1].
    thermal
        Lower the viscosity in the shear stress by the film's own heat.

    Raises
    ------
    InputError
        If there is no such model, or a number cannot be used.

    Examples
    --------
    >>> Resolution(model="passage", fewest=97).most
    1025
    """

    model: Literal["load_sharing", "passage"] = "load_sharing"
    correlation_length: float = field(default=20e-6, metadata=bounded("m", above=0.0))
    points: float = field(default=3.0, metadata=bounded(above=0.0))
    fewest: int = field(default=257, metadata=bounded(least=FEWEST_NODES, most=MOST_NODES))
    most: int = field(default=1025, metadata=bounded(least=FEWEST_NODES, most=MOST_NODES))
    travel: float = field(default=30.0, metadata=bounded(least=0.0))
    smooth_from: float = field(default=3.0, metadata=bounded(least=0.0, infinite=True))
    flooded: float = field(default=ROUGH_INLET_GAP_RATIO, metadata=bounded(above=1.0))
    order: int = field(default=2, metadata=bounded(least=1, most=2))
    seed: int = 1
    touching_film: float = field(default=TOUCHING_FILM, metadata=bounded("m", above=0.0))
    boundary_friction: float = field(default=BOUNDARY_FRICTION, metadata=bounded(least=0.0))
    thermal: bool = True

    def __post_init__(self) -> None:
        checks.check_fields(self)
        if self.model == "passage":
            checks.whole("most", self.most, self.fewest, MOST_NODES)


Row = dict[str, float]

#: Numbers of a row besides the condition and the status; NaN where there is no answer.
NUMBERS = (
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
    """Row of one combination: ``status`` and the numbers of the dataset, in its units.

    Where the model or its arithmetic fails, the status is ``FAILED`` with a ``message``; a mistake in the program
    raises.
    """
    checks.instance("condition", condition, Condition)
    resolution = Resolution() if resolution is None else resolution
    checks.instance("resolution", resolution, Resolution)
    start = time.perf_counter()
    row: Row = {**dict.fromkeys(NUMBERS, math.nan), "status": float(Status.FAILED)}
    try:
        row.update(_computed(condition, resolution))
    except (EaseoffError, ArithmeticError, np.linalg.LinAlgError) as error:  # the study goes on
        row["message"] = f"{type(error).__name__}: {error}"  # type: ignore[assignment]
    row["run_time"] = time.perf_counter() - start
    return row


def _computed(condition: Condition, resolution: Resolution) -> Row:
    contact = condition.contact
    smooth = _smooth_film(contact)
    if not smooth.certified:
        return {"status": float(Status.NOT_CONVERGED)}
    film = smooth.minimum_film
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
    cost = {"newton_steps": float(film.iterations), "nodes": float(film.position.size)}
    unknown = cost | {"status": float(Status.NOT_CONVERGED), "certified_share": 0.0}
    if not film.certified:
        return unknown
    shear = traction(
        film.contact,
        film.position,
        film.pressure - film.asperity_pressure,
        film.film,
        asperity_pressure=film.asperity_pressure,
        boundary_friction=resolution.boundary_friction,
        thermal=resolution.thermal,
    )
    if not math.isfinite(shear.film):
        return unknown
    within = np.abs(film.position) < film.contact.half_width
    return cost | {
        "status": float(Status.CERTIFIED),
        "certified_share": 1.0,
        "film_friction": shear.film,
        "asperity_friction": shear.asperities,
        "asperity_share": film.asperity_share,
        "mean_film": 1e6 * float(film.film[within].mean()),
    }


def _rough(condition: Condition, contact: LubricatedContact, resolution: Resolution) -> Row:
    span = domain(contact, resolution.flooded)
    length = (span[1] - span[0]) * contact.half_width
    wanted = math.ceil(resolution.points * length / resolution.correlation_length) + 1
    nodes = min(max(wanted, resolution.fewest), resolution.most)
    spacing = length / (nodes - 1)
    settle = max(RAMP_STEPS, math.ceil(-span[0] * contact.half_width / spacing))
    averaged = math.ceil(max(resolution.travel * resolution.correlation_length, contact.half_width) / spacing)
    period = max(2.0 * length, 50.0 * resolution.correlation_length)
    first, second = (
        generated_profile(1e-6 * rms, resolution.correlation_length, period, 2 * resolution.seed + number)
        for number, rms in enumerate((condition.roughness_1, condition.roughness_2))
    )
    passage = rough_passage(
        contact,
        first,
        second,
        steps=settle + averaged,
        nodes=nodes,
        ramp=RAMP_STEPS,
        settle=settle,
        span=span,
        touching_film=resolution.touching_film,
        order=resolution.order,
        boundary_friction=resolution.boundary_friction,
        thermal=resolution.thermal,
    )
    enough = passage.certified_share >= CERTIFIED_SHARE_MINIMUM and passage.leakage <= LEAKAGE_LIMIT
    known = enough and math.isfinite(passage.friction_coefficient)
    return {
        "status": float(Status.CERTIFIED if known else Status.NOT_CONVERGED),
        **{name: passage.average(name) for name in ("film_friction", "asperity_friction", "asperity_share")},
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
    write_netcdf(dataset, target)
    return dataset


def study_dataset(design: Design, rows: dict[int, Row]) -> xr.Dataset:
    """Rows as a labelled dataset over ``combination``; failed ones are included, with their ``failure``."""
    cases = [asdict(design.condition(number)) for number in rows]
    renamed = {"hertz_pressure": "contact_pressure", "equivalent_radius": "contact_radius"}
    data: dict[str, Any] = {
        renamed.get(one.name, one.name): ("combination", np.array([case[one.name] for case in cases], dtype=float))
        for one in fields(Condition)
    }
    data |= {name: ("combination", np.array([row[name] for row in rows.values()], dtype=float)) for name in NUMBERS}
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
