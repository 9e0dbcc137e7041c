"""Regression of the friction formula on a study, and errors of formulas against the model."""

from __future__ import annotations

import math
from collections.abc import Callable
from itertools import pairwise

import numpy as np
import xarray as xr
from numpy.typing import ArrayLike, NDArray

from ....core import checks
from ....core.errors import InputError
from ...conditions import STEEL_MODULUS
from ..equations.film_certificate import Status
from .friction_formula import (
    TERMS,
    FrictionFormula,
    RegimeError,
    combined,
    lambda_ratio,
    logarithms_of,
    normalised,
    products,
    shared,
)
from .study_design import oil_75w90

Array = NDArray[np.float64]
Bools = NDArray[np.bool_]
#: Bounds of the lambda ratio between which errors are told apart.
REGIMES = (0.0, 0.2, 0.5, 1.0, 3.0, math.inf)
#: What of a study a fit needs.
FITTED_VARIABLES = (
    "contact_pressure",
    "contact_radius",
    "rolling_velocity",
    "slide_to_roll",
    "temperature",
    "roughness_1",
    "roughness_2",
    "status",
    "friction_coefficient",
    "film_friction",
    "asperity_share",
)
FOLDS = 10
FEWEST_CASES = 3 * len(TERMS)
#: Where the fit starts, shares beyond are those of the ends; its steps, and the relative change that ends them.
LEAST_SHARE, FIT_ITERATIONS, FIT_TOLERANCE = 1e-4, 20, 1e-4
#: Keeps products that the cases do not tell apart from growing against each other.
RIDGE = 1e-7


def study_inputs(dataset: xr.Dataset) -> tuple[Array, ...]:
    """Arguments of a formula for each case of a study; SI.

    Examples
    --------
    >>> from easeoff.friction.ehl.study import Design
    >>> from easeoff.friction.ehl.study.study_case import run_case
    >>> from easeoff.friction.ehl.study.parameter_study import study_dataset
    >>> study = study_dataset(Design(), {31499: run_case(Design().condition(31499))})
    >>> pressure, radius, *_ = study_inputs(study)
    >>> print(pressure, radius)
    [2.5e+09] [0.04]
    """
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
        np.array(STEEL_MODULUS),
    )


def fit_friction(*studies: xr.Dataset) -> FrictionFormula:
    """Fit the formula to the certified cases of studies.

    Parameters
    ----------
    studies
        Of ``run_study``, one or more with the same boundary friction.

    Raises
    ------
    InputError
        If there is no study, they differ in the boundary friction, a certified case lacks a number, too few cases are
        certified, or a variable has the same value in all of them.

    Examples
    --------
    >>> from easeoff.friction.ehl.study import Design, shipped_formula
    >>> from easeoff.friction.ehl.study.parameter_study import study_dataset
    >>> from easeoff.friction.ehl.study.study_case import NUMBERS
    >>> row = {**dict.fromkeys(NUMBERS, 0.02), "status": 0.0}
    >>> study = study_dataset(Design(), {int(number): row for number in Design().subset(300)})
    >>> study["friction_coefficient"][:], _ = shipped_formula()(*study_inputs(study))  # in place of the model's
    >>> study.attrs["boundary_friction"] = 0.1
    >>> fit_friction(study).cases
    300
    """
    boundary = _boundary_friction(studies)
    dataset = xr.concat(
        [study[list(FITTED_VARIABLES)] for study in studies], "combination", combine_attrs="drop_conflicts"
    )
    friction = dataset["friction_coefficient"].values.astype(float)
    certified = dataset["status"].values == Status.CERTIFIED
    for name in ("friction_coefficient", "asperity_share", "film_friction"):
        lacking = certified & ~np.isfinite(dataset[name].values.astype(float))
        if lacking.any():
            first = int(dataset["combination"].values[lacking][0])
            raise InputError(f"{name} of combination {first} = nan: must be a number in every certified case")
    good = certified & (friction > 0.0)
    if good.sum() < FEWEST_CASES:
        raise InputError(f"certified cases = {int(good.sum())}: must be {FEWEST_CASES} or more to fit a formula")
    logarithms, material, modulus = (values[good] for values in logarithms_of(*study_inputs(dataset)))
    ratio = lambda_ratio(logarithms, material, modulus)
    friction = friction[good]
    lowest, highest = logarithms.min(axis=0), logarithms.max(axis=0)
    ratios = np.array([ratio.min(), ratio.max()])
    if (highest - lowest <= 0.0).any():
        raise InputError("a variable has the same value in all cases: the study does not cover the parameters")
    columns = products(normalised(logarithms, ratio, lowest, highest, ratios))
    share = np.clip(dataset["asperity_share"].values[good].astype(float), LEAST_SHARE, 1.0 - LEAST_SHARE)
    film = np.maximum(dataset["film_friction"].values[good].astype(float), 1e-9)
    guesses = np.stack([np.log(share / (1.0 - share)), np.log(film / (1.0 - share))])

    def fitted(rows: Bools) -> tuple[Array, Array]:
        return _least_squares(columns[rows], guesses[:, rows], np.log(friction[rows]), boundary)

    def error(rows: Bools, coefficients: tuple[Array, Array]) -> Array:
        return np.asarray(np.log(combined(columns[rows], *coefficients, boundary) / friction[rows]))

    everything = np.ones(friction.size, dtype=bool)
    coefficients = fitted(everything)
    fold = np.random.default_rng(0).permutation(friction.size) % FOLDS
    predicted = np.empty_like(friction)
    for k in range(FOLDS):
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


def compare(dataset: xr.Dataset, formula: FrictionFormula | Callable[..., ArrayLike]) -> tuple[RegimeError, ...]:
    """Compare a formula with the model of a study: ln of formula over model by regime.

    Parameters
    ----------
    dataset
        Of ``run_study``.
    formula
        The latter takes the keywords of ``easeoff.friction.friction_coefficient``.

    Raises
    ------
    InputError
        If the dataset is no study, or the formula neither.

    Examples
    --------
    >>> from easeoff.friction.ehl.study import Design, shipped_formula
    >>> from easeoff.friction.ehl.study.study_case import run_case
    >>> from easeoff.friction.ehl.study.parameter_study import study_dataset
    >>> study = study_dataset(Design(), {31499: run_case(Design().condition(31499))})
    >>> [(regime.cases, abs(regime.mean) < 0.2) for regime in compare(study, shipped_formula())]
    [(1, True)]
    """
    _check_study(dataset)
    if isinstance(formula, FrictionFormula):
        return _compared(dataset, formula(*study_inputs(dataset))[0])
    if not callable(formula):
        raise InputError(f"formula = {formula!r}: must be a FrictionFormula, or a function like friction_coefficient")
    p, r, u, s, *_ = study_inputs(dataset)
    own = formula(
        hertz_pressure=p,
        equivalent_radius=r,
        rolling_velocity=u,
        slide_to_roll=s,
        roughness=(1e-6 * dataset["roughness_1"].values, 1e-6 * dataset["roughness_2"].values),
        temperature=dataset["temperature"].values,
    )
    return _compared(dataset, own)


def _compared(dataset: xr.Dataset, own: ArrayLike) -> tuple[RegimeError, ...]:
    good = dataset["status"].values == Status.CERTIFIED
    error = np.log(np.asarray(own) / dataset["friction_coefficient"].values)
    return _by_regime(np.exp(lambda_ratio(*logarithms_of(*study_inputs(dataset))))[good], error[good])


def _check_study(study: xr.Dataset) -> None:
    checks.instance("study", study, xr.Dataset)
    missing = [name for name in FITTED_VARIABLES if name not in study]
    if missing:
        raise InputError(f"study = a dataset without {', '.join(missing)}: must be a study of run_study")


def _boundary_friction(studies: tuple[xr.Dataset, ...]) -> float:
    """The one of all studies, once they are found to be some."""
    if not studies:
        raise InputError("studies = none: must be one study or more, as in fit_friction(first, second)")
    for study in studies:
        _check_study(study)
    found = {float(study.attrs.get("boundary_friction", math.nan)) for study in studies}
    if len(found) > 1 or math.isnan(max(found)):
        raise InputError(f"boundary_friction = {sorted(found)}: must be the same attribute of all studies")
    return found.pop()


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
    for _ in range(FIT_ITERATIONS):
        part = 1.0 / (1.0 + np.exp(-np.clip(odds, -30.0, 30.0)))
        film = np.exp(np.minimum(logarithm, 0.0))
        friction = boundary_friction * part + (1.0 - part) * film
        by_odds = (boundary_friction - film) * part * (1.0 - part) / friction
        by_film = (1.0 - part) * film / friction
        slopes = np.concatenate([columns * by_odds[:, None], columns * by_film[:, None]], axis=1)
        target = wanted - np.log(friction) + by_odds * odds + by_film * logarithm
        normal = slopes.T @ slopes
        ridge = RIDGE * np.diag(normal).mean() * np.eye(2 * size)
        coefficients = np.linalg.solve(normal + ridge, slopes.T @ target)
        odds, logarithm = columns @ coefficients[:size], columns @ coefficients[size:]
        last, error = error, _rms(wanted - np.log(shared(odds, logarithm, boundary_friction)))
        if abs(error - last) < FIT_TOLERANCE * error:
            break
    return coefficients[:size], coefficients[size:]


def _rms(values: Array) -> float:
    return math.sqrt(float(np.mean(values**2)))
