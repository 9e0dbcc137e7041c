"""Shared by the tests: one BLAS thread, the shipped cases and an exactly conjugate hypoid pair."""

from __future__ import annotations

import atexit
import os
import shutil
import tempfile

for variable in ("OPENBLAS_NUM_THREADS", "OMP_NUM_THREADS", "MKL_NUM_THREADS"):
    os.environ.setdefault(variable, "1")
# Condensed teeth of the tests are not the user's.
CACHE = tempfile.mkdtemp(prefix="easeoff-cache-")
atexit.register(shutil.rmtree, CACHE, ignore_errors=True)
os.environ["EASEOFF_CACHE"] = CACHE
