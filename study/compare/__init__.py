"""Comparison of solvers on contact problems: attempts, table and test set; ``write_comparison`` writes its report."""

from __future__ import annotations

from typing import Any

from .comparison import compare

__all__ = ["compare", "write_comparison"]


def __getattr__(name: str) -> Any:
    if name == "write_comparison":
        from importlib import import_module

        # A floor above: what is written of a comparison stands with the other reports.
        return import_module("..", __name__).write_comparison
    raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
