"""V-H check for the report: table, prints at toe, middle and heel, and those over the grid of V and H."""

from __future__ import annotations

from typing import Any

import numpy as np
import xarray as xr
from numpy.typing import NDArray

from ....core.attributes import ordered
from ..vh_table import SIGNS, reasons, totals, vh_rows
from .packed_array import packed

Array = NDArray[Any]
GRID = ("lengthwise", "profile")
COARSER = 2  # prints of the grid, which are drawn small
MARGIN = 0.04  # around a print, of its length
HEADS = ("", "V [mm]", "H [mm]", "centre at toe, root [%]", "from, to toe [%]", "height [%]", "peak to peak [µrad]")
VARIABLES = "v, h, pattern_centre_lengthwise, pattern_centre_profile, pattern_from, pattern_to, pattern_height"


def vh_part(name: str, found: xr.Dataset) -> dict[str, Any]:
    """A V-H check for the page.

    Examples
    --------
    >>> from easeoff.study import vh_check
    >>> part = vh_part("check", vh_check("fh-design-a"))
    >>> [one["name"] for one in part["places"]], part["grid"]
    (['toe', 'middle', 'heel'], None)
    """
    plane = ordered(found, "in_plane", "plane_axis", *GRID)
    (left, bottom), (right, top) = plane.min(axis=(1, 2)), plane.max(axis=(1, 2))
    margin = MARGIN * (right - left)
    rows = [[*row, *[""] * (len(HEADS) - len(row))] for row in vh_rows(found)]
    return {
        "name": name,
        "title": str(found.attrs.get("title", "")),
        "flank": str(found.attrs.get("flank", "")),
        "thickness": float(found.attrs.get("separation", np.nan)),
        "flanks": {
            "gear": {
                "plane": _bilinear(plane).tolist(),
                "window": [left - margin, right + margin, bottom - margin, top + margin],
                "common": [],
            }
        },
        "table": {"heads": list(HEADS), "rows": rows, "variables": [*VARIABLES.split(", "), "peak_to_peak"]},
        "total": "; ".join([totals(found), *SIGNS]),
        "reasons": reasons(found),
        "places": [_place(found.sel(place=place)) for place in found["place"].values],
        "grid": _grid(found) if "grid_print_excess" in found else None,
    }


def _bilinear(plane: Array) -> Array:
    """Coefficients (2, 4) of 1, t, h and t h of a bilinear grid (2, m, n), from its corners."""
    first, along, up, both = plane[:, 0, 0], plane[:, -1, 0], plane[:, 0, -1], plane[:, -1, -1]
    return np.stack([first, along - first, up - first, both - along - up + first], axis=1)


def _place(one: xr.Dataset) -> dict[str, Any]:
    excess = ordered(one, "print_excess", *GRID)
    return {
        "name": str(one["place"].values),
        "v": _number(one["v"]),
        "h": _number(one["h"]),
        "print": _print(excess),
        "wanted": [_number(one[f"place_{name}"]) for name in GRID],
        "centre": [_number(one[f"pattern_centre_{name}"]) for name in GRID],
    }


def _grid(found: xr.Dataset) -> dict[str, Any]:
    """Prints over V and H, row by row of H from the greatest one down."""
    prints = ordered(found, "grid_print_excess", "v_grid", "h_grid", *GRID)
    centre = [ordered(found, f"grid_pattern_centre_{name}", "v_grid", "h_grid") for name in GRID]
    drawn = prints[..., ::COARSER, ::COARSER]
    cells = [
        [
            {"print": _print(drawn[i, j]), "centre": [_finite(values[i, j]) for values in centre]}
            for i in range(prints.shape[0])
        ]
        for j in reversed(range(prints.shape[1]))
    ]
    return {"v": found["v_grid"].values.tolist(), "h": found["h_grid"].values[::-1].tolist(), "cells": cells}


def _print(excess: Array) -> dict[str, Any] | None:
    """Where the gap is less than the compound is thick, negative; ``None`` where the flanks do not meet."""
    return packed(np.clip(excess, -1.0, 1.0)) if np.any(np.isfinite(excess)) else None


def _number(value: xr.DataArray) -> float | None:
    return _finite(float(value))


def _finite(value: float) -> float | None:
    return float(value) if np.isfinite(value) else None
