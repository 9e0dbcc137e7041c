"""Derivatives of the variables of the loaded contact, with the layout of its dataset."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
import xarray as xr
from numpy.typing import NDArray

from ....core.ordered_values import ordered
from .loaded_slopes import CaseSlopes
from .rotation_slopes import rotation_slopes

Array = NDArray[Any]

#: Variables of the loaded contact that are differentiated.
OF_LOAD = (
    "transmission_error",
    "mean_level",
    "peak_to_peak",
    "harmonic",
    "rms",
    "load_share",
    "edge_share",
    "force",
    "pressure",
    "max_pressure",
)


def load_variables(loaded: xr.Dataset, found: Sequence[CaseSlopes]) -> dict[str, Any]:
    """Derivatives of the variables ``OF_LOAD``, with their dimensions.

    Parameters
    ----------
    loaded
        From ``MeshCycle.loaded``.
    found
        Derivatives of its cases.
    """
    cycle, count = (loaded.sizes["torque"], loaded.sizes["mesh_position"]), found[0].rotation.size
    pairs, size = loaded["pair"].values, loaded.sizes["segment"]
    rotation = np.full((*cycle, count), np.nan)
    share = np.full((*cycle, pairs.size, count), np.nan)
    on_edges = np.full((*cycle, count), np.nan)
    of_segments = {name: np.full((*cycle, size, count), np.nan) for name in ("force", "pressure")}
    for one in found:
        at, here = (one.case.torque, one.case.mesh_position), one.case.segments
        rotation[at] = 1e6 * one.rotation
        whole = one.case.problem.torque
        moments = here.lever_arm * one.case.solution.force

        def of_whole(own: Array, one: CaseSlopes = one, moments: Array = moments, whole: float = whole) -> Array:
            # The moments add up to the torque, which the last setting changes.
            part = one.moment[own].sum(axis=0) / whole
            part[-1] -= moments[own].sum() / whole * one.moment[:, -1].sum() / whole
            return np.asarray(part)

        for number, pair in enumerate(pairs):
            share[at][number] = of_whole(here.pair == pair)
        on_edges[at] = of_whole(here.edge >= 0)
        of_segments["force"][at][: here.pair.size] = one.force
        of_segments["pressure"][at][: here.pair.size] = one.pressure
    error = ordered(loaded, "transmission_error", "torque", "mesh_position")
    data: dict[str, Any] = {"transmission_error": (("torque", "mesh_position", "setting"), rotation)}
    data |= rotation_slopes(error, rotation, loaded.sizes["order"])
    data["load_share"] = (("torque", "mesh_position", "pair", "setting"), share)
    data["edge_share"] = (("torque", "mesh_position", "setting"), on_edges)
    for name, values in of_segments.items():
        data[name] = (("torque", "mesh_position", "segment", "setting"), values)
    pressure = ordered(loaded, "pressure", "torque", "mesh_position", "segment")
    flat, slopes = pressure.reshape(cycle[0], -1), of_segments["pressure"].reshape(cycle[0], -1, count)
    greatest = np.argmax(np.where(flat > 0.0, flat, -np.inf), axis=1)
    data["max_pressure"] = (("torque", "setting"), slopes[np.arange(cycle[0]), greatest])
    return data
