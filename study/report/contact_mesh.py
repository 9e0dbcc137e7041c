"""Teeth in contact: both members in mesh, for the turnable picture of the report, as VTK and as REXS with the contact.

Contact segments of a mesh position are strips in the tangent plane of the gear flank, with the pressure under them.
"""

from __future__ import annotations

import math
import os
import tomllib
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import Any

import numpy as np
import xarray as xr

from ...cases.conversion import gear_pair
from ...cases.reading import CASE
from ...cases.rexs.rexs_vocabulary import GEAR_BACKLASH, STAGE_BACKLASH
from ...cases.rexs.rexs_writing import ContactPoints, write_rexs
from ...cases.schema.case_schema import MATING_SIDES, Case, MisalignmentTable
from ...contact.lines.contact_lines import boundary_distance, contact_splines
from ...contact.lines.flank_splines import FlankSplines, fit
from ...core.arrays import Array, Integers
from ...core.attributes import ordered
from ...core.checks import file_path, number, two_whole
from ...core.errors import EaseoffError, InputError
from ...core.memory import require_memory
from ...core.output_file import check_writable, whole_file
from ...geometry.formats.mesh import vtu_file
from ...geometry.pair.assembly import Misalignment
from ...geometry.pair.gear_pair import MEMBERS, GearPair
from ...geometry.tooth.tooth_flanks import MemberName
from ...geometry.tooth.tooth_surface import tooth_patches
from ..plot.panel_grid import chosen_torques, require_result
from ..plot.tooth_view import ToothView, fine_grid, tooth_view
from ..summary.assembly import ERRORS
from .page_data import gear_raster, packed, packed_exactly, rasterised

#: Tables that may name other files, which a report does not open.
LEFT_OUT = ("friction", "load_cases")


def stored_case(tree: xr.DataTree) -> Case | None:
    """Case of a result without some of its tables; ``None`` if the result keeps none that can be read."""
    text = str(tree.attrs.get("case", ""))
    try:
        data: dict[str, Any] = tomllib.loads(text)
        return CASE.check({key: value for key, value in data.items() if key not in LEFT_OUT}, "the case")
    except (ValueError, EaseoffError, AttributeError):
        return None


def pair_of_result(tree: xr.DataTree, case: Case) -> GearPair:
    """The pair of a case in the misalignment of the result."""
    misalignment = Misalignment(*(float(tree.attrs[error.attribute]) for error in ERRORS))
    return gear_pair(case, tree.attrs["flank"]).misaligned(misalignment)


def member_turns(tree: xr.DataTree, pair: GearPair) -> dict[str, float]:
    """Rotation [rad] of each member from its stored position to that at the pinion rotation zero.

    The middle of the flank, by what ``/ease_off`` says, then makes contact at its own roll angle.
    """
    ease_off, flanks = tree["ease_off"].to_dataset(), tree["flanks"].to_dataset()
    grid = ("lengthwise", "profile")
    inside = ordered(ease_off, "inside", *grid) == 1
    roll = ordered(ease_off, "roll_angle", *grid)[inside]
    action = ordered(ease_off, "action_position", *grid, "space")[inside]
    position = ordered(flanks, "position", "member", *grid, "xyz")
    gear = position[MEMBERS.index("gear")][inside] + pair.assembly.gear_origin
    fractions = np.stack([ordered(ease_off, f"pinion_{name}", *grid)[inside] for name in grid])
    from scipy.interpolate import RegularGridInterpolator

    axes = tuple(ordered(flanks, name, name) for name in grid)
    pinion = RegularGridInterpolator(axes, position[MEMBERS.index("pinion")])(np.clip(fractions.T, 0.0, 1.0))
    pinion = pinion @ pair.assembly.pinion_frame.T + pair.assembly.pinion_origin
    turns = {}
    for member, points, rate in (("pinion", pinion, 1.0), ("gear", gear, 1.0 / float(ease_off.attrs["ratio"]))):
        axis = np.asarray(ease_off.attrs[f"{member}_axis"], float)
        origin = np.asarray(ease_off.attrs[f"{member}_origin_mm"], float)
        angle = _azimuth(action - origin, axis) - _azimuth(points - origin, axis) - rate * roll
        known = angle[np.isfinite(angle)]
        # A mean of angles that do not jump from one turn to the next; of the pinion all are alike.
        turns[member] = float(np.angle(np.mean(np.exp(1j * known))))
    return turns


def flank_places(pair: GearPair, member: str, points: Array) -> Array:
    """Lengthwise and profile fractions (2, m, n) of points (m, n, 3) in a member's frame."""
    section = pair.pinion.section if member == "pinion" else pair.gear.section
    return np.stack(section.fractions(points[..., 2], np.hypot(points[..., 0], points[..., 1])))


def _azimuth(vectors: Array, axis: Array) -> Array:
    """Angle (n) [rad] of vectors (n, 3) about an axis."""
    first = np.cross(axis, [0.0, 1.0, 0.0])
    first /= np.linalg.norm(first)
    return np.asarray(np.arctan2(vectors @ np.cross(axis, first), vectors @ first))


def turned(points: Array, axis: Array, origin: Array, angle: float) -> Array:
    """Points (..., 3) turned about an axis through an origin by an angle [rad]."""
    x, y, z = axis / np.linalg.norm(axis)
    cross = np.array([[0.0, -z, y], [z, 0.0, -x], [-y, x, 0.0]])
    rotation = np.eye(3) + np.sin(angle) * cross + (1.0 - np.cos(angle)) * cross @ cross
    return np.asarray((points - origin) @ rotation.T + origin)


def placed(points: Array, pair: GearPair, member: MemberName) -> Array:
    """Points (..., 3) of a member's own frame in the common one, at the member's stored position."""
    if member == "gear":
        return np.asarray(points + pair.assembly.gear_origin)
    return np.asarray(points @ pair.assembly.pinion_frame.T + pair.assembly.pinion_origin)


def loaded_patch(tree: xr.DataTree, member: str) -> str:
    """Name of the loaded flank among the patches of a tooth."""
    return f"{MATING_SIDES[tree.attrs['flank']][MEMBERS.index(member)]}_flank"


SCENE_NODES = (41, 15)  # of a drawn tooth along the face and the profile


def mesh_scene(tree: xr.DataTree, case: Case) -> dict[str, Any] | None:
    """Teeth of both members and their motion; ``None`` if a tooth's surface does not exist.

    At the pinion rotation q, the tooth of the pair p is turned by ``turn + rate * (q - p * pitch)`` about its axis.
    """
    try:
        pair = pair_of_result(tree, case)
        patches = {member: tooth_patches(pair, member, SCENE_NODES) for member in MEMBERS}
    except EaseoffError:
        return None
    attributes = tree["ease_off"].attrs
    turns = member_turns(tree, pair)
    members = {}
    for member in MEMBERS:
        loaded = loaded_patch(tree, member)
        surfaces = patches[member]
        frame = pair.assembly.pinion_frame if member == "pinion" else np.eye(3)
        origin = pair.assembly.pinion_origin if member == "pinion" else pair.assembly.gear_origin
        placed = {name: points @ frame.T + origin for name, points in surfaces.items()}
        node = ordered(tree["flanks"].to_dataset(), "position", "member", "lengthwise", "profile", "xyz")
        flank, outward = _from_toe(placed[loaded], node[MEMBERS.index(member), 0, 0] @ frame.T + origin)
        members[member] = {
            "axis": np.asarray(attributes[f"{member}_axis"], float).tolist(),
            "origin": np.asarray(attributes[f"{member}_origin_mm"], float).tolist(),
            "turn": turns[member],
            "rate": 1.0 if member == "pinion" else 1.0 / float(attributes["ratio"]),
            "teeth": int(tree.attrs[f"{member}_teeth"]),
            "flank": packed(flank),
            "outward": outward,
            "places": packed(flank_places(pair, member, flank @ frame - origin @ frame)),
            "grid": packed(node[MEMBERS.index(member)] @ frame.T + origin),
            "others": [packed(points) for name, points in placed.items() if name != loaded],
        }
    middle = ordered(tree["ease_off"].to_dataset(), "action_position", "lengthwise", "profile", "space")
    return {
        "members": members,
        "pitch": 2.0 * math.pi / int(tree.attrs["pinion_teeth"]),
        "rotation": packed_exactly(tree["loaded"].to_dataset()["pinion_rotation"].values),
        "middle": np.nanmean(middle, axis=(0, 1)).tolist(),
    }


def _from_toe(points: Array, corner: Array) -> tuple[Array, int]:
    """Flank's grid (m, n, 3) with the first index from the toe and the second from the root, and its sense.

    The sense is 1 if the first derivative times the second one points out of the tooth, else -1.
    """
    turned = [(points[::a, ::b], a * b) for a in (1, -1) for b in (1, -1)]
    return min(turned, key=lambda each: float(np.linalg.norm(each[0][0, 0] - corner)))


#: Values of a segment in a file, by the name there: group, variable and factor.
SEGMENT_VALUES = {
    "pressure [MPa]": ("loaded", "pressure"),
    "force [N]": ("loaded", "force"),
    "half width [mm]": ("loaded", "half_width"),
    "film thickness [um]": ("friction", "film_thickness"),
    "lambda ratio [1]": ("friction", "lambda_ratio"),
    "friction coefficient [1]": ("friction", "friction_coefficient"),
    "sliding velocity [m/s]": ("friction", "sliding_velocity"),
    "flash temperature [K]": ("friction", "flash_temperature"),
}
LOAD_PER_LENGTH, CONTACT_TEMPERATURE = "load per length [N/mm]", "contact temperature [degC]"
SHARP_HALF_WIDTH = 0.05  # [mm] of a segment on a sharp edge, whose contact has no width
LENGTH_TOLERANCE = 1e-9  # relative, between the segments of a line


@dataclass(frozen=True)
class Segments:
    """Loaded segments (n) at a mesh position."""

    points: Array  # (2, n), fractions of the middles on the gear flank
    tooth: Integers
    line: Integers
    length: Array  # [mm] each
    half_width: Array
    values: dict[str, Array]


def loaded_segments(at_position: xr.Dataset, friction: xr.Dataset | None) -> Segments:
    """Loaded segments of the group ``loaded`` at one torque and mesh position, with friction at one condition."""
    force = np.nan_to_num(ordered(at_position, "force", "segment"))
    chosen = np.flatnonzero(force > 0.0)
    tooth, length = (ordered(at_position, name, "segment") for name in ("tooth", "length"))
    known = np.nan_to_num(np.stack([tooth, length]))
    new = (known[0][1:] != known[0][:-1]) | (np.abs(np.diff(known[1])) > LENGTH_TOLERANCE * known[1][1:])
    line = np.concatenate([[0], np.cumsum(new)]).astype(np.int64)
    groups = {"loaded": at_position} | ({} if friction is None else {"friction": friction})
    values = {
        name: ordered(groups[group], variable, "segment")[chosen]
        for name, (group, variable) in SEGMENT_VALUES.items()
        if group in groups and variable in groups[group]
    }
    values[LOAD_PER_LENGTH] = force[chosen] / length[chosen]
    if "flash temperature [K]" in values and friction is not None:
        values[CONTACT_TEMPERATURE] = values["flash temperature [K]"] + float(friction["bulk_temperature"])
    width = ordered(at_position, "half_width", "segment")[chosen]
    return Segments(
        np.stack([ordered(at_position, name, "segment")[chosen] for name in ("lengthwise", "profile")]),
        tooth[chosen].astype(np.int64),
        line[chosen],
        length[chosen],
        np.where(width > 0.0, width, SHARP_HALF_WIDTH),
        values,
    )


def flank_positions(flanks: xr.Dataset, member: MemberName) -> FlankSplines:
    """Spline ``position`` [mm] of a member's flank, in its own frame, over its own fractions."""
    position = ordered(flanks, "position", "member", "lengthwise", "profile", "xyz")[MEMBERS.index(member)]
    return fit(flanks["lengthwise"].values, flanks["profile"].values, {"position": position})


def strip_corners(segments: Segments, splines: FlankSplines) -> Array:
    """Corners (n, 4, 3) [mm] of the strips on the gear flank, in its frame, by splines of ``flank_positions``."""
    middle = splines("position", segments.points).T
    first, second = (splines("position", segments.points, order).T for order in ((1, 0), (0, 1)))
    normal = np.cross(first, second)
    normal /= np.linalg.norm(normal, axis=1, keepdims=True)
    along = _directions(middle, segments.line, first)
    along -= np.sum(along * normal, axis=1, keepdims=True) * normal
    along /= np.linalg.norm(along, axis=1, keepdims=True)
    across = np.cross(normal, along) * segments.half_width[:, None]
    ahead = along * (0.5 * segments.length)[:, None]
    return np.stack(
        [middle - ahead - across, middle + ahead - across, middle + ahead + across, middle - ahead + across], axis=1
    )


def _directions(middle: Array, line: Integers, default: Array) -> Array:
    """Directions (n, 3) of the contact lines at the middles (n, 3) of their segments."""
    directions = default.copy()
    for one in np.unique(line):
        indices = np.flatnonzero(line == one)
        if indices.size > 1:
            directions[indices] = np.gradient(middle[indices], axis=0)
    return directions


def band_pressure(points: Array, strips: Array, pressure: Array) -> Array:
    """Hertzian pressure (m, n) [MPa] at points (m, n, 3) under strips (k, 4, 3) [mm], zero beside them.

    The greatest pressure (k) of a strip, NaN for none, is on its middle line.
    """
    from scipy.spatial import cKDTree

    flat = points.reshape(-1, 3)
    pressures = np.zeros(len(flat))
    tree = cKDTree(flat)
    middle = strips.mean(axis=1)
    along, across = 0.5 * (strips[:, 1] - strips[:, 0]), 0.5 * (strips[:, 3] - strips[:, 0])
    reach = np.linalg.norm(along, axis=1) + np.linalg.norm(across, axis=1)
    for k in np.flatnonzero(np.isfinite(pressure)):
        near = np.array(tree.query_ball_point(middle[k], 1.01 * reach[k]), dtype=np.int64)
        if not near.size:
            continue
        away = flat[near] - middle[k]
        u = away @ along[k] / (along[k] @ along[k])
        v = away @ across[k] / (across[k] @ across[k])
        within = np.abs(u) <= 1.0
        value = pressure[k] * np.sqrt(np.maximum(1.0 - v**2, 0.0))
        np.maximum.at(pressures, near[within], value[within])
    return pressures.reshape(points.shape[:2])


Values = Mapping[str, Any]


class QuadMesh:
    """Quadrilaterals with values at points and of cells by name; NaN where not given, labels of cells always are."""

    def __init__(self, point_names: Sequence[str], cell_names: Sequence[str]) -> None:
        self._names = point_names, cell_names
        self._parts: list[tuple[Array, Array, Values, Values]] = []  # points, corners of cells, values of both

    def add_grid(self, points: Array, fields: Values, labels: Mapping[str, int]) -> None:
        """Add a grid of points (m, n, 3) with values (m, n) by name, and labels of its cells."""
        node = np.arange(points.shape[0] * points.shape[1]).reshape(points.shape[:2])
        quads = np.stack([node[:-1, :-1], node[1:, :-1], node[1:, 1:], node[:-1, 1:]], axis=-1).reshape(-1, 4)
        cells = {name: np.int32(label) for name, label in labels.items()}
        self._parts.append((points.reshape(-1, 3), quads, fields, cells))

    def add_strips(self, corners: Array, values: Values, labels: Mapping[str, int]) -> None:
        """Add separate cells with their corners (k, 4, 3), values (k) by name, and labels."""
        cells = {name: np.int32(label) for name, label in labels.items()} | dict(values)
        self._parts.append((corners.reshape(-1, 3), np.arange(4 * len(corners)).reshape(-1, 4), {}, cells))

    def content(self) -> tuple[Array, Array, dict[str, Array], dict[str, Array]]:
        """Points (n, 3), corners of the cells (c, 4), and data by name of cells and of points."""
        points, quads, fields, cells = zip(*self._parts, strict=True)
        starts = np.cumsum([0, *map(len, points[:-1])])

        def joined(names: Sequence[str], given: Sequence[Values], places: Sequence[Array]) -> dict[str, Array]:
            parts = list(zip(given, map(len, places), strict=True))
            filled = {name: [np.broadcast_to(np.ravel(one.get(name, np.nan)), n) for one, n in parts] for name in names}
            return {name: np.concatenate(values) for name, values in filled.items()}

        corners = np.concatenate([one + start for one, start in zip(quads, starts, strict=True)])
        of_points, of_cells = self._names
        return np.concatenate(points), corners, joined(of_cells, cells, quads), joined(of_points, fields, points)


SUFFIX, REXS_SUFFIX = ".vtu", ".rexs"
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
    """Write the teeth in contact at a mesh position as an unstructured grid of VTK, or the contact points as REXS.

    Cells are quadrilaterals: the surfaces of the teeth of both members that are in mesh, and on the gear flank a strip
    for every loaded segment, as long as the segment and as wide as its contact band. Cell data are the integers
    ``member`` (0 pinion, 1 gear, 2 both), ``pair`` and ``part`` (0 loaded flank, 1 other surface, 2 contact segment),
    and the values of the segments, which are NaN elsewhere. Point data are, on the loaded flanks, ease-off, greatest
    pressure over the mesh cycle and Hertzian pressure at the mesh position; NaN elsewhere. Names bear the units.

    The teeth stand as rigid ones of conjugate flanks would: deformation, rotation under load and motion of supports are
    not drawn, and the flanks are apart or overlap by some hundredths of a millimetre where they touch.

    REXS holds the case, its least backlash if known, and the contact points on the gear flank over the whole mesh cycle
    with ease-off, Hertzian pressure, load per length and, with friction, its coefficient, the ratio of film to
    roughness, sliding velocity and flash temperature. Segments on sharp edges, which have no pressure, are left out.

    Parameters
    ----------
    tree
        A result of ``analyze`` or ``read_result``.
    path
        The file, replaced if it exists; its suffix is ``.vtu`` or ``.rexs``.
    torque
        A torque of the result at the pinion [N m]; the greatest if left out.
    mesh_position
        A mesh position of the result, from 0 to 1; of VTK.
    nodes
        Nodes of a flank, lengthwise and along the profile; of VTK.

    Returns
    -------
    str
        Description of what was written.

    Raises
    ------
    InputError
        If ``tree`` is no result, keeps no case, does not have the torque or mesh position, has no contact to write, or
        the file cannot be written.
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
    if target.suffix.lower() not in (SUFFIX, REXS_SUFFIX):
        raise InputError(
            f"{target}: suffix = {target.suffix!r}: must be {SUFFIX} or {REXS_SUFFIX} for the contact of a result"
        )
    check_writable(target)
    require_result(tree)
    if target.suffix.lower() == REXS_SUFFIX:
        return _write_points(tree, target, torque)
    nodes = two_whole("nodes", nodes, 2)
    require_memory(f"nodes = {nodes[0]}x{nodes[1]}", NODE_SIZE * math.prod(nodes), "the surfaces of the teeth")
    teeth = TeethInMesh.of(tree, torque, nodes)
    number = teeth.position_number(mesh_position)
    content, pairs = teeth.at(number)
    with whole_file(target) as temporary:
        temporary.write_bytes(content)
    said = "1 tooth pair" if pairs == 1 else f"{pairs} tooth pairs"
    return f"{said} in contact at {teeth.torque:g} N m, mesh position {teeth.positions[number]:g}"


def _write_points(tree: xr.DataTree, path: Path, torque: float | None) -> str:
    """Write the case of a result as REXS, with the contact points of the mesh cycle at a torque [N m]."""
    case, loaded, friction = _at_torque(tree, torque)
    flanks = tree["flanks"].to_dataset()
    cycle = [
        loaded_segments(loaded.isel(at), None if friction is None else friction.isel(at))
        for at in ({"mesh_position": index} for index in range(loaded.sizes["mesh_position"]))
    ]
    places = np.concatenate([segments.points for segments in cycle], axis=1)
    values = {name: np.concatenate([segments.values[name] for segments in cycle]) for name in cycle[0].values}
    fields = contact_splines(flanks, tree["ease_off"].to_dataset())
    values["ease-off [mm]"] = fields("ease_off_angle", places) * fields("lever_arm", places)
    kept = np.all(np.isfinite(list(values.values())), axis=0)
    if not np.any(kept):
        raise InputError(f"torque = {float(loaded['torque']):g}: must be one with contact in the result")
    said = f"contact points on the gear flank at {float(loaded['torque']):g} N m"
    points = flank_positions(flanks, "gear")("position", places[:, kept]).T
    errors = {error.name: error.factor * float(tree.attrs[error.attribute]) for error in ERRORS}
    known = {name: column[kept] for name, column in values.items()}
    backlash = {}
    if "backlash" in tree.children:
        least = tree["backlash"].to_dataset()[[*STAGE_BACKLASH, *GEAR_BACKLASH]].min()
        backlash = {str(name): float(value) for name, value in least.items() if np.isfinite(value)}
    contact = ContactPoints(said, tree.attrs["flank"], points, known, backlash)
    write_rexs(case.model_copy(update={"misalignment": MisalignmentTable(**errors)}), path, contact)
    return f"{len(points)} {said}"


def _at_torque(tree: xr.DataTree, torque: float | None) -> tuple[Case, xr.Dataset, xr.Dataset | None]:
    """Case, loaded contact, and friction at its middle condition, at a torque [N m] of a result, else the greatest."""
    from ..plot.friction_charts import middle_condition

    loaded = tree["loaded"].to_dataset()
    torques = loaded["torque"].values
    index = int(np.argmax(torques)) if torque is None else int(chosen_torques(torques, torque)[0])
    case = stored_case(tree)
    if case is None:
        raise InputError("the result keeps no case that can be read: its teeth cannot be made; analyse it anew")
    if "friction" not in tree.children:
        return case, loaded.isel(torque=index), None
    whole = tree["friction"].to_dataset()
    return case, loaded.isel(torque=index), whole.isel(middle_condition(whole) | {"torque": index})


@dataclass(frozen=True)
class TeethInMesh:
    """Teeth of a result at one torque, with friction at the middle of the other conditions; made by ``of``."""

    tree: xr.DataTree
    loaded: xr.Dataset
    friction: xr.Dataset | None
    pair: GearPair
    patches: dict[MemberName, dict[str, Array]]  # grids of points of a tooth's surface by name
    views: dict[MemberName, ToothView]

    @classmethod
    def of(cls, tree: xr.DataTree, torque: float | None, nodes: tuple[int, int]) -> TeethInMesh:
        """Teeth at a torque [N m], the greatest if it is ``None``."""
        case, loaded, friction = _at_torque(tree, torque)
        pair = pair_of_result(tree, case)
        patches = {member: tooth_patches(pair, member, nodes) for member in MEMBER_NAMES}
        views = {member: tooth_view(tree, member) for member in MEMBER_NAMES}
        return cls(tree, loaded, friction, pair, patches, views)

    @property
    def torque(self) -> float:
        """Torque at the pinion [N m]."""
        return float(self.loaded["torque"])

    @property
    def positions(self) -> Array:
        """Mesh positions (k)."""
        return np.asarray(self.loaded["mesh_position"].values)

    def position_number(self, mesh_position: float) -> int:
        """Number of a mesh position that the result must have."""
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
        attributes = self.tree["ease_off"].attrs
        axis, origin = (np.asarray(attributes[f"{member}_{name}"], float) for name in ("axis", "origin_mm"))
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
        fields: dict[MemberName, dict[str, Array]] = {}
        for member, view in self.views.items():
            fractions = view.fractions(surface.points)
            pattern = np.nan_to_num(rasterised(fractions, surface.pressure, surface.triangles, RASTER))
            ease_off = gap if member == "gear" else gear_raster(grid, gap, view, RASTER)
            nodes = self.patches[member][loaded_patch(self.tree, member)]
            places = np.clip(np.moveaxis(flank_places(self.pair, member, nodes), 0, -1), 0.0, 1.0)
            rasters = {EASE_OFF: ease_off, PATTERN: pattern}
            fields[member] = {name: RegularGridInterpolator(axes, raster)(places) for name, raster in rasters.items()}
        return fields

    def at(self, number: int) -> tuple[bytes, int]:
        """Content of the file at a mesh position, and the number of tooth pairs in contact."""
        friction = None if self.friction is None else self.friction.isel(mesh_position=number)
        segments = loaded_segments(self.loaded.isel(mesh_position=number), friction)
        teeth = [int(tooth) for tooth in np.unique(segments.tooth)] or [0]
        mesh = QuadMesh((EASE_OFF, PATTERN, BAND), ("member", "pair", "part", *segments.values))
        corners = strip_corners(segments, flank_positions(self.tree["flanks"].to_dataset(), "gear"))
        for tooth in teeth:
            chosen = segments.tooth == tooth
            strips = self.in_mesh(corners[chosen], "gear", tooth, number)
            pressure = segments.values["pressure [MPa]"][chosen]  # NaN on sharp edges
            for index, member in enumerate(MEMBER_NAMES):
                for name, points in self.patches[member].items():
                    at, fields, part = self.in_mesh(points, member, tooth, number), {}, "other surface"
                    if name == loaded_patch(self.tree, member):
                        fields = self._flank_fields[member] | {BAND: band_pressure(at, strips, pressure)}
                        part = "loaded flank"
                    mesh.add_grid(at, fields, {"member": index, "pair": tooth, "part": PARTS[part]})
            values = {name: column[chosen] for name, column in segments.values.items()}
            labels = {"member": BOTH_MEMBERS, "pair": tooth, "part": PARTS["contact segment"]}
            mesh.add_strips(strips, values, labels)
        return vtu_file(*mesh.content()), len(teeth)
