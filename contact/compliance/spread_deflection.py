"""Deflection between flank and mid-surface that plane line contact leaves out, spread along the line.

Weber's formula integrates the strains of a half-plane down to the mid-surface. In a tooth, bent and with a free surface
on its other side, flank and foot of the normal approach by more: under an even line load q by 0.16 q (1 - nu^2) / E.
Under a load that varies along the line as cos(k s), this falls to a tenth at k h = 0.9, with the depth h to the
mid-surface. It is thus no local spring, but the load passed twice through a Gaussian of standard deviation 1.7 h:

    delta(s) = 0.16 (1 - nu^2) / E  integral of g(s - t) g(s' - t) q(s') over s' and t.

The Gaussians at a row of nodes t are unit loads like those of the bending modes, which they join: the compliance stays
symmetric and positive semidefinite. The two numbers are those of finite elements of tapered teeth, which they meet
within 0.05 in units of q (1 - nu^2) / E for flanks at 18 to 26 degrees to the tooth's axis; with less taper the
deflection falls off sooner.

Plane line contact is also wrong near the end of a tooth, and near the end of a load on a tooth that goes on.

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

import numpy as np

from ...core.arrays import Array, record
from ..lines.flank_splines import FlankSplines
from .material import Material

EVEN_LOAD_DEFLECTION = 0.16  # [q (1 - nu^2) / E], under an even line load
SPREAD_PER_DEPTH = 1.69  # standard deviation of the Gaussian over the depth of the mid-surface
NODE_SPACING = 0.6  # of the mean standard deviation
SMALLEST_SPREAD = 0.7  # standard deviation over the spacing of the nodes; a narrower Gaussian would fall between them
NODES_BEYOND = 2.5  # mean standard deviations beyond the flank
SAMPLES = np.linspace(0.0, 1.0, 9)  # of the flank in either direction, for means and limits


@record(frozen=True)
class SpreadDeflection:
    """Spread deflection of one member."""

    depth: str  # name of the field with the depth of the mid-surface
    flexibility: float  # (1 - nu^2) / E [1/MPa]
    direction: Array
    nodes: Array  # middles of the Gaussians (k) along it, evenly spaced [mm]

    @classmethod
    def of(cls, splines: FlankSplines, member: str, material: Material) -> SpreadDeflection:
        """Spread deflection of a member, from the splines of ``loaded_splines``."""
        middle = np.array([[0.5], [0.5]])
        roll = [splines("roll_angle", middle, d)[0] for d in ((1, 0), (0, 1))]
        tangents = [splines("position", middle, d)[:, 0] for d in ((1, 0), (0, 1))]
        direction = roll[1] * tangents[0] - roll[0] * tangents[1]
        direction = direction / np.linalg.norm(direction)
        everywhere = np.stack(np.meshgrid(SAMPLES, SAMPLES, indexing="ij"))
        along = np.einsum("x,x...->...", direction, splines("position", everywhere))
        depth = f"depth_{member}"
        spread = SPREAD_PER_DEPTH * float(np.maximum(splines(depth, everywhere), 0.0).mean())
        beyond = NODES_BEYOND * spread
        count = int(np.ceil((np.ptp(along) + 2.0 * beyond) / (NODE_SPACING * spread))) + 1
        nodes = np.linspace(along.min() - beyond, along.max() + beyond, count)
        return cls(depth, 1.0 / material.plane_strain_modulus, direction, nodes)

    def loads(self, splines: FlankSplines, points: Array, loaded: Array, weights: Array) -> Array:
        """Unit loads Y (k, n) on segments: Y^T Y is the compliance between them [mm/N].

        Both kinds of points (2, n, g) are fractions on the gear; ``loaded`` are those at which the member is loaded,
        see ``closest_approach.pinion_points``. The weights (g) add up to one.
        """
        along = np.einsum("x,x...->...", self.direction, splines("position", points))
        spacing = self.nodes[1] - self.nodes[0]
        return gaussians(self.nodes, along, splines(self.depth, loaded), self.flexibility * spacing) @ weights


def gaussians(nodes: Array, along: Array, depth: Array, scale: float) -> Array:
    """Gaussians (k, ...) about nodes (k) at places (...) along a line, over depths (...) [mm].

    With node spacing d and a ``scale`` of (1 - nu^2) d / E, their products summed over the nodes are the compliance
    between two places [mm/N].
    """
    spacing = nodes[1] - nodes[0]
    spread = np.maximum(SPREAD_PER_DEPTH * depth, SMALLEST_SPREAD * spacing)
    factor = np.sqrt(EVEN_LOAD_DEFLECTION * scale / (2.0 * np.pi))
    values = np.reshape(nodes, (-1, *[1] * along.ndim)) - along
    values *= np.sqrt(0.5) / spread  # in place: the array is large
    values *= -values
    np.exp(values, out=values)
    values *= factor / spread
    return np.asarray(values)


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
    """Compliance kappa [-] that an end adds near itself, over that of a mirror image.

    ``slant`` is the end face's angle against the normal of the flank [rad], positive where the tooth is a sharp wedge.
    """
    limited = _limited(slant)
    exponent = SLANT_FACTORS[0] * limited + SLANT_FACTORS[1] * limited**3
    return (1.0 + POISSON_FACTOR * material.poisson_ratio**2) * math.exp(exponent)


def end_decay(slant: float) -> tuple[float, float]:
    """Numbers k and c by which the compliance added at an end of a slant [rad] falls off."""
    sharp = max(_limited(slant), 0.0)
    return DECAY / (1.0 + (sharp / HALVING_SLANT) ** 2), min(REACH / max(math.tan(sharp), REACH), STEEPEST)


def _limited(slant: float) -> float:
    return min(max(slant, -SLANT_LIMIT), SLANT_LIMIT)


def end_loads(
    depth: Array, distance: Array, height: Array, slant: float, material: Material, middle_depth: float = math.inf
) -> Array:
    """Unit loads (k, ...): their inner products are the compliances that an end adds [mm/N].

    ``depth`` goes along the normal to the mid-surface, ``distance`` from the end at right angles to its edge,
    ``height`` from the root; ``middle_depth`` is the depth at half of this end's height [mm].
    """
    step = math.log(RANGE) / (MODES - 1)
    exponents = LEAST_EXPONENTS * np.exp(step * (np.arange(MODES) - 0.5))
    widths = step * exponents
    exponents[0], widths[0] = 0.5 * LEAST_EXPONENTS, LEAST_EXPONENTS
    reach = np.minimum(depth, middle_depth)
    along = np.hypot(distance, NEAREST_END * reach) / reach
    linear, quadratic = end_decay(slant)
    restraint = HELD_AT_ROOT * math.sin(max(_limited(slant), 0.0)) ** 2
    left = 1.0 - restraint * np.exp(-((np.maximum(height, 0.0) / (HELD_HEIGHT * depth)) ** 2))
    size = end_strength(slant, material) / (math.pi * material.plane_strain_modulus)
    fallen = np.sqrt(size * left / reach) * np.exp(-linear * along - (quadratic * along) ** 2)
    each, width = (np.reshape(values, (-1, *[1] * along.ndim)) for values in (exponents, widths))
    return np.asarray(np.sqrt(width) * np.exp(-each * along) * fallen)


def remaining_depth(depth: Array, load_end: Array, material: Material, cosine: Array | float = 1.0) -> Array:
    """Depth of the line contact near the end of a load, over that of the mid-surface.

    ``load_end`` is the distance from that end at right angles to its edge [mm], ``cosine`` that of the angle between
    line and normal of the edge.
    """
    along = load_end / np.maximum(cosine, COSINE_MINIMUM)
    return np.asarray(np.exp(-0.5 * math.pi * np.maximum(missing_approach(depth, along, material), 0.0)))


def missing_approach(depth: Array, distance: Array, material: Material) -> Array:
    """Part m in the approach of flank and foot of an even load from a distance on, in units of q (1 - nu^2) / E."""
    away = np.hypot(distance, NEAREST_END * depth)
    along = np.log(0.5 * depth / away) + np.arcsinh(away / depth)
    strained = 0.5 * (1.0 - away / np.hypot(away, depth)) / (1.0 - material.poisson_ratio)
    return np.asarray((along - strained) / math.pi)
