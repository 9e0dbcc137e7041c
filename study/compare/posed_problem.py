"""Posed problem: a contact problem of a comparison with its number in a file, its digest and its reference."""

from __future__ import annotations

import hashlib
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from ...contact.problem.contact_problem import ContactProblem
from ...contact.problem.exchange.problem_file import read_labels, read_problems
from ...contact.solvers import ContactSolution, solve
from ...core.errors import InputError
from .attempt import Attempt
from .comparison_table import Row


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
        Segments (n) in contact in the problem before, for a warm start; ``None`` if that does not fit.
    name, kind
        Labels of the file; empty if it has none.
    """

    file: str
    number: int
    problem: ContactProblem
    digest: str
    reference: ContactSolution
    before: NDArray[np.bool_] | None
    name: str = ""
    kind: str = ""

    def row(self, solver: str, settings: str, start: str, repetition: int, attempt: Attempt) -> Row:
        """Row of the table for an attempt at this problem."""
        return Row(
            problem_file=self.file,
            problem=self.number,
            problem_name=self.name,
            kind=self.kind,
            size=self.problem.size,
            gear_torque=self.problem.torque * 1e-3,
            solver=solver,
            settings=settings,
            start=start,
            repetition=repetition,
            attempt=attempt,
            reference_rotation=self.reference.elastic_rotation,
        )


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
    before: NDArray[np.bool_] | None = None
    for number, problem in enumerate(problems):
        if not problem.is_positive_semidefinite:
            raise InputError(
                f"{path}, problem {number}: its compliance has a negative eigenvalue, so no answer can be proved"
            )
        reference = solve(problem, "native")
        usable = before if before is not None and before.size == problem.size else None
        digest = problem_digest(problem)
        posed.append(PosedProblem(name, number, problem, digest, reference, usable, names[number], kinds[number]))
        before = reference.active if reference.certified else None
    return posed


def problem_digest(problem: ContactProblem) -> str:
    """Digest of all data of a problem: the same for identical problems only."""
    parts = problem.compliance if isinstance(problem.compliance, tuple) else (problem.compliance,)
    digest = hashlib.sha256(np.float64(problem.torque).tobytes())
    for array in (problem.separation, problem.lever_arm, *parts):
        digest.update(repr(array.shape).encode())
        digest.update(np.ascontiguousarray(array).tobytes())
    return digest.hexdigest()
