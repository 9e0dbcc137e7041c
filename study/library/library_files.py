"""Files of the library: the problems of a part with their labels and reference answers, made, checked and written.

Problems come from the shipped cases, and degenerate and badly conditioned ones by changes of these.
"""

from __future__ import annotations

import os
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
import xarray as xr

from ...cases.conversion import elastic_model
from ...cases.reading import read_case
from ...contact.mesh_cycle import MeshCycle
from ...contact.problem.certificate import EXACT_TOLERANCE, Answer
from ...contact.problem.contact_problem import ContactProblem
from ...contact.problem.exchange.problem_file import problem_checksum, set_checksum, write_problems
from ...contact.solvers import ContactSolution, solve
from ...core.arrays import RealArray as Array
from ...core.attributes import labelled
from ...core.checks import instance, shown
from ...core.errors import GeometryError, InputError
from ...core.output_file import check_folder, check_writable
from ...core.process_settings import one_blas_thread
from ...geometry.pair.assembly import Misalignment
from ...geometry.pair.gear_pair import pair_geometry
from ..case_in_mesh import prepared_pair
from .library_entries import (
    LIBRARY_VERSION,
    MESH_POSITIONS,
    PARTS,
    PINION_LAG,
    USUAL_PARTS,
    Entry,
    ReferenceAnswer,
    Source,
    entries,
    reference_answers,
)


def parts(problem: ContactProblem) -> tuple[Array, Array, float, Array, Array]:
    """Separation, lever arm, torque, local compliance and factor of a structured problem."""
    assert isinstance(problem.compliance, tuple)
    return problem.separation, problem.lever_arm, problem.torque, *problem.compliance


def zero_separation(problem: ContactProblem, _: float) -> ContactProblem:
    """All segments touch without load: S = 0."""
    s, r, t, d, v = parts(problem)
    return ContactProblem(np.zeros_like(s), r, t, (d, v))


def tied_separations(problem: ContactProblem, step: float) -> ContactProblem:
    """Separations rounded to multiples of a step [mm]."""
    s, r, t, d, v = parts(problem)
    return ContactProblem(step * np.round(s / step), r, t, (d, v))


def next_contact(problem: ContactProblem, _: float) -> ContactProblem:
    """Torque at which the next segment enters or leaves contact: F = Y = 0 there.

    Not below the problem's own. As long as the same segments touch, forces, gaps and rotation are linear in the torque.
    """
    active = solve(problem, "native").active
    touching = np.flatnonzero(active)
    arm, matrix = problem.lever_arm, problem.dense_compliance
    inner, zero = matrix[np.ix_(touching, touching)], np.zeros((1, 1))
    bordered = np.block([[inner, -arm[touching, None]], [arm[None, touching], zero]])
    rate = np.linalg.solve(bordered, np.r_[np.zeros(touching.size), 1.0])
    now = np.linalg.solve(bordered, np.r_[-problem.separation_at_first_contact[touching], problem.torque])
    force, force_rate = now[:-1], rate[:-1]
    gap = matrix[:, touching] @ force + problem.separation_at_first_contact - now[-1] * arm
    gap_rate = matrix[:, touching] @ force_rate - rate[-1] * arm
    level, slope = np.where(active, 0.0, gap), np.where(active, 0.0, gap_rate)
    level[touching], slope[touching] = force, force_rate
    falling = slope < 0.0
    if not falling.any():
        return problem
    return problem.with_torque(problem.torque + float((-level[falling] / slope[falling]).min()))


def scaled_torque(problem: ContactProblem, factor: float) -> ContactProblem:
    """Torque multiplied by a factor."""
    return problem.with_torque(factor * problem.torque)


def remote_segment(problem: ContactProblem, distance: float) -> ContactProblem:
    """Last segment farther away by a distance [mm]."""
    s, r, t, d, v = parts(problem)
    return ContactProblem(np.r_[s[:-1], s[-1] + distance], r, t, (d, v))


def shifted_rotation(problem: ContactProblem, rotation: float) -> ContactProblem:
    """Rotation counted from another zero [rad]."""
    s, r, t, d, v = parts(problem)
    return ContactProblem(s + rotation * r, r, t, (d, v))


def scaled_local_compliance(problem: ContactProblem, factor: float) -> ContactProblem:
    """Local compliance multiplied by a factor."""
    s, r, t, d, v = parts(problem)
    return ContactProblem(s, r, t, (factor * d, v))


def twin_segments(problem: ContactProblem, _: float) -> ContactProblem:
    """Every segment twice at the same point, each with a local compliance of its own."""
    s, r, t, d, v = parts(problem)
    twice = np.repeat(np.arange(problem.size), 2)
    return ContactProblem(s[twice], r[twice], t, (d[twice], v[twice]))


def copied_segments(problem: ContactProblem, _: float) -> ContactProblem:
    """Every segment twice with the same row of C: singular."""
    s, r, t, _d, _v = parts(problem)
    twice = np.repeat(np.arange(problem.size), 2)
    return ContactProblem(s[twice], r[twice], t, problem.dense_compliance[np.ix_(twice, twice)])


def copied_tooth_pairs(problem: ContactProblem, _: float) -> ContactProblem:
    """Every tooth pair twice, each with bending of its own."""
    s, r, t, d, v = parts(problem)
    nothing = np.zeros_like(v)
    return ContactProblem(np.tile(s, 2), np.tile(r, 2), t, (np.tile(d, 2), np.block([[v, nothing], [nothing, v]])))


def several_pinions(problem: ContactProblem, count: float) -> ContactProblem:
    """Several pinions on one gear, each 20 urad behind the one before."""
    s, r, t, d, v = parts(problem)
    number = int(count)
    separation = np.concatenate([s + lag * PINION_LAG * r for lag in range(number)])
    factor = np.kron(np.eye(number), v)
    return ContactProblem(separation, np.tile(r, number), number * t, (np.tile(d, number), factor))


def rigid_segment(problem: ContactProblem, _: float) -> ContactProblem:
    """No local compliance of the segment with the greatest force."""
    s, r, t, d, v = parts(problem)
    d = d.copy()
    d[np.argmax(solve(problem, "native").force)] = 0.0
    return ContactProblem(s, r, t, (d, v))


def rigid_half(problem: ContactProblem, _: float) -> ContactProblem:
    """No local compliance of every other segment."""
    s, r, t, d, v = parts(problem)
    return ContactProblem(s, r, t, (np.where(np.arange(s.size) % 2 == 0, d, 0.0), v))


def no_local_compliance(problem: ContactProblem, _: float) -> ContactProblem:
    """No local compliance: C = V V^T, of low rank."""
    s, r, t, d, v = parts(problem)
    return ContactProblem(s, r, t, (np.zeros_like(d), v))


def single_segment(problem: ContactProblem, _: float) -> ContactProblem:
    """Segment with the greatest force alone."""
    s, r, t, d, v = parts(problem)
    one = [int(np.argmax(solve(problem, "native").force))]
    return ContactProblem(s[one], r[one], t, (d[one], v[one]))


#: Changes by name: from a problem with structured compliance and an amount to another problem.
CHANGES: dict[str, Callable[[ContactProblem, float], ContactProblem]] = {
    change.__name__: change
    for change in (
        zero_separation,
        tied_separations,
        next_contact,
        scaled_torque,
        remote_segment,
        shifted_rotation,
        scaled_local_compliance,
        twin_segments,
        copied_segments,
        copied_tooth_pairs,
        several_pinions,
        rigid_segment,
        rigid_half,
        no_local_compliance,
        single_segment,
    )
}


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
    """The same problem with its compliance as a matrix."""
    return ContactProblem(problem.separation, problem.lever_arm, problem.torque, problem.dense_compliance)


def _cycle(source: Source) -> MeshCycle:
    """The pair of a source in mesh, its teeth as shells: the library stays what it is, whatever a case defaults to."""
    case = read_case(source.case)
    pair = prepared_pair(case, source.flank, Misalignment(source.offset_error, source.pinion_axial_error))
    geometry = pair_geometry(pair, (case.contact.lengthwise_nodes, case.contact.profile_nodes))
    return MeshCycle.of(geometry, elastic_model(case, None), mesh_positions=MESH_POSITIONS)


def _real_problem(cycle: MeshCycle, source: Source) -> ContactProblem:
    """The linear problem with the secant compliance at the solution of the nonlinear one."""
    cases = cycle.at(source.mesh_position).with_segments(source.segments_per_line).solved([source.torque], "native")
    if not cases:
        raise GeometryError(f"{source}: no tooth pair can touch there")
    (solved,) = cases
    if not solved.solution.certified:
        raise GeometryError(f"{source}: {solved.solution.status.name} {solved.solution.message}")
    return solved.problem


#: Largest relative difference from a reference rotation. Between the BLAS kernels for three kinds of processors it is
#: at most 1.4e-11 over small and medium problems.
ROTATION_TOLERANCE = 1e-8
#: How to cite the library, in its files.
CITATION = (
    f"easeoff library of contact problems, version {LIBRARY_VERSION}, made by the program easeoff. Give the version, "
    "the part and the checksum of the file."
)


@dataclass(frozen=True)
class LibraryFile:
    """File of the library, and the check of its problems."""

    path: Path
    problems: int
    worst_certificate: float  # largest violation of a condition by the native solver
    worst_difference: float  # largest relative difference of a rotation from the reference
    faults: tuple[str, ...]


@one_blas_thread()
def write_library(
    folder: str | os.PathLike[str], parts: Iterable[str] | None = None, *, progress: Callable[[], None] | None = None
) -> list[LibraryFile]:
    """Make the problems of ``parts``, else ``USUAL_PARTS``, and write them as ``small.nc`` and so on.

    Each is solved by the native solver, compared with its reference answer, and stored with solution, forces and gaps.
    Linear algebra runs in one thread: so the number of processors does not decide the last bits.
    """
    chosen = list(dict.fromkeys(USUAL_PARTS if parts is None else parts))
    unknown = [part for part in chosen if part not in PARTS]
    if unknown or not chosen:
        raise InputError(f"parts = {', '.join(chosen) or 'none'}: must be one or more of {', '.join(PARTS)}")
    target = Path(folder)
    check_folder(target, "library")
    paths = {part: target / f"{part}.nc" for part in chosen}
    for path in paths.values():
        check_writable(path)
    return [write_part([e for e in entries() if e.part == part], paths[part], progress) for part in chosen]


def write_part(chosen: Iterable[Entry], path: Path, progress: Callable[[], None] | None = None) -> LibraryFile:
    """Make, check and write problems of the library as one file."""
    answers = reference_answers()
    made: list[tuple[Entry, ContactProblem]] = []
    solutions: list[Answer] = []
    checks: list[tuple[float, float, str]] = [(0.0, 0.0, "")]
    for entry, problem in generate(chosen):
        made.append((entry, problem))
        solution = solve(problem, "native")
        solutions.append(solution.answer)
        checks.append(checked(problem, answers[entry.name], solution))
        if progress is not None:
            progress()
    given, problems = [entry for entry, _ in made], [problem for _, problem in made]
    attributes: dict[str, str | int | float] = {
        "title": f"easeoff library of contact problems, part {path.stem}",
        "library_version": LIBRARY_VERSION,
        "citation": CITATION,
        "license": "BSD-3-Clause",
        "checksum": set_checksum([entry.name for entry in given], problems),
    }
    write_problems(problems, path, labels(given, answers, problems), attributes, answers=solutions)
    certificates, differences, faults = zip(*checks, strict=True)
    return LibraryFile(path, len(made), max(certificates), max(differences), tuple(filter(None, faults)))


def checked(
    problem: ContactProblem, answer: ReferenceAnswer, solution: ContactSolution | None = None
) -> tuple[float, float, str]:
    """Worst violation, difference from the reference, and fault of the native solution of a problem."""
    solution = solve(problem, "native") if solution is None else solution
    certificate = solution.certificate.worst
    difference = abs(solution.elastic_rotation / answer.elastic_rotation - 1.0)
    touching = int(solution.active.sum())
    fault = ""
    if not solution.certificate.passes(EXACT_TOLERANCE):
        fault = f"{solution.status.name}, certificate {certificate:.1e}"
    elif problem.size != answer.size:
        fault = f"{problem.size} segments instead of {answer.size}"
    elif not difference <= ROTATION_TOLERANCE:
        fault = f"rotation differs from the reference by {difference:.1e}"
    elif answer.touching not in (-1, touching):
        fault = f"{touching} segments touch instead of {answer.touching}"
    return certificate, difference, f"{answer.name}: {fault}" if fault else ""


def labels(
    chosen: list[Entry], answers: Mapping[str, ReferenceAnswer], problems: Sequence[ContactProblem]
) -> dict[str, xr.DataArray]:
    """Labels of the problems, their reference answers and checksums, with units."""
    columns: dict[str, list[Any]] = {
        "name": [e.name for e in chosen],
        "kind": [e.kind for e in chosen],
        "case": [e.source.case for e in chosen],
        "flanks": [e.source.flank for e in chosen],
        "pinion_torque": [e.source.torque for e in chosen],
        "offset_error": [e.source.offset_error for e in chosen],
        "pinion_axial_error": [e.source.pinion_axial_error for e in chosen],
        "mesh_position": [e.source.mesh_position / MESH_POSITIONS for e in chosen],
        "segments_per_line": [e.source.segments_per_line for e in chosen],
        "change": [e.change for e in chosen],
        "amount": [e.amount for e in chosen],
        "sequence": [e.sequence for e in chosen],
        "sequence_step": [e.step for e in chosen],
        "checksum": [problem_checksum(problem) for problem in problems],
    }
    for name in ("elastic_rotation", "touching", "condition_number"):
        columns[name] = [getattr(answers[e.name], name) for e in chosen]
    dataset = labelled(xr.Dataset({name: ("problem", values) for name, values in columns.items()}))
    return {str(name): dataset[name] for name in dataset.data_vars}
