"""Pictures of a result on their pages: drawn once for the tests that read them or write them to files."""

from __future__ import annotations

from functools import cache

import xarray as xr
from matplotlib.figure import Figure
from runs import read_only, small

from easeoff import analyze, plot

TORQUES = [50.0, 100.0, 200.0]


@cache
def drawn_result() -> xr.DataTree:
    """A result with friction."""
    return read_only(analyze(small(compliance="shell"), torques=TORQUES, speed=[500.0, 1500.0]))


@cache
def drawn_pages() -> dict[str, Figure]:
    """Every picture of it."""
    return {name: getattr(plot, name)(drawn_result()) for name in plot.pictures(drawn_result())}
