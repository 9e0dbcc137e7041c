"""Projection plane: the axial plane of a member, into which every point of its flank is turned about the axis.

There the flank is a quadrangle and its grid is bilinear, so that its corners describe it completely.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
import xarray as xr
from numpy.typing import NDArray

from ...core.checks import frozen_arrays
from ...core.ordered_values import ordered
from ...geometry.tooth.tooth_flanks import MemberName

Array = NDArray[Any]


@frozen_arrays
@dataclass(frozen=True)
class ProjectionPlane:
    """Bilinear map from the fractions of a flank to its projection plane.

    Parameters
    ----------
    coefficients
        Coefficients (2, 4) of 1, t, h and t h, for both coordinates of the plane [mm].

    Examples
    --------
    >>> plane = ProjectionPlane(np.array([[0.0, 30.0, 0.0, 0.0], [0.0, 0.0, 8.0, 2.0]]))
    >>> plane(np.array([1.0, 1.0])).tolist()
    [30.0, 10.0]
    """

    coefficients: Array

    @classmethod
    def of(cls, flanks: xr.Dataset, member: MemberName = "gear") -> ProjectionPlane:
        """Plane of a flank of ``geometry.pair_geometry``; the nodes that have a position are enough.

        The first coordinate runs from toe to heel at half height, from zero at the toe; the second is zero at the lower
        of the root's corners.
        """
        own = int(np.flatnonzero(ordered(flanks, "member", "member") == member)[0])
        position = ordered(flanks, "position", "member", "lengthwise", "profile", "xyz")[own]
        t, h = np.meshgrid(*(ordered(flanks, name, name) for name in ("lengthwise", "profile")), indexing="ij")
        valid = np.all(np.isfinite(position), axis=-1)
        axial, radial = position[valid][:, 2], np.hypot(position[valid][:, 0], position[valid][:, 1])
        t, h = t[valid], h[valid]
        basis = np.stack([np.ones_like(t), t, h, t * h], axis=1)
        section = np.linalg.lstsq(basis, np.stack([axial, radial], axis=1))[0].T
        along = section[:, 1] + 0.5 * section[:, 3]
        along /= np.linalg.norm(along)
        up = np.array([-along[1], along[0]])
        if up @ (section[:, 2] + 0.5 * section[:, 3]) < 0.0:
            up = -up
        plane = np.stack([along, up]) @ section
        plane[0, 0] = -0.5 * plane[0, 2]
        plane[1, 0] = -min(0.0, plane[1, 1])
        return cls(np.asarray(plane))

    def __call__(self, points: Array) -> Array:
        """Coordinates in the plane (2, ...) [mm] of lengthwise and profile fractions (2, ...)."""
        t, h = points
        return np.asarray(np.tensordot(self.coefficients, np.stack([np.ones_like(t), t, h, t * h]), axes=1))
