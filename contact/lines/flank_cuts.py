"""How far the cut of one flank part lies from where it ends: at its blade section's ends, or where another cuts deeper.

A blade with a toprem or flankrem cuts every part of the flank with a section of its own. Where sections join at a
protruding kink both cut the same points, and the deeper cut remains (``geometry/flanks/flank_parts.py``).
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

Array = NDArray[Any]

KINK_LIMIT = 1e-5  # [rad per fraction of the flank]; below it two cuts join smoothly, and their sections' ends decide


@dataclass(frozen=True)
class FlankCuts:
    """What every part (p) of a flank cuts at points (n), with derivatives by the fractions.

    Parameters
    ----------
    depth, depth_slope
        How much metal the part removes, as a rotation of the member that opens the gap (p, n), and its derivatives
        (p, 2, n) [rad].
    coordinate, coordinate_slope
        Coordinate along the blade as a fraction of the flank's depth (p, n), and its derivatives (p, 2, n).
    begin, end
        Ends (p) of the sections in that coordinate; the lowest part begins where the edge radius of the blade ends.
    known
        Where the part has a point (p, n).
    """

    depth: Array
    depth_slope: Array
    coordinate: Array
    coordinate_slope: Array
    begin: Array
    end: Array
    known: NDArray[np.bool_]

    def margins(self, part: NDArray[np.int8]) -> tuple[Array, Array]:
        """How far inside its bounds the cut of one part (n) lies, as fractions (3, n), and the derivatives (3, 2, n).

        From the beginning of its section, from the end of it, and from where another part cuts deeper.
        """
        columns = np.arange(part.size)
        depth, depth_slope = self.depth[part, columns], self.depth_slope[part, :, columns].T
        coordinate, slope = self.coordinate[part, columns], self.coordinate_slope[part, :, columns].T
        cut, cut_slope = np.full(part.size, np.inf), np.zeros((2, part.size))
        for other in range(self.begin.size if self.begin.size > 1 else 0):
            away, away_slope = self._beyond(other)
            with np.errstate(all="ignore"):
                # Both as distances on the flank: from where the other section ends, and from where it cuts as deep.
                steepness = np.linalg.norm(depth_slope - self.depth_slope[other], axis=0)
                kinked = steepness > KINK_LIMIT
                scale = np.where(kinked, np.linalg.norm(away_slope, axis=0) / steepness, 0.0)
                deeper = scale * (depth - self.depth[other])
                kinked &= deeper > away
            away = np.where(kinked, deeper, away)
            away_slope = np.where(kinked, scale * (depth_slope - self.depth_slope[other]), away_slope)
            nearer = (part != other) & self.known[other] & (away < cut)
            cut, cut_slope = np.where(nearer, away, cut), np.where(nearer, away_slope, cut_slope)
        own = [coordinate - self.begin[part], self.end[part] - coordinate, cut]
        return np.stack(own), np.stack([slope, -slope, cut_slope])

    def _beyond(self, part: int) -> tuple[Array, Array]:
        """How far points (n) lie beyond the nearer end of a part's section, and the derivatives (2, n)."""
        coordinate, slope = self.coordinate[part], self.coordinate_slope[part]
        below = self.begin[part] - coordinate if part > 0 else np.full(coordinate.size, -np.inf)
        above = coordinate - self.end[part]
        return np.maximum(below, above), np.where(below > above, -slope, slope)
