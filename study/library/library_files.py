"""Library files: the problems of a part with their labels and reference answers, checked and written."""

from __future__ import annotations

import os
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import xarray as xr

from ...contact.problem.answer import Answer
from ...contact.problem.certificate import EXACT_TOLERANCE
from ...contact.problem.contact_problem import ContactProblem
from ...contact.problem.exchange.problem_checksum import problem_checksum, set_checksum
from ...contact.problem.exchange.problem_file import write_problems
from ...contact.solvers import ContactSolution, solve
from ...core.attributes import labelled
from ...core.errors import InputError
from ...core.output_file import check_folder, check_writable
from ...core.process_settings import one_blas_thread
from .library_entries import LIBRARY_VERSION, MESH_POSITIONS, PARTS, USUAL_PARTS, Entry, entries
from .problem_generation import generate
from .reference_answers import ReferenceAnswer, reference_answers

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
    """File of the library, and the check of its problems.

    Parameters
    ----------
    path
        Path of the file.
    problems
        Number of problems.
    worst_certificate
        Largest violation of a condition by the native solver.
    worst_difference
        Largest relative difference of a rotation from the reference.
    faults
        One line a problem that is not certified or differs from its reference answer.

    Examples
    --------
    >>> LibraryFile(Path("small.nc"), 117, 1e-14, 1e-13, ()).path.stem
    'small'
    """

    path: Path
    problems: int
    worst_certificate: float
    worst_difference: float
    faults: tuple[str, ...]


@one_blas_thread()
def write_library(
    folder: str | os.PathLike[str],
    parts: Iterable[str] | None = None,
    *,
    progress: Callable[[], None] | None = None,
) -> list[LibraryFile]:
    """Make the problems of the library and write them, ``small.nc`` and so on.

    Parameters
    ----------
    folder
        Folder for the files; made if it does not exist.
    parts
        Names of ``PARTS``; ``USUAL_PARTS`` if left out.
    progress
        Called after every problem.

    Returns
    -------
    list of LibraryFile
        The files. Every problem has been solved by the native solver and compared with its reference answer. The files
        hold these solutions, forces and gaps.

    Raises
    ------
    InputError
        If a part is unknown, or the folder cannot be written to.

    Notes
    -----
    Linear algebra runs in one thread, which takes a third of the processor time; so the number of processors does not
    decide the last bits.

    Examples
    --------
    >>> write_library("library", ["tiny"])  # doctest: +ELLIPSIS
    Traceback (most recent call last):
    easeoff.core.errors.InputError: parts = tiny: must be one or more of small, medium, large, ...
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
    faults: list[str] = []
    certificates, differences = [0.0], [0.0]
    for entry, problem in generate(chosen):
        made.append((entry, problem))
        solution = solve(problem, "native")
        solutions.append(solution.answer)
        certificate, difference, fault = checked(problem, answers[entry.name], solution)
        certificates.append(certificate)
        differences.append(difference)
        faults += [fault] if fault else []
        if progress is not None:
            progress()
    problems = [problem for _, problem in made]
    write_problems(
        problems,
        path,
        labels([entry for entry, _ in made], answers, problems),
        {
            "title": f"easeoff library of contact problems, part {path.stem}",
            "library_version": LIBRARY_VERSION,
            "citation": CITATION,
            "license": "BSD-3-Clause",
            "checksum": set_checksum([entry.name for entry, _ in made], problems),
        },
        answers=solutions,
    )
    return LibraryFile(path, len(made), max(certificates), max(differences), tuple(faults))


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
