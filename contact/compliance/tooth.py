"""The tooth as the shell sees it: a circular trace, a height and a thickness, each varying linearly."""

from __future__ import annotations

import math
from dataclasses import dataclass, fields

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ...core.errors import InputError


@dataclass(frozen=True)
class ToothDimensions:
    """Dimensions of one tooth, taken as a piece of a circular cylindrical shell (Kolivand 2009, Fig. 3.1).

    Coordinates on the mid-surface: ``x`` [mm] is the height above the root line, ``y`` [mm] the arc length along the
    trace from the toe.

    Parameters
    ----------
    trace_length : float
        Length of the tooth trace from toe to heel, that is the developed face width [mm].
    trace_radius : float
        Radius of curvature of the tooth trace [mm], always positive: the cutter radius of a face-milled tooth, the
        local radius at mid-face of any other. ``math.inf`` gives a straight tooth.
    height_toe, height_heel : float
        Height of the tooth above the root line at the two ends [mm]; linear in between (Eq. 3.1b).
    root_thickness_toe, root_thickness_heel : float
        Thickness at the root line at the two ends [mm].
    tip_thickness_toe, tip_thickness_heel : float
        Thickness at the tip at the two ends [mm]. The dissertation has a single tip thickness: equal values give its
        Eq. 3.1a.

    Raises
    ------
    InputError
        If a dimension is not positive, or if the trace is so strongly curved that its centre lies inside the tooth.
    """

    trace_length: float
    trace_radius: float
    height_toe: float
    height_heel: float
    root_thickness_toe: float
    root_thickness_heel: float
    tip_thickness_toe: float
    tip_thickness_heel: float

    def __post_init__(self) -> None:
        for field in fields(self):
            value = getattr(self, field.name)
            allowed = value > 0.0 and (math.isfinite(value) or field.name == "trace_radius")
            if not allowed:
                raise InputError(f"tooth dimension {field.name} must be positive and finite [mm]; got {value!r}")
        if self.trace_radius <= 0.5 * self.largest_thickness:
            raise InputError(
                f"trace_radius must exceed half the largest tooth thickness, {0.5 * self.largest_thickness:.6g} mm; "
                f"got {self.trace_radius!r}"
            )

    @property
    def largest_height(self) -> float:
        """Height of the taller end [mm]."""
        return max(self.height_toe, self.height_heel)

    @property
    def largest_thickness(self) -> float:
        """Largest thickness anywhere on the tooth [mm]; it sits at one of the four corners."""
        return max(self.root_thickness_toe, self.root_thickness_heel, self.tip_thickness_toe, self.tip_thickness_heel)

    @property
    def trace_curvature(self) -> float:
        """Curvature of the tooth trace [1/mm]; zero for a straight tooth."""
        return 1.0 / self.trace_radius

    def height(self, y: ArrayLike) -> NDArray[np.float64]:
        """Tooth height above the root line (Kolivand 2009, Eq. 3.1b).

        Parameters
        ----------
        y : array_like
            Arc length from the toe [mm], any shape.

        Returns
        -------
        numpy.ndarray
            Height [mm], shape of ``y``.
        """
        fraction = np.asarray(y, dtype=np.float64) / self.trace_length
        return np.asarray(self.height_toe + (self.height_heel - self.height_toe) * fraction)

    def thickness(self, x: ArrayLike, y: ArrayLike) -> NDArray[np.float64]:
        """Tooth thickness, bilinear in the relative height and the relative length (Kolivand 2009, Eq. 3.1a).

        Parameters
        ----------
        x, y : array_like
            Height above the root line and arc length from the toe [mm]; broadcast together.

        Returns
        -------
        numpy.ndarray
            Thickness in the radial direction [mm], shape of the broadcast.
        """
        fraction = np.asarray(y, dtype=np.float64) / self.trace_length
        relative_height = np.asarray(x, dtype=np.float64) / self.height(y)
        root = self.root_thickness_toe + (self.root_thickness_heel - self.root_thickness_toe) * fraction
        tip = self.tip_thickness_toe + (self.tip_thickness_heel - self.tip_thickness_toe) * fraction
        return np.asarray(root + (tip - root) * relative_height)
