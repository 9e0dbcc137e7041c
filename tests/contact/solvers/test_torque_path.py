"""The path over the torque: re-solved at many torques, through every event, ties and all; and what ends it."""

from __future__ import annotations

import numpy as np
import pytest
from numpy.typing import NDArray
from solver_choice import NEARLY_SINGULAR, dense

from easeoff import InputError
from easeoff.contact import ContactProblem, ContactSolution, Status, TorquePath, solve, torque_path
from easeoff.contact.solvers import touching_system
from easeoff.contact.solvers.parametric import torque_path as following, touching_form
from easeoff.contact.solvers.solution import no_solution
from easeoff.study.library import entries, generate
from easeoff.verification import problems
from easeoff.verification.problem_classes import PROBLEM_CLASSES


def torques_of(path: TorquePath, seed: int = 0, few: int = 5) -> NDArray[np.float64]:
    """Every breakpoint, and some torques between."""
    low, high = path.covered
    return np.concatenate([path.breakpoints, np.random.default_rng(seed).uniform(low, high, few)])


def differences(path: TorquePath, torques: NDArray[np.float64]) -> tuple[float, float]:
    """Largest relative differences of rotation and forces from solutions of each torque for itself."""
    rotation = force = 0.0
    for torque in torques[torques > 0.0]:
        own, other = path.at(float(torque)), solve(path.problem.with_torque(float(torque)))
        assert own.certified
        assert other.certified
        scale = abs(other.elastic_rotation) or 1.0
        rotation = max(rotation, abs(own.elastic_rotation - other.elastic_rotation) / scale)
        force = max(force, float(np.abs(own.force - other.force).max() / other.force.max()))
    return rotation, force


@pytest.mark.parametrize("form", ["modal", "dense"])
@pytest.mark.parametrize("name", PROBLEM_CLASSES)
def test_path_is_that_of_solving_every_torque(name: str, form: str, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(touching_form, "DENSE_FIRST_SIZE", 0)
    events = 0
    for number, given in enumerate(problems(name, 2, seed=5)):
        problem = dense(given) if form == "dense" else given
        path = torque_path(problem, 0.0, 2.0 * problem.torque)
        assert path.certified, path.message
        events += path.torque.size
        rotation, force = differences(path, torques_of(path, number))
        limit = 1e-9 if name in NEARLY_SINGULAR else 1e-12
        assert rotation <= limit
        assert force <= limit
    assert events >= 2  # one of each problem


@pytest.mark.thorough
@pytest.mark.parametrize("form", ["as given", "dense"])
def test_path_on_problems_of_the_library(form: str) -> None:
    chosen = [entry for entry in entries() if entry.part == "small" and entry.source.case == "nasa-12x36"]
    assert len(chosen) > 20
    for entry, problem in generate(chosen):
        path = torque_path(dense(problem) if form == "dense" else problem, 0.0, 3.0 * problem.torque)
        assert path.certified, (entry.name, path.message)
        rotation, force = differences(path, torques_of(path)[::3])
        assert rotation <= 1e-12, entry.name
        assert force <= 1e-9 or "copied" in entry.name, entry.name


def test_winkler_bed_in_closed_form() -> None:
    """Each spring takes part from the rotation S/r on, at the torque that the others carry there."""
    rng = np.random.default_rng(3)
    gap, arm, stiffness = rng.uniform(0.0, 0.02, 25), rng.uniform(40.0, 60.0, 25), rng.uniform(1e5, 1e6, 25)
    turned = np.sort(gap / arm)
    expected = [(stiffness * arm * np.maximum(one * arm - gap, 0.0)).sum() for one in turned]
    bed = ContactProblem(gap, arm, 0.0, np.diag(1.0 / stiffness))
    path = torque_path(bed, 0.0, 2.0 * expected[-1])
    np.testing.assert_allclose(path.torque, expected, rtol=1e-12, atol=1e-9 * expected[-1])
    assert path.segment.tolist() == np.argsort(gap / arm).tolist()
    assert path.enters.all()


def test_event_is_where_the_set_changes() -> None:
    *_, problem = problems("signed_modes", 9)
    path = torque_path(problem, 0.0, 3.0 * problem.torque)
    assert (~path.enters).sum() == 4, "some leave"
    for torque, segment, enters in zip(path.torque[1:], path.segment[1:], path.enters[1:], strict=True):
        below, above = (solve(problem.with_torque(float(torque) * (1.0 + part))) for part in (-1e-9, 1e-9))
        assert bool(below.active[segment]) is not bool(enters)
        assert bool(above.active[segment]) is bool(enters)
        here = path.at(float(torque))
        assert here.force[segment] <= 1e-12 * here.force.max()
        assert abs(here.gap[segment]) <= 1e-12


def test_downward_path_is_the_upward_one_backwards() -> None:
    *_, problem = problems("signed_modes", 9)
    low, high = 0.2 * problem.torque, 2.0 * problem.torque
    up, down = torque_path(problem, low, high), torque_path(problem, high, low)
    np.testing.assert_array_equal(down.torque, up.torque[::-1])
    np.testing.assert_array_equal(down.segment, up.segment[::-1])
    np.testing.assert_array_equal(down.enters, ~up.enters[::-1])
    np.testing.assert_array_equal(down.breakpoints, up.breakpoints[::-1])
    assert down.covered == (low, high)
    whole = torque_path(problem, 0.0, high)
    np.testing.assert_allclose(up.torque, whole.torque[whole.torque > low], rtol=1e-12)


def test_segments_that_touch_together_enter_together() -> None:
    """A symmetric crown: two by two; and a flat bed: all at once, without a torque."""
    x = np.linspace(-1.0, 1.0, 9)
    coupling = 1e-7 * np.exp(-(np.subtract.outer(x, x) ** 2)) + np.diag(np.full(9, 1e-6))
    crown = torque_path(ContactProblem(0.01 * x**2, np.full(9, 50.0), 0.0, coupling), 0.0, 4e6)
    np.testing.assert_allclose(crown.torque[1::2], crown.torque[2::2], rtol=1e-12)
    assert [set(pair) for pair in crown.segment[1:].reshape(-1, 2)] == [{3, 5}, {2, 6}, {1, 7}, {0, 8}]
    flat = torque_path(ContactProblem(np.zeros(9), np.full(9, 50.0), 0.0, coupling), 0.0, 1e6)
    assert flat.torque.tolist() == [0.0] * 9


def test_forces_that_are_not_unique_leave_the_rotation_exact() -> None:
    """Two copies of every segment, and rigid segments: the path carries one choice of the forces."""
    single = dense(next(problems("plain", 1, seed=2)))
    twice = np.tile(np.arange(single.size), 2)
    gap, arm = single.separation[twice], single.lever_arm[twice]
    copied = ContactProblem(gap, arm, single.torque, single.dense_compliance[np.ix_(twice, twice)])
    path, reference = (torque_path(one, 0.0, 2.0 * single.torque) for one in (copied, single))
    assert path.certified
    for torque in torques_of(reference):
        rotation = reference.at(float(torque)).elastic_rotation
        assert path.at(float(torque)).elastic_rotation == pytest.approx(rotation, rel=1e-12)
    rigid = torque_path(ContactProblem([0.0, 0.0, 1e-3], [40.0, 40.0, 40.0], 0.0, np.zeros((3, 3))), 0.0, 1e6)
    assert rigid.certified
    assert rigid.at(5e5).rotation == 0.0
    assert rigid.at(5e5).force @ np.full(3, 40.0) == pytest.approx(5e5)


def test_torque_and_separation_in_proportion() -> None:
    problem = next(problems("realistic", 1, seed=1))
    larger = ContactProblem(3.0 * problem.separation, problem.lever_arm, 0.0, problem.compliance)
    path, scaled = torque_path(problem, 0.0, 5e5), torque_path(larger, 0.0, 1.5e6)
    np.testing.assert_allclose(scaled.torque, 3.0 * path.torque, rtol=1e-12)
    np.testing.assert_allclose(scaled.at(9e5).force, 3.0 * path.at(3e5).force, rtol=1e-10, atol=1e-9)


def test_dataset_holds_the_whole_path() -> None:
    problem = next(problems("realistic", 1, seed=1))
    path = torque_path(problem, 1e5, 5e5)
    data = path.to_dataset()
    assert {variable.attrs["units"] for variable in data.data_vars.values()} == {"N mm", "1", "rad", "N", "mm"}
    assert all("long_name" in variable.attrs for variable in data.data_vars.values())
    assert data["path_torque"].values[[0, -1]].tolist() == [1e5, 5e5]
    assert float(data["worst_residual"].max()) < 1e-12
    for torque in (1.3e5, 2.7e5, 4.9e5):
        forces = [np.interp(torque, data["path_torque"], row) for row in data["path_force"].values.T]
        np.testing.assert_allclose(forces, path.at(torque).force, rtol=1e-11, atol=1e-9)
        rotation = np.interp(torque, data["path_torque"], data["path_rotation"])
        assert rotation == pytest.approx(path.at(torque).rotation, rel=1e-12)


@pytest.mark.parametrize("form", ["modal", "dense"])
def test_events_are_passed_by_updates(form: str, monkeypatch: pytest.MonkeyPatch) -> None:
    """The matrices are made from the beginning once in many events."""
    monkeypatch.setattr(touching_form, "DENSE_FIRST_SIZE", 0)
    made = []
    for owner, name in ((touching_system.DenseTouching, "_make"), (touching_form.ModalTouching, "_sum")):
        plain = getattr(owner, name)

        def counting(*arguments: object, plain: object = plain) -> object:
            made.append(1)
            return plain(*arguments)  # type: ignore[operator]

        monkeypatch.setattr(owner, name, counting)
    problem = next(problems("realistic", 1, seed=1))
    path = torque_path(dense(problem) if form == "dense" else problem, 1e3, 2e6)
    assert path.torque.size == 20
    assert len(made) <= 2


def test_path_that_cannot_be_followed_ends_with_a_reason(monkeypatch: pytest.MonkeyPatch) -> None:
    """What was followed is right, and nothing is said of the rest."""
    problem = next(problems("realistic", 1, seed=1))
    whole = torque_path(problem, 0.0, 5e5)
    monkeypatch.setattr(following, "MAX_EVENTS_PER_SEGMENT", 10.0 / problem.size)
    path = torque_path(problem, 0.0, 5e5)
    assert path.status is Status.NOT_CONVERGED
    assert "events" in path.message
    np.testing.assert_array_equal(path.torque, whole.torque[: path.torque.size])
    assert path.covered[1] < 5e5
    assert differences(path, torques_of(path))[0] <= 1e-12
    with pytest.raises(InputError, match="the known path; more than"):
        path.at(5e5)


@pytest.mark.parametrize("step", [1e-10, 0.3])
def test_set_is_sought_beyond_an_event_that_leaves_it_open(step: float, monkeypatch: pytest.MonkeyPatch) -> None:
    """Near enough that gives the same path; a set from too far beyond does not reach back, and is not taken."""
    problem = next(problems("realistic", 1, seed=1))
    whole = torque_path(problem, 1e5, 5e5)

    def sought(problem: ContactProblem, point: following._Point, _: object, step: float) -> object:
        return following._sought(problem, point.torque + step, point.torque + step)

    monkeypatch.setattr(following, "_beyond", sought)
    monkeypatch.setattr(following, "STEPS_BEYOND", (step,))
    path = torque_path(problem, 1e5, 5e5)
    assert path.certified == (step < 1e-6)
    assert path.certified or "cannot be told" in path.message
    np.testing.assert_allclose(path.torque, whole.torque[: path.torque.size], rtol=1e-12)
    assert differences(path, torques_of(path))[0] <= 1e-12


def test_path_begins_without_a_torque_where_the_start_has_no_solution(monkeypatch: pytest.MonkeyPatch) -> None:
    problem = next(problems("realistic", 1, seed=1))
    wanted = torque_path(problem, 1e5, 5e5)

    def failing(given: ContactProblem) -> ContactSolution:
        return no_solution(given.size, Status.SOLVER_FAILED, "native") if given.torque == 1e5 else solve(given)

    monkeypatch.setattr(following, "solve", failing)
    path = torque_path(problem, 1e5, 5e5)
    assert path.certified
    assert path.covered == (1e5, 5e5)
    np.testing.assert_array_equal(path.segment, wanted.segment)
    np.testing.assert_allclose(path.torque, wanted.torque, rtol=1e-12)
    assert differences(path, torques_of(path))[0] <= 1e-12


def test_mistakes_are_named() -> None:
    springs = ContactProblem([0.0, 1e-3], [40.0, 40.0], 0.0, np.diag([1e-6, 1e-6]))
    with pytest.raises(InputError, match="start"):
        torque_path(springs, -1.0, 1e5)
    with pytest.raises(InputError, match="end"):
        torque_path(springs, 0.0, np.inf)
    with pytest.raises(InputError, match=r"torque = 200000: must be from 0 to 100000 N mm"):
        torque_path(springs, 0.0, 1e5).at(2e5)
    indefinite = ContactProblem([0.0, 0.0], [40.0, 40.0], 0.0, np.array([[1e-6, 2e-6], [2e-6, 1e-6]]))
    with pytest.raises(InputError, match="positive semidefinite"):
        torque_path(indefinite, 0.0, 1e5)
