"""Plan of a sweep: its axes, its points in the order of the work, and what is the same at all of them.

An axis is a coordinate over its values, or coordinates that go together, as of samples and load cases.
"""

from __future__ import annotations

import hashlib
import json
import math
import os
import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, fields, replace
from functools import cached_property
from importlib.metadata import version
from pathlib import Path
from typing import Any, Literal, get_args

import numpy as np
import xarray as xr
from numpy.typing import NDArray

from ...cases.analysis_size import AnalysisSize
from ...cases.schema.case_schema import Case
from ...cases.shipped_files import shipped_deviations
from ...cases.table_rows import read_table_rows
from ...contact.solvers import require_solver
from ...core.arrays import Array, RealArray, record
from ...core.checks import array, instance, number, one_of, shown, whole
from ...core.errors import InputError
from ...core.memory import require_memory
from ...core.regular_file import TABLE_SIZE_LIMIT, leads_outside, require_file
from ...friction.lubricants.lubricant import is_shipped, lubricant
from ...geometry.deviation.deviation import Deviation
from ..analysis.contact_analysis import case_torques
from ..analysis.operating import Friction, FrictionConditions, Operating, analysis_size
from ..analysis.swept_quantity import CONDITIONS, Stage, SweptQuantity, swept_quantity
from ..case_in_mesh import FlanksInMesh, checked_case, prepared_pair
from ..deviations import flank_deviations

Sampler = Literal["sobol", "latin_hypercube"]
SAMPLE_COUNT_LIMIT = 2**24
TEXT = re.compile(r"\s*~?\s*([a-z]+)\s*\(([^()]*)\)\s*")
#: Parameters of every kind of distribution.
PARAMETERS = {
    "normal": ("mean", "standard_deviation"),
    "uniform": ("least", "greatest"),
    "triangular": ("least", "mode", "greatest"),
}


@dataclass(frozen=True)
class Distribution:
    """Distribution of a swept coordinate: ``normal``, ``uniform`` or ``triangular``."""

    kind: str
    parameters: tuple[float, ...]  # mean and standard deviation; least, greatest; least, mode, greatest

    def __post_init__(self) -> None:
        names = PARAMETERS[one_of("distribution", self.kind, PARAMETERS)]
        array("parameters of a distribution", self.parameters, ndim=1)
        wanted = f"{self.kind}({', '.join(names)})"
        if len(self.parameters) != len(names):
            raise InputError(f"{self.text}: must be {wanted}")
        for name, value in zip(names, self.parameters, strict=True):
            number(f"{name} in {self.text}", value)
        if self.kind == "normal":
            number(f"standard_deviation in {self.text}", self.parameters[1], above=0.0)
        elif not (list(self.parameters) == sorted(self.parameters) and self.parameters[0] < self.parameters[-1]):
            raise InputError(f"{self.text}: must be {wanted} with numbers that rise")

    @classmethod
    def parsed(cls, text: str) -> Distribution:
        """Distribution of a text such as ``normal(0, 0.03)``; raises InputError if it is none."""
        instance("distribution", text, str)
        match = TEXT.fullmatch(text)
        try:
            parameters = tuple(float(part) for part in match[2].split(",")) if match else ()
        except ValueError:
            match = None
        if match is None:
            kinds = ", ".join(f"{kind}({', '.join(names)})" for kind, names in PARAMETERS.items())
            raise InputError(f"{shown(text)}: must be one of {kinds}; decimals have a point")
        return cls(match[1], parameters)

    @property
    def text(self) -> str:
        """The distribution as it is written."""
        return f"{self.kind}({', '.join(map(repr, map(float, self.parameters)))})"

    def quantile(self, probability: RealArray) -> RealArray:
        """Values (n) that are not exceeded with given probabilities (n)."""
        from scipy import stats

        first, *others, last = self.parameters
        if self.kind == "normal":
            return np.asarray(stats.norm.ppf(probability, first, last))
        if self.kind == "uniform":
            return np.asarray(first + (last - first) * probability)
        mode = (others[0] - first) / (last - first)
        return np.asarray(stats.triang.ppf(probability, mode, first, last - first))


def sample_values(
    distributions: Mapping[str, Distribution], count: int, *, seed: int = 0, sampler: Sampler = "sobol"
) -> dict[str, RealArray]:
    """Values (n) of every distributed coordinate, by ``scipy.stats.qmc``; Sobol samples balance at powers of two."""
    from scipy.stats import qmc

    whole("samples", count, 1, SAMPLE_COUNT_LIMIT)
    whole("seed", seed, 0, 2**63 - 1)
    one_of("sampler", sampler, get_args(Sampler))
    dimensions = len(distributions)
    engine: Any
    if sampler == "sobol":
        engine = qmc.Sobol(dimensions, scramble=True, seed=seed)
        drawn = engine.random_base2(math.ceil(math.log2(count)))[:count]
    else:
        engine = qmc.LatinHypercube(dimensions, seed=seed)
        drawn = engine.random(count)
    # The ends of the unit interval, which a scrambled sequence may hit, are no probabilities of a normal distribution.
    drawn = np.clip(drawn, 2.0**-33, 1.0 - 2.0**-33)
    return {name: distribution.quantile(drawn[:, i]) for i, (name, distribution) in enumerate(distributions.items())}


VALUE_COUNT_LIMIT = 10_000_000
DIGIT_COUNT = 14  # of the greatest value of an even grid


@record(frozen=True)
class Axis:
    """A dimension of a sweep with its coordinates."""

    name: str  # that of its coordinate, ``sample`` or ``load_case``
    columns: Mapping[str, NDArray[Any]]

    @property
    def size(self) -> int:
        """Number of points along the axis."""
        return next(iter(self.columns.values())).size


def is_distribution(values: Any) -> bool:
    """True if the values of a coordinate are a distribution, or the text of one."""
    return isinstance(values, Distribution) or (isinstance(values, str) and "(" in values)


def column(quantity: SweptQuantity, values: Sequence[Any] | NDArray[Any]) -> NDArray[Any]:
    """Values of a quantity as an array; InputError if there are none, too many, or one is not possible."""
    if not 1 <= len(values) <= VALUE_COUNT_LIMIT:
        raise InputError(f"{quantity.name}: must have from 1 to {VALUE_COUNT_LIMIT} values, has {len(values)}")
    return np.array([quantity.checked(value) for value in values])


def grid_axis(name: str, values: Any) -> Axis:
    """Axis of one coordinate of ``swept_quantity``, its values possible and distinct.

    They are numbers or words in a row; or a text: FROM:TO:COUNT, evenly spaced, or values separated by commas.
    """
    quantity = swept_quantity(name)
    if quantity.stage == Stage.NOTHING:
        raise InputError(f"{name}: is a column of load cases and cannot be swept")
    listed = _listed(quantity, values) if isinstance(values, str) else np.atleast_1d(np.asarray(values, dtype=object))
    if np.ndim(listed) != 1:
        raise InputError(f"{name} = {shown(values)}: must be values in a row")
    coordinates = column(quantity, listed)
    different, counts = np.unique(coordinates, return_counts=True)
    if different.size != coordinates.size:
        raise InputError(f"{name}: {shown(different[counts > 1][0].item())} comes twice")
    return Axis(name, {name: coordinates})


def _listed(quantity: SweptQuantity, text: str) -> Sequence[Any]:
    """Values of a text."""
    parts = [part.strip() for part in text.split(",")]
    if quantity.words:
        return parts
    if ":" in text:
        wanted = "FROM:TO:COUNT, such as -0.1:0.1:9"
        try:
            first, last, count = text.split(":")
            start, stop, steps = float(first), float(last), int(count)
        except ValueError:
            raise InputError(f"{quantity.name} = {shown(text)}: must be {wanted}") from None
        if not 2 <= steps <= VALUE_COUNT_LIMIT:
            raise InputError(f"{quantity.name} = {shown(text)}: COUNT must lie between 2 and {VALUE_COUNT_LIMIT}")
        for end in (start, stop):
            quantity.checked(end)
        # Decimal numbers as they would be typed: -0.2:0.2:9 has 0.05 in it, not 0.05000000000000002.
        digits = DIGIT_COUNT - math.ceil(math.log10(max(abs(start), abs(stop), 1e-300)))
        return [round(value, digits) for value in np.linspace(start, stop, steps).tolist()]
    try:
        return [float(part) for part in parts]
    except ValueError:
        raise InputError(
            f"{quantity.name} = {shown(text)}: must be numbers separated by commas, FROM:TO:COUNT, or a distribution "
            "such as normal(0,0.03)"
        ) from None


LOAD_CASE = "load_case"
FILES = ("oil", "deviation.pinion", "deviation.gear")  # columns that name files


def read_load_case_axis(path: str | Path, *, allow_outside: bool = False) -> Axis:
    """Load cases of a table in CSV, read by ``read_table_rows``; no cell is empty.

    Columns are quantities of ``swept_quantity``, ``share`` and ``name``: those of a table of load cases for ``run``,
    and more. Only with ``allow_outside`` may it name oils and deviations outside its folder: it may be anybody's.
    """

    def checked(row: Mapping[str, Any]) -> dict[str, Any]:
        for name in FILES:
            if name in row and not allow_outside:
                _require_inside(path, name, row[name])
        return {name: swept_quantity(name).checked(value) for name, value in row.items()}

    rows = read_table_rows(
        path, lambda column: swept_quantity(column).words, checked, size_limit=TABLE_SIZE_LIMIT, complete=True
    )
    return load_case_axis({name: [row[name] for row in rows] for name in rows[0]})


def _require_inside(path: str | Path, name: str, value: str) -> None:
    """Refuse a file outside the folder of the table, and say nothing of it."""
    is_known = is_shipped(value) if name == "oil" else value in shipped_deviations()
    if not is_known and leads_outside(os.path.dirname(os.path.abspath(path)), os.path.abspath(value)):
        raise InputError(
            f"{name} = {shown(value)}: must be a shipped one, or a file inside the folder of the table; if you trust "
            "the table, --allow-outside (in Python columns in place of a file) opens files elsewhere"
        )


def load_case_axis(columns: Any) -> Axis:
    """Load cases from values (n) by the names of their columns, which are known and equally long."""
    table = {str(name): column(swept_quantity(str(name)), list(values)) for name, values in dict(columns).items()}
    if not any(swept_quantity(name).stage < Stage.NOTHING for name in table):
        raise InputError(
            f"load cases: must have a column that changes something, as torque or E; has {shown(list(table))}"
        )
    if len({values.size for values in table.values()}) > 1:
        raise InputError("load cases: the columns must be equally long")
    if "share" in table and not (np.all(table["share"] >= 0.0) and table["share"].sum() > 0.0):
        raise InputError("share: must be numbers of 0 or more, not all 0")
    return Axis(LOAD_CASE, table)


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
        names = ["" if axis.name in axis.columns else f"s of {', '.join(axis.columns)}" for axis in self.axes]
        sizes = [f"{axis.size} {axis.name}{of}" for axis, of in zip(self.axes, names, strict=True)]
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
