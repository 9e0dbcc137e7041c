"""The linear system of the segments that touch, kept up to date as segments enter and leave.

With the set A of touching segments the system

    C_AA F_A - r_A theta = g_A,    r_A'F_A = T,    F = 0 elsewhere

has a unique solution if no change of the forces of A is free: none that costs no energy and has no moment. The gaps
are Y = C F - r theta - g; with g = -S they are those of the contact problem. Derivatives of a solution solve the same
system with other right-hand sides.
"""

from __future__ import annotations

from typing import NamedTuple, Protocol

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]


class TouchingAnswer(NamedTuple):
    """Solution of the system for q right-hand sides: forces (n, q), rotations (q) and gaps (n, q)."""

    force: Array
    rotation: Array
    gap: Array

    def column(self, number: int) -> tuple[Array, float, Array]:
        """Force (n), rotation and gap (n) of one right-hand side."""
        return self.force[:, number], float(self.rotation[number]), self.gap[:, number]


class TouchingSystem(Protocol):
    """The system for a set of touching segments that changes one by one."""

    @property
    def active(self) -> NDArray[np.bool_]:
        """The touching segments (n), a copy."""
        ...

    def enter(self, segment: int) -> bool:
        """Add a segment; return False, and change nothing, where the forces would then not be unique."""
        ...

    def leave(self, segment: int) -> bool:
        """Remove a segment; return False, and change nothing, where the rest cannot carry a torque by itself."""
        ...

    def solve(self, closing: Array, torque: Array) -> TouchingAnswer:
        """Solve for right-hand sides g (n, q) and T (q); the gaps of A are set to zero."""
        ...

    def yielding(self) -> Array:
        """Return how much a segment yields to a unit force of its own at a fixed rotation (n) [mm/N]; zero in A."""
        ...

    def columns(self, segments: NDArray[np.intp]) -> Array:
        """Return columns of C (n, q)."""
        ...
