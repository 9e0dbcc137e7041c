"""Line contact near the end of a tooth, and near the end of a load on a tooth that goes on.

**Free ends.** Plane strain holds the material along the contact line: it needs a stress s_y = nu (s_x + s_z), which a
free end face cannot carry. Taken off the end face of a quarter space under an even line load q that ends there, this
stress lets the flank sink deeper the nearer the end is: at the distance s from it flank and foot of the normal, at the
depth h, approach by a function of s / h alone, which falls off as its logarithm. Finite elements of the quarter space
(``verification.end_relief``) give, within 0.012 q (1 - nu^2) / E from s = 0.03 h to 3 h for nu up to 0.4,

    delta = q / (pi E) nu (0.55 + 2.93 nu) ln(1 + nu (2.15 - 1.55 nu) h / s).

A line at an angle a to the normal of the end's edge gains more: q and h each over cos a, within 0.05 at 30 degrees and
0.09 at 45. With the distance a strip counts as a line only where it is not as near to the end as it is wide: below some
hundredths of the depth s levels off.

**Ends of a load.** Where one member's tooth ends, that of the other may go on. On a body that goes on a load indents
its own end half as far as plane strain has it: the load is missing beyond. By Boussinesq's field of a half space what
is missing from a distance s on has in the approach of flank and foot

    m(s) = q (1 - nu^2) / (pi E) [ln(h / 2 s) + asinh(s / h) - (1 - s / r) / (2 (1 - nu))],    r^2 = s^2 + h^2,

and the body's own end mirrors the load, as a free face does but for the stress above. So much less the line contact
deflects; as it must stiffen with every load, its depth is made smaller instead, to h exp(-pi m E / (2 q (1 - nu^2))),
which takes the same off the logarithm of narrow strips.
"""

from __future__ import annotations

import math
from typing import Any

import numpy as np
from numpy.typing import NDArray

from .material import Material

Array = NDArray[Any]

NEAREST_END = 0.03  # of the depth: where the distance from an end levels off
COSINE_MINIMUM = math.sqrt(0.5)  # of the angle between line and end's normal: finite elements go to 45 degrees


def free_end_deflection(depth: Array, distance: Array, material: Material, cosine: Array | float = 1.0) -> Array:
    """Deflection per line load that a free end adds [mm/(N/mm)].

    Parameters
    ----------
    depth
        Distance along the contact normal from the contact to the mid-surface of the tooth [mm].
    distance
        From the end, along the flank at right angles to its edge [mm]; not negative.
    material
        Of the tooth.
    cosine
        Of the angle between contact line and the normal of the end's edge.

    Examples
    --------
    As a part of plane strain's unit (1 - nu^2) / E, a tenth of the depth from the end and twice the depth:

    >>> from easeoff.contact import STEEL
    >>> found = free_end_deflection(np.full(2, 3.0), np.array([0.3, 6.0]), STEEL)
    >>> (found * STEEL.plane_strain_modulus).round(2).tolist()
    [0.26, 0.03]
    """
    nu, leaning = material.poisson_ratio, np.maximum(cosine, COSINE_MINIMUM)
    size = nu * (0.55 + 2.93 * nu) / (math.pi * material.elastic_modulus * leaning)
    reach = nu * (2.15 - 1.55 * nu) * depth / leaning
    return np.asarray(size * np.log1p(reach / np.hypot(distance, NEAREST_END * depth)))


def remaining_depth(depth: Array, load_end: Array, distance: Array, material: Material) -> Array:
    """Depth of the line contact near the end of a load, over that of the mid-surface.

    Parameters
    ----------
    depth, distance, material
        As of ``free_end_deflection``.
    load_end
        Distance from the end of the load [mm], not above that from the end of the tooth.

    Examples
    --------
    >>> from easeoff.contact import STEEL
    >>> distance = np.array([0.5, 1.0, 9.0])
    >>> remaining_depth(np.full(3, 3.0), np.full(3, 0.5), distance, STEEL).round(2).tolist()
    [1.0, 0.75, 0.72]
    """
    missing = _missing(depth, load_end, material) - _missing(depth, 2.0 * distance - load_end, material)
    return np.asarray(np.exp(-0.5 * math.pi * np.maximum(missing, 0.0)))


def _missing(depth: Array, distance: Array, material: Material) -> Array:
    """What an even load from a distance on has in the approach of flank and foot, in units of q (1 - nu^2) / E."""
    away = np.hypot(distance, NEAREST_END * depth)
    along = np.log(0.5 * depth / away) + np.arcsinh(away / depth)
    strained = 0.5 * (1.0 - away / np.hypot(away, depth)) / (1.0 - material.poisson_ratio)
    return np.asarray((along - strained) / math.pi)
