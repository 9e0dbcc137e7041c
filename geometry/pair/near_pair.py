"""Flanks and ease-off of a pair along a change of one setting, at the nodes of the gear flank.

Which points of the flanks stand at a node follows from the conditions that Newton's method solved: differentiated
implicitly they tell how fast the surface parameters change with the setting. Along the straight path of this rate all
fields have the same first derivative as on the solutions themselves, and nothing has to be solved anew.

A setting is any number of the pair: of machine or cutter, an assembly error, a deviation of the flanks.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, fields, replace
from functools import cached_property, lru_cache
from typing import Any, Literal, get_args

import numpy as np

from ...core.arrays import Array, Bools
from ...core.checks import one_of
from ..cutting.generating_surface import GeneratingSurface, SurfacePoints, axial_and_radial
from ..cutting.named_settings import MODIFIED_ROLL_ORDERS, MOTION_PATTERN, get_setting, scale_of, with_settings
from ..flanks.blank_section import BlankSection
from ..flanks.flank import Flank, mean_parameters, on_parts, pick
from ..newton import cramers_rule, solve
from .conjugate_motion import ConjugateMotion
from .ease_off import EaseOff, classified
from .gear_pair import GearPair, PairGeometry
from .modification import TERM_POWERS

#: Usual steps of the assembly errors, by their names in ``Misalignment`` [mm or rad].
ERROR_STEPS = {"offset": 0.3, "pinion_axial": 0.3, "gear_axial": 0.3, "shaft_angle": 0.003}

Origin = Literal["pinion", "gear", "assembly", "modification"]


@dataclass(frozen=True)
class PairSetting:
    """One number of a pair that can change: setting of a loaded flank, assembly error, or term of the ease-off."""

    of: Origin
    name: str  # as in named_settings, Misalignment or Modification

    def __post_init__(self) -> None:
        one_of("of", self.of, get_args(Origin))
        if self.of == "assembly":
            one_of("assembly error", self.name, ERROR_STEPS)
        elif self.of == "modification":
            one_of("modification term", self.name, TERM_POWERS)
        else:
            scale_of(self.name)

    @property
    def scale(self) -> float:
        """Usual step [mm, rad or per radian; um of a modification]."""
        if self.of == "modification":
            return 1.0
        return ERROR_STEPS[self.name] if self.of == "assembly" else scale_of(self.name)

    def value(self, pair: GearPair) -> float:
        """The number [mm, rad or per radian], of the pair itself."""
        if self.of == "assembly":
            return float(getattr(pair.assembly.misalignment, self.name))
        return get_setting(_designed(pair, self.of), self.name)

    def moved(self, pair: GearPair, step: float) -> GearPair:
        """The pair with the number greater by a step."""
        value = self.value(pair) + step
        if self.of == "assembly":
            return pair.misaligned(replace(pair.assembly.misalignment, **{self.name: value}))
        member = pair.pinion if self.of == "pinion" else pair.gear
        changed = replace(member, loaded=with_settings(member.loaded, {self.name: value}))
        return replace(pair, pinion=changed) if self.of == "pinion" else replace(pair, gear=changed)

    def acts_on(self, pair: GearPair) -> bool:
        """True if the pair has it: a Formate flank has no roll and motions, a face-milled one no rake and hook."""
        if self.of not in ("pinion", "gear"):
            return True
        settings = _designed(pair, self.of).settings
        if self.name == "ratio_of_roll" or self.name in MODIFIED_ROLL_ORDERS or MOTION_PATTERN.fullmatch(self.name):
            return settings.generated
        return settings.indexing_ratio != 0.0 or self.name not in ("rake_angle", "hook_angle")


def _designed(pair: GearPair, of: str) -> GeneratingSurface:
    return (pair.pinion if of == "pinion" else pair.gear).loaded.designed


def is_angle(setting: PairSetting) -> bool:
    """True if the number is an angle, or the derivative of one by the cradle increment [rad]."""
    return setting.name.rsplit("_motion_", 1)[0].endswith(("_angle", "cutter_tilt", "cutter_swivel"))


#: Steps of a fourth-order difference, see ``rate``.
PLACES = (-2.0, -1.0, 1.0, 2.0)
ROUNDED_CHANGE = 1e-6  # over a step, by the value; of less, rounding could be told for a departure


def rate(values: Sequence[Array], step: float) -> Array:
    """Derivative from values at the ``PLACES``, in steps; zero to the bit where nothing changes."""
    far_behind, behind, ahead, far_ahead = values
    return np.asarray((8.0 * (ahead - behind) - (far_ahead - far_behind)) / (12.0 * step))


def at_places(setting: PairSetting, pair: GearPair, step: float) -> list[GearPair]:
    """The pair with a setting moved by a step to each of the ``PLACES``."""
    return [setting.moved(pair, step * place) for place in PLACES]


def uneven(values: Sequence[Array]) -> float:
    """Departure of two differences of second order from each other, over the derivative; NaN does not count.

    Over the ``PLACES`` it is some three times the error of the nearer one, and the error of ``rate`` of the order of
    its square. Values that hardly change count as even.
    """
    far_behind, behind, ahead, far_ahead = values
    near, far = 0.5 * (ahead - behind), 0.25 * (far_ahead - far_behind)
    known = (np.where(np.isfinite(far - near), np.abs(x), 0.0) for x in (ahead, near, far - near))
    size, change, departure = (float(np.max(x)) for x in known)
    return departure / max(change, ROUNDED_CHANGE * size) if departure > 0.0 else 0.0


@dataclass(frozen=True)
class NearPair:
    """Flanks of a pair at the nodes of the gear flank."""

    gear: Flank
    exact: EaseOff  # status, part and the member of blade_distance are those of the known pair


@lru_cache(maxsize=256)
def _mean_near(surface: GeneratingSurface, known: GeneratingSurface, section: BlankSection) -> Array:
    """Parameters (2, 1) of the mean point of a flank near a known one."""
    middle = section.points(np.array([0.5]), np.array([0.5]))
    return solve(surface.axial_and_radial, mean_parameters(known, section), middle, surface.max_step).parameters


@dataclass(frozen=True)
class KnownPair:
    """Pair whose solution is known, from which others near it follow."""

    geometry: PairGeometry

    @property
    def gear(self) -> Flank:
        """The gear flank at the nodes."""
        return self.geometry.members.gear

    @property
    def exact(self) -> EaseOff:
        """The ease-off at the nodes."""
        return self.geometry.exact

    @cached_property
    def _pinion_ends(self) -> Bools:
        """True where the pinion's blade ends nearer to the conjugate point than the gear's to the node (n)."""
        exact = self.exact
        parts = exact.motion.surface.flank_parts
        distance = on_parts(parts, exact.part, exact.pinion_parameters, lambda s, p: s.evaluate(p)[2])
        return np.asarray(distance < self.gear.blade_distance)

    @cached_property
    def _pinion_slopes(self) -> Array:
        """Derivatives (2, 2, n) of the conjugate gear points' coordinates by the pinion's parameters."""
        exact = self.exact

        def slopes(surface: GeneratingSurface, parameters: Array) -> Array:
            return replace(exact.motion, surface=surface).conjugate_place(SurfacePoints.of(surface, parameters))[1]

        with np.errstate(all="ignore"):
            return on_parts(exact.motion.surface.flank_parts, exact.part, exact.pinion_parameters, slopes)

    @cached_property
    def _pinion_sides(self) -> list[float]:
        """Orientation sign of the valid side of every part of the pinion flank."""
        exact = self.exact
        known = np.isfinite(exact.angle)
        sides = []
        for number, part in enumerate(exact.motion.surface.flank_parts):
            mask = known & (exact.part == number)
            values = part.orientation(exact.pinion_parameters[:, mask]) if np.any(mask) else np.ones(1)
            sides.append(float(np.sign(np.median(values))))
        return sides

    @cached_property
    def _gear_slopes(self) -> Array:
        """Derivatives (2, 2, n) of the gear nodes' coordinates by the gear's parameters."""

        def slopes(surface: GeneratingSurface, parameters: Array) -> Array:
            return axial_and_radial(SurfacePoints.of(surface, parameters))[1]

        return on_parts(self.gear.surface.flank_parts, self.gear.part, self.gear.parameters, slopes)

    def along(self, pairs: Sequence[GearPair], step: float) -> list[NearPair]:
        """Pairs on the same blanks, one number changed by so many steps as the ``PLACES`` say."""
        known, first = self.geometry.pair, pairs[0]
        exact, gear = [self.exact] * len(pairs), [self.gear] * len(pairs)
        if first.pinion != known.pinion or first.assembly != known.assembly:
            exact = self._with_pinion(pairs, step)
        if first.gear != known.gear:
            gear = self._with_gear([pair.gear.loaded for pair in pairs], step)
            exact = [self._facing(*each) for each in zip(exact, gear, strict=True)]
        return [NearPair(*each) for each in zip(gear, exact, strict=True)]

    def motion(self, pair: GearPair) -> ConjugateMotion:
        """Conjugate motion of a pair near this one, with the zero of the roll angle at its pinion's mean point."""
        designed = pair.pinion.loaded.designed.on("profile")
        mean = _mean_near(designed, self.geometry.pair.pinion.loaded.designed, pair.pinion.section)
        motion = replace(self.exact.motion, surface=designed, assembly=pair.assembly)
        center = float(motion.rotation(*motion.pinion_point(mean))[0])
        return replace(motion, surface=pair.pinion.loaded.on("profile"), center=center)

    def _with_pinion(self, pairs: Sequence[GearPair], step: float) -> list[EaseOff]:
        known, pinion_parameters = self.exact, self.exact.pinion_parameters
        motions = [self.motion(pair) for pair in pairs]

        def place(motion: ConjugateMotion) -> Array:
            x, y, z = on_parts(
                motion.surface.flank_parts,
                known.part,
                pinion_parameters,
                lambda surface, parameters: replace(motion, surface=surface).conjugate_gear(parameters)[0],
            )
            return np.stack([z, np.hypot(x, y)])

        with np.errstate(all="ignore"):
            first, second = self._pinion_slopes
            moved = -cramers_rule(first, second, rate([place(motion) for motion in motions], step))
        moved = np.where(np.isfinite(moved), moved, 0.0)
        ease_offs, section, solved = [], known.pinion_section, np.isfinite(known.angle)
        for number, motion in zip(PLACES, motions, strict=True):
            each = []
            for part, side in zip(motion.surface.flank_parts, self._pinion_sides, strict=True):
                points = SurfacePoints.of(part, pinion_parameters + number * step * moved)
                each.append(classified(replace(motion, surface=part), section, self.gear, points, solved, side))
            ease_offs.append(self._joined(motion, each))
        return ease_offs

    def _joined(self, motion: ConjugateMotion, parts: list[EaseOff]) -> EaseOff:
        known = self.exact
        names = [f.name for f in fields(EaseOff) if f.name not in ("motion", "pinion_section", "status", "part")]
        picked: dict[str, Any] = {name: pick([getattr(one, name) for one in parts], known.part) for name in names}
        # Azimuths are known but for whole turns.
        apart = np.nanmedian(picked["angle"] - known.angle)
        picked["angle"] = picked["angle"] - 2.0 * np.pi * np.round(apart / (2.0 * np.pi))
        picked["blade_distance"] = np.where(self._pinion_ends, picked["blade_distance"], known.blade_distance)
        return replace(known, motion=motion, **picked)

    def _with_gear(self, surfaces: Sequence[GeneratingSurface], step: float) -> list[Flank]:
        known = self.gear

        def values(surface: GeneratingSurface, parameters: Array) -> Array:
            return on_parts(surface.flank_parts, known.part, parameters, GeneratingSurface.rows)

        def place(surface: GeneratingSurface) -> Array:
            x, y, z = values(surface, known.parameters)[:3]
            return np.stack([z, np.hypot(x, y)])

        with np.errstate(all="ignore"):
            first, second = self._gear_slopes
            moved = -cramers_rule(first, second, rate([place(surface) for surface in surfaces], step))
        moved = np.where(np.isfinite(moved), moved, 0.0)
        flanks = []
        for number, surface in zip(PLACES, surfaces, strict=True):
            parameters = known.parameters + number * step * moved
            points = np.where(np.isfinite(known.position[0]), values(surface, parameters), np.nan)
            flank = {"position": points[:3], "normal": points[3:6], "blade_distance": points[6]}
            flanks.append(replace(known, surface=surface, parameters=parameters, **flank))
        return flanks

    def _facing(self, exact: EaseOff, gear: Flank) -> EaseOff:
        """The ease-off with another gear flank at the nodes."""
        (x, y), position, normal = self.gear.position[:2], gear.position, gear.normal
        # The azimuth beyond that of the known flank, without jumps.
        ahead = np.arctan2(x * position[1] - y * position[0], x * position[0] + y * position[1])
        lever_arm = np.abs(position[0] * normal[1] - position[1] * normal[0])
        return replace(
            exact,
            angle=exact.angle - exact.motion.pinion_sense * ahead,
            lever_arm=np.where(np.isfinite(exact.angle), lever_arm, np.nan),
            blade_distance=np.where(self._pinion_ends, exact.blade_distance, gear.blade_distance),
        )
