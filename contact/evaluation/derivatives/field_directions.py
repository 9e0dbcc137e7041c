"""Splines of the contact's fields on the gear flank, moved along the derivatives by several settings."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ....core.errors import GeometryError
from ...lines.closest_approach import SEPARATION_FIELDS
from ...lines.contact_lines import BOUNDARY_FIELDS, bend_and_slope
from ...lines.flank_splines import FlankSplines, fit
from ...lines.opposite_points import PASSING_FIELDS
from ...lines.tensor_spline import TensorSpline

Array = NDArray[Any]

#: What contact depends on.
FIELDS = (
    "roll_angle",
    "ease_off_angle",
    "lever_arm",
    *BOUNDARY_FIELDS,
    *SEPARATION_FIELDS,
    "position",
    "depth_pinion",
    "depth_gear",
    *PASSING_FIELDS,
)
BEND_STEP = 1e-4  # of the greatest change of curvature and skew, in a difference of their bounded forms


@dataclass(frozen=True)
class FieldDirections:
    """Fields of a pair and their derivatives by settings (j).

    Parameters
    ----------
    base
        Splines of the ``FIELDS``.
    slopes
        Splines of their derivatives, the settings last.
    count
        Number of settings.
    """

    base: FlankSplines
    slopes: FlankSplines
    count: int

    @classmethod
    def of(cls, fields: FlankSplines, ease_off: Mapping[str, Array], slopes: Mapping[str, Array]) -> FieldDirections:
        """Splines through derivatives at the nodes.

        Parameters
        ----------
        fields
            Splines from ``loaded_splines``.
        ease_off
            Separation curvature and skew at the nodes (nt, nh).
        slopes
            From ``geometry.pair.field_slopes``.

        Raises
        ------
        GeometryError
            If a node that has a conjugate point has no derivatives.
        """
        curvature, skew = ease_off["separation_curvature"][..., None], ease_off["separation_skew"][..., None]
        by_curvature, by_skew = slopes["separation_curvature"], slopes["separation_skew"]
        sizes = [np.nanmax(np.abs(d) / (0.1 + np.abs(v))) for v, d in ((curvature, by_curvature), (skew, by_skew))]
        step = BEND_STEP / max(*sizes, 1e-300)
        ahead, behind = (
            bend_and_slope(curvature + sign * step * by_curvature, skew + sign * step * by_skew) for sign in (1.0, -1.0)
        )
        given = dict(slopes) | {
            name: (a - b) / (2.0 * step) for name, a, b in zip(SEPARATION_FIELDS, ahead, behind, strict=True)
        }
        found = fit(fields.lengthwise, fields.profile, {name: given[name] for name in FIELDS})
        if not np.array_equal(found.holes, fields.holes):
            raise GeometryError(
                "the flanks have no derivatives at some nodes: a setting moves the end of the flank there"
            )
        return cls(_part(fields), found, given["roll_angle"].shape[-1])

    def moved(self, setting: int, step: float) -> FlankSplines:
        """The fields after a step of one setting, to first order."""
        change = self.slopes.spline.coefficients.reshape(-1, self.count, *self.base.spline.coefficients.shape[1:])
        spline = TensorSpline(self.base.spline.intervals, self.base.spline.coefficients + step * change[:, setting])
        base = self.base
        return FlankSplines(spline, base.columns, base.holes, base.lengthwise, base.profile)


def _part(fields: FlankSplines) -> FlankSplines:
    """The ``FIELDS`` alone."""
    numbers, columns, start = [], {}, 0
    for name in FIELDS:
        own, shape = fields.columns[name]
        numbers.append(np.arange(own.start, own.stop))
        columns[name] = (slice(start, start := start + own.stop - own.start), shape)
    spline = fields.spline.part(np.concatenate(numbers))
    return FlankSplines(spline, columns, fields.holes, fields.lengthwise, fields.profile)
