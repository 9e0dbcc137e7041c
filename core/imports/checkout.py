"""In a checkout the folder of the package holds tests and docs, too: they cannot be imported from it."""

from __future__ import annotations

import sys
from collections.abc import Sequence
from pathlib import Path
from types import ModuleType

EXCLUDED_MODULES = ("easeoff.tests", "easeoff.docs", "easeoff.benchmarks", "easeoff.fuzz")


class CheckoutFinder:
    """Module finder that refuses the folders of a checkout that are not part of the package."""

    @staticmethod
    def find_spec(fullname: str, path: Sequence[str] | None, target: ModuleType | None = None) -> None:
        """Raise ``ModuleNotFoundError`` for folders beside the package's own."""
        if fullname in EXCLUDED_MODULES:
            raise ModuleNotFoundError(f"No module named {fullname!r}", name=fullname)


def fence() -> None:
    """Install the finder if the package is that of a checkout."""
    if (Path(__file__).parents[2] / "pyproject.toml").is_file():
        sys.meta_path.insert(0, CheckoutFinder)
