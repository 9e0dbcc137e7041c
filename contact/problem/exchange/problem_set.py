"""Contact problems of a file with what the file says of each: labels and reference solutions."""

from __future__ import annotations

import os
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ....core.checks import frozen_arrays, shown
from ....core.errors import InputError
from ..answer import Answer
from ..contact_problem import ContactProblem


@frozen_arrays
@dataclass(frozen=True, eq=False)
class ProblemSet:
    """Contact problems with labels and reference solutions.

    Attributes
    ----------
    problems
        The problems.
    labels
        By name an array of one entry a problem, such as ``name``, ``kind`` and ``mesh_position``.
    answers
        Reference solutions, one a problem; None if there are none.
    attributes
        What holds for all problems, text or numbers by name; formats other than netCDF have no place for it.

    Examples
    --------
    >>> import numpy as np
    >>> springs = ContactProblem(np.zeros(2), np.full(2, 40.0), 8.0e4, np.diag([1e-6, 1e-6]))
    >>> ProblemSet([springs, springs], {"name": np.array(["one spring/mm", ""])}).file_names()
    ['one_spring_mm', 'problem_0001']
    """

    problems: Sequence[ContactProblem]
    labels: Mapping[str, NDArray[Any]] = field(default_factory=dict)
    answers: Sequence[Answer] | None = None
    attributes: Mapping[str, Any] = field(default_factory=dict)

    @classmethod
    def of(cls, problems: ProblemSet | Sequence[ContactProblem]) -> ProblemSet:
        """Problems as a set, if they are not one already.

        Raises
        ------
        InputError
            No problems.
        """
        given = problems if isinstance(problems, ProblemSet) else cls(problems)
        require_problems(given.problems)
        return given

    def answer(self, i: int) -> Answer | None:
        """Reference solution of problem i; None if there is none."""
        return None if self.answers is None else self.answers[i]

    def label(self, i: int) -> dict[str, Any]:
        """Labels of problem i."""
        return {name: np.asarray(values)[i] for name, values in self.labels.items()}

    def file_names(self, stem: str = "problem") -> list[str]:
        """Names for files of single problems: the labels ``name``; stem and number where these are missing or alike."""
        numbers = [f"{stem}_{i:04d}" for i in range(len(self.problems))]
        if "name" not in self.labels:
            return numbers
        names = ["".join(c if c.isalnum() or c in "-+." else "_" for c in str(n)) for n in self.labels["name"]]
        return [
            name if name.strip("_.") and names.count(name) == 1 else number
            for name, number in zip(names, numbers, strict=True)
        ]


def require_problems(problems: object) -> None:
    """Refuse anything but a sequence of contact problems.

    Raises
    ------
    InputError
        Another type, such as the name of a file, or no problems.
    """
    if isinstance(problems, str | os.PathLike | ContactProblem) or not isinstance(problems, Sequence):
        raise InputError(f"problems = {shown(problems)}: must be a list of contact problems, the file comes after it")
    if not problems:
        raise InputError("problems = []: must hold at least one contact problem")
    for i, one in enumerate(problems):
        if not isinstance(one, ContactProblem):
            raise InputError(f"problems[{i}] = {shown(one)}: must be a ContactProblem")


def joined(sets: Sequence[ProblemSet]) -> ProblemSet:
    """Return the problems of several sets as one, with the labels that all have, and answers if all have them.

    Examples
    --------
    >>> springs = ContactProblem(np.zeros(2), np.full(2, 40.0), 8.0e4, np.diag([1e-6, 1e-6]))
    >>> one = ProblemSet([springs], {"name": np.array(["springs"]), "step": np.array([0])})
    >>> both = joined([one, ProblemSet([springs], {"name": np.array(["again"])})])
    >>> both.labels["name"].tolist(), list(both.labels)
    (['springs', 'again'], ['name'])
    """
    names = [name for name in sets[0].labels if all(name in one.labels for one in sets)]
    answers = [one.answers for one in sets if one.answers is not None]
    return ProblemSet(
        [problem for one in sets for problem in one.problems],
        {name: np.concatenate([np.asarray(one.labels[name]) for one in sets]) for name in names},
        [answer for some in answers for answer in some] if len(answers) == len(sets) else None,
    )
