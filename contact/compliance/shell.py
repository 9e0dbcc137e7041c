"""The tooth as a Rayleigh-Ritz shell, factored once for the compliance between any loads.

The stiffness matrix is scaled to a unit diagonal and factored, K = D^1/2 L L^T D^1/2. Loads become load vectors Phi
(one row each), whitened loads Y = L^-1 D^-1/2 Phi^T, and the compliance between loads i and j is column i times column
j of Y: symmetric and positive semidefinite by construction.

Loads on the mid-surface do no work on the rotations. These come first in the factor, so that only its last block is
needed: forward substitution keeps the zeros in front.

Every trial function is a product of one over the height and one along the trace. Along the trace the functions are free
at both ends; over the height a power of the relative height in front pins or clamps the root. Legendre polynomials span
the same space as the monomials of the dissertation, so the exact answer is the same, while the condition number stays
below 1e7 where that of the monomials passes 1e18 and Cholesky breaks down.

The stiffness matrix is the Gauss integral of the strain energy, taken by sum factorisation. At each lengthwise Gauss
station the strain-displacement matrix of the height functions alone is built and its energy integrated over height and
thickness; the lengthwise functions are multiplied in afterwards by one matrix product. That is the plain B^T D B
accumulated at all Gauss points, at a hundredth of the work.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field
from functools import cached_property
from math import comb, perm
from typing import Protocol

import numpy as np
from numpy.typing import ArrayLike

from ...core.arrays import Bools, Integers, RealArray as Array, record
from ...core.checks import instance, positive, two_whole
from ...core.errors import InputError
from .material import Material
from .shell_kinematics import (
    NUMBER_OF_ROOT_QUANTITIES,
    NUMBER_OF_STRAINS,
    DisplacementAssumption,
    ElasticFoundation,
    Kinematics,
    energy_roots,
    five_field,
)
from .tooth_dimensions import ToothDimensions


class PolynomialFamily(Protocol):
    """Function that evaluates a family of polynomials, as ``legendre`` does."""

    def __call__(self, relative: Array, count: int, *, order: int = 0) -> Array:
        """Values and derivatives of the first ``count`` polynomials."""


def legendre(relative: Array, count: int, *, order: int = 0) -> Array:
    """Shifted Legendre polynomials and derivatives (order + 1, ..., count) at positions (...), 0 and 1 the ends."""
    values = np.zeros((order + 1, *relative.shape, count))
    t = 2.0 * relative - 1.0
    values[0, ..., 0] = 1.0
    if count > 1:
        values[0, ..., 1] = t
    for degree in range(1, count - 1):
        two_step = (2 * degree + 1) * t * values[0, ..., degree] - degree * values[0, ..., degree - 1]
        values[0, ..., degree + 1] = two_step / (degree + 1)
    for derivative in range(1, order + 1):
        # P'_{n+1} = P'_{n-1} + (2n + 1) P_n, and the factor 2 of the shift to the unit interval.
        lower, current = values[derivative - 1], values[derivative]
        for degree in range(count - 1):
            before = current[..., degree - 1] if degree > 0 else 0.0
            current[..., degree + 1] = before + 2.0 * (2 * degree + 1) * lower[..., degree]
    return values


def rooted_polynomials(relative: Array, count: int, root_power: int, order: int, family: PolynomialFamily) -> Array:
    """Polynomials times a power of the relative height, and their derivatives (order + 1, ..., count).

    ``root_power`` 0 leaves the root free, 1 pins the function there, 2 clamps it (value and slope vanish).
    """
    plain = family(relative, count, order=order)
    if root_power == 0:
        return plain
    rooted = np.zeros_like(plain)
    for derivative in range(order + 1):
        for inner in range(min(derivative, root_power) + 1):  # Leibniz: derivatives taken of the power in front
            factor = comb(derivative, inner) * perm(root_power, inner) * relative ** (root_power - inner)
            rooted[derivative] += factor[..., None] * plain[derivative - inner]
    return rooted


# Gauss points beyond the number of trial functions. Over the height the integrand is a polynomial and this is exact;
# along the trace the varying height raises its degree, and 6 leave 1e-11 even if the height doubles from toe to heel.
EXTRA_HEIGHT_POINTS = 4
EXTRA_LENGTH_POINTS = 6
# Through the thickness only 1 / (1 + z / r_c) is not a polynomial: four points leave 2e-10 at r_c = 40 mm.
THICKNESS_POINTS = 4


@dataclass(frozen=True)
class TrialFunctions:
    """Trial space of the Rayleigh-Ritz method: functions over the height and along the trace.

    Degrees of freedom are ordered (field, height function, lengthwise function), the last fastest.
    """

    reference_height: float  # scale of x [mm]
    trace_length: float
    height_count: int
    length_count: int
    root_powers: tuple[int, ...]
    family: PolynomialFamily

    @property
    def size(self) -> int:
        """Number of degrees of freedom."""
        return len(self.root_powers) * self.height_count * self.length_count

    def over_height(self, x: Array, root_power: int, order: int = 0) -> Array:
        """Height functions and their derivatives d/dx [1/mm per order], (order + 1, *x.shape, height_count)."""
        relative = x / self.reference_height
        functions = rooted_polynomials(relative, self.height_count, root_power, order, self.family)
        for derivative in range(1, order + 1):
            functions[derivative] /= self.reference_height**derivative
        return functions

    def along_trace(self, y: Array, order: int = 0) -> Array:
        """Lengthwise functions and their derivatives d/dy [1/mm per order], (order + 1, *y.shape, length_count)."""
        functions = self.family(y / self.trace_length, self.length_count, order=order)
        for derivative in range(1, order + 1):
            functions[derivative] /= self.trace_length**derivative
        return functions


def _unit_gauss(count: int) -> tuple[Array, Array]:
    points, weights = np.polynomial.legendre.leggauss(count)
    return 0.5 * (points + 1.0), 0.5 * weights


def stiffness_matrix(
    dimensions: ToothDimensions,
    material: Material,
    kinematics: Kinematics,
    functions: TrialFunctions,
    shear_factor: float = 1.0,
    foundation: ElasticFoundation | None = None,
) -> Array:
    """Ritz stiffness matrix (n_dof, n_dof) [N/mm] of a tooth (Kolivand 2009, Eq. 3.6-3.10).

    Coefficients are in mm (or rad); ``shear_factor`` is on the energy of both transverse shear strains; without
    ``foundation`` the root is clamped.
    """
    height_count, powers = functions.height_count, functions.root_powers
    station, station_weight = _unit_gauss(functions.length_count + EXTRA_LENGTH_POINTS)
    level, level_weight = _unit_gauss(height_count + EXTRA_HEIGHT_POINTS)
    layer, layer_weight = _unit_gauss(THICKNESS_POINTS)

    y = functions.trace_length * station
    height = dimensions.height(y)
    x = height[:, None] * level
    thickness = dimensions.thickness(x, y[:, None])
    z = thickness[..., None] * (layer - 0.5)
    metric = 1.0 + dimensions.trace_curvature * z
    area = (functions.trace_length * station_weight * height)[:, None] * level_weight
    stretch = dimensions.stretch(x, y[:, None])
    volume = (area * stretch * thickness)[..., None] * layer_weight * metric

    # Strain-displacement matrix of the height functions, per lengthwise derivative of the lengthwise function.
    x_order = max(term.x_derivative for term in kinematics.strain_terms)
    y_orders = 1 + max(term.y_derivative for term in kinematics.strain_terms)
    over_height = {power: functions.over_height(x, power, x_order) for power in set(powers)}
    strain = np.zeros((*z.shape, NUMBER_OF_STRAINS, y_orders, len(powers), height_count))
    for term in kinematics.strain_terms:
        shape = over_height[powers[term.field]][term.x_derivative]
        coefficient = term.coefficient(z, metric) / stretch[..., None] ** (term.y_derivative + term.fans)
        strain[..., term.strain, term.y_derivative, term.field, :] += coefficient[..., None] * shape[:, :, None, :]
    columns = y_orders * len(powers) * height_count
    rooted = energy_roots(material, shear_factor) @ strain.reshape(*z.shape, NUMBER_OF_STRAINS, columns)
    rooted *= np.sqrt(volume)[..., None, None]
    rooted = rooted.reshape(y.size, -1, columns)
    energy = np.swapaxes(rooted, 1, 2) @ rooted
    height_unknowns = len(powers) * height_count
    energy = energy.reshape(y.size, y_orders, height_unknowns, y_orders, height_unknowns)

    if foundation is not None:
        length_weight = functions.trace_length * station_weight * dimensions.stretch(0.0, y)
        root = root_shapes(kinematics, functions).reshape(NUMBER_OF_ROOT_QUANTITIES, -1)
        springs = foundation.stiffness(dimensions.thickness(0.0, y), material)
        energy[:, 0, :, 0, :] += length_weight[:, None, None] * (root.T @ springs @ root)

    # Lengthwise functions: K[a n, b m] = sum over stations and derivative orders of energy[a, b] Y_n Y_m.
    along = functions.along_trace(y, y_orders - 1)
    products = along[:, None, :, :, None] * along[None, :, :, None, :]
    products = products.reshape(y_orders**2 * y.size, functions.length_count**2)
    summed = energy.transpose(2, 4, 1, 3, 0).reshape(height_unknowns**2, -1) @ products
    blocks = summed.reshape(height_unknowns, height_unknowns, functions.length_count, functions.length_count)
    stiffness = blocks.transpose(0, 2, 1, 3).reshape(functions.size, functions.size)
    return np.asarray(0.5 * (stiffness + stiffness.T))


def root_shapes(kinematics: Kinematics, functions: TrialFunctions) -> Array:
    """Root quantities of the height functions, shape (quantities, fields, height_count)."""
    shapes = np.zeros((NUMBER_OF_ROOT_QUANTITIES, len(functions.root_powers), functions.height_count))
    for term in kinematics.root_terms:
        power, order = functions.root_powers[term.field], term.x_derivative
        shapes[term.quantity, term.field] += term.sign * functions.over_height(np.zeros(1), power, order)[order, 0]
    return shapes


@record(frozen=True)
class Shell:
    """Bending, shear and membrane compliance of one tooth by the Rayleigh-Ritz method (Kolivand 2009, Eq. 3.1-3.11).

    Building the object assembles and factors the stiffness matrix; it is valid for all mesh positions and loads.

    Parameters
    ----------
    dimensions
        The tooth.
    material
        Its material.
    modes
        Number of trial functions over the height and along the trace, (profile, lengthwise). The dissertation's
        I_CF = 5 and I_FF = 15 are the default.
    shear_factor
        Factor on the transverse shear energy [-]; the dissertation has none, that is 1.
    foundation
        Springs along the root; None clamps the root as in the dissertation (Eq. 3.9).
    assumption
        Makes the kinematics from the curvature of the trace and the fanning [1/mm].
    family
        Polynomials of the trial functions.

    Raises
    ------
    InputError
        If a value is out of range, or so many modes are asked for that the stiffness matrix is not positive definite
        to working precision.

    Notes
    -----
    The compliance of a single point with itself grows without limit, as a logarithm, with the number of modes: that is
    a property of the theory. Average the load and the deflection over a segment or patch, and keep the modes fixed.

    Examples
    --------
    Deflection [um] of a clamped steel tooth under a radial force of 500 N at mid height in its middle:

    >>> from easeoff.contact import Material, ToothDimensions
    >>> tooth = ToothDimensions(36.0, 95.25, 7.0, 9.5, 5.5, 7.5, 2.5, 2.5)
    >>> shell = Shell(tooth, Material(206000.0, 0.3), modes=(3, 5))
    >>> load = shell.load_vectors(4.0, 18.0, (0.0, 0.0, 1.0))
    >>> round(500e3 * float(shell.compliance(load[None])[0, 0]), 2)
    0.45
    """

    dimensions: ToothDimensions
    material: Material
    modes: tuple[int, int] = (5, 15)
    shear_factor: float = 1.0
    foundation: ElasticFoundation | None = None
    assumption: DisplacementAssumption = five_field
    family: PolynomialFamily = legendre
    functions: TrialFunctions = field(init=False, repr=False, compare=False)
    _factor: Array = field(init=False, repr=False, compare=False)
    _order: Integers = field(init=False, repr=False, compare=False)
    _scale: Array = field(init=False, repr=False, compare=False)

    def __post_init__(self) -> None:
        from scipy.linalg.lapack import dpotrf

        instance("dimensions", self.dimensions, ToothDimensions)
        instance("material", self.material, Material)
        instance("foundation", self.foundation, ElasticFoundation | None)
        instance("assumption", self.assumption, Callable)
        instance("family", self.family, Callable)
        profile, lengthwise = two_whole("modes", self.modes, 1)
        positive("shear_factor", self.shear_factor)
        kinematics = self.kinematics
        powers = kinematics.clamped_powers if self.foundation is None else kinematics.sprung_powers
        lengths = self.dimensions.largest_height, self.dimensions.trace_length
        functions = TrialFunctions(*lengths, profile, lengthwise, powers, self.family)
        object.__setattr__(self, "modes", (profile, lengthwise))
        object.__setattr__(self, "functions", functions)
        stiffness = self.stiffness()
        scale = 1.0 / np.sqrt(np.diagonal(stiffness))
        scaled = stiffness * scale[:, None] * scale
        order = np.argsort(self._feels_mid_surface_loads, kind="stable")
        factor, failed = dpotrf(scaled[np.ix_(order, order)], lower=1, clean=1)
        if failed:
            raise InputError(
                f"modes = {self.modes}: must leave the shell's stiffness matrix positive definite to working "
                "precision; use fewer modes, or Legendre polynomials"
            )
        object.__setattr__(self, "_factor", factor)
        object.__setattr__(self, "_order", order)
        object.__setattr__(self, "_scale", scale)

    @property
    def kinematics(self) -> Kinematics:
        """Kinematics of this tooth by the displacement assumption; made on demand, so that a shell can be pickled."""
        return self.assumption(self.dimensions.trace_curvature, self.dimensions.fanning)

    @property
    def size(self) -> int:
        """Number of degrees of freedom."""
        return self.functions.size

    @property
    def idle_size(self) -> int:
        """Number of degrees of freedom on which loads on the mid-surface do no work."""
        return int(np.count_nonzero(~self._feels_mid_surface_loads))

    @cached_property
    def _mid_surface_whitening(self) -> Array:
        """(L^-1 D^-1/2)^T of the last block: a product with it takes half the time of a substitution."""
        from scipy.linalg.lapack import dtrtri

        idle = self.idle_size
        inverse, _info = dtrtri(self._factor[idle:, idle:], lower=1)
        return np.ascontiguousarray(np.tril(inverse) * self._scale[self._order[idle:]]).T

    @property
    def _feels_mid_surface_loads(self) -> Bools:
        """True for degrees of freedom (n_dof) on which a load on the mid-surface does work."""
        fields = {term.field for term in self.kinematics.displacement_terms if term.coefficient != "offset"}
        felt = np.isin(np.arange(len(self.functions.root_powers)), list(fields))
        return np.repeat(felt, self.size // felt.size)

    def stiffness(self) -> Array:
        """Ritz stiffness matrix, shape (n_dof, n_dof) [N/mm]; assembled anew, for inspection and checks."""
        parts = self.dimensions, self.material, self.kinematics, self.functions
        return stiffness_matrix(*parts, self.shear_factor, self.foundation)

    def load_vectors(
        self,
        x: ArrayLike,
        y: ArrayLike,
        direction: ArrayLike,
        weights: ArrayLike | None = None,
        offset: ArrayLike | None = None,
    ) -> Array:
        """Work of unit loads on every trial function.

        A load acts at a point of the mid-surface, or at an offset from it. A force on the flank may be given at the
        foot of its line of action on the mid-surface, where it is statically the same force, or at its true height
        with the flank's offset.

        Parameters
        ----------
        x
            Height above the root line [mm]. The trial functions are polynomials: a point below the root or above the
            tip is allowed and continues them.
        y
            Arc length along the trace from the toe [mm]; broadcast with ``x``. Continuation beyond the ends grows fast
            (degree lengthwise modes - 1): stay within a fraction of a lengthwise wave.
        direction
            Components of the unit load along the height, along the trace (towards the heel) and along the outward
            radius of the trace, in the last axis of length 3.
        weights
            Quadrature weights. If given, the last axis of the points is summed with them: a load spread over a
            segment or patch, whose weights add up to one, becomes one load vector.
        offset
            Distance of the load from the mid-surface along the outward radius [mm]; broadcast with ``x``. None is the
            mid-surface.

        Returns
        -------
        Array
            Shape (points, n_dof), without the summed axis if there are weights.

        Raises
        ------
        InputError
            If ``direction`` has no last axis of length 3.
        """
        fields, work = self._work(x, y, direction, weights, offset)
        # Fields that the loads do not feel stay zero.
        vectors = np.zeros((*work.shape[:-3], len(self.functions.root_powers), *work.shape[-2:]))
        vectors[..., fields, :, :] = work
        return vectors.reshape(*work.shape[:-3], self.size)

    def whitened_mid_surface_loads(
        self, x: ArrayLike, y: ArrayLike, direction: ArrayLike, weights: ArrayLike | None = None
    ) -> Array:
        """Whitened unit loads on the mid-surface, as ``whiten`` of ``load_vectors`` without the rows that are zero.

        Parameters
        ----------
        x, y, direction, weights
            As of ``load_vectors``, of loads (n).

        Returns
        -------
        Array
            A row for each load (n, n_dof - idle_size); the inner products of rows are the compliances [mm/N].
        """
        _fields, work = self._work(x, y, direction, weights, None)
        return self._whitened(work.reshape(*work.shape[:-3], self.size - self.idle_size))

    def _work(
        self, x: ArrayLike, y: ArrayLike, direction: ArrayLike, weights: ArrayLike | None, offset: ArrayLike | None
    ) -> tuple[list[int], Array]:
        """Fields that feel loads, ascending, and the work on their trial functions (points, field, height, length)."""
        direction = np.asarray(direction, dtype=np.float64)
        if direction.ndim == 0 or direction.shape[-1] != 3:
            raise InputError(f"direction of shape {direction.shape}: must have a last axis of length 3")
        x, y = np.asarray(x, dtype=np.float64), np.asarray(y, dtype=np.float64)
        z = np.asarray(0.0 if offset is None else offset, dtype=np.float64)
        points = np.broadcast_shapes(x.shape, y.shape, z.shape, direction.shape[:-1])
        if weights is not None:
            if not points:
                raise InputError(
                    "weights: must not be given for a single point, as they sum the last axis of the points"
                )
            direction = direction * np.asarray(weights, dtype=np.float64)[..., None]
            points = np.broadcast_shapes(points, direction.shape[:-1])
        direction = np.broadcast_to(direction, (*points, 3))
        functions = self.functions
        along = functions.along_trace(y)[0]
        over_height = {power: functions.over_height(x, power)[0] for power in set(functions.root_powers)}
        if weights is not None:
            along = np.broadcast_to(along, (*points, functions.length_count))
            points = points[:-1]
        coefficients = {"one": 1.0, "metric": 1.0 + self.dimensions.trace_curvature * z, "offset": z}

        offered = sorted(self.kinematics.displacement_terms, key=lambda one: one.field)
        terms = [one for one in offered if offset is not None or one.coefficient != "offset"]
        loaded = [
            (direction[..., one.component] * coefficients[one.coefficient])[..., None]
            * over_height[functions.root_powers[one.field]]
            for one in terms
        ]
        if weights is None:
            work = np.stack(loaded, axis=-2)[..., None] * along[..., None, None, :]
        else:
            summed = np.swapaxes(np.concatenate(loaded, axis=-1), -1, -2) @ along
            work = summed.reshape(*points, len(terms), functions.height_count, functions.length_count)
        return [one.field for one in terms], work

    def whiten(self, load_vectors: ArrayLike) -> Array:
        """Whitened loads: their inner products are the compliances.

        Parameters
        ----------
        load_vectors
            Shape (n, n_dof), from :meth:`load_vectors` or any linear combination of its rows.

        Returns
        -------
        Array
            Y of shape (n_dof, n); Y^T Y is the compliance between the loads [mm/N]. Its first `idle_size` rows are
            zero if all loads are on the mid-surface.
        """
        from scipy.linalg.blas import dtrsm

        vectors, idle = np.asarray(load_vectors, dtype=np.float64), self.idle_size
        if vectors.ndim != 2 or vectors.shape[1] != self.size:
            raise InputError(f"load_vectors of shape {vectors.shape}: must have shape (n, {self.size})")
        if vectors[:, self._order[:idle]].any():
            scaled = vectors[:, self._order] * self._scale[self._order]
            return np.asarray(dtrsm(1.0, self._factor, scaled.T, lower=1, overwrite_b=1))
        felt = self._whitened(vectors[:, self._order[idle:]])
        return np.concatenate([np.zeros((idle, len(vectors))), felt.T])

    def _whitened(self, loads: Array) -> Array:
        """Whitened loads from their work on the degrees of freedom that feel them, a row each."""
        from scipy.linalg.blas import dtrmm

        if not loads.size:
            return np.zeros(loads.shape)
        return np.asarray(dtrmm(1.0, self._mid_surface_whitening, loads.T, trans_a=1).T)

    def compliance(self, load_vectors: ArrayLike) -> Array:
        """Compliance matrix between loads (Kolivand 2009, Eq. 3.11).

        Parameters
        ----------
        load_vectors
            Shape (n, n_dof).

        Returns
        -------
        Array
            Symmetric positive semidefinite, shape (n, n) [mm/N].
        """
        whitened = self.whiten(load_vectors)
        return np.asarray(whitened.T @ whitened)
