"""Nominal points of a member's flanks for coordinate measuring machines, and their files."""

from __future__ import annotations

import os
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np
import xarray as xr

from ...core.arrays import Array
from ...core.attributes import labelled, units_of
from ...core.checks import array, bounded, check_fields, file_path, instance, number, shown, whole
from ...core.errors import GeometryError, InputError
from ...core.netcdf_file import read_dataset, write_netcdf
from ...core.output_file import whole_file
from ...core.regular_file import LINE_LENGTH_LIMIT, TABLE_SIZE_LIMIT, read_text
from ..flanks.blank_section import BlankSection
from ..flanks.flank import Flank, NodeStatus
from ..pair.gear_pair import Member
from ..tooth.tooth_flanks import PlacedFlank, placed_flanks, side
from . import csv_points as cmm_csv

FORMAT = "easeoff measurement points"
GRID_FORMAT = "easeoff measured grid"
FORMAT_VERSION = 1
DEFAULT_MARGIN_SHARE = 0.1  # of the face width at toe and heel, of the mean depth of the flank at root and tip
# Tried in this order where the flank ends early.
ROOT_MARGIN_SHARES = (DEFAULT_MARGIN_SHARE, 0.15, 0.2, 0.25, 0.3, 0.35, 0.4)
SUFFIXES = (".csv", ".nc")
MARGIN = bounded("mm", least=0.0)


@dataclass(frozen=True)
class EdgeMargins:
    """Strips of a flank that are not measured [mm], at right angles to its edges in the axial section.

    ``None`` stands for a tenth of the face width (toe, heel) or of the mean depth of the flank (root, tip). At the root
    it is more, in steps of a twentieth of the depth, where the flank ends above its root line (short blade, undercut).

    Examples
    --------
    >>> from easeoff.cases import gear_pair, read_case
    >>> section = gear_pair(read_case("nasa-12x36")).gear.section
    >>> EdgeMargins(toe=2.0, heel=2.0, root=1.0, tip=0.5).of(section)["tip"]
    0.5
    """

    toe: float | None = field(default=None, metadata=MARGIN)
    heel: float | None = field(default=None, metadata=MARGIN)
    root: float | None = field(default=None, metadata=MARGIN)
    tip: float | None = field(default=None, metadata=MARGIN)

    def __post_init__(self) -> None:
        check_fields(self, "edge margin ")

    def of(self, section: BlankSection, root_share: float = DEFAULT_MARGIN_SHARE) -> dict[str, float]:
        """The four margins on a blank [mm].

        Parameters
        ----------
        section
            The blank.
        root_share
            Default of the margin at the root, as a share of the mean depth of the flank.
        """
        corners = section.corners
        depth = float(np.mean(np.linalg.norm(corners[:, 1] - corners[:, 0], axis=-1)))
        along, up = DEFAULT_MARGIN_SHARE * section.face_width, DEFAULT_MARGIN_SHARE * depth
        usual = {"toe": along, "heel": along, "root": root_share * depth, "tip": up}
        return {name: float(usual[name] if value is None else value) for name, value in vars(self).items()}


def cmm_points(
    member: Member,
    rows: int = 5,
    columns: int = 9,
    edge_margins: EdgeMargins | None = None,
    *,
    tooth_angle: float | None = None,
    tolerance: tuple[float, float] | None = None,
) -> xr.Dataset:
    """Nominal points and normals of a member's flanks on a measuring grid.

    Parameters
    ----------
    member
        The member.
    rows
        Rows from root to tip, at least 2; row 1 runs along the root.
    columns
        Columns from toe to heel, at least 2; column 1 stands at the toe.
    edge_margins
        Strips left out at the edges.
    tooth_angle
        Angular thickness of the tooth in the middle of the flank [rad], from ``tooth_flanks.tooth_angle``; it
        puts both flanks of one tooth into one frame. Without it the loaded flank comes alone, as it does for a member
        whose other flank is not known.

    tolerance
        Lower and upper limit of the deviation of every point [um], along the outward normal.

    Returns
    -------
    xr.Dataset
        ``position`` [mm] and outward unit ``normal`` over (flank, row, column, xyz), in the member's frame; over
        (flank, row, column) the place from 0 to 1, ``lengthwise`` from toe to heel and ``profile`` from root to tip,
        and with a tolerance ``lower_tolerance`` and ``upper_tolerance`` [um].

    Raises
    ------
    InputError
        If the grid is too small, the margins leave no flank, or the upper limit is not above the lower one.
    GeometryError
        If a point of the grid lies off the flank.

    Examples
    --------
    >>> from easeoff.cases import gear_pair, read_case
    >>> points = cmm_points(gear_pair(read_case("nasa-12x36")).gear, rows=3, columns=5)
    >>> dict(points["position"].sizes)
    {'flank': 1, 'row': 3, 'column': 5, 'xyz': 3}
    """
    instance("member", member, Member)
    for name, count in (("rows", rows), ("columns", columns)):
        whole(name, count, 2, cmm_csv.GRID_SIZE_LIMIT)
    instance("edge_margins", edge_margins, EdgeMargins | None)
    limits = None if tolerance is None else array("tolerance", tolerance, "um", ndim=1, size=2)
    if limits is not None and not limits[0] < limits[1]:
        raise InputError(
            f"tolerance = {limits[0]:g}, {limits[1]:g}: must be a lower limit and a greater upper one [um]"
        )
    given = edge_margins or EdgeMargins()
    flanks = {side(member.loaded): PlacedFlank(member.section, member.loaded)}
    attributes: dict[str, Any] = {}
    if tooth_angle is not None and number("tooth_angle", tooth_angle, "rad") and member.opposite is not None:
        flanks = placed_flanks(member, tooth_angle)
        attributes["tooth_angle_rad"] = float(tooth_angle)
    names = sorted(flanks)
    for share in ROOT_MARGIN_SHARES:
        margins = given.of(member.section, share)
        axial, radial = _grid(member.section, margins, rows, columns)
        points = [flanks[name].at(axial, radial) for name in names]
        if given.root is not None or all(np.all(flank.inside) for flank in points):
            break
    for name, flank in zip(names, points, strict=True):
        _check_measurable(name, flank, columns)
    values = np.stack([np.concatenate([flank.position, flank.normal]).T.reshape(rows, columns, 6) for flank in points])
    lengthwise, profile = member.section.fractions(axial.reshape(rows, columns), radial.reshape(rows, columns))
    more: dict[str, Any] = {"lengthwise": lengthwise, "profile": profile}
    if limits is not None:
        more |= {"lower_tolerance": limits[0], "upper_tolerance": limits[1]}
    variables = {name: (("flank", "row", "column"), np.full(values.shape[:3], value)) for name, value in more.items()}
    attributes = {
        "format": FORMAT,
        "format_version": FORMAT_VERSION,
        "length_unit": "mm",
        "frame": "member: z along its axis from the crossing point to the heel, right-handed, tooth near x",
        "normals": "unit vectors out of the tooth",
        "deviation": "positive outward, along the normal",
        "grid": "row 1 at the root, last row at the tip; column 1 at the toe, last column at the heel",
        "number_of_teeth": member.teeth,
        "hand_of_spiral": member.loaded.hand,
        **attributes,
        **{f"margin_{name}_mm": value for name, value in margins.items()},
    }
    return labelled(cmm_csv.point_grid(names, values, variables, attributes))


def _grid(section: BlankSection, margins: dict[str, float], rows: int, columns: int) -> tuple[Array, Array]:
    """Axial and radial coordinates (rows * columns) [mm]: the flank's own quadrilateral, each edge moved inwards."""
    outer = section.corners
    middle = outer.mean(axis=(0, 1))
    edges = {"toe": outer[0], "heel": outer[1], "root": outer[:, 0], "tip": outer[:, 1]}
    normals, levels = {}, {}
    for name, (start, end) in edges.items():
        along = (end - start) / np.linalg.norm(end - start)
        inward = np.array([-along[1], along[0]])
        inward = inward * np.sign(inward @ (middle - start))
        normals[name], levels[name] = inward, inward @ start + margins[name]
    inner = np.empty_like(outer)
    for i, end_name in enumerate(("toe", "heel")):
        for j, edge in enumerate(("root", "tip")):
            matrix = np.stack([normals[end_name], normals[edge]])
            inner[i, j] = np.linalg.solve(matrix, [levels[end_name], levels[edge]])
    along = np.einsum("jk,jk->j", inner[1] - inner[0], outer[1] - outer[0])
    up = np.einsum("ik,ik->i", inner[:, 1] - inner[:, 0], outer[:, 1] - outer[:, 0])
    if min(along.min(), up.min()) <= 1e-6:
        length = np.linalg.norm(outer[1] - outer[0], axis=-1).min()
        depth = np.linalg.norm(outer[:, 1] - outer[:, 0], axis=-1).min()
        given = ", ".join(f"{name} {value:g}" for name, value in margins.items())
        raise InputError(
            f"the margins ({given} mm) leave nothing of the flank, which is {length:.3f} mm long and at its lower end "
            f"{depth:.3f} mm deep: give smaller ones"
        )
    t, h = np.meshgrid(np.linspace(0.0, 1.0, columns), np.linspace(0.0, 1.0, rows))
    root = np.multiply.outer(inner[0, 0], 1.0 - t) + np.multiply.outer(inner[1, 0], t)
    tip = np.multiply.outer(inner[0, 1], 1.0 - t) + np.multiply.outer(inner[1, 1], t)
    axial, radial = root * (1.0 - h) + tip * h
    return axial.ravel(), radial.ravel()


def _check_measurable(name: str, flank: Flank, columns: int) -> None:
    """Refuse a grid with points off the flank."""
    if np.all(flank.inside):
        return
    first = int(np.argmin(flank.inside))
    why = NodeStatus(int(flank.status[first])).name.lower().replace("_", " ")
    raise GeometryError(
        f"{int(np.count_nonzero(~flank.inside))} of {flank.status.size} grid points lie off the {name} flank, "
        f"the first in row {first // columns + 1}, column {first % columns + 1} ({why}): choose larger margins"
    )


def write_cmm_points(dataset: xr.Dataset, path: str | os.PathLike[str]) -> None:
    """Write measuring points: netCDF-4 for ``.nc``, text for ``.csv``; neither loses a digit.

    Parameters
    ----------
    dataset
        Dataset from ``cmm_points``; more attributes (such as ``member`` or ``title``) are written, too.
    path
        The file, replaced if it exists. It appears complete or not at all.

    Raises
    ------
    InputError
        If the suffix is another one, or the file cannot be written.

    Examples
    --------
    >>> import tempfile
    >>> from easeoff.cases import gear_pair, read_case
    >>> points = cmm_points(gear_pair(read_case("nasa-12x36")).gear, rows=3, columns=5)
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     write_cmm_points(points, f"{folder}/gear.csv")
    """
    suffix = _suffix(path)
    check_points(dataset, "dataset", FORMAT, GRID_FORMAT)
    if suffix == ".csv":
        with whole_file(path) as temporary:
            temporary.write_text(cmm_csv.text(dataset), encoding="utf-8")
    else:
        write_netcdf(dataset, path, packed=True)


def read_cmm_points(path: str | os.PathLike[str]) -> xr.Dataset:
    """Read measuring points, identical to those written.

    Parameters
    ----------
    path
        A ``.nc`` or ``.csv`` file of ``write_cmm_points``.

    Raises
    ------
    InputError
        If the file does not exist or does not hold such points; for a text file with the number of the line.

    Examples
    --------
    >>> import tempfile
    >>> from easeoff.cases import gear_pair, read_case
    >>> points = cmm_points(gear_pair(read_case("nasa-12x36")).gear, rows=3, columns=5)
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     write_cmm_points(points, f"{folder}/gear.csv")
    ...     read_cmm_points(f"{folder}/gear.csv").equals(points)
    True
    """
    source = file_path("path", path)
    dataset = read_dataset(source) if _suffix(path) == ".nc" else labelled(cmm_csv.parsed(content(source), str(source)))
    check_points(dataset, source, FORMAT)
    return dataset


def content(source: Path) -> str:
    """Read a text file. Raises InputError if it does not exist or is not text."""
    return read_text(source, TABLE_SIZE_LIMIT, line_limit=LINE_LENGTH_LIMIT)


def _suffix(path: str | os.PathLike[str]) -> str:
    suffix = file_path("path", path).suffix.lower()
    if suffix not in SUFFIXES:
        raise InputError(f"{path}: measuring points are written as {' or '.join(SUFFIXES)}")
    return suffix


def check_points(dataset: xr.Dataset, source: Path | str, *kinds: str) -> None:
    """Refuse a dataset without nominal points, or of another kind."""
    instance(str(source), dataset, xr.Dataset)
    if dataset.attrs.get("format") not in kinds:
        raise InputError(f"{source} holds no measuring points: its attribute 'format' is not {kinds[0]!r}")
    version = str(dataset.attrs.get("format_version", "not given"))
    if version not in map(str, range(1, FORMAT_VERSION + 1)):
        raise InputError(f"{source} is of format version {version}; this program reads up to {FORMAT_VERSION}")
    dimensions = ("flank", "row", "column", "xyz")
    for name in ("position", "normal"):
        if name not in dataset or dataset[name].dims != dimensions or dataset[name].dtype.kind != "f":
            raise InputError(f"{source} is incomplete: no numbers {name!r} over ({', '.join(dimensions)})")
        require_units(dataset, name, str(units_of(name)), source)
        missing = next((dimension for dimension in dimensions if dimension not in dataset.coords), "xyz")
        if missing not in dataset.coords or dataset.sizes["xyz"] != 3:
            raise InputError(f"{source} is incomplete: no coordinate {missing!r}, or not of three values")
        if not np.all(np.isfinite(dataset[name].values)):
            raise InputError(f"{source}: {name!r} holds values that are no finite numbers")
        largest = float(np.max(np.abs(dataset[name].values), initial=0.0))
        if largest > cmm_csv.COORDINATE_LIMIT:
            raise InputError(f"{source}: {name!r} holds {largest:g}: must be at most {cmm_csv.COORDINATE_LIMIT:g} mm")
    cmm_csv.require_size(dataset.sizes["row"], dataset.sizes["column"], str(source))
    flanks = [str(name) for name in dataset["flank"].values]
    if dataset["flank"].dims != ("flank",) or not flanks or len({*flanks, "concave", "convex"}) != 2:
        raise InputError(f"{source}: flank = {shown(flanks)}: must be concave, convex or both")
    if len(set(flanks)) != len(flanks):
        raise InputError(f"{source}: flank = {shown(flanks)}: must be names that differ")
    if np.max(np.abs(np.linalg.norm(dataset["normal"].values, axis=-1) - 1.0)) > 1e-6:
        raise InputError(f"{source}: 'normal' holds vectors that are not of length 1")


def require_units(dataset: xr.Dataset, name: str, units: str, source: Path | str) -> None:
    """Refuse a variable that says of itself to have other units."""
    unit = dataset[name].attrs.get("units", units)
    if cmm_csv.unit_name(unit) != units:
        raise InputError(f"{source}: units of {name!r} = {shown(unit)}: must be {units}")
