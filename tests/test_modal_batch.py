"""Many problems at once: the same answers as one by one, each proved, and local laws that bend."""

from __future__ import annotations

from dataclasses import dataclass, replace
from itertools import pairwise
from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray

import easeoff.contact.loaded as loaded_module
from easeoff.cases import read_case
from easeoff.contact import ContactProblem, solve, solve_many
from easeoff.contact.compliance import Material, WeberLineContact
from easeoff.contact.line_contact.line_contact_law import LineContactLaw
from easeoff.contact.solvers import problem_batch as many
from easeoff.contact.solvers.modal_batch import LinearLaw, ModalBatch, newton_batch
from easeoff.core.errors import InputError
from easeoff.study.analysis import contact_analysis
from easeoff.study.case_in_mesh import CaseInMesh
from easeoff.verification.problem_classes import PROBLEM_CLASSES, problems

Array = NDArray[np.float64]


@pytest.fixture(autouse=True)
def without_numba(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(many, "compiled_kernel", lambda: None)


def structured(count: int, seed: int = 0) -> list[ContactProblem]:
    return [*problems("plain", count, seed), *problems("signed_modes", count, seed)]


@pytest.mark.parametrize("name", PROBLEM_CLASSES)
def test_every_kind_of_problem_has_the_answer_of_solve(name: str) -> None:
    given = list(problems(name, 40, 7))
    for problem, found in zip(given, solve_many(given), strict=True):
        alone = solve(problem)
        assert found.status is alone.status
        if found.certified:
            assert found.certificate.worst <= 1e-9
            assert found.rotation == pytest.approx(alone.rotation, rel=1e-9)


def test_the_common_kinds_need_no_other_method(monkeypatch: pytest.MonkeyPatch) -> None:
    def refuse(*_: Any, **__: Any) -> None:
        raise AssertionError("solved one by one")

    monkeypatch.setattr(many, "solve", refuse)
    for name in ("plain", "touching", "duplicated", "light_load", "heavy_load", "far_apart", "interfering"):
        assert all(found.certified for found in solve_many(list(problems(name, 60, 3))))


def test_answers_come_in_order_whatever_the_form() -> None:
    given = structured(3)
    dense = [ContactProblem(p.separation, p.lever_arm, p.torque, p.dense_compliance) for p in given]
    idle = given[0].with_torque(0.0)
    mixed = [dense[2], given[0], idle, given[1], dense[1]]
    for problem, found in zip(mixed, solve_many(mixed), strict=True):
        assert found.rotation == pytest.approx(solve(problem).rotation, rel=1e-12, abs=1e-15)
    assert solve_many([]) == []


def test_company_changes_nothing() -> None:
    """A problem is not touched by those that stand beside it, larger, smaller or without an answer yet."""
    given = structured(20)
    together = solve_many(given)
    for problem, found in zip(given, together, strict=True):
        alone = solve_many([problem])[0]
        assert np.abs(found.force - alone.force).max() <= 1e-13 * alone.force.max()


def test_any_start_leads_to_the_same_answer() -> None:
    given = structured(10)
    right = solve_many(given)
    rng = np.random.default_rng(0)
    wrong = solve_many(given, initial_active=[rng.random(p.size) < 0.3 for p in given])
    none = solve_many(given, initial_active=[np.zeros(p.size, dtype=bool) for p in given])
    for a, b, c in zip(right, wrong, none, strict=True):
        assert np.abs(a.force - b.force).max() <= 1e-12 * a.force.max()
        assert np.abs(a.force - c.force).max() <= 1e-12 * a.force.max()


def test_warm_starts_are_checked() -> None:
    given = structured(1)
    with pytest.raises(InputError, match="1 entries for 2 problems"):
        solve_many(given, initial_active=[None])
    with pytest.raises(InputError, match="shape"):
        solve_many(given, initial_active=[None, np.zeros(10_000, dtype=bool)])


# Local laws


@dataclass
class PowerLaw:
    """F = k indentation ** exponent: beside bending it makes every kind of trouble for full steps."""

    factor: float
    exponent: float

    def response(self, indentation: Array, chosen: NDArray[np.intp]) -> tuple[Array, Array]:
        with np.errstate(divide="ignore", invalid="ignore"):
            force = self.factor * indentation**self.exponent
            stiffness = np.where(indentation > 0.0, self.exponent * force / indentation, 0.0)
        return force, stiffness


def batch_of(given: list[ContactProblem]) -> ModalBatch:
    return ModalBatch.of(
        [p.modal_basis for p in given],  # type: ignore[misc]
        [p.lever_arm for p in given],
        [p.separation_at_first_contact for p in given],
        np.array([p.torque for p in given]),
    )


def even_start(batch: ModalBatch) -> tuple[Array, Array]:
    arm = np.maximum(batch.rows[..., -1], 0.0)
    force = arm * (batch.torque / np.sum(arm**2, axis=(1, 2)))[:, None, None]
    return batch.start(force, force)


@pytest.mark.parametrize("exponent", [1.0, 1.5, 3.0])
def test_conditions_hold_for_any_convex_law(exponent: float) -> None:
    given = list(problems("realistic", 12, 5))
    batch = batch_of(given)
    law = PowerLaw(3e5 if exponent == 1.0 else 3e5 * 1e3 ** (exponent - 1.0), exponent)
    answer = newton_batch(batch, law, *even_start(batch))
    assert answer.ended.all()
    for problem, force, rotation in zip(given, batch.by_segments(answer.force), answer.rotation, strict=True):
        assert isinstance(problem.compliance, tuple)
        modes = problem.compliance[1]
        gap = modes @ (modes.T @ force) + problem.separation_at_first_contact - rotation * problem.lever_arm
        assert force @ problem.lever_arm == pytest.approx(problem.torque, rel=1e-12)
        expected = law.response(np.maximum(-gap, 0.0), np.arange(1))[0]
        assert np.abs(force - expected).max() <= 1e-9 * force.max()


def test_linear_law_is_the_linear_problem() -> None:
    given = list(problems("realistic", 12, 5))
    batch = batch_of(given)
    stiffness = batch.in_blocks([1.0 / p.compliance[0] for p in given], 0.0)
    answer = newton_batch(batch, LinearLaw(stiffness), *even_start(batch))
    for problem, force in zip(given, batch.by_segments(answer.force), strict=True):
        exact = solve(problem, method="primal_dual_active_set").force
        assert np.abs(force - exact).max() <= 1e-12 * exact.max()


def test_smooth_law_converges_quadratically(monkeypatch: pytest.MonkeyPatch) -> None:
    """The residual falls by the square from step to step once it is small."""
    import easeoff.contact.solvers.modal_batch as module

    batch = batch_of(list(problems("realistic", 6, 2)))
    seen: list[Array] = []
    honest = module._residual

    def noted(*arguments: Any) -> Array:
        seen.append(honest(*arguments))
        return seen[-1]

    monkeypatch.setattr(module, "_residual", noted)
    answer = newton_batch(batch, PowerLaw(3e5 * 10.0, 1.2), *even_start(batch))
    assert answer.ended.all()
    assert answer.iterations.max() <= 20
    for before, after in pairwise(seen):
        if after.size == before.size:
            small = before < 1e-5
            assert (after[small] <= np.maximum(1e6 * before[small] ** 2, 1e-12)).all()


def test_line_contact_is_inverted_over_all_decades() -> None:
    steel = Material(206000.0, 0.3)
    count = 200
    contact = WeberLineContact(
        np.full(count, 1.3), np.full(count, 40.0), np.full(count, 2.0), np.full(count, 3.0), steel, steel
    )
    force = np.geomspace(1e-9, 1e6, count)
    place = np.append(np.arange(count), count)[None, None, :]
    law = LineContactLaw(contact, place, np.full(count, 100.0))
    indentation = np.append(contact.deflection(force), 0.0)[None, None, :]
    found, stiffness = law.response(indentation, np.arange(1))
    assert np.abs(found[0, 0, :-1] / force - 1.0).max() < 1e-13
    assert np.abs(stiffness[0, 0, :-1] * contact.tangent(force) - 1.0).max() < 1e-7
    assert found[0, 0, -1] == stiffness[0, 0, -1] == 0.0


@pytest.mark.parametrize("name", ["fm-11x41", "fh-12x41-45"])
def test_loaded_analysis_agrees_with_exact_programmes_one_by_one(name: str, monkeypatch: pytest.MonkeyPatch) -> None:
    """Two methods: modes with the law inverted, and a sequence of quadratic programmes on the dense matrix."""
    case = read_case(name)
    case = replace_positions(case, 5)
    together = contact_analysis(CaseInMesh.of(case)).cases
    monkeypatch.setattr(loaded_module, "solve_line_contacts", lambda given, *_: [None] * len(given))
    for found, exact in zip(together, contact_analysis(CaseInMesh.of(case)).cases, strict=True):
        assert found.solution.message.startswith("modal")
        assert exact.solution.message.endswith("linear problems")
        assert (found.torque, found.mesh_position) == (exact.torque, exact.mesh_position)
        assert np.abs(found.solution.force - exact.solution.force).max() <= 1e-12 * exact.solution.force.max()
        assert found.solution.rotation == pytest.approx(exact.solution.rotation, rel=1e-13)


def replace_positions(case: Any, count: int) -> Any:
    return case.model_copy(update={"contact": case.contact.model_copy(update={"mesh_positions": count})})


def test_basis_knows_its_factor() -> None:
    for problem in structured(5):
        basis = problem.modal_basis
        assert basis is not None
        again = ContactProblem.of_modes(
            problem.separation, problem.lever_arm, problem.torque, problem.compliance[0], basis
        )
        largest = np.abs(problem.dense_compliance).max()
        assert np.abs(again.dense_compliance - problem.dense_compliance).max() <= 1e-14 * largest
        assert again.modal_basis is basis
        assert replace(basis).factor.shape == (problem.size, np.count_nonzero(basis.modes.any(axis=1)))
