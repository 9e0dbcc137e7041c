"""Formula of the friction coefficient, fitted to a study: a fast model for use inside a gear analysis.

As in the model, the load is shared: with a the part that asperities carry and m that of the film's friction,

    mu = boundary friction * a + m (1 - a),    ln[a / (1 - a)] and ln m polynomials of third degree

in the logarithms of pressure, radius, rolling velocity, slide-to-roll ratio, viscosity, and lambda ratio by the film
formula of Pan and Hamrock. Both limits of the lambda ratio are so met by the form itself.

The polynomials are a regression on the study, with their errors against the model.
"""

from __future__ import annotations

import json
import math
import os
from collections.abc import Callable
from dataclasses import astuple, dataclass, fields
from functools import cache
from itertools import combinations_with_replacement, pairwise
from pathlib import Path

import numpy as np
import xarray as xr
from numpy.typing import ArrayLike

from ....core import checks
from ....core.arrays import Bools, RealArray as Array, record
from ....core.errors import InputError
from ....core.output_file import check_writable, whole_file
from ....core.regular_file import TOML_SIZE_LIMIT, parsed_json, read_text
from ...conditions import STEEL_MODULUS, ContactConditions
from ...kolivand_formula import Flags, combined_flags
from ..reynolds_equation import Status
from .study_design import oil_75w90

#: The variables, whose logarithms are the columns; where the range is concerned, roughness stands for the last.
VARIABLES = ("hertz_pressure", "equivalent_radius", "rolling_velocity", "slide_to_roll", "viscosity", "lambda_ratio")
#: Arguments of a formula, in their order.
INPUTS = (*VARIABLES[:-1], "pressure_viscosity", "composite_roughness", "contact_modulus")
#: All products of up to as many variables, each term after the one that it extends.
DEGREE = 3
TERMS = tuple(t for d in range(DEGREE + 1) for t in combinations_with_replacement(range(len(VARIABLES)), d))
#: How far ln(G) may be from that of the study's oil at the same viscosity.
OIL_TOLERANCE = 0.15
#: Flags of the inputs beyond the study, in the order of ``VARIABLES``, and of the oil; see ``kolivand_formula.FLAGS``.
VARIABLE_FLAGS, OIL_FLAG = (2, 1024, 2048, 1, 4096, 4), 8192
CHUNK_SIZE = 16384
#: How many numbers each array of a formula has.
ARRAY_SIZES = {
    **dict.fromkeys(("share", "film"), len(TERMS)),
    **dict.fromkeys(("lowest", "highest"), len(VARIABLES)),
    **dict.fromkeys(("ratios", "oil"), 2),
}

#: The formula fitted to both studies in ``docs/data``.
FORMULA_FILE = Path(__file__).with_name("formula.json")


@dataclass(frozen=True)
class RegimeError:
    """Error of ln(mu), formula less model, in a range of lambda, each case predicted from other nine tenths."""

    lowest: float
    highest: float
    cases: int
    mean: float
    rms: float
    worst: float


@record(frozen=True, eq=False)
class FrictionFormula:
    """Fitted friction coefficient with its range and its errors.

    Parameters
    ----------
    share, film
        Coefficients of the ``TERMS`` for ln[a / (1 - a)] and ln(m) (k).
    lowest, highest
        Range of the logarithms (6) of pressure, radius, rolling velocity, slide-to-roll ratio, viscosity and composite
        roughness in the study.
    ratios
        Range of the logarithm of the lambda ratio (2). With it, the ``VARIABLES`` are brought to -1 ... 1.
    oil
        ln(G) of the study's oil as a straight line in ln(viscosity) (2).
    boundary_friction
        [1].
    cases
        Number of cases of the fit.
    fit_error, prediction_error, worst_error
        Root of the mean square of the error of ln(mu) over the cases of the fit; the same with each case predicted from
        other nine tenths; the largest of the latter kind.
    determination
        1 - square of the prediction error over the variance of ln(mu).
    regimes
        Errors by ranges of the lambda ratio.

    Examples
    --------
    >>> formula = shipped_formula()
    >>> formula.boundary_friction, formula.prediction_error < 0.1
    (0.1, True)
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
        equivalent_radius: ArrayLike,
        rolling_velocity: ArrayLike,
        slide_to_roll: ArrayLike,
        viscosity: ArrayLike,
        pressure_viscosity: ArrayLike,
        composite_roughness: ArrayLike,
        contact_modulus: ArrayLike = STEEL_MODULUS,
    ) -> tuple[Array, Bools]:
        """Friction coefficient, in one call for any number of conditions; arrays are broadcast.

        Parameters
        ----------
        hertz_pressure, equivalent_radius, rolling_velocity
            (...) [Pa], [m], [m/s].
        slide_to_roll
            (...) [1]; its sign does not matter.
        viscosity, pressure_viscosity
            (...) [Pa s], [1/Pa].
        composite_roughness
            Root of the sum of the squares of both surfaces' rms heights (...) [m].
        contact_modulus
            (...) [Pa].

        Returns
        -------
        friction_coefficient
            [1]. Variables beyond the range of the study are taken at its end, as is a slide-to-roll ratio or a
            roughness of zero; NaN where an input is not finite, or otherwise not positive.
        inside
            Where nothing was beyond the range, and the oil like that of the study: its pressure-viscosity coefficient
            within 15 % of the other's at the same viscosity.
        """
        logarithms, material, modulus = logarithms_of(
            hertz_pressure,
            equivalent_radius,
            rolling_velocity,
            slide_to_roll,
            viscosity,
            pressure_viscosity,
            composite_roughness,
            contact_modulus,
        )
        usual = self._usual_material(logarithms)
        inside = ~np.any(self._beyond(logarithms), axis=-1) & (np.abs(material - usual) <= OIL_TOLERANCE)
        material = np.clip(material, usual - OIL_TOLERANCE, usual + OIL_TOLERANCE)
        flat = logarithms.reshape(-1, len(VARIABLES))
        material, modulus = material.reshape(-1), modulus.reshape(-1)
        friction = np.empty(flat.shape[0])
        for at in range(0, flat.shape[0], CHUNK_SIZE):  # in pieces that stay in the cache
            part = slice(at, at + CHUNK_SIZE)
            within = np.clip(flat[part], self.lowest, self.highest)
            ratio = lambda_ratio(within, material[part], modulus[part])
            columns = products(normalised(within, ratio, self.lowest, self.highest, self.ratios))
            friction[part] = combined(columns, self.share, self.film, self.boundary_friction)
        return friction.reshape(inside.shape), np.asarray(inside)

    def _beyond(self, logarithms: Array) -> Bools:
        """True for the logarithms (..., 6) beyond the range of the study, and for those that are no numbers."""
        slack = 1e-9
        return np.asarray(~((logarithms >= self.lowest - slack) & (logarithms <= self.highest + slack)))

    def _usual_material(self, logarithms: Array) -> Array:
        """ln(G) of the study's oil (...) at the viscosity among the logarithms (..., 6)."""
        return np.asarray(np.polyval(self.oil, np.clip(logarithms[..., 4], self.lowest[4], self.highest[4])))

    def coefficient(self, conditions: ContactConditions) -> Array:
        """Friction coefficient of the segments of a gear analysis: a model that ``easeoff.friction`` takes."""
        friction, _ = self(*_inputs(conditions))
        return friction

    def flags(self, conditions: ContactConditions) -> Flags:
        """Flags (...) of the inputs of ``coefficient`` that were taken at the end of the study's range, summed.

        Examples
        --------
        >>> from easeoff.friction.kolivand_formula import FLAGS
        >>> from easeoff.friction.coefficient import contact_conditions
        >>> contact = contact_conditions(hertz_pressure=0.7e9, equivalent_radius=0.042, rolling_velocity=2.2,
        ...                              slide_to_roll=0.45, roughness=0.8e-6)
        >>> [name for bit, name in FLAGS.items() if shipped_formula().flags(contact) & bit]
        ['radius_clamped']
        """
        logarithms, material, _ = logarithms_of(*_inputs(conditions))
        beyond = self._beyond(logarithms)
        masks = {bit: beyond[..., column] for column, bit in enumerate(VARIABLE_FLAGS)}
        masks[OIL_FLAG] = ~(np.abs(material - self._usual_material(logarithms)) <= OIL_TOLERANCE)
        return combined_flags(masks)


@cache
def shipped_formula() -> FrictionFormula:
    """Return the formula fitted to a study of all conditions of the dissertation, and one with levels in between.

    Examples
    --------
    >>> friction, inside = shipped_formula()(1e9, 0.02, 5.0, 0.25, 0.0208, 11.4e-9, 0.6e-6)
    >>> print(f"{friction:.4f}", inside)
    0.0406 True
    """
    return read_formula(FORMULA_FILE)


def write_formula(path: str | os.PathLike[str], formula: FrictionFormula) -> None:
    """Write a formula as JSON."""
    content = {key: value.tolist() if isinstance(value, np.ndarray) else value for key, value in vars(formula).items()}
    content["regimes"] = [list(astuple(regime)) for regime in formula.regimes]
    check_writable(path)
    with whole_file(path) as temporary:
        temporary.write_text(json.dumps(content, indent=1) + "\n", encoding="utf-8")


def read_formula(path: str | os.PathLike[str]) -> FrictionFormula:
    """Formula that ``write_formula`` wrote."""
    try:
        content = parsed_json(read_text(path, TOML_SIZE_LIMIT))
        if not isinstance(content, dict):
            raise InputError("must be an object with the attributes of a FrictionFormula")
        arrays = {name: checks.array(name, content[name], ndim=1, size=size) for name, size in ARRAY_SIZES.items()}
        for row in content["regimes"]:
            checks.array("regimes", row, ndim=1, size=len(fields(RegimeError)), infinite=True)
        regimes = tuple(RegimeError(*row) for row in content["regimes"])
        formula = FrictionFormula(**(content | arrays | {"regimes": regimes}))
        checks.positive("boundary_friction", formula.boundary_friction, "1", zero=True)
        for name in ("cases", "fit_error", "prediction_error", "worst_error", "determination"):
            checks.number(name, getattr(formula, name))
        return formula
    except KeyError as error:
        raise InputError(f"{path} is not a friction formula: {error} is missing") from error
    except (ValueError, TypeError) as error:
        raise InputError(f"{path} is not a friction formula: {error}") from error


def _inputs(conditions: ContactConditions) -> tuple[ArrayLike, ...]:
    """Arguments of a formula from conditions of contacts."""
    return tuple(getattr(conditions, name) for name in INPUTS)


def logarithms_of(*inputs: ArrayLike) -> tuple[Array, Array, Array]:
    """Logarithms of the inputs whose range is known (..., 6), of the material group G, and of E' (...).

    NaN where an input is not finite or not positive; minus infinity where nothing slides or nothing is rough, which is
    taken at the end of the range.
    """
    given = (np.asarray(value, dtype=np.float64) for value in inputs)
    p, r, u, s, eta, alpha, sigma, modulus = np.broadcast_arrays(*given)
    columns = [_logarithm(value) for value in (p, r, u)]
    columns += [_logarithm(np.abs(s), zero=True), _logarithm(eta), _logarithm(sigma, zero=True)]
    material = _logarithm(np.where(alpha > 0.0, alpha, np.nan) * modulus)
    return np.stack(columns, axis=-1), material, _logarithm(modulus)


def _logarithm(values: Array, *, zero: bool = False) -> Array:
    valid = np.isfinite(values) & ((values >= 0.0) if zero else (values > 0.0))
    with np.errstate(divide="ignore", invalid="ignore"):
        return np.where(valid, np.log(values), np.nan)


def lambda_ratio(logarithms: Array, material: Array, modulus: Array) -> Array:
    """Logarithm of the lambda ratio by Pan and Hamrock."""
    p, r, u, _, eta, sigma = logarithms.T
    load = math.log(2.0 * math.pi) + 2.0 * (p - modulus)
    film = math.log(1.714) + 0.694 * (eta + u - modulus - r) + 0.568 * material - 0.128 * load
    return np.asarray(film + r - sigma)


def normalised(logarithms: Array, ratio: Array, lowest: Array, highest: Array, ratios: Array) -> Array:
    """Variables, each within [-1, 1]."""
    values = np.column_stack([logarithms[:, :-1], ratio])
    low, high = np.append(lowest[:-1], ratios[0]), np.append(highest[:-1], ratios[1])
    return np.asarray(2.0 * (values - low) / (high - low) - 1.0)


def products(normal: Array) -> Array:
    """Products of the variables (n, k), each one more factor than a product before it."""
    columns = np.empty((len(TERMS), normal.shape[0]))
    factors = np.ascontiguousarray(normal.T)
    columns[0] = 1.0
    row = {term: at for at, term in enumerate(TERMS)}
    for at, term in enumerate(TERMS[1:], start=1):
        np.multiply(columns[row[term[:-1]]], factors[term[-1]], out=columns[at])
    return columns.T


def combined(columns: Array, share: Array, film: Array, boundary_friction: float) -> Array:
    """Friction coefficients from products of the variables and both sets of coefficients."""
    odds, logarithm = (columns @ np.stack([share, film], axis=1)).T
    return shared(odds, logarithm, boundary_friction)


def shared(odds: Array, logarithm: Array, boundary_friction: float) -> Array:
    """Friction coefficients from ln[a / (1 - a)] and ln(m)."""
    part = 1.0 / (1.0 + np.exp(-np.clip(odds, -30.0, 30.0)))
    return np.asarray(boundary_friction * part + (1.0 - part) * np.exp(np.minimum(logarithm, 0.0)))


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
    """Arguments of a formula for each case of a study; SI."""
    oils = {float(t): oil_75w90(float(t)) for t in np.unique(dataset["temperature"].values)}
    case_oils = [oils[float(t)] for t in dataset["temperature"].values]
    return (
        1e9 * dataset["contact_pressure"].values,
        1e-3 * dataset["contact_radius"].values,
        dataset["rolling_velocity"].values,
        dataset["slide_to_roll"].values,
        np.array([oil.viscosity for oil in case_oils]),
        np.array([oil.pressure_viscosity for oil in case_oils]),
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
    >>> from easeoff.friction.ehl.study.study_design import study_dataset
    >>> from easeoff.friction.ehl.study.study_design import NUMBERS
    >>> row = {**dict.fromkeys(NUMBERS, 0.02), "status": 0.0}
    >>> study = study_dataset(Design(), {int(number): row for number in Design().subset(300)})
    >>> study["friction_coefficient"][:], _ = shipped_formula()(*study_inputs(study))  # in place of the model's
    >>> study.attrs["boundary_friction"] = 0.1
    >>> fit_friction(study).cases
    300
    """
    boundary = _boundary_friction(studies)
    fitted_parts = [study[list(FITTED_VARIABLES)] for study in studies]
    dataset = xr.concat(fitted_parts, "combination", combine_attrs="drop_conflicts")
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
    >>> from easeoff.friction.ehl.study.study_design import run_case
    >>> from easeoff.friction.ehl.study.study_design import study_dataset
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
    coefficients = formula(
        hertz_pressure=p,
        equivalent_radius=r,
        rolling_velocity=u,
        slide_to_roll=s,
        roughness=(1e-6 * dataset["roughness_1"].values, 1e-6 * dataset["roughness_2"].values),
        temperature=dataset["temperature"].values,
    )
    return _compared(dataset, coefficients)


def _compared(dataset: xr.Dataset, computed: ArrayLike) -> tuple[RegimeError, ...]:
    good = dataset["status"].values == Status.CERTIFIED
    error = np.log(np.asarray(computed) / dataset["friction_coefficient"].values)
    return _by_regime(np.exp(lambda_ratio(*logarithms_of(*study_inputs(dataset))))[good], error[good])


def _check_study(study: xr.Dataset) -> None:
    checks.instance("study", study, xr.Dataset)
    if missing := [name for name in FITTED_VARIABLES if name not in study]:
        raise InputError(f"study = a dataset without {', '.join(missing)}: must be a study of run_study")


def _boundary_friction(studies: tuple[xr.Dataset, ...]) -> float:
    """The one of all studies, once they are found to be some."""
    if not studies:
        raise InputError("studies = none: must be one study or more, as in fit_friction(first, second)")
    for study in studies:
        _check_study(study)
    coefficients = {float(study.attrs.get("boundary_friction", math.nan)) for study in studies}
    if len(coefficients) > 1 or math.isnan(max(coefficients)):
        raise InputError(f"boundary_friction = {sorted(coefficients)}: must be the same attribute of all studies")
    return coefficients.pop()


def _by_regime(ratio: Array, error: Array) -> tuple[RegimeError, ...]:
    regimes = ((low, high, error[(ratio >= low) & (ratio < high)]) for low, high in pairwise(REGIMES))
    return tuple(
        RegimeError(low, high, errors.size, float(errors.mean()), _rms(errors), float(np.abs(errors).max()))
        for low, high, errors in regimes
        if errors.size
    )


def _least_squares(columns: Array, guesses: Array, wanted: Array, boundary_friction: float) -> tuple[Array, Array]:
    """Coefficients of odds and film for the least squares of ln(mu), by Gauss and Newton.

    Each step is linear in the coefficients, with each part of the model weighted by what it changes in the whole.
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
