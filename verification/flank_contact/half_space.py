"""A force on a half space: displacements and tractions of a point force.

The field of a normal point force on the surface of a half space (J. Boussinesq 1885; K. L. Johnson, Contact Mechanics,
1985, section 3.2) in vectors: with the unit normal N into the body, d from the force to the point, rho = |d| and
z = d . N,

    u = P / (4 pi G) [ z d / rho^3 + (3 - 4 nu) N / rho - (1 - 2 nu) grad ln(rho + z) ].

It also solves the equations of elasticity beyond the plane z = 0, up to the ray on which rho + z = 0.
"""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from ...contact.compliance.material import Material

Array = NDArray[Any]


def point_force_displacement(offset: Array, inward: Array, material: Material) -> Array:
    """Displacement under a unit force.

    Parameters
    ----------
    offset
        From the force to the points (..., 3) [mm].
    inward
        Unit normal into the body (..., 3), the direction of the force.
    material
        Of the body.

    Returns
    -------
    Array
        (..., 3) [mm/N].
    """
    nu = material.poisson_ratio
    shear = 0.5 * material.elastic_modulus / (1.0 + nu)
    rho = np.linalg.norm(offset, axis=-1, keepdims=True)
    z = np.sum(offset * inward, axis=-1, keepdims=True)
    gradient = (offset / rho + inward) / (rho + z)
    field = z * offset / rho**3 + (3.0 - 4.0 * nu) * inward / rho - (1.0 - 2.0 * nu) * gradient
    return np.asarray(field / (4.0 * np.pi * shear))


def point_force_traction(offset: Array, inward: Array, normal: Array, poisson_ratio: float) -> Array:
    """Traction of the field of a unit force on surfaces with given normals.

    Parameters
    ----------
    offset
        From the force to the points (..., 3) [mm].
    inward
        Unit normal into the body (..., 3), the direction of the force.
    normal
        Unit normals (..., 3) of the surfaces.
    poisson_ratio
        Of the body.

    Returns
    -------
    Array
        (..., 3) [MPa/N]; zero on the half space's own surface.
    """
    rho = np.linalg.norm(offset, axis=-1, keepdims=True)
    d, z = offset / rho, np.sum(offset * inward, axis=-1, keepdims=True) / rho
    along, facing = (np.sum(v * normal, axis=-1, keepdims=True) for v in (d, inward))
    hessian = (normal - d * along) / (1.0 + z) - (d + inward) * (along + facing) / (1.0 + z) ** 2
    free = z * normal - inward * along - d * facing - hessian
    return np.asarray(((1.0 - 2.0 * poisson_ratio) * free - 3.0 * z * d * along) / (2.0 * np.pi * rho**2))
