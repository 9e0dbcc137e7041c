"""The library on disk: a file a part, every problem with its labels and its reference answer, and checked by it."""

from __future__ import annotations

import os
from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import xarray as xr

from ...contact.problem.certificate import EXACT_TOLERANCE
from ...contact.problem.contact_problem import ContactProblem
from ...contact.problem.problem_file import write_problems
from ...contact.solvers import solve
from ...core.attributes import labelled
from ...core.errors import InputError
from ...core.files import check_folder, check_writable
from .library_entries import LIBRARY_VERSION, MESH_POSITIONS, PARTS, Entry, entries
from .problem_generation import generate
from .reference_answers import Answer, reference_answers

#: Relative difference from a reference rotation that is taken for rounding. Between the kernels of the BLAS for three
#: kinds of processors it is 3e-11 at most.
AGREEMENT = 1e-8


@dataclass(frozen=True)
class Written:
    """A file of the library and how its problems were found.

    Parameters
    ----------
    path
        The file.
    problems
        Their number.
    worst_certificate
        Largest violation in a certificate of the native solver.
    worst_difference
        Largest relative difference of a rotation from the reference.
    faults
        One line a problem that is not certified, or not the one the reference answer is for.
    """

    path: Path
    problems: int
    worst_certificate: float
    worst_difference: float
    faults: tuple[str, ...]


def write_library(
    folder: str | os.PathLike[str],
    parts: Iterable[str] | None = None,
    *,
    progress: Callable[[], None] | None = None,
) -> list[Written]:
    """Make the problems of the library and write them, ``small.nc`` and so on.

    Parameters
    ----------
    folder
        Made if it does not exist.
    parts
        Names of `PARTS`; all of them if left out.
    progress
        Called after every problem.

    Returns
    -------
    list of Written
        One entry a file. Every problem has been solved natively and compared with its reference answer.

    Raises
    ------
    InputError
        An unknown part, or a folder that cannot be written.
    """
    chosen = list(dict.fromkeys(PARTS if parts is None else parts))
    unknown = [part for part in chosen if part not in PARTS]
    if unknown or not chosen:
        raise InputError(f"parts = {', '.join(chosen) or 'none'}: choose from {', '.join(PARTS)}")
    target = Path(folder)
    check_folder(target, "library")
    paths = {part: target / f"{part}.nc" for part in chosen}
    for path in paths.values():
        check_writable(path)
    return [write_part([e for e in entries() if e.part == part], paths[part], progress) for part in chosen]


def write_part(chosen: Iterable[Entry], path: Path, progress: Callable[[], None] | None = None) -> Written:
    """Make, check and write problems of the library as one file."""
    answers = reference_answers()
    made: list[tuple[Entry, ContactProblem]] = []
    faults: list[str] = []
    certificates, differences = [0.0], [0.0]
    for entry, problem in generate(chosen):
        made.append((entry, problem))
        certificate, difference, fault = checked(problem, answers[entry.name])
        certificates.append(certificate)
        differences.append(difference)
        faults += [fault] if fault else []
        if progress is not None:
            progress()
    write_problems(
        [problem for _, problem in made],
        path,
        labels([entry for entry, _ in made], answers),
        {"title": "easeoff library of contact problems", "library_version": LIBRARY_VERSION},
    )
    return Written(path, len(made), max(certificates), max(differences), tuple(faults))


def checked(problem: ContactProblem, answer: Answer) -> tuple[float, float, str]:
    """Solve a problem natively; return its certificate's worst entry, difference from the reference, what is wrong."""
    solution = solve(problem, "native")
    certificate = solution.certificate.worst
    difference = abs(solution.elastic_rotation / answer.elastic_rotation - 1.0)
    touching = int(solution.active.sum())
    fault = ""
    if not solution.certificate.passes(EXACT_TOLERANCE):
        fault = f"{solution.status.name}, certificate {certificate:.1e}"
    elif problem.size != answer.size:
        fault = f"{problem.size} segments instead of {answer.size}"
    elif not difference <= AGREEMENT:
        fault = f"rotation differs from the reference by {difference:.1e}"
    elif answer.touching not in (-1, touching):
        fault = f"{touching} segments touch instead of {answer.touching}"
    return certificate, difference, f"{answer.name}: {fault}" if fault else ""


def labels(chosen: list[Entry], answers: Mapping[str, Answer]) -> dict[str, xr.DataArray]:
    """What each problem is, and its reference answer, with units."""
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
    }
    for name in ("elastic_rotation", "touching", "condition_number"):
        columns[name] = [getattr(answers[e.name], name) for e in chosen]
    dataset = labelled(xr.Dataset({name: ("problem", values) for name, values in columns.items()}))
    return {str(name): dataset[name] for name in dataset.data_vars}
