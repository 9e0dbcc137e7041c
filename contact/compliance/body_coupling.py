"""Coupling of tooth pairs through the bodies of pinion and gear, as modes that all pairs of a mesh position share."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ...core.checks import frozen, frozen_arrays
from ..problem.modal_basis import SharedModes

Array = NDArray[Any]
DROPPED_SHARE = 1e-8  # of the greatest eigenvalue: shared modes below, which change no digit of a result, are left out
EIGENVALUE_RATIO_LIMIT = 1e-12  # of the greatest: what is below is rounding


@frozen_arrays
@dataclass(frozen=True)
class BodyCoupling:
    """Compliance between tooth pairs through the bodies of the members.

    Parameters
    ----------
    members
        Of each member the compliance between the modes of its teeth by their distance (N, q, q) [mm/N], see
        ``SharedBody``, and the pitches from the tooth of one pair to that of the next.
    """

    members: tuple[tuple[Array, int], ...]
    known: dict[tuple[int, ...], Array] = field(default_factory=dict, repr=False, compare=False)

    def compliance(self, pairs: Sequence[int] | NDArray[np.int64]) -> Array:
        """Compliance (p, q, p, q) [mm/N] between the modes of tooth pairs (p), those of all members one by one."""
        numbers = np.asarray(pairs)
        distance = numbers[:, None] - numbers
        size = sum(coupling.shape[1] for coupling, _ in self.members)
        result = np.zeros((numbers.size, size, numbers.size, size))
        start = 0
        for coupling, pitches in self.members:
            own = slice(start, start + coupling.shape[1])
            result[:, own, :, own] = np.moveaxis(coupling[np.mod(pitches * distance, len(coupling))], 1, 2)
            start = own.stop
        return result

    def shared_modes(
        self, pairs: Sequence[int] | NDArray[np.int64], segments: Sequence[NDArray[np.intp]], loads: Array
    ) -> SharedModes:
        """Modes of the bodies that tooth pairs share.

        Parameters
        ----------
        pairs
            Numbers of the pairs (p).
        segments
            Segments of each pair.
        loads
            Unit loads on the segments in the modes of the bodies (n, q).
        """
        root = self._root(tuple(int(pair) for pair in pairs))
        on_root = np.concatenate([loads[rows] @ own for rows, own in zip(segments, root, strict=True)])
        values, vectors = np.linalg.eigh(on_root.T @ on_root)
        kept = values > DROPPED_SHARE * values[-1]
        return SharedModes(loads, root @ vectors[:, kept])

    def _root(self, pairs: tuple[int, ...]) -> Array:
        """Y (p, q, r) such that the compliance between the modes of tooth pairs is Y Y^T."""
        if pairs not in self.known:
            whole = self.compliance(pairs)
            values, vectors = np.linalg.eigh(whole.reshape(len(pairs) * whole.shape[1], -1))
            kept = values > EIGENVALUE_RATIO_LIMIT * values[-1]
            root = (vectors[:, kept] * np.sqrt(values[kept])).reshape(*whole.shape[:2], -1)
            self.known[pairs] = frozen(root)
        return self.known[pairs]
