"""Deviations of a case's flanks, from files, datasets or formulas, and the geometry of the pair with them."""

from __future__ import annotations

import os
from collections.abc import Iterator, Mapping
from dataclasses import replace
from importlib import resources
from pathlib import Path
from typing import Literal, get_args

import numpy as np
import xarray as xr

from ..cases.shipped_files import shipped_deviations as shipped_deviations
from ..core.attributes import units_of
from ..core.checks import instance, one_of
from ..core.errors import GeometryError, InputError, printable, shortened
from ..core.netcdf_file import read_dataset
from ..geometry.deviation.deviated_flank import deviated_ease_off, deviated_pair
from ..geometry.deviation.deviation import Deviation, Method, deviation_from_dataset, require_method
from ..geometry.formats.csv_points import COORDINATE_LIMIT, GRID_SIZE_LIMIT
from ..geometry.formats.measured_grid import NOMINAL_DISTANCE_LIMIT, SUFFIXES, flank_deviation, read_measured_grid
from ..geometry.pair.gear_pair import GearPair, Member, PairGeometry, pair_geometry
from ..geometry.tooth.tooth_flanks import MemberName, named_member

Source = Deviation | xr.Dataset | str | Path
Deviated = Literal["ease_off", "surface"]
LOST_CONTACT_LIMIT = 0.002  # of the points of the contact lines; with less, update and surfaces agree to a percent


def measured_file(name_or_path: str | Path, member: Member | None = None) -> xr.Dataset:
    """A measured grid that comes with the package (by name), or of a file (by path).

    Parameters
    ----------
    name_or_path
        Name or path.
    member
        The member as designed, for a file that is a table of deviations without points.

    Raises
    ------
    InputError
        If there is neither, or the file cannot be used.

    Examples
    --------
    >>> measured_file("fm-11x41-worn-gear").attrs["member"]
    'gear'
    """
    name = str(name_or_path)
    if name in shipped_deviations():
        with resources.as_file(resources.files("easeoff.cases").joinpath("deviations", f"{name}.csv")) as path:
            return read_measured_grid(path)
    if not Path(name).suffix and not os.path.exists(name):
        raise InputError(
            f"deviation {name!r}: there is no such file ({', '.join(SUFFIXES)}), and the shipped ones are: "
            f"{', '.join(shipped_deviations())}"
        )
    return read_measured_grid(name_or_path, member)


def _from_file(name_or_path: str | Path, name: MemberName, pair: GearPair) -> xr.Dataset:
    """A measured grid; or, of a file of ``study.wear``, what it leaves of a member's flank."""
    path = Path(name_or_path)
    if path.suffix == ".nc" and os.path.isfile(path):
        opened = read_dataset(path)
        if "wear_depth" in opened:
            _require_own_flank(path, opened, name, pair)
            return opened[["deviation"]].isel(step=-1).sel(member=name)
    return measured_file(name_or_path, named_member(pair, name))


def _require_own_flank(path: Path, worn: xr.Dataset, name: MemberName, pair: GearPair) -> None:
    """Refuse wear of another flank, known by its teeth and by the positions of its designed nodes.

    As for measured grids: blank and machine settings count as far as they move the flank, torque, friction and assembly
    errors not at all, and the flank may be turned about its axis.
    """
    lacking = [word for word, there in _wear_layout(worn) if not there]
    if lacking:
        raise InputError(
            f"deviation {name} = {path}: the file is incomplete, damaged or does not say for which flanks it was made: "
            f"no {lacking[0]}; make it anew with 'easeoff wear'"
        )
    teeth = (int(worn.attrs["pinion_teeth"]), int(worn.attrs["gear_teeth"]))
    own_teeth = (pair.assembly.pinion_teeth, pair.assembly.gear_teeth)
    off = _apart(named_member(pair, name), worn.sel(member=name))
    if teeth == own_teeth and off <= NOMINAL_DISTANCE_LIMIT:
        return
    other = [] if teeth == own_teeth else [f"this pair has {own_teeth[0]} x {own_teeth[1]} teeth"]
    if off > NOMINAL_DISTANCE_LIMIT:
        far = f"up to {off:.3g} mm" if np.isfinite(off) else "altogether"
        other.append(f"its {name} flank is {far} off the designed one here ({NOMINAL_DISTANCE_LIMIT:g} mm are allowed)")
    title = printable(shortened(str(worn.attrs.get("title", "no title"))))
    raise InputError(
        f"deviation {name} = {path}: made by 'easeoff wear' for another pair or for the other flanks: "
        f"{title!r}, {printable(str(worn.attrs.get('flank', 'unknown')))} flanks, "
        f"{teeth[0]} x {teeth[1]} teeth; {' and '.join(other)}. Give the case and the flank that it was made for, or "
        "wear this one"
    )


def _wear_layout(worn: xr.Dataset) -> Iterator[tuple[str, bool]]:
    """Contents that a file of wear must have to be read, each with True if it is there."""
    grid = ("lengthwise", "profile")
    for name, dimensions in (("deviation", {"step", "member", *grid}), ("position", {"member", *grid, "xyz"})):
        there = name in worn.variables and set(worn[name].dims) == dimensions and worn[name].dtype.kind == "f"
        units = units_of(name)
        known = there and worn[name].attrs.get("units", units) == units
        yield f"numbers {name!r} [{units}] over {', '.join(sorted(dimensions))}", known
    for name in grid:
        values = worn[name].values if name in worn.coords else np.zeros(0)
        numbers = values.dtype.kind == "f" and values.ndim == 1 and 2 <= values.size <= GRID_SIZE_LIMIT
        within = numbers and np.all(np.diff(values) > 0.0) and np.all(np.abs(values - 0.5) <= 0.5 + 1e-9)
        yield f"fractions {name!r}", bool(within)
    members = [str(value) for value in worn["member"].values] if "member" in worn.indexes else []
    yield "members 'pinion' and 'gear'", sorted(members) == sorted(get_args(MemberName))
    yield "step", worn.sizes.get("step", 0) > 0
    yield "three coordinates 'xyz'", worn.sizes.get("xyz") == 3
    for name in ("pinion_teeth", "gear_teeth"):
        yield f"attribute {name!r}", isinstance(worn.attrs.get(name), int | np.integer)


def _apart(member: Member, worn: xr.Dataset) -> float:
    """Greatest distance of a file's nodes from the designed flank [mm], turned to fit; infinite if too few compare."""
    there = worn["position"].transpose("xyz", "lengthwise", "profile").values.reshape(3, -1)
    designed_points = member.flank(worn["lengthwise"].values, worn["profile"].values).position
    both = np.all((np.abs(there) <= COORDINATE_LIMIT) & np.isfinite(designed_points), axis=0)
    if 2 * np.count_nonzero(both) < both.size:
        return float("inf")
    there, designed_points = there[:, both], designed_points[:, both]
    turned = np.arctan2(there[1], there[0]) - np.arctan2(designed_points[1], designed_points[0])
    turned = np.mod(turned - turned[0] + np.pi, 2.0 * np.pi) - np.pi
    radius = np.hypot(designed_points[0], designed_points[1])
    around = radius * (turned - np.median(turned))
    outward = np.hypot(there[0], there[1]) - radius
    return float(np.max(np.sqrt(around**2 + outward**2 + (there[2] - designed_points[2]) ** 2)))


def flank_deviations(
    pair: GearPair, sources: Mapping[MemberName, Source] | None, interpolation: Method = "spline"
) -> dict[str, Deviation]:
    """Deviations of the loaded flanks of a pair, by member; InputError if a source is unfit or of another flank.

    A source is a ``Deviation``, a dataset (a measured grid, or ``deviation`` over lengthwise and profile), the path of
    a measured grid or of a result of ``study.wear``, or the name of a shipped grid; ``None`` for no deviations.
    """
    require_method(interpolation)
    instance("deviations", sources, Mapping | None)
    deviations = {}
    for name, source in (sources or {}).items():
        member = named_member(pair, name)
        grid = _from_file(source, name, pair) if isinstance(source, str | Path) else source
        if isinstance(grid, xr.Dataset):
            try:
                deviations[str(name)] = (
                    flank_deviation(grid, member, interpolation)
                    if "row" in grid.dims
                    else deviation_from_dataset(member.section, grid, interpolation)
                )
            except InputError as error:
                if grid is source:
                    raise
                raise InputError(f"deviation {name} = {printable(str(source))}: {error}") from error
        elif not isinstance(grid, Deviation):
            raise InputError(
                f"the deviation of the {name} is a {type(grid).__name__}: give a file, a dataset or a Deviation, as "
                "geometry.deviation_from_formula makes it"
            )
        elif grid.section != member.section:
            raise InputError(f"the deviation of the {name} was made for another blank: use the section of this member")
        else:
            deviations[str(name)] = grid
    return deviations


def deviated_geometry(
    pair: GearPair, nodes: tuple[int, int], deviations: Mapping[str, Deviation], deviated: Deviated = "ease_off"
) -> PairGeometry:
    """The geometry of a pair whose flanks deviate, with grid nodes lengthwise and along the profile.

    ``ease_off``: the ease-off of the designed flanks is updated; ``surface``: the flanks themselves deviate.
    """
    one_of("deviated", deviated, get_args(Deviated))
    if deviations and deviated == "surface":
        pair = deviated_pair(pair, pinion=deviations.get("pinion"), gear=deviations.get("gear"))
    return updated_geometry(pair_geometry(pair, nodes), deviations, deviated)


def updated_geometry(
    geometry: PairGeometry, deviations: Mapping[str, Deviation], deviated: Deviated = "ease_off"
) -> PairGeometry:
    """The geometry of a pair with its ease-off updated for deviations, unless its surfaces have them already."""
    if not deviations or deviated == "surface":
        return geometry
    ease_off = deviated_ease_off(geometry, pinion=deviations.get("pinion"), gear=deviations.get("gear"))
    return replace(geometry, ease_off=ease_off)


def require_line_contact(lost: float, deviations: Mapping[str, Deviation]) -> None:
    """Refuse deviating flanks without line contact (``MeshCycle.lost_contact``); designed ones never are refused."""
    if lost <= LOST_CONTACT_LIMIT or not deviations:
        return
    scatter = {name: 1e3 * deviation.scatter for name, deviation in deviations.items()}
    worst = max(scatter, key=lambda name: scatter[name])
    raise GeometryError(
        f"with these deviations the flanks have no line contact at {100 * lost:.1f} % of the points of the contact "
        f"lines: the flank of the {worst} bends too much from node to node (it scatters by {scatter[worst]:.1f} um rms "
        "about a surface of third order). Measure outliers again or leave them out, or smooth the deviation: "
        "interpolation 'smooth'"
    )


def deviation_attributes(deviations: Mapping[str, Deviation], deviated: str) -> dict[str, float | str]:
    """Deviations of an analysis, as netCDF attributes of its result."""
    if not deviations:
        return {}
    largest = {f"largest_deviation_{n}_um": 1e3 * float(np.max(np.abs(d.value))) for n, d in deviations.items()}
    return {"deviated": deviated, **largest}
