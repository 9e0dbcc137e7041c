"""The Ritz stiffness matrix of the shell: Gauss integration of the strain energy, by sum factorisation.

Every trial function is a product of one over the height and one along the trace. At each lengthwise Gauss station the
strain-displacement matrix of the height functions alone is built and its energy integrated over height and thickness;
the lengthwise functions are multiplied in afterwards by one matrix product. That is the plain B^T D B accumulated at
all Gauss points, at a hundredth of the work.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from .elastic_foundation import ElasticFoundation
from .material import Material
from .shell_kinematics import (
    NUMBER_OF_ROOT_QUANTITIES,
    NUMBER_OF_STRAINS,
    SHEAR_XY,
    SHEAR_XZ,
    SHEAR_YZ,
    STRAIN_X,
    STRAIN_Y,
    FloatArray,
    Kinematics,
)
from .tooth_dimensions import ToothDimensions
from .trial_polynomials import PolynomialFamily, rooted_polynomials

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

    Parameters
    ----------
    reference_height
        Height that scales x in the height functions [mm].
    trace_length
        Length that scales y in the lengthwise functions [mm].
    height_count, length_count
        Number of functions in each direction.
    root_powers
        Power of the relative height in front of each field.
    family
        Polynomials used.
    """

    reference_height: float
    trace_length: float
    height_count: int
    length_count: int
    root_powers: tuple[int, ...]
    family: PolynomialFamily

    @property
    def size(self) -> int:
        """Number of degrees of freedom."""
        return len(self.root_powers) * self.height_count * self.length_count

    def over_height(self, x: FloatArray, root_power: int, order: int = 0) -> FloatArray:
        """Height functions and their derivatives d/dx [1/mm per order], (order + 1, *x.shape, height_count)."""
        functions = rooted_polynomials(
            x / self.reference_height, self.height_count, root_power, order=order, family=self.family
        )
        for derivative in range(1, order + 1):
            functions[derivative] /= self.reference_height**derivative
        return functions

    def along_trace(self, y: FloatArray, order: int = 0) -> FloatArray:
        """Lengthwise functions and their derivatives d/dy [1/mm per order], (order + 1, *y.shape, length_count)."""
        functions = self.family(y / self.trace_length, self.length_count, order=order)
        for derivative in range(1, order + 1):
            functions[derivative] /= self.trace_length**derivative
        return functions


def _unit_gauss(count: int) -> tuple[FloatArray, FloatArray]:
    points, weights = np.polynomial.legendre.leggauss(count)
    return 0.5 * (points + 1.0), 0.5 * weights


def _energy_roots(material: Material, shear_factor: float) -> FloatArray:
    """Matrix R with R^T R = D, the plane stress law with transverse shear (Kolivand 2009, Eq. 3.6a)."""
    nu, shear = material.poisson_ratio, np.sqrt(material.shear_modulus)
    roots = np.zeros((NUMBER_OF_STRAINS, NUMBER_OF_STRAINS))
    direct = np.sqrt(material.plane_strain_modulus)
    roots[STRAIN_X, STRAIN_X] = direct
    roots[STRAIN_X, STRAIN_Y] = direct * nu
    roots[STRAIN_Y, STRAIN_Y] = direct * np.sqrt(1.0 - nu**2)
    roots[SHEAR_XY, SHEAR_XY] = shear
    roots[SHEAR_XZ, SHEAR_XZ] = roots[SHEAR_YZ, SHEAR_YZ] = shear * np.sqrt(shear_factor)
    return roots


def stiffness_matrix(
    dimensions: ToothDimensions,
    material: Material,
    kinematics: Kinematics,
    functions: TrialFunctions,
    shear_factor: float = 1.0,
    foundation: ElasticFoundation | None = None,
) -> FloatArray:
    """Ritz stiffness matrix of a tooth (Kolivand 2009, Eq. 3.6-3.10).

    Parameters
    ----------
    dimensions
        The tooth.
    material
        Its material.
    kinematics
        The displacement assumption.
    functions
        The trial space.
    shear_factor
        Factor on the energy of the two transverse shear strains [-].
    foundation
        Springs along the root line; None for a clamped root.

    Returns
    -------
    Array
        Symmetric, shape (n_dof, n_dof) [N/mm], one unit of every coefficient being one millimetre (or radian).
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
    x_order, y_orders = kinematics.highest_x_derivative, kinematics.highest_y_derivative + 1
    over_height = {power: functions.over_height(x, power, x_order) for power in set(powers)}
    strain = np.zeros((*z.shape, NUMBER_OF_STRAINS, y_orders, len(powers), height_count))
    for term in kinematics.strain_terms:
        shape = over_height[powers[term.field]][term.x_derivative]
        coefficient = term.coefficient(z, metric) / stretch[..., None] ** (term.y_derivative + term.fans)
        strain[..., term.strain, term.y_derivative, term.field, :] += coefficient[..., None] * shape[:, :, None, :]
    columns = y_orders * len(powers) * height_count
    rooted = _energy_roots(material, shear_factor) @ strain.reshape(*z.shape, NUMBER_OF_STRAINS, columns)
    rooted *= np.sqrt(volume)[..., None, None]
    rooted = rooted.reshape(y.size, -1, columns)
    energy = np.swapaxes(rooted, 1, 2) @ rooted
    height_unknowns = len(powers) * height_count
    energy = energy.reshape(y.size, y_orders, height_unknowns, y_orders, height_unknowns)

    if foundation is not None:
        length_weight = functions.trace_length * station_weight * dimensions.stretch(0.0, y)
        energy[:, 0, :, 0, :] += _root_energy(dimensions, material, kinematics, functions, foundation, y, length_weight)

    # Lengthwise functions: K[a n, b m] = sum over stations and derivative orders of energy[a, b] Y_n Y_m.
    along = functions.along_trace(y, y_orders - 1)
    products = along[:, None, :, :, None] * along[None, :, :, None, :]
    summed = energy.transpose(2, 4, 1, 3, 0).reshape(height_unknowns**2, -1) @ products.reshape(
        y_orders**2 * y.size, functions.length_count**2
    )
    blocks = summed.reshape(height_unknowns, height_unknowns, functions.length_count, functions.length_count)
    stiffness = blocks.transpose(0, 2, 1, 3).reshape(functions.size, functions.size)
    return np.asarray(0.5 * (stiffness + stiffness.T))


def _root_energy(
    dimensions: ToothDimensions,
    material: Material,
    kinematics: Kinematics,
    functions: TrialFunctions,
    foundation: ElasticFoundation,
    y: FloatArray,
    length_weight: FloatArray,
) -> FloatArray:
    """Spring energy of the height functions at every lengthwise station, shape (stations, unknowns, unknowns)."""
    powers, count = functions.root_powers, functions.height_count
    terms = np.zeros((NUMBER_OF_ROOT_QUANTITIES, len(powers), count))
    for term in kinematics.root_terms:
        shape = functions.over_height(np.zeros(1), powers[term.field], term.x_derivative)[term.x_derivative, 0]
        terms[term.quantity, term.field] += term.sign * shape
    root = terms.reshape(NUMBER_OF_ROOT_QUANTITIES, -1)
    springs = foundation.stiffness(dimensions.thickness(0.0, y), material)
    return np.asarray(length_weight[:, None, None] * (root.T @ springs @ root))
