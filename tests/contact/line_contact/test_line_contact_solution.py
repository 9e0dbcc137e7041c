"""Contact with load-dependent line contact: optimality of the nonlinear problem, descent, and honesty about failure."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray
from solver_choice import installed

from easeoff import InputError, MissingSolverError
from easeoff.contact import SOLVERS, ContactProblem, ContactSolution, Status, solve
from easeoff.contact.line_contact.line_contact_solution import LineContact, NewtonIteration, solve_on_bending
from easeoff.contact.problem.certificate import EXACT_TOLERANCE
from easeoff.verification import problems

Array = NDArray[np.float64]


@dataclass
class Logarithmic:
    """Line contact of Weber's form, K q (L - ln q) per length, linear at small load; records where it was asked."""

    length: Array
    scale: float = 2.8e-6
    level: float = 11.0
    floor: float = 1e-2
    visited: list[Array] = field(default_factory=list)

    def _intensity(self, force: Array) -> Array:
        return np.maximum(np.abs(force) / self.length, self.floor)

    def secant(self, force: Array) -> Array:
        return self.scale * (self.level - np.log(self._intensity(force))) / self.length

    def deflection(self, force: Array) -> Array:
        return self.secant(force) * force

    def tangent(self, force: Array) -> Array:
        self.visited.append(force.copy())
        return self.secant(force) - np.where(np.abs(force) / self.length > self.floor, self.scale, 0.0) / self.length

    def energy(self, force: Array) -> Array:
        q, q0 = np.abs(force) / self.length, self.floor
        above = 0.5 * self.scale * q**2 * (self.level - np.log(np.maximum(q, q0)) + 0.5)
        below = 0.5 * self.scale * (self.level - np.log(q0)) * q**2
        return np.where(q > q0, above - 0.25 * self.scale * q0**2, below) * self.length


@dataclass
class Power:
    """Deflection a (F/F0)^p: stiffening for p < 1, softening for p > 1; linear below a thousandth of F0."""

    exponent: float
    amplitude: float = 0.01
    force0: float = 1e3

    def secant(self, force: Array) -> Array:
        ratio = np.maximum(np.abs(force) / self.force0, 1e-3)
        return self.amplitude / self.force0 * ratio ** (self.exponent - 1.0)

    def deflection(self, force: Array) -> Array:
        return self.secant(force) * force

    def tangent(self, force: Array) -> Array:
        return self.secant(force) * np.where(np.abs(force) > 1e-3 * self.force0, self.exponent, 1.0)


@dataclass
class Yielding:
    """Stiff, then suddenly soft about a load, then stiff again: amplitude times an arc tangent. Newton's nightmare."""

    amplitude: float
    width: float
    centre: float = 800.0

    def deflection(self, force: Array) -> Array:
        turned = np.arctan((force - self.centre) / self.width) + np.arctan(self.centre / self.width)
        return np.asarray(self.amplitude * turned)

    def tangent(self, force: Array) -> Array:
        return self.amplitude / self.width / (1.0 + ((force - self.centre) / self.width) ** 2)

    def secant(self, force: Array) -> Array:
        small = force < 1e-9 * self.width
        ratio = self.deflection(force) / np.where(small, 1.0, force)
        return np.asarray(np.where(small, self.tangent(np.zeros_like(force)), ratio))


def bending_problems(count: int, seed: int = 0) -> list[ContactProblem]:
    """Realistic problems of which only the coupled, rank-deficient part of the compliance is kept."""
    kept = []
    for problem in problems("realistic", count, seed):
        assert isinstance(problem.compliance, tuple)
        dense = problem.compliance[1] @ problem.compliance[1].T
        kept.append(ContactProblem(problem.separation, problem.lever_arm, problem.torque, dense))
    return kept


def nonlinear_residual(problem: ContactProblem, local: LineContact, solution: ContactSolution) -> float:
    """Natural residual of the nonlinear conditions, in 80-bit numbers apart from the local deflection."""
    wide, force = np.longdouble, solution.force
    deflection = problem.dense_compliance.astype(wide) @ force.astype(wide) + local.deflection(force)
    gap = deflection + problem.separation_at_first_contact - wide(solution.elastic_rotation) * problem.lever_arm
    natural = np.minimum(force / force.max(), gap / np.abs(deflection).max())
    balance = abs(float(force @ problem.lever_arm) / problem.torque - 1.0)
    return float(max(np.abs(natural).max(), balance))


def solve_on(
    problem: ContactProblem, local: LineContact, solver: str = "auto", **options: Any
) -> tuple[ContactSolution, ContactProblem]:
    """Solve with the compliance of the problem as that of bending."""
    data = (problem.separation, problem.lever_arm, problem.torque, problem.compliance)
    return solve_on_bending(ContactProblem(*data), local, solver, **options)


@pytest.mark.parametrize("torque", [1e-3, 1e2, 1e4, 4e5, 2e6])
def test_nonlinear_conditions_hold_to_rounding(torque: float) -> None:
    for problem in bending_problems(5):
        loaded = problem.with_torque(torque)
        local = Logarithmic(np.full(loaded.size, 1.2))
        solution, linear = solve_on(loaded, local)
        assert solution.status is Status.CERTIFIED
        assert nonlinear_residual(loaded, local, solution) < 1e-10
        assert solution.iterations <= 7
        assert np.array_equal(linear.separation, loaded.separation)


def test_equivalent_linear_problem_has_the_same_solution() -> None:
    for problem in bending_problems(5):
        local = Logarithmic(np.full(problem.size, 1.2))
        solution, linear = solve_on(problem, local)
        again = solve(linear)
        assert np.array_equal(linear.dense_compliance, problem.dense_compliance + np.diag(local.secant(solution.force)))
        assert again.rotation == pytest.approx(solution.rotation, rel=1e-13)
        assert np.abs(again.force - solution.force).max() < 1e-11 * solution.force.max()


def test_energy_falls_at_every_step_and_is_least_at_the_end() -> None:
    rng = np.random.default_rng(3)
    for problem in bending_problems(5):
        local = Logarithmic(np.full(problem.size, 1.2))
        solution, _ = solve_on(problem, local)

        def energy(force: Array, problem: ContactProblem = problem, local: Logarithmic = local) -> float:
            return float(force @ (0.5 * problem.deflection(force) + problem.separation) + local.energy(force).sum())

        visited = [energy(force) for force in local.visited]
        least = energy(solution.force)
        assert all(
            later <= earlier * (1.0 + 1e-14) for earlier, later in zip(visited, [*visited[1:], least], strict=True)
        )
        for _ in range(20):  # any other load of the same torque costs more
            other = np.maximum(solution.force + 0.1 * solution.force.max() * rng.standard_normal(problem.size), 0.0)
            other *= problem.torque / float(other @ problem.lever_arm)
            assert energy(other) > least


def test_plain_repetition_with_the_secant_arrives_at_the_same_point() -> None:
    """The slow way of old programs: update the secant compliance, solve again, until nothing changes."""
    problem = bending_problems(1)[0]
    local = Logarithmic(np.full(problem.size, 1.2))
    force = np.full(problem.size, problem.torque / float(problem.lever_arm.sum()))
    for _ in range(60):
        force = solve(problem.with_added_compliance(local.secant(force))).force
    solution, _ = solve_on(problem, local)
    assert np.abs(force - solution.force).max() < 1e-11 * force.max()


def test_constant_local_compliance_is_the_linear_problem() -> None:
    class Constant:
        def secant(self, force: Array) -> Array:
            return np.full(force.shape, 2e-6)

        tangent = secant

        def deflection(self, force: Array) -> Array:
            return 2e-6 * force

    problem = bending_problems(1)[0]
    solution, _ = solve_on(problem, Constant())
    reference = solve(problem.with_added_compliance(np.full(problem.size, 2e-6)))
    assert solution.rotation == pytest.approx(reference.rotation, rel=1e-14)
    assert solution.iterations <= 2


@pytest.mark.parametrize("exponent", [0.3, 0.5, 0.9, 1.5, 3.0])
def test_strong_nonlinearity_is_tamed_by_the_line_search(exponent: float) -> None:
    """Far stronger than any line contact, with a jump of the tangent at small load."""
    for problem in bending_problems(4):
        local = Power(exponent)
        solution, _ = solve_on(problem, local)
        assert solution.status is Status.CERTIFIED
        assert nonlinear_residual(problem, local, solution) < 1e-9


@pytest.mark.parametrize(("amplitude", "width"), [(0.1, 100.0), (0.3, 30.0)])
def test_full_steps_would_cycle_where_the_line_search_arrives(
    monkeypatch: pytest.MonkeyPatch, amplitude: float, width: float
) -> None:
    hard = bending_problems(6)
    local = Yielding(amplitude, width)
    for problem in hard:
        solution, _ = solve_on(problem, local)
        assert solution.status is Status.CERTIFIED
        assert solution.iterations <= 20
        assert nonlinear_residual(problem, local, solution) < 1e-10
    monkeypatch.setattr(NewtonIteration, "_step_length", lambda *_: 1.0)
    assert any(solve_on(problem, local)[0].status is Status.NOT_CONVERGED for problem in hard)


@pytest.mark.parametrize("polish", [True, False])
@pytest.mark.parametrize("name", SOLVERS)
def test_every_solver_gives_the_nonlinear_answer(name: str, polish: bool) -> None:
    installed(name)
    problem = bending_problems(1)[0]
    local = Logarithmic(np.full(problem.size, 1.2))
    reference, _ = solve_on(problem, local)
    solution, _ = solve_on(problem, local, name, polish=polish, tolerance=SOLVERS[name].tolerance)
    assert solution.status is Status.CERTIFIED
    assert solution.solver == name
    assert solution.polished is (polish and name != "native")
    exact = polish or name == "native"
    assert solution.certificate.passes(EXACT_TOLERANCE if exact else SOLVERS[name].tolerance)
    assert solution.rotation == pytest.approx(reference.rotation, rel=1e-13 if exact else 1e-6)


def test_warm_start_saves_iterations_and_changes_nothing() -> None:
    for problem in bending_problems(5):
        local = Logarithmic(np.full(problem.size, 1.2))
        cold, _ = solve_on(problem, local)
        warm, _ = solve_on(problem, local, initial_force=0.98 * cold.force)
        assert warm.iterations < cold.iterations
        assert warm.rotation == pytest.approx(cold.rotation, rel=1e-13)


def test_forces_of_a_failed_neighbour_are_no_warm_start() -> None:
    problem = bending_problems(1)[0]
    local = Logarithmic(np.full(problem.size, 1.2))
    solution, _ = solve_on(problem, local, initial_force=np.full(problem.size, np.nan))
    assert solution.rotation == solve_on(problem, local)[0].rotation
    with pytest.raises(InputError, match="initial_force"):
        solve_on(problem, local, initial_force=np.zeros(2))


def test_bending_compliance_may_be_a_pair() -> None:
    for problem in problems("realistic", 2):
        assert isinstance(problem.compliance, tuple)
        local = Logarithmic(np.full(problem.size, 1.2))
        diagonal, factor = problem.compliance
        pair, linear = solve_on(problem, local)
        dense = ContactProblem(
            problem.separation, problem.lever_arm, problem.torque, np.diag(diagonal) + factor @ factor.T
        )
        assert linear.is_structured
        assert pair.rotation == pytest.approx(solve_on(dense, local)[0].rotation, rel=1e-13)


def test_rotation_never_falls_as_the_torque_rises() -> None:
    problem = bending_problems(1)[0]
    local = Logarithmic(np.full(problem.size, 1.2))
    rotations = [solve_on(problem.with_torque(float(t)), local)[0].rotation for t in np.geomspace(1.0, 2e6, 30)]
    assert (np.diff(rotations) > 0.0).all()


def test_without_torque_the_teeth_just_touch() -> None:
    problem = bending_problems(1)[0].with_torque(0.0)
    solution, _ = solve_on(problem, Logarithmic(np.full(problem.size, 1.2)))
    assert solution.status is Status.CERTIFIED
    assert not solution.force.any()
    assert solution.rotation == problem.first_contact_rotation


def test_interference_loads_segments_even_without_torque() -> None:
    """Two segments pressed apart against each other: equal moments whose deflections add up to the interference."""
    problem = ContactProblem(np.array([0.0, -0.1]), np.array([40.0, -40.0]), 0.0, np.diag([1e-6, 1e-6]))
    local = Logarithmic(np.full(2, 1.2))
    solution, _ = solve_on(problem, local)
    assert solution.status is Status.CERTIFIED
    assert solution.force[0] == pytest.approx(solution.force[1], rel=1e-12)
    deflection = problem.deflection(solution.force) + local.deflection(solution.force)
    assert deflection.sum() == pytest.approx(0.1, rel=1e-12)


@pytest.mark.parametrize("bad", [np.nan, -1e-3])
def test_useless_local_compliance_is_a_status(bad: float) -> None:
    class Useless:
        def __init__(self, start: float) -> None:
            self.start = start

        def secant(self, force: Array) -> Array:
            return np.full(force.shape, self.start)

        def tangent(self, force: Array) -> Array:
            return np.full(force.shape, bad)

        def deflection(self, force: Array) -> Array:
            return 2e-6 * force

    problem = bending_problems(1)[0]
    for start in (bad, 1e-6):
        solution, _ = solve_on(problem, Useless(start))
        assert solution.status is Status.INVALID_DATA
        assert np.isnan(solution.force).all()
        assert solution.message


def test_inconsistent_line_contact_does_not_converge_in_silence() -> None:
    """A secant that is not deflection over force would make the linear problem a different one."""

    class Inconsistent(Logarithmic):
        def secant(self, force: Array) -> Array:
            return 2.0 * super().secant(force)

        def deflection(self, force: Array) -> Array:
            return super().secant(force) * force

    problem = bending_problems(1)[0]
    solution, _ = solve_on(problem, Inconsistent(np.full(problem.size, 1.2)))
    assert solution.status is Status.NOT_CONVERGED
    assert np.isnan(solution.force).all()
    assert solution.certificate.worst > 1e-3


def test_failing_backend_passes_its_status_on() -> None:
    problem = bending_problems(1)[0]
    local = Logarithmic(np.full(problem.size, 1.2))
    solution, _ = solve_on(problem, local, "clarabel", polish=False, max_iter=1)
    assert solution.status is Status.NOT_CONVERGED
    assert np.isnan(solution.force).all()


def test_users_mistakes_are_errors() -> None:
    problem = bending_problems(1)[0]
    local = Logarithmic(np.full(problem.size, 1.2))
    with pytest.raises(InputError, match="must be one of auto, native"):
        solve_on(problem, local, "simplex")
    with pytest.raises(InputError, match="lever_arm"):
        solve_on_bending(ContactProblem(problem.separation, problem.lever_arm[1:], 1.0, problem.compliance), local)
    assert issubclass(MissingSolverError, ImportError)
