"""Search for the displacements V and H at which a pattern is centred at a place of the flank.

Newton's method with Broyden's update of the derivatives: an evaluation is a whole unloaded analysis, and the centre
moves smoothly with V and H until the edges of the teeth cut the pattern. Steps are shortened until they lead nearer.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ...core.attributes import StoredStatus
from ...core.checks import frozen_arrays

Array = NDArray[Any]
#: Centre of the pattern (2) [mm], along the face and the profile, at displacements V and H (2) [mm]; NaN for none.
Centre = Callable[[Array], Array]

HALVING_COUNT_LIMIT = 4  # of a step that does not lead nearer
EVALUATION_COUNT_LIMIT = 40  # of the centre, in one search
LEAST_DECREASE = 0.05  # of the distance that a step must take off, as a share
STEP_SHARE = 0.01  # of the face; the longest step
DIFFERENCE_SHARE = 4e-4  # of the face; a step of V and H for derivatives
SHORT_SHARE = 1e-4  # of the face; shorter steps say nothing of the derivatives, the print has corners


class PatternStatus(StoredStatus):
    """How the search for a place of the pattern ended.

    Examples
    --------
    >>> PatternStatus(0).name
    'REACHED'
    """

    REACHED = 0
    NO_PATTERN = 1
    OUT_OF_RANGE = 2
    NOT_REACHED = 3


REASONS = {
    PatternStatus.REACHED: "",
    PatternStatus.NO_PATTERN: "there is no pattern at V = H = 0 to start from",
    PatternStatus.OUT_OF_RANGE: "V or H would exceed the range",
    PatternStatus.NOT_REACHED: "the pattern comes no nearer: it leaves the flank, or edges cut it off",
}


@frozen_arrays
@dataclass(frozen=True)
class Found:
    """The nearest place that a search came to.

    Parameters
    ----------
    displacement
        V and H (2) [mm].
    centre
        Of the pattern (2) [mm].
    slope
        Derivatives (2, 2) of the centre by V and H, as the search last knew them.
    status
        How it ended.
    """

    displacement: Array
    centre: Array
    slope: Array
    status: PatternStatus

    def distance(self, target: Array) -> float:
        """Distance from a place [mm]."""
        return float(np.linalg.norm(self.centre - target))


@dataclass
class PatternSearch:
    """Search with one way to compute the centre.

    Parameters
    ----------
    centre
        The centre as a function of V and H.
    face
        Length of the flank [mm].
    reach
        Greatest size of V and of H [mm].
    tolerance
        Greatest distance of the centre from its place [mm].

    Examples
    --------
    >>> slope = np.array([[-20.0, 5.0], [10.0, 10.0]])
    >>> search = PatternSearch(lambda x: np.array([15.0, 4.0]) + slope @ x + 3.0 * x**2, 30.0, 3.0, tolerance=1e-4)
    >>> found = search.find(np.array([10.0, 4.0]), search.start())
    >>> found.status.name, bool(found.distance(np.array([10.0, 4.0])) < 1e-4)
    ('REACHED', True)
    """

    centre: Centre
    face: float
    reach: float
    tolerance: float
    evaluations: int = field(default=0, init=False)

    def start(self, displacement: Array | None = None) -> Found:
        """Centre and its derivatives, by differences, at displacements (2) [mm]; at none if left out."""
        here = np.zeros(2) if displacement is None else displacement
        centre = self._centre(here)
        if not np.all(np.isfinite(centre)):
            return Found(here, centre, np.full((2, 2), np.nan), PatternStatus.NO_PATTERN)
        slope = self._slope(here, centre)
        known = bool(np.all(np.isfinite(slope)))
        return Found(here, centre, slope, PatternStatus.NOT_REACHED if known else PatternStatus.NO_PATTERN)

    def find(self, target: Array, start: Found) -> Found:
        """Displacements at which the centre is at a place (2) [mm], from where another search ended."""
        if start.status == PatternStatus.NO_PATTERN:
            return start
        here, centre, slope = start.displacement, self._centre(start.displacement), start.slope
        if not np.all(np.isfinite(centre)):
            return Found(here, centre, slope, PatternStatus.NO_PATTERN)
        last, fresh, was_cut = self.evaluations + EVALUATION_COUNT_LIMIT, False, False
        while np.linalg.norm(centre - target) > self.tolerance:
            step, cut = self._step(here, target - centre, slope)
            if cut and was_cut:
                return Found(here, centre, slope, PatternStatus.OUT_OF_RANGE)
            was_cut, moved = cut, None
            for _ in range(HALVING_COUNT_LIMIT):
                found = self._centre(here + step)
                if np.all(np.isfinite(found)):
                    if np.linalg.norm(step) > SHORT_SHARE * self.face:
                        slope = slope + np.outer(found - centre - slope @ step, step) / (step @ step)
                    nearer = np.linalg.norm(found - target) <= (1.0 - LEAST_DECREASE) * np.linalg.norm(centre - target)
                    if nearer:
                        moved = here + step, found
                        break
                step = 0.5 * step
            if moved is not None:
                (here, centre), fresh = moved, False
            elif cut or fresh or self.evaluations >= last:
                return Found(here, centre, slope, PatternStatus.OUT_OF_RANGE if cut else PatternStatus.NOT_REACHED)
            else:
                taken = self._slope(here, centre)
                if not np.all(np.isfinite(taken)):
                    return Found(here, centre, slope, PatternStatus.NOT_REACHED)
                slope, fresh = taken, True
        return Found(here, centre, slope, PatternStatus.REACHED)

    def _centre(self, displacement: Array) -> Array:
        self.evaluations += 1
        return self.centre(displacement)

    def _slope(self, here: Array, centre: Array) -> Array:
        """Derivatives (2, 2) of the centre by V and H, forward."""
        size = DIFFERENCE_SHARE * self.face
        return np.stack([(self._centre(here + step) - centre) / size for step in size * np.eye(2)], axis=1)

    def _step(self, here: Array, wanted: Array, slope: Array) -> tuple[Array, bool]:
        """Step (2) towards a change of the centre (2), not too long and within the range; whether that cut it."""
        step = np.linalg.lstsq(slope, wanted, rcond=1e-6)[0]
        longest = STEP_SHARE * self.face
        step = step * min(1.0, longest / max(float(np.linalg.norm(step)), 1e-300))
        cut = bool(np.any(np.abs(here + step) > self.reach))
        return (np.clip(here + step, -self.reach, self.reach) - here, True) if cut else (step, False)
