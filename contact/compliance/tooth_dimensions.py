"""Dimensions of the shell that stands for a tooth: circular trace, linear height and thickness."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np
from numpy.typing import ArrayLike

from ...core.arrays import RealArray as Array
from ...core.checks import bounded, check_fields
from ...core.errors import InputError

LENGTH = bounded("mm", above=0.0)


@dataclass(frozen=True)
class ToothDimensions:
    """Dimensions of one tooth as a piece of a circular cylindrical shell (Kolivand 2009, Fig. 3.1).

    Coordinates on the mid-surface: ``x`` [mm] is the height above the root line, ``y`` [mm] the arc length along the
    trace from the toe.

    Parameters
    ----------
    trace_length
        Length of the tooth trace from toe to heel, that is the developed face width [mm].
    trace_radius
        Radius of curvature of the tooth trace [mm], always positive: the cutter radius of a face-milled tooth, the
        local radius at mid-face of any other. ``math.inf`` gives a straight tooth.
    height_toe, height_heel
        Height of the tooth above the root line at the two ends [mm]; linear in between (Eq. 3.1b).
    root_thickness_toe, root_thickness_heel
        Thickness at the root line at the two ends [mm].
    tip_thickness_toe, tip_thickness_heel
        Thickness at the tip at the two ends [mm]. The dissertation has a single tip thickness: equal values give its
        Eq. 3.1a.
    bulge_toe, bulge_heel
        Extra thickness at mid height over an even taper, at the two ends [mm]; a parabola over the height.
    fanning
        Growth of the trace's length per height, over its length at mid height [1/mm]. The heights of a pinion with few
        teeth fan out from its axis.

    Raises
    ------
    InputError
        If a dimension is not positive, or if the trace is so strongly curved that its centre lies inside the tooth.

    Examples
    --------
    >>> tooth = ToothDimensions(36.0, 95.25, 7.0, 9.5, 5.5, 7.5, 2.5, 2.5)
    >>> float(tooth.height(18.0)), float(tooth.thickness(0.0, 18.0))
    (8.25, 6.5)
    """

    trace_length: float = field(metadata=LENGTH)
    trace_radius: float = field(metadata=LENGTH | {"infinite": True})
    height_toe: float = field(metadata=LENGTH)
    height_heel: float = field(metadata=LENGTH)
    root_thickness_toe: float = field(metadata=LENGTH)
    root_thickness_heel: float = field(metadata=LENGTH)
    tip_thickness_toe: float = field(metadata=LENGTH)
    tip_thickness_heel: float = field(metadata=LENGTH)
    bulge_toe: float = field(default=0.0, metadata=bounded("mm"))
    bulge_heel: float = field(default=0.0, metadata=bounded("mm"))
    fanning: float = field(default=0.0, metadata=bounded("1/mm"))

    def __post_init__(self) -> None:
        check_fields(self)
        thinnest = self.thickness(np.linspace(0.0, 1.0, 9)[:, None] * self.height(self._ends), self._ends)
        if not thinnest.min() > 0.0:
            bulges = f"bulge_toe = {self.bulge_toe!r}, bulge_heel = {self.bulge_heel!r} mm"
            raise InputError(f"{bulges}: must leave the tooth some thickness")
        if not abs(self.fanning) * self.largest_height < 1.0:
            raise InputError(f"fanning = {self.fanning!r} 1/mm: must be below {1.0 / self.largest_height:.6g} in size")
        if self.trace_radius <= 0.5 * self.largest_thickness:
            raise InputError(
                f"trace_radius = {self.trace_radius!r} mm: must be greater than half the largest tooth thickness, "
                f"{0.5 * self.largest_thickness:.6g} mm"
            )

    @property
    def largest_height(self) -> float:
        """Height of the taller end [mm]."""
        return max(self.height_toe, self.height_heel)

    @property
    def largest_thickness(self) -> float:
        """Largest thickness anywhere on the tooth [mm]: at one of the four corners, or a little less with a bulge."""
        corners = (self.root_thickness_toe, self.root_thickness_heel, self.tip_thickness_toe, self.tip_thickness_heel)
        return max(corners) + max(self.bulge_toe, self.bulge_heel, 0.0)

    @property
    def _ends(self) -> Array:
        """Arc lengths of toe and heel [mm]."""
        return np.array([0.0, self.trace_length])

    @property
    def trace_curvature(self) -> float:
        """Curvature of the tooth trace [1/mm]; zero for a straight tooth."""
        return 1.0 / self.trace_radius

    def height(self, y: ArrayLike) -> Array:
        """Tooth height above the root line (Kolivand 2009, Eq. 3.1b).

        Parameters
        ----------
        y
            Arc length from the toe [mm], any shape.

        Returns
        -------
        Array
            Height [mm], shape of ``y``.
        """
        fraction = np.asarray(y, dtype=np.float64) / self.trace_length
        return np.asarray(self.height_toe + (self.height_heel - self.height_toe) * fraction)

    def thickness(self, x: ArrayLike, y: ArrayLike) -> Array:
        """Tooth thickness (Kolivand 2009, Eq. 3.1a): bilinear in the relative height and length, plus the bulge.

        Parameters
        ----------
        x, y
            Height above the root line and arc length from the toe [mm]; broadcast together.

        Returns
        -------
        Array
            Thickness in the radial direction [mm], shape of the broadcast.
        """
        fraction = np.asarray(y, dtype=np.float64) / self.trace_length
        relative_height = np.asarray(x, dtype=np.float64) / self.height(y)
        root = self.root_thickness_toe + (self.root_thickness_heel - self.root_thickness_toe) * fraction
        tip = self.tip_thickness_toe + (self.tip_thickness_heel - self.tip_thickness_toe) * fraction
        bulge = self.bulge_toe + (self.bulge_heel - self.bulge_toe) * fraction
        even = root + (tip - root) * relative_height
        return np.asarray(even + 4.0 * bulge * relative_height * (1.0 - relative_height))

    def stretch(self, x: ArrayLike, y: ArrayLike) -> Array:
        """Length along the trace at a height over that at mid height.

        Parameters
        ----------
        x, y
            Height above the root line and arc length from the toe [mm]; broadcast together.
        """
        return np.asarray(1.0 + self.fanning * (np.asarray(x, dtype=np.float64) - 0.5 * self.height(y)))
