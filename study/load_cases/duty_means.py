"""Means over the load cases of a duty cycle: power loss and efficiency by time, torques of equal damage."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Any

import numpy as np
import xarray as xr
from numpy.typing import NDArray

from ...core.checks import array, distinct, positive

Array = NDArray[Any]

#: Life factors of case-hardened steel, ISO 6336-2 and -3: at fewer cycles and at the knee. Pitting stress grows with
#: the root of the torque, root stress with the torque.
PITTING_LIFE, PITTING_CYCLES = (1.6, 1.0), (1e5, 5e7)
BENDING_LIFE, BENDING_CYCLES = (2.5, 1.0), (1e3, 3e6)


def _slope(life: tuple[float, float], cycles: tuple[float, float]) -> float:
    return math.log(cycles[1] / cycles[0]) / math.log(life[0] / life[1])


#: Exponents of the torque in the number of cycles to failure: pitting 6.61, bending of the root 8.74.
DAMAGE_EXPONENTS = (0.5 * _slope(PITTING_LIFE, PITTING_CYCLES), _slope(BENDING_LIFE, BENDING_CYCLES))
EXPONENT_LIMIT = 100.0


def equivalent_torque(torques: Array, cycles: Array, exponent: float) -> float:
    """Torque that does the same damage in the same number of cycles.

    By Palmgren and Miner's rule with a life of T^-p: (sum n T^p / sum n)^(1/p), ISO 6336-6.

    Parameters
    ----------
    torques
        Torques (n) [N m].
    cycles
        Numbers of cycles (n), or what is in proportion to them.
    exponent
        p.

    Raises
    ------
    InputError
        If a number is negative, or there is no torque above 0 or no cycle.

    Examples
    --------
    >>> round(equivalent_torque(np.array([100.0, 200.0]), np.array([3.0, 1.0]), 1.0), 9)
    125.0
    >>> round(equivalent_torque(np.array([100.0, 200.0]), np.array([1.0, 1.0]), 1000.0), 1)
    199.9
    """
    torques = array("torques", torques, "N m", ndim=1, fewest=1, least=0.0)
    cycles = array("cycles", cycles, ndim=1, size=torques.size, least=0.0)
    positive("sum of the cycles", cycles.sum())
    greatest = positive("greatest of the torques", torques.max(), "N m")
    mean = float(np.average((torques / greatest) ** positive("exponent", exponent), weights=cycles))
    return greatest * math.pow(mean, 1.0 / exponent)


def checked_exponents(exponents: Sequence[float]) -> tuple[float, ...]:
    """Damage exponents, refused if they are none.

    Raises
    ------
    InputError
        If there is none, one comes twice, or one is not from 1 to ``EXPONENT_LIMIT``.

    Examples
    --------
    >>> checked_exponents([6.61])
    (6.61,)
    """
    return tuple(distinct("damage_exponents", exponents, least=1.0, most=EXPONENT_LIMIT).tolist())


def duty_means(numbers: xr.Dataset, exponents: Sequence[float] = DAMAGE_EXPONENTS) -> xr.Dataset:
    """Means over load cases with shares of time.

    Power loss is additive in time: the mean loss is that of the shares, and the mean efficiency one less mean loss over
    mean power in. Of other numbers, such as transmission errors or pressures, a mean says nothing, and there is none.
    Damage is additive in cycles: each flank has a torque that does the same damage in as many cycles, one for each
    exponent. Cycles are in proportion to share times speed, or to the share where no load case has a speed.

    Parameters
    ----------
    numbers
        Numbers over ``load_case`` with torque, share, flank and, if there is friction, speed, mean power loss and input
        power.
    exponents
        Exponents p of a life of T^-p.

    Returns
    -------
    xr.Dataset
        Over ``flank`` and ``damage_exponent`` the equivalent torque; over ``load_case`` and ``damage_exponent`` its
        share of the damage of its flank; means of power loss and efficiency. NaN if a load case has no value.

    Examples
    --------
    >>> rows = {"torque": [100.0, 300.0], "share": [0.9, 0.1], "mean_power_loss": [40.0, 160.0]}
    >>> rows |= {"input_power": [1000.0, 3000.0], "speed": [95.5, 95.5], "flank": ["drive", "drive"]}
    >>> means = duty_means(xr.Dataset({name: ("load_case", values) for name, values in rows.items()}), [6.61])
    >>> round(float(means["duty_power_loss"]), 6), round(float(means["duty_efficiency"]), 6)
    (52.0, 0.956667)
    >>> means["equivalent_torque"].values.round(1).tolist()
    [[212.0]]
    """
    share, torque = numbers["share"].values / np.sum(numbers["share"].values), numbers["torque"].values
    sides = numbers["flank"].values.astype(str)
    known = [str(side) for side in ("drive", "coast") if side in sides]
    cycles = share * numbers["speed"].values if "speed" in numbers else share
    equivalent = np.empty((len(known), len(exponents)))
    damage = np.zeros((torque.size, len(exponents)))
    for row, side in enumerate(known):
        own = sides == side
        for column, exponent in enumerate(exponents):
            equivalent[row, column] = equivalent_torque(torque[own], cycles[own], exponent)
            part = cycles[own] * (torque[own] / np.max(torque[own])) ** exponent
            damage[own, column] = part / np.sum(part)
    data: dict[str, Any] = {
        "equivalent_torque": (("flank", "damage_exponent"), equivalent),
        "damage_share": (("load_case", "damage_exponent"), damage),
    }
    if "mean_power_loss" in numbers:
        loss, power = (float(share @ numbers[name].values) for name in ("mean_power_loss", "input_power"))
        data |= {"duty_power_loss": loss, "duty_input_power": power, "duty_efficiency": 1.0 - loss / power}
    names = {str(name): numbers[name] for name in numbers.coords}
    return xr.Dataset(data, coords={"flank": known, "damage_exponent": list(exponents), **names})
