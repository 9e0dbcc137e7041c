"""Sweeps: a case analysed over grids, samples and load cases, and what is read off the numbers."""

from .parameter_sweep import sweep
from .reductions import percentiles, sensitivities, worst_points
from .sweep_file import read_sweep

__all__ = ["percentiles", "read_sweep", "sensitivities", "sweep", "worst_points"]
