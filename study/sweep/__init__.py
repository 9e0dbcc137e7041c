"""Sweeps: a case analysed over grids, samples and load cases, and what is read off the numbers."""

from __future__ import annotations

from typing import TYPE_CHECKING

from ...core.lazy_names import lazy_names

if TYPE_CHECKING:
    from .parameter_sweep import sweep
    from .reductions import percentiles, sensitivities, worst_points
    from .sweep_file import read_sweep

__all__ = ["percentiles", "read_sweep", "sensitivities", "sweep", "worst_points"]

_ORIGINS = {
    ".parameter_sweep": ["sweep"],
    ".reductions": ["percentiles", "sensitivities", "worst_points"],
    ".sweep_file": ["read_sweep"],
}
__getattr__, __dir__ = lazy_names(__name__, _ORIGINS)
