"""Derivatives of solutions: against differences, transposed, through changes of contact, and in closed form."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray
from solver_choice import dense

from easeoff import InputError
from easeoff.contact import (
    ContactProblem,
    Differentiability,
    SolutionChange,
    sensitivity,
    solve,
    torque_path,
)
from easeoff.contact.solvers.parametric import touching_form
from easeoff.verification import problems

Array = NDArray[np.float64]

SMOOTH = ("plain", "duplicated", "realistic", "signed_modes", "mixed_arms", "heavy_load")
DATA = ("torque", "separation", "lever_arm", "local", "factor", "compliance")


def direction(problem: ContactProblem, names: tuple[str, ...], seed: int) -> dict[str, Any]:
    """A random change of some of the data, of the size of what matters in the problem."""
    rng, size = np.random.default_rng(seed), problem.size
    gap = abs(solve(problem).elastic_rotation) * problem.lever_arm.max()
    matrix = problem.compliance_matrix.diagonal.min() * rng.normal(size=(size, size)) / size
    whole = {
        "torque": problem.torque * rng.normal(),
        "separation": gap * rng.normal(size=size),
        "lever_arm": 0.1 * np.abs(problem.lever_arm) * rng.normal(size=size),
        "compliance": matrix + matrix.T,
    }
    if isinstance(problem.compliance, tuple):
        local, factor = problem.compliance
        whole["local"] = 0.3 * local * rng.normal(size=size)
        whole["factor"] = 0.3 * np.abs(factor).max() * rng.normal(size=factor.shape)
    return {name: whole[name] for name in names if name in whole}


def changed(problem: ContactProblem, change: Mapping[str, Any], length: float) -> ContactProblem:
    step = {name: length * value for name, value in change.items()}
    compliance: Any = problem.dense_compliance + step.get("compliance", 0.0)
    if isinstance(problem.compliance, tuple):
        local, factor = problem.compliance
        compliance = local + step.get("local", 0.0), factor + step.get("factor", 0.0)
        if "compliance" in step:
            compliance = np.diag(compliance[0]) + compliance[1] @ compliance[1].T + step["compliance"]
    return ContactProblem(
        problem.separation + step.get("separation", 0.0),
        problem.lever_arm + step.get("lever_arm", 0.0),
        problem.torque + step.get("torque", 0.0),
        compliance,
    )


def outputs(problem: ContactProblem) -> Array:
    """Forces, gaps, rotation and deformation energy as one array."""
    solution = solve(problem)
    assert solution.certified
    energy = 0.5 * solution.force @ problem.deflection(solution.force)
    return np.concatenate([solution.force, solution.gap, [solution.rotation, energy]])


def as_array(change: SolutionChange) -> Array:
    return np.concatenate([change.force, change.gap, [change.rotation, change.energy]])


def scales(problem: ContactProblem, change: SolutionChange) -> Array:
    solution = solve(problem)
    gap = abs(solution.elastic_rotation) * problem.lever_arm.max()
    of = solution.force.max(), gap, abs(solution.elastic_rotation), solution.force @ problem.deflection(solution.force)
    found = np.abs(change.force).max(), np.abs(change.gap).max(), abs(change.rotation), abs(change.energy)
    force, gap, rotation, energy = (max(pair) for pair in zip(of, found, strict=True))
    return np.concatenate([np.full(problem.size, force), np.full(problem.size, gap), [rotation, energy]])


@pytest.mark.parametrize("form", ["modal", "dense"])
@pytest.mark.parametrize("data", DATA)
def test_derivatives_are_those_of_central_differences(data: str, form: str, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(touching_form, "DENSE_FIRST_SIZE", 0)
    tried = 0
    for name in SMOOTH:
        for number, given in enumerate(problems(name, 1, seed=1)):
            problem = dense(given) if form == "dense" else given
            change = direction(problem, (data,), number)
            if not change:
                continue
            slope = sensitivity(problem, solve(problem))
            assert slope.status is Differentiability.DIFFERENTIABLE
            found = slope.forward(**change)
            assert not found.one_sided
            length = 1e-5
            ends = [changed(problem, change, sign * length) for sign in (1.0, -1.0)]
            assert all((solve(end).active == slope.loaded).all() for end in ends), "the set must not change"
            ahead, behind = map(outputs, ends)
            error = (ahead - behind) / (2.0 * length) - as_array(found)
            assert np.abs(error / scales(problem, found)).max() < 1e-6
            tried += 1
    assert tried == (0 if form == "dense" and data in ("local", "factor") else 6)


@pytest.mark.parametrize("form", ["modal", "dense"])
@pytest.mark.parametrize("name", [*SMOOTH, "lattice", "random_dense", "interfering", "weak_local"])
def test_adjoint_is_the_transpose(name: str, form: str, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(touching_form, "DENSE_FIRST_SIZE", 0)
    for number, given in enumerate(problems(name, 3, seed=2)):
        problem = dense(given) if form == "dense" else given
        change = direction(problem, DATA, number)
        slope = sensitivity(problem, solve(problem))
        forward = slope.forward(**change)
        weights = np.random.default_rng(number).normal(size=2 * problem.size + 2) / scales(problem, forward)
        force, gap, (rotation, energy) = np.split(weights, [problem.size, 2 * problem.size])
        active = forward.active if slope.weak.any() else None
        gradient = slope.adjoint(force=force, gap=gap, rotation=rotation, energy=energy, active=active)
        terms = [np.sum(getattr(gradient, key) * value) for key, value in change.items()]
        level = max(1.0, np.abs(terms).max())
        assert abs(weights @ as_array(forward) - sum(terms)) <= 1e-12 * level


def test_winkler_bed_in_closed_form() -> None:
    """Stiffnesses k in parallel: dtheta/dT = 1 / sum k r^2, and so on."""
    rng = np.random.default_rng(0)
    gap, arm, k = rng.uniform(0.0, 0.01, 12), rng.uniform(40.0, 60.0, 12), rng.uniform(1e5, 1e6, 12)
    bed = ContactProblem(gap, arm, 3e5, (1.0 / k, np.zeros((12, 1))))
    solution = solve(bed)
    slope = sensitivity(bed, solution)
    touching = solution.active
    stiffness = np.where(touching, k, 0.0)
    whole = (stiffness * arm**2).sum()
    by_torque = slope.forward(torque=1.0)
    assert by_torque.rotation == pytest.approx(1.0 / whole)
    np.testing.assert_allclose(by_torque.force, stiffness * arm / whole)
    assert by_torque.energy == pytest.approx((solution.force * arm / whole).sum())
    gradient = slope.adjoint(rotation=1.0)
    np.testing.assert_allclose(gradient.separation, stiffness * arm / whole)
    np.testing.assert_allclose(gradient.local, stiffness * arm / whole * solution.force)
    by_gap = -stiffness * arm / whole * solution.rotation - solution.force / whole
    np.testing.assert_allclose(gradient.lever_arm, by_gap)


@pytest.mark.parametrize("name", [*SMOOTH, "far_apart"])
def test_identities(name: str) -> None:
    """What scales, scales; a turn of the zero turns the rotation alone; work goes into energy."""
    for problem in problems(name, 3, seed=3):
        solution = solve(problem)
        slope = sensitivity(problem, solution)
        force, rotation = solution.force, solution.rotation
        atol = 1e-9 * force.max()
        larger = slope.forward(torque=problem.torque, separation=problem.separation)
        np.testing.assert_allclose(larger.force, force, rtol=1e-9, atol=atol)
        assert larger.rotation == pytest.approx(rotation, rel=1e-9)
        assert larger.energy == pytest.approx(force @ problem.deflection(force), rel=1e-9)
        softer = slope.forward(compliance=problem.dense_compliance, separation=problem.separation)
        np.testing.assert_allclose(softer.force, 0.0, rtol=1e-9, atol=atol)
        assert softer.rotation == pytest.approx(rotation, rel=1e-9)
        longer = slope.forward(torque=problem.torque, lever_arm=problem.lever_arm)
        np.testing.assert_allclose(longer.force, 0.0, rtol=1e-9, atol=atol)
        assert longer.rotation == pytest.approx(-rotation, rel=1e-9)
        turned = slope.forward(separation=problem.lever_arm)
        np.testing.assert_allclose(turned.force, 0.0, rtol=1e-9, atol=atol)
        np.testing.assert_allclose(turned.gap, 0.0, atol=1e-9 * problem.lever_arm.max())
        assert turned.rotation == pytest.approx(1.0, rel=1e-9)
        loaded = slope.forward(torque=1.0)
        work = loaded.energy + problem.separation @ loaded.force
        terms = float(np.abs(problem.separation) @ np.abs(loaded.force))
        assert work == pytest.approx(rotation, rel=1e-9, abs=1e-12 * terms)


@pytest.mark.parametrize("form", ["modal", "dense"])
def test_kink_has_the_slopes_of_both_pieces(form: str, monkeypatch: pytest.MonkeyPatch) -> None:
    """At every event of a path the derivatives up and down are the slopes of the pieces there."""
    monkeypatch.setattr(touching_form, "DENSE_FIRST_SIZE", 0)
    *_, given = problems("signed_modes", 9)
    problem = dense(given) if form == "dense" else given
    path = torque_path(problem, 0.0, 3.0 * problem.torque)
    ends = path.breakpoints
    for below, torque, above in zip(ends[:-2], ends[1:-1], ends[2:], strict=True):
        slope = sensitivity(problem.with_torque(torque), path.at(torque))
        assert slope.status is Differentiability.ONE_SIDED
        up, down = slope.forward(torque=1.0), slope.forward(torque=-1.0)
        assert up.one_sided
        assert down.one_sided
        for found, other in ((up, above), (down, below)):
            secant = (path.at(other).force - path.at(torque).force) / abs(other - torque)
            np.testing.assert_allclose(found.force, secant, rtol=1e-7, atol=1e-7 * np.abs(secant).max())
            turn = (path.at(other).elastic_rotation - path.at(torque).elastic_rotation) / abs(other - torque)
            assert found.rotation == pytest.approx(turn, rel=1e-7)
            side = path.at(0.5 * (torque + other))
            np.testing.assert_array_equal(found.active, side.active)
            gradient = slope.adjoint(rotation=1.0, active=found.active)
            assert gradient.one_sided
            assert gradient.torque == pytest.approx(abs(turn), rel=1e-7)


def test_kink_of_many_weak_segments() -> None:
    """Symmetric ties: one-sided differences in every direction agree with the derivative in that direction alone."""
    x = np.linspace(-1.0, 1.0, 9)
    coupling = 1e-7 * np.exp(-(np.subtract.outer(x, x) ** 2)) + np.diag(np.full(9, 1e-6))
    crown = ContactProblem(0.01 * x**2, np.full(9, 50.0), 0.0, coupling)
    problem = crown.with_torque(float(torque_path(crown, 0.0, 4e6).torque[4]))
    slope = sensitivity(problem, solve(problem))
    assert np.flatnonzero(slope.weak).tolist() == [2, 6]
    sides = set()
    for seed in range(24):
        change = direction(problem, ("torque", "separation", "lever_arm", "compliance"), seed)
        found = slope.forward(**change)
        here, near, far = (outputs(changed(problem, change, length)) for length in (0.0, 1e-6, 2e-6))
        error = (4.0 * near - far - 3.0 * here) / 2e-6 - as_array(found)
        assert np.abs(error / scales(problem, found)).max() < 1e-6
        sides.add(tuple(found.active))
    assert len(sides) == 4, "each of the two may enter or stay open"


def test_first_contact_has_derivatives_into_the_load() -> None:
    springs = ContactProblem([0.0, 0.0, 1e-3], [40.0, 40.0, 40.0], 0.0, np.diag([1e-6, 1e-6, 1e-6]))
    slope = sensitivity(springs, solve(springs))
    assert slope.status is Differentiability.ONE_SIDED
    np.testing.assert_allclose(slope.forward(torque=80.0).force, [1.0, 1.0, 0.0])
    assert slope.forward(separation=[2e-3, 1e-3, 0.0]).rotation == pytest.approx(1e-3 / 40.0)
    apart = slope.forward(torque=-1.0)
    assert np.isnan(apart.rotation)
    assert "no solution in this direction" in apart.message


def test_forces_that_are_not_unique_have_no_derivatives_but_the_rotation_may() -> None:
    single = dense(next(problems("plain", 1, seed=2)))
    twice = np.tile(np.arange(single.size), 2)
    gap, arm = single.separation[twice], single.lever_arm[twice]
    copied = ContactProblem(gap, arm, single.torque, single.dense_compliance[np.ix_(twice, twice)])
    slope, reference = (sensitivity(one, solve(one)) for one in (copied, single))
    assert slope.status is Differentiability.FORCES_NOT_UNIQUE
    both = np.random.default_rng(0).normal(size=single.size) * 1e-3
    for change, other in (
        (slope.forward(torque=1.0), reference.forward(torque=1.0)),
        (slope.forward(separation=both[twice]), reference.forward(separation=both)),
    ):
        assert change.rotation == pytest.approx(other.rotation, rel=1e-9)
        assert change.energy == pytest.approx(other.energy, rel=1e-9)
        np.testing.assert_allclose(change.gap, other.gap[twice], rtol=1e-9, atol=1e-9 * np.abs(other.gap).max())
        assert np.isnan(change.force).all()
    split = slope.forward(separation=np.arange(2.0 * single.size))
    assert np.isnan(split.rotation)
    assert "not unique" in split.message
    assert np.isnan(slope.forward(lever_arm=np.ones(copied.size)).rotation)
    gradient = slope.adjoint(rotation=1.0)
    assert gradient.torque == pytest.approx(reference.adjoint(rotation=1.0).torque, rel=1e-9)
    assert np.isnan(gradient.separation).all()
    assert np.isnan(slope.adjoint(force=np.ones(copied.size)).torque)


def test_mistakes_are_named() -> None:
    problem = next(problems("plain", 1))
    solution = solve(problem)
    slope = sensitivity(problem, solution)
    with pytest.raises(InputError, match="solution: must be that of this problem"):
        sensitivity(problem.with_torque(2.0 * problem.torque), solution)
    refused = solve(ContactProblem([0.0, 0.0], [1.0, 1.0], 1.0, np.array([[1.0, 2.0], [2.0, 1.0]])))
    with pytest.raises(InputError, match="not_positive_semidefinite: must be certified"):
        sensitivity(problem, refused)
    with pytest.raises(InputError, match="separation"):
        slope.forward(separation=[0.0])
    with pytest.raises(InputError, match="factor = array of shape"):
        slope.forward(factor=np.zeros((1, 1)))
    with pytest.raises(InputError, match="compliance: must be a symmetric array"):
        slope.forward(compliance=np.triu(np.ones((problem.size, problem.size))))
    with pytest.raises(InputError, match="factor: must be left out"):
        sensitivity(dense(problem), solve(dense(problem))).forward(factor=np.zeros((problem.size, 1)))
    with pytest.raises(InputError, match="active: must be the loaded segments"):
        slope.adjoint(rotation=1.0, active=np.zeros(problem.size, dtype=bool))


def test_solution_knows_its_own_derivatives() -> None:
    problem = next(problems("realistic", 1))
    solution = solve(problem)
    own, other = solution.sensitivity().adjoint(rotation=1.0), sensitivity(problem, solution).adjoint(rotation=1.0)
    np.testing.assert_array_equal(own.separation, other.separation)
    refused = solve(ContactProblem([0.0, 0.0], [1.0, 1.0], 1.0, np.array([[1.0, 2.0], [2.0, 1.0]])))
    with pytest.raises(InputError, match="must be certified"):
        refused.sensitivity()
