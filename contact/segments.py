"""Potential contact segments of a mesh cycle: contact lines in even pieces, with their gap and their compliance."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np

from ..core.arrays import Array, Bools, Integers, record
from ..geometry.pair.gear_pair import MEMBERS
from .compliance.elastic_model import ElasticTeeth, Loads, UnitLoads, member_points, unit_loads
from .compliance.finite_elements.flank_compliance import FlankCompliance
from .compliance.material import Material
from .compliance.spread_deflection import SpreadDeflection, end_loads, remaining_depth
from .compliance.weber_line_contact import WeberLineContact
from .lines.closest_approach import ClosestApproach, closest_approach, pinion_points
from .lines.flank_splines import FlankSplines
from .lines.mesh_edges import FlankEdge, edge_distance, edges_in_mesh, flank_edges, line_rotations, lines_to_edges
from .lines.mesh_lines import LoadedPlaces, MeshLines, gauss_points
from .mesh_wrench import MeshWrenches, SupportModes
from .problem.contact_problem import ContactProblem
from .problem.modal_basis import ModalBasis

MATERIAL_DEPTH_MINIMUM = 0.05  # [mm]; nearer to a sharp edge than this there is no half space for a line contact
RELATIVE_CURVATURE_MINIMUM = 1e-5  # [1/mm]; flanks that fit closer make no line contact
#: Points (2, 2, 5) in the middle of the height of toe and heel.
END_MIDDLES = np.stack([np.linspace([0.0, 1.0], [0.25, 0.75], 5, axis=1), np.full((2, 5), 0.5)])
DEPTHS = [f"depth_{member}" for member in MEMBERS]


@record(frozen=True)
class Segments:
    """Potential contact segments (n) of one mesh position."""

    pair: Integers
    point: Array  # loaded on the gear: lengthwise and profile fractions (2, n)
    pinion_point: Array  # loaded on the pinion: those of its conjugate contact (2, n)
    separation_angle: Array  # gap as a gear rotation [rad]
    lever_arm: Array  # of the normal force about the gear axis [mm]
    bending: ModalBasis
    line_contact: WeberLineContact
    searched: Bools  # flanks bend over so short a way that closest_approach was searched for
    edge: Integers  # number among flank_edges; -1 on contact lines, as the element
    element: Integers
    wrench: Array | None = None  # of a unit normal force on the pinion, global frame (n, 6)
    support: SupportModes | None = None

    @property
    def separation(self) -> Array:
        """Normal gap (n) [mm]."""
        return np.asarray(self.separation_angle * self.lever_arm)

    @property
    def length(self) -> Array:
        """Length along the contact line (n) [mm]."""
        return self.line_contact.length

    @property
    def equivalent_radius(self) -> Array:
        """Radius of relative curvature across the contact line (n) [mm]."""
        return self.line_contact.equivalent_radius

    def mesh_wrench(self, force: Array) -> Array:
        """Wrench (6) of the gear on the pinion about the origin of the global frame under normal forces (n) [N]."""
        if self.wrench is None:
            raise ValueError("the segments are made without wrenches")
        return np.asarray(force @ self.wrench)

    def moved(self, force: Array) -> Array:
        """Twist (6) of the pinion relative to the gear beyond what is in the separations, under forces (n) [N]."""
        if self.support is None:
            return np.zeros(6)
        return np.asarray(self.support.twist(self.mesh_wrench(force)) - self.support.absorbed)

    @cached_property
    def bending_problem(self) -> ContactProblem:
        """The contact problem without local compliance and without torque."""
        nothing, separation, basis = np.zeros(self.pair.size), self.separation, self.bending
        if self.support is not None and self.wrench is not None:
            separation, basis = self.support.separation(separation, self.wrench), self.support.basis(basis, self.wrench)
        return ContactProblem.of_modes(separation, self.lever_arm, 0.0, nothing, basis)


@record(frozen=True)
class LineSegments:
    """Contact lines of a mesh cycle in even segments (n), and the bending of teeth under a unit load on each.

    An ease-off that leaves the contact lines where they are leaves all of this as it is.
    """

    fields: FlankSplines
    lines: MeshLines
    teeth: ElasticTeeth
    count: int

    @cached_property
    def quadrature(self) -> tuple[Array, Array]:
        """Points (2, m, count * g) on the lines (m), and the weights (g) of one segment."""
        return gauss_points(self.lines.lines, self.count)

    def mean(self, values: Array) -> Array:
        """Means (..., n) over the segments of values (..., m, count * g) at the quadrature points."""
        weights = self.quadrature[1]
        return np.asarray(np.reshape(values, (*np.shape(values)[:-2], -1, weights.size)) @ weights)

    @cached_property
    def table(self) -> dict[str, Array]:
        """Values of the segments by name, their number last."""
        return self.names | self.loaded_at(self.places)

    @cached_property
    def unit_loads(self) -> UnitLoads:
        """Unit loads at the quadrature points."""
        return self.loads(self.places)

    @cached_property
    def places(self) -> LoadedPlaces:
        """Both members loaded at the quadrature points."""
        points = self.quadrature[0]
        return LoadedPlaces(self.fields, points, points)

    @property
    def names(self) -> dict[str, Array]:
        """Mesh position, tooth pair, length and number of the segments."""
        mesh, lines = self.lines, self.lines.lines
        return {
            "position": np.repeat(mesh.position, self.count),
            "pair": np.repeat(mesh.pair, self.count),
            "length": np.repeat(lines.length / self.count, self.count),
            "row": np.arange(mesh.pair.size * self.count),
        }

    def loaded_at(self, places: LoadedPlaces) -> dict[str, Array]:
        """Means over the segments of ``loaded_at`` at places (m, count * g)."""
        return {name: self.mean(values) for name, values in loaded_at(places, self.teeth.solid).items()}

    @cached_property
    def spread(self) -> list[SpreadDeflection]:
        """Deflection that line contact leaves out; empty on plates, the dissertation's method."""
        members = zip(MEMBERS, self.teeth.solid or (), strict=False)
        return [SpreadDeflection.of(self.fields, *one) for one in members]

    def loads(self, places: LoadedPlaces) -> UnitLoads:
        """Unit loads on the segments where both members are loaded at places (m, count * g)."""
        weights = self.quadrature[1]
        pinion, gear = (np.reshape(one, (2, -1, weights.size)) for one in places.points)
        ends = end_loads_at(places, self.teeth)
        ends = ends.reshape(len(ends), *pinion.shape[1:])
        return UnitLoads(self._loads((pinion, gear), weights, ends), coupling=self.teeth.coupling)

    def loads_on(self, points: tuple[Array, Array], weights: Array) -> Loads:
        """Both teeth's unit loads on segments (n) with quadrature points (2, n, g), see ``unit_loads``."""
        return self._loads(points, weights, end_loads_at(LoadedPlaces(self.fields, *points), self.teeth))

    def _loads(self, points: tuple[Array, Array], weights: Array, ends: Array) -> Loads:
        bending, on_bodies = unit_loads(self.teeth.both, self.fields, points, weights)
        members = zip(self.spread, points, strict=False)  # no spread deflection beside plates
        spread = [one.loads(self.fields, points[1], loaded, weights).T for one, loaded in members]
        return Loads((*bending, np.concatenate([*spread, (ends @ weights).T], axis=1)), on_bodies)

    @cached_property
    def bending(self) -> list[ModalBasis]:
        """Bending compliance at every mesh position that has contact lines."""
        table, parts = _sorted(self.table)
        return [self.unit_loads.bending(table["pair"][part], table["row"][part]) for part in parts.values()]


def loaded_at(places: LoadedPlaces, solid: tuple[Material, Material] | None) -> dict[str, Array]:
    """Loaded places of pinion and gear and the line contact there, by name.

    Depths near the ends of loads on ``solid`` teeth (see ``ElasticTeeth.solid``) are what remains of them.
    """
    table = dict(zip(DEPTHS, places.depths, strict=True))
    table |= {"pinion_point": places.pinion, "point": places.gear}
    if solid is None:
        return table
    load_end = np.minimum(*(one.distance for one in places.ends))
    for name, material, ends in zip(DEPTHS, solid, places.ends, strict=True):
        depth = np.maximum(table[name], MATERIAL_DEPTH_MINIMUM)
        table[name] = depth * np.prod(remaining_depth(depth, load_end, material, ends.cosine), axis=0)
    return table


def end_loads_at(places: LoadedPlaces, teeth: ElasticTeeth) -> Array:
    """Unit loads (k, ...) by the free ends of pinion and gear where these are loaded; none on plates."""
    fields, loads = places.fields, [np.zeros((0, *places.gear.shape[1:]))]
    for number, material in enumerate(teeth.solid or ()):
        member, tooth = MEMBERS[number], teeth.both[number]
        assert isinstance(tooth, FlankCompliance)
        depth = np.maximum(places.depths[number], MATERIAL_DEPTH_MINIMUM)
        profile = member_points(fields, member, places.points[number])[1]
        middles = np.maximum(fields(DEPTHS[number], END_MIDDLES).mean(axis=-1), MATERIAL_DEPTH_MINIMUM)
        distances = places.ends[number].distance
        for end, distance, middle in zip(tooth.ends or (), distances, middles, strict=False):
            loads.append(end_loads(depth, distance, profile * end.height, end.slant, material, float(middle)))
    return np.concatenate(loads)


@record(frozen=True)
class CycleSegments:
    """Potential contact segments at every mesh position of a cycle."""

    fields: FlankSplines
    on_lines: LineSegments
    cut: bool = False  # lines of to_edges, next to which an edge can cut the pressed strip
    wrenches: MeshWrenches | None = None

    @cached_property
    def to_edges(self) -> CycleSegments:
        """The same with contact lines that end where edges begin to touch, see ``mesh_edges``."""
        lines = lines_to_edges(self.fields, self.on_lines.lines)
        return replace(self, on_lines=replace(self.on_lines, fields=self.fields, lines=lines), cut=True)

    @cached_property
    def closest(self) -> ClosestApproach:
        """Closest approach of the flanks next to the quadrature points of ``on_lines``."""
        return closest_approach(self.fields, self.on_lines.quadrature[0])

    @cached_property
    def by_position(self) -> list[Segments | None]:
        """Segments of the contact lines at every mesh position; ``None`` where no tooth pair can touch."""
        return self._split(self.table, self._unit_loads, None if self.cut else self.on_lines.bending)

    def at_every(self, stride: int) -> list[Segments | None]:
        """As ``by_position`` at every so many mesh positions, and ``None`` at the others."""
        table = self.table
        chosen = table["position"] % stride == 0
        return self._split({name: values[..., chosen] for name, values in table.items()}, self._unit_loads)

    def with_edges(self, widest: Array) -> list[Segments | None]:
        """Segments of the lines ``to_edges``, and pieces of edges with a gap below one a mesh position (k) [rad]."""
        mesh, on_lines = self.on_lines.lines, self.to_edges.table
        edges = edges_in_mesh(self.fields, mesh, widest, self.edges)
        elements, points = edges.elements, edges.elements.points
        rotation = mesh.rotations[edges.position] - edges.pair * mesh.pinion_pitch
        pinion = pinion_points(self.fields, points, rotation)
        names = ("separation_angle", "lever_arm", "curvature", "length", "overhang", "edge", "element")
        on_edges = {name: getattr(elements, name) for name in names}
        if self.wrenches is not None:
            on_edges["wrench"] = self.wrenches.beside_lines(points, rotation)
        on_edges |= loaded_at(LoadedPlaces(self.fields, pinion, points), self.on_lines.teeth.solid)
        on_edges |= {"position": edges.position, "pair": edges.pair, "searched": np.zeros(rotation.size, dtype=bool)}
        on_edges["row"] = on_lines["row"].size + np.arange(rotation.size)
        both = {name: np.concatenate([on_lines[name], on_edges[name]], axis=-1) for name in on_lines}
        loads = self.on_lines.loads_on((pinion[..., None], points[..., None]), np.ones(1))
        return self._split(both, self.to_edges._unit_loads.with_edges(loads))

    @cached_property
    def edges(self) -> tuple[FlankEdge, ...]:
        """Toe, heel and tip of both members."""
        return flank_edges(self.fields)

    @cached_property
    def table(self) -> dict[str, Array]:
        """Values of the segments on lines by name, their number last, with their gap."""
        closest, on_lines = self.closest, self.on_lines
        points, weights = on_lines.quadrature
        names = ("separation_angle", "lever_arm", "curvature")
        gap = {name: on_lines.mean(getattr(closest, name)) for name in names}
        if self.wrenches is not None:
            gap["wrench"] = on_lines.mean(self.wrenches.on_lines(points))
        expanded = np.reshape(closest.expanded, (-1, weights.size))
        gap["searched"] = np.any(~expanded, axis=-1)
        gap["edge"] = gap["element"] = np.full(len(expanded), -1)
        if not self.cut:
            return on_lines.table | gap | {"overhang": np.full(expanded.shape[0], np.nan)}
        middle = points[:, :, weights.size // 2 :: weights.size].reshape(2, -1)
        rotation = np.repeat(line_rotations(on_lines.lines), on_lines.count)
        gap["overhang"] = -edge_distance(self.fields, middle, rotation)
        return on_lines.names | on_lines.loaded_at(self.loaded_places) | gap

    @cached_property
    def loaded_places(self) -> LoadedPlaces:
        """Loaded places of pinion and gear (m, count * g), where the flanks come closest."""
        if not self.cut:
            return self.on_lines.places
        closest = np.clip(self.on_lines.quadrature[0] + self.closest.shift, 0.0, 1.0)
        rotation = line_rotations(self.on_lines.lines)[:, None]
        return LoadedPlaces(self.fields, pinion_points(self.fields, closest, rotation), closest)

    @cached_property
    def _unit_loads(self) -> UnitLoads:
        return self.on_lines.loads(self.loaded_places) if self.cut else self.on_lines.unit_loads

    def _split(
        self, table: dict[str, Array], loads: UnitLoads, bending: list[ModalBasis] | None = None
    ) -> list[Segments | None]:
        """Segments of a table by mesh position, with their bending where it is known."""
        model = self.on_lines.teeth.model
        result: list[Segments | None] = [None] * self.on_lines.lines.rotations.size
        table, parts = _sorted(table)
        of_pinion, of_gear = (np.maximum(table[name], MATERIAL_DEPTH_MINIMUM) for name in DEPTHS)
        radius = 1.0 / np.maximum(table["curvature"], RELATIVE_CURVATURE_MINIMUM)
        bodies = model.pinion, model.gear, model.foot_correction
        contact = WeberLineContact(table["length"], radius, of_pinion, of_gear, *bodies, overhang=table["overhang"])
        for i, (k, part) in enumerate(parts.items()):
            columns = {name: values[..., part] for name, values in table.items()}
            basis = bending[i] if bending is not None else loads.bending(columns["pair"], columns["row"])
            gap = columns["separation_angle"], columns["lever_arm"]
            wrench = columns["wrench"].T if "wrench" in columns else None
            piece = columns["searched"], columns["edge"], columns["element"]
            places = columns["point"], columns["pinion_point"]
            result[k] = Segments(columns["pair"], *places, *gap, basis, contact.part(part), *piece, wrench)
        return result


def _sorted(table: dict[str, Array]) -> tuple[dict[str, Array], dict[int, slice]]:
    """A table in the order of the mesh positions, and the part of each that has segments."""
    order = np.argsort(table["position"], kind="stable")
    table = {name: values[..., order] for name, values in table.items()}
    known, first = np.unique(table["position"], return_index=True)
    ends = np.append(first, order.size)
    return table, {int(k): slice(*bounds) for k, *bounds in zip(known, ends[:-1], ends[1:], strict=True)}


@dataclass(frozen=True, eq=False)
class HeldMembers:
    """Supports at every mesh position (k)."""

    modes: Sequence[SupportModes]
    wrenches: MeshWrenches

    def holding(self, segments: Sequence[Segments | None]) -> list[Segments | None]:
        """The segments of every mesh position with its supports."""
        both = zip(segments, self.modes, strict=True)
        return [None if group is None else replace(group, support=modes) for group, modes in both]

    def closing(self, segments: Segments, force: Array) -> float:
        """Rotation [rad] by which some gap on the flank closes farther, by the members' motion, than the gear turns."""
        wrenches = self.wrenches
        return -float(np.min(wrenches.flank @ segments.moved(force) / wrenches.lever_arm))
