"""Members of a pair on their supports over a mesh cycle, for the contact problems of its segments."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from ..segments import Segments
from .mesh_wrench import MeshWrenches
from .support_modes import SupportModes

Array = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class HeldMembers:
    """Supports at every mesh position (k)."""

    modes: Sequence[SupportModes]
    wrenches: MeshWrenches

    def holding(self, segments: Sequence[Segments | None]) -> list[Segments | None]:
        """The segments of every mesh position with its supports."""
        both = zip(segments, self.modes, strict=True)
        return [
            None if position_segments is None else replace(position_segments, held=modes)
            for position_segments, modes in both
        ]

    def closing(self, segments: Segments, force: Array) -> float:
        """Rotation [rad] by which some gap on the flank closes farther, by the members' motion, than the gear turns."""
        wrenches = self.wrenches
        return -float(np.min(wrenches.flank @ segments.moved(force) / wrenches.lever_arm))
