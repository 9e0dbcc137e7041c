"""The solution of a contact problem as a function of the torque: exact, piecewise affine, with every change of contact.

For given separations the segments that touch change at certain torques only; between two of these forces, gaps and
rotation are affine in the torque. The path is the list of these torques and pieces.

Table of a path over the torque: its events, and the solutions between which it runs.
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from bisect import bisect_right
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from functools import cached_property
from typing import Any

import numpy as np
import xarray as xr
from numpy.typing import NDArray

from ....core.attributes import labelled
from ....core.checks import array, frozen_arrays, instance
from ....core.errors import InputError
from ...problem.certificate import EXACT_TOLERANCE
from ...problem.contact_problem import ContactProblem
from ..registry import solve
from ..solution import ContactSolution, Status, judged
from .path_following import PathPiece, follow

Array = NDArray[np.float64]


@frozen_arrays
@dataclass(frozen=True, eq=False)
class PathOverTorque(ABC):
    """Ends, events and status of a path, in the direction of travel; of linear or of load-dependent contact."""

    start: float
    end: float
    torque: Array
    segment: NDArray[np.int64]
    enters: NDArray[np.bool_]
    status: Status
    message: str

    @property
    def certified(self) -> bool:
        """True if the path was followed from start to end, and all of it is proved."""
        return self.status is Status.CERTIFIED

    @property
    @abstractmethod
    def covered(self) -> tuple[float, float]:
        """Least and greatest torque at which the path is known [N mm]; NaN if it is at none."""

    def _torque_on(self, torque: float) -> float:
        """Check that the path is known at a torque [N mm]."""
        given = float(array("torque", torque, "N mm", ndim=0))
        low, high = self.covered
        if not low <= given <= high:
            reason = f"; {self.message}" if self.message else ""
            raise InputError(f"torque = {given:g}: must be from {low:g} to {high:g} N mm, the known path{reason}")
        return given

    def _table(self, size: int, torque: Array, solutions: Sequence[ContactSolution], **attributes: Any) -> xr.Dataset:
        """Events, and solutions at the breakpoints (b) [N mm], as a Dataset with units."""
        per_segment = ("breakpoint", "segment")
        data: Mapping[str, Any] = {
            "event_torque": ("event", self.torque),
            "event_segment": ("event", self.segment),
            "event_enters": ("event", self.enters.astype(np.int8)),
            "path_torque": ("breakpoint", torque),
            "path_rotation": ("breakpoint", np.array([one.rotation for one in solutions])),
            "path_force": (per_segment, np.array([one.force for one in solutions]).reshape(-1, size)),
            "path_gap": (per_segment, np.array([one.gap for one in solutions]).reshape(-1, size)),
            "worst_residual": ("breakpoint", np.array([one.certificate.worst for one in solutions])),
        }
        status = {"status": self.status.name.lower(), "message": self.message}
        return labelled(xr.Dataset(data, attrs=status | attributes))


def path_ends(start: float, end: float) -> tuple[float, float]:
    """Check the torques between which a path is asked for [N mm]."""
    first, last = (array(name, value, "N mm", ndim=0, least=0.0) for name, value in (("start", start), ("end", end)))
    return float(first), float(last)


def path_fields(start: float, end: float, changes: Sequence[tuple[float, int, bool]], failure: str) -> dict[str, Any]:
    """Fields of a `PathOverTorque` of changes (torque, segment, enters) in the order of a rising torque."""
    if start > end:
        changes = [(torque, segment, not enters) for torque, segment, enters in reversed(changes)]
    torque, segment, enters = zip(*changes, strict=True) if changes else ((), (), ())
    return {
        "start": start,
        "end": end,
        "torque": np.array(torque, dtype=np.float64),
        "segment": np.array(segment, dtype=np.int64),
        "enters": np.array(enters, dtype=np.bool_),
        "status": Status.NOT_CONVERGED if failure else Status.CERTIFIED,
        "message": failure,
    }


METHOD = "torque_path"


@frozen_arrays
@dataclass(frozen=True, eq=False)
class TorquePath(PathOverTorque):
    """Solutions of a contact problem between two torques.

    Attributes
    ----------
    problem
        The contact problem; its own torque plays no part.
    start, end
        Torques between which the path was asked for [N mm], in the direction of travel.
    torque
        Torque of every event (e) [N mm], in the direction of travel.
    segment
        Segment that enters or leaves the contact there (e).
    enters
        Whether it enters (e).
    status
        `Status.CERTIFIED` if the path was followed from start to end and the answer at every event is proved.
    message
        Why it was not followed to the end; empty if it was.

    Notes
    -----
    All conditions are convex, or equations, in forces and gaps: where both ends of a piece are certified, so is all
    between them.

    Examples
    --------
    Two springs, the second with a gap of 1 um:

    >>> import numpy as np
    >>> from easeoff.contact import ContactProblem, torque_path
    >>> springs = ContactProblem([0.0, 1e-3], [40.0, 40.0], 0.0, np.diag([1e-6, 1e-6]))
    >>> path = torque_path(springs, 0.0, 1e5)
    >>> path.torque.round(6).tolist(), path.segment.tolist(), path.at(8e4).force.round(6).tolist()
    ([0.0, 40000.0], [0, 1], [1500.0, 500.0])
    """

    problem: ContactProblem
    _pieces: Sequence[PathPiece] = field(repr=False)
    _reached: float = field(repr=False)

    @property
    def covered(self) -> tuple[float, float]:
        """Least and greatest torque at which the path is known [N mm]; NaN if it is at none."""
        if not self._pieces:
            return np.nan, np.nan
        return self._pieces[0].torque, self._reached

    def at(self, torque: float) -> ContactSolution:
        """Return the certified solution at a torque.

        Parameters
        ----------
        torque
            Torque about the gear axis [N mm], in `covered`.

        Raises
        ------
        InputError
            The path is not known at that torque.
        """
        given = self._torque_on(torque)
        piece = self._pieces[max(bisect_right(self._torques, given) - 1, 0)]
        answer = piece.answer(self.problem, given)
        solution = judged("native", answer, tolerance=EXACT_TOLERANCE, iterations=0, method=METHOD, message=METHOD)
        if solution.certified:
            return solution
        return solve(self.problem.with_torque(given), initial_active=piece.index)

    @property
    def breakpoints(self) -> Array:
        """Torques at which pieces meet, and both ends (b) [N mm], in the direction of travel."""
        if not self._pieces:
            return np.empty(0)
        torques = np.array([*self._torques, self._reached][: len(self._pieces) + (self._reached > self._torques[-1])])
        return torques if self.start <= self.end else torques[::-1]

    def to_dataset(self) -> xr.Dataset:
        """Return the whole path with units.

        Returns
        -------
        xarray.Dataset
            ``event_torque``, ``event_segment``, ``event_enters`` (event); ``path_force``, ``path_gap`` (breakpoint,
            segment), ``path_rotation`` and ``worst_residual`` (breakpoint) at the torques ``path_torque``
            (breakpoint): between these everything is linear.
        """
        solutions = [self.at(torque) for torque in self.breakpoints]
        return self._table(self.problem.size, self.breakpoints, solutions)

    @cached_property
    def _torques(self) -> list[float]:
        return [piece.torque for piece in self._pieces]


def torque_path(problem: ContactProblem, start: float, end: float) -> TorquePath:
    """Follow the solution of a contact problem over the torque.

    Parameters
    ----------
    problem
        The contact problem; its own torque plays no part.
    start, end
        Torques between which it is followed [N mm], not negative, either of them the greater.

    Returns
    -------
    TorquePath
        With all events; with a status and a message where the path could not be followed to the end.

    Raises
    ------
    InputError
        A torque is negative or not finite, or the compliance is not positive semidefinite.

    Examples
    --------
    A Winkler bed: each spring takes part from the torque on at which the rotation has closed its gap.

    >>> import numpy as np
    >>> from easeoff.contact import ContactProblem
    >>> bed = ContactProblem([0.0, 1e-3, 3e-3], [50.0] * 3, 0.0, np.diag([1e-6] * 3))
    >>> torque_path(bed, 0.0, 4e5).torque.round(6).tolist()
    [0.0, 50000.0, 250000.0]
    >>> torque_path(bed, 4e5, 2e5).enters.tolist()
    [False]
    """
    instance("problem", problem, ContactProblem)
    first, last = path_ends(start, end)
    if not problem.is_positive_semidefinite:
        raise InputError("compliance: must be positive semidefinite")
    path = follow(problem, min(first, last), max(first, last))
    fields = path_fields(first, last, path.changes, path.failure)
    return TorquePath(**fields, problem=problem, _pieces=tuple(path.pieces), _reached=path.reached)
