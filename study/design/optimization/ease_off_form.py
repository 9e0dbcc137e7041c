"""Form of the ease-off at some nodes of the flank, a rotation left out, and its change by the settings."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ....geometry.pair.ease_off import exact_ease_off
from ....geometry.pair.gear_pair import GearPair
from .aim import Reading
from .contact_quantity import turned

Array = NDArray[np.float64]

#: Nodes lengthwise and along the profile.
FORM_NODES = (9, 7)
_GRID = ("lengthwise", "profile")


@dataclass(frozen=True, eq=False)
class EaseOffForm:
    """Ease-off of one pair of flanks.

    Parameters
    ----------
    lengthwise, profile
        Fractions of the nodes.
    lever_arm
        At the nodes (s) [mm]; NaN where the flanks have no common part.
    value
        Ease-off (s) [um].
    slopes
        Its derivatives (s, n) by the settings, a rotation left out.
    """

    lengthwise: Array
    profile: Array
    lever_arm: Array
    value: Array
    slopes: Array

    @classmethod
    def of(cls, reading: Reading) -> EaseOffForm:
        """Form of an analysis with derivatives."""
        values = reading.values
        rows, columns = (
            np.unique(np.linspace(0, values.sizes[name] - 1, count).round().astype(int))
            for name, count in zip(_GRID, FORM_NODES, strict=True)
        )
        chosen = np.ix_(rows, columns)
        arm, value = (values[name].transpose(*_GRID).values[chosen].ravel() for name in ("lever_arm", "ease_off"))
        change = reading.slopes["ease_off"].transpose(*_GRID, "setting").values[chosen]
        known = np.where(np.isfinite(value), arm, np.nan)
        slopes = turned(change.reshape(arm.size, -1), known)
        t, h = (values[name].values[own] for name, own in zip(_GRID, (rows, columns), strict=True))
        return cls(t, h, known, value, slopes)

    def missed(self, pair: GearPair, step: Array) -> Array:
        """What another pair lacks of the form after a step (n) to first order (s) [um]; zero where either is unknown.

        Raises
        ------
        GeometryError
            If its flanks do not meet.
        """
        gear = pair.gear.flank(self.lengthwise, self.profile)
        exact = exact_ease_off(gear, pair.pinion.loaded, pair.pinion.section, pair.assembly)
        found = self.value + self.slopes @ step - 1e3 * exact.angle * exact.lever_arm
        return turned(found[:, None], self.lever_arm)[:, 0]
