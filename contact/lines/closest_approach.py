"""Gap across a contact curve, and the closest approach of the flanks next to it.

Opposite a point of the gear that is in conjugate contact at the pinion rotation Q stands, at the rotation q, the pinion
point p + p' (q - Q) + p'' (q - Q)^2 / 2, with the derivatives that ``ease_off.drift`` finds.
"""

from __future__ import annotations

import numpy as np

from ...core.arrays import Array, Bools, record
from ...geometry.newton import cramers_rule, determinant
from .contact_lines import curvature_and_skew
from .flank_splines import BENDS, SLOPES, VALUE_AND_SLOPES, FlankSplines

SEPARATION_FIELDS = ("separation_bend", "separation_bend_slope")  # give separation curvature and skew
SEARCH_RADIUS_LIMIT = 0.15  # of the flank, from a contact line to its closest approach; designed pairs have up to 0.05
CURVATURE_SHARE_LIMIT = 0.2  # least share of its curvature that a gap must keep for its expansion to be used
GAIN_RATIO_LIMIT = 0.5  # least ratio of what a step closes of the gap to what it promises; designed pairs: 0.99 to 1.03
GAIN_TOLERANCE = 1e-6  # [rad]; a smaller shortfall is ignored, as where a step ends at the border of the flank
# Every round of a search looks between the neighbours of the best point, in the end to 1e-4 of the flank.
SEARCH_ROUNDS, SAMPLES_PER_ROUND = 3, 31


def gap_beside(ease_off_angle: Array, curvature: Array, skew: Array, left: Array) -> Array:
    """Gap as a gear rotation [rad] at points whose roll angle the pinion has left behind by ``left`` [rad].

    ``left`` is zero in conjugate contact, negative before it; ease-off [rad], curvature [1/rad] and skew [1/rad^2].
    """
    return np.asarray(ease_off_angle + left**2 * (0.5 * curvature + left * skew / 6.0))


def still_opens(curvature: Array, skew: Array, left: Array) -> Bools:
    """True where the gap's expansion is valid over the rotation left [rad]: it lies nowhere below the ease-off."""
    return np.asarray(curvature + np.minimum(skew * left, 0.0) > CURVATURE_SHARE_LIMIT * curvature)


@record(frozen=True)
class AcrossLine:
    """Gap and roll angle across the contact curve through each of the points (...)."""

    roll_angle: Array
    ease_off_angle: Array
    lever_arm: Array
    direction: Array  # one mm across the curve to growing roll angle, in fractions (2, ...)
    metric: Array  # first fundamental form by the fractions, E, F, G (3, ...) [mm^2]
    gradient: Array
    slope: Array  # of the roll angle along the direction [rad/mm]
    ease_off_slope: Array  # by the roll angle, across the curve [-]
    ease_off_bend: Array
    separation_curvature: Array  # by the pinion rotation [1/rad]
    separation_skew: Array

    def gap(self, left: Array) -> Array:
        """Gap as a gear rotation (...) [rad] when the pinion is ``left`` (...) [rad] beyond the roll angle."""
        return gap_beside(self.ease_off_angle, self.separation_curvature, self.separation_skew, left)

    def gap_slope(self, left: Array) -> Array:
        """Slope of that gap across the curve, towards growing roll angle (...) [rad/mm]."""
        by_roll = self.ease_off_slope - self.separation_curvature * left - 0.5 * self.separation_skew * left**2
        return np.asarray(by_roll * self.slope)

    def still_opens(self, left: Array) -> Bools:
        """True where that expansion is valid over the rotation left (...) [rad] to their conjugate contact."""
        return still_opens(self.separation_curvature, self.separation_skew, left)

    def length_along(self, way: Array) -> Array:
        """Length (...) [mm] along the curve of a short displacement, given as fractions (2, ...)."""
        e, f, g = self.metric

        def product(one: Array, other: Array) -> Array:
            mixed = one[0] * other[1] + one[1] * other[0]
            return np.asarray(e * one[0] * other[0] + f * mixed + g * one[1] * other[1])

        squared = product(way, way) - product(way, self.direction) ** 2
        return np.asarray(np.sqrt(np.maximum(squared, 0.0)))

    @property
    def stiffness(self) -> Array:
        """Second derivative of the gap across the curve by the roll angle (...) [1/rad]."""
        return np.asarray(self.separation_curvature + self.ease_off_bend)

    @property
    def to_closest(self) -> Array:
        """Roll angle (...) [rad] from the points to the closest approach beside; zero where the gap does not open."""
        with np.errstate(divide="ignore", invalid="ignore"):
            return np.where(self.stiffness > 0.0, -self.ease_off_slope / self.stiffness, 0.0)

    @property
    def curvature(self) -> Array:
        """Relative curvature of the gap across the curve (...) [1/mm]; zero where the gap does not open."""
        return np.where(self.stiffness > 0.0, self.lever_arm * self.stiffness * self.slope**2, 0.0)


def across_line(splines: FlankSplines, points: Array) -> AcrossLine:
    """Gap and roll angle across the contact curves through points (2, ...) of the gear flank."""
    value = splines.evaluate(["lever_arm", *SEPARATION_FIELDS], points)
    gap = splines.derivatives(["roll_angle", "ease_off_angle"], points, [*VALUE_AND_SLOPES, *BENDS])
    value, first, second = value | gap[0], gap[1:3], gap[3:]
    sides = [side["position"] for side in splines.derivatives(["position"], points, SLOPES)]

    # Unit length across the curve on the flank, as a direction (lengthwise, profile).
    metric = [np.sum(sides[i] * sides[j], axis=0) for i, j in ((0, 0), (0, 1), (1, 1))]
    gradient = [f["roll_angle"] for f in first]
    across = cramers_rule(metric[:2], metric[1:], gradient)
    slope = np.sqrt(gradient[0] * across[0] + gradient[1] * across[1])
    across = across / slope

    def along_across(name: str) -> tuple[Array, Array]:
        d = first[0][name] * across[0] + first[1][name] * across[1]
        dd = second[0][name] * across[0] ** 2 + 2 * second[1][name] * across[0] * across[1]
        return d, dd + second[2][name] * across[1] ** 2

    _, roll_bend = along_across("roll_angle")
    ease_slope, ease_bend = along_across("ease_off_angle")
    by_roll = ease_slope / slope
    curvature, skew = curvature_and_skew(*(value[name] for name in SEPARATION_FIELDS))
    return AcrossLine(
        **{name: value[name] for name in ("roll_angle", "ease_off_angle", "lever_arm")},
        direction=across,
        metric=np.stack(metric),
        gradient=np.stack(gradient),
        slope=slope,
        ease_off_slope=by_roll,
        ease_off_bend=(ease_bend - by_roll * roll_bend) / slope**2,
        separation_curvature=curvature,
        separation_skew=skew,
    )


@record(frozen=True)
class ClosestApproach:
    """Closest approach of the flanks next to points (...) of contact curves."""

    separation_angle: Array  # gap as a gear rotation (...) [rad]
    shift: Array  # from the point, in fractions (2, ...)
    lever_arm: Array
    curvature: Array  # across the curve [1/mm]; zero where the gap does not open
    expanded: Bools  # by the expansion: opens to both sides, near, smaller; else searched for


def closest_approach(splines: FlankSplines, points: Array) -> ClosestApproach:
    """Gap, position and curvature of the closest approach next to points (2, ...) of a contact curve.

    By ``one_step``; where that leads to none, as on flanks that bend over a short way, the least gap across the curve
    within ``SEARCH_RADIUS_LIMIT``, with the curvature at the point found.
    """
    step = one_step(splines, points)
    if np.all(step.expanded):
        return step
    lost = ~step.expanded
    gap, shift, curvature = step.separation_angle.copy(), step.shift.copy(), step.curvature.copy()
    gap[lost], shift[:, lost] = _searched(splines, points[:, lost])
    curvature[lost] = across_line(splines, points[:, lost] + shift[:, lost]).curvature
    return ClosestApproach(gap, shift, step.lever_arm, curvature, step.expanded)


def one_step(splines: FlankSplines, points: Array) -> ClosestApproach:
    """Closest approach by one step of the gap's expansion across the curve, a(u) + c u^2 / 2 - s u^3 / 6, valid or not.

    The step to u = -a'/(c + a'') closes the gap by a'^2 / (2 (c + a'')); u is the roll angle beyond the curve's, a the
    ease-off, c curvature and s skew. As c + a'' goes to zero it has any length: see ``expanded``.
    """
    expansion = across_line(splines, points)
    # A gap that does not open across the curve has no closest approach there: keep the curve itself.
    opens, step = expansion.stiffness > 0.0, expansion.to_closest
    wanted = points + expansion.direction * step / expansion.slope
    closest = np.clip(wanted, 0.0, 1.0)
    gap, holds = _gap_at(splines, closest, expansion.roll_angle)
    promised = np.where(np.all(wanted == closest, axis=0), -0.5 * expansion.ease_off_slope * step, 0.0)
    near = np.max(np.abs(closest - points), axis=0) <= SEARCH_RADIUS_LIMIT
    kept = expansion.ease_off_angle - gap > GAIN_RATIO_LIMIT * promised - GAIN_TOLERANCE
    return ClosestApproach(gap, closest - points, expansion.lever_arm, expansion.curvature, opens & near & holds & kept)


def _gap_at(splines: FlankSplines, points: Array, rotation: Array) -> tuple[Array, Bools]:
    """Gap (...) [rad] at points (2, ...) of the flank at pinion rotations (...), and where its expansion holds."""
    there = splines.evaluate(["roll_angle", "ease_off_angle", *SEPARATION_FIELDS], points)
    curvature, skew = curvature_and_skew(*(there[name] for name in SEPARATION_FIELDS))
    left = rotation - there["roll_angle"]
    return gap_beside(there["ease_off_angle"], curvature, skew, left), still_opens(curvature, skew, left)


def _searched(splines: FlankSplines, points: Array) -> tuple[Array, Array]:
    """Least gap (n) [rad] on straight lines across the curve through points (2, n), and the shifts there (2, n)."""
    expansion = across_line(splines, points)
    unit = expansion.direction / np.max(np.abs(expansion.direction), axis=0)
    columns = np.arange(points.shape[1])
    best, reach = np.zeros(columns.size), SEARCH_RADIUS_LIMIT
    for _ in range(SEARCH_ROUNDS):
        # An odd number of samples has the best one of the round before in its middle, at first the curve itself.
        way = best + reach * np.linspace(-1.0, 1.0, SAMPLES_PER_ROUND)[:, None]
        tried = points[:, None] + unit[:, None] * way
        gap, holds = _gap_at(splines, np.clip(tried, 0.0, 1.0), expansion.roll_angle)
        usable = holds & np.all((tried >= 0.0) & (tried <= 1.0), axis=0) & ~splines.in_hole(np.clip(tried, 0.0, 1.0))
        usable |= way == 0.0
        least = np.argmin(np.where(usable, gap, np.inf), axis=0)
        best, reach = way[least, columns], 2.0 * reach / (SAMPLES_PER_ROUND - 1)
    return gap[least, columns], unit * best


EXTRAPOLATION_LIMIT = 0.05  # fraction of the flank by which a search may leave it
CORRECTION_ITERATIONS = 3  # of Newton's method from an estimate of second order
SEARCH_ITERATIONS, SEARCH_TOLERANCE = 12, 1e-13  # [fraction of the flank]; seven are usual
POSITION_TOLERANCE = 1e-6  # fraction of the flank
PINION_FRACTIONS = ("pinion_lengthwise", "pinion_profile")
#: Of the geometry's ``ease_off``, beside what ``contact_splines`` takes: how the pinion passes a point of the gear.
PASSING_FIELDS = tuple(f"{name}_{order}" for order in ("rate", "acceleration") for name in PINION_FRACTIONS)


@record(frozen=True)
class OppositePoints:
    """Fractions on the pinion flank opposite points (n) of the gear."""

    fractions: Array
    slopes: Array  # by the fractions of the point (2, 2, n)
    rate: Array  # by the pinion rotation (2, n) [1/rad]
    acceleration: Array

    @classmethod
    def of(cls, splines: FlankSplines, points: Array) -> OppositePoints:
        """Opposite points (2, n)."""
        passing = np.stack(list(splines.evaluate(list(PASSING_FIELDS), points).values()))
        return cls(*_in_conjugate_contact(splines, points), passing[:2], passing[2:])

    def after(self, left: Array) -> Array:
        """Fractions (2, ..., n) when the pinion is ``left`` (..., n) [rad] beyond conjugate contact."""
        shape = (2, *[1] * (left.ndim - 1), -1)
        first, rate, second = (np.reshape(v, shape) for v in (self.fractions, self.rate, self.acceleration))
        return np.asarray(first + rate * left + 0.5 * second * left**2)


def _in_conjugate_contact(splines: FlankSplines, points: Array) -> tuple[Array, Array]:
    """Fractions (2, n) of the pinion in conjugate contact with points (2, n) of the gear, their slopes (2, 2, n)."""
    derivatives = splines.derivatives(PINION_FRACTIONS, points, VALUE_AND_SLOPES)
    fractions, *by_fraction = (np.stack(list(each.values())) for each in derivatives)
    return fractions, np.stack(by_fraction, axis=1)


def conjugate_points(splines: FlankSplines, nodes: Array, near: Array | None = None) -> Array:
    """Points (2, k) on the gear conjugate to those of the pinion, searched from ``near`` where known; NaN if none."""
    points = _searched_opposite(splines, nodes, _nearest_of_lattice(splines, nodes) if near is None else near)
    there = np.stack(list(splines.evaluate(list(PINION_FRACTIONS), points).values()))
    return np.where(np.max(np.abs(nodes - there), axis=0) < POSITION_TOLERANCE, points, np.nan)


def pinion_points(splines: FlankSplines, points: Array, rotations: Array) -> Array:
    """Points of the gear in conjugate contact with the pinion points opposite points (2, ...) at rotations (...) [rad].

    Fields of the pinion on the gear flank are to be read there: off conjugate contact a gear point faces another pinion
    point.
    """
    flat = np.reshape(points, (2, -1))
    left = np.reshape(np.broadcast_to(rotations, np.shape(points)[1:]), -1) - splines("roll_angle", flat)
    opposite = OppositePoints.of(splines, flat).after(left)
    return _searched_opposite(splines, opposite, flat).reshape(np.shape(points))


def _searched_opposite(splines: FlankSplines, nodes: Array, points: Array) -> Array:
    """Points (2, k) on the gear or near it in conjugate contact with pinion points (2, k), from others near them."""
    for _ in range(SEARCH_ITERATIONS):
        before, (fractions, slopes) = points, _in_conjugate_contact(splines, points)
        points = _near_flank(points + solved(slopes, nodes - fractions))
        if not np.any(np.abs(points - before) > SEARCH_TOLERANCE):
            break
    return points


def _nearest_of_lattice(splines: FlankSplines, nodes: Array) -> Array:
    """Points (2, k) of a lattice on the gear opposite which pinion points come nearest to given ones (2, k)."""
    lattice = np.stack(np.meshgrid(np.linspace(0, 1, 31), np.linspace(0, 1, 21), indexing="ij")).reshape(2, -1)
    there = splines.evaluate(list(PINION_FRACTIONS), lattice).values()
    away = [np.subtract.outer(side, node) ** 2 for side, node in zip(there, nodes, strict=True)]
    return np.asarray(lattice[:, np.argmin(away[0] + away[1], axis=0)])


def points_below(splines: FlankSplines, wanted: Array, points: Array, rotations: Array) -> Array:
    """Points (2, n) on the gear opposite pinion points (2, n) at pinion rotations (n), from points near them."""
    for _ in range(CORRECTION_ITERATIONS):
        opposite = OppositePoints.of(splines, points)
        roll = splines.derivatives(["roll_angle"], points, VALUE_AND_SLOPES)
        roll_angle, *by_fraction = (each["roll_angle"] for each in roll)
        gradient, left = np.stack(by_fraction), rotations - roll_angle
        passing = opposite.rate + opposite.acceleration * left
        slopes = opposite.slopes - passing[:, None] * gradient[None]
        points = _near_flank(points + solved(slopes, wanted - opposite.after(left)))
    return points


def _near_flank(points: Array) -> Array:
    return np.clip(points, -EXTRAPOLATION_LIMIT, 1.0 + EXTRAPOLATION_LIMIT)


def solved(matrix: Array, right: Array) -> Array:
    """Solutions (2, n) of systems (2, 2, n), zero where there is none."""
    columns = matrix[:, 0], matrix[:, 1]
    with np.errstate(divide="ignore", invalid="ignore"):
        return np.where(determinant(*columns) != 0.0, cramers_rule(*columns, right), 0.0)
