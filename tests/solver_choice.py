"""Which solvers a test tries."""

from __future__ import annotations

import pytest

from easeoff.contact.solvers import SOLVERS, available_solvers

BACKENDS = [name for name in SOLVERS if name != "native"]
LIFTING = [name for name in BACKENDS if SOLVERS[name].lifted_from is not None]


def installed(name: str) -> str:
    """Return the name of a solver; the test is skipped where it is not installed."""
    if name not in available_solvers():
        pytest.skip(f"{name} is not installed")
    return name
