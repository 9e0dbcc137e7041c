"""A formula for the friction coefficient, fitted to a study: the fast evaluator for use inside a gear analysis.

As in the model, the load is shared: with a the part that asperities carry and m that of the film's friction,

    mu = boundary friction * a + m (1 - a),    ln[a / (1 - a)] and ln m polynomials of third degree

in the logarithms of pressure, radius, rolling velocity, slide-to-roll ratio, viscosity, and lambda ratio by the film
formula of Pan and Hamrock. Both limits of the lambda ratio are so met by the form itself.
"""

from __future__ import annotations

import json
import math
import os
from collections.abc import Callable
from dataclasses import astuple, dataclass
from functools import cache
from itertools import combinations_with_replacement, pairwise
from pathlib import Path

import numpy as np
import xarray as xr
from numpy.typing import ArrayLike, NDArray

from ...core.errors import InputError
from ...core.files import check_writable, whole_file
from ..conditions import ContactConditions
from .certificate import Status
from .conditions import STEEL
from .design import oil_75w90

Array = NDArray[np.float64]
Bools = NDArray[np.bool_]
#: p, R, u, slide-to-roll, viscosity, pressure-viscosity, composite roughness, E'.
Inputs = tuple[ArrayLike, ArrayLike, ArrayLike, ArrayLike, ArrayLike, ArrayLike, ArrayLike, ArrayLike]

#: The variables, whose logarithms are the columns; where the range is concerned, roughness stands for the last.
VARIABLES = ("hertz_pressure", "radius", "rolling_velocity", "slide_to_roll", "viscosity", "lambda_ratio")
#: Bounds of the lambda ratio between which errors are told apart.
REGIMES = (0.0, 0.2, 0.5, 1.0, 3.0, math.inf)
#: All products of up to as many variables, each term after the one that it extends.
_DEGREE = 3
TERMS = tuple(t for d in range(_DEGREE + 1) for t in combinations_with_replacement(range(len(VARIABLES)), d))
_FOLDS = 10
_FEWEST_CASES = 3 * len(TERMS)
#: Where the fit starts, shares beyond are those of the ends; its steps, and the relative change that ends them.
_LEAST_SHARE, _STEPS, _SETTLED = 1e-4, 20, 1e-4
#: Keeps products that the cases do not tell apart from growing against each other.
_RIDGE = 1e-7
#: How far ln(G) may be from that of the study's oil at the same viscosity.
_OTHER_OIL = 0.15
_CHUNK = 16384

#: Space-filling subsets of the design of the dissertation and of `design.REFINED`, run with the defaults.
SHIPPED_FORMULA = Path(__file__).with_name("formula.json")
SHIPPED = tuple(Path(__file__).with_name(name) for name in ("study.nc", "study_refined.nc"))


@dataclass(frozen=True)
class RegimeError:
    """Error of the formula in a range of the lambda ratio, each case predicted from other nine tenths.

    Attributes
    ----------
    lowest, highest : float
        Of the lambda ratio.
    cases : int
    mean, rms, worst : float
        Error of ln(mu): formula less model.
    """

    lowest: float
    highest: float
    cases: int
    mean: float
    rms: float
    worst: float


@dataclass(frozen=True, eq=False)
class FrictionFormula:
    """Fitted friction coefficient with its range and its errors.

    Attributes
    ----------
    share, film : (k) arrays
        Coefficients of the `TERMS` for ln[a / (1 - a)] and ln(m).
    lowest, highest : (6) arrays
        Range of the logarithms of pressure, radius, rolling velocity, slide-to-roll ratio, viscosity and composite
        roughness in the study.
    ratios : (2) array
        That of the lambda ratio. With it, the `VARIABLES` are brought to [-1, 1].
    oil : (2) array
        ln(G) of the study's oil as a straight line in ln(viscosity).
    boundary_friction : float
        [1].
    cases : int
    fit_error, prediction_error, worst_error : float
        Root of the mean square of the error of ln(mu) over the cases of the fit; the same with each case predicted from
        other nine tenths; the largest of the latter kind.
    determination : float
        1 - square of the prediction error over the variance of ln(mu).
    regimes : tuple of RegimeError
    """

    share: Array
    film: Array
    lowest: Array
    highest: Array
    ratios: Array
    oil: Array
    boundary_friction: float
    cases: int
    fit_error: float
    prediction_error: float
    worst_error: float
    determination: float
    regimes: tuple[RegimeError, ...]

    def __call__(
        self,
        hertz_pressure: ArrayLike,
        radius: ArrayLike,
        rolling_velocity: ArrayLike,
        slide_to_roll: ArrayLike,
        viscosity: ArrayLike,
        pressure_viscosity: ArrayLike,
        composite_roughness: ArrayLike,
        reduced_modulus: ArrayLike = STEEL,
    ) -> tuple[Array, Bools]:
        """Friction coefficient, in one call for any number of conditions; arrays are broadcast.

        Parameters
        ----------
        hertz_pressure, radius, rolling_velocity, slide_to_roll, viscosity, pressure_viscosity, composite_roughness
            [Pa], [m], [m/s], [1], [Pa s], [1/Pa], [m]; the last is the root of the sum of the squares of both surfaces.
            The sign of the slide-to-roll ratio does not matter.
        reduced_modulus
            [Pa].

        Returns
        -------
        friction_coefficient : array
            [1]. Variables beyond the range of the study are taken at its end.
        inside : bool array
            Where nothing was beyond the range, and the oil like that of the study: its pressure-viscosity coefficient
            within 15 % of the other's at the same viscosity.
        """
        inputs = (
            hertz_pressure,
            radius,
            rolling_velocity,
            slide_to_roll,
            viscosity,
            pressure_viscosity,
            composite_roughness,
            reduced_modulus,
        )
        logarithms, material, modulus = _logarithms(*inputs)
        slack = 1e-9
        inside = np.all((logarithms >= self.lowest - slack) & (logarithms <= self.highest + slack), axis=-1)
        inside &= np.abs(material - np.polyval(self.oil, logarithms[..., 4])) <= _OTHER_OIL
        flat = logarithms.reshape(-1, len(VARIABLES))
        material, modulus = material.reshape(-1), modulus.reshape(-1)
        friction = np.empty(flat.shape[0])
        for at in range(0, flat.shape[0], _CHUNK):  # in pieces that stay in the cache
            part = slice(at, at + _CHUNK)
            within = np.clip(flat[part], self.lowest, self.highest)
            ratio = _ratio(within, material[part], modulus[part])
            columns = _columns(_normal(within, ratio, self.lowest, self.highest, self.ratios))
            friction[part] = _friction(columns, self.share, self.film, self.boundary_friction)
        return friction.reshape(inside.shape), np.asarray(inside)

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
    """Return the formula fitted to both studies that come with the package."""
    return read_formula(SHIPPED_FORMULA)


def write_formula(path: str | os.PathLike[str], formula: FrictionFormula) -> None:
    """Write a formula as JSON.

    Raises
    ------
    InputError
        The file cannot be written.
    """
    content = {
        name: value.tolist() if isinstance(value, np.ndarray) else value for name, value in vars(formula).items()
    }
    content["regimes"] = [list(astuple(regime)) for regime in formula.regimes]
    target = Path(path)
    check_writable(target)
    with whole_file(target) as temporary:
        temporary.write_text(json.dumps(content, indent=1) + "\n", encoding="utf-8")


def read_formula(path: str | os.PathLike[str]) -> FrictionFormula:
    """Read what `write_formula` wrote.

    Raises
    ------
    InputError
        The file is not a formula.
    """
    try:
        content = json.loads(Path(path).read_text(encoding="utf-8"))
        arrays = {name: np.array(value) for name, value in content.items() if isinstance(value, list)}
        arrays["regimes"] = tuple(RegimeError(*numbers) for numbers in content["regimes"])
        return FrictionFormula(**(content | arrays))
    except (OSError, ValueError, TypeError, KeyError) as error:
        raise InputError(f"{path} is not a friction formula: {error}") from error


def shipped_studies() -> tuple[xr.Dataset, ...]:
    """Return the studies that come with the package, see `SHIPPED`."""
    return tuple(xr.load_dataset(path, engine="netcdf4") for path in SHIPPED)


def _logarithms(*inputs: ArrayLike) -> tuple[Array, Array, Array]:
    """Logarithms of the inputs whose range is known (..., 6), of the material group G, and of E' (...)."""
    p, r, u, s, eta, alpha, sigma, modulus = np.broadcast_arrays(
        *(np.asarray(value, dtype=np.float64) for value in inputs)
    )
    with np.errstate(divide="ignore"):  # nothing slides, or nothing is rough: taken at the end of the range
        columns = [np.log(value) for value in (p, r, u, np.abs(s), eta, sigma)]
        return np.stack(columns, axis=-1), np.asarray(np.log(alpha * modulus)), np.asarray(np.log(modulus))


def _ratio(logarithms: Array, material: Array, modulus: Array) -> Array:
    """Logarithm of the lambda ratio by Pan and Hamrock."""
    p, r, u, _, eta, sigma = logarithms.T
    load = math.log(2.0 * math.pi) + 2.0 * (p - modulus)
    film = math.log(1.714) + 0.694 * (eta + u - modulus - r) + 0.568 * material - 0.128 * load
    return np.asarray(film + r - sigma)


def _normal(logarithms: Array, ratio: Array, lowest: Array, highest: Array, ratios: Array) -> Array:
    """Variables, each within [-1, 1]."""
    values = np.column_stack([logarithms[:, :-1], ratio])
    low, high = np.append(lowest[:-1], ratios[0]), np.append(highest[:-1], ratios[1])
    return np.asarray(2.0 * (values - low) / (high - low) - 1.0)


def _columns(normal: Array) -> Array:
    """Products of the variables (n, k), each one more factor than a product before it."""
    columns = np.empty((len(TERMS), normal.shape[0]))
    factors = np.ascontiguousarray(normal.T)
    columns[0] = 1.0
    place = {term: at for at, term in enumerate(TERMS)}
    for at, term in enumerate(TERMS[1:], start=1):
        np.multiply(columns[place[term[:-1]]], factors[term[-1]], out=columns[at])
    return columns.T


def _friction(columns: Array, share: Array, film: Array, boundary_friction: float) -> Array:
    odds, logarithm = (columns @ np.stack([share, film], axis=1)).T
    return _shared(odds, logarithm, boundary_friction)


def _shared(odds: Array, logarithm: Array, boundary_friction: float) -> Array:
    part = 1.0 / (1.0 + np.exp(-np.clip(odds, -30.0, 30.0)))
    return np.asarray(boundary_friction * part + (1.0 - part) * np.exp(np.minimum(logarithm, 0.0)))


def study_inputs(dataset: xr.Dataset) -> Inputs:
    """What a formula is called with for each case of a study; SI."""
    oils = {float(t): oil_75w90(float(t)) for t in np.unique(dataset["temperature"].values)}
    own = [oils[float(t)] for t in dataset["temperature"].values]
    return (
        1e9 * dataset["contact_pressure"].values,
        1e-3 * dataset["contact_radius"].values,
        dataset["rolling_velocity"].values,
        dataset["slide_to_roll"].values,
        np.array([oil.viscosity for oil in own]),
        np.array([oil.pressure_viscosity for oil in own]),
        1e-6 * np.hypot(dataset["roughness_1"].values, dataset["roughness_2"].values),
        STEEL,
    )


def fit_friction(*studies: xr.Dataset) -> FrictionFormula:
    """Fit the formula to the certified cases of studies.

    Parameters
    ----------
    studies : xarray.Dataset
        Of `study.run_study`, one or more with the same boundary friction.

    Raises
    ------
    InputError
        Too few cases are certified, or a variable has the same value in all of them.
    """
    dataset = xr.concat(studies, "combination", combine_attrs="drop_conflicts")
    friction = dataset["friction_coefficient"].values.astype(float)
    good = (dataset["status"].values == Status.CERTIFIED) & (friction > 0.0)
    if good.sum() < _FEWEST_CASES:
        raise InputError(f"{int(good.sum())} certified cases are too few to fit a formula: {_FEWEST_CASES} at least")
    logarithms, material, modulus = (values[good] for values in _logarithms(*study_inputs(dataset)))
    ratio = _ratio(logarithms, material, modulus)
    friction = friction[good]
    lowest, highest = logarithms.min(axis=0), logarithms.max(axis=0)
    ratios = np.array([ratio.min(), ratio.max()])
    if (highest - lowest <= 0.0).any():
        raise InputError("a variable has the same value in all cases: the study does not cover the parameters")
    columns = _columns(_normal(logarithms, ratio, lowest, highest, ratios))
    share = np.clip(dataset["asperity_share"].values[good].astype(float), _LEAST_SHARE, 1.0 - _LEAST_SHARE)
    film = np.maximum(dataset["film_friction"].values[good].astype(float), 1e-9)
    boundary = float(dataset.attrs["boundary_friction"])
    guesses = np.stack([np.log(share / (1.0 - share)), np.log(film / (1.0 - share))])

    def fitted(rows: Bools) -> tuple[Array, Array]:
        return _least_squares(columns[rows], guesses[:, rows], np.log(friction[rows]), boundary)

    def error(rows: Bools, coefficients: tuple[Array, Array]) -> Array:
        return np.asarray(np.log(_friction(columns[rows], *coefficients, boundary) / friction[rows]))

    everything = np.ones(friction.size, dtype=bool)
    coefficients = fitted(everything)
    fold = np.random.default_rng(0).permutation(friction.size) % _FOLDS
    predicted = np.empty_like(friction)
    for k in range(_FOLDS):
        predicted[fold == k] = error(fold == k, fitted(fold != k))
    return FrictionFormula(
        share=coefficients[0],
        film=coefficients[1],
        lowest=lowest,
        highest=highest,
        ratios=ratios,
        oil=np.polyfit(logarithms[:, 4], material, 1),
        boundary_friction=boundary,
        cases=friction.size,
        fit_error=_rms(error(everything, coefficients)),
        prediction_error=_rms(predicted),
        worst_error=float(np.abs(predicted).max()),
        determination=float(1.0 - np.mean(predicted**2) / np.log(friction).var()),
        regimes=_by_regime(np.exp(ratio), predicted),
    )


def compare(dataset: xr.Dataset, formula: Callable[..., ArrayLike]) -> tuple[RegimeError, ...]:
    """Compare a formula with the model of a study: ln of formula over model by regime.

    Parameters
    ----------
    dataset : xarray.Dataset
        Of `study.run_study`.
    formula : callable
        Takes the keywords of `easeoff.friction.friction_coefficient`.
    """
    p, r, u, s, *_ = study_inputs(dataset)
    own = formula(
        hertz_pressure=p,
        equivalent_radius=r,
        rolling_velocity=u,
        slide_to_roll=s,
        roughness=(1e-6 * dataset["roughness_1"].values, 1e-6 * dataset["roughness_2"].values),
        temperature=dataset["temperature"].values,
    )
    good = dataset["status"].values == Status.CERTIFIED
    error = np.log(np.asarray(own) / dataset["friction_coefficient"].values)
    return _by_regime(np.exp(_ratio(*_logarithms(*study_inputs(dataset))))[good], error[good])


def _by_regime(ratio: Array, error: Array) -> tuple[RegimeError, ...]:
    found = []
    for low, high in pairwise(REGIMES):
        own = error[(ratio >= low) & (ratio < high)]
        if own.size:
            found.append(RegimeError(low, high, own.size, float(own.mean()), _rms(own), float(np.abs(own).max())))
    return tuple(found)


def _least_squares(columns: Array, guesses: Array, wanted: Array, boundary_friction: float) -> tuple[Array, Array]:
    """Coefficients of odds and film for the least squares of ln(mu): Gauss and Newton, from both parts of the model.

    Each step is linear in the coefficients, with each part weighted by what it changes in the whole.
    """
    odds, logarithm = guesses
    size = columns.shape[1]
    coefficients, error = np.zeros(2 * size), math.inf
    for _ in range(_STEPS):
        part = 1.0 / (1.0 + np.exp(-np.clip(odds, -30.0, 30.0)))
        film = np.exp(np.minimum(logarithm, 0.0))
        friction = boundary_friction * part + (1.0 - part) * film
        by_odds = (boundary_friction - film) * part * (1.0 - part) / friction
        by_film = (1.0 - part) * film / friction
        slopes = np.concatenate([columns * by_odds[:, None], columns * by_film[:, None]], axis=1)
        target = wanted - np.log(friction) + by_odds * odds + by_film * logarithm
        normal = slopes.T @ slopes
        ridge = _RIDGE * np.diag(normal).mean() * np.eye(2 * size)
        coefficients = np.linalg.solve(normal + ridge, slopes.T @ target)
        odds, logarithm = columns @ coefficients[:size], columns @ coefficients[size:]
        last, error = error, _rms(wanted - np.log(_shared(odds, logarithm, boundary_friction)))
        if abs(error - last) < _SETTLED * error:
            break
    return coefficients[:size], coefficients[size:]


def _rms(values: Array) -> float:
    return math.sqrt(float(np.mean(values**2)))
