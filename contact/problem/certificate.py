"""Certificate of an answer: violations of every condition of the contact problem by forces and rotation.

The certificate is evaluated on the problem as the user gave it, never on a scaled or clipped one, and never from the
report of a solver. It needs no reference solution: the problem is convex, so whoever satisfies all conditions
has the answer.

It counts its own rounding. A bound of the rounding stands beside the violations and must fit into the tolerance with
them; where the bound in double precision does not, the residuals are summed without error. Rotations count from first
contact, which is known to twice the digits of a double, so that a large separation costs no digit.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from ...core.checks import array, instance
from .contact_problem import ContactProblem
from .operator_compliance import OperatorCompliance
from .proof.error_free import UNIT_ROUNDOFF
from .proof.residuals import Residuals, Sizes, exact_residuals, rounded_residuals

Array = NDArray[np.float64]

#: Largest violation of a certified answer of the native solver, and of every polished one.
EXACT_TOLERANCE = 1e-9

#: Largest rounding with which violations are accepted as they are; else they are evaluated with more care.
RESOLUTION_LIMIT = 1e-10
#: Cancellation in r'F, C F or C F + S - r theta beyond this factor leaves fewer than the digits that EXACT_TOLERANCE
#: asks for: violations then count relative to this part of the terms, not to the torque or the deflection.
CANCELLATION_FLOOR = 1e-5


@dataclass(frozen=True)
class Certificate:
    """Violations of the conditions, all dimensionless; zero is perfect.

    Attributes
    ----------
    equilibrium
        ``|r'F - T| / T``.
    negative_force
        max(-F, 0) over the peak force.
    negative_gap
        max(-Y, 0), penetration, over the mean deflection of the loaded segments.
    complementarity
        max of min(F, Y), each by its scale: no segment carries load across a gap.
    duality_gap
        ``|F'CF + S'F - theta T|``, S and theta from first contact: work on the segments less work of the torque. Over
        the sum of ``|F|`` times that mean deflection plus the sum of ``|F S|``.
    resolution
        Bound of the rounding in these five, relative to the same scales.
    cancellation
        Size of the terms of r'F over the torque, or of the terms of loaded gaps over the deflection, whichever is
        more; an upper bound. Beyond 10^5 the scales of torque and deflection are 10^-5 of the terms.

    Examples
    --------
    >>> Certificate(0.0, 0.0, 1e-7, 0.0, 0.0).worst, Certificate(0.0, 0.0, 1e-7, 0.0, 0.0).passes(1e-6)
    (1e-07, True)
    >>> print(Certificate(1e-16, 0.0, 2e-15, 0.0, 0.0, resolution=3e-14, cancellation=40.0))
    passes 1e-09: worst violation 2e-15, of negative_gap (rounding bound 3e-14); 14 digits left by cancellation
    """

    equilibrium: float
    negative_force: float
    negative_gap: float
    complementarity: float
    duality_gap: float
    resolution: float = field(default=0.0, compare=False)
    cancellation: float = field(default=1.0, compare=False)

    @property
    def violations(self) -> tuple[float, ...]:
        """The five violations, in the order of `CERTIFICATE_FIELDS`."""
        return self.equilibrium, self.negative_force, self.negative_gap, self.complementarity, self.duality_gap

    @property
    def worst(self) -> float:
        """The largest of all violations; infinite if one of them is not a number."""
        entries = self.violations
        # The built-in maximum may or may not notice a NaN, depending on where it stands.
        return math.inf if any(map(math.isnan, entries)) else max(entries)

    @property
    def digits(self) -> float:
        """Decimal digits of torque and deflection that cancellation leaves in doubles, at least; 15.95 without any."""
        return max(0.0, -math.log10(UNIT_ROUNDOFF * max(self.cancellation, 1.0)))

    def passes(self, tolerance: float = EXACT_TOLERANCE) -> bool:
        """Whether every violation is within the tolerance, whatever the rounding in it."""
        return self.worst + self.resolution <= tolerance

    @property
    def worst_condition(self) -> str:
        """Name of the condition with the largest violation, as in `CERTIFICATE_FIELDS`."""
        entries = [math.inf if math.isnan(value) else value for value in self.violations]
        return CERTIFICATE_FIELDS[entries.index(max(entries))]

    def told(self, tolerance: float = EXACT_TOLERANCE) -> str:
        """Return in words whether it passes a tolerance, the worst violation, its rounding, and the digits left.

        Parameters
        ----------
        tolerance
            Largest violation that it may have.

        Examples
        --------
        >>> Certificate(0.0, 0.0, 1e-7, 0.0, 0.0).told(1e-8)
        'misses 1e-08: worst violation 1e-07, of negative_gap (rounding bound 0); 15 digits left by cancellation'
        """
        if not self.worst < math.inf:
            return "misses every tolerance: a violation is not a finite number"
        verdict = f"{'passes' if self.passes(tolerance) else 'misses'} {tolerance:.1g}"
        worst = f"worst violation {self.worst:.1g}, of {self.worst_condition}" if self.worst > 0.0 else "no violation"
        left = f"{math.floor(self.digits)} digits left by cancellation"
        return f"{verdict}: {worst} (rounding bound {self.resolution:.1g}); {left}"

    def __str__(self) -> str:
        """As `told` says it of the tolerance of exact answers."""
        return self.told()


#: Names of the violations.
CERTIFICATE_FIELDS = ("equilibrium", "negative_force", "negative_gap", "complementarity", "duality_gap")
#: What it says of itself.
CERTIFICATE_LIMITS = ("resolution", "cancellation")
#: Certificate of a solve without an answer.
NO_CERTIFICATE = Certificate(math.inf, math.inf, math.inf, math.inf, math.inf)


def certify(
    problem: ContactProblem, force: Array, rotation: float, elastic_rotation: float | None = None
) -> Certificate:
    """Measure how well an answer satisfies the contact problem.

    Parameters
    ----------
    problem
        The contact problem.
    force
        Normal forces (n) [N].
    rotation
        Rotation theta [rad].
    elastic_rotation
        Rotation beyond first contact [rad]. With it the certificate is that of exactly these numbers.

    Returns
    -------
    Certificate
        Infinite throughout where forces or rotation are not finite.

    Notes
    -----
    Without `elastic_rotation` the certificate is that of the forces at the rotation at which the torque does their
    work, if this rounds to the given one, else at the nearest one that does: one double stands for all rotations that
    round to it. It then proves the forces, and the rotation to its last digit. Where a light load is lost in that
    digit, the elastic rotation is known by the forces alone.

    Examples
    --------
    The second of two springs carries nothing, although the bodies have closed its gap:

    >>> import numpy as np
    >>> from easeoff.contact import ContactProblem
    >>> springs = ContactProblem(np.zeros(2), np.full(2, 40.0), 8.0e4, np.diag([1e-6, 1e-6]))
    >>> round(certify(springs, np.array([2000.0, 0.0]), 5e-5).negative_gap, 9)
    1.0
    """
    instance("problem", problem, ContactProblem)
    rotation = array("rotation", rotation, "rad", ndim=0, anything=True).item()
    if elastic_rotation is not None:
        array("elastic_rotation", elastic_rotation, "rad", ndim=0, anything=True)
    force = array("force", force, "N", anything=True)
    if force.shape != problem.separation.shape or not (math.isfinite(rotation) and np.isfinite(force).all()):
        return NO_CERTIFICATE
    with np.errstate(over="ignore", invalid="ignore"):
        deflection = problem.deflection(force)
        if elastic_rotation is None:
            elastic_rotation = resolved_rotation(problem, force, rotation, deflection)
        gap = deflection + problem.separation_at_first_contact - elastic_rotation * problem.lever_arm
    return violations(problem, force, elastic_rotation, deflection, gap)


def resolved_rotation(problem: ContactProblem, force: Array, rotation: float, deflection: Array) -> float:
    """Return the rotation beyond first contact [rad], among those that the given one stands for, that fits the forces.

    Parameters
    ----------
    problem, force, rotation
        As `certify` has them.
    deflection
        C F (n) [mm].
    """
    elastic_rotation = problem.elastic_rotation(rotation)
    if not problem.torque > 0.0:
        return elastic_rotation
    of_work = float(force @ (deflection + problem.separation_at_first_contact)) / problem.torque
    half = 0.5 * math.ulp(rotation)
    return min(max(of_work, elastic_rotation - half), elastic_rotation + half)


def violations(
    problem: ContactProblem, force: Array, elastic_rotation: float, deflection: Array, gap: Array
) -> Certificate:
    """Return the certificate where the deflections C F and the gaps [mm], both (n), are known already.

    Parameters
    ----------
    problem, force, elastic_rotation
        As `certify` has them.
    deflection, gap
        Of these forces, at this rotation (n) [mm].
    """
    if not (_finite(gap) and _finite(force)):
        return NO_CERTIFICATE
    with np.errstate(over="ignore", invalid="ignore"):
        sizes = Sizes.of(problem, force, deflection)
        rounded = rounded_residuals(problem, force, elastic_rotation, deflection, gap, sizes)
        found = _relative_to_scales(problem, force, elastic_rotation, sizes, rounded)
        known = not isinstance(problem.compliance_matrix, OperatorCompliance)
        if found.resolution <= RESOLUTION_LIMIT or not found.worst < math.inf or not known:
            return found
        sharp = rounded_residuals(problem, force, elastic_rotation, deflection, gap, sizes, sharp=True)
        found = _relative_to_scales(problem, force, elastic_rotation, sizes, sharp)
        if found.resolution <= RESOLUTION_LIMIT:
            return found
        try:
            exact = exact_residuals(problem, force, elastic_rotation)
        except (OverflowError, ValueError):
            return found
        return _relative_to_scales(problem, force, elastic_rotation, sizes, exact)


def _finite(numbers: Array) -> bool:
    return math.isfinite(float(numbers.sum())) or bool(np.isfinite(numbers).all())


def _relative_to_scales(
    problem: ContactProblem, force: Array, elastic_rotation: float, sizes: Sizes, left: Residuals
) -> Certificate:
    moment_scale = max(problem.torque, CANCELLATION_FLOOR * sizes.moment)
    gap_scale, cancellation = _gap_scale(problem, sizes, abs(elastic_rotation))
    energy_scale = sizes.total * gap_scale + sizes.preload
    if problem.torque > 0.0:
        cancellation = max(cancellation, sizes.moment / problem.torque)
    shared = np.minimum(_ratio(force, sizes.largest_force), left.gap / gap_scale)
    resolution = left.gap_error / gap_scale
    if sizes.total > 0.0:
        of_balance = _relative(left.imbalance_error, moment_scale)
        resolution = max(resolution, of_balance, _relative(left.surplus_error, energy_scale))
    return Certificate(
        _relative(abs(left.imbalance), moment_scale),
        _relative(max(-sizes.least_force, 0.0), sizes.largest_force),
        max(-float(left.gap.min()), 0.0) / gap_scale,
        max(float(shared.max()), 0.0),
        _relative(abs(left.surplus), energy_scale),
        resolution,
        cancellation,
    )


def _gap_scale(problem: ContactProblem, sizes: Sizes, turned: float) -> tuple[float, float]:
    """Mean deflection of the loaded segments [mm], weighted by force, but not below what cancellation resolves.

    And that cancellation: the mean of the terms of their gaps, which is a bound, over the mean deflection.
    """
    if sizes.total > 0.0:
        mean = sizes.strain / sizes.total
        cancelled = sizes.roots * sizes.roots / sizes.total  # bounds F'|C|F / sum F
        if max(mean, sizes.roots) > 0.0:  # the square of small roots may be none
            apart = sizes.preload / sizes.total
            terms = max(cancelled, apart, turned * sizes.moment / sizes.total)
            floor = CANCELLATION_FLOOR * terms
            if problem.first_contact.signs and apart > 0.0:
                # Forces of any size can be in balance: they must not hide a penetration of the size of separations.
                floor = min(floor, apart)
            if max(mean, floor) > 0.0:
                return max(mean, floor), max(terms / mean, 1.0) if mean > 0.0 else math.inf
    largest = float(np.abs(problem.separation_at_first_contact).max())  # no load or no compliance
    return (largest if largest > 0.0 else 1.0), 1.0


def _ratio(values: Array, scale: float) -> Array:
    return values / scale if scale > 0.0 else values


def _relative(error: float, scale: float) -> float:
    if error == 0.0:
        return 0.0
    return error / scale if scale > 0.0 else math.inf
