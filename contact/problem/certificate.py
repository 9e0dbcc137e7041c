"""Certificate of an answer: violations of every condition of the contact problem by forces and rotation.

The certificate is evaluated on the problem as the user gave it, never on a scaled or clipped one, and never from the
report of a solver. It needs no reference solution: the problem is convex, so whoever satisfies all conditions
has the answer.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, fields

import numpy as np
from numpy.typing import NDArray

from .contact_problem import ContactProblem

Array = NDArray[np.float64]

#: Largest violation of a certified answer of the native solver, and of every polished one.
EXACT_TOLERANCE = 1e-9

#: Cancellation in C F or r'F beyond this factor leaves fewer than the digits that EXACT_TOLERANCE asks for.
_CANCELLATION_FLOOR = 1e-5


@dataclass(frozen=True)
class Certificate:
    """Violations of the conditions, all dimensionless; zero is perfect.

    Attributes
    ----------
    equilibrium
        |r'F - T| / T.
    negative_force
        max(-F, 0) over the peak force.
    negative_gap
        max(-Y, 0), penetration, over the mean deflection of the loaded segments.
    complementarity
        max of min(F, Y), each by its scale: no segment carries load across a gap.
    duality_gap
        |F'CF + S'F - theta T| over the deformation energy: work of the torque against work on the segments.

    Examples
    --------
    >>> Certificate(0.0, 0.0, 1e-7, 0.0, 0.0).worst, Certificate(0.0, 0.0, 1e-7, 0.0, 0.0).passes(1e-6)
    (1e-07, True)
    """

    equilibrium: float
    negative_force: float
    negative_gap: float
    complementarity: float
    duality_gap: float

    @property
    def worst(self) -> float:
        """The largest of all violations; infinite if one of them is not a number."""
        entries = (
            self.equilibrium,
            self.negative_force,
            self.negative_gap,
            self.complementarity,
            self.duality_gap,
        )
        # The built-in maximum may or may not notice a NaN, depending on where it stands.
        return math.inf if any(map(math.isnan, entries)) else max(entries)

    def passes(self, tolerance: float = EXACT_TOLERANCE) -> bool:
        """Whether every violation is within the tolerance."""
        return self.worst <= tolerance


#: Names of the violations.
CERTIFICATE_FIELDS = tuple(field.name for field in fields(Certificate))
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
        Rotation beyond first contact [rad], where it is known to more digits than the difference of `rotation` and
        the rotation of first contact can hold (light loads, large separations).

    Returns
    -------
    Certificate
        Infinite throughout where forces or rotation are not finite.

    Notes
    -----
    A penetration that the last digit of the given rotation cannot express is not held against the answer.

    Examples
    --------
    The second of two springs carries nothing, although the bodies have closed its gap:

    >>> import numpy as np
    >>> from easeoff.contact import ContactProblem
    >>> springs = ContactProblem(np.zeros(2), np.full(2, 40.0), 8.0e4, np.diag([1e-6, 1e-6]))
    >>> round(certify(springs, np.array([2000.0, 0.0]), 5e-5).negative_gap, 9)
    1.0
    """
    force = np.asarray(force, dtype=np.float64)
    if force.shape != problem.separation.shape or not (math.isfinite(rotation) and np.isfinite(force).all()):
        return NO_CERTIFICATE
    if elastic_rotation is None:
        resolution = math.ulp(rotation)
        elastic_rotation = rotation - problem.first_contact_rotation
    else:
        resolution = math.ulp(elastic_rotation)
    with np.errstate(over="ignore", invalid="ignore"):
        deflection = problem.deflection(force)
        gap = deflection + problem.separation_at_first_contact - elastic_rotation * problem.lever_arm
    return violations(problem, force, elastic_rotation, deflection, gap, resolution)


def violations(
    problem: ContactProblem,
    force: Array,
    elastic_rotation: float,
    deflection: Array,
    gap: Array,
    resolution: float,
) -> Certificate:
    """Return the certificate where the deflections C F and the gaps [mm], both (n), are known already.

    Parameters
    ----------
    problem, force, elastic_rotation
        As `certify` has them.
    deflection, gap
        Of these forces, at this rotation (n) [mm].
    resolution
        Unit in the last place of the rotation [rad].
    """
    if not np.isfinite(gap).all():
        return NO_CERTIFICATE
    arm, separation = problem.lever_arm, problem.separation_at_first_contact
    magnitude = np.abs(force)
    total = float(magnitude.sum())
    with np.errstate(over="ignore", invalid="ignore"):
        moment_scale = max(problem.torque, _CANCELLATION_FLOOR * float(magnitude @ np.abs(arm)))
        force_scale = float(magnitude.max())
        gap_scale = _gap_scale(problem, magnitude, total, deflection)
        unknown = resolution * np.abs(arm)
        penetration = -gap - unknown
        work = float(force @ deflection + force @ separation)
        energy_scale = total * gap_scale + float(magnitude @ np.abs(separation))
        shared = np.minimum(_ratio(force, force_scale), (gap - unknown) / gap_scale)
        return Certificate(
            equilibrium=_relative(abs(float(force @ arm) - problem.torque), moment_scale),
            negative_force=_relative(max(-float(force.min()), 0.0), force_scale),
            negative_gap=max(float(penetration.max()), 0.0) / gap_scale,
            complementarity=max(float(shared.max()), 0.0),
            duality_gap=_relative(
                max(abs(work - elastic_rotation * problem.torque) - resolution * problem.torque, 0.0), energy_scale
            ),
        )


def _gap_scale(problem: ContactProblem, magnitude: Array, total: float, deflection: Array) -> float:
    """Mean deflection of the loaded segments [mm], weighted by force, but not below what cancellation resolves."""
    if total > 0.0:
        mean = float(magnitude @ np.abs(deflection)) / total
        root = np.sqrt(problem.compliance_diagonal)
        without_cancellation = float(magnitude @ root) * float(magnitude @ root) / total  # bounds F'|C|F / sum F
        scale = max(mean, _CANCELLATION_FLOOR * without_cancellation)
        if scale > 0.0:
            return scale
    largest = float(np.abs(problem.separation_at_first_contact).max())  # no load or no compliance
    return largest if largest > 0.0 else 1.0


def _ratio(values: Array, scale: float) -> Array:
    return values / scale if scale > 0.0 else values


def _relative(error: float, scale: float) -> float:
    if error == 0.0:
        return 0.0
    return error / scale if scale > 0.0 else math.inf
