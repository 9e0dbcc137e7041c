"""Axes of a sweep: a coordinate over its values, or coordinates that go together, as of samples and load cases.

Distributions of swept coordinates, and samples of them by low-discrepancy sequences.

Load cases of a sweep from a table in CSV, a row a point.
"""

from __future__ import annotations

import math
import os
import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Literal, get_args

import numpy as np
from numpy.typing import NDArray

from ...cases.shipped_files import shipped_deviations
from ...cases.table_rows import read_table_rows
from ...core.arrays import RealArray as Array, record
from ...core.checks import array, instance, number, one_of, shown, whole
from ...core.errors import InputError
from ...core.regular_file import TABLE_SIZE_LIMIT, leads_outside
from ...friction.lubricants.lubricant import is_shipped
from ..analysis.swept_quantity import Stage, SweptQuantity, swept_quantity

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

    def quantile(self, probability: Array) -> Array:
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
) -> dict[str, Array]:
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
