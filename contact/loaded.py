"""Loaded contact over a mesh cycle: forces, pressures, transmission error at every torque (Kolivand 2009, ch. 3)."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
import xarray as xr
from numpy.typing import NDArray

from ..core.errors import InputError
from .bending import ElasticModel, ElasticTooth, elastic_teeth, tooth_fields, whitened_loads
from .compliance import WeberLineContact
from .curves import contact_fields
from .fields import FlankFields
from .line_contact_batch import LineContacts, solve_line_contacts
from .line_contact_solution import solve_on_bending
from .loaded_cases import LoadedCase, Segments, loaded_dataset
from .modal_basis import basis_of_blocks
from .segments import MeshLines, closest_approach, gauss_points
from .solvers import Status, require_solver

Array = NDArray[Any]
SMALLEST_DEPTH = 0.05  # [mm]; nearer to a sharp edge than this there is no half space for a line contact
SMALLEST_CURVATURE = 1e-5  # [1/mm]; flanks that fit closer than this make no line contact, and a wider band is no harm


def all_segments(
    fields: FlankFields,
    teeth: xr.Dataset,
    model: ElasticModel,
    mesh: MeshLines,
    count: int,
    elastic: tuple[ElasticTooth, ElasticTooth] | None = None,
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
    elastic
        ``bending.elastic_teeth`` of these teeth, where they are known.

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
    whitened = whitened_loads(elastic or elastic_teeth(teeth, model), fields, per_segment, weights).T
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
        # Segments on different teeth are coupled through the blanks alone, which are taken as rigid.
        rows = [np.flatnonzero(pairs == pair) for pair in np.unique(pairs)]
        bending = basis_of_blocks(pairs.size, rows, [whitened[columns[own]] for own in rows])
        lengths = length[chosen].ravel()
        radii = 1.0 / np.maximum(curvature, SMALLEST_CURVATURE)
        depth_p, depth_g = (np.maximum(depth, SMALLEST_DEPTH) for depth in (pinion_depth, gear_depth))
        contact = WeberLineContact(lengths, radii, depth_p, depth_g, model.pinion, model.gear, model.foot_correction)
        result.append(Segments(pairs, place[:, chosen].reshape(2, -1), angles, arms, lengths, radii, bending, contact))
    return result


def solve_all(
    segments: list[Segments | None],
    torques: Array,
    ratio: float,
    solver: str,
    options: dict[str, Any],
    progress: Callable[[], None] | None = None,
) -> list[LoadedCase]:
    """Solve every torque at every mesh position where a tooth pair can touch, each torque starting from the one before.

    Parameters
    ----------
    segments
        From ``all_segments``.
    torques
        Torques at the pinion (t) [N m].
    ratio
        Gear teeth over pinion teeth.
    solver
        Name of the solver; the native one takes all mesh positions at once.
    options
        Passed to the solver.
    progress
        Called for every torque and mesh position.
    """
    present = [(k, here) for k, here in enumerate(segments) if here is not None]
    together = require_solver(solver) == "native" and not options
    contacts = LineContacts([here.line_contact for _, here in present]) if together else None
    starts: list[Array | None] = [None] * len(present)
    cases = []
    for index in np.argsort(torques, kind="stable"):
        problems = [here.bending_problem.with_torque(1e3 * ratio * float(torques[index])) for _, here in present]
        known = [None] * len(present) if contacts is None else solve_line_contacts(problems, contacts, starts)
        for i, ((k, here), problem, found) in enumerate(zip(present, problems, known, strict=True)):
            solution, secant = found or solve_on_bending(
                problem, here.line_contact, solver, initial_force=starts[i], **options
            )
            starts[i] = solution.force if solution.status == Status.CERTIFIED else None
            cases.append(LoadedCase(int(index), k, here, solution, secant))
            if progress is not None:
                progress()
    return sorted(cases, key=lambda case: (case.mesh_position, float(torques[case.torque])))


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
        Called for every torque and mesh position where a tooth pair can touch.
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
    cases = solve_all(segments, torques, ratio, solver, options, progress)
    return loaded_dataset(segments, cases, torques, mesh.rotations), cases
