"""Certificate of an answer: violations of every condition of the contact problem by forces and rotation.

The certificate is evaluated on the problem as the user gave it, never on a scaled or clipped one, and never from the
report of a solver. It needs no reference solution: the problem is convex, so whoever satisfies all conditions
has the answer.

It counts its own rounding. A bound of the rounding stands beside the violations and must fit into the tolerance with
them; where the bound in double precision does not, the residuals are summed without error. Rotations count from first
contact, which is known to twice the digits of a double, so that a large separation costs no digit.

Each residual has a bound of its own rounding, found with one of three degrees of care.

1. In double precision, the rounding bounded by Cauchy and Schwarz, |C_ij| <= sqrt(C_ii C_jj), for no more than a few
   sums.
2. The same numbers, the rounding bounded segment by segment with |C| |F|, for a product with C.
3. Sums free of error, rounded once, for some hundred products with C.

The bounds hold for sums taken in any order (Higham 2002, Accuracy and Stability of Numerical Algorithms, chapter 3).
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass, field
from typing import NamedTuple

import numpy as np

from ...core.arrays import RealArray as Array, record
from ...core.checks import array, instance, shown
from ...core.errors import InputError
from ..outcomes import CERTIFICATE_FIELDS as CERTIFICATE_FIELDS
from .compliance_matrix import ComplianceMatrix, ModalCompliance, OperatorCompliance
from .contact_problem import ContactProblem
from .first_contact import ERROR_FREE, UNIT_ROUNDOFF, dot_terms, double_double

#: Greatest error of operations whose result is below the normal numbers [in any unit].
UNDERFLOW = 1e-318
#: Rounding of a product that is not ours, over its greatest entry: assumed, for nothing is known of it. A convolution
#: by FFT of a million segments has 1e-15.
PRODUCT_ROUNDING = 1e-13


class Sizes(NamedTuple):
    """Sizes |F| (n) [N] and |r| (n) [mm], and of the terms of the residuals; S counts from first contact."""

    force: Array
    lever_arm: Array
    least_force: float
    largest_force: float
    total: float
    moment: float  # sum of |F| |r| [N mm]
    strain: float  # sum of |F| |C F| [N mm]
    preload: float  # sum of |F| |S| [N mm]
    roots: float  # sum of |F| over the roots of the diagonal of C
    root: float

    @classmethod
    def of(cls, problem: ContactProblem, force: Array, deflection: Array) -> Sizes:
        """Gather them for forces (n) [N] and C F (n) [mm]."""
        contact, arm = problem.first_contact, problem.lever_arm
        separation, magnitude, least = contact.separation, force, float(force.min())
        if contact.signs:
            arm, separation = np.abs(arm), np.abs(separation)
        if least < 0.0:
            magnitude = np.abs(force)
        root = np.sqrt(problem.compliance_matrix.diagonal)
        largest, total, greatest_root = float(magnitude.max()), float(magnitude.sum()), float(root.max())
        factors = (arm, np.abs(deflection), separation, root)
        moment, strain, preload, roots = (float(magnitude @ factor) for factor in factors)
        return cls(magnitude, arm, least, largest, total, moment, strain, preload, roots, greatest_root)


class Residuals(NamedTuple):
    """Residuals of forces and a rotation in the contact conditions, and bounds of the rounding in them."""

    gap: Array  # C F + S - r theta (n) [mm]
    gap_error: float  # bound for segments that carry load or may touch [mm]
    imbalance: float  # r'F - T [N mm]
    imbalance_error: float
    surplus: float  # F'C F + S'F - theta T [N mm], S and theta from first contact
    surplus_error: float


def rounded_residuals(
    problem: ContactProblem,
    force: Array,
    elastic_rotation: float,
    deflection: Array,
    gap: Array,
    sizes: Sizes,
    *,
    sharp: bool = False,
) -> Residuals:
    """Residuals in double precision, with the deflection C F and the gap (n) [mm].

    ``sharp`` bounds the rounding by segment, with |C| |F|; else by the largest entries of the diagonal of C and of r.
    """
    contact, matrix, size = problem.first_contact, problem.compliance_matrix, force.size
    columns = matrix.factor.shape[1] + 2 if isinstance(matrix, ModalCompliance) else 0
    # A gap that may be none has |S| <= |C F| + |r theta|, and three times its rounding is within these terms.
    terms = (size + columns + 8) * UNIT_ROUNDOFF
    of_arm = 6.0 * UNIT_ROUNDOFF * abs(elastic_rotation) + contact.error * abs(contact.rotation)
    if isinstance(matrix, OperatorCompliance):
        of_product = PRODUCT_ROUNDING * float(np.abs(deflection).max())
        gap_error = of_product + of_arm * float(sizes.lever_arm.max()) + UNDERFLOW
    elif sharp:
        bound = terms * _term_sizes(matrix, sizes.force) + of_arm * sizes.lever_arm + UNDERFLOW
        bound = bound[(force != 0.0) | (gap <= bound)]
        gap_error = float(bound.max()) if bound.size else 0.0
    else:
        gap_error = terms * sizes.roots * sizes.root + of_arm * float(sizes.lever_arm.max()) + UNDERFLOW
    turned, rounding = elastic_rotation * problem.torque, (size + 4) * UNIT_ROUNDOFF
    imbalance = float(force @ problem.lever_arm) - problem.torque
    surplus = float(force @ deflection) + float(force @ contact.separation) - turned
    surplus_error = sizes.total * gap_error + rounding * (sizes.strain + sizes.preload + abs(turned))
    return Residuals(gap, gap_error, imbalance, rounding * sizes.moment, surplus, surplus_error)


def _term_sizes(matrix: ComplianceMatrix, magnitude: Array) -> Array:
    """|C| |F| of the terms that are summed (n)."""
    if isinstance(matrix, ModalCompliance):
        factor = np.abs(matrix.factor)
        return np.asarray(matrix.local * magnitude + factor @ (magnitude @ factor))
    return np.asarray(np.abs(matrix.dense) @ magnitude)


def exact_residuals(problem: ContactProblem, force: Array, elastic_rotation: float) -> Residuals:
    """Residuals as rounded sums of exact products; overflows at numbers near 10^300."""
    arm, turned = problem.lever_arm, dot_terms(problem.lever_arm, np.full(force.size, -elastic_rotation))
    rigid = np.vstack([*_exact_separation(problem), turned.reshape(2, -1)]).T.tolist()  # S - r theta as terms (n, 4)
    rows = zip(_deflection_terms(problem, force), rigid, strict=True)
    gap = np.array([math.fsum([*row, *terms]) for row, terms in rows])
    imbalance = math.fsum([*dot_terms(force, arm), -problem.torque])
    bound = exact_gap_error(problem, gap)
    bound = np.where((force != 0.0) | (gap <= bound), bound, 0.0)
    # F'C F + S'F - theta T = F'Y + theta (r'F - T), the gaps being rounded already.
    of_gaps, of_balance = math.fsum(dot_terms(force, gap)), elastic_rotation * imbalance
    rounding = float(np.abs(force) @ bound) + 4.0 * UNIT_ROUNDOFF * (abs(of_gaps) + abs(of_balance))
    surplus, unbalanced = of_gaps + of_balance, UNIT_ROUNDOFF * abs(imbalance)
    return Residuals(gap, float(bound.max()), imbalance, unbalanced, surplus, rounding)


def exact_gap_error(problem: ContactProblem, gap: Array) -> Array:
    """Return the bound of the error (n) of the gaps of `exact_residuals`."""
    return UNIT_ROUNDOFF * np.abs(gap) + ERROR_FREE * np.abs(problem.separation_at_first_contact) + UNDERFLOW


def _exact_separation(problem: ContactProblem) -> tuple[Array, Array]:
    """S - r S_f / r_f to twice the digits of a double: rounded, and what this lacks (n), see ``first_contact``."""
    first = problem.first_contact.segment
    distance, lever = float(problem.separation[first]), float(problem.lever_arm[first])
    scale = math.ldexp(1.0, -math.frexp(lever)[1])
    size, lever = problem.size, lever * scale
    products = np.concatenate([
        dot_terms(problem.separation, np.full(size, lever)),
        dot_terms(problem.lever_arm * scale, np.full(size, -distance)),
    ]).reshape(4, -1).T  # fmt: skip
    rounded = np.array([math.fsum(row) for row in products]) / lever
    left = np.column_stack([products, dot_terms(rounded, np.full(size, -lever)).reshape(2, -1).T])
    return rounded, np.array([math.fsum(row) for row in left]) / lever


def _deflection_terms(problem: ContactProblem, force: Array) -> Iterator[list[float]]:
    """For each segment, numbers whose exact sum is its deflection."""
    matrix = problem.compliance_matrix
    if not isinstance(matrix, ModalCompliance):
        for row in matrix.dense:
            yield dot_terms(row, force).tolist()
        return
    # The amplitudes V'F to twice the digits of a double: their error is then far below that of one rounding.
    pairs = [double_double(dot_terms(column, force)) for column in matrix.factor.T]
    amplitudes = np.array(pairs).reshape(-1, 2).T.ravel()
    products = dot_terms(matrix.local, force).reshape(2, -1).T.tolist()
    for row, local in zip(np.hstack([matrix.factor, matrix.factor]), products, strict=True):
        yield [*dot_terms(row, amplitudes).tolist(), *local]


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
        # The built-in maximum may or may not notice a NaN, depending on where it stands; a sum always does.
        return math.inf if math.isnan(sum(entries)) else max(entries)

    @property
    def digits(self) -> float:
        """Decimal digits of torque and deflection that cancellation leaves in doubles, at least; 15.95 without any."""
        return max(0.0, -math.log10(UNIT_ROUNDOFF * max(self.cancellation, 1.0)))

    def passes(self, tolerance: float = EXACT_TOLERANCE) -> bool:
        """True if every violation is within the tolerance, whatever the rounding in it."""
        return self.worst + self.resolution <= tolerance

    @property
    def worst_condition(self) -> str:
        """Name of the condition with the largest violation, as in `CERTIFICATE_FIELDS`."""
        entries = [math.inf if math.isnan(value) else value for value in self.violations]
        return CERTIFICATE_FIELDS[entries.index(max(entries))]

    def verdict(self, tolerance: float = EXACT_TOLERANCE) -> str:
        """Return in words whether it passes a tolerance, the worst violation, its rounding, and the digits left.

        Parameters
        ----------
        tolerance
            Largest violation that it may have.

        Examples
        --------
        >>> Certificate(0.0, 0.0, 1e-7, 0.0, 0.0).verdict(1e-8)
        'misses 1e-08: worst violation 1e-07, of negative_gap (rounding bound 0); 15 digits left by cancellation'
        """
        if not self.worst < math.inf:
            return "misses every tolerance: a violation is not a finite number"
        verdict = f"{'passes' if self.passes(tolerance) else 'misses'} {tolerance:.1g}"
        worst = f"worst violation {self.worst:.1g}, of {self.worst_condition}" if self.worst > 0.0 else "no violation"
        left = f"{math.floor(self.digits)} digits left by cancellation"
        return f"{verdict}: {worst} (rounding bound {self.resolution:.1g}); {left}"

    def __str__(self) -> str:
        """As `verdict` says it of the tolerance of exact answers."""
        return self.verdict()


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
    return of_whole_rotation(problem, force, rotation, elastic_rotation).certificate


def resolved_rotation(problem: ContactProblem, force: Array, rotation: float, deflection: Array) -> float:
    """Rotation beyond first contact [rad] that fits the forces best, among those that the given one stands for."""
    elastic_rotation = problem.elastic_rotation(rotation)
    if not problem.torque > 0.0:
        return elastic_rotation
    of_work = float(force @ (deflection + problem.separation_at_first_contact)) / problem.torque
    half = 0.5 * math.ulp(rotation)
    return min(max(of_work, elastic_rotation - half), elastic_rotation + half)


def violations(
    problem: ContactProblem, force: Array, elastic_rotation: float, deflection: Array, gap: Array
) -> Certificate:
    """Certificate where the deflections C F and the gaps (n) [mm] are known already."""
    if not (_finite(gap) and _finite(force)):
        return NO_CERTIFICATE
    with np.errstate(over="ignore", invalid="ignore"):
        sizes = Sizes.of(problem, force, deflection)
        rounded = rounded_residuals(problem, force, elastic_rotation, deflection, gap, sizes)
        certificate = _relative_to_scales(problem, force, elastic_rotation, sizes, rounded)
        known = not isinstance(problem.compliance_matrix, OperatorCompliance)
        if certificate.resolution <= RESOLUTION_LIMIT or not certificate.worst < math.inf or not known:
            return certificate
        sharp = rounded_residuals(problem, force, elastic_rotation, deflection, gap, sizes, sharp=True)
        certificate = _relative_to_scales(problem, force, elastic_rotation, sizes, sharp)
        if certificate.resolution <= RESOLUTION_LIMIT:
            return certificate
        try:
            exact = exact_residuals(problem, force, elastic_rotation)
        except (OverflowError, ValueError):
            return certificate
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
    share = force / sizes.largest_force if sizes.largest_force > 0.0 else force
    shared = np.minimum(share, left.gap / gap_scale)
    resolution = left.gap_error / gap_scale
    if sizes.total > 0.0:
        of_balance = _relative(left.imbalance_error, moment_scale)
        resolution = max(resolution, of_balance, _relative(left.surplus_error, energy_scale))
    imbalance, surplus = _relative(abs(left.imbalance), moment_scale), _relative(abs(left.surplus), energy_scale)
    pulling = _relative(max(-sizes.least_force, 0.0), sizes.largest_force)
    penetration, loaded_gap = max(-float(left.gap.min()), 0.0) / gap_scale, max(float(shared.max()), 0.0)
    return Certificate(imbalance, pulling, penetration, loaded_gap, surplus, resolution, cancellation)


def _gap_scale(problem: ContactProblem, sizes: Sizes, turned: float) -> tuple[float, float]:
    """Mean deflection of the loaded segments [mm], weighted by force, and its relative cancellation.

    The cancellation is the mean of the terms of their gaps, a bound, over the mean deflection, which is not taken below
    what cancellation resolves.
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


def _relative(error: float, scale: float) -> float:
    if error == 0.0:
        return 0.0
    return error / scale if scale > 0.0 else math.inf


@record(frozen=True, eq=False, slots=True)
class Answer:
    """Forces, rotation and gaps, right or wrong: the certificate tells."""

    force: Array
    rotation: float
    gap: Array  # C F + S - r theta (n) [mm], of the data as given
    elastic_rotation: float  # beyond first contact [rad]
    certificate: Certificate
    problem: ContactProblem | None = field(default=None, repr=False)  # of the certificate; None without answer


def no_answer(size: int, certificate: Certificate = NO_CERTIFICATE) -> Answer:
    """Return the answer of a solve without one: NaN for every segment."""
    return Answer(np.full(size, np.nan), math.nan, np.full(size, np.nan), math.nan, certificate)


def unscaled(problem: ContactProblem, force: Array, rotation: float) -> Answer:
    """Answer from forces (n) and rotation beyond first contact in the scale of `problem.scaling`."""
    scaling = problem.scaling
    return with_certificate(problem, scaling.unscale_force(force), scaling.unscale_elastic_rotation(rotation))


def with_certificate(problem: ContactProblem, force: Array, elastic_rotation: float) -> Answer:
    """Return forces [N] and the rotation beyond first contact [rad] with the gaps they leave and the proof."""
    return _answer(problem, force, problem.whole_rotation(elastic_rotation), elastic_rotation)


def of_whole_rotation(
    problem: ContactProblem, force: Array, rotation: float, elastic_rotation: float | None = None
) -> Answer:
    """Return forces [N] of any shape and a rotation from zero [rad] with the proof, if there is one; see `certify`."""
    force = np.asarray(force, dtype=np.float64)
    if force.shape != problem.separation.shape or not (math.isfinite(rotation) and np.isfinite(force).all()):
        return Answer(force, rotation, no_answer(problem.size).gap, math.nan, NO_CERTIFICATE)
    if elastic_rotation is None:
        with np.errstate(over="ignore", invalid="ignore"):
            elastic_rotation = resolved_rotation(problem, force, rotation, problem.deflection(force))
    return _answer(problem, force, rotation, elastic_rotation)


def _answer(problem: ContactProblem, force: Array, rotation: float, elastic_rotation: float) -> Answer:
    with np.errstate(over="ignore", invalid="ignore"):
        # Not from `gap(force, rotation)`, whose difference of rotations would lose the digits of a light load.
        deflection = problem.deflection(force)
        gap = deflection + problem.separation_at_first_contact - elastic_rotation * problem.lever_arm
    certificate = NO_CERTIFICATE
    if math.isfinite(rotation):
        certificate = violations(problem, force, elastic_rotation, deflection, gap)
    return Answer(force, rotation, gap, elastic_rotation, certificate, problem)


def require_convex(problem: ContactProblem) -> None:
    """Refuse a compliance that is not positive semidefinite."""
    if not problem.is_positive_semidefinite:
        raise InputError(
            "the compliance has a negative eigenvalue: its contact problem is no minimum and has no other form"
        )


def vector_of(value: object, name: str, size: int) -> Array:
    """Return an answer of a solver as an array of the given size; InputError where it is none."""
    vector = array(name, value, anything=True)
    if vector.shape != (size,):
        raise InputError(f"{name} = {shown(vector)}: must have the shape ({size},)")
    return vector
