"""Formula of the friction coefficient, fitted to a study: a fast model for use inside a gear analysis.

As in the model, the load is shared: with a the part that asperities carry and m that of the film's friction,

    mu = boundary friction * a + m (1 - a),    ln[a / (1 - a)] and ln m polynomials of third degree

in the logarithms of pressure, radius, rolling velocity, slide-to-roll ratio, viscosity, and lambda ratio by the film
formula of Pan and Hamrock. Both limits of the lambda ratio are so met by the form itself.
"""

from __future__ import annotations

import json
import math
import os
from dataclasses import astuple, dataclass, fields
from functools import cache
from itertools import combinations_with_replacement
from pathlib import Path

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ....core import checks
from ....core.checks import frozen_arrays
from ....core.errors import InputError
from ....core.reading.json_text import parsed_json
from ....core.reading.text_file import TOML_SIZE_LIMIT, read_text
from ....core.writing.output_file import check_writable, whole_file
from ...conditions import STEEL_MODULUS, ContactConditions
from ...formula_range import Flags, combined_flags

Array = NDArray[np.float64]
Bools = NDArray[np.bool_]
#: The variables, whose logarithms are the columns; where the range is concerned, roughness stands for the last.
VARIABLES = ("hertz_pressure", "equivalent_radius", "rolling_velocity", "slide_to_roll", "viscosity", "lambda_ratio")
#: All products of up to as many variables, each term after the one that it extends.
DEGREE = 3
TERMS = tuple(t for d in range(DEGREE + 1) for t in combinations_with_replacement(range(len(VARIABLES)), d))
#: How far ln(G) may be from that of the study's oil at the same viscosity.
OIL_TOLERANCE = 0.15
#: Flags of the inputs beyond the study, in the order of the ``VARIABLES``, and of the oil; see ``friction.FLAGS``.
VARIABLE_FLAGS, OIL_FLAG = (2, 1024, 2048, 1, 4096, 4), 8192
CHUNK_SIZE = 16384
#: How many numbers each array of a formula has.
ARRAY_SIZES = {
    "share": len(TERMS),
    "film": len(TERMS),
    "lowest": len(VARIABLES),
    "highest": len(VARIABLES),
    "ratios": 2,
    "oil": 2,
}

#: The formula fitted to both studies in ``docs/data``.
FORMULA_FILE = Path(__file__).with_name("formula.json")


@dataclass(frozen=True)
class RegimeError:
    """Error of the formula in a range of the lambda ratio, each case predicted from other nine tenths.

    Parameters
    ----------
    lowest, highest
        Of the lambda ratio.
    cases
        Number of cases in the range.
    mean, rms, worst
        Error of ln(mu): formula less model.
    """

    lowest: float
    highest: float
    cases: int
    mean: float
    rms: float
    worst: float


@frozen_arrays
@dataclass(frozen=True, eq=False)
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
        inputs = (
            hertz_pressure,
            equivalent_radius,
            rolling_velocity,
            slide_to_roll,
            viscosity,
            pressure_viscosity,
            composite_roughness,
            contact_modulus,
        )
        logarithms, material, modulus = logarithms_of(*inputs)
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
        """Which of the logarithms (..., 6) are beyond the range of the study, or no numbers."""
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
        """Which inputs of ``coefficient`` were taken at the end of the study's range (...), as sums of flags.

        Examples
        --------
        >>> from easeoff.friction.formula_range import FLAGS
        >>> from easeoff.friction.coefficient import contact_conditions
        >>> contact = contact_conditions(hertz_pressure=0.7e9, equivalent_radius=0.042, rolling_velocity=2.2,
        ...                              slide_to_roll=0.45, roughness=0.8e-6)
        >>> [name for bit, name in FLAGS.items() if shipped_formula().flags(contact) & bit]
        ['radius_clamped']
        """
        logarithms, material, _ = logarithms_of(*_inputs(conditions))
        beyond = self._beyond(logarithms)
        found = {bit: beyond[..., column] for column, bit in enumerate(VARIABLE_FLAGS)}
        found[OIL_FLAG] = ~(np.abs(material - self._usual_material(logarithms)) <= OIL_TOLERANCE)
        return combined_flags(found)


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
    """Write a formula as JSON.

    Raises
    ------
    InputError
        If the file cannot be written.

    Examples
    --------
    >>> from tempfile import TemporaryDirectory
    >>> with TemporaryDirectory() as folder:
    ...     write_formula(f"{folder}/formula.json", shipped_formula())
    ...     print(read_formula(f"{folder}/formula.json").cases == shipped_formula().cases)
    True
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
    """Read what ``write_formula`` wrote.

    Raises
    ------
    InputError
        If the file is not a formula.

    Examples
    --------
    >>> read_formula(FORMULA_FILE).boundary_friction
    0.1
    """
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
    return (
        conditions.hertz_pressure,
        conditions.equivalent_radius,
        conditions.rolling_velocity,
        conditions.slide_to_roll,
        conditions.viscosity,
        conditions.pressure_viscosity,
        conditions.composite_roughness,
        conditions.contact_modulus,
    )


def logarithms_of(*inputs: ArrayLike) -> tuple[Array, Array, Array]:
    """Logarithms of the inputs whose range is known (..., 6), of the material group G, and of E' (...).

    NaN where an input is not finite or not positive; minus infinity where nothing slides or nothing is rough, which is
    taken at the end of the range.
    """
    p, r, u, s, eta, alpha, sigma, modulus = np.broadcast_arrays(
        *(np.asarray(value, dtype=np.float64) for value in inputs)
    )
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
