"""Geometry export: measuring points, CAD surfaces and meshes of a case's teeth as files."""

from __future__ import annotations

import math
from pathlib import Path
from typing import Any, Literal

import numpy as np

from ..cases.conversion import given_pair
from ..cases.schema.case_schema import Case
from ..core.checks import whole
from ..core.errors import InputError
from ..core.memory import require_memory
from ..core.output_file import check_writable
from ..geometry.formats import EdgeMargins, cmm_points, write_cmm_points, write_mesh, write_step
from ..geometry.formats.measuring_points import SUFFIXES as POINT_SUFFIXES
from ..geometry.formats.mesh import SUFFIXES as MESH_SUFFIXES
from ..geometry.formats.step import SUFFIXES as STEP_SUFFIXES, require_opencascade
from ..geometry.tooth.tooth_flanks import MemberName, named_member, tooth_angle
from ..geometry.tooth.tooth_surface import tooth_patches

FlankChoice = Literal["concave", "convex", "both"]
POINT_SIZE = 2.5e3  # memory of a point or node while it is found and written [byte]
SURFACE_NODES = (61, 31)  # splines through them are within 0.02 um of the flanks of the shipped cases


def export_points(
    case: Case,
    path: Path,
    member: MemberName,
    flank: FlankChoice = "both",
    *,
    rows: int = 5,
    columns: int = 9,
    margins: EdgeMargins | None = None,
    tolerance: tuple[float, float] | None = None,
) -> str:
    """Write measuring points of a member, rows from root to tip and columns from toe to heel, and describe them.

    Margins are a tenth of face width and depth if left out; the tolerance is the lower and upper limit of the deviation
    [um]. GeometryError if a point is not on the flank.
    """
    require_memory(f"rows = {rows}, columns = {columns}", 2.0 * POINT_SIZE * rows * columns, "the grid of points")
    pair = given_pair(case)
    angle = tooth_angle(pair, member)
    points = cmm_points(named_member(pair, member), rows, columns, margins, tooth_angle=angle, tolerance=tolerance)
    points = points.assign_attrs({"member": member, "title": case.title})
    known = [str(name) for name in points["flank"].values]
    if flank != "both":
        if flank not in known:
            raise InputError(
                f"flank = {flank!r}: must be {known[0]}, the only flank of the {member} that the case describes"
            )
        points = points.sel(flank=[flank])
        known = [flank]
    write_cmm_points(points, path)
    return f"{rows} x {columns} points of the {member}, {' and '.join(known)} flank"


def export_surfaces(
    case: Case,
    path: Path,
    member: MemberName,
    flank: FlankChoice = "both",
    *,
    teeth: int | None = 1,
    nodes: tuple[int, int] = SURFACE_NODES,
) -> str:
    """Write the surface of one or more teeth of a member, all for ``None``, and describe it.

    ``both`` flanks also write the other surfaces of the tooth; ``nodes`` of a flank are lengthwise and along the
    profile. GeometryError if part of the surface does not exist, MissingPackageError without the package of the format.
    """
    step = path.suffix.lower() in STEP_SUFFIXES
    if step:
        require_opencascade()
    pair = given_pair(case)
    number = named_member(pair, member).teeth
    wanted = number if teeth is None else whole("teeth", teeth, 1, number)
    copies = 1 if step else wanted  # a STEP file has one tooth and where its copies stand
    size = f"nodes = {nodes[0]}x{nodes[1]}" + ("" if copies == 1 else f", teeth = {copies}")
    require_memory(size, POINT_SIZE * math.prod(nodes) * copies, "the surface")
    patches = tooth_patches(pair, member, nodes)
    if flank != "both":
        patches = {name: points for name, points in patches.items() if name.startswith(flank)}
    pitch = 2.0 * np.pi / number
    if step:
        write_step(patches, path, teeth=wanted, pitch=pitch, name=f"{case.title}, {member}")
    else:
        write_mesh(patches, path, teeth=wanted, pitch=pitch)
    return f"{wanted} of {number} teeth of the {member}: {', '.join(patches)}"


def export(case: Case, path: Path, member: MemberName, flank: FlankChoice, options: dict[str, Any]) -> str:
    """Write measuring points, CAD surfaces or a mesh of a member, by the suffix of the file, and describe them.

    Options are ``rows``, ``columns``, ``margins``, ``tolerance`` of points and ``teeth``, ``nodes`` of surfaces, else
    InputError.
    """
    suffix = path.suffix.lower()
    surfaces = (*STEP_SUFFIXES, *MESH_SUFFIXES)
    if suffix not in (*POINT_SUFFIXES, *surfaces):
        raise InputError(
            f"{path}: suffix = {suffix!r}: must be {', '.join(POINT_SUFFIXES)} for measuring points, "
            f"{', '.join(surfaces)} for surfaces"
        )
    points = suffix in POINT_SUFFIXES
    foreign = set(options) & ({"teeth", "nodes"} if points else {"rows", "columns", "margins", "tolerance"})
    if foreign:
        kind = "surfaces" if points else "measuring points"
        raise InputError(
            f"{', '.join(f'--{name}' for name in sorted(foreign))}: must go with {kind}, not with a {suffix} file"
        )
    check_writable(path)
    write = export_points if points else export_surfaces
    return write(case, path, member, flank, **options)
