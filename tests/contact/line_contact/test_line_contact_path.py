"""Load-dependent line contact over the torque, and its derivatives: against the linear path, and re-solving."""

from __future__ import annotations

from functools import cache
from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray

from easeoff import InputError
from easeoff.cases import gear_pair, read_case
from easeoff.contact import (
    STEEL,
    ContactProblem,
    ContactSolution,
    Differentiability,
    ElasticModel,
    MeshCycle,
    Status,
    line_contact_path,
    line_contact_sensitivity,
    torque_path,
)
from easeoff.contact.compliance.weber_line_contact import WeberLineContact
from easeoff.contact.evaluation.cycle_numbers import mesh_stiffnesses
from easeoff.contact.line_contact.line_contact_path import solved_at
from easeoff.contact.line_contact.line_contact_solution import LineContact, solve_on_bending
from easeoff.contact.solvers.solution import no_solution
from easeoff.geometry import pair_geometry
from easeoff.verification import problems

Array = NDArray[np.float64]


class Springs:
    """A local law of constant compliance (n) [mm/N]."""

    def __init__(self, compliance: Array) -> None:
        self.compliance = compliance

    def deflection(self, force: Array) -> Array:
        return self.compliance * force

    def secant(self, force: Array) -> Array:
        return self.compliance + 0.0 * force

    def tangent(self, force: Array) -> Array:
        return self.compliance + 0.0 * force


def steel_line(length: Array, radius: float) -> WeberLineContact:
    return WeberLineContact(length, np.array(radius), np.array(3.0), np.array(4.0), STEEL, STEEL)


def line_of_contact(size: int = 15) -> tuple[ContactProblem, WeberLineContact]:
    """A crowned, tilted line on two bending modes."""
    x = np.linspace(-1.0, 1.0, size)
    bending = 1e-3 * np.column_stack([np.ones(size), 0.5 * x])
    contact = steel_line(np.full(size, 30.0 / size), 30.0)
    return ContactProblem(0.02 * (x - 0.1) ** 2, np.full(size, 50.0), 0.0, (np.zeros(size), bending)), contact


def solved(bending: ContactProblem, contact: LineContact, torque: float) -> ContactSolution:
    data = bending.separation, bending.lever_arm, torque, bending.compliance
    return solve_on_bending(ContactProblem(*data), contact)[0]


def test_constant_law_has_the_path_of_the_linear_problem() -> None:
    """Events are then those of the exact path, to the stated tolerance."""
    for number in range(3):
        *_, given = problems("signed_modes", number + 1)
        assert isinstance(given.compliance, tuple)
        local, factor = given.compliance
        bending = ContactProblem(given.separation, given.lever_arm, 0.0, (np.zeros(given.size), factor))
        linear = torque_path(given, 0.0, 2.0 * given.torque)
        path = line_contact_path(bending, Springs(local), 0.0, 2.0 * given.torque)
        assert path.certified, path.message
        np.testing.assert_array_equal(path.segment, linear.segment)
        np.testing.assert_array_equal(path.enters, linear.enters)
        np.testing.assert_allclose(path.torque, linear.torque, rtol=1e-9)


@pytest.mark.parametrize("torques", [(0.0, 6e5), (6e5, 1e5)])
def test_path_is_that_of_solving_every_torque(torques: tuple[float, float]) -> None:
    bending, contact = line_of_contact()
    path = line_contact_path(bending, contact, *torques)
    assert path.certified, path.message
    assert path.torque.size >= 5
    assert path.covered == (min(torques), max(torques))
    rising = 1.0 if torques[0] < torques[1] else -1.0
    assert (rising * np.diff(path.torque) >= 0.0).all()
    touching = solved(bending, contact, torques[0]).active
    for torque, segment, enters in zip(path.torque, path.segment, path.enters, strict=True):
        if torque > 0.0:
            before, after = (
                solved(bending, contact, float(torque) * (1.0 + sign * rising * 2e-9)) for sign in (-1.0, 1.0)
            )
            assert bool(before.active[segment]) is not bool(enters)
            assert bool(after.active[segment]) is bool(enters)
            np.testing.assert_array_equal(before.active, touching)
        touching = touching.copy()
        touching[segment] = enters
    for torque in np.random.default_rng(0).uniform(*path.covered, 8):
        own, other = path.at(float(torque)), solved(bending, contact, float(torque))
        assert own.certified
        np.testing.assert_allclose(own.force, other.force, rtol=0.0, atol=1e-11 * other.force.max())


def test_points_and_events_in_a_dataset() -> None:
    bending, contact = line_of_contact()
    path = line_contact_path(bending, contact, 0.0, 3e5, tolerance=1e-6)
    data = path.to_dataset()
    assert data.attrs["event_tolerance"] == 1e-6
    assert all({"units", "long_name"} <= set(variable.attrs) for variable in data.data_vars.values())
    assert float(data["worst_residual"].max()) < 1e-9
    moment = data["path_force"].values @ bending.lever_arm
    np.testing.assert_allclose(moment, data["path_torque"], rtol=1e-12, atol=1e-9)


def test_path_ends_with_a_reason_where_no_solution_is_certified(monkeypatch: pytest.MonkeyPatch) -> None:
    bending, contact = line_of_contact()

    def failing(bending: ContactProblem, contact: LineContact, torque: float, start: Array | None) -> ContactSolution:
        if torque > 2e5:
            return no_solution(bending.size, Status.SOLVER_FAILED, "native", message="as planted")
        return solved_at(bending, contact, torque, start)

    monkeypatch.setattr("easeoff.contact.line_contact.line_contact_path.solved_at", failing)
    path = line_contact_path(bending, contact, 1e4, 6e5)
    assert path.status is Status.NOT_CONVERGED
    assert "solver_failed; as planted" in path.message
    assert path.covered[1] <= 2e5
    with pytest.raises(InputError, match="the known path"):
        path.at(5e5)


def energy(bending: ContactProblem, contact: WeberLineContact, force: Array) -> float:
    return float(0.5 * force @ bending.deflection(force) + contact.energy(force).sum())


@pytest.mark.parametrize("data", ["torque", "separation", "lever_arm", "factor"])
def test_derivatives_are_those_of_central_differences(data: str) -> None:
    bending, contact = line_of_contact()
    bending = bending.with_torque(2e5)
    assert isinstance(bending.compliance, tuple)
    rng, (local, factor) = np.random.default_rng(1), bending.compliance
    change: Any = {
        "torque": 1e5,
        "separation": 1e-2 * rng.normal(size=15),
        "lever_arm": 5.0 * rng.normal(size=15),
        "factor": 3e-4 * rng.normal(size=factor.shape),
    }[data]

    def at(length: float) -> tuple[ContactSolution, float]:
        step = {data: length * change}
        moved = ContactProblem(
            bending.separation + step.get("separation", 0.0),
            bending.lever_arm + step.get("lever_arm", 0.0),
            float(bending.torque + step.get("torque", 0.0)),
            (local, factor + step.get("factor", 0.0)),
        )
        solution = solved(moved, contact, moved.torque)
        return solution, energy(moved, contact, solution.force)

    slope = line_contact_sensitivity(bending, contact, at(0.0)[0])
    assert slope.status is Differentiability.DIFFERENTIABLE
    found = slope.forward(**{data: change})
    (ahead, more), (behind, less) = at(1e-5), at(-1e-5)
    np.testing.assert_array_equal(ahead.active, behind.active)
    rate = (ahead.force - behind.force) / 2e-5
    np.testing.assert_allclose(found.force, rate, rtol=0.0, atol=1e-6 * np.abs(rate).max())
    rate = (ahead.gap - behind.gap) / 2e-5
    np.testing.assert_allclose(found.gap, rate, rtol=0.0, atol=1e-6 * np.abs(rate).max())
    assert found.rotation == pytest.approx((ahead.rotation - behind.rotation) / 2e-5, rel=1e-6)
    assert found.energy == pytest.approx((more - less) / 2e-5, rel=1e-6)
    gradient = slope.adjoint(rotation=1.0)
    assert np.sum(getattr(gradient, data) * change) == pytest.approx(found.rotation, rel=1e-12)


def test_parameter_of_the_line_contact_acts_as_a_separation() -> None:
    """Radius of curvature: the change of the deflection under the same forces."""
    bending, contact = line_of_contact()
    bending = bending.with_torque(2e5)
    solution = solved(bending, contact, 2e5)

    ahead, behind = (steel_line(contact.length, 30.0 + step) for step in (1e-3, -1e-3))
    moved = (ahead.deflection(solution.force) - behind.deflection(solution.force)) / 2e-3
    found = line_contact_sensitivity(bending, contact, solution).forward(separation=moved).rotation
    rate = (solved(bending, ahead, 2e5).rotation - solved(bending, behind, 2e5).rotation) / 2e-3
    assert found == pytest.approx(rate, rel=1e-6)


def test_solution_of_another_problem_is_refused() -> None:
    bending, contact = line_of_contact()
    with pytest.raises(InputError, match="solution: must be that of this problem"):
        line_contact_sensitivity(bending.with_torque(1e5), contact, solved(bending, contact, 2e5))


@cache
def cycle() -> MeshCycle:
    geometry = pair_geometry(gear_pair(read_case("nasa-12x36")), (9, 7))
    return MeshCycle.of(geometry, ElasticModel(), mesh_positions=2, segments_per_line=11)


def test_mesh_stiffness_is_the_derivative_of_the_torque_by_the_rotation() -> None:
    for case in cycle().solved([50.0, 300.0]):
        here = case.segments
        bending = here.bending_problem.with_torque(case.problem.torque)
        slope = line_contact_sensitivity(bending, here.line_contact, case.solution)
        stiffness = 1e-9 / slope.forward(torque=1.0).rotation
        assert mesh_stiffnesses([case])[0] == pytest.approx(stiffness, rel=1e-12)


@pytest.mark.thorough
def test_path_of_a_mesh_position() -> None:
    here = cycle().segments.by_position[1]
    assert here is not None
    bending, contact = here.bending_problem, here.line_contact
    path = line_contact_path(bending, contact, 0.0, 4e5 * cycle().ratio)
    assert path.certified
    assert path.torque.size > 8
    touching = np.zeros(bending.size, dtype=bool)
    events = list(zip(path.torque, path.segment, path.enters, strict=True))
    for torque in np.linspace(1e3, path.end, 60):
        while events and events[0][0] <= torque:
            _, segment, enters = events.pop(0)
            touching[segment] = enters
        np.testing.assert_array_equal(solved(bending, contact, float(torque)).active, touching)
