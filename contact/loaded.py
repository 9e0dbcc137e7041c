"""Loaded contact over a mesh cycle: forces, pressures, transmission error at every torque (Kolivand 2009, ch. 3)."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from typing import Any

import numpy as np
import xarray as xr
from numpy.typing import NDArray

from ..core.errors import InputError
from .bending import ElasticModel, elastic_teeth, tooth_fields, whitened_loads
from .compliance import WeberLineContact
from .curves import contact_fields
from .fields import FlankFields
from .line_contact_solution import solve_line_contact
from .loaded_cases import LoadedCase, Segments, loaded_dataset
from .segments import MeshLines, closest_approach, gauss_points
from .solvers import Status

Array = NDArray[Any]
SMALLEST_DEPTH = 0.05  # [mm]; nearer to a sharp edge than this there is no half space for a line contact
SMALLEST_CURVATURE = 1e-5  # [1/mm]; flanks that fit closer than this make no line contact, and a wider band is no harm


def all_segments(
    fields: FlankFields, teeth: xr.Dataset, model: ElasticModel, mesh: MeshLines, count: int
) -> list[Segments | None]:
    """Segments of every mesh position, with their compliance.

    Parameters
    ----------
    fields
        Splines of ``curves.contact_fields`` and ``bending.tooth_fields``.
    teeth
        The geometry's ``teeth``.
    model
        How the teeth give way.
    mesh
        Contact lines from ``segments.lines_in_mesh``.
    count
        Segments per contact line.

    Returns
    -------
    list
        One entry a mesh position; ``None`` where no tooth pair can touch.
    """
    lines = mesh.lines
    points, weights = gauss_points(lines, count)
    closest = closest_approach(fields, points)
    # Two depths and all segments at once: the splines cost more to call than to evaluate.
    shape = (lines.level.size, count, weights.size)
    depths = fields.evaluate(["depth_pinion", "depth_gear"], points)
    averaged = (closest.separation_angle, closest.lever_arm, closest.curvature, *depths.values())
    means = [np.reshape(v, shape) @ weights for v in averaged]
    place = np.reshape(points, (2, *shape)) @ weights
    per_segment = np.reshape(points, (2, -1, weights.size))
    whitened = whitened_loads(elastic_teeth(teeth, model), fields, per_segment, weights)
    length = np.repeat(lines.length / count, count).reshape(shape[:2])
    result: list[Segments | None] = []
    for k in range(mesh.rotations.size):
        chosen = np.flatnonzero(mesh.position == k)
        if chosen.size == 0:
            result.append(None)
            continue
        angles, arms, curvature, pinion_depth, gear_depth = (m[chosen].ravel() for m in means)
        columns = (chosen[:, None] * count + np.arange(count)).ravel()
        pairs = np.repeat(mesh.pair[chosen], count)
        factor = whitened[:, columns]
        # Segments on different teeth are coupled through the blanks alone, which are taken as rigid.
        bending = np.where(pairs[:, None] == pairs[None, :], factor.T @ factor, 0.0)
        lengths = length[chosen].ravel()
        radii = 1.0 / np.maximum(curvature, SMALLEST_CURVATURE)
        depth_p, depth_g = (np.maximum(depth, SMALLEST_DEPTH) for depth in (pinion_depth, gear_depth))
        contact = WeberLineContact(lengths, radii, depth_p, depth_g, model.pinion, model.gear)
        result.append(Segments(pairs, place[:, chosen].reshape(2, -1), angles, arms, lengths, radii, bending, contact))
    return result


def solve_all(
    segments: list[Segments | None], torques: Array, ratio: float, solver: str, options: dict[str, Any]
) -> Iterator[LoadedCase | tuple[int, int]]:
    """Solve every torque at every mesh position, each torque starting from the one before.

    Yields
    ------
    LoadedCase or tuple
        The case, or (torque, mesh position) where no tooth pair can touch.
    """
    order = np.argsort(torques)
    for k, here in enumerate(segments):
        start: Array | None = None
        for index in order:
            if here is None:
                yield int(index), k
                continue
            solution, problem = solve_line_contact(
                here.separation,
                here.lever_arm,
                1e3 * ratio * float(torques[index]),
                here.bending,
                here.line_contact,
                solver,
                initial_force=start,
                **options,
            )
            start = solution.force if solution.status == Status.CERTIFIED else None
            yield LoadedCase(int(index), k, here, solution, problem)


def loaded_fields(flanks: xr.Dataset, ease_off: xr.Dataset, teeth: xr.Dataset) -> FlankFields:
    """Splines of everything the loaded contact needs on the gear flank."""
    return contact_fields(flanks, ease_off, tooth_fields(teeth))


def loaded_contact(
    fields: FlankFields,
    teeth: xr.Dataset,
    mesh: MeshLines,
    *,
    ratio: float,
    torques: Array,
    model: ElasticModel | None = None,
    segments_per_line: int = 31,
    solver: str = "auto",
    progress: Callable[[], None] | None = None,
    **options: Any,
) -> tuple[xr.Dataset, list[LoadedCase]]:
    """Loaded contact over one mesh cycle.

    Parameters
    ----------
    fields
        Splines from ``loaded_fields``.
    teeth
        The geometry's ``teeth``.
    mesh
        Contact lines from ``segments.lines_in_mesh``.
    ratio
        Gear teeth over pinion teeth.
    torques
        Torques at the pinion (t) [N m].
    model
        How the teeth give way.
    segments_per_line
        Segments of a contact line.
    solver
        Name of the solver, see ``solvers.available_solvers``.
    progress
        Called after every solved case.
    **options
        Passed to the solver.

    Returns
    -------
    tuple
        The dataset over (torque, mesh_position, segment), and every case with its contact problem.

    Raises
    ------
    InputError
        If a torque is not positive.
    """
    torques = np.asarray(torques, dtype=float)
    if torques.size == 0 or not np.all(np.isfinite(torques) & (torques > 0.0)):
        raise InputError(f"torques = {torques.tolist()}: every torque must be a positive number in N m")
    segments = all_segments(fields, teeth, model or ElasticModel(), mesh, segments_per_line)
    cases = []
    for case in solve_all(segments, torques, ratio, solver, options):
        if isinstance(case, LoadedCase):
            cases.append(case)
        if progress is not None:
            progress()
    return loaded_dataset(segments, cases, torques, mesh.rotations), cases
