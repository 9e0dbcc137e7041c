"""Least film thickness of a mesh cycle, and where it is."""

from __future__ import annotations

import numpy as np
import xarray as xr

from ..core.attributes import labelled


def with_least_film(friction: xr.Dataset, loaded: xr.Dataset) -> xr.Dataset:
    """The group ``/friction`` with the least film over the mesh cycle, if its fields over the segments were kept."""
    if "film_thickness" not in friction:
        return friction
    film = friction["film_thickness"].transpose("mesh_position", "segment", "torque", ...)
    flat = np.where(np.isfinite(film.values), film.values, np.inf).reshape(-1, *film.shape[2:])
    least = np.argmin(flat, axis=0)
    known = np.isfinite(flat.min(axis=0))
    position, segment = np.unravel_index(least, film.shape[:2])
    dims = film.dims[2:]
    torque = np.arange(film.sizes["torque"]).reshape(-1, *(1,) * (least.ndim - 1))
    table = loaded[["lengthwise", "profile"]].transpose("torque", "mesh_position", "segment")
    points = {f"min_film_{name}": table[name].values[torque, position, segment] for name in ("lengthwise", "profile")}
    numbers = {
        "min_film_thickness": flat.min(axis=0),
        "min_film_position": loaded["mesh_position"].values[position],
        **points,
    }
    conditions = friction["efficiency"]
    # Without feedback the film is the same at every roughness.
    missing = len(conditions.dims) - len(dims)
    variables = {}
    for name, value in numbers.items():
        known_value = np.where(known, value, np.nan)
        spread = np.broadcast_to(known_value.reshape(*known_value.shape, *[1] * missing), conditions.shape)
        variables[name] = (conditions.dims, spread.copy())
    return labelled(friction.assign(variables))
