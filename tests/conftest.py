"""Shared by the tests: one BLAS thread, a cache of their own, examples drawn alike each time, and a quick suite.

A test that takes more than two seconds is marked ``@pytest.mark.thorough``: ``make test`` leaves it out, ``.ci/run``
runs every fifth of them, ``make check`` all. Of one with many cases, ``@pytest.mark.quick(3)`` leaves three, spread
over them, to ``make test``.

Nothing may depend on the clock or on how busy the machine is: no test waits for a time limit, and solvers have as long
as they need. Pages are tested in Chromium (``browser.py``), the site where ``make docs`` has built it; kernels also as
the Python that they are written in, with the same bits (``kernels.py``).
"""

from __future__ import annotations

import atexit
import gc
import os
import shutil
import sys
import tempfile
from collections import defaultdict
from collections.abc import Callable, Iterator
from typing import Any, cast

import pytest
from hypothesis import HealthCheck, settings

# The garbage collector comes less often.
gc.set_threshold(50_000, 20, 20)
for variable in ("OPENBLAS_NUM_THREADS", "OMP_NUM_THREADS", "MKL_NUM_THREADS"):
    os.environ.setdefault(variable, "1")
os.environ["EASEOFF_PROGRESS"] = "off"  # lines of progress come by the clock
# Modules are read by two workers and by all processes that tests start: their byte code is kept.
os.environ.pop("PYTHONDONTWRITEBYTECODE", None)
sys.dont_write_bytecode = False
# Condensed teeth of the tests are not the user's.
if "PYTEST_XDIST_WORKER" not in os.environ:  # a worker takes the folder of the process that started it
    CACHE = tempfile.mkdtemp(prefix="easeoff-cache-")
    atexit.register(shutil.rmtree, CACHE, ignore_errors=True)
    os.environ["EASEOFF_CACHE"] = CACHE

# No test is judged by the clock. ``make random`` takes the second profile: other examples, and more of them.
CALM: dict[str, Any] = {"deadline": None, "suppress_health_check": [HealthCheck.too_slow]}
settings.register_profile("alike", max_examples=40, derandomize=True, database=None, **CALM)
settings.register_profile("random", max_examples=400, print_blob=True, **CALM)
settings.load_profile("alike")


def pytest_configure(config: pytest.Config) -> None:
    """Hand files to the workers by name: by their number of tests, the longest would come among the last."""
    config.option.loadscopereorder = False
    config.add_cleanup(gc.unfreeze)  # in the end: compiled libraries count what is left at the end of a process


#: Pairs, and teeth, whose geometry is kept by a worker.
GEOMETRY_COUNT = 50
#: Middles of teeth, of one node each.
MIDDLE_COUNT = 1000
#: Of the thorough items one in so many is run by ``.ci/run``.
CI_SHARE = 5


@pytest.fixture(scope="session", autouse=True)
def patience() -> None:
    """Give solvers as long as they need, on a machine however busy."""
    from easeoff.contact import SOLVERS

    for solver in SOLVERS.values():
        for key in ("time_limit", "time_limit_secs"):
            if key in solver.settings:
                cast(dict[str, Any], solver.settings)[key] = 3600.0


@pytest.fixture(scope="session", autouse=True)
def shared_geometry() -> Iterator[None]:
    """Compute the geometry of a pair, and of a tooth in any pair, once: frozen, it depends on the arguments alone."""
    from shared import Shared, replace_everywhere

    from easeoff.contact.compliance.finite_elements.tooth_ring import body_modes
    from easeoff.geometry.pair.ease_off import exact_ease_off
    from easeoff.geometry.pair.gear_pair import pair_geometry
    from easeoff.geometry.pair.tooth_body import middle_angle, tooth_body
    from easeoff.geometry.pair.tooth_thickness import mean_flanks
    from easeoff.geometry.tooth.tooth_surface import tooth_side

    computed: dict[Callable[..., Any], int] = {
        **dict.fromkeys((pair_geometry, exact_ease_off, tooth_body, tooth_side, body_modes), GEOMETRY_COUNT),
        **dict.fromkeys((middle_angle, mean_flanks), MIDDLE_COUNT),
    }
    with pytest.MonkeyPatch.context() as patch:
        for compute, count in computed.items():
            replace_everywhere(patch, compute, Shared(count).once(compute))
        yield


@pytest.fixture(scope="session", autouse=True)
def reading() -> Iterator[Callable[..., Any]]:
    """Read a file that this process wrote in this process, as on Windows: a copy of it takes longer than the reading.

    Any other is read in a copy: on a damaged file netCDF may end the process, as it does on one that xarray holds open.
    """
    from shared import replace_everywhere

    from easeoff.core import forked_process, netcdf_file

    read, write, in_copy = netcdf_file._read, netcdf_file.write_netcdf, forked_process.in_forked_process
    written = set[tuple[int, ...]]()

    def state(path: Any) -> tuple[int, ...]:
        found = os.stat(path)
        return found.st_ino, found.st_size, found.st_mtime_ns, found.st_ctime_ns

    def write_netcdf(content: Any, path: Any, *further: Any, **keywords: Any) -> None:
        write(content, path, *further, **keywords)
        written.add(state(path))

    def is_own(path: Any) -> bool:
        try:
            return state(path) in written
        except (OSError, TypeError, ValueError):
            return False

    def read_here(path: Any, *further: Any, **keywords: Any) -> Any:
        with pytest.MonkeyPatch.context() as patch:
            if vars(netcdf_file)["in_forked_process"] is in_copy and is_own(path):
                patch.setattr(netcdf_file, "in_forked_process", lambda work: work())
            return read(path, *further, **keywords)

    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(netcdf_file, "_read", read_here)
        replace_everywhere(patch, write, write_netcdf)
        yield read


@pytest.fixture
def reading_here(reading: Callable[..., Any], monkeypatch: pytest.MonkeyPatch) -> None:
    """Read all files in this process: whole ones, whoever wrote them."""
    from easeoff.core import netcdf_file

    monkeypatch.setattr(netcdf_file, "in_forked_process", lambda work: work())


@pytest.fixture
def reading_in_copies(reading: Callable[..., Any], monkeypatch: pytest.MonkeyPatch) -> None:
    """Read all files in copies of this process, also from several threads."""
    from easeoff.core import netcdf_file

    monkeypatch.setattr(netcdf_file, "_read", reading)


@pytest.hookimpl(tryfirst=True)
def pytest_collection_modifyitems(items: list[pytest.Item]) -> None:
    """Mark what is left out: of the cases of ``quick(count)`` all but that many, of thorough items four in five."""
    cases = defaultdict(list)
    for item in items:
        quick = item.get_closest_marker("quick")
        if quick is not None:
            cases[item.nodeid.partition("[")[0], *quick.args].append(item)
    for (_, count), found in cases.items():
        kept = {len(found) * k // count for k in range(count)}
        for number, item in enumerate(found):
            if number not in kept:
                item.add_marker(pytest.mark.thorough)
    for number, item in enumerate(item for item in items if item.get_closest_marker("thorough")):
        if number % CI_SHARE:
            item.add_marker(pytest.mark.beyond_ci)


def pytest_collection_finish() -> None:
    """Let the garbage collector pass over what lasts as long as the tests do."""
    gc.collect()
    gc.freeze()


def pytest_unconfigure() -> None:
    """Let it pass once over what the tests leave, for pytest, which looks more than once for what went wrong in it."""
    gc.collect()
    gc.freeze()
