"""A low-order surface added to the ease-off, and the names of its terms."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
import xarray as xr

from ...core.arrays import Array
from ...core.checks import instance, number, one_of, whole
from .gear_pair import first_contact

TERM_ORDERS = (2, 3, 4)
#: Powers of the terms up to second order by their names, which are those of ``EaseOffTarget``.
NAMED_TERM_POWERS = {
    "spiral_angle_error": (1, 0),
    "pressure_angle_error": (0, 1),
    "lengthwise_crowning": (2, 0),
    "bias": (1, 1),
    "profile_crowning": (0, 2),
}


def terms(order: int) -> tuple[str, ...]:
    """Names of the terms t^a h^b of the total order a + b = 1 ... ``order``."""
    whole("order", order, min(TERM_ORDERS), max(TERM_ORDERS))
    return tuple(name for name, powers in TERM_POWERS.items() if sum(powers) <= order)


def _name(a: int, b: int) -> str:
    return "_".join(f"{word}_{n}" for word, n in (("lengthwise", a), ("profile", b)) if n)


#: Powers (a, b) of every term by its name.
TERM_POWERS: Mapping[str, tuple[int, int]] = NAMED_TERM_POWERS | {
    _name(total - b, b): (total - b, b) for total in range(3, max(TERM_ORDERS) + 1) for b in range(total + 1)
}


def basis(names: tuple[str, ...], lengthwise: Array, profile: Array) -> Array:
    """Values (..., p) of terms with the coefficient one, at fractions (...) of the gear flank.

    With t and h from -1 to 1 lengthwise and up the profile a term is t^a h^b; the bias is -t h, so that it is positive
    where ``EaseOffTarget.bias`` is.
    """
    t, h = 2.0 * np.asarray(lengthwise) - 1.0, 2.0 * np.asarray(profile) - 1.0
    powers = [(-1.0 if name == "bias" else 1.0, *TERM_POWERS[name]) for name in names]
    return np.stack([sign * t**a * h**b for sign, a, b in powers], axis=-1)


@dataclass(frozen=True)
class Modification:
    """An addition to the ease-off along the normal: the sum of low-order terms.

    Parameters
    ----------
    coefficients
        Coefficient of each term [um] by its name, see ``terms``.

    Raises
    ------
    InputError
        If there is no such term, or a coefficient is not finite.

    Examples
    --------
    Ten micrometres more of lengthwise crowning open the gap at toe and heel, mid height, by as much:

    >>> import numpy as np
    >>> more = Modification({"lengthwise_crowning": 10.0})
    >>> [float(v) for v in more(np.array([0.0, 0.5, 1.0]), np.full(3, 0.5))]
    [10.0, 0.0, 10.0]
    """

    coefficients: Mapping[str, float]

    def __post_init__(self) -> None:
        instance("coefficients", self.coefficients, Mapping)
        for name, value in self.coefficients.items():
            one_of("modification term", name, TERM_POWERS)
            number(f"modification term {name}", value, "um")

    def __call__(self, lengthwise: Array, profile: Array) -> Array:
        """Addition to the ease-off [um] at fractions (...) on the gear flank."""
        values = np.array(list(self.coefficients.values()), dtype=float)
        return np.asarray(basis(tuple(self.coefficients), lengthwise, profile) @ values)


def modified_ease_off(ease_off: xr.Dataset, modification: Modification) -> xr.Dataset:
    """The ease-off with a modification along the normal added, zero again at first contact.

    Roll angle and contact lines stay: a few micrometres change them in the second order only.
    """
    added = 1e-3 * modification(*np.meshgrid(ease_off["lengthwise"], ease_off["profile"], indexing="ij"))
    grid = ("lengthwise", "profile")
    lever_arm = ease_off["lever_arm"].transpose(*grid).values
    angle = ease_off["ease_off_angle"].transpose(*grid).values + added / lever_arm
    zero = first_contact(angle, ease_off["inside"].transpose(*grid).values == 1)
    changed = ease_off.assign(
        ease_off_angle=(grid, angle - zero, ease_off["ease_off_angle"].attrs),
        ease_off=(grid, 1e3 * (angle - zero) * lever_arm, ease_off["ease_off"].attrs),
    )
    return changed.assign_attrs(first_contact_rad=ease_off.attrs["first_contact_rad"] + zero)
