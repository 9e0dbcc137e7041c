"""Adapter of the quadratic solver in HiGHS (Huangfu and Hall 2018, doi 10.1007/s12532-017-0130-5)."""

from __future__ import annotations

import ctypes
import os
import sys
from collections.abc import Mapping
from contextlib import suppress
from functools import cache
from time import perf_counter
from typing import Any

from ...problem.scaled_problem import ScaledProblem
from ..backend import read_answer, refuse_unknown, run_qpsolvers
from ..scaled_answer import ScaledAnswer
from ..solver_limits import limit_met


@cache
def _say_banner() -> None:
    """Let HiGHS say its name and version, once a process, where nobody hears it: no option leaves that out."""
    import highspy

    sys.stdout.flush()
    library = ctypes.CDLL(None) if os.name == "posix" else None
    with suppress(OSError), open(os.devnull, "wb") as nowhere:
        kept = os.dup(1)
        try:
            os.dup2(nowhere.fileno(), 1)
            made: Any = highspy.Highs
            made()
            if library is not None:
                library.fflush(None)  # its text waits in the C library
        finally:
            os.dup2(kept, 1)
            os.close(kept)


def solve_scaled(problem: ScaledProblem, settings: Mapping[str, Any]) -> ScaledAnswer:
    """Solve the scaled problem."""
    import highspy

    _say_banner()
    refuse_unknown("highs", settings, highspy.HighsOptions())
    start = perf_counter()
    solution = run_qpsolvers("highs", problem, settings)
    return read_answer(
        solution, suspicion=None if solution.found else limit_met("highs", settings, perf_counter() - start)
    )
