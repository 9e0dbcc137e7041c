"""Contact without the split beside the analyses: what is kept of it, and how they differ."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cache

import numpy as np
import xarray as xr
from folders import DOCS
from numpy.typing import NDArray

import easeoff
from easeoff.cases import gear_pair
from easeoff.geometry import BlankSection, GearPair, Misalignment
from easeoff.verification import FlankContact

Array = NDArray[np.float64]

FOLDER = DOCS.parent / "tests" / "data" / "contact_reference"
TORQUES = {"fm-11x41": (50.0, 250.0, 500.0), "fh-12x41-45": (50.0, 200.0, 500.0)}
# Misaligned positions of figure 3.7 of the dissertation: case, torque, offset and pinion axial position [mm].
MISALIGNED = {
    "fm-11x41-toe": ("fm-11x41", (50.0,), (-0.08, 0.05)),
    "fm-11x41-heel": ("fm-11x41", (50.0,), (-0.26, 0.13)),
}
NAMES = (*TORQUES, *MISALIGNED)
EDGES = ("all", "on lines")  # which may touch: all, or only where the ease-off method has a line of contact
EDGE_MARGIN = 1.5  # [mm]; nearer to a sharp edge the pressure has no limit


def setting(name: str) -> tuple[str, tuple[float, ...], Misalignment]:
    """Case, torques and misalignment of one kept file."""
    if name in MISALIGNED:
        case, torques, (offset, axial) = MISALIGNED[name]
        return case, torques, Misalignment(offset=offset, pinion_axial=axial)
    return name, TORQUES[name], gear_pair(easeoff.read_case(name)).assembly.misalignment


@cache
def reference(name: str) -> xr.Dataset:
    """Stored contact without the split."""
    with xr.open_dataset(FOLDER / f"{name}.nc", engine="netcdf4") as opened:
        return opened.load()


@cache
def analysed(name: str, model: str, fineness: float = 1.0, edge_contact: bool | None = None) -> xr.DataTree:
    """The same by line contact, with the model ``fe``, ``solid_shell`` or ``shell``; edges as in the case.

    Each tooth has a body of its own, as in the contact without the split.
    """
    case, torques, misalignment = setting(name)
    read = easeoff.read_case(case)
    compliance = read.compliance.model_copy(update={"model": model, "fineness": fineness, "neighbours": False})
    changed = read.model_copy(update={"compliance": compliance})
    return easeoff.analyze(changed, torques=torques, misalignment=misalignment, edge_contact=edge_contact)


@dataclass(frozen=True)
class Difference:
    """An analysis at one torque against the contact without the split.

    Parameters
    ----------
    mean
        Of the transmission error, over its mean [%].
    error
        Greatest difference of the transmission error at one mesh position, over its mean [%].
    peak_to_peak
        Of the reference and of the analysis at the same mesh positions [urad].
    share
        Greatest difference of a load share [% of the load].
    peak
        Of the greatest pressure of the cycle, away from edges [%].
    pressure
        Root mean square difference of the pressure on all lines away from edges, over that greatest pressure [%].
    """

    mean: float
    error: float
    peak_to_peak: tuple[float, float]
    share: float
    peak: float
    pressure: float


def difference(
    name: str, model: str, torque: float, fineness: float = 1.0, edges: str = EDGES[0], edge_contact: bool | None = None
) -> Difference:
    """How an analysis differs from the contact without the split; pressures of the reference always with all edges."""
    kept = reference(name).sel(torque=torque, edges=edges)
    tree = analysed(name, model, fineness, edge_contact if edges == EDGES[0] else False)
    loaded = tree["loaded"].to_dataset().sel(torque=torque)
    same = loaded.sel(mesh_position=kept["mesh_position"])
    theirs, ours = kept["transmission_error"].values, same["transmission_error"].values
    mean = float(theirs.mean())
    shares = same["load_share"].reindex(pair=kept["pair"]).fillna(0.0) - kept["load_share"]
    away = kept["edge_distance"].values > EDGE_MARGIN
    pressures = at_stations(same, kept)
    peak = away_from_edges(kept)
    return Difference(
        100.0 * float(ours.mean() - mean) / mean,
        100.0 * float(np.abs(ours - theirs).max()) / mean,
        (float(np.ptp(theirs)), float(np.ptp(ours))),
        100.0 * float(np.abs(shares).max()),
        100.0 * (float(pressures[away].max()) / peak - 1.0),
        100.0 * float(np.sqrt(np.mean((pressures - kept["pressure"].values)[away] ** 2))) / peak,
    )


def away_from_edges(kept: xr.Dataset) -> float:
    """Greatest pressure of the reference that is no matter of a sharp edge [MPa]."""
    return float(kept["pressure"].values[kept["edge_distance"].values > EDGE_MARGIN].max())


def at_stations(loaded: xr.Dataset, kept: xr.Dataset) -> np.ndarray:
    """Pressures on the lines of an analysis (mesh_position, station) at the stations of the reference, zero beyond."""
    result = np.zeros(kept["pressure"].shape)
    for k in range(kept.sizes["mesh_position"]):
        here, there = loaded.isel(mesh_position=k), kept.isel(mesh_position=k)
        for pair in np.unique(there["tooth"].values[np.isfinite(there["tooth"].values)]):
            own, at = (one["tooth"].values == pair for one in (here, there))
            own &= np.isfinite(here["pressure"].values)
            if np.any(own):
                order = np.argsort(here["lengthwise"].values[own])
                places, values = (here[n].values[own][order] for n in ("lengthwise", "pressure"))
                result[k, at] = np.interp(there["lengthwise"].values[at], places, values, left=0.0, right=0.0)
    return result


def line_stations(pair: GearPair, contact: FlankContact) -> Array:
    """Stations (n) across the contact lines that carry load, at the greatest pressure, from ``contact_of_flanks``.

    Rows (6, n): tooth pair, lengthwise and profile fraction, greatest pressure [MPa], line load [N/mm], distance from
    toe, heel and tip of either member [mm].
    """
    columns = []
    for tooth, cells, force in zip(contact.pairs, contact.cells, contact.force, strict=True):
        pressure = force / cells.area
        for station in np.unique(cells.station[force > 0.0]):
            indices = np.flatnonzero(cells.station == station)
            top = indices[np.argmax(pressure[indices])]
            load = float(pressure[indices] @ cells.sides[indices, 1])
            place = cells.gear_fractions[:, top]
            edge = min(
                edge_distance(pair.gear.section, place),
                edge_distance(pair.pinion.section, cells.pinion_fractions[:, top]),
            )
            columns.append((tooth, *place, pressure[top], load, edge))
    return np.array(columns).T.reshape(6, -1)


def edge_distance(section: BlankSection, place: Array) -> float:
    """Distance of a place (2), as fractions, from toe, heel and tip of its flank [mm]."""
    corners = section.corners
    height = np.linalg.norm(corners[:, 1] - corners[:, 0], axis=1) @ np.array([1.0 - place[0], place[0]])
    length = np.linalg.norm(corners[1, 1] - corners[0, 1])
    return float(min(place[0] * length, (1.0 - place[0]) * length, (1.0 - place[1]) * height))
