"""The solution with load-dependent line contact as a function of the torque, with every change of contact."""

from __future__ import annotations

from bisect import bisect_right
from collections.abc import Sequence
from dataclasses import dataclass, field

import numpy as np
import xarray as xr
from numpy.typing import NDArray

from ...core.checks import array, frozen_arrays, instance, number
from ..problem.contact_problem import ContactProblem
from ..solvers import ContactSolution, Status
from ..solvers.parametric.path_table import path_table, torque_on
from .line_contact_continuation import PathNode, continue_path, solved_at
from .line_contact_newton import LineContact

Array = NDArray[np.float64]

#: Part of its torque within which a change of contact is located.
TORQUE_TOLERANCE = 1e-9


@frozen_arrays
@dataclass(frozen=True, eq=False)
class LineContactPath:
    """Solutions of a contact problem with load-dependent line contact between two torques.

    Attributes
    ----------
    bending
        The contact problem with the compliance of bending alone; its own torque plays no part.
    line_contact
        The local part.
    start, end
        Torques between which the path was asked for [N mm], in the direction of travel.
    tolerance
        Part of its torque within which each event is located.
    torque
        Torque of every event (e) [N mm], in the direction of travel.
    segment
        Segment that enters or leaves the contact there (e).
    enters
        Whether it enters (e).
    status
        `Status.CERTIFIED` if the path was followed from start to end; every point of it is then certified.
    message
        Why it was not followed to the end; empty if it was.

    Examples
    --------
    >>> import numpy as np
    >>> from easeoff.contact import ContactProblem, Material, line_contact_path
    >>> from easeoff.contact.compliance.weber_line_contact import WeberLineContact
    >>> steel = Material(206000.0, 0.3)
    >>> line_contact = WeberLineContact(*(np.full(2, value) for value in (1.5, 30.0, 3.0, 3.0)), steel, steel)
    >>> bending = ContactProblem([0.0, 1e-3], [40.0, 40.0], 0.0, (np.zeros(2), np.full((2, 1), 1e-3)))
    >>> path = line_contact_path(bending, line_contact, 0.0, 1e5)
    >>> path.segment.tolist(), path.at(5e4).certified
    ([0, 1], True)

    The first segment has the indentation 1 um when the second touches:

    >>> round(float(line_contact.deflection(np.array([path.torque[1] / 40.0, 0.0]))[0]), 9)
    0.001
    """

    bending: ContactProblem
    line_contact: LineContact
    start: float
    end: float
    tolerance: float
    torque: Array
    segment: NDArray[np.int64]
    enters: NDArray[np.bool_]
    status: Status
    message: str
    _nodes: Sequence[PathNode] = field(repr=False)

    @property
    def certified(self) -> bool:
        """Whether the path was followed from start to end."""
        return self.status is Status.CERTIFIED

    @property
    def covered(self) -> tuple[float, float]:
        """Least and greatest torque between which the path was followed [N mm]; NaN if it was nowhere."""
        return (self._nodes[0].torque, self._nodes[-1].torque) if self._nodes else (np.nan, np.nan)

    def at(self, torque: float) -> ContactSolution:
        """Return the certified solution at a torque, found from the one below it on the path.

        Parameters
        ----------
        torque
            Torque about the gear axis [N mm], in `covered`.

        Raises
        ------
        InputError
            The path was not followed to that torque.
        """
        given = torque_on(self, torque)
        below = self._nodes[bisect_right([node.torque for node in self._nodes], given) - 1]
        if below.torque == given:
            return below.solution
        foretold = np.maximum(below.solution.force + (given - below.torque) * below.force_rate, 0.0)
        return solved_at(self.bending, self.line_contact, given, foretold)

    def to_dataset(self) -> xr.Dataset:
        """Return events and certified points with units.

        Returns
        -------
        xarray.Dataset
            ``event_torque``, ``event_segment``, ``event_enters`` (event); ``path_force``, ``path_gap`` (breakpoint,
            segment), ``path_rotation``, ``worst_residual`` (breakpoint) at the torques ``path_torque`` (breakpoint).
            Between these nothing is linear: `at` solves there.
        """
        nodes = self._nodes if self.start <= self.end else self._nodes[::-1]
        torque = np.array([node.torque for node in nodes])
        solutions = [node.solution for node in nodes]
        return path_table(self, self.bending.size, torque, solutions, event_tolerance=self.tolerance)


def line_contact_path(
    bending: ContactProblem,
    line_contact: LineContact,
    start: float,
    end: float,
    *,
    tolerance: float = TORQUE_TOLERANCE,
) -> LineContactPath:
    """Follow the solution of a contact problem with load-dependent line contact over the torque.

    Parameters
    ----------
    bending
        The contact problem with the compliance of bending alone, as `solve_line_contact` takes it.
    line_contact
        The local part.
    start, end
        Torques between which it is followed [N mm], not negative, either of them the greater.
    tolerance
        Part of its torque within which each event is located.

    Returns
    -------
    LineContactPath
        With a status and a message where the path could not be followed to the end.

    Raises
    ------
    InputError
        A torque is negative or not finite, or the tolerance is not between 1e-12 and 0.1.

    Notes
    -----
    A segment that enters and leaves again (or leaves and enters) between two neighbouring points is noticed if a cubic
    through their values and derivatives shows it. Steps grow the torque by half at the most.

    Examples
    --------
    One mesh position of a pair, from no load to 300 N m at the pinion:

    >>> from easeoff.cases import gear_pair, read_case
    >>> from easeoff.contact import MeshCycle
    >>> from easeoff.geometry import pair_geometry
    >>> geometry = pair_geometry(gear_pair(read_case("nasa-12x36")), (9, 7))
    >>> cycle = MeshCycle.of(geometry, mesh_positions=2, segments_per_line=7)
    >>> here = cycle.segments.by_position[0]
    >>> path = line_contact_path(here.bending_problem, here.line_contact, 0.0, 3e5 * cycle.ratio)
    >>> path.certified, bool(path.enters[0]), path.torque[0].item()
    (True, True, 0.0)
    """
    instance("bending", bending, ContactProblem)
    instance("line_contact", line_contact, LineContact)
    first, last = (
        float(array(name, value, "N mm", ndim=0, least=0.0)) for name, value in (("start", start), ("end", end))
    )
    number("tolerance", tolerance, least=1e-12, most=0.1)
    found = continue_path(bending, line_contact, min(first, last), max(first, last), tolerance)
    changes = found.changes if first <= last else [(t, i, not enters) for t, i, enters in reversed(found.changes)]
    torque, segment, enters = (np.array(column) for column in zip(*changes, strict=True)) if changes else ([], [], [])
    return LineContactPath(
        bending,
        line_contact,
        first,
        last,
        tolerance,
        np.asarray(torque, dtype=np.float64),
        np.asarray(segment, dtype=np.int64),
        np.asarray(enters, dtype=np.bool_),
        Status.NOT_CONVERGED if found.failure else Status.CERTIFIED,
        found.failure,
        tuple(found.nodes),
    )
