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
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Literal

import numpy as np

from ...core.arrays import RealArray as Array

# Order of the strains in every strain vector.
STRAIN_X, STRAIN_Y, SHEAR_XY, SHEAR_XZ, SHEAR_YZ = range(5)
NUMBER_OF_STRAINS = 5

# Order of the root quantities on which an elastic foundation acts.
ROOT_DEFLECTION, ROOT_ROTATION, ROOT_HEIGHT_SHIFT, ROOT_TRACE_SHIFT, ROOT_TWIST = range(5)
NUMBER_OF_ROOT_QUANTITIES = 5


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

    field_names: tuple[str, ...]
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
        field_names=("W", "beta_x", "beta_theta", "u0", "v0"),
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
