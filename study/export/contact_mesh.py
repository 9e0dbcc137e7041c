"""Contact in mesh position as a VTK file: teeth of both members, and the loaded segments on them."""

from __future__ import annotations

import math
import os
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np
import xarray as xr
from numpy.typing import NDArray

from ...contact.lines.contact_lines import boundary_distance
from ...core.attributes import ordered
from ...core.checks import file_path, number, two_whole
from ...core.errors import InputError
from ...core.memory import require_memory
from ...core.output_file import check_writable, whole_file
from ...geometry.formats.mesh import vtu_file
from ...geometry.pair.gear_pair import GearPair
from ...geometry.tooth.tooth_flanks import MemberName
from ...geometry.tooth.tooth_surface import tooth_patches
from ..plot.figures.drawn_result import require_result
from ..plot.tooth_view import ToothView, fine_grid, tooth_view
from ..report.contact_report.flank_raster import gear_raster, on_member, rasterised
from ..report.contact_report.stored_case import stored_case
from .contact_cells import band_pressure, flank_positions, loaded_segments, strip_corners
from .mesh_placement import flank_places, member_turns, pair_of_result, placed, turned
from .quad_mesh import QuadMesh

Array = NDArray[Any]

SUFFIX = ".vtu"
FLANK_NODES = (121, 49)
NODE_SIZE = 2.0e4  # memory of a node of a flank, with those of all teeth, while it is found and written [byte]
RASTER = (361, 145)  # points over a flank from which the nodes have their values
POSITION_TOLERANCE = 1e-6
MEMBER_NAMES: tuple[MemberName, ...] = ("pinion", "gear")
BOTH_MEMBERS = len(MEMBER_NAMES)
PARTS = {"loaded flank": 0, "other surface": 1, "contact segment": 2}
EASE_OFF, PATTERN, BAND = "ease-off [um]", "greatest pressure over the cycle [MPa]", "contact pressure [MPa]"


def export_contact(
    tree: xr.DataTree,
    path: str | os.PathLike[str],
    *,
    torque: float | None = None,
    mesh_position: float = 0.0,
    nodes: tuple[int, int] = FLANK_NODES,
) -> str:
    """Write the teeth in contact at a mesh position as an unstructured grid of VTK.

    Cells are quadrilaterals: the surfaces of the teeth of both members that are in mesh, and on the gear flank a strip
    for every loaded segment, as long as the segment and as wide as its contact band. Cell data are the integers
    ``member`` (0 pinion, 1 gear, 2 both), ``pair`` and ``part`` (0 loaded flank, 1 other surface, 2 contact segment),
    and the values of the segments, which are NaN elsewhere. Point data are, on the loaded flanks, ease-off, greatest
    pressure over the mesh cycle and Hertzian pressure at the mesh position; NaN elsewhere. Names bear the units.

    The teeth stand as rigid ones of conjugate flanks would: deformation, rotation under load and motion of supports are
    not drawn, and the flanks are apart or overlap by some hundredths of a millimetre where they touch.

    Parameters
    ----------
    tree
        A result of ``analyze`` or ``read_result``.
    path
        The file, replaced if it exists; its suffix is ``.vtu``.
    torque
        A torque of the result at the pinion [N m]; the greatest if left out.
    mesh_position
        A mesh position of the result, from 0 to 1.
    nodes
        Nodes of a flank, lengthwise and along the profile.

    Returns
    -------
    str
        Description of what was written.

    Raises
    ------
    InputError
        If ``tree`` is no result, keeps no case, does not have the torque or mesh position, or the file cannot be
        written.
    GeometryError
        If part of a tooth's surface does not exist.

    Examples
    --------
    >>> import easeoff
    >>> from pathlib import Path
    >>> from tempfile import TemporaryDirectory
    >>> tree = easeoff.analyze("nasa-12x36", torques=[100.0])
    >>> with TemporaryDirectory() as folder:
    ...     export_contact(tree, Path(folder) / "pattern.vtu", nodes=(31, 15))
    '1 tooth pair in contact at 100 N m, mesh position 0'
    """
    target = file_path("path", path)
    if target.suffix.lower() != SUFFIX:
        raise InputError(f"{target}: suffix = {target.suffix!r}: must be {SUFFIX} for the contact of a result")
    check_writable(target)
    require_result(tree)
    nodes = two_whole("nodes", nodes, 2)
    require_memory(f"nodes = {nodes[0]}x{nodes[1]}", NODE_SIZE * math.prod(nodes), "the surfaces of the teeth")
    teeth = TeethInMesh.of(tree, torque, nodes)
    number = teeth.position_number(mesh_position)
    content, pairs = teeth.at(number)
    with whole_file(target) as temporary:
        temporary.write_bytes(content)
    said = "1 tooth pair" if pairs == 1 else f"{pairs} tooth pairs"
    return f"{said} in contact at {teeth.torque:g} N m, mesh position {teeth.positions[number]:g}"


@dataclass(frozen=True)
class TeethInMesh:
    """Teeth of a result at one torque; ``of`` makes them.

    Parameters
    ----------
    tree
        The result.
    loaded
        Its group ``loaded`` at the torque.
    friction
        Its group ``friction`` at the torque and the middle of the other conditions; ``None`` if it has none.
    pair
        The gear pair.
    patches
        Surface of a tooth of each member: grids of points by name.
    views
        Flanks of pinion and gear.
    """

    tree: xr.DataTree
    loaded: xr.Dataset
    friction: xr.Dataset | None
    pair: GearPair
    patches: dict[MemberName, dict[str, Array]]
    views: dict[MemberName, ToothView]

    @classmethod
    def of(cls, tree: xr.DataTree, torque: float | None, nodes: tuple[int, int]) -> TeethInMesh:
        """Teeth at a torque [N m], the greatest if it is ``None``."""
        from ..plot.friction_map_chart import chosen_condition
        from ..plot.panel_grid import chosen_torques

        loaded = tree["loaded"].to_dataset()
        torques = loaded["torque"].values
        index = int(np.argmax(torques)) if torque is None else int(chosen_torques(torques, torque, 1)[0])
        case = stored_case(tree)
        if case is None:
            raise InputError("the result keeps no case that can be read: its teeth cannot be made; analyse it anew")
        pair = pair_of_result(tree, case)
        friction = None
        if "friction" in tree.children:
            whole = tree["friction"].to_dataset()
            at = chosen_condition(whole)
            friction = whole.isel({name: int(np.argmax(whole[name].values == at[name])) for name in list(at)[1:]})
            friction = friction.isel(torque=index)
        patches = {member: tooth_patches(pair, member, nodes) for member in MEMBER_NAMES}
        views = {member: tooth_view(tree, member) for member in MEMBER_NAMES}
        return cls(tree, loaded.isel(torque=index), friction, pair, patches, views)

    @property
    def torque(self) -> float:
        """Torque at the pinion [N m]."""
        return float(self.loaded["torque"])

    @property
    def positions(self) -> Array:
        """Mesh positions (k)."""
        return np.asarray(self.loaded["mesh_position"].values)

    def position_number(self, mesh_position: float) -> int:
        """Number of a mesh position.

        Raises
        ------
        InputError
            If the result does not have it.
        """
        near = np.abs(self.positions - number("mesh_position", mesh_position))
        if not np.min(near) <= POSITION_TOLERANCE:
            count = self.positions.size
            nearest = self.positions[np.argmin(near)]
            raise InputError(
                f"mesh_position = {mesh_position:g}: must be one of the {count} of the result, K/{count}; the nearest "
                f"is {nearest:.10g}"
            )
        return int(np.argmin(near))

    @cached_property
    def _turns(self) -> dict[str, float]:
        return member_turns(self.tree, self.pair)

    def _angle(self, member: MemberName, tooth: int, number: int) -> float:
        """Rotation [rad] of the tooth of a pair from its stored position."""
        rate = 1.0 if member == "pinion" else 1.0 / float(self.tree["ease_off"].attrs["ratio"])
        pitch = 2.0 * math.pi / int(self.tree.attrs["pinion_teeth"])
        rotation = float(ordered(self.loaded, "pinion_rotation", "mesh_position")[number])
        return self._turns[member] + rate * (rotation - tooth * pitch)

    def in_mesh(self, points: Array, member: MemberName, tooth: int, number: int) -> Array:
        """Points (..., 3) [mm] of a member's own frame where the tooth of a pair stands at a mesh position."""
        own = self.tree["ease_off"].attrs
        axis, origin = (np.asarray(own[f"{member}_{name}"], float) for name in ("axis", "origin_mm"))
        return turned(placed(points, self.pair, member), axis, origin, self._angle(member, tooth, number))

    @cached_property
    def _flank_fields(self) -> dict[MemberName, dict[str, Array]]:
        """Ease-off and greatest pressure over the cycle at the nodes of the loaded flanks (m, n)."""
        from scipy.interpolate import RegularGridInterpolator

        from ...contact.evaluation.pressure_map import pressure_map

        gear = self.views["gear"].fields
        grid = fine_grid(RASTER)
        gap = 1e3 * gear("ease_off_angle", grid) * gear("lever_arm", grid)
        gap = np.where(boundary_distance(gear, grid) >= 0.0, gap, np.nan)
        surface = pressure_map(self.loaded)
        axes = tuple(np.linspace(0.0, 1.0, count) for count in RASTER)
        found: dict[MemberName, dict[str, Array]] = {}
        for member, view in self.views.items():
            own = on_member(view.fields, surface.points, member)
            pattern = np.nan_to_num(rasterised(own, surface.pressure, surface.triangles, RASTER))
            ease_off = gap if member == "gear" else gear_raster(grid, gap, view, RASTER)
            places = np.clip(
                np.moveaxis(flank_places(self.pair, member, self.patches[member][self._flank(member)]), 0, -1), 0.0, 1.0
            )
            rasters = {EASE_OFF: ease_off, PATTERN: pattern}
            found[member] = {name: RegularGridInterpolator(axes, raster)(places) for name, raster in rasters.items()}
        return found

    def _flank(self, member: MemberName) -> str:
        """Name of the loaded flank's patch."""
        sides = {"pinion": ("concave", "convex"), "gear": ("convex", "concave")}
        return f"{sides[member][self.tree.attrs['flank'] != 'drive']}_flank"

    def at(self, number: int) -> tuple[bytes, int]:
        """Content of the file at a mesh position, and the number of tooth pairs in contact."""
        friction = None if self.friction is None else self.friction.isel(mesh_position=number)
        segments = loaded_segments(self.loaded.isel(mesh_position=number), friction)
        teeth = [int(tooth) for tooth in np.unique(segments.tooth)] or [0]
        mesh = QuadMesh((EASE_OFF, PATTERN, BAND), ("member", "pair", "part"), tuple(segments.values))
        corners = strip_corners(segments, flank_positions(self.tree["flanks"].to_dataset(), "gear"))
        for tooth in teeth:
            chosen = segments.tooth == tooth
            strips = self.in_mesh(corners[chosen], "gear", tooth, number)
            pressure = segments.values["pressure [MPa]"][chosen]  # NaN on sharp edges
            for index, member in enumerate(MEMBER_NAMES):
                for name, points in self.patches[member].items():
                    at = self.in_mesh(points, member, tooth, number)
                    if name == self._flank(member):
                        fields = self._flank_fields[member] | {BAND: band_pressure(at, strips, pressure)}
                        mesh.add_grid(at, fields, (index, tooth, PARTS["loaded flank"]))
                    else:
                        mesh.add_grid(at, {}, (index, tooth, PARTS["other surface"]))
            values = {name: own[chosen] for name, own in segments.values.items()}
            mesh.add_strips(strips, values, (BOTH_MEMBERS, tooth, PARTS["contact segment"]))
        return vtu_file(*mesh.content()), len(teeth)
