"""All teeth of a member on one closed body: their compliance under loads on one of them, from one pitch of the body.

Every pitch of the body is the same as the next, turned. A load on one tooth is a sum of waves round the member, and a
wave needs one pitch alone, whose sides move alike but for the turn and the phase of the wave. The pitch is condensed
to its sides once; each wave is then a small dense system.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from ....core.errors import GeometryError
from ....geometry.tooth.tooth_lattice import ToothLattice
from ....geometry.vectors import rotate_z
from ..material import Material
from .bricks import brick_stiffness
from .substructures import displacements, substructures

if TYPE_CHECKING:
    from scipy.sparse import csc_array

Array = NDArray[Any]
SIDE_MISFIT_LIMIT = 1e-6  # [mm], between one side of a pitch and the other, turned by the pitch


@dataclass(frozen=True)
class RingCompliance:
    """Compliance between loads (n) on a tooth and the same on every other tooth of the member (N).

    Parameters
    ----------
    alone
        Of one pitch with both its sides held (n, n) [mm/N].
    shared
        What the motion of the sides adds: displacements of the tooth k pitches further, in the order of the lattice
        from the loaded side through the tooth, under loads on the first (N, n, n) [mm/N]. All waves of it are positive
        semidefinite.
    """

    alone: Array
    shared: Array


def pitch_angle(lattice: ToothLattice, teeth: int) -> float:
    """Angle about the member's axis from one pitch of the body to that next to its opposite side [rad].

    Raises
    ------
    GeometryError
        If the sides of the lattice do not lie one pitch apart.
    """
    start, end = (lattice.nodes[side].reshape(-1, 3).T for side in lattice.sides)
    for angle in (2.0 * np.pi / teeth, -2.0 * np.pi / teeth):
        if np.abs(rotate_z(np.full(start.shape[1], angle), start) - end).max() < SIDE_MISFIT_LIMIT:
            return angle
    raise GeometryError("the sides of the lattice must lie one pitch apart")


def ring_compliance(
    lattice: ToothLattice,
    teeth: int,
    material: Material,
    loads: csc_array,
    held: NDArray[np.int64],
) -> RingCompliance:
    """Compliance of all teeth of a member on one body.

    Parameters
    ----------
    lattice
        One pitch, from mid slot to mid slot (``LatticeSize(beside=0)``).
    teeth
        Number of teeth N.
    material
        Its material.
    loads
        Unit loads on its tooth (3 m, n), also the displacements that are wanted.
    held
        Nodes that do not move; of the sides the same on both.

    Raises
    ------
    GeometryError
        If a brick is turned inside out, or the sides do not lie one pitch apart.
    """
    from scipy.linalg import cho_factor, cho_solve

    angle = pitch_angle(lattice, teeth)
    movable = ~np.isin(lattice.sides[0].ravel(), held)
    on_sides = np.concatenate([side.ravel()[movable] for side in lattice.sides])
    loaded = np.setdiff1d(loads.tocoo().row // 3, np.concatenate([on_sides, held]))
    kept = np.concatenate([on_sides, loaded])
    bricks = brick_stiffness(lattice.nodes, lattice.cells, material)
    matrix = substructures(lattice.cells, *bricks, held, kept).stiffness
    sides, within = slice(0, 3 * on_sides.size), slice(3 * on_sides.size, None)
    to_sides, forces = matrix[within, sides], loads.tocsr()[displacements(loaded)].toarray()
    moved = cho_solve(cho_factor(matrix[within, within]), np.concatenate([to_sides, forces], axis=1))
    of_sides, of_forces = moved[:, sides], moved[:, within]
    condensed = matrix[sides, sides] - to_sides.T @ of_sides
    by_forces = to_sides.T @ of_forces
    turned = _second_turned(_second_turned(condensed, angle).T, angle)
    waves = _waves(0.5 * (turned + turned.T), _second_turned(by_forces, angle), teeth)
    alone = forces.T @ of_forces
    return RingCompliance(0.5 * (alone + alone.T), waves)


def _second_turned(rows: Array, angle: float) -> Array:
    """Rows (2 m, k) of both sides with those of the second one in the frame of the first, turned back by an angle."""
    half = len(rows) // 2
    second = np.moveaxis(rows[half:].reshape(half // 3, 3, rows.shape[1]), 1, 0)
    back = rotate_z(np.full(second.shape[1:], -angle), second)
    return np.concatenate([rows[:half], np.moveaxis(back, 0, 1).reshape(half, rows.shape[1])])


def _waves(stiffness_of_sides: Array, loads: Array, teeth: int) -> Array:
    """Compliance by distance (N, n, n) of sides that move alike but for the phase of each wave."""
    half = len(loads) // 2
    first, second = slice(0, half), slice(half, None)
    own = stiffness_of_sides[first, first] + stiffness_of_sides[second, second]
    across = stiffness_of_sides[first, second]
    count = loads.shape[1]
    spectrum = np.empty((teeth // 2 + 1, count, count), dtype=complex)
    for wave in range(len(spectrum)):
        phase = np.exp(2j * np.pi * wave / teeth)
        factor = np.linalg.cholesky(own + phase * across + np.conj(phase) * across.T)
        whitened = np.linalg.solve(factor, loads[first] + np.conj(phase) * loads[second])
        spectrum[wave] = np.conj(whitened.T) @ whitened
    return np.fft.irfft(spectrum, teeth, axis=0)
