"""Elastic root: springs along the root line, for the dissertation's fitted base rotation and translation.

The gear body yields under the moment and the shear force of the tooth. Per unit length of the root line, with root
thickness t and a line load q at height l, the classical formulas (plane strain) give

    delta = q cos^2(alpha) (1 - nu^2) / E [ a (l/t)^2 + b (l/t) + c (1 + k tan^2(alpha)) ]

which is the work of a 2 x 2 flexibility between the root's moment and shear force (rotation a, coupling b/2,
deflection c) and of an axial flexibility c k. The inverse is a spring energy for the Ritz system: no coupling along
the face (Winkler), yet the tooth itself spreads the load.

The two remaining motions of a root section do not appear in a plane formula. Both load the body in antiplane shear,
whose half-space kernel ln(r) / (pi G) is the plane strain kernel 2 (1 - nu^2) ln(r) / (pi E) divided by (1 - nu):

    shift along the trace:  c / (1 - nu)        twist about the height:  a / (1 - nu)

Under a concentrated load across the tooth a rigid twist would lower the peak deflection by 4 %, a rigid shift by 0.2 %;
under a uniform load neither matters.
"""

from __future__ import annotations

from dataclasses import dataclass
from math import pi
from typing import Literal, NamedTuple, get_args

import numpy as np

from ...core.arrays import Array
from ...core.checks import one_of, positive
from .material import Material
from .shell_kinematics import (
    NUMBER_OF_ROOT_QUANTITIES,
    ROOT_DEFLECTION,
    ROOT_HEIGHT_SHIFT,
    ROOT_ROTATION,
    ROOT_TRACE_SHIFT,
    ROOT_TWIST,
)

FoundationSource = Literal["weber", "odonnell"]


class FoundationConstants(NamedTuple):
    """Dimensionless constants of the plane strain formula."""

    rotation: float  # a, under moment
    coupling: float  # b, twice that between rotation and deflection
    deflection: float
    axial_share: float  # k, axial over deflection flexibility


@dataclass(frozen=True)
class ElasticFoundation:
    """Line springs between the tooth root and a rigid support.

    Parameters
    ----------
    source
        ``weber``: a = 5.2, b = 1, c = 1.4, k = (1 - nu) / 2.4 (C. Weber 1949; the axial share as in Weber and
        Banaschek 1953, 0.29 for steel). Against finite elements of a body that is deep below the tooth it is within 2 %
        at the loaded tip.
        ``odonnell``: a = 16.67 / pi, b = 2 (1 - 2 nu) / (1 - nu), c = 1.534, k = 1 / (2.4 (1 + nu)) (W. J. O'Donnell
        1960, 1963, as used by R. W. Cornell 1981).
    factor
        Multiplies the flexibility [-]. O'Donnell's constants with 0.8 match a rim of 2.5 modules under the root,
        held at its bottom and ends, within 3 %.

    Raises
    ------
    InputError
        If the source is unknown or the factor is not positive. For a rigid root give the shell no foundation.

    Examples
    --------
    >>> ElasticFoundation("weber").constants(0.3).rotation
    5.2
    """

    source: FoundationSource = "weber"
    factor: float = 1.0

    def __post_init__(self) -> None:
        one_of("source", self.source, get_args(FoundationSource))
        positive("factor", self.factor)

    def constants(self, poisson_ratio: float) -> FoundationConstants:
        """Dimensionless constants of the source, before ``factor``."""
        nu = poisson_ratio
        if self.source == "weber":
            return FoundationConstants(5.2, 1.0, 1.4, (1.0 - nu) / 2.4)
        return FoundationConstants(16.67 / pi, 2.0 * (1.0 - 2.0 * nu) / (1.0 - nu), 1.534, 1.0 / (2.4 * (1.0 + nu)))

    def stiffness(self, root_thickness: Array, material: Material) -> Array:
        """Spring stiffness per unit length of the root line.

        Parameters
        ----------
        root_thickness
            Thickness at the root [mm], shape (n,).
        material
            Material of the body.

        Returns
        -------
        Array
            Symmetric positive definite, shape (n, 5, 5), between the root quantities in the order of the module
            ``shell_kinematics``: deflection, rotation, shift along the height, shift along the trace, twist
            [N, mm and rad per mm of root line].
        """
        a, b, c, k = self.constants(material.poisson_ratio)
        unit = self.factor / material.plane_strain_modulus
        t = root_thickness
        stiffness = np.zeros((t.size, NUMBER_OF_ROOT_QUANTITIES, NUMBER_OF_ROOT_QUANTITIES))
        # Inverse of unit * [[c, b/(2t)], [b/(2t), a/t^2]].
        determinant = (a * c - 0.25 * b**2) * unit
        stiffness[:, ROOT_DEFLECTION, ROOT_DEFLECTION] = a / determinant
        stiffness[:, ROOT_ROTATION, ROOT_ROTATION] = c * t**2 / determinant
        stiffness[:, ROOT_DEFLECTION, ROOT_ROTATION] = -0.5 * b * t / determinant
        stiffness[:, ROOT_ROTATION, ROOT_DEFLECTION] = -0.5 * b * t / determinant
        antiplane = 1.0 - material.poisson_ratio
        stiffness[:, ROOT_HEIGHT_SHIFT, ROOT_HEIGHT_SHIFT] = 1.0 / (c * k * unit)
        stiffness[:, ROOT_TRACE_SHIFT, ROOT_TRACE_SHIFT] = antiplane / (c * unit)
        stiffness[:, ROOT_TWIST, ROOT_TWIST] = antiplane * t**2 / (a * unit)
        return stiffness
