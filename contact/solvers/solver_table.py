"""Table of the solvers: package, licence, kind, settings for high accuracy, and the certificate to reach.

All settings are meant for the scaled problem, in which every number is of order one; on raw units the same tolerances
mean nothing.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any

from ..problem.certificate import EXACT_TOLERANCE

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
class SolverSettings:
    """Facts and settings of one solver.

    Attributes
    ----------
    package
        Importable package it needs; empty for the solvers of this package.
    requirement
        Requirement that pip installs.
    licence
        SPDX identifier. What is under a copyleft licence is an optional extra of its own.
    kind
        The method, in a few words.
    sparse
        Whether it wants sparse matrices.
    tolerance
        Certificate that its unpolished answers reach with these settings.
    largest
        Number of segments up to which it is known to keep that tolerance on the problem library; None for all of it.
        A solver that gets the whole matrix takes minutes on more. Nothing is refused for it but by `lemke`.
    definite
        Whether it begins with a Cholesky factor of the whole compliance: where that is singular to rounding it has no
        answer, or one that the certificate refuses.
    lifted_from
        Number of segments from which a structured problem is given in the lifted form; None for a solver that takes
        the dense form only.
    settings
        Keywords passed to it; what the caller gives comes on top.
    tolerance_settings
        Those of its settings that are stopping tolerances; empty for a method that is exact up to rounding. With them
        as in ``settings`` its unpolished answers reach ``tolerance``.
    tolerance_power
        Power of the certificate to which they belong: 2 for interior-point methods, see `INTERIOR_POINT_TOLERANCE`.
    least_tolerance
        Smallest stopping tolerance that it takes.
    time_setting, step_setting
        Its names for a time limit [s] and a limit of its iterations; empty where it has none.
    warm_start
        Whether it makes use of the forces of a neighbouring problem. The others ignore them, or have no use for them.

    Examples
    --------
    >>> SOLVERS["osqp"].licence, SOLVERS["osqp"].tolerance
    ('Apache-2.0', 1e-06)
    """

    package: str
    requirement: str
    licence: str
    kind: str
    sparse: bool = False
    tolerance: float = EXACT_TOLERANCE
    largest: int | None = None
    definite: bool = False
    lifted_from: int | None = None
    settings: Mapping[str, Any] = field(default_factory=dict)
    tolerance_settings: tuple[str, ...] = ()
    tolerance_power: int = 1
    least_tolerance: float = 0.0
    time_setting: str = ""
    step_setting: str = ""
    warm_start: bool = False


_EXTRA = "easeoff[solvers]"
_COPYLEFT = "easeoff[copyleft-solvers]"
_OWN = "BSD-3-Clause"

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
        settings={
            "tol_gap_abs": 1e-11,
            "tol_gap_rel": 1e-11,
            "tol_feas": 1e-11,
            "tol_ktratio": 1e-9,
            "max_iter": 200,
            "time_limit": TIME_LIMIT,
        },
        tolerance_settings=(
            "tol_gap_abs",
            "tol_gap_rel",
            "tol_feas",
        ),
        tolerance_power=2,
        time_setting="time_limit",
        step_setting="max_iter",
    ),
    "osqp": SolverSettings(
        "osqp",
        "osqp",
        "Apache-2.0",
        "alternating direction method of multipliers, sparse",
        sparse=True,
        tolerance=1e-6,
        lifted_from=250,
        settings={
            "eps_abs": 1e-10,
            "eps_rel": 1e-10,
            "max_iter": 100_000,
            "polishing": True,
            "time_limit": TIME_LIMIT,
        },
        tolerance_settings=(
            "eps_abs",
            "eps_rel",
        ),
        time_setting="time_limit",
        step_setting="max_iter",
        warm_start=True,
    ),
    "daqp": SolverSettings(
        "daqp",
        _EXTRA,
        "MIT",
        "dual active set, dense",
        tolerance=1e-6,
        largest=LARGEST_DENSE,
        settings={"primal_tol": 1e-11, "dual_tol": 1e-12, "iter_limit": 10_000, "time_limit": TIME_LIMIT},
        tolerance_settings=(
            "primal_tol",
            "dual_tol",
        ),
        time_setting="time_limit",
        step_setting="iter_limit",
        warm_start=True,
    ),
    "piqp": SolverSettings(
        "piqp",
        _EXTRA,
        "BSD-2-Clause",
        "proximal interior point, dense or sparse",
        tolerance=INTERIOR_POINT_TOLERANCE,
        lifted_from=250,
        settings={
            "eps_abs": 1e-11,
            "eps_rel": 1e-11,
            "eps_duality_gap_abs": 1e-11,
            "eps_duality_gap_rel": 1e-11,
            "max_iter": 500,
        },
        tolerance_settings=(
            "eps_abs",
            "eps_rel",
            "eps_duality_gap_abs",
            "eps_duality_gap_rel",
        ),
        tolerance_power=2,
        step_setting="max_iter",
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
    ),
    "highs": SolverSettings(
        "highspy",
        _EXTRA,
        "MIT",
        "primal active set, sparse input",
        sparse=True,
        tolerance=EXACT_TOLERANCE,
        largest=1000,  # 9 s at 2001 segments: on a busy machine it meets its time limit
        settings={
            "primal_feasibility_tolerance": 1e-10,
            "dual_feasibility_tolerance": 1e-10,
            # By default 1e-7 is added to the diagonal, a bias of the same size in the forces.
            "qp_regularization_value": 0.0,
            # It has been seen to cycle for ever.
            "time_limit": TIME_LIMIT,
        },
        tolerance_settings=(
            "primal_feasibility_tolerance",
            "dual_feasibility_tolerance",
        ),
        least_tolerance=1e-10,
        time_setting="time_limit",
        step_setting="qp_iteration_limit",
    ),
    "scs": SolverSettings(
        "scs",
        _EXTRA,
        "MIT",
        "splitting cone solver, sparse",
        sparse=True,
        tolerance=1e-7,
        lifted_from=250,
        settings={"eps_abs": 1e-10, "eps_rel": 1e-10, "max_iters": 200_000, "time_limit_secs": TIME_LIMIT},
        tolerance_settings=(
            "eps_abs",
            "eps_rel",
        ),
        time_setting="time_limit_secs",
        step_setting="max_iters",
        warm_start=True,
    ),
    "sip": SolverSettings(
        "sip_qp_python",
        _EXTRA,
        "MIT",
        "regularised interior point, sparse",
        sparse=True,
        tolerance=1e-6,
        lifted_from=100,
        settings={"eps_abs": 1e-11, "eps_rel": 1e-11, "time_limit": TIME_LIMIT},
        tolerance_settings=(
            "eps_abs",
            "eps_rel",
        ),
        time_setting="time_limit",
        step_setting="max_iterations",
        warm_start=True,
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
    ),
    "qpalm": SolverSettings(
        "qpalm",
        _COPYLEFT,
        "LGPL-3.0-or-later",
        "proximal augmented Lagrangian, sparse",
        sparse=True,
        tolerance=1e-7,
        lifted_from=200,
        settings={"eps_abs": 1e-10, "eps_rel": 1e-10, "max_iter": 100_000, "time_limit": TIME_LIMIT},
        tolerance_settings=(
            "eps_abs",
            "eps_rel",
        ),
        time_setting="time_limit",
        step_setting="max_iter",
    ),
    "quadprog": SolverSettings(
        "quadprog",
        _COPYLEFT,
        "GPL-2.0-or-later",
        "dual active set, dense, for positive definite matrices",
        tolerance=1e-6,
        largest=LARGEST_DENSE,
        definite=True,
    ),
    "cvxopt": SolverSettings(
        "cvxopt",
        _COPYLEFT,
        "GPL-3.0-or-later",
        "interior point, dense",
        tolerance=INTERIOR_POINT_TOLERANCE,
        largest=LARGEST_DENSE,
        settings={"abstol": 1e-11, "reltol": 1e-11, "feastol": 1e-11, "maxiters": 200},
        tolerance_settings=(
            "abstol",
            "reltol",
            "feastol",
        ),
        tolerance_power=2,
        step_setting="maxiters",
        warm_start=True,
    ),
    "ecos": SolverSettings(
        "ecos",
        _COPYLEFT,
        "GPL-3.0-or-later",
        "interior point for cones, dense, for positive definite matrices",
        tolerance=INTERIOR_POINT_TOLERANCE,
        largest=LARGEST_DENSE,
        definite=True,
        settings={"abstol": 1e-12, "reltol": 1e-12, "feastol": 1e-12, "max_iters": 200},
        tolerance_settings=(
            "abstol",
            "reltol",
            "feastol",
        ),
        tolerance_power=2,
        step_setting="max_iters",
    ),
    "cvxpy": SolverSettings(
        "cvxpy",
        "cvxpy",
        "Apache-2.0",
        "modelling language, by default with clarabel",
        tolerance=INTERIOR_POINT_TOLERANCE,
        lifted_from=60,
        settings={"tol_gap_abs": 1e-11, "tol_gap_rel": 1e-11, "tol_feas": 1e-11},
        tolerance_settings=(
            "tol_gap_abs",
            "tol_gap_rel",
            "tol_feas",
        ),
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
