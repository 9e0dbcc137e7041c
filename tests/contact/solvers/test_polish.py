"""Polish: exact on the right active set, without the matrix where there is structure, and honest on a wrong one."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from solver_choice import installed

from easeoff.contact import ContactProblem, solve
from easeoff.contact.problem.compliance_matrix import ModalCompliance
from easeoff.contact.problem.scaled_problem import ScaledProblem
from easeoff.contact.solvers import touching_system as modal_system
from easeoff.contact.solvers.polish import MAX_EXCHANGES, STRICT_POLISH, PolishRule, polished_answer
from easeoff.contact.solvers.solution import ScaledAnswer
from easeoff.contact.solvers.touching_system import ModalProblem, solve_active_set, solve_modal_active_set
from easeoff.verification import problems
from easeoff.verification.problem_classes import PROBLEM_CLASSES

FREE = PolishRule()
ONE_SOLVE = PolishRule(exchanges=0)


@pytest.fixture(params=["block", "modes"])
def system(request: pytest.FixtureRequest, monkeypatch: pytest.MonkeyPatch) -> str:
    """Both systems of a set, whatever its size: the block of the active segments, and that of the modes."""
    if request.param == "modes":
        monkeypatch.setattr(modal_system, "SMALL_BLOCK", 0)
        monkeypatch.setattr(modal_system, "SMALL_PROBLEM", 0)
    return str(request.param)


def never(_: Any) -> Any:
    raise AssertionError("the matrix was formed")


def structured(size: int = 240, modes: int = 12, *, rigid: int = 0, seed: int = 0) -> ContactProblem:
    """A line contact with smooth modes: parabolic separation, a part in contact, some without local compliance."""
    x = np.linspace(-1.0, 1.0, size)
    local = np.full(size, 2e-6)
    local[np.random.default_rng(seed).permutation(size)[:rigid]] = 0.0
    factor = 1e-3 * np.polynomial.legendre.legvander(x, modes - 1) / (1.0 + np.arange(modes))
    return ContactProblem(0.02 * (x - 0.2) ** 2, 40.0 + 3.0 * x, 1e5, (local, factor))


def rough(problem: ContactProblem, *, wrong: int = 0, noise: float = 1e-6) -> tuple[ScaledProblem, ScaledAnswer]:
    """The answer with noise in its forces, and with some touching segments of little force taken for open."""
    scaled, reference = problem.scaled(), solve(problem)
    force = reference.force / problem.scaling.force
    touching = np.flatnonzero(force > 0.0)
    force[touching] *= 1.0 + noise * np.random.default_rng(1).standard_normal(touching.size)
    force[touching[np.argsort(force[touching])][:wrong]] = 0.0
    return scaled, ScaledAnswer(force, reference.elastic_rotation / problem.scaling.rotation, -1)


@pytest.mark.parametrize("rigid", [0, 3, 8])
def test_system_of_the_modes_has_the_solution_of_the_matrix(rigid: int, system: str) -> None:
    problem = structured(rigid=rigid)
    scaled = problem.scaled()
    modal = ModalProblem.of(scaled)
    assert modal is not None
    index = np.flatnonzero(solve(problem).force > 0.0)
    point, wanted = solve_modal_active_set(modal, index), solve_active_set(scaled, index)
    assert point is not None
    assert wanted is not None
    wanted.refine()
    np.testing.assert_allclose(point.force, wanted.force, rtol=0.0, atol=1e-9 * wanted.force.max())
    assert point.rotation == pytest.approx(wanted.rotation, rel=1e-12)
    # The equations themselves, whoever solved them:
    force = np.zeros(problem.size)
    force[index] = point.force
    residual = scaled.compliance @ force + scaled.separation - point.rotation * scaled.lever_arm
    np.testing.assert_allclose(residual[index], 0.0, atol=1e-12 * abs(point.rotation))
    assert float(scaled.lever_arm @ force) == pytest.approx(scaled.torque, rel=1e-13)
    np.testing.assert_allclose(point.gap, residual, atol=1e-12 * abs(point.rotation))


def test_two_springs_and_a_mode_in_closed_form(system: str) -> None:
    """Two equal springs on a common mode share the load: theta = (d F + v^2 2 F) / r with F = T / (2 r)."""
    problem = ContactProblem(np.zeros(2), np.full(2, 40.0), 8.0e4, (np.full(2, 1e-6), np.full((2, 1), 1e-3)))
    given = ScaledAnswer(np.array([1.1, 0.9]) * 1e3 / problem.scaling.force, 7e-5 / problem.scaling.rotation, -1)
    found = polished_answer(problem, problem.scaled(), given, ONE_SOLVE)
    assert found.polished
    np.testing.assert_allclose(found.answer.force, 1e3, rtol=1e-14)
    assert found.answer.rotation == pytest.approx((1e-3 + 2e-3) / 40.0, rel=1e-14)


@pytest.mark.parametrize("rule", [FREE, ONE_SOLVE])
@pytest.mark.parametrize("rigid", [0, 5, 40, 90])
def test_structured_problem_is_polished_without_its_matrix(
    rigid: int, rule: PolishRule, system: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Also with more rigid segments than modes, where the forces are not unique and the block is singular."""
    problem = structured(90, rigid=rigid)
    scaled, given = rough(problem)
    monkeypatch.setattr(ModalCompliance, "dense", property(never))
    monkeypatch.setattr(ScaledProblem, "compliance", property(never))
    found = polished_answer(problem, scaled, given, rule)
    assert found.polished
    assert found.exchanges == 0
    assert found.answer.certificate.passes(1e-9)


@pytest.mark.parametrize("name", ["piqp", "clarabel", "osqp"])
def test_whole_call_of_a_sparse_backend_never_forms_the_matrix(name: str, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(ModalCompliance, "dense", property(never))
    solution = solve(structured(2000), installed(name))
    assert (solution.method, solution.polished) == ("lifted", True)
    assert solution.certificate.worst <= 1e-12


@pytest.mark.parametrize("kind", PROBLEM_CLASSES)
def test_polish_agrees_with_the_native_solver_on_every_class(kind: str, system: str) -> None:
    for problem in problems(kind, 5, seed=3):
        reference = solve(problem)
        if not reference.certified or problem.torque == 0.0:
            continue
        scaled, given = rough(problem, noise=0.0)
        found = polished_answer(problem, scaled, given, FREE)
        assert found.polished
        assert found.answer.elastic_rotation == pytest.approx(reference.elastic_rotation, rel=1e-8)


def test_wrong_set_stays_as_it_is_without_exchange_and_is_told_with_it() -> None:
    problem = structured()
    scaled, given = rough(problem, wrong=4)
    left = polished_answer(problem, scaled, given, ONE_SOLVE)
    assert not left.polished
    np.testing.assert_array_equal(left.answer.force, problem.scaling.unscale_force(given.force))
    right = polished_answer(problem, scaled, given, FREE)
    assert right.polished
    assert 0 < right.exchanges <= MAX_EXCHANGES
    assert right.answer.certificate.worst <= 1e-12


def test_answer_that_is_no_approximation_is_not_polished_in_a_comparison() -> None:
    """Equal forces where every segment touches: the set is right, the answer is not."""
    problem = ContactProblem(np.zeros(3), np.full(3, 40.0), 8.0e4, np.diag([1e-6, 2e-6, 3e-6]))
    scaled = problem.scaled()
    lie = ScaledAnswer(np.full(3, scaled.torque / scaled.lever_arm.sum()), 1.0, -1)
    assert polished_answer(problem, scaled, lie, ONE_SOLVE).polished
    assert not polished_answer(problem, scaled, lie, STRICT_POLISH).polished
    close = replace(lie, force=solve(problem).force / problem.scaling.force * (1.0 + 1e-6 * np.array([1.0, -1.0, 0.0])))
    close = replace(close, rotation=solve(problem).elastic_rotation / problem.scaling.rotation)
    assert polished_answer(problem, scaled, close, STRICT_POLISH).polished


def test_no_rule_and_numbers_that_are_none_leave_the_answer_alone() -> None:
    problem = structured()
    scaled, given = rough(problem)
    assert not polished_answer(problem, scaled, given, None).polished
    broken = replace(given, rotation=np.inf)
    assert not polished_answer(problem, scaled, broken, FREE).polished


def test_set_without_a_lever_arm_is_not_solved() -> None:
    problem = structured()
    scaled = problem.scaled()
    nothing = ScaledAnswer(np.zeros(problem.size), -1.0, -1)
    assert not polished_answer(problem, scaled, nothing, ONE_SOLVE).polished


def test_block_that_is_too_large_is_not_formed(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(modal_system, "SMALL_BLOCK", 0)
    monkeypatch.setattr(modal_system, "LARGEST_BLOCK", 10)
    monkeypatch.setattr(modal_system, "_block_factor", lambda *_: never(_))
    problem = structured(rigid=240)
    scaled, given = rough(problem)
    found = polished_answer(problem, scaled, given, ONE_SOLVE)
    assert np.isfinite(found.answer.force).all()
    assert found.answer.certificate.passes(1e-9 if found.polished else 1e-4)


def test_solution_tells_exchanges_and_times() -> None:
    problem = structured()
    exact = solve(problem, "osqp")
    assert exact.polished
    assert exact.exchanges == 0
    times = exact.times
    assert times.measured_by == "solver"
    assert 0.0 < times.solve <= times.call <= exact.run_time
    assert 0.0 < times.setup <= times.call
    assert 0.0 < times.polish <= exact.run_time
    own = solve(problem, "osqp", polish=False)
    assert np.isnan(own.times.polish)
    without_setup = solve(problem, "clarabel", polish=False).times
    assert without_setup.measured_by == "solver"
    assert np.isnan(without_setup.setup)
    assert solve(problem).times.call > 0.0
    rough_settings: dict[str, Any] = {"eps_abs": 0.05, "eps_rel": 0.05, "polishing": False}
    assert solve(problem, "osqp", **rough_settings).exchanges > 0
