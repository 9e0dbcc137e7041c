"""Shared by the tests: one BLAS thread, a cache of their own, examples drawn alike each time, and a quick suite."""

from __future__ import annotations

import atexit
import contextlib
import importlib
import os
import shutil
import tempfile
from collections import defaultdict
from typing import Any, cast

import pytest
from hypothesis import HealthCheck, settings

for variable in ("OPENBLAS_NUM_THREADS", "OMP_NUM_THREADS", "MKL_NUM_THREADS"):
    os.environ.setdefault(variable, "1")
os.environ["EASEOFF_PROGRESS"] = "off"  # lines of progress come by the clock
# Condensed teeth of the tests are not the user's.
if "PYTEST_XDIST_WORKER" not in os.environ:  # a worker takes the folder of the process that started it
    CACHE = tempfile.mkdtemp(prefix="easeoff-cache-")
    atexit.register(shutil.rmtree, CACHE, ignore_errors=True)
    os.environ["EASEOFF_CACHE"] = CACHE


COMPILED_MODULES = (
    "easeoff.contact.solvers.compiled.newton_kernel",
    "easeoff.contact.lines.spline_kernel",
    "easeoff.contact.evaluation.least_gap_kernel",
)

# No test is judged by the clock. ``make random`` takes the second profile: other examples, and more of them.
CALM: dict[str, Any] = {"deadline": None, "suppress_health_check": [HealthCheck.too_slow]}
settings.register_profile("alike", max_examples=40, derandomize=True, database=None, **CALM)
settings.register_profile("random", max_examples=400, print_blob=True, **CALM)
settings.load_profile("alike")


@pytest.fixture(scope="session", autouse=True)
def patience() -> None:
    """Give solvers as long as they need, on a machine however busy."""
    from easeoff.contact import SOLVERS

    for solver in SOLVERS.values():
        for key in ("time_limit", "time_limit_secs"):
            if key in solver.settings:
                cast(dict[str, Any], solver.settings)[key] = 3600.0


def pytest_sessionstart(session: pytest.Session) -> None:
    """Compile before the workers start: the first tests would else use the methods in numpy, with other last digits."""
    if "PYTEST_XDIST_WORKER" not in os.environ:
        from easeoff.core.compiled.compiled_use import compiling

        with compiling(), contextlib.suppress(ImportError):
            for module in COMPILED_MODULES:
                importlib.import_module(module)


@pytest.hookimpl(tryfirst=True)
def pytest_collection_modifyitems(items: list[pytest.Item]) -> None:
    """Mark the cases that ``quick(count)`` and ``ci(count)`` leave out: all but that many, spread over the test's."""
    for name, left_out in (("quick", pytest.mark.thorough), ("ci", pytest.mark.beyond_ci)):
        cases = defaultdict(list)
        for item in items:
            mark = item.get_closest_marker(name)
            if mark is not None:
                cases[item.nodeid.partition("[")[0], *mark.args].append(item)
        for (_, count), found in cases.items():
            kept = {len(found) * k // count for k in range(count)}
            for number, item in enumerate(found):
                if number not in kept:
                    item.add_marker(left_out)
