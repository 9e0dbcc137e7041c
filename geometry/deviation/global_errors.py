"""Global errors of a flank by their usual names, as a formula and fitted to a measured grid."""

from __future__ import annotations

from dataclasses import astuple, dataclass

import numpy as np

from ...core.arrays import Array
from ...core.checks import check_fields, instance
from ...core.errors import InputError
from ..design.blank import angles_of_normal
from ..flanks.flank import solve_flank
from ..pair.gear_pair import Member
from .deviation import Deviation

TANGENT_HALF_WIDTH = 0.01  # fraction of the flank over which its tangents are taken


@dataclass(frozen=True)
class GlobalErrors:
    """A surface of second order over the whole flank, every coefficient in um of metal along the normal.

    With t and h from -1 to 1 from toe to heel and from root to tip the deviation is ``level + spiral_angle t +
    pressure_angle h - lengthwise_crowning t^2 - profile_crowning h^2 + twist t h``.

    Parameters
    ----------
    spiral_angle
        Half the difference between heel and toe, at mid height.
    pressure_angle
        Half the difference between tip and root, at mid face.
    lengthwise_crowning
        Relief of toe and heel against the middle.
    profile_crowning
        Relief of root and tip against the middle.
    twist
        Metal added at toe-root and heel-tip, and removed at toe-tip and heel-root.
    level
        Value in the middle; it depends on how the tooth was turned for measuring.

    Examples
    --------
    >>> errors = GlobalErrors(lengthwise_crowning=10.0)
    >>> [float(v) for v in errors(np.array([0.0, 0.5, 1.0]), np.full(3, 0.5))]  # toe, middle, heel [um]
    [-10.0, 0.0, -10.0]
    """

    spiral_angle: float = 0.0
    pressure_angle: float = 0.0
    lengthwise_crowning: float = 0.0
    profile_crowning: float = 0.0
    twist: float = 0.0
    level: float = 0.0

    def __post_init__(self) -> None:
        check_fields(self)

    def __call__(self, lengthwise: Array, profile: Array) -> Array:
        """Deviation (...) [um] at fractions (...)."""
        return np.asarray(_terms(lengthwise, profile) @ np.array(astuple(self)))


def _terms(lengthwise: Array, profile: Array) -> Array:
    """Factors of the errors (..., 6), in the order of the fields."""
    t, h = np.broadcast_arrays(2.0 * lengthwise - 1.0, 2.0 * profile - 1.0)
    return np.stack([t, h, -(t**2), -(h**2), t * h, np.ones_like(t)], axis=-1)


@dataclass(frozen=True)
class GlobalErrorFit:
    """Global errors of a measured flank."""

    errors: GlobalErrors
    residual: Array  # at the nodes (columns, rows) [um]
    rms_before: float  # of the deviation, its mean removed [um]
    rms: float


def fit_global_errors(deviation: Deviation) -> GlobalErrorFit:
    """Global errors of a deviation, by least squares on its nodes.

    Raises
    ------
    InputError
        If there are fewer than three rows or columns.

    Examples
    --------
    >>> from easeoff.cases import gear_pair, read_case
    >>> pair = gear_pair(read_case("fm-11x41"))
    >>> from easeoff.geometry import deviation_from_formula
    >>> deviation = deviation_from_formula(pair.gear.section, GlobalErrors(spiral_angle=5.0))
    >>> round(fit_global_errors(deviation).errors.spiral_angle, 9)
    5.0
    """
    instance("deviation", deviation, Deviation)
    columns, rows = deviation.value.shape
    if min(columns, rows) < 3:
        raise InputError(f"grid = {rows} rows x {columns} columns: must have at least 3 of each for global errors")
    terms, value = _terms(*deviation.section.fractions(deviation.axial, deviation.radial)), 1e3 * deviation.value
    errors, *_ = np.linalg.lstsq(terms.reshape(-1, terms.shape[-1]), value.ravel(), rcond=None)
    residual = value - terms @ errors
    return GlobalErrorFit(
        GlobalErrors(*(float(v) for v in errors)), residual, float(np.std(value)), float(np.sqrt(np.mean(residual**2)))
    )


def angle_errors(errors: GlobalErrors, member: Member) -> tuple[float, float]:
    """Changes of spiral angle and pressure angle in the middle of the flank [rad] equivalent to global errors.

    From the normal of the flank, which leans against the slope of the deviation; rows and columns of a measuring grid
    are not at right angles on the flank, so that either error changes both angles.

    Parameters
    ----------
    errors
        The errors.
    member
        The member, seen from the flank with the errors.

    Examples
    --------
    >>> from easeoff.cases import gear_pair, read_case
    >>> pair = gear_pair(read_case("nasa-12x36"))
    >>> spiral, pressure = angle_errors(GlobalErrors(pressure_angle=10.0), pair.gear)
    >>> bool(abs(pressure) > abs(spiral))
    True
    """
    instance("errors", errors, GlobalErrors)
    instance("member", member, Member)
    surface, section = member.loaded.designed, member.section
    t, h = 0.5 + TANGENT_HALF_WIDTH * np.array([0, -1, 1, 0, 0]), 0.5 + TANGENT_HALF_WIDTH * np.array([0, 0, 0, -1, 1])
    flank = solve_flank(surface, section, *section.points(t, h))
    position, normal = flank.position, flank.normal[:, 0]
    tangents = np.stack([position[:, 2] - position[:, 1], position[:, 4] - position[:, 3]]) / (2.0 * TANGENT_HALF_WIDTH)
    slopes = 2e-3 * np.array([errors.spiral_angle, errors.pressure_angle])  # t and h run over twice their fractions
    leaning = normal - np.linalg.solve(np.stack([*tangents, normal]), [*slopes, 0.0])
    angles = [
        angles_of_normal(position[:, 0], n / np.linalg.norm(n), section.pitch_angle, surface.hand)
        for n in (normal, leaning)
    ]
    return (angles[1].spiral_angle - angles[0].spiral_angle, angles[1].pressure_angle - angles[0].pressure_angle)
