"""Solution of a contact problem: answer, certificate and status.

Scaled answer: forces and rotation of a contact problem in scaled numbers, not yet certified.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING, Any

import numpy as np

from ...core.arrays import Bools, RealArray as Array
from ...core.errors import InputError
from ..outcomes import Status as Status
from ..problem.certificate import NO_CERTIFICATE, Answer, Certificate, no_answer
from ..problem.conditioning import Conditioning, conditioning, unknown_conditioning
from ..problem.contact_problem import ContactProblem

if TYPE_CHECKING:
    from .parametric.sensitivity import Sensitivity


#: Claims of a solver besides the names of `Status` in lower case: a solution, or an exception.
SOLVED, RAISED = "solved", "raised"


#: Ends that a solver reports of itself. What it says of the data is a claim, whatever it says.
OWN_ENDS = (Status.SOLVER_FAILED, Status.TIME_LIMIT, Status.NOT_CONVERGED)


@dataclass(frozen=True)
class CallTimes:
    """Times of the parts of a call of a backend [s]; NaN where unknown."""

    call: float = math.nan  # from the data in the backend's form to its answer
    setup: float = math.nan
    solve: float = math.nan
    measured_by: str = ""  # setup and solve: solver, interface, or empty for nobody
    polish: float = math.nan  # with the certificates it takes


@dataclass(frozen=True, eq=False, repr=False)
class ContactSolution:
    """Forces, rotation and gaps of one contact problem, with proof.

    Attributes
    ----------
    answer
        The numbers found, certified or not: those of a refused answer stand here alone.
    status
        End of the solve.
    solver
        Name of the solver that was used.
    iterations
        Its iterations; -1 if unknown.
    claim
        The solver's own report, right or wrong: ``solved``, ``raised``, or the name of a `Status` in lower case.
    method
        Method of the native solver that found the answer, or form in which a backend was given the problem.
    run_time
        Wall time of the whole call [s]: checks, scaling, solver, polish and certificate; of many problems solved
        together, a share of it.
    polished
        Whether the answer was made exact by solving on the active set that the solver had found.
    tolerance
        Largest violation that the certificate may have.
    message
        The method and what happened, in plain words.
    words
        The solver's own message, as it is.
    stiffness
        Torque that turns the gear by one radian while the touching segments keep contact, their line contacts yielding
        by the tangent [N mm/rad]; NaN where the method does not give it.
    exchanges
        Exchanges of segments that the polish made: zero if the active set of the solver was right.
    times
        Times of the parts of a call of a backend.

    Examples
    --------
    >>> import numpy as np
    >>> from easeoff.contact import ContactProblem, solve
    >>> solution = solve(ContactProblem(np.zeros(2), np.full(2, 40.0), 8.0e4, np.diag([1e-6, 1e-6])))
    >>> solution.certified, solution.claim, solution.force.tolist(), solution.energy
    (True, 'solved', [1000.0, 1000.0], 1.0)
    >>> print(repr(solution).splitlines()[0])
    ContactSolution: native, certified, 2 of 2 segments in contact, rotation 2.5e-05 rad
    """

    answer: Answer
    status: Status
    solver: str
    iterations: int = -1
    claim: str = ""
    method: str = ""
    run_time: float = math.nan
    polished: bool = False
    tolerance: float = 0.0
    message: str = ""
    exchanges: int = 0
    times: CallTimes = CallTimes()
    words: str = ""
    stiffness: float = math.nan

    def __repr__(self) -> str:
        """Solver and how it ended; of a certified solution segments in contact, rotation and certificate."""
        head = f"ContactSolution: {self.solver}, {self.status.name.lower().replace('_', ' ')}"
        if not self.certified:
            return f"{head}\n  {self.message}" if self.message else head
        touching = f"{np.count_nonzero(self.active)} of {self.force.size} segments in contact"
        return f"{head}, {touching}, rotation {self.rotation:.6g} rad\n  {self.certificate.verdict(self.tolerance)}"

    @property
    def certified(self) -> bool:
        """True if the answer is proved."""
        return self.status is Status.CERTIFIED

    @cached_property
    def _proved(self) -> Answer:
        return self.answer if self.certified else no_answer(self.answer.force.size)

    @property
    def force(self) -> Array:
        """Normal forces (n) [N]; NaN unless certified."""
        return self._proved.force

    @property
    def rotation(self) -> float:
        """Rotation of the gear [rad]; NaN unless certified."""
        return self._proved.rotation

    @property
    def gap(self) -> Array:
        """Gaps left under load (n) [mm]; NaN unless certified."""
        return self._proved.gap

    @property
    def elastic_rotation(self) -> float:
        """Rotation beyond the first contact of the rigid bodies [rad], free of the cancellation in the difference."""
        return self._proved.elastic_rotation

    @property
    def problem(self) -> ContactProblem | None:
        """The problem solved, of load-dependent line contact with the secant compliance; None without an answer."""
        return self.answer.problem

    @cached_property
    def energy(self) -> float:
        """Deformation energy 1/2 F'C F of the forces [N mm]; NaN unless certified."""
        if self.problem is None or not self.certified:
            return math.nan
        return 0.5 * float(self.force @ self.problem.deflection(self.force))

    def sensitivity(self) -> Sensitivity:
        """Return the derivatives of the solution by the data of its problem; see `easeoff.contact.sensitivity`.

        Of a solution with load-dependent line contact these are the derivatives of the linear problem with the secant
        compliance; `easeoff.contact.line_contact_sensitivity` has those of the problem itself.

        Raises
        ------
        InputError
            The solution is not certified.

        Examples
        --------
        >>> from easeoff.contact import ContactProblem, solve
        >>> solution = solve(ContactProblem(np.zeros(2), np.full(2, 40.0), 8.0e4, np.diag([1e-6, 1e-6])))
        >>> solution.sensitivity().forward(torque=80.0).force.round(9).tolist()
        [1.0, 1.0]
        """
        from .parametric.sensitivity import answer_sensitivity  # most solutions are not differentiated

        if self.problem is None or not self.certified:
            raise InputError(f"solution = {self.status.name.lower()}: must be certified to have derivatives")
        return answer_sensitivity(self.problem, self.answer)

    @property
    def certificate(self) -> Certificate:
        """Certificate of the answer, also of one that was refused."""
        return self.answer.certificate

    @cached_property
    def conditioning(self) -> Conditioning:
        """Uniqueness of the forces, and bounds of the errors; computed when it is first asked for."""
        answer = self.answer
        if answer.problem is None:
            return unknown_conditioning(answer.force.size)
        return conditioning(answer.problem, answer.force, answer.elastic_rotation)

    @property
    def active(self) -> Bools:
        """Segments that carry load, (n): the warm start of a neighbouring problem.

        An exact answer, of the native solver or polished, has zero on all others. In the answer of another solver a
        force up to its `tolerance` of the greatest is none: the certificate could not tell it from zero.
        """
        exact = self.polished or self.solver == "native"
        return self.force > (0.0 if exact else self.tolerance * float(self.force.max()))


def judged(
    solver: str, answer: Answer, *, tolerance: float, suspicion: Status | None = None, claim: str = "", **facts: Any
) -> ContactSolution:
    """Solution with the status that the certificate of an answer gives it, and what else is known of it.

    The suspicion, the solver's own report, is the status of a refused answer if in `OWN_ENDS`, else `NOT_CERTIFIED`.
    """
    status = suspicion if suspicion in OWN_ENDS else Status.NOT_CERTIFIED
    if answer.certificate.passes(tolerance):
        status = Status.CERTIFIED
    claim = claim or (SOLVED if status is Status.CERTIFIED else status.name.lower())
    return ContactSolution(answer, status, solver, claim=claim, tolerance=tolerance, **facts)


def no_solution(
    size: int, status: Status, solver: str, *, claim: str = "", certificate: Certificate = NO_CERTIFICATE, **facts: Any
) -> ContactSolution:
    """Return the solution of a solve without an answer: NaN forces, and what is known of it."""
    return ContactSolution(no_answer(size, certificate), status, solver, claim=claim or status.name.lower(), **facts)


#: Ends of a solve in words, where there is no certified answer.
_ENDS = {
    Status.NOT_CERTIFIED: "refused",
    Status.INFEASIBLE: "it reports that no forces satisfy the conditions",
    Status.UNBOUNDED: "no forces satisfy the conditions",
    Status.SOLVER_FAILED: "it failed",
    Status.TIME_LIMIT: "ended at the time limit",
    Status.NOT_CONVERGED: "ended before it converged",
}


def course(method: str, solution: ContactSolution, words: str = "") -> str:
    """Method and end of a solution, in plain words."""
    count = solution.iterations
    steps = f", {count} step{'' if count == 1 else 's'}" if count >= 0 else ""
    if solution.polished:
        moved = f" after {solution.exchanges} exchange{'' if solution.exchanges == 1 else 's'} of segments"
        end = f"made exact on the active set it found{moved if solution.exchanges else ''}"
    else:
        end = "certified" if solution.certified else _ENDS.get(solution.status, solution.status.name.lower())
    worst = solution.certificate.worst
    if not solution.certified and math.isfinite(worst):
        end += f"; the certificate of its answer, {worst:.1e}, misses {solution.tolerance:.1e}"
    said = f"; its own words: {words}" if words else ""
    return f"{method}{steps}: {end}{said}"


@dataclass(frozen=True, eq=False, slots=True)
class ScaledAnswer:
    """An answer to a `ScaledProblem`, not yet certified."""

    force: Array
    rotation: float
    iterations: int  # -1 if unknown
    message: str = ""
    suspicion: Status | None = None  # counts only if the certificate refuses
    gap: Array | None = None  # multipliers of the bounds, in the sign of gaps; only for comparison
    times: CallTimes | None = None
