"""The stored studies of the film model: the design of the dissertation, a refined one, and one with moving profiles."""

from __future__ import annotations

import xarray as xr
from places import DOCS

DATA = DOCS / "data"
STUDY_FILES = tuple(DATA / name for name in ("friction_study.nc", "friction_study_refined.nc"))
#: A subset of the first with moving profiles instead, which the formula is not fitted to.
RIDGES_FILE = DATA / "friction_study_ridges.nc"


def stored_studies() -> tuple[xr.Dataset, ...]:
    """The two studies that the formula is fitted to."""
    return tuple(xr.load_dataset(path, engine="netcdf4") for path in STUDY_FILES)
