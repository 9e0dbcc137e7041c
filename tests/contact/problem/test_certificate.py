"""The certificate on the problem as given: large rotations, its own rounding, uniqueness, errors, other statuses."""

from __future__ import annotations

import copy
import math
import pickle
from collections import Counter
from collections.abc import Callable
from dataclasses import fields, replace
from fractions import Fraction
from typing import Any

import numpy as np
import pytest
from contact_problems import claims
from contact_problems.drawn_problem import drawn_problem
from contact_problems.rational_solution import RationalProblem, solution
from numpy.typing import NDArray

from easeoff.contact import (
    SOLVERS,
    Certificate,
    ContactProblem,
    ContactSolution,
    ModalBasis,
    Solver,
    Status,
    available_solvers,
    certify,
    solve,
    solve_many,
)
from easeoff.contact.problem import contact_problem
from easeoff.contact.problem.certificate import (
    EXACT_TOLERANCE,
    RESOLUTION_LIMIT,
    Sizes,
    exact_residuals,
    rounded_residuals,
    violations,
)
from easeoff.contact.problem.conditioning import is_unbounded
from easeoff.contact.problem.first_contact import FirstContact, double_double, first_contact, two_product, two_sum
from easeoff.contact.problem.modal_basis import modal_basis
from easeoff.contact.solvers import registry
from easeoff.contact.solvers.backend import NoAnswerError
from easeoff.contact.solvers.backend_solution import backend_solution
from easeoff.contact.solvers.solution import OWN_ENDS, ScaledAnswer
from easeoff.contact.solvers.solver_limits import Limits
from easeoff.verification import problems
from easeoff.verification.problem_classes import PROBLEM_CLASSES

Array = NDArray[np.float64]


def far(turns: float, torque: float = 2e6) -> ContactProblem:
    """Two springs whose rotation counts from far away."""
    arm = np.array([40.0, 41.7])
    return ContactProblem(np.array([0.0, 0.013]) + turns * arm, arm, torque, np.diag([1e-6, 1e-6]))


def exact_worst(problem: ContactProblem, force: Array, elastic_rotation: float) -> float:
    return RationalProblem.of(problem).worst_violation(force, Fraction(elastic_rotation))


# First contact


def test_errors_of_sums_and_products_are_exact() -> None:
    rng = np.random.default_rng(1)
    for _ in range(200):
        a, b = (rng.standard_normal(2) * 10.0 ** rng.uniform(-30, 30, 2)).tolist()
        for operation, (rounded, error) in (
            (Fraction(a) + Fraction(b), two_sum(a, b)),
            (Fraction(a) * Fraction(b), two_product(a, b)),
        ):
            assert Fraction(rounded) + Fraction(error) == operation
    assert double_double(np.array([1e30, 1.0, 1e-30, -1e30])) == (1.0, 1e-30)


@pytest.mark.parametrize("signed", [False, True])
def test_separations_from_first_contact_are_rounded_once(signed: bool) -> None:
    rng = np.random.default_rng(2)
    for _ in range(200):
        size = int(rng.integers(1, 9))
        arm = rng.uniform(30.0, 55.0, size) * (rng.choice([-1.0, 1.0], size) if signed else 1.0)
        arm[0] = abs(arm[0])
        turns = rng.choice([-1.0, 1.0]) * 10.0 ** rng.uniform(-9.0, 9.0)
        given = 0.01 * rng.integers(0, 3, size) * rng.random(size) + turns * arm
        found = first_contact(given, arm)
        exact = RationalProblem.of(ContactProblem(given, arm, 1.0, np.eye(size)))
        for s, r, shifted in zip(exact.separation, exact.lever_arm, found.separation.tolist(), strict=True):
            right = s - exact.contact * r
            assert abs(Fraction(shifted) - right) <= abs(right) * Fraction(1, 2**52) + abs(s) / 2**102
        assert (found.separation[arm > 0.0] >= 0.0).all()
        assert found.separation[found.segment] == 0.0
        rotation = Fraction(found.rotation) + Fraction(found.remainder)
        assert abs(rotation - exact.contact) <= abs(exact.contact) / 2**100


def test_first_contact_at_rotation_zero_leaves_the_separations() -> None:
    separation = np.array([0.3, 0.0, 0.1])
    found = first_contact(separation, np.array([40.0, 41.0, 42.0]))
    assert np.array_equal(found.separation, separation)
    assert (found.rotation, found.remainder, found.segment) == (0.0, 0.0, 1)


def test_separations_near_overflow_are_shifted_plainly() -> None:
    found = first_contact(np.array([1e305, 2e305]), np.array([1.0, 1.0]))
    assert found.separation.tolist() == [0.0, 1e305]


# Certificate


def test_forces_are_right_however_far_away_rotations_are_counted() -> None:
    """By the data as doubles: the answer is that of the separations which cancellation leaves, exactly."""
    for turns in 10.0 ** np.arange(-9.0, 9.5, 0.5):
        problem = far(turns)
        found, exact = solve(problem), solution(RationalProblem.of(problem), [0, 1])
        assert found.certified
        assert exact is not None
        right = np.array([float(force) for force in exact.force])
        assert np.abs(found.force - right).max() <= 1e-14 * right.max()
        assert found.elastic_rotation == pytest.approx(float(exact.rotation), rel=1e-14)
        assert exact_worst(problem, found.force, found.elastic_rotation) <= 1e-14


def test_plain_shift_would_be_found_out(monkeypatch: pytest.MonkeyPatch) -> None:
    """What stood here before: rounded separations, a certificate at rounding level, and forces wrong by 5e-7."""

    def plain(separation: Array, arm: Array) -> FirstContact:
        rotation = float((separation / arm).min())
        shifted = np.maximum(separation - rotation * arm, 0.0)
        return replace(first_contact(separation, arm), separation=shifted, rotation=rotation, remainder=0.0)

    problem = far(1e7)
    right = solve(problem).force
    monkeypatch.setattr(contact_problem, "first_contact", plain)
    monkeypatch.setattr(registry, "compiled_solution", lambda *_: None)
    wrong = solve(far(1e7))
    assert wrong.certified
    assert np.abs(wrong.force - right).max() > 3e-7 * right.max()
    assert exact_worst(problem, wrong.force, wrong.elastic_rotation) > EXACT_TOLERANCE


def test_rotation_in_one_double_proves_the_forces_but_not_others() -> None:
    """At 10^9 rad a double resolves 5e-6 mm, a thousandth of the deflection: the forces tell where in it."""
    problem = far(1e9)
    found = solve(problem)
    assert certify(problem, found.force, found.rotation).passes()
    assert certify(problem, found.force, found.rotation).worst < 1e-12
    wrong = found.force + np.array([417.0, -400.0]) * 1e-3  # in equilibrium
    assert wrong @ problem.lever_arm == pytest.approx(problem.torque, rel=1e-12)
    assert not certify(problem, wrong, found.rotation).passes()
    beyond = found.rotation + 3.0 * math.ulp(found.rotation)
    assert not certify(problem, found.force, beyond).passes()


def test_elastic_rotation_is_taken_as_it_is() -> None:
    problem = far(1e9)
    found = solve(problem)
    turned = found.elastic_rotation * (1.0 + 1e-8)
    assert certify(problem, found.force, found.rotation, turned).worst == pytest.approx(1e-8, rel=0.5)


@pytest.mark.parametrize("name", PROBLEM_CLASSES)
def test_rounding_stays_within_its_bound(name: str) -> None:
    """Of violations of all sizes, in the three degrees of care."""
    rng = np.random.default_rng(7)
    for problem in problems(name, 2, 5):
        right = solve(problem)
        for spoil in (0.0, 1e-14, 1e-9, 1e-3):
            force = right.force * (1.0 + spoil * rng.standard_normal(problem.size))
            elastic = right.elastic_rotation * (1.0 + spoil * rng.standard_normal())
            found = certify(problem, force, right.rotation, elastic)
            exact = exact_worst(problem, force, elastic)
            assert abs(found.worst - exact) <= found.resolution + 1e-9 * exact
            assert found.resolution <= RESOLUTION_LIMIT
            deflection = problem.deflection(force)
            gap = deflection + problem.separation_at_first_contact - elastic * problem.lever_arm
            sizes = Sizes.of(problem, force, deflection)
            best = exact_residuals(problem, force, elastic)
            matters = (force != 0.0) | (gap <= 0.0)
            for sharp in (False, True):
                left = rounded_residuals(problem, force, elastic, deflection, gap, sizes, sharp=sharp)
                assert np.abs(left.gap - best.gap)[matters].max() <= left.gap_error + best.gap_error
                assert abs(left.imbalance - best.imbalance) <= left.imbalance_error + best.imbalance_error
                assert abs(left.surplus - best.surplus) <= left.surplus_error + best.surplus_error


def test_cancellation_is_stated() -> None:
    """Two tooth flanks that nearly balance each other: the torque is a millionth of the moments."""
    problem = ContactProblem([0.0, -0.1], [40.0, -40.0], 8.0, np.diag([1e-6, 1e-6]))
    found = solve(problem)
    moments = float(found.force @ np.abs(problem.lever_arm))
    assert found.certificate.cancellation == pytest.approx(moments / 8.0)
    assert found.certificate.digits == pytest.approx(15.95 - math.log10(moments / 8.0), abs=0.01)
    assert "10 digits left by cancellation" in str(found.certificate)
    alone = solve(ContactProblem([0.0], [40.0], 8e4, [[1e-6]])).certificate
    assert (alone.cancellation, round(alone.digits, 2)) == (1.0, 15.95)


def test_rounding_counts_against_the_tolerance() -> None:
    assert Certificate(0.0, 0.0, 9e-10, 0.0, 0.0, resolution=1e-11).passes()
    assert not Certificate(0.0, 0.0, 9e-10, 0.0, 0.0, resolution=2e-10).passes()
    assert not Certificate(0.0, 0.0, 0.0, 0.0, 0.0, resolution=math.nan).passes()


def test_rough_bounds_of_rounding_are_sharpened() -> None:
    """A soft segment far from contact beside stiff ones: its terms do not matter, and cost no digit."""
    problem = ContactProblem([0.0, 0.0, 5.0], [40.0, 41.0, 42.0], 1e5, np.diag([1e-6, 2e-6, 1e8]))
    found = solve(problem)
    force, deflection = found.force, problem.deflection(found.force)
    sizes = Sizes.of(problem, force, deflection)
    rough = rounded_residuals(problem, force, found.elastic_rotation, deflection, found.gap, sizes)
    assert rough.gap_error > 100.0 * RESOLUTION_LIMIT * deflection.max()
    assert violations(problem, force, found.elastic_rotation, deflection, found.gap).resolution < 1e-14
    assert found.certified


def test_compiled_certificate_counts_its_rounding_too() -> None:
    """Local compliances over nine decades: rounding bounded roughly is too much, and evaluated anew."""
    rng = np.random.default_rng(4)
    size = 30
    local = np.full(size, 2e-6)
    local[-1] = 2e18
    arm = rng.uniform(38.0, 45.0, size)
    gap = 0.01 * rng.random(size)
    gap[-1] = 40.0
    basis = modal_basis(1e-4 * rng.random((size, 2)))
    problem = ContactProblem.of_modes(gap + 1e6 * arm, arm, 1e5, local, basis)
    found = solve(problem)
    assert found.certified
    assert found.certificate.resolution <= RESOLUTION_LIMIT
    rows = solve_many(problem, separation=[problem.separation] * 2)
    assert rows.certified.all()
    for force, elastic in zip(
        [found.force, *rows.force], [found.elastic_rotation, *rows.elastic_rotation], strict=True
    ):
        assert exact_worst(problem, force, float(elastic)) <= EXACT_TOLERANCE


# Uniqueness and errors


def pair(share: float, torque: float = 8e4) -> ContactProblem:
    """Two segments with the same gap, whose deflections differ by little from each other."""
    return ContactProblem([0.0, 0.0], [40.0, 40.0], torque, 2e-6 * np.array([[1.0, share], [share, 1.0]]))


def test_two_segments_that_are_the_same_share_the_load_in_any_way() -> None:
    found = solve(pair(1.0))
    known = found.conditioning
    assert found.certified
    assert known.unique is False
    assert known.smallest_eigenvalue == 0.0
    assert np.isinf(known.force_error).all()
    assert known.rotation_error <= 1e-7 * found.elastic_rotation
    other = np.array([1.7e3, 0.3e3])
    assert certify(pair(1.0), other, found.rotation, found.elastic_rotation).passes()


@pytest.mark.parametrize("difference", [1e-3, 1e-8, 1e-12, 2e-14])
def test_bound_of_the_forces_grows_as_segments_become_alike(difference: float) -> None:
    """Scaled, the compliance has the eigenvalue 1 - share for forces without moment."""
    problem = pair(1.0 - difference)
    found = solve(problem)
    known, off = found.conditioning, np.abs(found.force - 1000.0).max()
    assert known.unique
    assert known.smallest_eigenvalue == pytest.approx(difference, rel=0.3)
    assert off <= known.force_error.max() <= 1e-10 / difference
    assert abs(found.elastic_rotation - 2e-6 * (2.0 - difference) * 1000.0 / 40.0) <= known.rotation_error


def test_answers_that_a_solver_leaves_rough_have_wide_bounds() -> None:
    problem = next(problems("realistic", 1))
    right = solve(problem)
    rough = solve(problem, "clarabel", polish=False)
    assert rough.certified
    for number in (right, rough):
        assert (np.abs(number.force - right.force) <= number.conditioning.force_error + 1e-12).all()
    assert right.conditioning.force_error.max() < 1e-10 * right.force.max()
    assert rough.conditioning.force_error.max() > 1e-10 * right.force.max()


def test_segments_just_in_contact_leave_no_false_claim() -> None:
    """Force and gap of the third are both zero, and it is the same as the second: uniqueness is open, and not claimed.

    With the second and third apart it holds, and is shown although the contact is degenerate.
    """
    arm, torque = np.ones(3), 3.0
    same = np.array([[1.0, 0.0, 0.0], [0.0, 1.0, 1.0], [0.0, 1.0, 1.0]])
    touching = ContactProblem([0.0, 3.0, 3.0], arm, torque, same)
    found = solve(touching)
    assert found.certified
    assert found.force.tolist() == [3.0, 0.0, 0.0]
    assert found.gap.tolist() == [0.0, 0.0, 0.0]
    assert found.conditioning.unique is None
    assert found.conditioning.may_touch.tolist() == [True, True, True]
    apart = solve(ContactProblem([0.0, 3.0, 3.0], arm, torque, np.eye(3)))
    assert apart.force.tolist() == [3.0, 0.0, 0.0]
    assert apart.conditioning.unique
    assert apart.conditioning.force_error.max() < 1e-13
    open_twins = solve(ContactProblem([0.0, 3.1, 3.1], arm, torque, same))
    assert open_twins.conditioning.unique  # the segments that are the same are open
    assert open_twins.conditioning.may_touch.tolist() == [True, False, False]


def test_equilibrium_alone_determines_one_rigid_segment() -> None:
    known = solve(ContactProblem([0.02, 0.01], [40.0, 40.0], 1e5, np.zeros((2, 2)))).conditioning
    assert known.unique
    assert known.smallest_eigenvalue == math.inf
    assert known.force_error.max() < 1e-9


def test_no_answer_says_nothing() -> None:
    refused = solve(ContactProblem([0.1, -0.3], [40.0, 0.0], 10.0, np.diag([1e-6, 0.0]))).conditioning
    assert refused.unique is None
    assert np.isinf(refused.force_error).all()
    assert refused.rotation_error == math.inf


def test_large_structured_problems_are_bounded_by_their_local_part(monkeypatch: pytest.MonkeyPatch) -> None:
    problem = next(problems("realistic", 1))
    found = solve(problem)
    whole = replace(found).conditioning
    monkeypatch.setattr("easeoff.contact.problem.conditioning.EIGENVALUE_SIZE_LIMIT", 2)
    local = replace(found).conditioning
    assert local.unique
    assert 0.0 < local.smallest_eigenvalue <= whole.smallest_eigenvalue
    assert local.force_error.max() < 1e-9 * found.force.max()


# Statuses without an answer


def test_unbounded_is_proved_not_believed() -> None:
    interfering = np.array([0.1, -0.3, -0.3])
    arm = np.array([40.0, 0.0, 0.0])
    assert is_unbounded(ContactProblem(interfering, arm, 10.0, np.diag([1e-6, 0.0, 0.0])))
    assert not is_unbounded(ContactProblem(interfering, arm, 10.0, np.diag([1e-6, 1e-17, 1e-17])))
    assert not is_unbounded(ContactProblem(np.abs(interfering), arm, 10.0, np.diag([1e-6, 0.0, 0.0])))
    modal = (np.array([1e-6, 0.0, 0.0]), np.array([[0.0], [1e-3], [-1e-3]]))  # the two move against each other
    assert is_unbounded(ContactProblem(interfering, arm, 10.0, modal))


@pytest.mark.parametrize("answers", [True, False])
@pytest.mark.parametrize("said", Status)
def test_what_a_solver_says_of_the_data_is_a_claim(
    said: Status, answers: bool, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Of these data none of it is true; that it failed or met a limit is its own matter."""
    stiff = ContactProblem([0.0, 0.01], [40.0, 40.0], 1e3, np.diag([1e-6, 1e-6]))

    def adapter(*_: object) -> ScaledAnswer:
        if not answers:
            raise NoAnswerError("said", said)
        return ScaledAnswer(np.full(2, 3.0), 1.0, 1, "said", said)

    monkeypatch.setattr(registry, "adapter_of", lambda _: adapter)
    for found in (solve(stiff, "clarabel", polish=False), solve(stiff, Solver("mine", adapter), polish=False)):
        assert found.status is (said if said in OWN_ENDS else Status.NOT_CERTIFIED)
        assert found.claim == said.name.lower()
        assert np.isnan(found.force).all()


def test_an_answer_has_the_same_status_whichever_solver_gave_it() -> None:
    """Unless the caller sets a tolerance; so has a problem that is proved to have none."""
    wide, stiff = SOLVERS["clarabel"].tolerance, far(0.0)
    scaled, right = stiff.scaled(), solve(stiff)
    for error, status in ((0.0, Status.CERTIFIED), (1e-7, Status.NOT_CERTIFIED)):
        force = right.force / stiff.scaling.force * (1.0 + error)
        answer = ScaledAnswer(force, float(scaled.deflection(force)[0] / scaled.lever_arm[0]), 1)
        for name in ("clarabel", "daqp", "highs", "mine"):
            found = backend_solution(stiff, name, lambda *_, answer=answer: answer, {}, polish=None)
            assert found.status is status, name
            loose = backend_solution(stiff, name, lambda *_, a=answer: a, {}, polish=None, limits=Limits(wide))
            assert loose.certified
    rigid = ContactProblem([0.1, -0.3], [40.0, 0.0], 10.0, np.diag([1e-6, 0.0]))
    quick = {*available_solvers()} - {"proxqp"}  # which goes on to its last step
    assert {solve(rigid, name).status for name in quick} == {Status.UNBOUNDED}


# Random and degenerate problems


@pytest.mark.parametrize(("first", "count"), [(0, 120), pytest.param(1000, 6000, marks=pytest.mark.thorough)])
def test_nothing_is_claimed_falsely(first: int, count: int) -> None:
    found: Counter[str] = Counter()
    for seed in range(first, first + count):
        what, faults = claims.judge(seed)
        assert not faults, f"seed {seed}: {faults}"
        found[what.split()[1].strip(",")] += 1
    assert found["CERTIFIED"] > 0.97 * count


@pytest.mark.parametrize(
    ("fault", "name", "value"),
    [
        ("violation", "easeoff.contact.problem.certificate.Certificate.passes", lambda *_: True),
        ("bound", "easeoff.contact.problem.conditioning._smallest_eigenvalue", lambda *_: 1e3),
        ("unique", "easeoff.contact.problem.conditioning._smallest_eigenvalue", lambda *_: 1e-3),
        ("negative eigenvalue", "easeoff.contact.ContactProblem.is_positive_semidefinite", property(lambda _: False)),
    ],
)
def test_judge_finds_false_claims(fault: str, name: str, value: Any, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(name, value)
    assert any(fault in each for seed in range(0, 150, 5) for each in claims.judge(seed)[1])


def test_drawn_problems_are_of_every_kind() -> None:
    drawn = [drawn_problem(seed) for seed in range(400)]
    assert len({name for name, _ in drawn}) == 8
    rotations = np.array([abs(problem.first_contact_rotation) for _, problem in drawn])
    assert rotations.max() > 1e7
    assert np.count_nonzero([problem.lever_arm.min() < 0.0 for _, problem in drawn]) > 20
    assert np.count_nonzero([problem.torque == 0.0 for _, problem in drawn]) > 5
    assert np.count_nonzero([problem.is_structured for _, problem in drawn]) > 100
    bases = [problem.modal_basis for _, problem in drawn]
    assert np.count_nonzero([basis is not None and basis.shared is not None for basis in bases]) > 10


@pytest.mark.parametrize("dense", [True, False])
def test_forces_beyond_all_bounds_hide_no_penetration(dense: bool) -> None:
    """Equal forces on both segments have no moment and bend nothing, but close penetration: there is no minimum.

    Forces of 1e15 N penetrate by as much as the segments are apart, little beside the terms of their deflection.
    """
    modes = np.array([[-1.0], [1.0]])
    compliance = modes @ modes.T if dense else (np.zeros(2), modes)
    problem = ContactProblem(np.array([-1.0, -1.0]), np.array([2.0, -2.0]), 11.0, compliance)
    assert solve(problem).status is Status.UNBOUNDED
    assert not certify(problem, np.array([1e15 + 5.5, 1e15]), 2.25).passes(1e-3)


def test_a_certificate_says_whether_it_passes_and_which_condition_is_worst() -> None:
    springs = ContactProblem(np.zeros(2), np.full(2, 40.0), 8.0e4, np.diag([1e-6, 1e-6]))
    one_sided = certify(springs, np.array([2000.0, 0.0]), 5e-5)
    assert one_sided.worst_condition == "negative_gap"
    assert str(one_sided).startswith("misses 1e-09: worst violation 1, of negative_gap (rounding bound ")
    assert one_sided.verdict(2.0).startswith("passes 2: ")
    short = certify(springs, np.array([990.0, 990.0]), 2.5e-5)
    assert short.verdict(0.03).startswith("passes 0.03: worst violation 0.02, of duality_gap")
    assert str(solve(springs).certificate).startswith("passes 1e-09: ")
    assert "every tolerance" in str(certify(springs, np.array([math.nan, 0.0]), 0.0))


def test_a_status_prints_as_its_name_and_is_an_integer_in_arrays() -> None:
    springs = ContactProblem(np.zeros(2), np.full(2, 40.0), 8.0e4, np.diag([1e-6, 1e-6]))
    status = solve(springs).status
    assert (str(status), f"{status}", f"{status:d}") == ("CERTIFIED", "CERTIFIED", "0")
    kept = np.array([status, Status.TIME_LIMIT])
    assert kept.dtype.kind == "i"
    assert kept.tolist() == [0, 7]


# Certificates stay true


@pytest.mark.parametrize("again", [lambda s: s, copy.copy, copy.deepcopy, lambda s: pickle.loads(pickle.dumps(s))])
def test_no_number_of_a_proved_solution_can_be_changed(again: Callable[[ContactSolution], ContactSolution]) -> None:
    solution = again(solve(far(0.0)))
    assert solution.problem is not None
    for numbers in (solution.force, solution.gap, solution.answer.force, solution.conditioning.force_error):
        with pytest.raises(ValueError, match="read-only"):
            numbers[:] = 0.0
    for numbers in (solution.problem.separation, solution.problem.compliance, solution.sensitivity().force):
        with pytest.raises(ValueError, match="read-only"):
            numbers[:] = 0.0
    assert solution.certified
    assert solution.force.min() > 0.0


def test_what_a_record_was_given_stays_the_users_own() -> None:
    """And changes nothing in the record."""
    modes = np.ones((1, 2, 1))
    basis = ModalBasis(2, np.array([[0, 1]]), modes)
    modes[:] = 7.0
    assert basis.modes.tolist() == [[[1.0], [1.0]]]
    assert not basis.columns.columns.flags.writeable
    found = solve_many(far(0.0), torque=[1e6, 2e6])
    arrays = [value for field in fields(found) if isinstance(value := getattr(found, field.name), np.ndarray)]
    assert len(arrays) > 7
    assert not any(values.flags.writeable for values in arrays)
