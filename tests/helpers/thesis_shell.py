"""The dissertation's shell: its displacement assumption and its monomials, as arguments of ``compliance.Shell``.

With z the distance from the mid-surface and g = 1 + z / r_c the displacements

    U = z (p_x - W,x),  V = z g p_y - z W,y,  W = W

are the only ones that give every term of Kolivand 2009, Eq. 3.5. They answer to radial loads only. On springs the
deflection loses the two powers that clamp it: at least 5 profile modes are needed.
"""

from __future__ import annotations

from math import perm

import numpy as np

from easeoff import InputError
from easeoff.contact.compliance.shell_kinematics import (
    ROOT_DEFLECTION,
    ROOT_ROTATION,
    SHEAR_XY,
    SHEAR_XZ,
    SHEAR_YZ,
    STRAIN_X,
    STRAIN_Y,
    DisplacementTerm,
    Kinematics,
    RootTerm,
    StrainTerm,
)
from easeoff.core.arrays import RealArray as Array


def thesis_kinematics(curvature: float, fanning: float) -> Kinematics:
    """Displacement assumption of the dissertation: the deflection W and two transverse shear strains p_x, p_y.

    The curvature is of the tooth trace, 1 / r_c [1/mm]; no displacement along the height, so fanning is refused.
    """
    if fanning:
        raise InputError(f"fanning = {fanning!r}: must be 0, the dissertation's shell has parallel heights only")
    w, px, py = range(3)
    terms = (
        StrainTerm(STRAIN_X, px, 1, 0, lambda z, g: z),
        StrainTerm(STRAIN_X, w, 2, 0, lambda z, g: -z),
        StrainTerm(STRAIN_Y, py, 0, 1, lambda z, g: z),
        StrainTerm(STRAIN_Y, w, 0, 2, lambda z, g: -z / g),
        StrainTerm(STRAIN_Y, w, 0, 0, lambda z, g: curvature / g),
        StrainTerm(SHEAR_XY, py, 1, 0, lambda z, g: z * g),
        StrainTerm(SHEAR_XY, w, 1, 1, lambda z, g: -z * (1.0 + 1.0 / g)),
        StrainTerm(SHEAR_XY, px, 0, 1, lambda z, g: z / g),
        StrainTerm(SHEAR_XZ, px, 0, 0, lambda z, g: np.ones_like(z)),
        StrainTerm(SHEAR_YZ, py, 0, 0, lambda z, g: g),
    )
    # The shear strains keep their zero at the root, so that there the slope of W is the rotation of the section.
    root = (RootTerm(ROOT_DEFLECTION, w, 0, 1.0), RootTerm(ROOT_ROTATION, w, 1, 1.0))
    return Kinematics(
        clamped_powers=(2, 1, 1),
        sprung_powers=(0, 1, 1),
        strain_terms=terms,
        root_terms=root,
        displacement_terms=(DisplacementTerm(2, w, "one"),),
    )


def monomials(relative: Array, count: int, *, order: int = 0) -> Array:
    """Values and derivatives of plain powers; parameters and result as ``shell.legendre``.

    They span the space of the Legendre polynomials, and lose all digits beyond about (5, 5) modes.
    """
    values = np.zeros((order + 1, *relative.shape, count))
    for derivative in range(order + 1):
        for degree in range(derivative, count):
            values[derivative, ..., degree] = perm(degree, derivative) * relative ** (degree - derivative)
    return values
