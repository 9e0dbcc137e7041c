"""Checksum of a contact problem: of its numbers, whatever file, compression or padding holds them."""

from __future__ import annotations

import hashlib
from collections.abc import Sequence

import numpy as np

from ....core.checks import instance
from ..contact_problem import ContactProblem


def problem_checksum(problem: ContactProblem) -> str:
    """Return the SHA-256 of the numbers of a problem, in hexadecimal digits.

    The digest is over the doubles, little endian, row by row: T; S; r; then C, or d and V. Negative zeros count as
    zeros. Problems that are identical have the same checksum; so have the same numbers in another file or program.

    Examples
    --------
    >>> springs = ContactProblem(np.zeros(2), np.full(2, 40.0), 8.0e4, np.diag([1e-6, 1e-6]))
    >>> problem_checksum(springs)[:8]
    'cf7e0c8f'
    """
    instance("problem", problem, ContactProblem)
    parts = problem.compliance if isinstance(problem.compliance, tuple) else (problem.dense_compliance,)
    digest = hashlib.sha256()
    for array in (problem.torque, problem.separation, problem.lever_arm, *parts):
        digest.update((np.ascontiguousarray(array, dtype="<f8") + 0.0).tobytes())
    return digest.hexdigest()


def set_checksum(names: Sequence[str], problems: Sequence[ContactProblem]) -> str:
    """Return the SHA-256 of the lines ``name checksum`` of problems in order, in hexadecimal digits.

    Examples
    --------
    >>> springs = ContactProblem(np.zeros(2), np.full(2, 40.0), 8.0e4, np.diag([1e-6, 1e-6]))
    >>> set_checksum(["one"], [springs]) == set_checksum(["two"], [springs])
    False
    """
    lines = (f"{name} {problem_checksum(problem)}\n" for name, problem in zip(names, problems, strict=True))
    return hashlib.sha256("".join(lines).encode()).hexdigest()
