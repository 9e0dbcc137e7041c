"""Shared by the tests: one BLAS thread, a cache of their own, and examples that are drawn alike each time."""

from __future__ import annotations

import atexit
import os
import shutil
import tempfile

from hypothesis import HealthCheck, settings

for variable in ("OPENBLAS_NUM_THREADS", "OMP_NUM_THREADS", "MKL_NUM_THREADS"):
    os.environ.setdefault(variable, "1")
# Condensed teeth of the tests are not the user's.
CACHE = tempfile.mkdtemp(prefix="easeoff-cache-")
atexit.register(shutil.rmtree, CACHE, ignore_errors=True)
os.environ["EASEOFF_CACHE"] = CACHE

# No test is judged by the clock. ``make random`` takes the second profile: other examples, and more of them.
settings.register_profile("alike", max_examples=40, derandomize=True, database=None, deadline=None)
settings.register_profile(
    "random", max_examples=400, deadline=None, print_blob=True, suppress_health_check=list(HealthCheck)
)
settings.load_profile("alike")
