"""Table of the solvers: package, licence, kind, settings for high accuracy, and the certificate to reach.

Its rows stand in ``solver_table.toml``.
"""

from __future__ import annotations

import tomllib
from collections.abc import Mapping
from dataclasses import dataclass, field
from importlib import resources
from typing import Any

from ..problem.certificate import EXACT_TOLERANCE
from .solution import Status


@dataclass(frozen=True)
class Report:
    """Names under which a backend behind qpsolvers reports its end, among the extras of its solution.

    Empty where it reports none.
    """

    place: str = ""  # among the extras; empty for the extras themselves
    status: str = ""
    iterations: str = ""
    #: Meanings of ends without an answer; where there are none a limit that was met counts.
    ends: Mapping[str | int, Status] = field(default_factory=dict)
    end: str = ""  # name of what ends go by, if not the status
    other_end: Status | None = None  # meaning of every other end without an answer
    unit: float = 1.0  # of the times [s]
    set_up_time: str = ""
    solve_time: str = ""


@dataclass(frozen=True)
class SolverSettings:
    """Facts and settings of one solver; the caller's settings come on top."""

    package: str  # importable; empty for solvers of this package
    requirement: str
    licence: str  # SPDX; copyleft ones are optional extras of their own
    kind: str
    work: str = ""  # key of the published work that it is from; empty if none
    sparse: bool = False
    tolerance: float = EXACT_TOLERANCE  # certificate of unpolished answers with these settings
    #: Segments up to which it keeps the tolerance on the problem library; None for all; only `lemke` refuses more.
    largest: int | None = None
    definite: bool = False  # begins with a Cholesky factor of C: no answer, or a refused one, where C is singular
    lifted_from: int | None = None  # segments; None for the dense form only
    settings: Mapping[str, Any] = field(default_factory=dict)
    tolerance_settings: tuple[str, ...] = ()  # stopping tolerances in settings; none if exact up to rounding
    tolerance_power: int = 1  # of the certificate: 2 for interior points, which leave force and gap at its root
    least_tolerance: float = 0.0  # smallest stopping tolerance that it takes
    time_setting: str = ""  # its name for a limit [s]; empty if none
    step_setting: str = ""
    warm_start: bool = False  # uses the forces of a neighbouring problem
    report: Report | None = None
    known: tuple[str, ...] = ()  # settings there are, of a backend that ignores others in silence
    #: Classes of its package whose instances have further ones as attributes, or such an object: "Settings.sip".
    known_of: tuple[str, ...] = ()
    second_attempt: Mapping[str, Any] = field(default_factory=dict)  # where it finds nothing


def _solvers() -> dict[str, SolverSettings]:
    """The table from its file, where the meanings of ends stand by the names of `Status`."""
    text = resources.files(__package__).joinpath("solver_table.toml").read_text(encoding="utf-8")
    solvers = {}
    for name, row in tomllib.loads(text).items():
        facts: dict[str, Any] = {key: tuple(value) if isinstance(value, list) else value for key, value in row.items()}
        if (report := facts.pop("report", None)) is not None:
            ends = {end: Status[status] for status, each in report.pop("ends", {}).items() for end in each}
            other_end = Status[report.pop("other_end")] if "other_end" in report else None
            facts["report"] = Report(**report, ends=ends, other_end=other_end)
        solvers[name] = SolverSettings(**facts)
    return solvers


#: The solvers by name, the native one first.
SOLVERS = _solvers()
