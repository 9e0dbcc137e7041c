"""Loaded contact of a pair under any low-order modification of its ease-off, and the change of its loads."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np

from ...core.arrays import Array, record
from ...geometry.pair.modification import Modification, basis, modified_ease_off
from ..mesh_cycle import MeshCycle
from ..problem.compliance_matrix import ModalCompliance
from ..segments import Segments
from ..solvers import Status
from .convex_programme import LoadResponse, held_in_contact, load_response, stacked


def separation_slopes(cycle: MeshCycle, names: tuple[str, ...]) -> list[Array]:
    """Derivatives (n, p) [mm/um] of segments' separations by the terms of a modification, by mesh position.

    To first order a smallest gap does not change with its place: it is the modification itself at the closest approach.
    """
    points, weights = cycle.segments.on_lines.quadrature
    closest, lines = cycle.segments.closest, cycle.lines
    point = points + closest.shift
    by_angle = 1e-3 * basis(names, point[0], point[1]) / cycle.fields("lever_arm", point)[..., None]
    shape = (lines.lines.level.size, cycle.segments_per_line, weights.size)
    slopes = np.einsum("mcgp,g->mcp", by_angle.reshape(*shape, len(names)), weights)
    slopes *= (closest.lever_arm.reshape(shape) @ weights)[..., None]
    return [slopes[lines.position == k].reshape(-1, len(names)) for k in range(lines.rotations.size)]


@record(frozen=True)
class ModifiedContact:
    """A pair whose ease-off may be modified, with contact on lines."""

    cycle: MeshCycle
    torques: Array  # at the pinion (t) [N m]
    names: tuple[str, ...]  # terms of the modification (p)
    solver: str = "auto"

    def modification(self, coefficients: Array) -> Modification:
        """The modification with these coefficients (p) [um]."""
        return Modification(dict(zip(self.names, map(float, coefficients), strict=True)))

    def loads(self, coefficients: Array, cycles: Sequence[int] | None = None) -> LoadResponse | None:
        """Solve the loaded contact afresh at coefficients (p) [um], certified, with its changes by these.

        ``None`` if a torque has a mesh position without a certified solution. ``cycles`` number the torques' mesh
        cycles (t).
        """
        modified, slopes = self._modified(coefficients)
        cases = modified.solved(self.torques, self.solver)
        certified = sum(case.solution.status == Status.CERTIFIED for case in cases)
        if certified < self.torques.size * len(slopes):
            return None
        parts = []
        for case in cases:
            segments, solution = case.segments, case.solution
            compliance = ModalCompliance(segments.line_contact.tangent(solution.force), segments.bending)
            outcome = solution.force, solution.gap, solution.rotation, slopes[case.mesh_position]
            number = case.torque if cycles is None else cycles[case.torque]
            parts.append(load_response(compliance, *outcome, **self._segments(segments), cycle=number))
        return stacked(parts)

    def full_contact(self, coefficients: Array, cycles: Sequence[int] | None = None) -> LoadResponse:
        """As ``loads``, all segments held in contact, with the local compliance of even load."""
        modified, slopes = self._modified(coefficients)
        parts = []
        for segments, slope in zip(modified.segments.by_position, slopes, strict=True):
            if segments is None:
                continue
            for index, torque in enumerate(1e3 * self.cycle.ratio * self.torques):
                even = torque / float(segments.lever_arm @ segments.length) * segments.length
                compliance = ModalCompliance(segments.line_contact.secant(even), segments.bending)
                force, rotation = held_in_contact(compliance, segments.separation, segments.lever_arm, torque)
                outcome = force, np.zeros(force.size), rotation, slope
                number = index if cycles is None else cycles[index]
                parts.append(load_response(compliance, *outcome, **self._segments(segments), cycle=number, pull=True))
        return stacked(parts)

    def _modified(self, coefficients: Array) -> tuple[MeshCycle, list[Array]]:
        """The pair with a modification, and the slopes of its separations."""
        ease_off = modified_ease_off(self.cycle.geometry.ease_off, self.modification(coefficients))
        modified = self.cycle.with_ease_off(ease_off)
        return modified, separation_slopes(modified, self.names)

    def _segments(self, segments: Segments) -> dict[str, Any]:
        """Lever arms and line contact of segments, as ``load_response`` takes them."""
        count = self.cycle.segments_per_line
        number = np.arange(segments.length.size) % count
        at_end, curvature = (number == 0) | (number == count - 1), 1.0 / segments.equivalent_radius
        return {"lever_arm": segments.lever_arm, "length": segments.length, "curvature": curvature, "at_end": at_end}
