"""Pinion settings from a target ease-off: least squares on the machine settings, from the exactly conjugate pinion.

The residual is ease-off less target at the nodes, with the blade tips' way off the root cone of the blank.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np

from ...core.arrays import Array, record
from ...core.checks import array, check_fields, instance, positive, truth, words
from ...core.errors import GeometryError
from ..cutting.generating_surface import GeneratingSurface
from ..cutting.named_settings import CURVATURE_STEPS, get_setting, scale_of, with_settings
from ..flanks.blank_section import BlankSection
from ..flanks.flank import solve_flank
from ..newton import complex_steps, cramers_rule, solve
from ..pair.ease_off import angle_near, exact_ease_off, sheet_area
from ..pair.gear_pair import GearPair, grid
from ..tooth.tooth_surface import tip_gap
from ..vectors import dot
from .pinion_method import BLADE_SETTINGS, MACHINE_SETTINGS

# Without tilt and swivel: their effects are nearly those of other settings, which makes the fit ill-conditioned.
FREE_SETTINGS = (*BLADE_SETTINGS, *MACHINE_SETTINGS, "modified_roll_2c", "modified_roll_6d")
# To follow the root cone the cutter has to be tilted anew; the others then hold the flank.
FREE_SETTINGS_WITH_TILT = (*FREE_SETTINGS, "cutter_tilt", "cutter_swivel", "sliding_base")
# A pinion rolled with a crown gear follows its root cone by the root angle, as on a machine without tilt.
FREE_SETTINGS_WITH_ROOT_ANGLE = (*FREE_SETTINGS, "machine_root_angle", "sliding_base")
COMMON_FLANK_TOLERANCE = 1e-6  # relative change of the sum of squares at which a fit on the common flank ends

LOST_ROOT_GAP = 10.0  # [mm]; weight of a root point that the cutter does not reach


@dataclass(frozen=True)
class EaseOffTarget:
    """Wanted ease-off on the gear flank, up to a constant [mm].

    With t and h from -1 to 1 lengthwise and up the profile it is
    ``lengthwise_crowning t^2 + profile_crowning h^2 - bias t h + spiral_angle_error t + pressure_angle_error h``.

    Parameters
    ----------
    lengthwise_crowning
        At toe and heel, mid height.
    profile_crowning
        At root and tip, mid face.
    bias
        Twist; positive adds gap at toe-tip and heel-root.
    spiral_angle_error
        Half the difference between heel and toe.
    pressure_angle_error
        Half the difference between tip and root.

    Examples
    --------
    >>> target = EaseOffTarget(lengthwise_crowning=0.03)
    >>> [float(v) for v in target(np.array([0.0, 0.5, 1.0]), np.full(3, 0.5))]
    [0.03, 0.0, 0.03]
    """

    lengthwise_crowning: float = 0.0
    profile_crowning: float = 0.0
    bias: float = 0.0
    spiral_angle_error: float = 0.0
    pressure_angle_error: float = 0.0

    def __post_init__(self) -> None:
        check_fields(self)

    def __call__(self, lengthwise: Array, profile: Array) -> Array:
        """Target (n) [mm] at fractions (n)."""
        t, h = 2.0 * lengthwise - 1.0, 2.0 * profile - 1.0
        second = self.lengthwise_crowning * t**2 + self.profile_crowning * h**2 - self.bias * t * h
        return np.asarray(second + self.spiral_angle_error * t + self.pressure_angle_error * h)


@record(frozen=True)
class Synthesis:
    """A pinion flank fitted to a target.

    Parameters
    ----------
    surface
        The pinion flank.
    moved
        Start and end value of each free setting: mm, rad or per radian.
    residual
        Ease-off less target at the fit's nodes (n) [mm], its mean removed.
    root_gap
        Height of the path of the blade's tip above the root cone at toe, middle and heel (3) [mm], negative where it
        cuts deeper, NaN where the flank is undercut or missing.

    Examples
    --------
    >>> from easeoff.cases import gear_pair, read_case
    >>> pair = gear_pair(read_case("fm-11x41"))
    >>> fit = fit_pinion(pair, EaseOffTarget(lengthwise_crowning=0.04), free=["point_radius"], nodes=(7, 5))
    >>> isinstance(fit, Synthesis), list(fit.moved)
    (True, ['point_radius'])
    """

    surface: GeneratingSurface
    moved: dict[str, tuple[float, float]]
    residual: Array
    root_gap: Array

    @property
    def rms(self) -> float:
        """Root mean square of the residual [mm]."""
        return float(np.sqrt(np.mean(self.residual**2)))

    @property
    def largest_residual(self) -> float:
        """Largest residual [mm]."""
        return float(np.abs(self.residual).max())


def root_cost(fit: Synthesis) -> float:
    """Sum of squares [mm^2] of the blade tips' heights above the root cone, as a fit weighs them."""
    return float(np.sum((1e-3 * ROOT_WEIGHT * np.nan_to_num(fit.root_gap, nan=LOST_ROOT_GAP)) ** 2))


def fit_pinion(
    pair: GearPair,
    target: Callable[[Array, Array], Array],
    *,
    free: Sequence[str] | None = None,
    nodes: tuple[int, int] = (9, 7),
    follow_root: bool = False,
    fold_margin: float = 0.0,
    wanted_root: Array | None = None,
) -> Synthesis:
    """Fit the pinion's settings to a target ease-off.

    Parameters
    ----------
    pair
        The pair as assembled, with the pinion flank to start from, usually the conjugate one.
    target
        The wanted ease-off on the gear flank (n) [mm] at fractions (n) lengthwise and up the profile, up to a rotation
        of the gear: an ``EaseOffTarget`` or any other function.
    free
        Settings that may move, see ``named_settings``; ``FREE_SETTINGS`` if left out, or
        ``FREE_SETTINGS_WITH_TILT`` to follow the root.
    nodes
        Gear nodes of the fit, lengthwise and along the profile.
    follow_root
        Whether the blade tips shall also run along the root cone, which the conjugate pinion of a tapered tooth does
        not let them do. A millimetre off it counts as much as 50 um of ease-off at one node.
    fold_margin
        Leaves out the nodes beyond either flank, and those so near to a fold of the conjugate gear that its area per
        pinion parameters is below this share of the median's. Zero keeps every node that the pinion reaches.
    wanted_root
        What ``RootLine.gap`` gives at toe, middle and heel (3) [mm] while the blade tips run along the root cone; zero
        if left out.

    Returns
    -------
    Synthesis
        The settings that leave the smallest sum of squares.

    Raises
    ------
    InputError
        If a free setting has another name.
    GeometryError
        If the flanks do not meet on enough of the gear flank.

    Examples
    --------
    More lengthwise crowning takes another cutter radius on another radial distance:

    >>> from easeoff.cases import gear_pair, read_case
    >>> pair = gear_pair(read_case("fm-11x41"))
    >>> target = EaseOffTarget(lengthwise_crowning=0.04, profile_crowning=0.01)
    >>> fit = fit_pinion(pair, target, nodes=(7, 5))
    >>> bool(fit.rms < 0.001)  # [mm]
    True
    """
    instance("pair", pair, GearPair)
    instance("target", target, Callable)
    truth("follow_root", follow_root)
    positive("fold_margin", fold_margin, zero=True)
    from scipy.optimize import least_squares

    names = words("free", free, 1) if free is not None else FREE_SETTINGS_WITH_TILT if follow_root else FREE_SETTINGS

    def fitted(*, exact: bool) -> Synthesis:
        fit = EaseOffResidual(pair, target, names, nodes, fold_margin, follow_root, wanted_root)
        # A straight blade has no radius: begin a little curved.
        curved = np.array([name in CURVATURE_STEPS for name in names])
        solution = least_squares(
            fit,
            np.where(curved & (fit.origin == 0.0), 0.1, 0.0),
            fit.jacobian if exact else "2-point",
            method="trf",
            x_scale=1.0,
            diff_step=fit.difference,
            xtol=1e-12,
            ftol=COMMON_FLANK_TOLERANCE if fold_margin > 0.0 else 1e-12,
            gtol=1e-12,
            max_nfev=60,
        )
        values, surface = fit.settings(solution.x), fit.surface(solution.x)
        moved = {name: (float(start), values[name]) for name, start in zip(names, fit.origin, strict=True)}
        left = fit.left(solution.x, f": free fewer settings than {', '.join(names)}, or start nearer to the target")
        return Synthesis(surface, moved, left, tip_gap(surface, pair.pinion.section))

    try:
        return fitted(exact=True)
    except GeometryError:
        if fold_margin > 0.0:
            raise
        return fitted(exact=False)  # by other steps, which may pass by settings that cut no flank


Tie = Callable[[Mapping[str, float]], Mapping[str, float]]

MISSING_RESIDUAL = 1e9  # residual [um] of settings with which the flanks do not meet
ROOT_WEIGHT = 50.0  # [um/mm]
TOO_FEW_NODES = "pinion and gear flank meet on too few nodes to fit the pinion's settings"


@dataclass
class EaseOffResidual:
    """Residuals of a fit of one pinion flank, which starts from where the flanks last met."""

    pair: GearPair
    target: Callable[[Array, Array], Array]
    free: Sequence[str]
    nodes: tuple[int, int]  # even ones of the gear flank
    fold_margin: float
    follow_root: bool = False
    wanted_root: Array | None = None  # blade's tip above the root cone (3) [mm]; zero if None
    tie: Tie | None = None

    def __post_init__(self) -> None:
        """Raises GeometryError if the flanks meet on too few nodes."""
        (t, h), pinion = grid(self.nodes), self.pair.pinion
        self.gear, self.start = self.pair.gear.flank(t, h), pinion.loaded
        on_nodes = self.target(*(f.ravel() for f in np.meshgrid(t, h, indexing="ij")))
        self.wanted = array("target", on_nodes, "mm", ndim=1, size=t.size * h.size)
        self.known = exact_ease_off(self.gear, pinion.loaded, pinion.section, self.pair.assembly)
        self.root_line = RootLine.of(pinion.loaded, pinion.section) if self.follow_root else None
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
        if self.lever.size < 2 * len(self.free):
            raise GeometryError(TOO_FEW_NODES)
        self.side = float(np.sign(np.median(self.start.orientation(self.parameters)[self.usable])))

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


LENGTHWISE_FRACTIONS = np.array([0.0, 0.5, 1.0])  # toe, middle, heel
PROFILE_FRACTIONS = (0.15, 0.3, 0.45)  # of the nodes: near the root, or higher up where no flank is cut there


@dataclass(frozen=True)
class RootLine:
    """Nodes near the root of a flank at toe, middle and heel, and the parameters that cut them.

    It measures along the blade's axis where the blade cuts these nodes, not the path of the rolling blade's tip, see
    ``tooth_surface.tip_gap``; a change moves both by nearly as much.
    """

    section: BlankSection
    parameters: Array  # (2, 3) of the nodes, a start for other settings
    profile: float = PROFILE_FRACTIONS[0]

    @classmethod
    def of(cls, surface: GeneratingSurface, section: BlankSection) -> RootLine:
        """The nodes of a flank. Raises GeometryError if the cutter meets no tooth of the blank."""
        lines = []
        for profile in PROFILE_FRACTIONS:
            axial, radial = section.points(LENGTHWISE_FRACTIONS, np.full_like(LENGTHWISE_FRACTIONS, profile))
            flank = solve_flank(surface, section, axial, radial)
            lines.append(cls(section, flank.parameters, profile))
            if np.all(np.isfinite(flank.position)):
                return lines[-1]
        return lines[0]

    def gap(self, surface: GeneratingSurface) -> tuple[Array, RootLine]:
        """Distance of the blade's tip above the root cone (3) [mm], and the nodes of this surface, near the known one.

        Negative where it cuts deeper, NaN where the node is not found.
        """
        target = self.section.points(LENGTHWISE_FRACTIONS, np.full_like(LENGTHWISE_FRACTIONS, self.profile))
        solution = solve(surface.axial_and_radial, self.parameters, target, surface.max_step)
        gap = self.section.height_above_root(target[0], target[1]) - _above_tip(surface, solution.parameters)
        parameters = np.where(solution.converged, solution.parameters, self.parameters)
        return np.where(solution.converged, gap, np.nan), RootLine(self.section, parameters, self.profile)

    def change(self, surface: GeneratingSurface, behind: GeneratingSurface, ahead: GeneratingSurface) -> Array:
        """Change of the gap (3) [mm] from one near flank to another, to first order: one step of Newton's method."""
        coordinates, (first, second) = complex_steps(surface.axial_and_radial, self.parameters)

        def above_tip(near: GeneratingSurface) -> Array:
            step = cramers_rule(first, second, coordinates - near.axial_and_radial(self.parameters))
            return _above_tip(near, self.parameters + step)

        return above_tip(behind) - above_tip(ahead)


def root_gap(surface: GeneratingSurface, section: BlankSection) -> Array:
    """Distance of the blade's tip above the root cone at toe, middle and heel (3) [mm], see ``RootLine``."""
    return RootLine.of(surface, section).gap(surface)[0]


def _above_tip(surface: GeneratingSurface, parameters: Array) -> Array:
    """Height of flank points above the tip of the blade, along its axis (n) [mm]."""
    _, _, coordinates = surface.evaluate(parameters)
    return np.array([surface.section.point(c)[1] for c in coordinates])
