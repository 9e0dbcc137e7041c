"""Deflection that the free end of a tooth adds to plane line contact.

Plane strain holds the material along the contact line: it needs a stress s_y = nu (s_x + s_z), which a free end face
cannot carry. Taken off the end face of a quarter space under an even line load q that ends there, this stress lets the
flank sink deeper the nearer the end is: at the distance s from it flank and foot of the normal, at the depth h, approach
by a function of s / h alone, which falls off as its logarithm. Finite elements of the quarter space
(``verification.end_relief``) give, within 0.012 q (1 - nu^2) / E from s = h / 10 to 3 h for nu up to 0.4,

    delta = q / (pi E) nu (0.55 + 2.93 nu) ln(1 + nu (2.15 - 1.55 nu) h / s).

That is 2.4 times what plane stress in all that is deeper than s would make of it. With the distance a strip counts as
a line only where it is not as near to the end as it is wide: below some hundredths of the depth s levels off.
"""

from __future__ import annotations

import math
from typing import Any

import numpy as np
from numpy.typing import NDArray

from .material import Material

Array = NDArray[Any]

NEAREST_END = 0.03  # of the depth: where the distance from an end levels off


def free_end_deflection(depth: Array, distance: Array, material: Material) -> Array:
    """Deflection per line load that a free end adds [mm/(N/mm)].

    Parameters
    ----------
    depth
        Distance along the contact normal from the contact to the mid-surface of the tooth [mm].
    distance
        From the end, along the flank [mm]; not negative.
    material
        Of the tooth.

    Examples
    --------
    As a part of plane strain's unit (1 - nu^2) / E, a tenth of the depth from the end and twice the depth:

    >>> from easeoff.contact import STEEL
    >>> found = free_end_deflection(np.full(2, 3.0), np.array([0.3, 6.0]), STEEL)
    >>> (found * STEEL.plane_strain_modulus).round(2).tolist()
    [0.26, 0.03]
    """
    nu = material.poisson_ratio
    size = nu * (0.55 + 2.93 * nu) / (math.pi * material.elastic_modulus)
    reach = nu * (2.15 - 1.55 * nu) * depth
    return np.asarray(size * np.log1p(reach / np.hypot(distance, NEAREST_END * depth)))
