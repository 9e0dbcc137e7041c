"""Relief of a free end: finite elements of a body with a free end face, at which an even line load ends.

Under an even line load that goes on for ever a half space is in plane strain, with Flamant's stresses. Where the body
ends, these must be taken off the end face; the displacements by their opposites are what the end adds. The load itself
has no part in that: the displacements grow towards the end as a logarithm, and bricks that shrink towards it follow.
An independent check of ``contact.compliance.spread_deflection``.
"""

from __future__ import annotations

import math

import numpy as np
from scipy.interpolate import PchipInterpolator

from ..contact.compliance.finite_elements.elastic_body import elastic_body, quadratic
from ..contact.compliance.material import Material
from ..core.arrays import Array, record
from ..core.checks import instance, number, whole
from ..geometry.tooth.tooth_lattice import with_middles

FACE_GAUSS_POINTS = 8  # in each direction of a brick's face; the stress is singular at the load
FIRST_BRICK = 0.03  # [mm]
GROWTH = 2.0  # of the bricks' borders away from the end of the load
BORDER_COUNT_LIMIT = 16  # 1 km


@record(frozen=True)
class EndRelief:
    """Added displacements of a free end under a line load of 1 N/mm.

    Parameters
    ----------
    distance
        From the end along the line (n) [mm].
    depth
        Below the flank (m) [mm]; the first is zero.
    sinking
        Displacements into the body under the line (n, m) [mm].
    slant
        How much farther along the line the body begins per depth: the tangent of the angle of the end face.

    Examples
    --------
    A flank that sinks by 2 nm where the point 1 mm below it sinks by 1 nm has come 1 nm nearer:

    >>> even = EndRelief(np.arange(3.0), np.array([0.0, 1.0]), np.array([[2e-6, 1e-6]] * 3), slant=0.0)
    >>> even.approach(1).tolist()
    [1e-06, 1e-06, 1e-06]
    """

    distance: Array
    depth: Array
    sinking: Array
    slant: float

    def approach(self, row: int) -> Array:
        """Approach (n) of the flank and the point at one of the depths below it, or nearest to it, [mm]."""
        begin = self.slant * self.depth[row]
        below = PchipInterpolator(self.distance + begin, self.sinking[:, row])
        return np.asarray(self.sinking[:, 0] - below(np.maximum(self.distance, begin)))


def end_relief(material: Material, *, slant: float = 0.0, oblique: float = 0.0, borders: int = 10) -> EndRelief:
    """Relief of an end face.

    Parameters
    ----------
    material
        Of the body.
    slant
        Angle of the end face against the normal of the flank [rad], positive where the body is a sharp wedge.
    oblique
        Angle of the load against the normal of the end's edge, in the flank [rad].
    borders
        Borders of bricks in each direction; the outermost is held, 15 mm away with ten of them.

    Examples
    --------
    >>> from easeoff.contact import STEEL
    >>> relief = end_relief(STEEL, borders=6)
    >>> relief.sinking.shape, bool(np.all(np.diff(relief.sinking[1:6, 0]) < 0.0))
    ((13, 13), True)
    """
    instance("material", material, Material)
    number("slant", slant, "rad", above=-0.5 * math.pi, below=0.5 * math.pi)
    number("oblique", oblique, "rad", above=-0.5 * math.pi, below=0.5 * math.pi)
    whole("borders", borders, 2, BORDER_COUNT_LIMIT)
    sides = np.concatenate([[0.0], FIRST_BRICK * GROWTH ** np.arange(borders)])
    one, both = with_middles(sides), with_middles(np.concatenate([-sides[:0:-1], sides]))
    across, along, deep = np.meshgrid(both, one, one, indexing="ij")
    leaning = math.tan(slant), math.tan(oblique)
    nodes = np.stack([across, along + leaning[0] * deep + leaning[1] * across, deep], axis=-1)
    index = np.arange(across.size).reshape(across.shape)
    windows = np.lib.stride_tricks.sliding_window_view(index, (3, 3, 3))[::2, ::2, ::2]
    fixed_nodes = np.unique(np.concatenate([index[0], index[-1], index[:, -1], index[:, :, -1]], axis=None))
    body = elastic_body(nodes.reshape(-1, 3), windows.reshape(-1, 3, 3, 3), fixed_nodes, material)
    loads = np.zeros((across.size, 3))
    x, w = np.polynomial.legendre.leggauss(FACE_GAUSS_POINTS)
    shape = quadratic(x)[0]
    for i in range(0, both.size - 1, 2):
        for k in range(0, one.size - 1, 2):
            half = 0.5 * (both[i + 2] - both[i]), 0.5 * (one[k + 2] - one[k])
            at = (both[i + 1] + half[0] * x)[:, None], (one[k + 1] + half[1] * x)[None]
            weight = half[0] * half[1] * np.outer(w, w)
            traction = _traction(*at, leaning, material.poisson_ratio) * weight[..., None]
            face = index[i : i + 3, 0, k : k + 3].ravel()
            loads[face] += np.einsum("pi,qj,pqx->ijx", shape, shape, traction).reshape(9, 3)
    moved = body.solve(loads.reshape(-1, 1)).reshape(*across.shape, 3)
    return EndRelief(one, one, moved[both.size // 2, :, :, 2], leaning[0])


def _traction(across: Array, depth: Array, leaning: tuple[float, float], poisson_ratio: float) -> Array:
    """Opposite (..., 3) of what plane strain puts on an end face, per area at right angles to the load."""
    fourth = math.pi * (across**2 + depth**2) ** 2
    first, shear, last = (-2.0 * across**n * depth ** (3 - n) / fourth for n in (2, 1, 0))
    along = poisson_ratio * (first + last)
    slant, oblique = leaning
    return -np.stack([first * oblique + shear * slant, -along, shear * oblique + last * slant], axis=-1)
