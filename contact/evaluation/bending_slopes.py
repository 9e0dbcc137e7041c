"""Derivatives of the teeth's deflections under held forces, as the segments move over the teeth.

The elastic teeth themselves are held. A segment's unit load on a tooth depends on its points' fractions on that member
alone: two derivatives a member and point, which serve all settings.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ...core.arrays import Array, Integers
from ...core.errors import InputError
from ...geometry.pair.gear_pair import MEMBERS
from ..compliance.finite_elements.flank_compliance import FlankCompliance
from ..compliance.material import Material
from ..compliance.spread_deflection import SpreadDeflection, gaussians
from ..lines.flank_splines import SLOPES
from ..lines.mesh_lines import LoadedPlaces
from ..segments import LineSegments, end_loads_at
from .segment_slopes import FieldDirections, SegmentSlopes, on_member

POINT_STEP = 1e-7  # fraction of the flank; shape functions are quadratic between borders, few of which are so near
END_STEP_SHARE = 0.05  # of the usual steps: unit loads of free ends fall off in hundredths of a millimetre
PLACE_STEP = 1e-5  # [mm], of the places and depths of a Gaussian some millimetres wide


@dataclass(frozen=True)
class MemberLoads:
    """Unit loads on one member's teeth and their derivatives, n segments of g points."""

    loads: Array  # whitened, then in the modes of the body (n, k)
    by_point: Array  # derivatives by the fractions of each point (2, n, g, k)
    motion: Array
    whitened_count: int  # of columns


@dataclass(frozen=True)
class BendingSlopes:
    """Changes of deflections under held forces; ``of`` makes one."""

    on_lines: LineSegments
    members: tuple[MemberLoads, ...]
    weights: Array
    beside: tuple[Array, Array]

    @classmethod
    def of(cls, directions: FieldDirections, segments: SegmentSlopes) -> BendingSlopes:
        """Derivatives at the points where the segments are loaded; an ``InputError`` refuses teeth that are plates."""
        on_lines = segments.segments.on_lines
        points, moved, weights = segments.points, segments.motion, on_lines.quadrature[1]
        members = []
        for member, tooth, loaded, moving in zip(MEMBERS, on_lines.teeth.both, points, moved, strict=True):
            if not isinstance(tooth, FlankCompliance):
                raise InputError("compliance.model = 'shell': derivatives need solid shells or finite elements")
            at, motion = on_member(directions, member, loaded, moving)
            loads = np.concatenate(tooth.unit_loads(at, weights), axis=1)
            by_point = np.stack([_by_fraction(tooth, at, axis) for axis in (0, 1)])
            members.append(MemberLoads(loads, by_point, motion, tooth.factor.shape[0]))
        beside = (_spread(on_lines, directions, segments), _ends(on_lines, directions, segments))
        both = [np.concatenate(parts, axis=-1) for parts in zip(*beside, strict=True)]
        return cls(on_lines, tuple(members), weights, (both[0], both[1]))

    def __call__(self, pair: Integers, chosen: Integers, force: Array) -> Array:
        """Changes of deflections (s, j) [mm] of the segments ``chosen`` by the settings, under held forces (s) [N]."""
        result = np.zeros((force.size, self.members[0].motion.shape[-1]))
        coupling, pairs = self.on_lines.teeth.coupling, np.unique(pair)
        on_bodies = []
        for member in self.members:
            by_force: list[tuple[Array, Array]] = []
            for one in pairs:
                rows = np.flatnonzero(pair == one)
                selection = chosen[rows]
                amplitude = member.loads[selection].T @ force[rows]
                changed = self._amplitude_change(member, selection, force[rows])
                whitened = slice(0, member.whitened_count)
                held_amplitude = np.concatenate([amplitude[whitened], np.zeros(amplitude.size - member.whitened_count)])
                moved = self._moved(member, selection, held_amplitude)
                result[rows] += moved + member.loads[selection, whitened] @ changed[whitened]
                by_force.append((amplitude[member.whitened_count :], changed[member.whitened_count :]))
            on_bodies.append(by_force)
        if coupling is not None:
            compliance = coupling.compliance(pairs)
            amplitude = np.stack([np.concatenate([m[p][0] for m in on_bodies]) for p in range(pairs.size)])
            changed = np.stack([np.concatenate([m[p][1] for m in on_bodies]) for p in range(pairs.size)])
            answer = np.einsum("aqbr,br->aq", compliance, amplitude)
            answer_change = np.einsum("aqbr,brj->aqj", compliance, changed)
            for number, one in enumerate(pairs):
                rows, start = np.flatnonzero(pair == one), 0
                for member in self.members:
                    columns = slice(start, start := start + member.loads.shape[1] - member.whitened_count)
                    held_amplitude = np.concatenate([np.zeros(member.whitened_count), answer[number, columns]])
                    result[rows] += self._moved(member, chosen[rows], held_amplitude)
                    result[rows] += member.loads[chosen[rows], member.whitened_count :] @ answer_change[number, columns]
        loads, change = self.beside
        for one in pairs if loads.shape[1] else ():
            rows = np.flatnonzero(pair == one)
            selection, moved = loads[chosen[rows]], change[:, chosen[rows]]
            result[rows] += (moved @ (selection.T @ force[rows])).T
            result[rows] += selection @ np.einsum("jnk,n->kj", moved, force[rows])
        return result

    def _moved(self, member: MemberLoads, loads: Array, amplitudes: Array) -> Array:
        """Change (s, j) of the deflections under held amplitudes of the loads (k)."""
        slope = member.by_point[:, loads] @ amplitudes
        return np.asarray(np.einsum("csg,csgj,g->sj", slope, member.motion[:, loads], self.weights))

    def _amplitude_change(self, member: MemberLoads, loads: Array, force: Array) -> Array:
        """Change (k, j) of the amplitudes of the loads under held forces."""
        moved = member.motion[:, loads] * (force[:, None] * self.weights)[..., None]
        by_point = member.by_point[:, loads]
        return np.asarray(by_point.reshape(-1, by_point.shape[-1]).T @ moved.reshape(-1, moved.shape[-1]))


def _by_fraction(tooth: FlankCompliance, points: Array, axis: int) -> Array:
    """Derivatives (n, g, k) of the unit loads at points (2, n, g) by one of their fractions."""
    single = points.reshape(2, -1, 1)
    step = np.zeros((2, 1, 1))
    step[axis] = POINT_STEP
    ahead, behind = (np.concatenate(tooth.unit_loads(single + sign * step, np.ones(1)), axis=1) for sign in (1.0, -1.0))
    return np.asarray((ahead - behind) / (2.0 * POINT_STEP)).reshape(*points.shape[1:], -1)


def _spread(on_lines: LineSegments, directions: FieldDirections, segments: SegmentSlopes) -> tuple[Array, Array]:
    """Unit loads (n, k) of the spread deflection of both members, and their derivatives (j, n, k)."""
    points, weights = segments.points, on_lines.quadrature[1]
    size = points[1].shape[1]
    if not on_lines.spread:
        return np.zeros((size, 0)), np.zeros((directions.count, size, 0))
    materials = on_lines.teeth.model.pinion, on_lines.teeth.model.gear
    parts = []
    position, moved = _with_motion(directions, "position", points[1], segments.motion[1])
    members = zip(MEMBERS, materials, on_lines.spread, points, segments.motion, strict=True)
    for member, material, spread, loaded, motion in members:
        depth, deeper = _with_motion(directions, spread.depth, loaded, motion)
        turned, shifted, wider = _nodes_motion(directions, segments.steps, member, material)
        along = np.einsum("x,xmq->mq", spread.direction, position)
        along_moved = np.einsum("x,xmqj->mqj", spread.direction, moved) + np.einsum("xmq,jx->mqj", position, turned)
        unit, by_shift, by_depth, by_spacing = _gaussian_slopes(spread, along, depth)
        slope = np.einsum("kng,ngj,g->jnk", by_shift, shifted - along_moved, weights, optimize=True)
        slope += np.einsum("kng,ngj,g->jnk", by_depth, deeper, weights, optimize=True)
        slope += wider[:, None, None] * np.einsum("kng,g->nk", by_spacing, weights)
        parts.append((np.einsum("kng,g->nk", unit, weights), slope))
    loads, slopes = zip(*parts, strict=True)
    return np.concatenate(loads, axis=1), np.concatenate(slopes, axis=2)


def _ends(on_lines: LineSegments, directions: FieldDirections, segments: SegmentSlopes) -> tuple[Array, Array]:
    """Unit loads (n, k) of the free ends of both members, and their derivatives (j, n, k)."""
    weights = on_lines.quadrature[1]
    loads = end_loads_at(LoadedPlaces(directions.base, *segments.points), on_lines.teeth) @ weights
    slopes = np.zeros((segments.steps.size, *loads.T.shape))

    def moved(j: int, step: float) -> Array:
        points = (one + step * way[..., j] for one, way in zip(segments.points, segments.motion, strict=True))
        return end_loads_at(LoadedPlaces(directions.moved(j, step), *points), on_lines.teeth)

    for j, step in enumerate(END_STEP_SHARE * segments.steps):
        slopes[j] = ((moved(j, step) - moved(j, -step)) @ weights).T / (2.0 * step)
    return loads.T, slopes


def _with_motion(directions: FieldDirections, name: str, points: Array, motion: Array) -> tuple[Array, Array]:
    """Values (..., n, g) of a field at points (2, n, g), and their derivatives (..., n, g, j) as these move."""
    change = np.moveaxis(directions.slopes(name, points), -3, -1)
    tangents = directions.base.derivatives([name], points, SLOPES)
    moved = sum(tangent[name][..., None] * way for tangent, way in zip(tangents, motion, strict=True))
    return directions.base(name, points), change + moved


def _nodes_motion(
    directions: FieldDirections, steps: Array, member: str, material: Material
) -> tuple[Array, Array, Array]:
    """Derivatives of the direction (j, 3), the first node (j) [mm] and the spacing (j) [mm] of a spread deflection."""
    turned, shifted, wider = np.zeros((steps.size, 3)), np.zeros(steps.size), np.zeros(steps.size)
    for j, step in enumerate(steps):
        ahead, behind = (SpreadDeflection.of(directions.moved(j, way), member, material) for way in (step, -step))
        if ahead.nodes.size != behind.nodes.size:
            continue  # as many nodes as fit: between two numbers of them, where they stand plays no part
        turned[j] = (ahead.direction - behind.direction) / (2.0 * step)
        shifted[j] = (ahead.nodes[0] - behind.nodes[0]) / (2.0 * step)
        wider[j] = (np.diff(ahead.nodes)[0] - np.diff(behind.nodes)[0]) / (2.0 * step)
    return turned, shifted, wider


def _gaussian_slopes(spread: SpreadDeflection, along: Array, depth: Array) -> list[Array]:
    """Unit loads (k, n, g) of a spread deflection at places along its direction and depths (n, g) [mm].

    Then their derivatives as the nodes shift, as the depths grow, and as the nodes stand wider apart.
    """
    nodes = spread.nodes

    def at(shift: float, deeper: float, wider: float) -> Array:
        spacing = nodes[1] - nodes[0] + wider
        moved = nodes[0] + shift + spacing * np.arange(nodes.size)
        return gaussians(moved, along, depth + deeper, spread.flexibility * spacing)

    ways = PLACE_STEP * np.eye(3)
    return [at(0.0, 0.0, 0.0), *((at(*way) - at(*-way)) / (2.0 * PLACE_STEP) for way in ways)]
