"""Loaded contact of a pair under any low-order modification of its ease-off, and how the loads change with it."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np
import xarray as xr
from numpy.typing import NDArray

from ...geometry.pair.gear_pair import PairGeometry
from ...geometry.pair.modification import Modification, basis, modified_ease_off
from ..compliance.elastic_model import ElasticModel, ElasticTooth, elastic_teeth
from ..lines.closest_approach import closest_approach
from ..lines.flank_splines import FlankSplines
from ..lines.mesh_lines import MeshLines, gauss_points, lines_in_mesh
from ..loaded import all_segments, loaded_splines, solve_all
from ..loaded_cases import Segments
from ..solvers import Status
from .load_response import LoadResponse, held_in_contact, load_response, stacked

Array = NDArray[Any]


def separation_slopes(fields: FlankSplines, mesh: MeshLines, count: int, names: tuple[str, ...]) -> list[Array]:
    """Derivatives of every segment's separation by the coefficients of a modification.

    A gap at its smallest does not change, to first order, with the place where it is taken: the derivative is the
    modification itself at the closest approach.

    Parameters
    ----------
    fields
        Splines from ``loaded_splines``.
    mesh
        Contact lines.
    count
        Segments per line.
    names
        Terms of the modification (p).

    Returns
    -------
    list
        One array (n, p) [mm/um] a mesh position, in the order of ``loaded.all_segments``.
    """
    points, weights = gauss_points(mesh.lines, count)
    closest = closest_approach(fields, points)
    place = points + closest.shift
    by_angle = 1e-3 * basis(names, place[0], place[1]) / fields("lever_arm", place)[..., None]
    shape = (mesh.lines.level.size, count, weights.size)
    slopes = np.einsum("mcgp,g->mcp", by_angle.reshape(*shape, len(names)), weights)
    slopes *= (closest.lever_arm.reshape(shape) @ weights)[..., None]
    return [slopes[mesh.position == k].reshape(-1, len(names)) for k in range(mesh.rotations.size)]


@dataclass(frozen=True)
class ModifiedContact:
    """A pair whose ease-off may be modified.

    Parameters
    ----------
    geometry
        The pair as it is.
    mesh
        Its contact lines, which a modification leaves where they are.
    ratio
        Gear teeth over pinion teeth.
    torques
        Torques at the pinion (t) [N m].
    model
        How the teeth give way.
    segments_per_line
        Segments of a contact line.
    names
        Terms of the modification (p).
    solver
        Name of the contact solver.
    """

    geometry: PairGeometry
    mesh: MeshLines
    ratio: float
    torques: Array
    model: ElasticModel
    segments_per_line: int
    names: tuple[str, ...]
    solver: str = "auto"

    @classmethod
    def of(
        cls, geometry: PairGeometry, pinion_teeth: int, ratio: float, mesh_positions: int, **options: Any
    ) -> ModifiedContact:
        """Trace the contact lines of a pair; the options are the other fields."""
        fields = _fields(geometry, geometry.ease_off)
        mesh = lines_in_mesh(fields, 2.0 * np.pi / pinion_teeth, mesh_positions)
        return cls(geometry, mesh, ratio, **options)

    def modification(self, coefficients: Array) -> Modification:
        """The modification with these coefficients (p) [um]."""
        return Modification(dict(zip(self.names, map(float, coefficients), strict=True)))

    def loads(self, coefficients: Array, cycle: int = 0) -> LoadResponse | None:
        """Solve the loaded contact afresh, certified, and find how it changes with the coefficients.

        Parameters
        ----------
        coefficients
            Of the modification (p) [um].
        cycle
            Number of the first torque's mesh cycle.

        Returns
        -------
        LoadResponse or None
            ``None`` if a torque has a mesh position without a certified solution.
        """
        segments, slopes = self._segments(coefficients)
        cases = solve_all(segments, self.torques, self.ratio, self.solver, {})
        certified = sum(case.solution.status == Status.CERTIFIED for case in cases)
        if certified < self.torques.size * len(segments):
            return None
        parts = []
        for case in cases:
            here, solution = case.segments, case.solution
            outcome = solution.force, solution.gap, solution.rotation
            local, slope = here.line_contact.tangent(solution.force), slopes[case.mesh_position]
            parts.append(self._linear(here, _compliance(here, local), outcome, slope, cycle + case.torque))
        return stacked(parts)

    def held(self, coefficients: Array, cycle: int = 0) -> LoadResponse:
        """As ``loads``, all segments held in contact, with the local compliance of even load."""
        segments, slopes = self._segments(coefficients)
        parts = []
        for here, slope in zip(segments, slopes, strict=True):
            if here is None:
                continue
            for index, torque in enumerate(1e3 * self.ratio * self.torques):
                even = torque / float(here.lever_arm @ here.length) * here.length
                compliance = _compliance(here, here.line_contact.secant(even))
                force, rotation = held_in_contact(compliance, here.separation, here.lever_arm, torque)
                outcome = force, np.zeros(force.size), rotation
                parts.append(self._linear(here, compliance, outcome, slope, cycle + index, held=True))
        return stacked(parts)

    @cached_property
    def _elastic(self) -> tuple[ElasticTooth, ElasticTooth]:
        return elastic_teeth(self.geometry.teeth, self.model)

    def _segments(self, coefficients: Array) -> tuple[list[Segments | None], list[Array]]:
        ease_off = modified_ease_off(self.geometry.ease_off, self.modification(coefficients))
        fields, count = _fields(self.geometry, ease_off), self.segments_per_line
        segments = all_segments(fields, self.geometry.teeth, self.model, self.mesh, count, self._elastic)
        return segments, separation_slopes(fields, self.mesh, count, self.names)

    def _linear(
        self,
        here: Segments,
        compliance: Array,
        outcome: tuple[Array, Array, float],
        slope: Array,
        cycle: int,
        *,
        held: bool = False,
    ) -> LoadResponse:
        number = np.arange(here.length.size) % self.segments_per_line
        return load_response(
            compliance,
            here.lever_arm,
            *outcome,
            slope,
            length=here.length,
            curvature=1.0 / here.equivalent_radius,
            at_end=(number == 0) | (number == self.segments_per_line - 1),
            cycle=cycle,
            held=held,
        )


def _compliance(here: Segments, local: Array) -> Array:
    """Compliance (n, n) [mm/N] with this local part (n)."""
    factor = here.bending.factor
    return np.asarray(factor @ factor.T + np.diag(local))


def _fields(geometry: PairGeometry, ease_off: xr.Dataset) -> FlankSplines:
    return loaded_splines(geometry.flanks, ease_off, geometry.teeth)
