"""The problems of the library from the shipped cases: geometry, contact lines, compliance, solution."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from typing import Any

import numpy as np

from ...cases.conversion import elastic_model
from ...cases.reading import read_case
from ...contact.compliance.elastic_model import ElasticModel
from ...contact.lines.contact_lines import ContactLines
from ...contact.lines.flank_splines import FlankSplines
from ...contact.lines.mesh_lines import MeshLines, lines_in_mesh
from ...contact.loaded import all_segments, loaded_splines, solve_all
from ...contact.problem.contact_problem import ContactProblem
from ...core.errors import GeometryError
from ...geometry.pair.assembly import Misalignment
from ...geometry.pair.gear_pair import pair_geometry
from ..analysis import prepared_pair
from .library_entries import MESH_POSITIONS, Entry, Source
from .problem_changes import CHANGES


def generate(entries: Iterable[Entry]) -> Iterator[tuple[Entry, ContactProblem]]:
    """Make problems of the library, one after the other.

    Parameters
    ----------
    entries
        What to make; entries of one geometry or one source share the work.

    Yields
    ------
    tuple
        The entry and its problem. The same machine and libraries make the same numbers to the bit; others make them
        to rounding, and a compliance factor only up to a rotation of its columns.

    Raises
    ------
    GeometryError
        The source has no certified solution, whose compliance could be taken.
    """
    meshes: dict[Any, _Mesh] = {}
    real: dict[Source, ContactProblem] = {}
    for entry in entries:
        source = entry.source
        if source not in real:
            key = (source.case, source.flank, source.offset_error, source.pinion_axial_error)
            if key not in meshes:
                meshes[key] = _mesh(source)
            real[source] = _real_problem(meshes[key], source)
        problem = real[source]
        if entry.change:
            problem = CHANGES[entry.change](problem, entry.amount)
        if entry.dense:
            problem = dense(problem)
        yield entry, problem


def dense(problem: ContactProblem) -> ContactProblem:
    """The same problem with its compliance as a matrix."""
    return ContactProblem(problem.separation, problem.lever_arm, problem.torque, problem.dense_compliance)


@dataclass(frozen=True)
class _Mesh:
    """What all instants of a pair have in common."""

    fields: FlankSplines
    teeth: Any
    model: ElasticModel
    ratio: float
    lines: MeshLines


def _mesh(source: Source) -> _Mesh:
    case = read_case(source.case)
    pair = prepared_pair(case, source.flank, Misalignment(source.offset_error, source.pinion_axial_error))
    geometry = pair_geometry(pair, (case.contact.lengthwise_nodes, case.contact.profile_nodes))
    fields = loaded_splines(geometry.flanks, geometry.ease_off, geometry.teeth)
    lines = lines_in_mesh(fields, pair.assembly.pinion_pitch, MESH_POSITIONS)
    return _Mesh(fields, geometry.teeth, elastic_model(case), pair.assembly.ratio, lines)


def _real_problem(mesh: _Mesh, source: Source) -> ContactProblem:
    """The linear problem with the secant compliance at the solution of the nonlinear one."""
    instant = _instant(mesh.lines, source.mesh_position)
    (segments,) = all_segments(mesh.fields, mesh.teeth, mesh.model, instant, source.segments_per_line)
    if segments is None:
        raise GeometryError(f"{source}: no tooth pair can touch there")
    (solved,) = solve_all([segments], np.array([source.torque]), mesh.ratio, "native", {})
    if not solved.solution.certified:
        raise GeometryError(f"{source}: {solved.solution.status.name} {solved.solution.message}")
    return solved.problem


def _instant(mesh: MeshLines, position: int) -> MeshLines:
    """The contact lines of one pinion rotation."""
    chosen = np.flatnonzero(mesh.position == position)
    every = mesh.lines
    lines = ContactLines(every.level[chosen], every.points[:, chosen], every.length[chosen])
    return MeshLines(
        mesh.rotations[position : position + 1],
        lines,
        np.zeros(chosen.size, dtype=np.int64),
        mesh.pair[chosen],
        mesh.pinion_pitch,
    )
