"""Mesh positions where the greatest pressure stands out of its course, for run, show and pictures."""

from __future__ import annotations

import numpy as np
import xarray as xr
from numpy.typing import NDArray

Array = NDArray[np.float64]

#: Part by which the greatest pressure at a position exceeds that at both neighbours to be told. Shipped cases, either
#: flank, aligned or not, at 20 to 800 N m, have up to 0.12 at 32 mesh positions, where edges carry; less at more.
JUMP_LIMIT = 0.125
MESH_POSITION_MINIMUM = 16  # with fewer the course itself changes as much from one position to the next


def pressure_jumps(loaded: xr.Dataset) -> Array:
    """Part by which the greatest pressure at a mesh position exceeds the greater of those at its neighbours.

    The first and the last position of a cycle are neighbours.

    Parameters
    ----------
    loaded
        The group ``/loaded``.

    Returns
    -------
    Array
        Over (torque, mesh_position), negative where a neighbour has more; NaN where one of the three is not certified.

    Examples
    --------
    >>> course = np.array([[[500.0], [510.0], [765.0], [505.0]]])
    >>> loaded = xr.Dataset({"pressure": (("torque", "mesh_position", "segment"), course)})
    >>> pressure_jumps(loaded).round(2).tolist()
    [[-0.02, -0.33, 0.5, -0.34]]
    """
    pressure = loaded["pressure"].transpose("torque", "mesh_position", "segment").values
    greatest = np.where(np.isfinite(pressure), pressure, -np.inf).max(axis=2)
    greatest = np.where(greatest > 0.0, greatest, np.nan)
    beside = np.maximum(np.roll(greatest, 1, axis=1), np.roll(greatest, -1, axis=1))
    return np.asarray(greatest / beside - 1.0)


def jump_notes(loaded: xr.Dataset) -> list[str]:
    """Note on the mesh position whose greatest pressure exceeds that at its neighbours most, if by ``JUMP_LIMIT``.

    Parameters
    ----------
    loaded
        The group ``/loaded``.

    Returns
    -------
    list of str
        One note, or none.

    Examples
    --------
    >>> import easeoff
    >>> jump_notes(easeoff.analyze("nasa-12x36", torques=[100.0])["loaded"].to_dataset())
    []
    """
    if loaded.sizes["mesh_position"] < MESH_POSITION_MINIMUM:
        return []
    jumps = np.nan_to_num(pressure_jumps(loaded), nan=-1.0)
    if not jumps.max(initial=-1.0) > JUMP_LIMIT:
        return []
    torque, position = (int(i) for i in np.unravel_index(int(np.argmax(jumps)), jumps.shape))
    pressure = loaded["pressure"].isel(torque=torque, mesh_position=position).max().item()
    others = np.count_nonzero(np.delete(jumps.max(axis=1), torque) > JUMP_LIMIT)
    more = f", and likewise at {others} more torque{'s' if others > 1 else ''}" if others else ""
    return [
        f"Note: at {loaded['torque'].values[torque]:g} N m the greatest pressure jumps to {pressure:.0f} MPa at mesh "
        f"position {loaded['mesh_position'].values[position]:.4g}, {100.0 * jumps[torque, position]:.0f} % above both "
        f"neighbouring positions{more}: more mesh_positions and segments_per_line show whether it is the contact's or "
        "the grid's."
    ]
