"""Posed problem: a contact problem of a comparison with its number in a file, its digest and its reference.

A solver that returns what it has kept from an earlier call shall neither be right nor be fast. So no call has the data
of the one before: separations and torque are multiplied by a load factor, other for each call, and with them the forces
and the rotation of the answer. Active set and conditioning stay as they are, and each answer is certified, and compared
with the reference, on the data of its own call.
"""

from __future__ import annotations

import hashlib
import math
from dataclasses import dataclass, replace
from functools import cached_property
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from ....contact.problem.answer import with_certificate
from ....contact.problem.contact_problem import ContactProblem
from ....contact.problem.exchange.problem_file import read_labels, read_problems
from ....contact.solvers import ContactSolution, solve
from ....core.errors import InputError
from .method import SETTINGS, WARM, Method

#: Load factors are one and a number of such steps.
FACTOR_COUNT, FACTOR_STEP = 31, 1.0 / 62.0
#: Load factor of the call that is not measured, the first in a process.
UNMEASURED_FACTOR = 1.0 + 0.5 * FACTOR_STEP
#: Certificate below which the answer to the problem before solves this one, too: there is nothing to measure.
START_CERTIFICATE = 1e-3


@dataclass(frozen=True, eq=False)
class PosedProblem:
    """A problem of a file and the reference that answers to it are compared with.

    Parameters
    ----------
    file
        Name of the file in the table.
    number
        Number of the problem in its file, from 0.
    problem
        The problem itself.
    digest
        Digest of its data, see ``problem_digest``.
    reference
        Solution of the native solver.
    before
        Forces (n) [N] of the problem before, for a warm start; ``None`` if that does not fit, or has the same answer.
    name, kind
        Labels of the file; empty if it has none.
    """

    file: str
    number: int
    problem: ContactProblem
    digest: str
    reference: ContactSolution
    before: NDArray[np.float64] | None
    name: str = ""
    kind: str = ""

    def start(self, method: Method) -> NDArray[np.float64] | None:
        """Return the forces (n) [N] that a method starts from; None for a cold start."""
        return self.before if method.start == WARM else None

    @cached_property
    def before_digest(self) -> str:
        """Digest of the warm start; empty if there is none."""
        return "" if self.before is None else hashlib.sha256(self.before.tobytes()).hexdigest()

    def varied(self, factor: float) -> PosedProblem:
        """Return the same problem with separations, torque and warm start multiplied by a factor."""
        if factor == 1.0:
            return self
        problem = multiplied(self.problem, factor)
        before = None if self.before is None else factor * self.before
        return replace(self, problem=problem, reference=solve(problem, "native"), before=before)


def multiplied(problem: ContactProblem, factor: float) -> ContactProblem:
    """Return a problem with separations and torque multiplied: its forces and rotation are multiplied alike."""
    return ContactProblem(factor * problem.separation, problem.lever_arm, factor * problem.torque, problem.compliance)


def load_factor(method: Method, repetition: int, number: int) -> float:
    """Return the load factor of a call, the same in every comparison, other than those of the calls before and after.

    Parameters
    ----------
    method
        The method.
    repetition
        From 1.
    number
        Number of the problem in its file, from 0.

    Examples
    --------
    >>> load_factor(Method("osqp", "scaled"), 1, 0), load_factor(Method("osqp", "scaled"), 2, 0) > 1.0
    (1.0, True)
    """
    kind = (2 * list(SETTINGS).index(method.settings)) + (method.start == WARM)
    if method.tolerance:
        kind += round(-10.0 * math.log10(method.tolerance))
    # Multiples of other primes: neighbours in any of the three are apart.
    return 1.0 + FACTOR_STEP * ((11 * kind + 7 * number + repetition - 1) % FACTOR_COUNT)


def posed_problems(path: Path, name: str) -> list[PosedProblem]:
    """Read the problems of a file and solve them for reference.

    Parameters
    ----------
    path
        The file.
    name
        Its name in the table.

    Raises
    ------
    InputError
        If the file cannot be read, has no problems, or has one that is not convex: no certificate could prove it.
    """
    problems = read_problems(path)
    if not problems:
        raise InputError(f"{path} holds no contact problems")
    labels = read_labels(path)
    names, kinds = ([str(value) for value in labels.get(key, [""] * len(problems))] for key in ("name", "kind"))
    posed: list[PosedProblem] = []
    before: NDArray[np.float64] | None = None
    for number, problem in enumerate(problems):
        if not problem.is_positive_semidefinite:
            raise InputError(
                f"{path}, problem {number}: its compliance has a negative eigenvalue, so no answer can be proved"
            )
        reference = solve(problem, "native")
        usable = before if before is not None and _is_start(problem, before) else None
        digest = problem_digest(problem)
        posed.append(PosedProblem(name, number, problem, digest, reference, usable, names[number], kinds[number]))
        before = reference.force if reference.certified else None
    return posed


def _is_start(problem: ContactProblem, force: NDArray[np.float64]) -> bool:
    """Whether forces (n) [N] can start the solution of a problem: of its size, and not its answer already."""
    if force.size != problem.size:
        return False
    work = float(force @ (problem.deflection(force) + problem.separation_at_first_contact))
    rotation = work / problem.torque if problem.torque > 0.0 else 0.0
    return not with_certificate(problem, force, rotation).certificate.passes(START_CERTIFICATE)


def problem_digest(problem: ContactProblem) -> str:
    """Digest of all data of a problem: the same for identical problems only."""
    parts = problem.compliance if isinstance(problem.compliance, tuple) else (problem.compliance,)
    digest = hashlib.sha256(np.float64(problem.torque).tobytes())
    for array in (problem.separation, problem.lever_arm, *parts):
        digest.update(repr(array.shape).encode())
        digest.update(np.ascontiguousarray(array).tobytes())
    return digest.hexdigest()
