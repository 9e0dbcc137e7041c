"""Write the table of agreement in contact_solvers.md: python docs/make agreement.

Every installed solver, unpolished and at the settings of the table of solvers, on random and degenerate problems and on
those of two gears: how far its multipliers are from rotation and gaps of the native solver.

After a change of solvers or of their settings; takes a minute.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from dataclasses import dataclass

import numpy as np
from dissertation_method import by_its_method
from folders import NOTES
from tabulate import tabulate

from easeoff.contact import SOLVERS, ContactProblem, available_solvers, solve
from easeoff.contact.solvers.backend import NoAnswerError, chosen_form
from easeoff.contact.solvers.backend_solution import adapter_of
from easeoff.contact.solvers.polish import polished_answer
from easeoff.study import CaseInMesh
from easeoff.study.analysis.contact_analysis import contact_analysis
from easeoff.verification import problems
from easeoff.verification.problem_classes import PROBLEM_CLASSES

PAGE = NOTES / "contact_solvers.md"
HEADING = "## Agreement"
PER_CLASS = 10
GEARS = {"nasa-12x36": [40.0, 150.0, 400.0], "fm-11x41": [50.0, 250.0, 500.0]}
MESH_POSITIONS = 4


@dataclass(frozen=True)
class Agreement:
    """A solver beside the native one on some problems; errors are the greatest among its certified answers.

    Attributes
    ----------
    certified, number : int
        Problems with a certified answer, and all.
    rotation : float
        Relative error of the rotation beyond first contact that the multiplier of the balance gives.
    gap : float
        Error of the gaps that the multipliers of the bounds give, over the greatest deflection; NaN without them.
    certificate : float
        Worst violation.
    """

    certified: int
    number: int
    rotation: float
    gap: float
    certificate: float

    def cells(self) -> list[str]:
        """The columns of the table."""
        gap = "-" if np.isnan(self.gap) else f"{self.gap:.0e}"
        return [f"{self.certified} of {self.number}", f"{self.rotation:.0e}", gap, f"{self.certificate:.0e}"]


def agreement(name: str, chosen: Iterable[ContactProblem], form: str = "auto") -> Agreement:
    """Compare a solver's own multipliers with the answer of the native solver."""
    adapter = adapter_of(name)
    entry = SOLVERS[name]
    number, errors = 0, []
    for problem in chosen:
        number += 1
        scaled, reference = problem.scaled(), solve(problem)
        assert reference.certified
        settings = {**entry.settings, **({"form": "lifted"} if chosen_form(name, scaled, form) == "lifted" else {})}
        try:
            answer = adapter(scaled, settings)
        except NoAnswerError:
            continue
        found = polished_answer(problem, scaled, answer, None).answer
        if not found.certificate.passes(entry.tolerance):
            continue
        rotation = reference.elastic_rotation / problem.scaling.rotation
        deflection = scaled.compliance @ (reference.force / problem.scaling.force)
        gap = deflection + scaled.separation - rotation * scaled.lever_arm
        error = np.nan if answer.gap is None else np.abs(answer.gap - gap).max() / np.abs(deflection).max()
        errors.append((abs(answer.rotation - rotation) / abs(rotation), error, found.certificate.worst))
    worst = np.max(errors, axis=0) if errors else np.full(3, np.nan)
    return Agreement(len(errors), number, *(float(value) for value in worst))


def random_problems() -> Iterator[ContactProblem]:
    """Some of every class."""
    for name in PROBLEM_CLASSES:
        yield from problems(name, PER_CLASS, seed=5)


def gear_problems() -> Iterator[ContactProblem]:
    """Mesh positions of two shipped cases under three torques, with shells on lines as in the problem library."""
    for name, torques in GEARS.items():
        case = by_its_method(name)
        case = case.model_copy(update={"contact": case.contact.model_copy(update={"mesh_positions": MESH_POSITIONS})})
        for solved in contact_analysis(CaseInMesh.of(case), torques).cases:
            yield solved.problem


def table() -> str:
    """The table of the page."""
    sets = {"random": list(random_problems()), "gears": list(gear_problems())}
    rows = [
        [f"`{name}`", *(cell for chosen in sets.values() for cell in agreement(name, chosen).cells())]
        for name in available_solvers()
        if name != "native" and name in SOLVERS
    ]
    heads = ["certified", "rotation", "gap", "certificate"]
    headers = ["solver", *(f"{name}: {head}" for name in sets for head in heads)]
    return tabulate(rows, headers=headers, tablefmt="github", disable_numparse=True)


def updated(page: str, made: str) -> str:
    """Return the page with the first table behind the heading replaced."""
    before, behind = page.split(HEADING, 1)
    start = behind.index("\n|") + 1
    end = behind.index("\n\n", start)
    return before + HEADING + behind[:start] + made + behind[end:]


def main() -> None:
    """Write the table into the page."""
    PAGE.write_text(updated(PAGE.read_text(encoding="utf-8"), table()), encoding="utf-8")
    print(f"wrote {PAGE}")


if __name__ == "__main__":
    main()
