"""Derivatives of the potential contact segments of a mesh cycle: gap, lever arm, line contact."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ...lines.closest_approach import closest_approach
from ...lines.flank_splines import FlankSplines
from ...segments import DEPTHS, CycleSegments
from .field_directions import FieldDirections
from .line_motion import LineMotion

Array = NDArray[Any]

STEP = 1e-5  # of the flank, and of the range of a field, in differences of smooth functions of the fields
#: What a segment has of its own; the derivatives of all are those of the means over its quadrature points.
NAMES = ("separation_angle", "lever_arm", "curvature", *DEPTHS)


@dataclass(frozen=True)
class SegmentSlopes:
    """Derivatives of the segments of contact lines (n) by settings (j).

    Parameters
    ----------
    values
        The segments' own values (n) by name.
    slopes
        Their derivatives (n, j) by name.
    points
        Derivatives (2, m, count * g, j) of the quadrature points.
    steps
        Step of every setting (j) that moves points and fields by about ``STEP`` of their ranges.
    """

    values: dict[str, Array]
    slopes: dict[str, Array]
    points: Array
    steps: Array

    @classmethod
    def of(cls, segments: CycleSegments, directions: FieldDirections, motion: LineMotion) -> SegmentSlopes:
        """Derivatives of segments that move with their lines.

        Parameters
        ----------
        segments
            Of the contact lines.
        directions
            Fields and their derivatives.
        motion
            Of the lines.
        """
        on_lines = segments.on_lines
        points = on_lines.quadrature[0]
        moved = motion.quadrature(on_lines.lines, on_lines.count)
        steps = STEP / np.maximum(_sizes(directions), np.max(np.abs(moved), axis=(0, 1, 2)))
        slopes: dict[str, list[Array]] = {name: [] for name in NAMES}
        for j, step in enumerate(steps):
            ahead, behind = (
                _values(segments, directions.moved(j, sign * step), points + sign * step * moved[..., j])
                for sign in (1.0, -1.0)
            )
            for name in NAMES:
                slopes[name].append((ahead[name] - behind[name]) / (2.0 * step))
        found = {name: np.stack(columns, axis=-1) for name, columns in slopes.items()}
        found["length"] = np.repeat(motion.length / on_lines.count, on_lines.count, axis=0)
        values = _values(segments, segments.fields, points) | {"length": on_lines.names["length"]}
        return cls(values, found, moved, steps)


def _values(segments: CycleSegments, fields: FlankSplines, points: Array) -> dict[str, Array]:
    on_lines = segments.on_lines
    closest = closest_approach(fields, points)
    of_gap = {name: getattr(closest, name) for name in NAMES if name not in DEPTHS}
    return {name: on_lines.mean(values) for name, values in (of_gap | fields.evaluate(DEPTHS, points)).items()}


def _sizes(directions: FieldDirections) -> Array:
    """Greatest change (j) of any field by a unit of a setting, over the range of the field."""
    own = directions.base.spline.coefficients
    span = np.ptp(own, axis=(1, 2))
    change = np.abs(directions.slopes.spline.coefficients).max(axis=(1, 2)).reshape(len(own), directions.count)
    return np.asarray(np.maximum((change / span[:, None]).max(axis=0), 1e-300))
