"""Global errors of a flank by the names engineers give them, as a formula and fitted to a measured grid."""

from __future__ import annotations

from dataclasses import astuple, dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ..core.errors import InputError
from .deviation import Deviation
from .flank_surface import solve_flank
from .generating_surface import GeneratingSurface
from .section import BlankSection

Array = NDArray[Any]


@dataclass(frozen=True)
class FlankErrors:
    """A surface of second order over the whole flank, every coefficient in um of metal along the normal.

    With t and h from -1 to 1 from toe to heel and from root to tip the deviation is ``level + spiral_angle t +
    pressure_angle h - lengthwise_crowning t^2 - profile_crowning h^2 + twist t h``.

    Parameters
    ----------
    spiral_angle
        Half of what the heel has more than the toe, at mid height.
    pressure_angle
        Half of what the tip has more than the root, at mid face.
    lengthwise_crowning
        What toe and heel have less than the middle.
    profile_crowning
        What root and tip have less than the middle.
    twist
        What toe-root and heel-tip have more, and toe-tip and heel-root less, than without it.
    level
        In the middle; hardly more than a matter of how the tooth was turned for measuring.
    """

    spiral_angle: float = 0.0
    pressure_angle: float = 0.0
    lengthwise_crowning: float = 0.0
    profile_crowning: float = 0.0
    twist: float = 0.0
    level: float = 0.0

    def __call__(self, lengthwise: Array, profile: Array) -> Array:
        """Deviation (...) [um] at fractions (...)."""
        return np.asarray(_terms(lengthwise, profile) @ np.array(astuple(self)))


def _terms(lengthwise: Array, profile: Array) -> Array:
    """What multiplies each error (..., 6), in the order of the fields."""
    t, h = np.broadcast_arrays(2.0 * lengthwise - 1.0, 2.0 * profile - 1.0)
    return np.stack([t, h, -(t**2), -(h**2), t * h, np.ones_like(t)], axis=-1)


@dataclass(frozen=True)
class FlankErrorFit:
    """Global errors of a measured flank.

    Parameters
    ----------
    errors
        The errors.
    residual
        What they leave at the nodes (columns, rows) [um].
    rms_before, rms
        Root mean square of the deviation, its mean removed, and of what is left [um].
    """

    errors: FlankErrors
    residual: Array
    rms_before: float
    rms: float


def fit_flank_errors(deviation: Deviation) -> FlankErrorFit:
    """Global errors of a deviation, by least squares on its nodes.

    Raises
    ------
    InputError
        If there are fewer than three rows or columns, which know no crowning.
    """
    if min(deviation.value.shape) < 3:
        columns, rows = deviation.value.shape
        raise InputError(f"{rows} rows x {columns} columns: global errors take at least 3 of each")
    fractions = deviation.section.fractions(deviation.axial, deviation.radial)
    terms = _terms(*fractions)
    value = 1e3 * deviation.value
    found, *_ = np.linalg.lstsq(terms.reshape(-1, terms.shape[-1]), value.ravel(), rcond=None)
    residual = value - terms @ found
    return FlankErrorFit(
        FlankErrors(*(float(v) for v in found)),
        residual,
        float(np.std(value)),
        float(np.sqrt(np.mean(residual**2))),
    )


def angle_errors(errors: FlankErrors, section: BlankSection, surface: GeneratingSurface) -> tuple[float, float]:
    """Changes of spiral angle and pressure angle in the middle of the flank [rad] that stand for these errors.

    More metal at the heel makes the spiral angle of a concave flank larger and that of a convex flank smaller; more
    metal at the tip makes the pressure angle smaller, on either.

    Parameters
    ----------
    errors
        The errors.
    section
        Blank of the member.
    surface
        The designed flank.
    """
    t = np.array([0.5, 0.5, 0.5, 0.0, 1.0])
    h = np.array([0.5, 0.0, 1.0, 0.5, 0.5])
    flank = solve_flank(surface.designed, section, *section.points(t, h))
    length = float(np.linalg.norm(flank.position[:, 4] - flank.position[:, 3]))
    height = float(np.linalg.norm(flank.position[:, 2] - flank.position[:, 1]))
    concave = 1.0 if surface.blade.side == "outside" else -1.0
    return concave * 2e-3 * errors.spiral_angle / length, -2e-3 * errors.pressure_angle / height
