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

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

FloatArray = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class PressedStrip:
    """Pressed strips, in arrays of one shape.

    Parameters
    ----------
    half_width
        Half of the width [mm].
    growth
        Slope of the logarithm of the half-width by that of the load; one half for a whole strip.
    cut
        What an overhang adds to the deflection, in units of q (1/E1* + 1/E2*) / pi.
    cut_slope
        What it adds to the slope of the deflection by the load, in those units over q, beside what the half-width does.
    """

    half_width: FloatArray
    growth: FloatArray
    cut: FloatArray
    cut_slope: FloatArray

    @classmethod
    def of(cls, overhang: FloatArray, squared: FloatArray) -> PressedStrip:
        """Strips cut by an edge, or whole where the overhang is NaN.

        Parameters
        ----------
        overhang
            Distance of the strip's middle beyond the edge [mm], negative before it; NaN if there is no edge.
        squared
            Square of the half-width b of the whole strip under the same line load [mm^2].
        """
        half = np.sqrt(squared)
        whole = ~(overhang > -half)
        if whole.all():  # the usual case, in the innermost loop of the contact
            nothing = np.zeros_like(squared)
            return cls(half, np.full_like(squared, 0.5), nothing, nothing)
        e = np.where(whole, 0.0, overhang)
        a = squared / (np.sqrt(e * e + 3.0 * squared) + e)
        ends, twice = 2.0 * e + 3.0 * a, 2.0 * e + 6.0 * a
        cut = 2.0 * np.maximum(e, 0.0) / ends
        return cls(
            np.where(whole, half, a),
            np.where(whole, 0.5, ends / twice),
            cut,
            cut * (1.0 - 3.0 * a / twice),
        )
