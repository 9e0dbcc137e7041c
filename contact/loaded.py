"""Loaded contact over a mesh cycle: forces, pressures, transmission error at every torque (Kolivand 2009, ch. 3)."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
import xarray as xr
from numpy.typing import NDArray

from ..core.errors import InputError
from .compliance import WeberLineContact
from .compliance.elastic_model import MEMBERS, ElasticModel, ElasticTooth, elastic_teeth, tooth_fields, whitened_loads
from .line_contact.line_contact_law import LineContacts, solve_line_contacts
from .line_contact.line_contact_solution import solve_on_bending
from .lines.closest_approach import closest_approach
from .lines.contact_lines import contact_splines
from .lines.flank_splines import FlankSplines
from .lines.mesh_edges import MeshEdges, edges_in_mesh
from .lines.mesh_lines import MeshLines, gauss_points
from .lines.opposite_points import PASSING_FIELDS
from .loaded_cases import LoadedCase, Segments, loaded_dataset
from .problem.modal_basis import basis_of_blocks
from .solvers import Status, require_solver

Array = NDArray[Any]
SMALLEST_DEPTH = 0.05  # [mm]; nearer to a sharp edge than this there is no half space for a line contact
NEAREST = 1e-5  # [rad]; where a search without any rotation to go by begins
FARTHEST = 0.02  # [rad]; a pair that turns so far meets nothing any more
REACH = 1.1  # times the rotation within which an edge must be met to be taken in
SMALLEST_CURVATURE = 1e-5  # [1/mm]; flanks that fit closer than this make no line contact, and a wider band is no harm


def all_segments(
    fields: FlankSplines,
    teeth: xr.Dataset,
    model: ElasticModel,
    mesh: MeshLines,
    count: int,
    elastic: tuple[ElasticTooth, ElasticTooth] | None = None,
) -> list[Segments | None]:
    """Segments of the contact lines at every mesh position, with their compliance.

    Parameters
    ----------
    fields
        Splines of ``loaded_splines``.
    teeth
        The geometry's ``teeth``.
    model
        How the teeth give way.
    mesh
        Contact lines from ``lines_in_mesh``.
    count
        Segments per contact line.
    elastic
        ``elastic_teeth`` of these teeth, where they are known.

    Returns
    -------
    list
        One entry a mesh position; ``None`` where no tooth pair can touch.
    """
    lines = _on_lines(fields, elastic or elastic_teeth(teeth, model), mesh, count)
    return _by_position(lines, model, mesh.rotations.size)


def _by_position(rows: dict[str, Array], model: ElasticModel, positions: int) -> list[Segments | None]:
    """Rows of a table of segments, see ``_on_lines``, parted by mesh position."""
    result: list[Segments | None] = []
    for k in range(positions):
        chosen = np.flatnonzero(rows["position"] == k)
        if chosen.size == 0:
            result.append(None)
            continue
        here = {name: values[..., chosen] for name, values in rows.items()}
        pairs = here["pair"]
        # Segments on different teeth are coupled through the blanks alone, which are taken as rigid.
        blocks = [np.flatnonzero(pairs == pair) for pair in np.unique(pairs)]
        bending = basis_of_blocks(pairs.size, blocks, [here["load"][:, own].T for own in blocks])
        depths = [np.maximum(here[f"depth_{member}"], SMALLEST_DEPTH) for member in MEMBERS]
        contact = WeberLineContact(
            here["length"],
            1.0 / np.maximum(here["curvature"], SMALLEST_CURVATURE),
            depths[0],
            depths[1],
            model.pinion,
            model.gear,
            model.foot_correction,
            overhang=here["overhang"],
        )
        place, angle, arm, searched = (here[name] for name in ("place", "separation_angle", "lever_arm", "searched"))
        result.append(Segments(pairs, place, angle, arm, bending, contact, searched))
    return result


def _on_lines(
    fields: FlankSplines, elastic: tuple[ElasticTooth, ElasticTooth], mesh: MeshLines, count: int
) -> dict[str, Array]:
    """Table of the segments on contact lines, their number last; ``load`` has their whitened unit loads."""
    lines = mesh.lines
    points, weights = gauss_points(lines, count)
    closest = closest_approach(fields, points)
    averaged = {
        "separation_angle": closest.separation_angle,
        "lever_arm": closest.lever_arm,
        "curvature": closest.curvature,
        **fields.evaluate(["depth_pinion", "depth_gear"], points),
    }
    shape = (-1, weights.size)
    whitened = whitened_loads(elastic, fields, np.reshape(points, (2, *shape)), weights)
    return {name: np.reshape(v, shape) @ weights for name, v in averaged.items()} | {
        "position": np.repeat(mesh.position, count),
        "pair": np.repeat(mesh.pair, count),
        "place": np.reshape(points, (2, *shape)) @ weights,
        "searched": np.any(~np.reshape(closest.expanded, shape), axis=-1),
        "length": np.repeat(lines.length / count, count),
        "overhang": np.full(lines.level.size * count, np.nan),
        "load": whitened,
    }


def _on_edges(fields: FlankSplines, elastic: tuple[ElasticTooth, ElasticTooth], edges: MeshEdges) -> dict[str, Array]:
    """The same of the pieces of edges."""
    found = edges.elements
    names = ("separation_angle", "lever_arm", "curvature", "length", "overhang")
    return {name: getattr(found, name) for name in names} | {
        **fields.evaluate(["depth_pinion", "depth_gear"], found.points),
        "position": edges.position,
        "pair": edges.pair,
        "place": found.points,
        "searched": np.zeros(edges.pair.size, dtype=bool),
        "load": whitened_loads(elastic, fields, found.points[..., None], np.ones(1)),
    }


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


def loaded_splines(flanks: xr.Dataset, ease_off: xr.Dataset, teeth: xr.Dataset) -> FlankSplines:
    """Splines of everything the loaded contact needs on the gear flank."""
    passing = {name: ease_off[name].transpose("lengthwise", "profile").values for name in PASSING_FIELDS}
    return contact_splines(flanks, ease_off, tooth_fields(teeth) | passing)


def loaded_contact(
    fields: FlankSplines,
    teeth: xr.Dataset,
    mesh: MeshLines,
    *,
    ratio: float,
    torques: Array,
    model: ElasticModel | None = None,
    segments_per_line: int = 31,
    edge_contact: bool = False,
    solver: str = "auto",
    progress: Callable[[], None] | None = None,
    **options: Any,
) -> tuple[xr.Dataset, list[LoadedCase]]:
    """Loaded contact over one mesh cycle.

    Parameters
    ----------
    fields
        Splines from ``loaded_splines``.
    teeth
        The geometry's ``teeth``.
    mesh
        Contact lines from ``lines_in_mesh``.
    ratio
        Gear teeth over pinion teeth.
    torques
        Torques at the pinion (t) [N m].
    model
        How the teeth give way.
    segments_per_line
        Segments of a contact line.
    edge_contact
        Whether edges of the teeth may touch beside the contact lines.
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
    model = model or ElasticModel()
    elastic, positions = elastic_teeth(teeth, model), mesh.rotations.size
    lines = _on_lines(fields, elastic, mesh, segments_per_line)
    segments = _by_position(lines, model, positions)
    if not edge_contact:
        cases = solve_all(segments, torques, ratio, solver, options, progress)
        return loaded_dataset(segments, cases, torques, mesh.rotations), cases
    # What more touches can only hold the pair back: its rotation with contact on lines alone is the farthest.
    reached = _turned(solve_all(segments, np.array([torques.max()]), ratio, "auto", {}), positions)
    reached = REACH * np.where(reached > 0.0, reached, max(float(reached.max()), NEAREST))
    while True:
        edges = _on_edges(fields, elastic, edges_in_mesh(fields, mesh, reached))
        both = {name: np.concatenate([lines[name], edges[name]], axis=-1) for name in lines}
        segments = _by_position(both, model, positions)
        cases = solve_all(segments, torques, ratio, solver, options, progress)
        turned = _turned(cases, positions)
        # Where there is no line the pair turns until edges hold it, and may meet more of them than were looked for.
        turned[[here is None for here in segments]] = 2.0 * reached.max()
        if np.all((turned <= reached) | (reached > FARTHEST)):
            return loaded_dataset(segments, cases, torques, mesh.rotations), cases
        reached, progress = np.maximum(reached, REACH * turned), None


def _turned(cases: list[LoadedCase], positions: int) -> Array:
    """Greatest rotation at every mesh position [rad]; zero where nothing was solved."""
    turned = np.zeros(positions)
    for case in cases:
        if case.solution.certified:
            turned[case.mesh_position] = max(turned[case.mesh_position], case.solution.rotation)
    return turned
