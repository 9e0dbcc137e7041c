"""Adapter of DAQP, a dense dual active-set solver (Arnstrom, Bemporad and Axehill 2022, doi 10.1109/TAC.2022.3176430)."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from ..scaling import ScaledProblem
from .answer import ScaledAnswer
from .backend import read_answer, run_qpsolvers


def solve_scaled(problem: ScaledProblem, settings: Mapping[str, Any]) -> ScaledAnswer:
    """Solve the scaled problem."""
    return read_answer(run_qpsolvers("daqp", problem, settings))
