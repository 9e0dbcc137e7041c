"""Distributions of swept coordinates, and samples of them by low-discrepancy sequences."""

from __future__ import annotations

import math
import re
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any, Literal, get_args

import numpy as np
from numpy.typing import NDArray

from ...core.checks import array, instance, number, one_of, shown, whole
from ...core.errors import InputError

Array = NDArray[np.float64]
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
    """Distribution of a swept coordinate.

    Parameters
    ----------
    kind
        ``normal``, ``uniform`` or ``triangular``.
    parameters
        Mean and standard deviation; least and greatest value; least value, mode and greatest value.

    Raises
    ------
    InputError
        If there is no such kind, or the parameters are not those of it.

    Examples
    --------
    >>> Distribution("uniform", (-0.1, 0.1)).quantile(np.array([0.0, 0.75])).round(12).tolist()
    [-0.1, 0.05]
    >>> Distribution.parsed("normal(0, 0.03)").text
    'normal(0.0, 0.03)'
    """

    kind: str
    parameters: tuple[float, ...]

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
        found = TEXT.fullmatch(text)
        try:
            parameters = tuple(float(part) for part in found[2].split(",")) if found else ()
        except ValueError:
            found = None
        if found is None:
            kinds = ", ".join(f"{kind}({', '.join(names)})" for kind, names in PARAMETERS.items())
            raise InputError(f"{shown(text)}: must be one of {kinds}; decimals have a point")
        return cls(found[1], parameters)

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
    """Values (n) of every distributed coordinate.

    Parameters
    ----------
    distributions
        By coordinate.
    count
        Number of samples; of the Sobol sequence a power of two is balanced.
    seed
        Of the scrambling or of the permutations; the same seed gives the same samples.
    sampler
        ``sobol`` (scrambled) or ``latin_hypercube``, by ``scipy.stats.qmc``.

    Raises
    ------
    InputError
        If a number is out of range, or there is no such sampler.

    Examples
    --------
    >>> drawn = sample_values({"E": Distribution("uniform", (0.0, 1.0))}, 8)
    >>> sorted(int(8 * value) for value in drawn["E"])  # one in every eighth
    [0, 1, 2, 3, 4, 5, 6, 7]
    """
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
    return {name: found.quantile(drawn[:, i]) for i, (name, found) in enumerate(distributions.items())}
