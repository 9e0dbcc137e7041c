"""Numbers of a mesh cycle: contact ratio, pattern, place of the greatest pressure, mesh stiffness, as variables."""

from __future__ import annotations

from typing import Any

import numpy as np
import xarray as xr
from numpy.typing import NDArray

from ...core.attributes import labelled
from ...core.ordered_values import ordered
from ..lines.contact_lines import boundary_distance
from ..loaded_cases import LoadedCase
from ..mesh_cycle import MeshCycle
from .carrying_error import CarryingError
from .contact_ratio import loaded_contact_ratio, unloaded_contact_ratio
from .flank_region import FlankRegion, region_below
from .load_spot import load_spot
from .marking_print import MarkingPrint, least_gap
from .mesh_stiffness import mesh_stiffnesses
from .pressure_map import PRESSURE_TOLERANCE, pressure_map
from .pressure_place import LineEnd, PressurePlace
from .projection_plane import ProjectionPlane

Array = NDArray[Any]
READ_BY_TORQUE = [
    *("status", "transmission_error", "tooth", "separation", "lever_arm", "length", "lengthwise", "profile"),
    *("force", "pressure", "load_share"),
]


def with_unloaded_numbers(cycle: MeshCycle, unloaded: xr.Dataset) -> xr.Dataset:
    """The group ``/unloaded`` with contact ratios, marking print, and the error referred to the pinion.

    Parameters
    ----------
    cycle
        The pair in mesh.
    unloaded
        Of ``cycle.unloaded``; its ``separation`` is the thickness of the marking compound.

    Examples
    --------
    >>> from easeoff.cases import gear_pair, read_case
    >>> from easeoff.geometry import pair_geometry
    >>> geometry = pair_geometry(gear_pair(read_case("nasa-12x36")), (9, 7))
    >>> cycle = MeshCycle.of(geometry, mesh_positions=4, segments_per_line=5)
    >>> with_unloaded_numbers(cycle, cycle.unloaded())["contact_ratio"].dims
    ()
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
    """The group ``/loaded`` with contact ratio, pattern, place of load and greatest pressure, and mesh stiffness.

    Parameters
    ----------
    cycle
        The pair in mesh.
    loaded, cases
        Of ``cycle.loaded``.

    Examples
    --------
    >>> from easeoff.cases import gear_pair, read_case
    >>> from easeoff.geometry import pair_geometry
    >>> geometry = pair_geometry(gear_pair(read_case("nasa-12x36")), (9, 7))
    >>> cycle = MeshCycle.of(geometry, mesh_positions=4, segments_per_line=9)
    >>> with_loaded_numbers(cycle, *cycle.loaded([100.0], edge_contact=False))["mesh_stiffness"].dims
    ('torque', 'mesh_position')
    """
    by_torque = [loaded[READ_BY_TORQUE].isel(torque=i) for i in range(loaded.sizes["torque"])]
    positions = loaded.sizes["mesh_position"]
    start = float(loaded["pinion_rotation"].values[0])
    limits = (np.array(cycle.roll_limits) - start) / cycle.pinion_pitch * positions
    stiffness = np.full((len(by_torque), positions), np.nan)
    places_of_cases = np.array([(case.torque, case.mesh_position) for case in cases]).reshape(-1, 2).T
    stiffness[*places_of_cases] = mesh_stiffnesses(cases)
    places = [PressurePlace.of(here, cycle.fields) for here in by_torque]
    plane = ProjectionPlane.of(cycle.geometry.flanks)
    regions = [_loaded_region(here, plane) for here in by_torque]
    ends = np.array([place.line_end for place in places], dtype=np.int8)
    shares = ordered(loaded, "load_share", "torque", "mesh_position", "pair")
    shares = np.where(np.isnan(shares), -np.inf, shares).max(axis=(1, 2))
    numbers = {
        "contact_ratio": ("torque", [loaded_contact_ratio(here, limits) for here in by_torque]),
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
