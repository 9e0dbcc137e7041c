"""Greatest flash temperature and pressure times velocity of a mesh cycle, at every operating condition."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any, Protocol

import numpy as np
import xarray as xr
from numpy.typing import NDArray

Array = NDArray[Any]
OVER = ("torque", "speed", "temperature", "roughness")


class HeatedBlock(Protocol):
    """Flash temperatures of a block of contacts, as ``Losses`` has them."""

    @property
    def contacts(self) -> slice:
        """Which contacts."""

    @property
    def flash_temperature(self) -> Array:
        """[K] (speed, temperature, roughness, c)."""

    @property
    def pressure_velocity(self) -> Array:
        """[W/m^2] (speed, 1, 1, c)."""


@dataclass
class HottestContacts:
    """The hottest contact of each torque and condition, found a block of contacts at a time.

    Arrays over (torque, speed, temperature, roughness).

    Parameters
    ----------
    shape
        Numbers of torques, speeds, temperatures and roughnesses.
    """

    shape: tuple[int, int, int, int]
    flash: Array = field(init=False)
    contact: NDArray[np.int64] = field(init=False)
    pressure_velocity: Array = field(init=False)

    def __post_init__(self) -> None:
        self.flash, self.pressure_velocity = np.full(self.shape, -np.inf), np.full(self.shape, -np.inf)
        self.contact = np.zeros(self.shape, dtype=np.int64)

    def add(self, torque: NDArray[np.int64], block: HeatedBlock) -> None:
        """Add a block of contacts.

        Parameters
        ----------
        torque
            Number of the torque of each (c), sorted.
        block
            Their flash temperatures; NaN does not count.
        """
        starts = np.flatnonzero(np.diff(torque, prepend=-1))
        flash, product = (
            np.where(np.isnan(values), -np.inf, values) for values in (block.flash_temperature, block.pressure_velocity)
        )
        for start, end in zip(starts, [*starts[1:], torque.size], strict=True):
            at = torque[start]
            hottest = np.argmax(flash[..., start:end], axis=-1)
            greatest = np.take_along_axis(flash[..., start:end], hottest[..., None], axis=-1)[..., 0]
            hotter = greatest > self.flash[at]
            self.flash[at] = np.where(hotter, greatest, self.flash[at])
            self.contact[at] = np.where(hotter, block.contacts.start + start + hottest, self.contact[at])
            self.pressure_velocity[at] = np.maximum(self.pressure_velocity[at], product[..., start:end].max(axis=-1))

    def variables(self, loaded: xr.Dataset, index: NDArray[np.int64], bulk_temperature: Array) -> dict[str, Any]:
        """Variables of the group ``/friction``, NaN where no contact line carries.

        Parameters
        ----------
        loaded
            The group ``/loaded``, with torque, mesh position and segment first.
        index
            Torque, mesh position and segment of the contacts (3, n).
        bulk_temperature
            Of the teeth [degC] (temperature).
        """
        known = np.isfinite(self.flash)
        values: dict[str, Array] = {
            "max_flash_temperature": self.flash,
            "max_contact_temperature": self.flash + bulk_temperature[:, None],
            "max_pressure_velocity": 1e-6 * self.pressure_velocity,
        }
        if index.size:
            at = tuple(index[:, self.contact])
            values["max_flash_position"] = loaded["mesh_position"].values[at[1]]
            for name in ("lengthwise", "profile"):
                values[f"max_flash_{name}"] = loaded[name].values[at]
        else:
            nowhere = ("position", "lengthwise", "profile")
            values |= {f"max_flash_{name}": np.full(self.shape, np.nan) for name in nowhere}
        return {name: (OVER, np.where(known, value, np.nan)) for name, value in values.items()}
