"""Pinion settings from a target ease-off: least squares on the machine settings, from the exactly conjugate pinion."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np

from ...core.arrays import Array
from ...core.checks import check_fields, frozen_arrays, instance, positive, truth, words
from ..cutting.generating_surface import GeneratingSurface
from ..cutting.named_settings import CURVATURE_STEPS
from ..pair.gear_pair import GearPair
from ..tooth.tooth_surface import tip_gap
from .ease_off_residual import ROOT_WEIGHT, EaseOffResidual

# Without tilt and swivel: their effects are nearly those of other settings, which makes the fit ill-conditioned.
FREE_SETTINGS = (
    "point_radius",
    "pressure_angle",
    "radial_distance",
    "work_offset",
    "machine_center_to_crossing_point",
    "ratio_of_roll",
    "modified_roll_2c",
    "modified_roll_6d",
)


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


@frozen_arrays
@dataclass(frozen=True)
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
    gap = np.nan_to_num(fit.root_gap, nan=LOST_ROOT_GAP)
    return float(np.sum((1e-3 * ROOT_WEIGHT * gap) ** 2))


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
    fit = EaseOffResidual.of(pair, target, names, nodes, fold_margin, follow_root=follow_root, wanted_root=wanted_root)
    # A straight blade has no radius: begin a little curved.
    curved = np.array([name in CURVATURE_STEPS for name in names])
    solution = least_squares(
        fit,
        np.where(curved & (fit.origin == 0.0), 0.1, 0.0),
        # From the conjugate pinion the valley is flat: the shipped cases' settings are those that differences end at.
        fit.jacobian if fold_margin > 0.0 else "2-point",
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
