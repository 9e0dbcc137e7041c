"""In a checkout the folder of the package holds tests, docs and benchmarks too: they cannot be imported from it."""

from __future__ import annotations

import sys
from collections.abc import Sequence
from pathlib import Path
from types import ModuleType

BESIDE = ("easeoff.tests", "easeoff.docs", "easeoff.benchmarks")


class CheckoutFinder:
    """A finder of modules that finds none, and lets no other one look for what is no part of the package."""

    @staticmethod
    def find_spec(fullname: str, path: Sequence[str] | None, target: ModuleType | None = None) -> None:
        """Raise ``ModuleNotFoundError`` for folders beside the package's own."""
        if fullname in BESIDE:
            raise ModuleNotFoundError(f"No module named {fullname!r}", name=fullname)


def fence() -> None:
    """Put the finder in place, where the package is that of a checkout."""
    if (Path(__file__).parents[1] / "pyproject.toml").is_file():
        sys.meta_path.insert(0, CheckoutFinder)
