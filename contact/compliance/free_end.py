"""Line contact near the end of a tooth, and near the end of a load on a tooth that goes on.

**Ends of a load.** Plane line contact takes the load to go on. Where it ends, by Boussinesq's field of a half space,
what is missing from a distance s on has in the approach of flank and foot of the normal, at the depth h,

    m(s) = q (1 - nu^2) / (pi E) [ln(h / 2 s) + asinh(s / h) - (1 - s / r) / (2 (1 - nu))],    r^2 = s^2 + h^2.

So much less the line contact deflects; as it must stiffen with every load, its depth is made smaller instead, to
h exp(-pi m E / (2 q (1 - nu^2))), which takes the same off the logarithm of narrow strips.

**Free ends.** A tooth that ends there gives way more than the half space. What its end adds between loads at the
distances s and t from it is, beside a line at right angles to the end's edge,

    (1 - nu^2) / (pi E) kappa f(s / h) f(t / h) / (s + t),    f(x) = exp(-k x - (c x)^2),

with the angle a of the end face against the normal of the flank, positive where the tooth is a sharp wedge, and

    kappa = (1 + 7.5 nu^2) exp(3.3 a + 0.5 a^3),    k = 2 / (1 + (a / 30 deg)^2),    c = 0.9 / tan(a),

k at most 2 and c at most 1. The form 1 / (s + t) is that of a load and its mirror image, for which kappa is 1; the ends
of spiral teeth stand at 35 to 130 degrees to their flanks, and kappa runs from 0.1 to 60. It falls off where the foot
of the normal leaves the end face, h tan(a) from the end. The numbers are those of finite elements of wedges
(``verification.end_relief``). The form is positive definite, a sum of products of f(s / h) exp(-m s) over all m above
zero: unit loads like those of the bending modes, which they join. As all distances are taken at right angles to the
edge, an oblique line gains more.

A tooth is no wedge without end. Towards its root it is thicker, but an end reaches no farther there than at half its
height; and its body holds it, so that of kappa is left, at the height y above the root,

    1 - 0.95 sin(a)^2 exp(-(y / 0.6 h)^2)    for sharp wedges,

by finite elements of whole teeth of the pairs ``fm-11x41`` and ``nasa-12x36``.

A strip counts as a line only where it is not as near to the end as it is wide: below some hundredths of the depth
distances level off.
"""

from __future__ import annotations

import math
from typing import Any

import numpy as np
from numpy.typing import NDArray

from .material import Material

Array = NDArray[Any]

NEAREST_END = 0.03  # of the depth: where the distance from an end levels off
POISSON_FACTOR, SLANT_FACTORS = 7.5, (3.3, 0.5)  # of the squared ratio; of the slant and its cube, in the exponent
DECAY, HALVING_SLANT = 2.0, math.radians(30.0)  # k of a square end; where it is half of that
REACH, STEEPEST = 0.9, 1.0  # c times the tangent of the slant; its limit
HELD_AT_ROOT = 0.95  # of the strength of an end, times the squared sine of the slant
HELD_HEIGHT = 0.6  # over the depth
SLANT_LIMIT = math.radians(55.0)  # to where finite elements go
LEAST_EXPONENTS, RANGE, MODES = 0.4, 100.0, 6  # m over the depth: one stands for all below; greatest over it; number
COSINE_MINIMUM = math.sqrt(0.5)  # of the angle between line and end's normal: finite elements go to 45 degrees


def end_strength(slant: float, material: Material) -> float:
    """What an end adds near itself, as a part of what a mirror image would.

    Parameters
    ----------
    slant
        Angle of the end face against the normal of the flank [rad], positive where the tooth is a sharp wedge.
    material
        Of the tooth.

    Examples
    --------
    >>> from easeoff.contact import STEEL
    >>> [round(end_strength(math.radians(a), STEEL), 2) for a in (-35.0, 0.0, 20.0)]
    [0.2, 1.67, 5.41]
    """
    limited = _limited(slant)
    exponent = SLANT_FACTORS[0] * limited + SLANT_FACTORS[1] * limited**3
    return (1.0 + POISSON_FACTOR * material.poisson_ratio**2) * math.exp(exponent)


def end_decay(slant: float) -> tuple[float, float]:
    """How what an end adds falls off: the numbers k and c of a slant.

    Examples
    --------
    >>> [tuple(round(n, 2) for n in end_decay(math.radians(a))) for a in (0.0, 30.0, 45.0)]
    [(2.0, 1.0), (1.0, 1.0), (0.62, 0.9)]
    """
    sharp = max(_limited(slant), 0.0)
    return DECAY / (1.0 + (sharp / HALVING_SLANT) ** 2), min(REACH / max(math.tan(sharp), REACH), STEEPEST)


def _limited(slant: float) -> float:
    return min(max(slant, -SLANT_LIMIT), SLANT_LIMIT)


def end_loads(
    depth: Array, distance: Array, height: Array, slant: float, material: Material, middle_depth: float = math.inf
) -> Array:
    """Unit loads (k, ...): their inner products are the compliances that an end adds [mm/N].

    Parameters
    ----------
    depth
        Distance along the contact normal from the contact to the mid-surface of the tooth (...) [mm].
    distance
        From the end, along the flank at right angles to its edge (...) [mm]; not negative.
    height
        Above the root, along the end of the tooth (...) [mm].
    slant, material
        As of ``end_strength``.
    middle_depth
        The depth at half the height of this end [mm].

    Examples
    --------
    Under an even load from the end on, in units of q (1 - nu^2) / E, a third of the depth from the end:

    >>> from easeoff.contact import STEEL
    >>> places = np.arange(0.05, 20.0, 0.1)
    >>> loads = end_loads(np.full(200, 3.0), places, np.full(200, 9.0), 0.0, STEEL)
    >>> round(float(loads[:, 10] @ loads.sum(axis=1) * 0.1 * STEEL.plane_strain_modulus), 2)
    0.15
    """
    step = math.log(RANGE) / (MODES - 1)
    exponents = LEAST_EXPONENTS * np.exp(step * (np.arange(MODES) - 0.5))
    widths = step * exponents
    exponents[0], widths[0] = 0.5 * LEAST_EXPONENTS, LEAST_EXPONENTS
    reach = np.minimum(depth, middle_depth)
    along = np.hypot(distance, NEAREST_END * reach) / reach
    linear, quadratic = end_decay(slant)
    held = HELD_AT_ROOT * math.sin(max(_limited(slant), 0.0)) ** 2
    left = 1.0 - held * np.exp(-((np.maximum(height, 0.0) / (HELD_HEIGHT * depth)) ** 2))
    size = end_strength(slant, material) / (math.pi * material.plane_strain_modulus)
    fallen = np.sqrt(size * left / reach) * np.exp(-linear * along - (quadratic * along) ** 2)
    each, width = (np.reshape(values, (-1, *[1] * along.ndim)) for values in (exponents, widths))
    return np.asarray(np.sqrt(width) * np.exp(-each * along) * fallen)


def remaining_depth(depth: Array, load_end: Array, material: Material, cosine: Array | float = 1.0) -> Array:
    """Depth of the line contact near the end of a load, over that of the mid-surface.

    Parameters
    ----------
    depth, material
        As of ``end_loads``.
    load_end
        Distance from the end of the load, at right angles to its edge [mm].
    cosine
        Of the angle between contact line and the normal of the end's edge.

    Examples
    --------
    >>> from easeoff.contact import STEEL
    >>> remaining_depth(np.full(3, 3.0), np.array([0.1, 0.5, 3.0]), STEEL).round(2).tolist()
    [0.41, 0.72, 1.0]
    """
    along = load_end / np.maximum(cosine, COSINE_MINIMUM)
    return np.asarray(np.exp(-0.5 * math.pi * np.maximum(missing_approach(depth, along, material), 0.0)))


def missing_approach(depth: Array, distance: Array, material: Material) -> Array:
    """What an even load from a distance on has in the approach of flank and foot, in units of q (1 - nu^2) / E.

    Examples
    --------
    >>> from easeoff.contact import STEEL
    >>> missing_approach(np.full(2, 3.0), np.array([0.5, 3.0]), STEEL).round(2).tolist()
    [0.21, -0.01]
    """
    away = np.hypot(distance, NEAREST_END * depth)
    along = np.log(0.5 * depth / away) + np.arcsinh(away / depth)
    strained = 0.5 * (1.0 - away / np.hypot(away, depth)) / (1.0 - material.poisson_ratio)
    return np.asarray((along - strained) / math.pi)
