"""The pressed strip of a line contact: whole, or cut by the edge of a tooth.

A whole strip has Hertz's half-width b. Where the bodies would come closest a distance e beyond an edge, the strip
reaches from the edge to where the pressure falls to zero. With both bodies half planes, Chebyshev's expansion of the
pressure, of which the root is singular at the edge and bounded at the other end, gives its half-width a:

    3 a^2 + 2 e a = b^2.

Counting the gap from the edge, the deflection of a body under the line load q is that of a whole strip with a for b in
the logarithm, and q / (pi E*) 2 e / (2 e + 3 a) more. Its derivative is that of a whole strip with a for b.

The width is the same where the bodies come closest before the edge, less than b from it: e is negative then, down to
-b, where the strip becomes whole. So is the derivative, and the deflection is its integral from the load at which the
strip reaches the edge.

That the body ends at the edge is left to the bending of the tooth: near its corner it gives way more than a half plane.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

FloatArray = NDArray[np.float64]


def strip_half_width(overhang: FloatArray, squared: FloatArray) -> FloatArray:
    """Half-widths of strips cut by an edge, or whole where the overhang is NaN [mm].

    Parameters
    ----------
    overhang
        Distance of the strip's middle beyond the edge [mm], negative before it; NaN if there is no edge.
    squared
        Square of the half-width b of the whole strip under the same line load [mm^2].

    Examples
    --------
    >>> strip_half_width(np.array([np.nan, 0.0]), np.array([0.04, 0.12]))
    array([0.2, 0.2])
    """
    half = np.sqrt(squared)
    whole = ~(overhang > -half)
    e = np.where(whole, 0.0, overhang)
    return np.where(whole, half, squared / (np.sqrt(e * e + 3.0 * squared) + e))
