"""The problems of the library from the shipped cases: geometry, contact lines, compliance, solution."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from typing import Any

from ...cases.conversion import elastic_model
from ...cases.reading import read_case
from ...contact.mesh_cycle import MeshCycle
from ...contact.problem.contact_problem import ContactProblem
from ...core.checks import instance, shown
from ...core.errors import GeometryError, InputError
from ...geometry.pair.assembly import Misalignment
from ...geometry.pair.gear_pair import pair_geometry
from ..case_in_mesh import prepared_pair
from .library_entries import MESH_POSITIONS, Entry, Source
from .problem_changes import CHANGES


def generate(entries: Iterable[Entry]) -> Iterator[tuple[Entry, ContactProblem]]:
    """Make problems of the library, one after the other.

    Parameters
    ----------
    entries
        Entries to make; entries of one geometry or one source share the work.

    Yields
    ------
    tuple
        The entry and its problem. The same machine and libraries make the same numbers to the bit; others make them
        to rounding, and a compliance factor only up to a rotation of its columns.

    Raises
    ------
    GeometryError
        The source has no certified solution, whose compliance could be taken.

    Examples
    --------
    >>> from easeoff.study.library import entries
    >>> entry, problem = next(generate(entries()))
    >>> problem.separation.size > 0
    True
    """
    cycles: dict[Any, MeshCycle] = {}
    real: dict[Source, ContactProblem] = {}
    try:
        given = iter(entries)
    except TypeError as error:
        raise InputError(f"entries = {shown(entries)}: must be a list of entries") from error
    for entry in given:
        instance("entry", entry, Entry)
        source = entry.source
        if source not in real:
            key = (source.case, source.flank, source.offset_error, source.pinion_axial_error)
            if key not in cycles:
                cycles[key] = _cycle(source)
            real[source] = _real_problem(cycles[key], source)
        problem = real[source]
        if entry.change:
            problem = CHANGES[entry.change](problem, entry.amount)
        if entry.dense:
            problem = dense(problem)
        yield entry, problem


def dense(problem: ContactProblem) -> ContactProblem:
    """The same problem with its compliance as a matrix.

    Examples
    --------
    >>> import numpy as np
    >>> given = np.array([1e-6, 2e-6]), np.array([[1e-3], [1e-3]])  # diagonal and factor
    >>> dense(ContactProblem(np.zeros(2), np.ones(2), 1.0, given)).compliance.shape
    (2, 2)
    """
    return ContactProblem(problem.separation, problem.lever_arm, problem.torque, problem.dense_compliance)


def _cycle(source: Source) -> MeshCycle:
    """The pair of a source in mesh, its teeth as shells: the library stays what it is, whatever a case defaults to."""
    case = read_case(source.case)
    pair = prepared_pair(case, source.flank, Misalignment(source.offset_error, source.pinion_axial_error))
    geometry = pair_geometry(pair, (case.contact.lengthwise_nodes, case.contact.profile_nodes))
    return MeshCycle.of(geometry, elastic_model(case, None), mesh_positions=MESH_POSITIONS)


def _real_problem(cycle: MeshCycle, source: Source) -> ContactProblem:
    """The linear problem with the secant compliance at the solution of the nonlinear one."""
    found = cycle.at(source.mesh_position).with_segments(source.segments_per_line).solved([source.torque], "native")
    if not found:
        raise GeometryError(f"{source}: no tooth pair can touch there")
    (solved,) = found
    if not solved.solution.certified:
        raise GeometryError(f"{source}: {solved.solution.status.name} {solved.solution.message}")
    return solved.problem
