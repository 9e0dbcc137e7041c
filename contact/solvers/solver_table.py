"""Table of the solvers: package, licence, kind, settings for high accuracy, and the certificate to reach.

All settings are meant for the scaled problem, in which every number is of order one; on raw units the same tolerances
mean nothing.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from typing import Any

from ..problem.certificate import EXACT_TOLERANCE
from .solution import Status

#: Seconds after which a backend that can be stopped is stopped.
TIME_LIMIT = 10.0
#: Certificate that the unpolished answer of an interior-point method must reach. Where force and gap of a segment
#: vanish together, such methods leave both at the root of their tolerance; among thousands of segments some nearly do.
INTERIOR_POINT_TOLERANCE = 1e-4
#: Segments of the largest problems on which solvers without use for the structure were tried: three lines of 667.
LARGEST_DENSE = 2001
#: Segments beyond which Lemke's tableau is refused: it is dense, and its rounding errors grow with the pivots.
LARGEST_PIVOTING = 1000


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
    sparse: bool = False
    tolerance: float = EXACT_TOLERANCE  # certificate of unpolished answers with these settings
    #: Segments up to which it keeps the tolerance on the problem library; None for all; only `lemke` refuses more.
    largest: int | None = None
    definite: bool = False  # begins with a Cholesky factor of C: no answer, or a refused one, where C is singular
    lifted_from: int | None = None  # segments; None for the dense form only
    settings: Mapping[str, Any] = field(default_factory=dict)
    tolerance_settings: tuple[str, ...] = ()  # stopping tolerances in settings; none if exact up to rounding
    tolerance_power: int = 1  # of the certificate: 2 for interior points, see `INTERIOR_POINT_TOLERANCE`
    least_tolerance: float = 0.0  # smallest stopping tolerance that it takes
    time_setting: str = ""  # its name for a limit [s]; empty if none
    step_setting: str = ""
    warm_start: bool = False  # uses the forces of a neighbouring problem
    report: Report | None = None
    known: tuple[str, ...] = ()  # settings there are, of a backend that ignores others in silence
    #: Classes of its package whose instances have further ones as attributes, or such an object: "Settings.sip".
    known_of: tuple[str, ...] = ()
    second_attempt: Mapping[str, Any] = field(default_factory=dict)  # where it finds nothing


_EXTRA = "easeoff[solvers]"
_COPYLEFT = "easeoff[copyleft-solvers]"
_OWN = "BSD-3-Clause"

#: Names of stopping tolerances: the usual ones, of Clarabel, of programs for cones, of PIQP and of HiGHS.
_EPS = ("eps_abs", "eps_rel")
_CLARABEL = ("tol_gap_abs", "tol_gap_rel", "tol_feas")
_CONES = ("abstol", "reltol", "feastol")
_PIQP = (*_EPS, "eps_duality_gap_abs", "eps_duality_gap_rel")
_HIGHS = ("primal_feasibility_tolerance", "dual_feasibility_tolerance")
#: Limit of time in settings, by its usual name.
_TIME = {"time_limit": TIME_LIMIT}
#: Report by the usual names.
_REPORT = Report("info", "status", "iter", set_up_time="setup_time", solve_time="solve_time")


def _ends(*, infeasible: str, unbounded: str = "", time: str = "", steps: str = "") -> dict[str | int, Status]:
    """Meanings of ends by their names, which are empty where a backend has none."""
    meanings = {
        infeasible: Status.INFEASIBLE,
        unbounded: Status.UNBOUNDED,
        time: Status.TIME_LIMIT,
        steps: Status.NOT_CONVERGED,
    }
    return {name: status for name, status in meanings.items() if name}


SOLVERS: dict[str, SolverSettings] = {
    "native": SolverSettings(
        "",
        "easeoff",
        _OWN,
        "modal Newton or primal-dual active set, with certified fallbacks",
        time_setting="time_limit",
        step_setting="max_iterations",
        warm_start=True,
    ),
    "clarabel": SolverSettings(
        "clarabel",
        "clarabel",
        "Apache-2.0",
        "interior point, sparse",
        sparse=True,
        tolerance=INTERIOR_POINT_TOLERANCE,
        lifted_from=150,
        settings=dict.fromkeys(_CLARABEL, 1e-11) | {"tol_ktratio": 1e-9, "max_iter": 200} | _TIME,
        tolerance_settings=_CLARABEL,
        tolerance_power=2,
        time_setting="time_limit",
        step_setting="max_iter",
        report=Report(
            status="status",
            ends=_ends(
                infeasible="PrimalInfeasible", unbounded="DualInfeasible", time="MaxTime", steps="MaxIterations"
            ),
            solve_time="solve_time",
        ),
    ),
    "osqp": SolverSettings(
        "osqp",
        "osqp",
        "Apache-2.0",
        "alternating direction method of multipliers, sparse",
        sparse=True,
        tolerance=1e-6,
        lifted_from=250,
        settings=dict.fromkeys(_EPS, 1e-10) | {"max_iter": 100_000, "polishing": True} | _TIME,
        tolerance_settings=_EPS,
        time_setting="time_limit",
        step_setting="max_iter",
        warm_start=True,
        report=replace(
            _REPORT,
            ends={
                "problem non convex": Status.NOT_POSITIVE_SEMIDEFINITE,
                **_ends(
                    infeasible="primal infeasible",
                    unbounded="dual infeasible",
                    time="run time limit reached",
                    steps="maximum iterations reached",
                ),
            },
        ),
    ),
    "daqp": SolverSettings(
        "daqp",
        _EXTRA,
        "MIT",
        "dual active set, dense",
        tolerance=1e-6,
        largest=LARGEST_DENSE,
        settings={"primal_tol": 1e-11, "dual_tol": 1e-12, "iter_limit": 10_000} | _TIME,
        tolerance_settings=("primal_tol", "dual_tol"),
        time_setting="time_limit",
        step_setting="iter_limit",
        warm_start=True,
        report=Report(),
        # Proximal iterations, for matrices that are numerically singular, where the plain method finds nothing.
        second_attempt={"eps_prox": 1e-4, "eta_prox": 1e-13},
    ),
    "piqp": SolverSettings(
        "piqp",
        _EXTRA,
        "BSD-2-Clause",
        "proximal interior point, dense or sparse",
        tolerance=INTERIOR_POINT_TOLERANCE,
        lifted_from=250,
        settings=dict.fromkeys(_PIQP, 1e-11) | {"max_iter": 500},
        tolerance_settings=_PIQP,
        tolerance_power=2,
        step_setting="max_iter",
        report=replace(
            _REPORT,
            ends=_ends(
                infeasible="PIQP_PRIMAL_INFEASIBLE",
                unbounded="PIQP_DUAL_INFEASIBLE",
                steps="PIQP_MAX_ITER_REACHED",
            ),
        ),
        known=("backend",),
        known_of=("DenseSolver.settings",),
    ),
    "proxqp": SolverSettings(
        "proxsuite",
        _EXTRA,
        "BSD-2-Clause",
        "proximal augmented Lagrangian, dense",
        tolerance=1e-7,
        largest=LARGEST_DENSE,
        settings={"eps_abs": 1e-11, "eps_rel": 0.0, "max_iter": 10_000},
        tolerance_settings=("eps_abs",),
        step_setting="max_iter",
        warm_start=True,
        report=replace(
            _REPORT,
            ends=_ends(
                infeasible="PROXQP_PRIMAL_INFEASIBLE",
                unbounded="PROXQP_DUAL_INFEASIBLE",
                steps="PROXQP_MAX_ITER_REACHED",
            ),
            unit=1e-6,
        ),
    ),
    "highs": SolverSettings(
        "highspy",
        _EXTRA,
        "MIT",
        "primal active set, sparse input",
        sparse=True,
        largest=1000,  # 9 s at 2001 segments: on a busy machine it meets its time limit
        # By default 1e-7 is added to the diagonal, a bias of the same size in the forces. The method has been seen to
        # cycle for ever.
        settings=dict.fromkeys(_HIGHS, 1e-10) | {"qp_regularization_value": 0.0} | _TIME,
        tolerance_settings=_HIGHS,
        least_tolerance=1e-10,
        time_setting="time_limit",
        step_setting="qp_iteration_limit",
        report=Report(),
        known_of=("HighsOptions",),
    ),
    "scs": SolverSettings(
        "scs",
        _EXTRA,
        "MIT",
        "splitting cone solver, sparse",
        sparse=True,
        tolerance=1e-7,
        lifted_from=250,
        settings=dict.fromkeys(_EPS, 1e-10) | {"max_iters": 200_000, "time_limit_secs": TIME_LIMIT},
        tolerance_settings=_EPS,
        time_setting="time_limit_secs",
        step_setting="max_iters",
        warm_start=True,
        report=replace(
            _REPORT,
            place="",
            ends=_ends(
                infeasible="infeasible",
                unbounded="unbounded",
                time="solved (inaccurate - reached time_limit_secs)",
                steps="solved (inaccurate - reached max_iters)",
            ),
            unit=1e-3,
        ),
    ),
    "sip": SolverSettings(
        "sip_qp_python",
        _EXTRA,
        "MIT",
        "regularised interior point, sparse",
        sparse=True,
        tolerance=1e-6,
        lifted_from=100,
        settings=dict.fromkeys(_EPS, 1e-11) | _TIME,
        tolerance_settings=_EPS,
        time_setting="time_limit",
        step_setting="max_iterations",
        warm_start=True,
        report=Report(
            "sip_output",
            "exit_status",
            "num_iterations",
            ends=_ends(infeasible="LOCALLY_INFEASIBLE", time="TIMEOUT", steps="ITERATION_LIMIT"),
        ),
        known=("eps_abs", "eps_rel", "time_limit"),
        known_of=("Settings", "Settings.sip"),
    ),
    "pyqpmad": SolverSettings(
        "pyqpmad",
        _EXTRA,
        "BSD-3-Clause AND Apache-2.0",
        "dual active set, dense, for positive definite matrices",
        tolerance=1e-6,
        largest=LARGEST_DENSE,
        definite=True,
        settings={"tolerance": 1e-14, "max_iter": 10_000},
        step_setting="max_iter",
        tolerance_settings=("tolerance",),
        known_of=("SolverParameters",),
    ),
    "qpalm": SolverSettings(
        "qpalm",
        _COPYLEFT,
        "LGPL-3.0-or-later",
        "proximal augmented Lagrangian, sparse",
        sparse=True,
        tolerance=1e-7,
        lifted_from=200,
        settings=dict.fromkeys(_EPS, 1e-10) | {"max_iter": 100_000} | _TIME,
        tolerance_settings=_EPS,
        time_setting="time_limit",
        step_setting="max_iter",
        report=replace(
            _REPORT,
            ends=_ends(
                infeasible="primal infeasible",
                unbounded="dual infeasible",
                time="time limit exceeded",
                steps="maximum iterations reached",
            ),
        ),
        known_of=("Settings",),
    ),
    "quadprog": SolverSettings(
        "quadprog",
        _COPYLEFT,
        "GPL-2.0-or-later",
        "dual active set, dense, for positive definite matrices",
        tolerance=1e-6,
        largest=LARGEST_DENSE,
        definite=True,
        report=Report(iterations="iterations"),
    ),
    "cvxopt": SolverSettings(
        "cvxopt",
        _COPYLEFT,
        "GPL-3.0-or-later",
        "interior point, dense",
        tolerance=INTERIOR_POINT_TOLERANCE,
        largest=LARGEST_DENSE,
        settings=dict.fromkeys(_CONES, 1e-11) | {"maxiters": 200},
        tolerance_settings=_CONES,
        tolerance_power=2,
        step_setting="maxiters",
        warm_start=True,
        # Its only other status is "unknown": the iterations are used up, or a matrix could not be factored.
        report=Report(status="status", iterations="iterations", other_end=Status.NOT_CONVERGED),
        known=("maxiters", *_CONES, "refinement", "kktreg", "use_correction"),
    ),
    "ecos": SolverSettings(
        "ecos",
        _COPYLEFT,
        "GPL-3.0-or-later",
        "interior point for cones, dense, for positive definite matrices",
        tolerance=INTERIOR_POINT_TOLERANCE,
        largest=LARGEST_DENSE,
        definite=True,
        settings=dict.fromkeys(_CONES, 1e-12) | {"max_iters": 200},
        tolerance_settings=_CONES,
        tolerance_power=2,
        step_setting="max_iters",
        # Exit flags; those from 10 on have the same meanings, for an answer that misses the tolerances.
        report=Report(
            status="infostring",
            iterations="iter",
            ends={
                1: Status.INFEASIBLE,
                2: Status.UNBOUNDED,
                11: Status.INFEASIBLE,
                12: Status.UNBOUNDED,
                -1: Status.NOT_CONVERGED,
            },
            end="exitFlag",
        ),
    ),
    "cvxpy": SolverSettings(
        "cvxpy",
        "cvxpy",
        "Apache-2.0",
        "modelling language, by default with clarabel",
        tolerance=INTERIOR_POINT_TOLERANCE,
        lifted_from=60,
        settings=dict.fromkeys(_CLARABEL, 1e-11),
        tolerance_settings=_CLARABEL,
        tolerance_power=2,
        time_setting="time_limit",
        step_setting="max_iter",
    ),
    "lemke": SolverSettings(
        "",
        "easeoff",
        _OWN,
        "Lemke's complementary pivoting, dense, to 1000 segments",
        largest=LARGEST_PIVOTING,
        time_setting="time_limit",
        step_setting="max_pivots",
    ),
}
