"""Stress in the root of the loaded side under unit forces on the flank.

Stresses of quadratic bricks are most exact at the 2 x 2 x 2 Gauss points. They are read at the four points of each
surface face that lie above these points, carried on to the surface along the line through both points beneath.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from ....core.checks import frozen_arrays
from ....geometry.tooth.tooth_lattice import ToothLattice
from ..material import Material
from .bricks import brick_gradients, gauss_rule, shape_functions

if TYPE_CHECKING:
    from scipy.sparse import csc_array

Array = NDArray[Any]
ROOT_BRICK_SHARE = 0.35  # of the bricks from the fillet's middle to the tip whose stress is read; it falls off above
FORCE_SETS_PER_BATCH = 512  # bounds the memory
STRESS_COMPONENTS = ((0, 0), (1, 1), (2, 2), (1, 2), (0, 2), (0, 1))


@frozen_arrays
@dataclass(frozen=True)
class StressResponse:
    """Stress at the root of the loaded side under unit forces on the nodes of the flank.

    Parameters
    ----------
    lengthwise
        Lengthwise fractions (s) of the stations.
    stress
        xx, yy, zz, yz, xz, xy (s, p, 6, k) [MPa] at p points around the fillet by a unit force at each of k nodes of
        the flank.
    """

    lengthwise: Array
    stress: Array

    def largest(self, forces: Array) -> Array:
        """Largest tensile stress (s, n) [MPa] at each station, for n sets of forces (k, n) [N] on the nodes."""
        step = FORCE_SETS_PER_BATCH
        parts = [self._largest(forces[:, start : start + step]) for start in range(0, forces.shape[1], step)]
        return np.concatenate([np.empty((self.lengthwise.size, 0)), *parts], axis=1)

    def _largest(self, forces: Array) -> Array:
        return np.asarray(np.linalg.eigvalsh(self._tensor(forces))[..., -1].max(axis=1))

    def gradients(self, forces: Array) -> Array:
        """Derivatives (k, n) [MPa/N] of the largest tensile stress of all stations by the forces on the nodes (k, n).

        The place of the largest stress and its direction, in which there is no shear, stay to first order.
        """
        step, count = FORCE_SETS_PER_BATCH, forces.shape[1]
        parts = [self._gradients(forces[:, start : start + step]) for start in range(0, count, step)]
        return np.concatenate([np.empty((forces.shape[0], 0)), *parts], axis=1)

    def _gradients(self, forces: Array) -> Array:
        tensor = self._tensor(forces)
        points, columns = self.stress.shape[1], np.arange(forces.shape[1])
        stress = np.linalg.eigvalsh(tensor)[..., -1].reshape(-1, columns.size)
        station, point = np.divmod(np.argmax(stress, axis=0), points)
        direction = np.linalg.eigh(tensor[station, point, columns])[1][..., -1]
        shares = [(1.0 if i == j else 2.0) * direction[:, i] * direction[:, j] for i, j in STRESS_COMPONENTS]
        return np.asarray(np.einsum("cn,nck->kn", np.stack(shares), self.stress[station, point]))

    def _tensor(self, forces: Array) -> Array:
        """Stress tensors (s, p, n, 3, 3) [MPa] under sets of forces (k, n)."""
        stress = np.einsum("spck,kn->spnc", self.stress, forces, optimize=True)
        tensor = np.empty((*stress.shape[:-1], 3, 3))
        for component, (i, j) in enumerate(STRESS_COMPONENTS):
            tensor[..., i, j] = tensor[..., j, i] = stress[..., component]
        return tensor


def _faces(lattice: ToothLattice) -> list[tuple[NDArray[np.int64], int, int]]:
    """Bricks on the loaded side's fillet (m, 3, 3, 3), the axis across their surface, and the end it is at."""
    rows = 2 * max(round(ROOT_BRICK_SHARE * (lattice.flank.shape[1] // 2)), 1) + 1
    # Not the bricks at toe and heel: the sharp corner where the tooth ends on its body has no stress of its own.
    on_flank = np.isin(lattice.cells[:, :, 0, :], lattice.flank[1:-1, :rows]).all(axis=(1, 2))
    on_floor = np.isin(lattice.cells[:, :, :, 2], lattice.slot[0, 1:-1]).all(axis=(1, 2))
    return [(lattice.cells[on_flank], 1, -1), (lattice.cells[on_floor], 2, 1)]


def stress_functionals(lattice: ToothLattice, material: Material) -> tuple[csc_array, Array]:
    """Stress components around the loaded side's fillet as functionals (3 n, 6 q), and the q lengthwise fractions."""
    from scipy.sparse import csc_array

    nu = material.poisson_ratio
    shear = material.shear_modulus
    first = 2.0 * shear * nu / (1.0 - 2.0 * nu)
    points, _ = gauss_rule(2)
    depth = abs(points[0, 0])
    per_section = int(lattice.column[1, 0, 0] - lattice.column[0, 0, 0])
    values, gradients = shape_functions(points)
    columns, stations = [], []
    for cells, axis, end in _faces(lattice):
        flat = cells.reshape(-1, 27)
        spatial, _ = brick_gradients(lattice.nodes[flat], gradients)
        # The two Gauss points on a line across the surface: the nearer one counts 1 + w, the further one -w.
        near = np.flatnonzero(np.sign(points[:, axis]) == end)
        mirrored = points[near].copy()
        mirrored[:, axis] *= -1.0
        far = np.array([np.flatnonzero(np.all(np.isclose(points, m), axis=1))[0] for m in mirrored])
        beyond = (1.0 - depth) / (2.0 * depth)
        slope = (1.0 + beyond) * spatial[:, near] - beyond * spatial[:, far]  # (m, 4, 27, 3)
        sections = flat // per_section
        stations.append(np.einsum("na,ma->mn", values[near], lattice.lengthwise[sections]))
        columns.append((np.broadcast_to(flat[:, None], slope.shape[:3]), slope))
    station = np.concatenate([s.ravel() for s in stations])
    nodes = np.concatenate([c[0].reshape(-1, 27) for c in columns])
    slope = np.concatenate([c[1].reshape(-1, 27, 3) for c in columns])
    # Work of a displacement on each stress component, per node and direction (m, 6, 27, 3).
    work = np.zeros((len(nodes), 6, 27, 3))
    for component, (i, j) in enumerate(STRESS_COMPONENTS):
        work[:, component, :, i] += shear * slope[:, :, j]
        work[:, component, :, j] += shear * slope[:, :, i]
        if i == j:
            work[:, component] += first * slope
    rows = np.broadcast_to((3 * nodes[:, None, :, None] + np.arange(3)), work.shape)
    column = np.broadcast_to(np.arange(6 * len(nodes)).reshape(-1, 6, 1, 1), work.shape)
    wanted = csc_array((work.ravel(), (rows.ravel(), column.ravel())), shape=(3 * len(lattice.nodes), 6 * len(nodes)))
    return wanted, station


def by_station(stress: Array, station: Array) -> StressResponse:
    """Stresses (6 q, k) by unit forces, put in the order of their lengthwise fractions (q)."""
    levels, which = np.unique(np.round(station, 9), return_inverse=True)
    order = np.argsort(which, kind="stable")
    return StressResponse(
        levels, stress.reshape(station.size, 6, -1)[order].reshape(levels.size, -1, 6, stress.shape[1])
    )
