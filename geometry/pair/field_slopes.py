"""Derivatives of a pair's ease-off, roll angle and what else the contact needs by machine and cutter settings.

At a fixed node of the gear flank (a fixed axial and radial coordinate) every field is an analytic function of the
settings. How the surface parameters at a node follow a setting is known implicitly, see ``near_pair``; along that path
the closed-form fields are differentiated by differences of fourth order. Rounding grows as a step gets shorter, and
truncation with the fourth power of a longer one. A setting may move conjugate contact far and unevenly, as the high
powers of the roll do on coast flanks; its step is shortened until both stay near 1e-8 of a derivative, and near 1e-7 of
that of the separation skew. The ease-off's own derivative has a closed form, too: that of the gap.

That is the normal motion of the flanks. Where a setting moves a flank along its normal, the gap closes or opens by as
much; over the moment of the normal about the gear axis that is a gear angle. By the envelope theorem it is the
derivative of the ease-off as well, where the pinion's rotation is that of conjugate contact, and of the unloaded
transmission error, where the point is that of the smallest gap: to first order neither moves.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from ...core.arrays import Array
from ..cutting.generating_surface import GeneratingSurface
from ..flanks.flank import Flank, on_parts
from ..vectors import dot
from .ease_off import EaseOff, drift
from .gear_pair import NODE_FIELDS, NODE_VECTORS, GearPair, PairGeometry, first_contact
from .modification import Modification
from .near_pair import KnownPair, NearPair, Origin, PairSetting, at_places, rate, uneven

STEP_SHARE = 0.02  # of the usual step of a setting, at most
UNEVENNESS_LIMIT = 3e-4  # of the separation skew, which bends most: truncation is near the square, rounding 1e-8
WITHIN_LIMIT = 0.8  # of that limit, at which a shortened step aims: the departure grows with the square of the step
SHORTEST_SHARE = 1.0 / 32.0  # of a step, by which one round shortens it at most
STEP_ROUNDS = 3  # of shortening: over a step that is much too long the departure says little
ZERO_STEP = 1e-9  # [rad], of the ease-off: its zero is that of the same node on either side


def field_slopes(geometry: PairGeometry, settings: Sequence[PairSetting]) -> dict[str, Array]:
    """Derivatives (nt, nh, ..., j) of the fields on the gear flank, by name, per mm, rad, or unit of the setting.

    A modified ease-off keeps its addition along the normal; the tooth bodies are held. ``put_in`` [rad] is added to the
    gap of the flanks: a modification, less the zero of the ease-off. NaN without a conjugate point.
    """
    known = KnownPair(geometry)
    at_node = _Fields(geometry)
    columns: list[dict[str, Array]] = []
    for setting in settings:
        if setting.of == "modification":
            columns.append(at_node.by_term(setting.name))
            continue
        each, step = _balanced(known, at_node, setting)
        columns.append({name: rate([one[name] for one in each], step) for name in each[0]})
        angle = columns[-1]["ease_off_angle"]
        columns[-1]["ease_off_angle"] = at_node.from_first_contact(angle)
        columns[-1]["put_in"] += columns[-1]["ease_off_angle"] - angle
    names = columns[0] if columns else at_node.known
    return {name: np.stack([one[name] for one in columns], axis=-1) for name in names}


def _balanced(known: KnownPair, at_node: _Fields, setting: PairSetting) -> tuple[list[dict[str, Array]], float]:
    """Fields at the ``PLACES`` of a setting, and the step: as long as the fields hardly bend over it."""

    def places(step: float) -> list[dict[str, Array]]:
        return [at_node(near) for near in known.along(at_places(setting, known.geometry.pair, step), step)]

    step = STEP_SHARE * setting.scale
    each = places(step)
    for _ in range(STEP_ROUNDS):
        departure = uneven([one["separation_skew"] for one in each])
        if departure <= UNEVENNESS_LIMIT:
            break
        step *= max((WITHIN_LIMIT * UNEVENNESS_LIMIT / departure) ** 0.5, SHORTEST_SHARE)
        each = places(step)
    return each, step


class _Fields:
    """Fields of a pair near a known one, with its bodies and its modification."""

    def __init__(self, geometry: PairGeometry) -> None:
        self.geometry = geometry
        exact, dataset = geometry.exact, geometry.ease_off
        angle = dataset["ease_off_angle"].transpose("lengthwise", "profile").values.ravel()
        added = (angle + dataset.attrs["first_contact_rad"] - exact.angle) * exact.lever_arm
        # Without a modification nothing but rounding is left.
        self.added = np.where(np.abs(added) > 1e-12, added, 0.0)
        self.angle, self.inside = angle.reshape(geometry.nodes), exact.inside.reshape(geometry.nodes)

    @cached_property
    def known(self) -> dict[str, Array]:
        """Of the pair itself."""
        return self(NearPair(self.geometry.members.gear, self.geometry.exact))

    def __call__(self, near: NearPair) -> dict[str, Array]:
        exact, gear, nodes = near.exact, near.gear, self.geometry.nodes
        put_in = self.added / exact.lever_arm
        vectors = {"position": gear.position, **{name: getattr(exact, name) for name in NODE_VECTORS}}
        values = {
            "ease_off_angle": (exact.angle + put_in).reshape(nodes),
            "put_in": put_in.reshape(nodes),
            **{name: np.moveaxis(vector.reshape(3, *nodes), 0, -1) for name, vector in vectors.items()},
            **{name: getattr(exact, name).reshape(nodes) for name in (*NODE_FIELDS, "blade_distance")},
        }
        # Most settings leave one of both members alone.
        same_pinion = exact.pinion_position is self.geometry.exact.pinion_position
        same_gear = gear.position is self.geometry.members.gear.position
        values |= self._known_pinion if same_pinion else self._of_pinion(exact)
        return values | {"depth_gear": self._known_gear if same_gear else self._depth(1, gear.position, gear.normal)}

    def _of_pinion(self, exact: EaseOff) -> dict[str, Array]:
        passing = {name: values.reshape(self.geometry.nodes) for name, values in drift(exact).of_fractions.items()}
        return {"depth_pinion": self._depth(0, exact.pinion_position, exact.pinion_normal), **passing}

    @cached_property
    def _known_pinion(self) -> dict[str, Array]:
        return self._of_pinion(self.geometry.exact)

    @cached_property
    def _known_gear(self) -> Array:
        gear = self.geometry.members.gear
        return self._depth(1, gear.position, gear.normal)

    def _depth(self, member: int, position: Array, normal: Array) -> Array:
        depth = self.geometry.members.bodies[member].shell_coordinates(position, normal).depth
        return depth.reshape(self.geometry.nodes)

    def by_term(self, name: str) -> dict[str, Array]:
        """Derivatives by a term of a modification [um], which adds to the ease-off alone."""
        members = self.geometry.members
        lengthwise, profile = np.meshgrid(members.lengthwise, members.profile, indexing="ij")
        added = 1e-3 * Modification({name: 1.0})(lengthwise, profile)
        slopes = {field: np.zeros_like(values) for field, values in self.known.items()}
        lever_arm = self.geometry.exact.lever_arm.reshape(self.geometry.nodes)
        slopes["ease_off_angle"] = slopes["put_in"] = self.from_first_contact(added / lever_arm)
        return slopes

    def from_first_contact(self, slope: Array) -> Array:
        """Derivative of the ease-off (nt, nh), less that of its zero, the paraboloid about the lowest node."""
        relative = slope - slope[np.unravel_index(np.argmin(np.where(self.inside, self.angle, np.inf)), slope.shape)]
        step = ZERO_STEP / max(float(np.nanmax(np.abs(relative))), 1e-300)
        ahead, behind = (first_contact(self.angle + sign * step * relative, self.inside) for sign in (1.0, -1.0))
        return np.asarray(relative - (ahead - behind) / (2.0 * step))


def _by_settings(
    geometry: PairGeometry,
    settings: Sequence[PairSetting],
    origins: tuple[Origin, ...],
    slope: Callable[[Sequence[GearPair], float], Array],
    shape: tuple[int, ...],
) -> Array:
    """Slopes (..., j) by the settings of some origins, from the pair at their ``PLACES``; zero by the others."""
    slopes = np.zeros((*shape, len(settings)))
    for number, setting in enumerate(settings):
        if setting.of in origins:
            step = STEP_SHARE * setting.scale
            slopes[..., number] = slope(at_places(setting, geometry.pair, step), step)
    return slopes


def pinion_gap_slopes(
    geometry: PairGeometry, settings: Sequence[PairSetting], parameters: Array, part: NDArray[np.int8], rotation: Array
) -> Array:
    """Derivatives of the gap by the pinion's place, as a gear rotation (n, j) [rad].

    Zero for settings of the gear and a modification. Pinion points (2, n) on parts (n), at rotations (n) [rad] counted
    as the roll angle; their zero follows the pinion's mean point.
    """
    known, motion = KnownPair(geometry), geometry.exact.motion
    _, position, normal, _ = _from_gear(known, geometry.pair, parameters, part, rotation)
    moment = position[0] * normal[1] - position[1] * normal[0]

    def closing(pairs: Sequence[GearPair], step: float) -> Array:
        each = [_from_gear(known, pair, parameters, part, rotation) for pair in pairs]
        moved = rate([place for _, place, _, _ in each], step)
        turned = rate([np.asarray(center) for _, _, _, center in each], step) / motion.assembly.ratio
        return np.asarray(motion.pinion_sense * dot(moved, normal) / moment + turned)

    return _by_settings(geometry, settings, ("pinion", "assembly"), closing, rotation.shape)


def gear_gap_slopes(geometry: PairGeometry, settings: Sequence[PairSetting], gear: Flank) -> Array:
    """Derivatives of the gap by the gear flank, as a gear rotation (n, j) [rad]; zero for all but its settings."""
    moment = gear.position[0] * gear.normal[1] - gear.position[1] * gear.normal[0]

    def positions(pair: GearPair) -> Array:
        return on_parts(pair.gear.loaded.flank_parts, gear.part, gear.parameters, lambda part, p: part.evaluate(p)[0])

    def closing(pairs: Sequence[GearPair], step: float) -> Array:
        moved = rate([positions(pair) for pair in pairs], step)
        return np.asarray(-geometry.exact.motion.pinion_sense * dot(moved, gear.normal) / moment)

    return _by_settings(geometry, settings, ("gear",), closing, gear.part.shape)


def held_point_slopes(
    geometry: PairGeometry, settings: Sequence[PairSetting], parameters: Array, part: NDArray[np.int8], rotation: Array
) -> tuple[Array, Array]:
    """Derivatives of the place of pinion points of held parameters (n).

    Of axial and radial coordinate along the gear axis (2, n, j) [mm], and of both fractions on the pinion (2, n, j).
    """
    known = KnownPair(geometry)

    def stand(pair: GearPair) -> Array:
        points, (x, y, z), _, _ = _from_gear(known, pair, parameters, part, rotation)
        fractions = geometry.exact.pinion_section.fractions(points[2], np.hypot(points[0], points[1]))
        return np.stack([z, np.hypot(x, y), *fractions])

    def moved(pairs: Sequence[GearPair], step: float) -> Array:
        return rate([stand(pair) for pair in pairs], step)

    slopes = _by_settings(geometry, settings, ("pinion", "assembly"), moved, (4, *rotation.shape))
    return slopes[:2], slopes[2:]


def _from_gear(
    known: KnownPair, pair: GearPair, parameters: Array, part: NDArray[np.int8], rotation: Array
) -> tuple[Array, Array, Array, float]:
    """Points and normals of the pinion (7, n), and seen from the gear (3, n) each; rotation of the zero.

    An error may move the gear along its axis.
    """
    there = known.motion(pair)
    points = on_parts(pair.pinion.loaded.flank_parts, part, parameters, GeneratingSurface.rows)
    position, normal = there.turned(*pair.assembly.pinion_to_global(points[:3], points[3:6]), rotation + there.center)
    return points, position - pair.assembly.gear_origin.reshape(3, 1), normal, there.center
