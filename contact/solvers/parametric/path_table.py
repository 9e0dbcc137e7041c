"""Table of a path over the torque: its events, and the solutions between which it runs."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any, Protocol

import numpy as np
import xarray as xr
from numpy.typing import NDArray

from ....core.attributes import labelled
from ....core.checks import array
from ....core.errors import InputError
from ..solution import ContactSolution, Status

Array = NDArray[np.float64]


class PathOverTorque(Protocol):
    """What paths of linear and of load-dependent contact have in common."""

    @property
    def torque(self) -> Array:
        """Torque of every event (e) [N mm]."""

    @property
    def segment(self) -> NDArray[np.int64]:
        """Segment that enters or leaves there (e)."""

    @property
    def enters(self) -> NDArray[np.bool_]:
        """Whether it enters (e)."""

    @property
    def status(self) -> Status:
        """Whether the path was followed to its end."""

    @property
    def message(self) -> str:
        """Why it was not."""

    @property
    def covered(self) -> tuple[float, float]:
        """Least and greatest torque at which it is known [N mm]."""


def torque_on(path: PathOverTorque, torque: float) -> float:
    """Check that a path is known at a torque [N mm].

    Raises
    ------
    InputError
        It is not.
    """
    given = float(array("torque", torque, "N mm", ndim=0))
    low, high = path.covered
    if not low <= given <= high:
        reason = f"; {path.message}" if path.message else ""
        raise InputError(f"torque = {given:g}: must be from {low:g} to {high:g} N mm, the known path{reason}")
    return given


def path_table(
    path: PathOverTorque, size: int, torque: Array, solutions: Sequence[ContactSolution], **attributes: Any
) -> xr.Dataset:
    """Return the events of a path, and its solutions at torques (b) [N mm], with units.

    Parameters
    ----------
    path
        The path.
    size
        Number of segments.
    torque, solutions
        Breakpoints and the solutions there (b).
    **attributes
        Of the dataset, beside status and message.
    """
    per_segment = ("breakpoint", "segment")
    data: Mapping[str, Any] = {
        "event_torque": ("event", path.torque),
        "event_segment": ("event", path.segment),
        "event_enters": ("event", path.enters.astype(np.int8)),
        "path_torque": ("breakpoint", torque),
        "path_rotation": ("breakpoint", np.array([one.rotation for one in solutions])),
        "path_force": (per_segment, np.array([one.force for one in solutions]).reshape(-1, size)),
        "path_gap": (per_segment, np.array([one.gap for one in solutions]).reshape(-1, size)),
        "worst_residual": ("breakpoint", np.array([one.certificate.worst for one in solutions])),
    }
    status = {"status": path.status.name.lower(), "message": path.message}
    return labelled(xr.Dataset(data, attrs=status | attributes))
