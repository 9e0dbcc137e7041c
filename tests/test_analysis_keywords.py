"""Keywords of an analysis: what is no argument and no setting of its solver is refused before any work."""

from __future__ import annotations

from typing import Any

import pytest

import easeoff
from easeoff.cases import LoadCase
from easeoff.core.errors import InputError
from easeoff.study import analyze_load_cases
from easeoff.study.analysis.solver_options import require_solver_options

COPY = r'it is a key of the case\'s \[{0}\]: .*case\.{0}\.model_copy\(update={{"{1}": \.\.\.}}\)'


@pytest.mark.parametrize(
    ("given", "said"),
    [
        ({"torque": 100.0}, r"^torque = 100: must be an argument of analyze .*; did you mean 'torques'\?$"),
        ({"suports_": "axle-fm-11x41"}, "^suports_ = 'axle-fm-11x41': .*; did you mean 'supports'"),
        ({"time_limt": 1.0}, "did you mean 'time_limit'"),
        ({"xyz": 1}, "native takes tolerance, time_limit, max_iterations, polish, form, method$"),
        ({"mesh_positions": 8}, COPY.format("contact", "mesh_positions")),
        ({"fineness": 0.5}, COPY.format("compliance", "fineness")),
        ({"initial_force": [1.0]}, "initial_force = .*: must be an argument"),
        ({"tolerance": -1.0}, "tolerance = -1: must be a number above 0"),
        ({"method": "modl"}, "method = 'modl': must be one of cascade, modal"),
        ({"solver": "osqp", "torque": 100.0}, "did you mean 'torques'"),
        ({"solver": "osqp", "mesh_positions": 8}, COPY.format("contact", "mesh_positions")),
    ],
)
def test_an_unknown_keyword_is_refused_before_any_work(given: dict[str, Any], said: str) -> None:
    with pytest.raises(InputError, match=said):
        easeoff.analyze("no such case", **given)  # it is not even read


def test_load_cases_suggest_their_own_arguments() -> None:
    with pytest.raises(InputError, match=r"argument of analyze_load_cases .*did you mean 'temperature'"):
        analyze_load_cases("nasa-12x36", [LoadCase(torque=100.0)], temperaturee=90.0)


@pytest.mark.parametrize("setting", ["presolve", "eps_abs", "max_iter", "rho", "verbose", "scaling", "seed", "polish"])
def test_settings_of_another_solver_are_its_own(setting: str) -> None:
    require_solver_options({setting: 1}, "osqp", easeoff.analyze)


def test_a_method_of_the_native_solver_is_taken() -> None:
    require_solver_options({"method": "modal", "tolerance": 1e-10}, "auto", easeoff.analyze)
