"""Smallest gap between two bounded flanks by direct search: unloaded contact without ease-off and contact lines.

At a pinion rotation every point of the gear flank has its own gap: the rotation of the gear, against the drive sense,
that brings it onto the pinion flank. On the way it keeps its distance along the gear axis and from it: two equations
for the two parameters of the pinion flank, solved on the generated surfaces themselves. The smallest gap over all
pairs of points that belong to both flanks is the closing angle at which the tooth pair touches. It is searched for
inside, and along every edge of either member on the flank of the other; a flank ends at toe, heel, tip, its root line
and where the blade's edge radius begins to cut.

The gap along the normal of the gear is found without any approximation, too. Both members stand where their shafts have
turned them; from points of the gear flank a ray runs along the outward normal to the pinion flank. Negative where the
flanks overlap.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import fields, replace

import numpy as np
from numpy.typing import NDArray
from scipy.spatial import cKDTree

from ..core.arrays import Array, Bools, Integers, record
from ..core.checks import array, instance
from ..geometry.cutting.generating_surface import GeneratingSurface
from ..geometry.flanks.flank import Flank, NodeStatus, deepest, pick, seed_lattice, solve_flank
from ..geometry.newton import COLUMNS_PER_BLOCK, complex_steps, cramers_rule, solve
from ..geometry.pair.conjugate_motion import ConjugateMotion
from ..geometry.pair.gear_pair import Member, PairGeometry
from ..geometry.vectors import column, cross, dot, rotate

FIELD_NODES = (41, 31)  # of the gear flank, from which the search inside starts
EDGE_NODES = 81  # of every edge
SEED_MARGIN = 0.3  # fraction of the flank by which first guesses lie beyond it
STARTS = 2  # local minima of the field's valley that are followed, of rows and of columns each
PAIR_LIMIT = 12  # tooth pairs ahead of the followed one, and behind it, at most
GAP_ABOVE_LEAST_LIMIT = 2e-4  # [rad]; what lies so far above the least value of all nodes needs no refinement
STENCIL_STEPS = (0.02, 0.02, 0.01, 0.005, 0.005, 0.002, 0.001, 0.001)  # fractions of the flank
ZOOM_ROUNDS, ZOOM_NODES = 7, 11
CREASE_WIDTH, CREASE_ROUNDS, CREASE_SHRINKAGE = 0.02, 12, 0.4  # half-width of the first grid, of the flank
NEWTON_ITERATIONS, NEWTON_TOLERANCE = 25, 1e-10  # [mm]
FRACTION_TOLERANCE, BLADE_TOLERANCE = 1e-9, 1e-8  # [1], [mm]; by which a point may lie beyond an edge
LIMIT_ITERATIONS = 12
#: Edges by name: the fraction that is held, and its value; the root ends at the blade's limit if that is higher.
EDGES = {"toe": (0, 0.0), "heel": (0, 1.0), "root": (1, 0.0), "tip": (1, 1.0)}


@record(frozen=True)
class SmallestGap:
    """Smallest gap at pinion rotations (n); NaN where no point of one flank lies opposite a point of the other.

    Parameters
    ----------
    closing_angle
        Gear rotation against the drive sense, beyond the ideal ratio, at which the flanks touch [rad]: the transmission
        error plus ``first_contact_rad`` of the ease-off.
    gear, pinion
        Lengthwise and profile fractions (2, n) of the point on either flank.
    edge
        Edge (n) the point lies on, such as ``"pinion tip"``; empty inside.

    Examples
    --------
    >>> from easeoff.cases import gear_pair, read_case
    >>> from easeoff.geometry import pair_geometry
    >>> geometry = pair_geometry(gear_pair(read_case("nasa-12x36")), (9, 7))
    >>> gap = smallest_gap(geometry, np.array([0.0, 0.4]))
    >>> gap.edge.tolist()
    ['', 'pinion tip']
    """

    closing_angle: Array
    gear: Array
    pinion: Array
    edge: NDArray[np.str_]


def smallest_gap(geometry: PairGeometry, rotations: Array) -> SmallestGap:
    """Smallest gap of one tooth pair over both bounded flanks.

    Parameters
    ----------
    geometry
        The pair: its members and their motion are used, its ease-off is not.
    rotations
        Pinion rotations (n) in the drive sense, zero in the middle of the pinion, as the roll angle is counted [rad].
        The tooth pair p of a mesh position is that far behind: subtract p pitches.

    Examples
    --------
    >>> from easeoff.cases import gear_pair, read_case
    >>> from easeoff.geometry import pair_geometry
    >>> geometry = pair_geometry(gear_pair(read_case("nasa-12x36")), (9, 7))
    >>> gap = smallest_gap(geometry, np.array([0.0]))
    >>> bool(gap.closing_angle[0] > geometry.ease_off.attrs["first_contact_rad"])
    True
    """
    instance("geometry", geometry, PairGeometry)
    rotations = np.atleast_1d(array("rotations", rotations, "rad", fewest=1))
    flanks = _Flanks(geometry)
    return _together([flanks.smallest(rotation) for rotation in rotations.ravel().tolist()])


def smallest_envelope(geometry: PairGeometry, rotations: Array) -> tuple[SmallestGap, Integers]:
    """Smallest gap over all tooth pairs at pinion rotations (n), and the tooth pair (n) that carries."""
    flanks, pitch = _Flanks(geometry), geometry.pair.assembly.pinion_pitch
    best, carrying = [], []
    for rotation in np.atleast_1d(rotations):
        gap, carrier = flanks.smallest(float(rotation)), 0
        for sense in (1, -1):
            for pair in range(1, PAIR_LIMIT):
                limit = gap[0] + GAP_ABOVE_LEAST_LIMIT if np.isfinite(gap[0]) else np.inf
                other = flanks.smallest(float(rotation) - sense * pair * pitch, limit)
                if other[0] < gap[0] or not np.isfinite(gap[0]):
                    gap, carrier = other, sense * pair
                elif not other[0] < limit:
                    break
        best.append(gap)
        carrying.append(carrier)
    return _together(best), np.array(carrying)


Found = tuple[float, Array, Array, str]
NOTHING: Found = (np.nan, np.full(2, np.nan), np.full(2, np.nan), "")


def _together(gaps: list[Found]) -> SmallestGap:
    angle, gear, pinion, edge = zip(*gaps, strict=True)
    return SmallestGap(np.array(angle), np.stack(gear, axis=1), np.stack(pinion, axis=1), np.array(edge))


class _Flanks:
    """Both flanks of a pair, and the search between them at one rotation."""

    def __init__(self, geometry: PairGeometry) -> None:
        self.motion, pair = geometry.exact.motion, geometry.pair
        self.gear, self.pinion = pair.gear, pair.pinion
        self.parts = pair.pinion.loaded.flank_parts
        self.lattices = [_near_flank(part, self.pinion) for part in self.parts]
        t, h = np.meshgrid(*(np.linspace(0.0, 1.0, n) for n in FIELD_NODES), indexing="ij")
        self.field = np.stack([t.ravel(), h.ravel()])
        self.field_flank = _flank(self.gear, self.field)
        along = np.linspace(0.0, 1.0, EDGE_NODES)
        self.edges = {
            (member, name): _edge(owner, name, along)
            for member, owner in (("gear", self.gear), ("pinion", self.pinion))
            for name in EDGES
        }

    def smallest(self, rotation: float, limit: float = np.inf) -> Found:
        """Smallest gap at one rotation, where, and on which edge; NaN if it is surely above a limit [rad]."""
        field, _ = self._closing(self.field_flank, rotation)
        along = {key: self._edge_gap(key[0], flank, rotation)[0] for key, (_, flank) in self.edges.items()}
        least = min(float(np.min(v, initial=np.inf, where=np.isfinite(v))) for v in (field, *along.values()))
        if not least < limit:
            return NOTHING
        candidates = self._inside(field.reshape(FIELD_NODES), rotation)
        for key, value in along.items():
            candidates += self._on_edge(*key, value, rotation, least + GAP_ABOVE_LEAST_LIMIT)
        return min((c for c in candidates if np.isfinite(c[0])), key=lambda c: c[0], default=NOTHING)

    def _inside(self, angle: Array, rotation: float) -> list[Found]:
        """Minima inside both flanks, from the lowest points of the valley in the field (nt, nh)."""
        points = np.concatenate([_valley(angle), _valley(angle.T)[::-1]], axis=1)
        if not points.size:
            return []
        for step in STENCIL_STEPS:
            points = self._lower(points, step, rotation)
        if len(self.parts) > 1 or len(self.gear.loaded.flank_parts) > 1:
            points = np.stack([self._zoomed(point, rotation) for point in points.T], axis=1)
        value, pinion = self._closing(_flank(self.gear, points), rotation)
        within = _within(points)
        return [(float(v), points[:, k], pinion[:, k], "") for k, v in enumerate(value) if within[k]]

    def _lower(self, points: Array, step: float, rotation: float) -> Array:
        """Minima (2, n) of paraboloids through nine points around each of the points (2, n)."""
        shift = np.array([(i, j) for i in (-1, 0, 1) for j in (-1, 0, 1)]).T
        around = (points[:, :, None] + step * shift[:, None]).reshape(2, -1)
        value = self._closing(_flank(self.gear, around), rotation, bounded=False)[0].reshape(-1, 9)
        x, y = shift
        basis = np.stack([np.ones(9), x, y, 0.5 * x**2, x * y, 0.5 * y**2], axis=1)
        _, a, b, aa, ab, bb = np.stack([_fit(basis, row) for row in value], axis=1)
        bowl = (aa > 0.0) & (aa * bb > ab**2)
        with np.errstate(all="ignore"):
            way = -cramers_rule((aa, ab), (ab, bb), (a, b))
        way = np.where(bowl, way, 0.0)
        way = step * way / np.maximum(1.0, np.max(np.abs(way), axis=0) / 4.0)
        return np.asarray(np.clip(points + np.where(np.isfinite(way), way, 0.0), -0.02, 1.02))

    def _zoomed(self, point: Array, rotation: float) -> Array:
        """Lowest point (2) near another by ever finer grids: a paraboloid does not fit a valley along a kink."""
        width = CREASE_WIDTH
        for _ in range(CREASE_ROUNDS):
            steps = width * np.linspace(-1.0, 1.0, ZOOM_NODES)
            tried = point[:, None] + np.stack(np.meshgrid(steps, steps, indexing="ij")).reshape(2, -1)
            tried = np.clip(tried, 0.0, 1.0)
            value, _ = self._closing(_flank(self.gear, tried), rotation)
            if np.any(np.isfinite(value)):
                point = tried[:, np.nanargmin(value)]
            width *= CREASE_SHRINKAGE
        return point

    def _on_edge(self, member: str, name: str, value: Array, rotation: float, limit: float) -> list[Found]:
        """Minima along an edge of one member on the flank of the other, from the values (k) of its nodes."""
        value = np.where(np.isfinite(value), value, np.inf)
        padded = np.pad(value, 1, constant_values=np.inf)
        lowest = np.flatnonzero((value < limit) & (value <= padded[:-2]) & (value <= padded[2:]))
        if not lowest.size:
            return []
        width = 1.0 / (EDGE_NODES - 1)
        place, rows = lowest * width, np.arange(lowest.size)
        for _ in range(ZOOM_ROUNDS):
            # Where the edge leaves the other flank the best node lies beside one without a value, and so to the end.
            tried = np.clip(place[:, None] + width * np.linspace(-1.0, 1.0, ZOOM_NODES), 0.0, 1.0)
            points, flank = _edge(getattr(self, member), name, tried.ravel())
            gaps, other = self._edge_gap(member, flank, rotation)
            gaps = np.where(np.isfinite(gaps), gaps, np.inf).reshape(tried.shape)
            best = np.argmin(gaps, axis=1)
            place, width = tried[rows, best], width * 2.0 / (ZOOM_NODES - 1)
        edge_points, there = (p.reshape(2, *tried.shape)[:, rows, best] for p in (points, other))
        gear, pinion = (edge_points, there) if member == "gear" else (there, edge_points)
        return [(float(gaps[k, best[k]]), gear[:, k], pinion[:, k], f"{member} {name}") for k in rows]

    def _edge_gap(self, member: str, flank: Flank, rotation: float) -> tuple[Array, Array]:
        """Gap (n) at points of an edge that lie on the other flank, and the fractions (2, n) there."""
        if member == "gear":
            return self._closing(flank, rotation)
        motion, assembly = self.motion, self.motion.assembly
        position, _ = assembly.pinion_to_global(flank.position, flank.normal)
        origin = column(assembly.pinion_origin, position)
        turned = np.full(position.shape[1], rotation + motion.center)
        position = rotate(motion.pinion_axis, turned, position - origin) + origin
        position = motion.in_gear(position, turned)
        usable = np.all(np.isfinite(position), axis=0)
        axial, radial = position[2], np.hypot(position[0], position[1])
        there = solve_flank(self.gear.loaded, self.gear.section, *np.where(usable, (axial, radial), 1.0))
        fractions = np.stack(self.gear.section.fractions(axial, radial))
        valid = usable & (there.status == NodeStatus.INSIDE) & _within(fractions)
        return np.where(valid, self._between(position, there.position), np.nan), fractions

    def _closing(self, flank: Flank, rotation: float, *, bounded: bool = True) -> tuple[Array, Array]:
        """Gap (n) at points of the gear flank, and the fractions (2, n) opposite; NaN beyond the bounds."""
        target = np.stack([flank.position[2], np.hypot(flank.position[0], flank.position[1])])
        usable = np.all(np.isfinite(target), axis=0)
        turned = rotation + self.motion.center
        gaps, places, coordinates, valid = [], [], [], []
        for part, (lattice, side) in zip(self.parts, self.lattices, strict=True):
            seen, ahead = self._in_gear(part, lattice, turned)
            facing = ahead > 0.0 if np.any(ahead > 0.0) else ahead <= 0.0  # what does not face is no gap, below
            seeds = cKDTree(np.stack([seen[2], np.hypot(seen[0], seen[1])])[:, facing].T)
            start = lattice[:, facing][:, seeds.query(np.where(usable, target, 1.0).T)[1]]
            parameters, solved = self._met(part, start, np.where(usable, target, 1.0), turned)
            points, _, coordinate = part.evaluate(parameters)
            fractions = np.stack(self.pinion.section.fractions(points[2], np.hypot(points[0], points[1])))
            with np.errstate(invalid="ignore"):
                there, ahead = self._in_gear(part, parameters, turned)
                valid_side = (part.orientation(parameters) * side > 0.0) & (ahead > 0.0)
            gaps.append(np.where(solved & valid_side & usable, self._between(there, flank.position), np.nan))
            places.append(fractions)
            coordinates.append(coordinate)
            valid.append(_within(fractions) & (coordinate > -BLADE_TOLERANCE))
        choice = deepest(self.parts, coordinates, gaps)
        gap, fractions, within = pick(gaps, choice), pick(places, choice), pick(valid, choice)
        if bounded:
            gap = np.where(within & (flank.status == NodeStatus.INSIDE), gap, np.nan)
        return gap, fractions

    def _in_gear(self, surface: GeneratingSurface, parameters: Array, turned: float) -> tuple[Array, Array]:
        """Points (3, n) of the pinion in the gear's frame, both turned, and how far their normals push the gear on."""
        motion, angle = self.motion, np.full(parameters.shape[1], turned)
        position, normal = replace(motion, surface=surface).action_point(parameters, angle)
        from_axis = position - column(motion.assembly.gear_origin, position)
        ahead = dot(cross(column(motion.gear_axis, position), from_axis), normal)
        return motion.in_gear(position, angle), ahead

    def _met(self, surface: GeneratingSurface, start: Array, target: Array, turned: float) -> tuple[Array, Bools]:
        """Parameters (2, n) of the pinion points on the circles that the gear points (2, n) run on, and where found."""

        def axial_and_radial(p: Array) -> Array:
            position, _ = self._in_gear(surface, p, turned)
            return np.stack([position[2], np.sqrt(position[0] ** 2 + position[1] ** 2)])

        tolerance = NEWTON_TOLERANCE / max(1.0, float(np.max(np.abs(target))))  # that of ``solve`` is relative
        met = solve(
            axial_and_radial, start, target, surface.max_step, tolerance=tolerance, iterations=NEWTON_ITERATIONS
        )
        return met.parameters, met.converged

    def _between(self, pinion: Array, gear: Array) -> Array:
        """Angle (n) [rad] by which gear points lie short of pinion points on their circles, in the drive sense."""
        angle = np.arctan2(pinion[1], pinion[0]) - np.arctan2(gear[1], gear[0])
        return np.asarray(self.motion.pinion_sense * (np.mod(angle + np.pi, 2.0 * np.pi) - np.pi))


def _fit(basis: Array, values: Array) -> Array:
    """Coefficients of a paraboloid (6), zero where a value is missing."""
    return np.asarray(np.linalg.lstsq(basis, np.nan_to_num(values), rcond=None)[0]) * np.all(np.isfinite(values))


def _near_flank(surface: GeneratingSurface, member: Member) -> tuple[Array, float]:
    """Surface parameters (2, m) spread over the flank and a little beyond, and the orientation of its valid side."""
    seeds = seed_lattice(surface, member.section)
    lattice = seeds.points.parameters[:, seeds.side]
    position, _, _ = surface.evaluate(lattice)
    fractions = np.stack(member.section.fractions(position[2], np.hypot(position[0], position[1])))
    with np.errstate(invalid="ignore"):
        near = np.all(np.abs(fractions - 0.5) < 0.5 + SEED_MARGIN, axis=0)
    return lattice[:, near], seeds.orientation


def _valley(field: Array) -> Array:
    """Fractions (2, m) of the lowest local minima of the valley in a field (k, n), one point of it in every row."""
    value = np.where(np.isfinite(field), field, np.inf)
    rows, middle = np.arange(field.shape[0]), np.argmin(value, axis=1)
    left, center, right = (value[rows, np.clip(middle + i, 0, field.shape[1] - 1)] for i in (-1, 0, 1))
    with np.errstate(invalid="ignore"):
        bend = left - 2.0 * center + right
        curved = np.isfinite(bend) & (bend > 0.0)
        step = np.where(curved, 0.5 * (left - right) / np.where(curved, bend, 1.0), 0.0)
        lowest = np.where(curved, center - 0.5 * bend * step**2, center)
    padded = np.pad(lowest, 1, constant_values=np.inf)
    minima = np.flatnonzero(np.isfinite(lowest) & (lowest <= padded[:-2]) & (lowest <= padded[2:]))
    minima = minima[np.argsort(lowest[minima])[:STARTS]]
    return np.stack([minima / (field.shape[0] - 1), (middle + step)[minima] / (field.shape[1] - 1)])


def _within(fractions: Array) -> Bools:
    """True where fractions (2, n) lie on a flank."""
    with np.errstate(invalid="ignore"):
        return np.asarray(np.all(np.abs(fractions - 0.5) <= 0.5 + FRACTION_TOLERANCE, axis=0))


def _flank(member: Member, points: Array) -> Flank:
    """The loaded flank at fractions (2, n)."""
    return solve_flank(member.loaded, member.section, *member.section.points(*points))


def _edge(member: Member, name: str, along: Array) -> tuple[Array, Flank]:
    """Fractions (2, n) of points along an edge, and the flank there."""
    axis, value = EDGES[name]
    points = np.stack([along, along])
    points[axis] = value
    flank = _flank(member, points)
    low = flank.blade_distance
    if name != "root" or not np.any(low < 0.0):
        return points, flank
    # The blade coordinate grows up the profile, nearly in proportion: false position with the Illinois weights.
    top = points.copy()
    top[1] = 1.0
    bottom, high = points[1].copy(), _flank(member, top).blade_distance
    upper, cut = np.ones(along.size), low < 0.0
    for _ in range(LIMIT_ITERATIONS):
        with np.errstate(all="ignore"):
            guess = np.where(cut, (bottom * high - upper * low) / (high - low), points[1])
        tried = np.stack([along, guess])
        there = _flank(member, tried).blade_distance
        above = there > 0.0
        low, high = np.where(above, 0.5 * low, there), np.where(above, there, 0.5 * high)
        bottom, upper = np.where(above, bottom, guess), np.where(above, guess, upper)
    points = np.where(cut, np.stack([along, upper]), points)
    return points, _flank(member, points)


ITERATION_LIMIT = 25
RESIDUAL_TOLERANCE = 1e-9  # [mm]


def limited_newton(
    function: Callable[[Array], Array], values: Array, limit: Array, tolerance: float, iterations: int
) -> tuple[Array, Bools]:
    """Values (m, n) of which the first k make a function zero, and where (n) they do; steps have limits (k).

    More equations than unknowns are met by least squares, which keeps the symmetry between them.
    """
    values, converged, count = values.copy(), np.zeros(values.shape[1], dtype=bool), limit.size
    for _ in range(iterations):
        value, derivatives = complex_steps(function, values, count)
        jacobian = np.array(derivatives.transpose(2, 1, 0))
        usable, square = np.all(np.isfinite(jacobian), axis=(1, 2)), len(value) == count
        if square:
            usable &= np.abs(np.linalg.det(jacobian)) > 0.0
        jacobian[~usable] = np.eye(len(value), count)
        residual = np.where(usable, value, 0.0).T[..., None]
        step = -(np.linalg.solve(jacobian, residual) if square else np.linalg.pinv(jacobian) @ residual)[..., 0].T
        converged = usable & (np.max(np.abs(value), axis=0) < tolerance)
        values[:count] += step / np.maximum(1.0, np.max(np.abs(step) / limit[:, None], axis=0))
        if np.all(converged | ~usable):
            break
    return values, converged


@record(frozen=True)
class FlankGap:
    """Gap along the outward normal at points (n) of the gear flank; NaN where no pinion flank was found."""

    gap: Array  # [mm]
    pinion_position: Array  # (3, n) [mm], in the pinion's frame
    facing: Array  # cosine between both normals


def flank_gap(
    motion: ConjugateMotion, position: Array, normal: Array, rotation: float, closing: float, start: Array
) -> FlankGap:
    """Gap between the flanks at one mesh position, at points (3, n) [mm] of the gear, started from ``start``.

    Pinion rotation is in the drive sense, as in ``motion`` [rad]; the closing angle of the gear, beyond the ideal
    ratio, against it [rad].
    """
    if position.shape[1] > COLUMNS_PER_BLOCK:
        parts = [slice(i, i + COLUMNS_PER_BLOCK) for i in range(0, position.shape[1], COLUMNS_PER_BLOCK)]
        gaps = [flank_gap(motion, position[:, p], normal[:, p], rotation, closing, start[:, p]) for p in parts]
        return FlankGap(*(np.concatenate([getattr(f, one.name) for f in gaps], axis=-1) for one in fields(FlankGap)))
    turn = np.asarray(rotation / motion.assembly.ratio - closing)
    origin = column(motion.assembly.gear_origin, position)
    points = rotate(motion.gear_axis, turn, position) + origin
    along = rotate(motion.gear_axis, turn, normal)
    # From here on all rays stand still: three equations for the pinion's two parameters and the distance.
    values = np.concatenate([start, np.zeros((1, position.shape[1]))])

    def miss(v: Array) -> Array:
        point, _ = motion.action_point(v[:2], np.full(v.shape[1], rotation))
        repeats = v.shape[1] // points.shape[1]
        return np.asarray(point - np.tile(points, repeats) - v[2] * np.tile(along, repeats))

    limit = np.concatenate([motion.surface.max_step, [2.0]])
    with np.errstate(all="ignore"):
        values, converged = limited_newton(miss, values, limit, RESIDUAL_TOLERANCE, ITERATION_LIMIT)
        pinion_position, _, _ = motion.surface.evaluate(values[:2])
        _, turned = motion.action_point(values[:2], np.full(values.shape[1], rotation))
    blank = np.where(converged, 1.0, np.nan)
    facing = -np.sum(turned * along, axis=0)
    return FlankGap(values[2] * blank, pinion_position * blank, facing * blank)
