"""Supports as modes of the contact problem, and as a change of its separations."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from ...core.checks import frozen_arrays
from ..problem.modal_basis import ModalBasis, with_shared_modes

Array = NDArray[np.float64]
ROTATION_LENGTH = 100.0  # [mm]; makes rotations comparable with translations, matters for rounding alone
DROPPED_SHARE = 1e-15  # of the greatest eigenvalue of the compliance


@frozen_arrays
@dataclass(frozen=True, eq=False)
class SupportModes:
    """Part of the supports in the contact problem of a mesh position."""

    compliance: Array  # twist of pinion to gear for wrench on the pinion, about the origin (6, 6)
    absorbed: Array  # twist (6) that is in the separations already

    @cached_property
    def mixing(self) -> Array:
        """L (6, s) with L L' the compliance, of as few columns as it has directions."""
        scale = np.repeat([1.0, ROTATION_LENGTH], 3)
        values, vectors = np.linalg.eigh(self.compliance * np.outer(scale, scale))
        kept = values > DROPPED_SHARE * max(values[-1], 0.0)
        return np.asarray(vectors[:, kept] * np.sqrt(values[kept]) / scale[:, None])

    def twist(self, wrench: Array) -> Array:
        """Twist (..., 6) of the pinion relative to the gear under wrenches (..., 6) on the pinion about the origin."""
        return np.asarray(wrench @ self.compliance)

    def basis(self, bending: ModalBasis, wrenches: Array) -> ModalBasis:
        """The modes of the teeth with those of the supports, for unit wrenches (n, 6) at the segments."""
        mixing = self.mixing
        if mixing.shape[1] == 0:
            return bending
        return with_shared_modes(bending, wrenches, np.tile(mixing, (len(bending.blocks), 1, 1)))

    def separation(self, separation: Array, wrenches: Array) -> Array:
        """The separations (n) [mm] without what is absorbed in them."""
        return separation - wrenches @ self.absorbed if self.absorbed.any() else separation
