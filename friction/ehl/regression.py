"""A formula for the friction coefficient, fitted to a study: the fast evaluator for use inside a gear analysis.

ln(mu) is a polynomial of second degree in the logarithms of the groups H = p_h / E', slide-to-roll ratio, U, G and
S = composite rms roughness / radius, of which the lambda ratio is a product of powers for a given film formula. The
formulas of the dissertation (its equation 5.11) have most of these products as well. Terms are taken in one by one, as
long as the error of prediction falls: that of each case by the formula fitted to all others.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import cache
from itertools import combinations_with_replacement
from pathlib import Path

import numpy as np
import xarray as xr
from numpy.typing import ArrayLike, NDArray

from ...core.errors import InputError
from ..conditions import ContactConditions
from .certificate import Status
from .conditions import STEEL
from .design import oil_75w90

Array = NDArray[np.float64]
Term = tuple[int, ...]

#: The groups in the order of the columns.
GROUPS = ("hertz_pressure", "slide_to_roll", "speed", "material", "roughness")
_FEWEST_CASES = 30
#: A further term must lower the error of prediction at least to this part.
_WORTHWHILE = 0.99


#: A space-filling subset of the design of the dissertation, run with the defaults.
SHIPPED = Path(__file__).with_name("study.nc")


@dataclass(frozen=True, eq=False)
class FrictionFormula:
    """Fitted friction coefficient with its range and its errors.

    Attributes
    ----------
    terms : tuple of tuples
        Numbers of the groups that are multiplied, none for the constant.
    coefficients : (k) array
        One a term.
    centre, scale : (5) arrays
        Each logarithm less the centre, over the scale, is a factor of the terms.
    lowest, highest : (5) arrays
        Range of the logarithms of the groups in the study.
    cases : int
    fit_error : float
        Root of the mean square of the error of ln(mu) over the cases of the fit.
    prediction_error : float
        The same with each case predicted from all others.
    worst_error : float
        Largest error of ln(mu) of the latter kind.
    determination : float
        1 - residual over total variance of ln(mu).
    """

    terms: tuple[Term, ...]
    coefficients: Array
    centre: Array
    scale: Array
    lowest: Array
    highest: Array
    cases: int
    fit_error: float
    prediction_error: float
    worst_error: float
    determination: float

    def __call__(
        self,
        hertz_pressure: ArrayLike,
        radius: ArrayLike,
        rolling_velocity: ArrayLike,
        slide_to_roll: ArrayLike,
        viscosity: ArrayLike,
        pressure_viscosity: ArrayLike,
        composite_roughness: ArrayLike,
        reduced_modulus: float = STEEL,
    ) -> tuple[Array, NDArray[np.bool_]]:
        """Friction coefficient, in one call for any number of conditions; arrays are broadcast.

        Parameters
        ----------
        hertz_pressure, radius, rolling_velocity, slide_to_roll, viscosity, pressure_viscosity, composite_roughness
            [Pa], [m], [m/s], [1], [Pa s], [1/Pa], [m]; the last is the root of the sum of the squares of both surfaces.
            The sign of the slide-to-roll ratio does not matter.
        reduced_modulus : float
            [Pa].

        Returns
        -------
        friction_coefficient : array
            [1]. Groups beyond the range of the study are taken at its end.
        inside : bool array
            Where nothing was beyond the range.
        """
        groups = _logarithms(
            hertz_pressure,
            radius,
            rolling_velocity,
            slide_to_roll,
            viscosity,
            pressure_viscosity,
            composite_roughness,
            reduced_modulus,
        )
        slack = 1e-9 * self.scale
        inside = np.all((groups >= self.lowest - slack) & (groups <= self.highest + slack), axis=-1)
        normal = (np.clip(groups, self.lowest, self.highest) - self.centre) / self.scale
        return np.exp(_columns(normal, self.terms) @ self.coefficients), np.asarray(inside)

    def coefficient(self, conditions: ContactConditions) -> Array:
        """Friction coefficient of the segments of a gear analysis: a model that `easeoff.friction` takes."""
        friction, _ = self(
            conditions.hertz_pressure,
            conditions.equivalent_radius,
            conditions.rolling_velocity,
            conditions.slide_to_roll,
            conditions.viscosity,
            conditions.pressure_viscosity,
            conditions.composite_roughness,
            conditions.contact_modulus,
        )
        return friction


@cache
def shipped_formula() -> FrictionFormula:
    """Return the formula fitted to the study that comes with the package."""
    with xr.open_dataset(SHIPPED, engine="netcdf4") as dataset:
        return fit_friction(dataset.load())


def _logarithms(
    pressure: ArrayLike,
    radius: ArrayLike,
    velocity: ArrayLike,
    slide: ArrayLike,
    viscosity: ArrayLike,
    coefficient: ArrayLike,
    roughness: ArrayLike,
    modulus: float,
) -> Array:
    p, r, u, s, eta, alpha, sigma = (
        np.asarray(value, dtype=np.float64)
        for value in (pressure, radius, velocity, slide, viscosity, coefficient, roughness)
    )
    with np.errstate(divide="ignore"):  # nothing slides: taken at the end of the range
        groups = (p / modulus, np.abs(s), eta * u / (modulus * r), alpha * modulus, sigma / r)
        return np.stack(np.broadcast_arrays(*(np.log(group) for group in groups)), axis=-1)


def _columns(normal: Array, terms: tuple[Term, ...]) -> Array:
    # The product over no groups is one: the constant.
    return np.stack([np.prod(normal[..., list(term)], axis=-1) for term in terms], axis=-1)


def study_groups(dataset: xr.Dataset) -> Array:
    """Logarithms of the groups of each case of a study, (cases, 5)."""
    oils = [oil_75w90(float(temperature)) for temperature in dataset["temperature"].values]
    return _logarithms(
        1e9 * dataset["contact_pressure"].values,
        1e-3 * dataset["contact_radius"].values,
        dataset["rolling_velocity"].values,
        dataset["slide_to_roll"].values,
        [oil.viscosity for oil in oils],
        [oil.pressure_viscosity for oil in oils],
        1e-6 * np.hypot(dataset["roughness_1"].values, dataset["roughness_2"].values),
        STEEL,
    )


def fit_friction(dataset: xr.Dataset) -> FrictionFormula:
    """Fit the formula to the certified cases of a study.

    Parameters
    ----------
    dataset : xarray.Dataset
        Of `study.run_study`.

    Raises
    ------
    InputError
        Fewer than thirty cases are certified.
    """
    good = (dataset["status"].values == Status.CERTIFIED) & (dataset["friction_coefficient"].values > 0.0)
    if good.sum() < _FEWEST_CASES:
        raise InputError(f"{int(good.sum())} certified cases are too few to fit a formula: {_FEWEST_CASES} at least")
    groups = study_groups(dataset)[good]
    wanted = np.log(dataset["friction_coefficient"].values[good])
    lowest, highest = groups.min(axis=0), groups.max(axis=0)
    if (highest - lowest <= 0.0).any():
        raise InputError("a group has the same value in all cases: the study does not cover the parameters")
    centre, scale = 0.5 * (lowest + highest), 0.5 * (highest - lowest)
    normal = (groups - centre) / scale
    count = len(GROUPS)
    candidates: list[Term] = [(k,) for k in range(count)]
    candidates += list(combinations_with_replacement(range(count), 2))
    chosen: tuple[Term, ...] = ((),)
    left_out = _left_out_errors(_columns(normal, chosen), wanted)
    while candidates and len(chosen) < good.sum() // 4:
        trials = [_left_out_errors(_columns(normal, (*chosen, term)), wanted) for term in candidates]
        best = int(np.argmin([_rms(trial) for trial in trials]))
        if _rms(trials[best]) > _WORTHWHILE * _rms(left_out):
            break
        left_out = trials[best]
        chosen = (*chosen, candidates.pop(best))
    columns = _columns(normal, chosen)
    coefficients = np.linalg.lstsq(columns, wanted, rcond=None)[0]
    residual = wanted - columns @ coefficients
    return FrictionFormula(
        terms=chosen,
        coefficients=coefficients,
        centre=centre,
        scale=scale,
        lowest=lowest,
        highest=highest,
        cases=int(good.sum()),
        fit_error=_rms(residual),
        prediction_error=_rms(left_out),
        worst_error=float(np.abs(left_out).max()),
        determination=float(1.0 - residual.var() / wanted.var()),
    )


def _left_out_errors(columns: Array, wanted: Array) -> Array:
    """Error of each case by the fit to all others: its residual over one minus its leverage."""
    q, _ = np.linalg.qr(columns)
    residual = wanted - q @ (q.T @ wanted)
    return np.asarray(residual / np.maximum(1.0 - (q**2).sum(axis=1), 1e-12))


def _rms(values: Array) -> float:
    return math.sqrt(float(np.mean(values**2)))
