"""Strain-displacement relations of the circular cylindrical shell, written as tables of terms.

With ``z`` the distance from the mid-surface along its outward radius and ``g = 1 + z / r_c``, the exact strains of a
cylinder (A. W. Leissa, Vibration of Shells, NASA SP-288, 1973; Kolivand 2009, Eq. 3.4) are, in height ``x`` and arc
length ``y``,

    e_x  = U,x                    g_xy = U,y / g + V,x
    e_y  = (V,y + W / r_c) / g    g_xz = W,x + U,z
                                  g_yz = (W,y - V / r_c) / g + V,z

The displacements are those of the standard first-order shear theory,

    U = u0 + z b_x,  V = g v0 + z b_y,  W = W,

with the mid-surface displacements u0, v0 and the section rotations b_x, b_y. It can carry forces along the tooth as
well as across it. ``verification.shell_root_stress`` has the dissertation's own assumption.

The root stands on springs along its line, for the dissertation's fitted base rotation and translation. The gear body
yields under the moment and the shear force of the tooth. Per unit length of the root line, with root thickness t and a
line load q at height l, the classical formulas (plane strain) give

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

from collections.abc import Callable
from dataclasses import dataclass, field
from math import pi
from typing import Literal, NamedTuple

import numpy as np

from ...core.arrays import RealArray as Array
from ...core.checks import bounded, check_fields
from .material import Material

# Order of the strains in every strain vector.
STRAIN_X, STRAIN_Y, SHEAR_XY, SHEAR_XZ, SHEAR_YZ = range(5)
NUMBER_OF_STRAINS = 5

# Order of the root quantities on which an elastic foundation acts.
ROOT_DEFLECTION, ROOT_ROTATION, ROOT_HEIGHT_SHIFT, ROOT_TRACE_SHIFT, ROOT_TWIST = range(5)
NUMBER_OF_ROOT_QUANTITIES = 5


def energy_roots(material: Material, shear_factor: float) -> Array:
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


@dataclass(frozen=True)
class StrainTerm:
    """One term of a strain: coefficient(z, g) times a derivative of one field.

    It is divided by the stretch of the trace at the height, once for each lengthwise derivative, and once if it
    ``fans``: if it is there only because the heights fan out.
    """

    strain: int
    field: int
    x_derivative: int
    y_derivative: int
    coefficient: Callable[[Array, Array], Array]
    fans: bool = False


@dataclass(frozen=True)
class RootTerm:
    """One root quantity: sign times a height derivative of one field, at the root line."""

    quantity: int
    field: int
    x_derivative: int
    sign: float


@dataclass(frozen=True)
class DisplacementTerm:
    """Part of a displacement that one field makes: 1 or g for a mid-surface field, z for a rotation.

    ``component`` counts along the height, along the trace, along the outward radius.
    """

    component: int
    field: int
    coefficient: Literal["one", "metric", "offset"]


@dataclass(frozen=True)
class Kinematics:
    """A displacement assumption: its fields, strains, root conditions and mid-surface displacements."""

    clamped_powers: tuple[int, ...]  # exponents of the relative height, by field
    sprung_powers: tuple[int, ...]
    strain_terms: tuple[StrainTerm, ...]
    root_terms: tuple[RootTerm, ...]
    displacement_terms: tuple[DisplacementTerm, ...]


#: Kinematics of a tooth from the curvature of its trace and the fanning of its heights [1/mm].
DisplacementAssumption = Callable[[float, float], Kinematics]


def five_field(curvature: float, fanning: float) -> Kinematics:
    """First-order shear theory: W, b_x, b_y, u0, v0; curvature 1 / r_c of the trace and fanning of the tooth [1/mm]."""
    w, bx, by, u0, v0 = range(5)
    # As in polar coordinates: what moves up the tooth gets longer, and turning with the heights is no shear.
    fan = (
        StrainTerm(STRAIN_Y, u0, 0, 0, lambda z, g: fanning / g, fans=True),
        StrainTerm(STRAIN_Y, bx, 0, 0, lambda z, g: fanning * z / g, fans=True),
        StrainTerm(SHEAR_XY, v0, 0, 0, lambda z, g: -fanning * g, fans=True),
        StrainTerm(SHEAR_XY, by, 0, 0, lambda z, g: -fanning * z, fans=True),
    )
    terms = (
        StrainTerm(STRAIN_X, u0, 1, 0, lambda z, g: np.ones_like(z)),
        StrainTerm(STRAIN_X, bx, 1, 0, lambda z, g: z),
        StrainTerm(STRAIN_Y, v0, 0, 1, lambda z, g: np.ones_like(z)),
        StrainTerm(STRAIN_Y, by, 0, 1, lambda z, g: z / g),
        StrainTerm(STRAIN_Y, w, 0, 0, lambda z, g: curvature / g),
        StrainTerm(SHEAR_XY, u0, 0, 1, lambda z, g: 1.0 / g),
        StrainTerm(SHEAR_XY, bx, 0, 1, lambda z, g: z / g),
        StrainTerm(SHEAR_XY, v0, 1, 0, lambda z, g: g),
        StrainTerm(SHEAR_XY, by, 1, 0, lambda z, g: z),
        StrainTerm(SHEAR_XZ, w, 1, 0, lambda z, g: np.ones_like(z)),
        StrainTerm(SHEAR_XZ, bx, 0, 0, lambda z, g: np.ones_like(z)),
        StrainTerm(SHEAR_YZ, w, 0, 1, lambda z, g: 1.0 / g),
        StrainTerm(SHEAR_YZ, by, 0, 0, lambda z, g: 1.0 / g),
    )
    # b_x > 0 moves the outer side up the tooth, so the section leans towards -W: hence the sign of the rotation.
    root = (
        RootTerm(ROOT_DEFLECTION, w, 0, 1.0),
        RootTerm(ROOT_ROTATION, bx, 0, -1.0),
        RootTerm(ROOT_HEIGHT_SHIFT, u0, 0, 1.0),
        RootTerm(ROOT_TRACE_SHIFT, v0, 0, 1.0),
        RootTerm(ROOT_TWIST, by, 0, 1.0),
    )
    return Kinematics(
        clamped_powers=(1, 1, 1, 1, 1),
        sprung_powers=(0, 0, 0, 0, 0),
        strain_terms=(*terms, *fan) if fanning else terms,
        root_terms=root,
        displacement_terms=(
            DisplacementTerm(0, u0, "one"),
            DisplacementTerm(0, bx, "offset"),
            DisplacementTerm(1, v0, "metric"),
            DisplacementTerm(1, by, "offset"),
            DisplacementTerm(2, w, "one"),
        ),
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
    factor: float = field(default=1.0, metadata=bounded(above=0.0))

    def __post_init__(self) -> None:
        check_fields(self)

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
