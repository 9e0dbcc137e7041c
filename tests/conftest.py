"""Shared by the tests: one BLAS thread, the shipped cases and an exactly conjugate hypoid pair."""

from __future__ import annotations

import os
import tempfile

for variable in ("OPENBLAS_NUM_THREADS", "OMP_NUM_THREADS", "MKL_NUM_THREADS"):
    os.environ.setdefault(variable, "1")
os.environ["EASEOFF_CACHE"] = tempfile.mkdtemp(prefix="easeoff-cache-")
