"""Numbers of a mesh cycle: contact ratio, pattern, place of the greatest pressure, mesh stiffness, as variables.

The contact ratio is the rotation over which one tooth pair is in contact, over the angular pitch (ISO 1122-1, total
ratio). The same number is the mean of how many pairs are in contact at the same time. The *geometric* ratio counts the
whole rotation over which a pair has contact lines: conjugate flanks, or any pair under a load without limit, have it.
Without load one pair carries at a time; counted are rotations at which the pair comes within a separation. Under load a
pair is in contact where it carries.

The mesh stiffness is the torque about the gear axis per rotation of the gear, the pinion held.

The pattern ends at a pressure, and its borders jump from segment to segment. Therefore centre and extent of the normal
forces on the gear flank are given, too: means over the forces change smoothly with settings and torque, also where
further segments begin to touch.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import xarray as xr

from ...core.arrays import Array
from ...core.attributes import labelled, ordered
from ..compliance.weber_line_contact import WeberLineContact
from ..lines.contact_lines import boundary_distance
from ..lines.flank_splines import FlankSplines
from ..loaded import LoadedCase
from ..mesh_cycle import MeshCycle
from ..solvers import Status
from ..solvers.parametric.touching_form import touching_stiffness
from .flank_region import FlankRegion, ProjectionPlane, region_below
from .marking_print import MarkingPrint, least_gap
from .pressure_map import PRESSURE_TOLERANCE, LineEnd, PressurePlace, pressure_map
from .tooth_passage import CarryingError, tooth_passage

PATH = ("path_lengthwise", "path_profile")


def unloaded_contact_ratio(
    splines: FlankSplines, unloaded: xr.Dataset, error: CarryingError, limits: tuple[float, float], separation: float
) -> float:
    """Contact ratio without load: a pair counts while its gap along the normal is within ``separation`` [um].

    NaN if the pair's transmission error is not known. ``limits`` are the roll limits of the mesh cycle [rad].
    """
    if not error.is_known:
        return float("nan")
    places = np.stack([ordered(unloaded, n, "pair", "mesh_position") for n in PATH], axis=-1)
    passage = tooth_passage(unloaded["pair"].values, places)
    known = np.all(np.isfinite(passage.values), axis=1)
    arms = splines("lever_arm", np.clip(passage.values[known].T, 0.0, 1.0))
    steps = error.steps
    rotation = error.rotation(steps)
    ahead = error.of_pair(rotation) - error.least(rotation)
    margin = separation - 1e3 * ahead * np.interp(steps, passage.steps[known], arms)
    return contact_time(steps, margin, error.step(np.array(limits))) / passage.per_cycle


def loaded_contact_ratio(at_torque: xr.Dataset, limits: Array) -> float:
    """Contact ratio at one torque, with roll limits (2) in steps of the mesh cycle; NaN if not certified throughout."""
    names = ("tooth", "separation", "lever_arm")
    tooth, separation, arm = (ordered(at_torque, name, "mesh_position", "segment") for name in names)
    turned = 1e-6 * ordered(at_torque, "transmission_error", "mesh_position")
    pairs = ordered(at_torque, "pair", "pair")
    if not np.all(ordered(at_torque, "status", "mesh_position") == Status.CERTIFIED):
        return float("nan")
    with np.errstate(divide="ignore", invalid="ignore"):
        met = separation / arm
    # A pair carries where the rotation exceeds the least one that closes a gap of it.
    least = np.stack([np.where(tooth == pair, met, np.inf).min(axis=1) for pair in pairs])
    passage = tooth_passage(pairs, np.where(np.isfinite(least), turned - least, np.nan))
    return contact_time(passage.steps, passage.values, limits) / passage.per_cycle


def contact_time(time: Array, margin: Array, limits: Array) -> float:
    """Time over which a margin is positive, straight between its values; NaN where there is no contact line.

    At either end of the evenly spaced times, by one or less, it goes on to where the margin leads to zero or the
    contact lines end (``limits``), at most one unit.
    """
    total, spacing = 0.0, float(time[1] - time[0])
    known = np.concatenate([[False], np.isfinite(margin), [False]])
    for first, beyond in np.flatnonzero(np.diff(known.astype(np.int8))).reshape(-1, 2):
        value, at = margin[first:beyond], time[first:beyond]
        low, high = np.minimum(value[:-1], value[1:]), np.maximum(value[:-1], value[1:])
        with np.errstate(divide="ignore", invalid="ignore"):
            share = np.where(low >= 0.0, 1.0, np.where(high > 0.0, high / (high - low), 0.0))
        total += spacing * float(np.sum(share))
        for sign, end, before, limit in ((-1.0, 0, 1, limits[0]), (1.0, -1, -2, limits[1])):
            if not value[end] > 0.0:
                continue
            fall = value[before] - value[end] if value.size > 1 else 0.0
            way = min(1.0, spacing * float(value[end] / fall)) if fall > 0.0 else 1.0
            left = sign * float(limit - at[end])
            total += min(way, left) if left >= 0.0 else way
    return total


def mesh_stiffnesses(cases: Sequence[LoadedCase]) -> Array:
    """Tangents of the torque over the rotation (c) [N m/urad], r . (B + D)^-1 r; NaN where a case is not certified.

    B bending compliance, D tangent of the line contacts, r lever arms of the touching segments. Where a segment is
    about to touch, it is the stiffness before it does. The solution gives it, or else the system of touching segments.
    """
    known = np.array([case.solution.stiffness if case.solution.certified else np.nan for case in cases])
    result = 1e-9 * known
    certified = [n for n, case in enumerate(cases) if case.solution.certified and not np.isfinite(known[n])]
    if not certified:
        return result
    contacts = WeberLineContact.joined([cases[number].segments.line_contact for number in certified])
    forces = [cases[number].solution.force for number in certified]
    tangents = np.split(contacts.tangent(np.concatenate(forces)), np.cumsum([force.size for force in forces])[:-1])
    for number, force, tangent in zip(certified, forces, tangents, strict=True):
        segments = cases[number].segments
        result[number] = 1e-9 * touching_stiffness(tangent, segments.bending, segments.lever_arm, force > 0.0)
    return result


WAYS = ("lengthwise", "profile")


def load_spot(loaded: xr.Dataset) -> dict[str, tuple[tuple[str, ...], Array]]:
    """Load-weighted centre and rms extents on the gear (fractions) by torque; NaN where a position is not certified."""
    dims = ("torque", "mesh_position", "segment")
    force = np.nan_to_num(ordered(loaded, "force", *dims))
    certified = np.all(ordered(loaded, "status", *dims[:2]) == Status.CERTIFIED, axis=1)
    whole = np.where(certified, force.sum(axis=(1, 2)), np.nan)
    centres: dict[str, tuple[tuple[str, ...], Array]] = {}
    extents: dict[str, tuple[tuple[str, ...], Array]] = {}
    for way in WAYS:
        place = np.nan_to_num(ordered(loaded, way, *dims))
        centre = np.sum(force * place, axis=(1, 2)) / whole
        away = place - centre[:, None, None]
        centres[f"load_centre_{way}"] = (("torque",), centre)
        extents[f"load_extent_{way}"] = (("torque",), np.sqrt(np.sum(force * away**2, axis=(1, 2)) / whole))
    return centres | extents


READ_BY_TORQUE = [
    "status",
    "transmission_error",
    "tooth",
    "separation",
    "lever_arm",
    "length",
    "lengthwise",
    "profile",
    "force",
    "pressure",
    "load_share",
]


def with_unloaded_numbers(cycle: MeshCycle, unloaded: xr.Dataset) -> xr.Dataset:
    """The group ``/unloaded`` with contact ratios, marking print, and the error referred to the pinion.

    Its ``separation`` is the thickness of the marking compound.
    """
    error = CarryingError.of(unloaded, cycle.pinion_pitch)
    limits = cycle.roll_limits
    separation = float(unloaded.attrs["separation"])
    axes = [cycle.geometry.ease_off[name].values for name in ("lengthwise", "profile")]
    nodes = np.stack(np.meshgrid(*axes, indexing="ij"))
    gap = np.where(boundary_distance(cycle.fields, nodes) >= 0.0, least_gap(cycle.fields, error, nodes), np.nan)
    plane = ProjectionPlane.of(cycle.geometry.flanks)
    printed = MarkingPrint.of(cycle.fields, error, separation, whole=False).region(plane)
    numbers = {
        "contact_ratio": unloaded_contact_ratio(cycle.fields, unloaded, error, limits, separation),
        "geometric_contact_ratio": (limits[1] - limits[0]) / cycle.pinion_pitch,
        "pinion_peak_to_peak": cycle.ratio * unloaded.attrs["peak_to_peak"],
        "least_gap": (("lengthwise", "profile"), gap),
        **{name: (name, values) for name, values in zip(("lengthwise", "profile"), axes, strict=True)},
        **{name: float(values[0]) for name, values in _pattern([printed]).items()},
    }
    return labelled(unloaded.assign(numbers))


def with_loaded_numbers(cycle: MeshCycle, loaded: xr.Dataset, cases: list[LoadedCase]) -> xr.Dataset:
    """The group ``/loaded`` with contact ratio, pattern, place of load and greatest pressure, and mesh stiffness."""
    by_torque = [loaded[READ_BY_TORQUE].isel(torque=i) for i in range(loaded.sizes["torque"])]
    positions = loaded.sizes["mesh_position"]
    start = float(loaded["pinion_rotation"].values[0])
    limits = (np.array(cycle.roll_limits) - start) / cycle.pinion_pitch * positions
    stiffness = np.full((len(by_torque), positions), np.nan)
    places_of_cases = np.array([(case.torque, case.mesh_position) for case in cases]).reshape(-1, 2).T
    stiffness[*places_of_cases] = mesh_stiffnesses(cases)
    places = [PressurePlace.of(at_torque, cycle.fields) for at_torque in by_torque]
    plane = ProjectionPlane.of(cycle.geometry.flanks)
    regions = [_loaded_region(at_torque, plane) for at_torque in by_torque]
    ends = np.array([place.line_end for place in places], dtype=np.int8)
    shares = ordered(loaded, "load_share", "torque", "mesh_position", "pair")
    shares = np.where(np.isnan(shares), -np.inf, shares).max(axis=(1, 2))
    numbers = {
        "contact_ratio": ("torque", [loaded_contact_ratio(at_torque, limits) for at_torque in by_torque]),
        "max_load_share": ("torque", np.where(np.isfinite(shares), shares, np.nan)),
        "pinion_mean_level": ("torque", cycle.ratio * ordered(loaded, "mean_level", "torque")),
        "pinion_peak_to_peak": ("torque", cycle.ratio * ordered(loaded, "peak_to_peak", "torque")),
        "mesh_stiffness": (("torque", "mesh_position"), stiffness),
        "mean_mesh_stiffness": ("torque", stiffness.mean(axis=1)),
        "max_pressure_position": ("torque", [place.mesh_position for place in places]),
        "max_pressure_pair": ("torque", [place.pair for place in places]),
        "max_pressure_lengthwise": ("torque", [place.point[0] for place in places]),
        "max_pressure_profile": ("torque", [place.point[1] for place in places]),
        "max_pressure_line_end": ("torque", ends, LineEnd.flag_attributes()),
        **{name: ("torque", values) for name, values in _pattern(regions).items()},
        **load_spot(loaded),
    }
    return labelled(loaded.assign(numbers))


def _loaded_region(at_torque: xr.Dataset, plane: ProjectionPlane) -> FlankRegion:
    """Part of the gear flank that carries at one torque, its extent with the edges that carry."""
    surface = pressure_map(at_torque)
    region = region_below(surface.points, np.full(surface.pressure.size, -1.0), surface.triangles, 0.0, plane)
    force = at_torque["force"].values
    sharp = (force > PRESSURE_TOLERANCE * np.nanmax(force, initial=0.0)) & np.isnan(at_torque["pressure"].values)
    return region.reaching(np.stack([at_torque[name].values[sharp] for name in ("lengthwise", "profile")]))


def _pattern(regions: list[FlankRegion]) -> dict[str, Array]:
    """Centre, length and height of contact patterns (n)."""
    centre, size = (np.array([getattr(region, name) for region in regions]) for name in ("centre", "size"))
    return {
        "pattern_centre_lengthwise": centre[:, 0],
        "pattern_centre_profile": centre[:, 1],
        "pattern_length": size[:, 0],
        "pattern_height": size[:, 1],
    }
