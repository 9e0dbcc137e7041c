"""The fit of a pinion's set-up within the limits of the machine: each flank by its own, or both by one.

The start is the pinion that the crown gear of the gear cuts: a machine without tilt whose cradle rolls as the gear's
pitch cone does. Its machine root angle is then laid along the root cone of the pinion.

One cutter for both flanks also has to leave the pinion's slot as wide at its mean point as the blank says.

The tip plane of the cutter stands still while the cradle turns. Seen from the work it envelops a cone with the machine
root angle whose apex is where the work axis meets the plane: the root of the tooth lies on it, whatever else is set.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from functools import partial

import numpy as np

from ...core.arrays import Array
from ...core.errors import GeometryError
from ..cutting.generating_surface import GeneratingSurface
from ..cutting.named_settings import get_setting, with_settings
from ..flanks.blank_section import BlankSection
from ..flanks.flank import solve_flank
from ..newton import solve
from ..pair.gear_pair import FlankName, GearPair
from ..tooth.tooth_surface import tip_gap
from .blank import BlankDimensions
from .closest_fit import BLANK_ADVICE, StandardSteps, first_good, is_good, started_from
from .pinion_method import BLADE_SETTINGS, SettingLimits, SetUpMethod, shared_settings
from .synthesis import EaseOffResidual, EaseOffTarget, Synthesis, root_cost, root_gap


class MeanSlot:
    """The mean point on both flanks of a pinion, and the width that the blank wants between them."""

    def __init__(
        self, concave: GeneratingSurface, convex: GeneratingSurface, section: BlankSection, blank: BlankDimensions
    ) -> None:
        """Raises GeometryError if the cutter meets no tooth of the blank."""
        member = blank.pinion
        self.point = np.array(member.mean_point)[:, None]
        #: (2, 1) on concave and convex flank
        self.parameters = [solve_flank(surface, section, *self.point).parameters for surface in (concave, convex)]
        self.width_per_angle = float(self.point[1, 0]) * math.cos(member.mean_spiral_angle)  # normal [mm/rad]
        self.wanted = math.pi * blank.mean_normal_module - member.mean_normal_thickness  # normal width [mm]

    def width(self, concave: GeneratingSurface, convex: GeneratingSurface) -> float:
        """Normal width of the slot that two flanks of one set-up leave [mm]; NaN where a flank is not found."""
        azimuths, parameters = [], []
        for surface, start in zip((concave, convex), self.parameters, strict=True):
            solution = solve(surface.axial_and_radial, start, self.point, surface.max_step)
            if not np.all(solution.converged):
                return math.nan
            position = surface.evaluate(solution.parameters)[0][:, 0]
            azimuths.append(math.atan2((1.0 if surface.hand == "right" else -1.0) * position[1], position[0]))
            parameters.append(solution.parameters)
        self.parameters = parameters
        return math.remainder(azimuths[1] - azimuths[0], 2.0 * math.pi) * self.width_per_angle

    def change(
        self, surface: GeneratingSurface, behind: GeneratingSurface, ahead: GeneratingSurface, *, convex: bool
    ) -> float:
        """Change of the width [mm] between two flanks near the known one, to first order: the other side stays."""
        parameters = self.parameters[1 if convex else 0]
        position, normal = (vector[:, 0] for vector in surface.evaluate(parameters)[:2])
        moved = (ahead.evaluate(parameters)[0] - behind.evaluate(parameters)[0])[:, 0]
        turn = float(moved @ normal) / float(position[0] * normal[1] - position[1] * normal[0])
        return (1.0 if convex == (surface.hand == "right") else -1.0) * turn * self.width_per_angle

    def error(self, concave: GeneratingSurface, convex: GeneratingSurface) -> float:
        """Width less the wanted one [mm]."""
        return self.width(concave, convex) - self.wanted


CENTER = "machine_center_to_crossing_point"


def _on_the_root(blank: BlankDimensions, values: Mapping[str, float]) -> Mapping[str, float]:
    """The sliding base that keeps the root on its cone where only the machine centre moves it.

    Without tilt, and with the blank's machine root angle, the tip plane of the cutter envelops the root cone: it has to
    pass through the apex of that cone.
    """
    root = blank.pinion
    return {"sliding_base": (root.root_apex - values[CENTER]) * math.sin(root.root_angle)}


def along_the_root(surface: GeneratingSurface, blank: BlankDimensions) -> GeneratingSurface:
    """A pinion flank's machine without tilt, at the root angle of the blank, its tip plane through the root apex."""
    upright = {"cutter_tilt": 0.0, "cutter_swivel": 0.0, "machine_root_angle": blank.pinion.root_angle}
    return with_settings(surface, {**upright, **_on_the_root(blank, {CENTER: get_setting(surface, CENTER)})})


#: Pair to start from, target, and what ``root_gap`` gives for blade tips on the root cone.
Side = tuple[GearPair, EaseOffTarget, Array]
Sides = Mapping[FlankName, Side]

NODES = (9, 7)
FOLD_MARGIN = 0.2  # see ``fit_pinion``
SLOT_WEIGHT = 3e3  # [um/mm]: an error of the slot counts as much as three times the same ease-off at one node
SLOT_STEP = 1e-4  # of the usual steps
RESIDUAL_CHANGE = 1e-6  # relative change of the sum of squares at which a fit ends
LARGEST_EVALUATIONS = 60
#: [rad]; with one milling cutter the conjugate pinion is out of reach, and without tilt nothing turns it.
FIRST_TILTS = (-0.1, 0.02, -0.05)
INTERIOR = 1e-6  # of a step: how far inside its limits a fit begins


class SetUpResidual:
    """Residuals of a set-up that cuts the given sides; each begins from the same machine settings.

    The steps of the ``shared`` machine settings come first, then those of each blade.
    """

    def __init__(
        self, sides: Sides, shared: Sequence[str], blank: BlankDimensions, blade: Sequence[str] = BLADE_SETTINGS
    ) -> None:
        names, tie = (*shared, *blade), None if "sliding_base" in shared else partial(_on_the_root, blank)
        self.parts = [
            EaseOffResidual(pair, target, names, NODES, FOLD_MARGIN, tie is None, root, tie)
            for pair, target, root in sides.values()
        ]
        self.shared, self.blade_steps = len(shared), len(blade)
        self.size = self.shared + self.blade_steps * len(self.parts)  # number of steps
        self.slot: MeanSlot | None = None
        flanks = [part.start for part in self.parts]
        if len(flanks) == 2 and flanks[0].settings.indexing_ratio == 0.0 and "point_radius" in blade:
            self.slot = MeanSlot(flanks[0], flanks[1], sides["drive"][0].pinion.section, blank)

    def columns(self, part: int) -> Array:
        """Places of one flank's steps among all."""
        first = self.shared + part * self.blade_steps
        return np.concatenate([np.arange(self.shared), np.arange(first, first + self.blade_steps)])

    def __call__(self, steps: Array) -> Array:
        """Residuals [um] of every flank, and of the slot."""
        rows = [part(steps[self.columns(k)]) for k, part in enumerate(self.parts)]
        if self.slot is not None:
            error = SLOT_WEIGHT * self.slot.error(*self.surfaces(steps))
            rows.append(np.atleast_1d(error if np.isfinite(error) else 1e9))
        return np.concatenate(rows)

    def jacobian(self, steps: Array) -> Array:
        """Derivatives of the residuals by the steps [um]."""
        rows = []
        for k, part in enumerate(self.parts):
            columns = self.columns(k)
            slopes = part.jacobian(steps[columns])
            block = np.zeros((slopes.shape[0], self.size))
            block[:, columns] = slopes
            rows.append(block)
        if self.slot is not None:
            rows.append(self._slot_slopes(self.slot, steps)[None, :])
        return np.concatenate(rows)

    def surfaces(self, steps: Array) -> list[GeneratingSurface]:
        """The flanks at given steps."""
        return [part.surface(steps[self.columns(k)]) for k, part in enumerate(self.parts)]

    def _slot_slopes(self, slot: MeanSlot, steps: Array) -> Array:
        slopes = np.zeros(self.size)
        for k, part in enumerate(self.parts):
            columns = self.columns(k)
            part_steps = steps[columns]
            surface = part.surface(part_steps)
            for index, shift in zip(columns, SLOT_STEP * np.eye(columns.size), strict=True):
                behind, ahead = part.surface(part_steps - shift), part.surface(part_steps + shift)
                change = slot.change(surface, behind, ahead, convex=k == 1)
                slopes[index] += SLOT_WEIGHT * change / (2.0 * SLOT_STEP)
        return slopes


def best_set_up(
    upright: Mapping[FlankName, GearPair],
    further: Sequence[Mapping[FlankName, GearPair]],
    targets: Mapping[FlankName, EaseOffTarget],
    method: SetUpMethod,
    limits: SettingLimits,
    blank: BlankDimensions,
    cutter_radius: float,
    steps: StandardSteps,
) -> dict[FlankName, Synthesis]:
    """Set-up fitted to the wanted ease-off of both sides: the first good fit, else the best of all.

    ``upright`` is from ``along_the_root``; ``further`` starts come before it where the cutter may be tilted. With
    ``completing`` blades have no steps, and a face-milling cutter also leaves the blank's slot at the mean point.
    """
    shared = shared_settings(method, limits, cutter_radius)
    on_root = {side: root_gap(pair.pinion.loaded, pair.pinion.section) for side, pair in upright.items()}
    first = _one_cutter(upright, blank) if method == "completing" else upright
    starts = [(first, 0.0)]
    if "cutter_tilt" in shared:
        milled = first["drive"].pinion.loaded.settings.indexing_ratio == 0.0
        tilts = FIRST_TILTS if method == "completing" and milled else (0.0,)
        starts = [*((start, 0.0) for start in further), *((first, tilt) for tilt in tilts)]
    sides: list[tuple[FlankName, ...]] = [("drive", "coast")] if method == "completing" else [("drive",), ("coast",)]
    machine = _Machine(shared, limits, blank, cutter_radius)

    def good(fits: Mapping[FlankName, Synthesis]) -> bool:
        return all(is_good(fit, targets[side], blank.clearance) for side, fit in fits.items())

    set_up: dict[FlankName, Synthesis] = {}
    for together in sides:
        attempts = []
        for start, tilt in starts:
            chosen: dict[FlankName, Side] = {side: (start[side], targets[side], on_root[side]) for side in together}
            attempts.append((chosen, partial(_fit, chosen, machine, tilt=tilt)))
        try:
            chosen, best = first_good(attempts, _cost, good)
            # Both flanks share one machine, which cannot make up for two rounded blades.
            set_up |= best if method == "completing" else _stepped(best, chosen, machine, steps)
        except GeometryError as error:
            other = "tilt" if method != "tilt" else "modified_roll"
            raise GeometryError(
                f"{' and '.join(together)}: no pinion of the method {method} was found that meets the gear: {error}; "
                f'choose another method, as method = "{other}", wider limits in [pinion.limits], or {BLANK_ADVICE}'
            ) from error
    return set_up


@dataclass(frozen=True)
class _Machine:
    """Machine settings that a set-up may move, and the limits of them and of the blades for a blank."""

    shared: tuple[str, ...]
    limits: SettingLimits
    blank: BlankDimensions
    cutter_radius: float

    def allowed(self, name: str) -> tuple[float, float]:
        """Least and largest value of a setting."""
        return self.limits.allowed(name, self.blank.pinion.root_angle, self.cutter_radius)


def _stepped(
    fits: Mapping[FlankName, Synthesis], sides: Sides, machine: _Machine, steps: StandardSteps
) -> dict[FlankName, Synthesis]:
    """The fits with blades at standard steps, and the machine settings fitted once more."""
    milled = {side: fit.surface.settings.indexing_ratio == 0.0 for side, fit in fits.items()}
    blades = {
        side: steps.blade(fit.surface, with_radius=milled[side], allowed=machine.allowed) for side, fit in fits.items()
    }
    names = tuple(name for name in BLADE_SETTINGS if any(name not in blade for blade in blades.values()))
    if names == BLADE_SETTINGS:
        return dict(fits)
    near: dict[FlankName, Side] = {}
    for side, (pair, target, root) in sides.items():
        surface = with_settings(fits[side].surface, blades[side])
        near[side] = (replace(pair, pinion=replace(pair.pinion, loaded=surface)), target, root)
    again = _fit(near, machine, blade=names)
    return {side: started_from(sides[side][0].pinion.loaded, fit, fits[side].moved) for side, fit in again.items()}


def _one_cutter(start: Mapping[FlankName, GearPair], blank: BlankDimensions) -> Mapping[FlankName, GearPair]:
    """Start with the point width that leaves the blank's slot, where one face-milling cutter cuts both flanks.

    The outside blade stands at the larger radius; the crown gear's flanks, cut from the other side, would have it at
    the smaller one, with a tooth of the crown gear between them.
    """
    concave, convex = (start[side].pinion for side in ("drive", "coast"))
    if concave.loaded.settings.indexing_ratio != 0.0:
        return start
    slot = MeanSlot(concave.loaded, convex.loaded, concave.section, blank)
    each = -0.5 * slot.error(concave.loaded, convex.loaded)
    pairs: dict[FlankName, GearPair] = {}
    for side, pair in start.items():
        surface = pair.pinion.loaded
        radius = get_setting(surface, "point_radius") + surface.blade.side_sign * each
        moved = with_settings(surface, {"point_radius": radius})
        pairs[side] = replace(pair, pinion=replace(pair.pinion, loaded=moved))
    return pairs


def _cost(fits: Mapping[FlankName, Synthesis]) -> float:
    """Mean square of the residuals [mm^2], with those of the root lines as the fit weighs them."""
    return sum(fit.rms**2 + root_cost(fit) for fit in fits.values())


def _fit(
    sides: Sides, machine: _Machine, *, blade: tuple[str, ...] = BLADE_SETTINGS, tilt: float = 0.0
) -> dict[FlankName, Synthesis]:
    from scipy.optimize import least_squares

    fit = SetUpResidual(sides, machine.shared, machine.blank, blade)
    bounds, start = np.zeros((fit.size, 2)), np.zeros(fit.size)
    for k, part in enumerate(fit.parts):
        for place, name, origin, scale in zip(fit.columns(k), part.free, part.origin, part.scale, strict=True):
            low, high = machine.allowed(name)
            bounds[place] = (low - origin) / scale, (high - origin) / scale
            if name == "cutter_tilt":
                start[place] += tilt / scale
    inside = np.minimum(INTERIOR, 0.25 * (bounds[:, 1] - bounds[:, 0]))
    solution = least_squares(
        fit,
        np.clip(start, bounds[:, 0] + inside, bounds[:, 1] - inside),
        fit.jacobian,
        bounds=(bounds[:, 0], bounds[:, 1]),
        method="trf",
        xtol=1e-10,
        ftol=RESIDUAL_CHANGE,
        gtol=1e-10,
        max_nfev=LARGEST_EVALUATIONS,
    )
    fit(solution.x)
    return {
        side: _synthesis(pair, part, solution.x[fit.columns(k)])
        for k, (part, (side, (pair, _, _))) in enumerate(zip(fit.parts, sides.items(), strict=True))
    }


def _synthesis(pair: GearPair, part: EaseOffResidual, steps: Array) -> Synthesis:
    """The fitted flank, its tilt written as a positive angle."""
    left, surface = part.left(steps), with_positive_tilt(part.surface(steps))
    moved = {name: (float(old), get_setting(surface, name)) for name, old in zip(part.free, part.origin, strict=True)}
    return Synthesis(surface, moved, left, tip_gap(surface, pair.pinion.section))


def with_positive_tilt(surface: GeneratingSurface) -> GeneratingSurface:
    """The same flank with a tilt of zero or more: a negative one is a positive one in the opposite direction."""
    settings = surface.settings
    if settings.cutter_tilt >= 0.0:
        return surface
    swivel = settings.cutter_swivel - np.copysign(np.pi, settings.cutter_swivel)
    return replace(surface, settings=replace(settings, cutter_tilt=-settings.cutter_tilt, cutter_swivel=float(swivel)))
