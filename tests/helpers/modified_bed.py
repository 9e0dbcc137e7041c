"""Beds of springs and random contact problems whose separation may be modified: S + B m, no gear."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from easeoff.contact import ContactProblem, Status, solve
from easeoff.contact.modification.convex_programme import (
    Goal,
    LoadResponse,
    Objective,
    figures,
    held_in_contact,
    load_response,
    stacked,
    worst_assembly,
)
from easeoff.contact.problem.compliance_matrix import DenseCompliance

Array = NDArray[np.float64]


@dataclass
class Bed:
    """Mesh positions (k) of n segments at several torques, with constant compliance.

    Separations (k, n) [mm], basis (k, n, p) [mm per unit], lever arms (k, n) [mm], compliances (k, n, n) [mm/N],
    torques (t) [N mm], lengths (n) [mm], curvatures (n) [1/mm].
    """

    separation: Array
    basis: Array
    lever_arm: Array
    compliance: Array
    torques: Array
    length: Array
    curvature: Array

    def problem(self, torque: int, position: int, coefficients: Array) -> ContactProblem:
        separation = self.separation[position] + self.basis[position] @ coefficients
        return ContactProblem(
            separation, self.lever_arm[position], float(self.torques[torque]), self.compliance[position]
        )

    def full_contact(self, coefficients: Array) -> LoadResponse:
        """All segments held in contact."""
        return self.solved(coefficients, pull=True)

    def solved(self, coefficients: Array, *, pull: bool = False) -> LoadResponse:
        parts = []
        ends = np.zeros(self.length.size, dtype=bool)
        ends[[0, -1]] = True
        for k in range(len(self.separation)):
            for t in range(self.torques.size):
                problem = self.problem(t, k, coefficients)
                if pull:
                    force, rotation = held_in_contact(
                        DenseCompliance(self.compliance[k]), problem.separation, problem.lever_arm, problem.torque
                    )
                    gap = np.zeros(force.size)
                else:
                    solution = solve(problem)
                    assert solution.status is Status.CERTIFIED
                    force, rotation, gap = solution.force, solution.rotation, solution.gap
                parts.append(
                    load_response(
                        DenseCompliance(self.compliance[k]),
                        force,
                        gap,
                        rotation,
                        self.basis[k],
                        lever_arm=self.lever_arm[k],
                        length=self.length,
                        curvature=self.curvature,
                        at_end=ends,
                        cycle=t,
                        pull=pull,
                    )
                )
        return stacked(parts)

    def goal(self, objective: Objective = "peak_load", **changes: Any) -> Goal:
        """No limits but a wide one of the surface, which is the coefficients themselves."""
        torques = self.torques.size
        start = self.solved(np.zeros(self.basis.shape[2]))
        values: dict[str, Any] = {
            "objective": objective,
            "reference": worst_assembly(figures(start, objective), torques),
            "load_reference": worst_assembly(figures(start, "peak_load"), torques),
            "transmission_error": np.inf,
            "end_load": np.full(torques, np.inf),
            "surface": np.eye(self.basis.shape[2]),
            "largest": 1e6,
        }
        return Goal(**(values | changes))


def smooth_bed(
    seed: int, *, segments: int = 12, positions: int = 1, torques: tuple[float, ...] = (4e5,), terms: int = 2,
    winkler: bool = False,
) -> Bed:  # fmt: skip
    """Crowned, tilted lines of contact on springs with a smooth coupling; the terms are powers along the line [um]."""
    rng = np.random.default_rng(seed)
    x = np.linspace(-1.0, 1.0, segments)
    crowning = rng.uniform(0.015, 0.04, (positions, 1)) * (x - rng.uniform(-0.5, 0.5, (positions, 1))) ** 2
    separation = crowning + 5e-4 * rng.standard_normal((positions, segments))
    coupling = 0.0 if winkler else 4e-7
    smooth = coupling * np.exp(-((x[:, None] - x[None, :]) ** 2) / 0.3)
    compliance = np.stack([smooth + np.diag(rng.uniform(1e-6, 2e-6, segments)) for _ in range(positions)])
    powers = np.stack([x ** (j + 1) for j in range(terms)], axis=-1)
    basis = 1e-3 * np.stack([powers + 0.1 * rng.standard_normal(powers.shape) for _ in range(positions)])
    return Bed(
        separation,
        basis,
        rng.uniform(60.0, 80.0, (positions, segments)),
        compliance,
        np.array(torques),
        rng.uniform(0.8, 1.2, segments),
        rng.uniform(0.02, 0.03, segments),
    )
