"""Spacing of the bricks of a tooth's lattice: along the face, up the flank and through the tooth."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ...core.checks import frozen_arrays
from .lattice_numbering import LatticeSize

Array = NDArray[Any]

EDGE_THICKNESS_RATIO = 0.12  # of the outer bricks through the tooth to the inner ones, for the root stress


def graded(count: int, ratio: float, steady: int = 3) -> Array:
    """Fractions (2 count + 1) from 0 to 1 of vertices and middles; the first ``steady`` intervals grow by ``ratio``."""
    sizes = ratio ** np.minimum(np.arange(count), steady)
    ends = np.concatenate([[0.0], np.cumsum(sizes)]) / sizes.sum()
    return with_middles(ends)


def with_middles(ends: Array) -> Array:
    """The ends (n + 1) of intervals and their middles between (2 n + 1)."""
    fractions = np.empty(2 * ends.size - 1)
    fractions[::2] = ends
    fractions[1::2] = 0.5 * (ends[1:] + ends[:-1])
    return fractions


@frozen_arrays
@dataclass(frozen=True)
class LatticeSpacing:
    """Ends and middles of the bricks of a tooth, from 0 to 1: an odd number of increasing fractions each.

    Parameters
    ----------
    lengthwise
        Lengthwise fractions.
    upward
        Of the length of a side from the middle of the fillet to the tip.
    through
        Of the thickness, from the loaded side.

    Examples
    --------
    >>> from easeoff.geometry import LatticeSize
    >>> LatticeSpacing.of_size(LatticeSize(lengthwise=2)).lengthwise
    array([0.  , 0.25, 0.5 , 0.75, 1.  ])
    """

    lengthwise: Array
    upward: Array
    through: Array

    @classmethod
    def of_size(cls, size: LatticeSize) -> LatticeSpacing:
        """Even along the face, smaller bricks near the fillet, thin ones at both sides."""
        return cls(graded(size.lengthwise, 1.0), graded(size.upward, 1.5), _both_ends(size.through))


def _both_ends(count: int) -> Array:
    """Fractions (2 count + 1) from side to side, with thinner bricks at both."""
    if count < 3:
        return graded(count, 1.0)
    sizes = np.minimum(np.arange(count), np.arange(count)[::-1])
    ends = np.concatenate([[0.0], np.cumsum(np.where(sizes == 0, EDGE_THICKNESS_RATIO, 1.0))])
    return with_middles(ends / ends[-1])
