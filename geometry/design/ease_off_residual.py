"""The residual of a fit of pinion settings: ease-off less target at the nodes, and the blade tips' way off the root."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np

from ...core.arrays import Array
from ...core.checks import array
from ...core.errors import GeometryError
from ..cutting.generating_surface import GeneratingSurface
from ..cutting.named_settings import CURVATURE_STEPS, get_setting, scale_of, with_settings
from ..flanks.flank import Flank
from ..pair.ease_off import EaseOff, angle_near, exact_ease_off, sheet_area
from ..pair.gear_pair import GearPair, grid
from ..vectors import dot
from .root_line import RootLine

Tie = Callable[[Mapping[str, float]], Mapping[str, float]]

MISSING_RESIDUAL = 1e9  # residual [um] of settings with which the flanks do not meet
ROOT_WEIGHT = 50.0  # [um/mm]
TOO_FEW_NODES = "pinion and gear flank meet on too few nodes to fit the pinion's settings"


@dataclass
class EaseOffResidual:
    """Residuals of a fit of one pinion flank, which starts from where the flanks last met."""

    pair: GearPair
    gear: Flank
    wanted: Array  # ease-off at the nodes (n) [mm]
    free: Sequence[str]
    known: EaseOff
    root_line: RootLine | None
    fold_margin: float
    wanted_root: Array | None = None  # blade's tip above the root cone (3) [mm]; zero if None
    tie: Tie | None = None

    def __post_init__(self) -> None:
        self.start = self.pair.pinion.loaded
        self.origin = np.array([get_setting(self.start, name) for name in self.free])
        self.scale = np.array([scale_of(name) for name in self.free])
        # A straight blade has no radius to differentiate by: long steps, which a flank that is nearly linear in its
        # blade's curvature allows.
        self.difference = np.array([0.1 if name in CURVATURE_STEPS else 1e-4 for name in self.free])
        self.solved = np.full(self.origin.shape, np.nan)
        self.parameters = self.known.pinion_parameters
        self.usable = np.isfinite(self.known.angle)
        if not np.any(self.usable):
            raise GeometryError(TOO_FEW_NODES)
        area = sheet_area(self.known.motion, self.parameters)
        middle = float(np.median(area[self.usable]))
        self.sheet = float(np.sign(middle))
        if self.fold_margin > 0.0:
            self.usable &= self.known.inside & (area / middle > self.fold_margin)
        # Where the start has no root, undercut or not reached, there is none to follow.
        self.rooted = np.zeros(0, bool) if self.root_line is None else np.isfinite(self.root_line.gap(self.start)[0])
        self.lever = self.known.lever_arm[self.usable]
        self.side = float(np.sign(np.median(self.start.orientation(self.parameters)[self.usable])))

    @classmethod
    def of(
        cls,
        pair: GearPair,
        target: Callable[[Array, Array], Array],
        free: Sequence[str],
        nodes: tuple[int, int],
        fold_margin: float,
        *,
        follow_root: bool = False,
        wanted_root: Array | None = None,
        tie: Tie | None = None,
    ) -> EaseOffResidual:
        """Residuals at even nodes of the gear flank; GeometryError if the flanks meet on too few of them."""
        t, h = grid(nodes)
        gear, pinion = pair.gear.flank(t, h), pair.pinion
        on_nodes = target(*(f.ravel() for f in np.meshgrid(t, h, indexing="ij")))
        wanted = array("target", on_nodes, "mm", ndim=1, size=t.size * h.size)
        known = exact_ease_off(gear, pinion.loaded, pinion.section, pair.assembly)
        root_line = RootLine.of(pinion.loaded, pinion.section) if follow_root else None
        residual = cls(pair, gear, wanted, free, known, root_line, fold_margin, wanted_root, tie)
        if residual.lever.size < 2 * len(free):
            raise GeometryError(TOO_FEW_NODES)
        return residual

    def settings(self, steps: Array) -> dict[str, float]:
        """Settings that moved, and those tied to them, at steps (m) of ``named_settings.scale_of``."""
        values = dict(zip(self.free, (float(v) for v in self.origin + self.scale * steps), strict=True))
        return values if self.tie is None else {**values, **self.tie(values)}

    def surface(self, steps: Array) -> GeneratingSurface:
        """The pinion flank at steps (m)."""
        return with_settings(self.start, self.settings(steps))

    def left(self, steps: Array, advice: str = "") -> Array:
        """Ease-off less target at the usable nodes [mm] that steps (m) leave; GeometryError if not that of the flank.

        The fit follows one sheet of the envelope; whoever uses the settings must find the same one.
        """
        left = 1e-3 * self(steps)[: self.lever.size]
        fresh = exact_ease_off(self.gear, self.surface(steps), self.pair.pinion.section, self.pair.assembly)
        if not np.allclose(self.error(fresh.angle), left, rtol=0.0, atol=1e-6):
            raise GeometryError(
                f"the fitted settings cut the blank with another part of the cutter than the fit followed{advice}"
            )
        return left

    def error(self, angle: Array) -> Array:
        """Ease-off less target at the usable nodes [mm]; a rotation of the gear is no change of form."""
        return self.form(angle[self.usable] * self.lever - self.wanted[self.usable])

    def form(self, gap: Array) -> Array:
        """Gap (..., n) less the rotation of the gear that fits it best."""
        return np.asarray(gap - np.multiply.outer(gap @ self.lever, self.lever) / float(self.lever @ self.lever))

    def __call__(self, steps: Array) -> Array:
        """Residuals [um]: the ease-off's and, asked for, the root line's with its weight."""
        surface = self.surface(steps)
        gap, root_line = (np.zeros(0), None) if self.root_line is None else self.root_line.gap(surface)
        if gap.size:
            gap = (gap if self.wanted_root is None else gap - self.wanted_root)[self.rooted]
        motion = replace(self.known.motion, surface=surface)
        angle, parameters = angle_near(motion, self.parameters, self.side, self.sheet, self.gear)
        residual = np.concatenate([1e3 * self.error(angle), ROOT_WEIGHT * gap])
        if not np.all(np.isfinite(residual)):
            # A step so large that the flanks no longer meet: the search must take a shorter one.
            return np.linspace(MISSING_RESIDUAL, 2.0 * MISSING_RESIDUAL, residual.size)
        self.parameters, self.root_line, self.solved = parameters, root_line, steps.copy()
        return residual

    def jacobian(self, steps: Array) -> Array:
        """Derivatives of the residuals by the steps (n, m) [um]; GeometryError if settings close by cut no flank.

        A setting that moves the pinion flank along its normal moves its envelope, the conjugate gear, as far: no
        conjugate point has to be sought.
        """
        if not np.array_equal(steps, self.solved):
            self(steps)
        motion = replace(self.known.motion, surface=self.surface(steps))
        parameters = self.parameters[:, self.usable]
        normal = motion.surface.evaluate(parameters)[1]
        action, action_normal = motion.action_point(parameters, motion.conjugate_gear(parameters)[1])
        arm = action - motion.assembly.gear_origin.reshape(3, 1)
        moment = motion.pinion_sense * (arm[0] * action_normal[1] - arm[1] * action_normal[0])
        columns = []
        for index, step in enumerate(self.difference):
            shift = np.zeros(steps.size)
            shift[index] = step
            ahead, behind = (self.surface(steps + sign * shift) for sign in (1.0, -1.0))
            moved = ahead.evaluate(parameters)[0] - behind.evaluate(parameters)[0]
            change = [1e3 * self.form(dot(moved, normal) / moment * self.lever)]
            if self.root_line is not None:
                change.append(ROOT_WEIGHT * self.root_line.change(motion.surface, behind, ahead)[self.rooted])
            columns.append(np.concatenate(change) / (2.0 * step))
        slopes = np.stack(columns, axis=1)
        if not np.all(np.isfinite(slopes)):
            raise GeometryError("the fit of the pinion's settings ran to settings that cut no flank")
        return slopes
