"""Rounds in which the assembly found under load becomes that of the geometry, until it changes no more."""

from __future__ import annotations

from dataclasses import dataclass, field, replace
from typing import TYPE_CHECKING, Literal, Protocol

from ...core.arrays import RealArray as Array, record
from ...core.attributes import StoredStatus
from ...core.checks import bounded, check_fields

if TYPE_CHECKING:
    from ...geometry.pair.gear_pair import PairGeometry
    from ..lines.mesh_lines import MeshLines
    from ..loaded import LoadedCase
    from ..mesh_wrench import MeshWrenches
    from ..segments import CycleSegments, Segments
    from .support import Supports

Update = Literal["none", "mean", "position"]


class RoundsStatus(StoredStatus):
    """Reason why the rounds ended."""

    ENDED = 0
    ROUND_LIMIT = 1
    NO_GEOMETRY = 2
    NOT_CERTIFIED = 3


@dataclass(frozen=True)
class AssemblyRounds:
    """Extent to which the assembly found under load is followed.

    Parameters
    ----------
    update
        ``mean``: at every torque the ease-off is that of the mean assembly over the mesh cycle, and what the assembly
        varies about it counts to first order. ``position``: it is that of the assembly at every mesh position, the
        pinion turned as its support turns it. ``none``: all counts to first order.
    limit
        Change of the gap, anywhere on the flank, by what the assembly or the supports still change between two rounds,
        below which the rounds end [um].
    most
        Greatest number of rounds.

    Raises
    ------
    InputError
        If an argument is out of range.

    Examples
    --------
    >>> AssemblyRounds(update="position").most
    10
    """

    update: Update = "mean"
    limit: float = field(default=1e-2, metadata=bounded("um", above=0.0))
    most: int = field(default=10, metadata=bounded(least=1))

    def __post_init__(self) -> None:
        check_fields(self)


class CycleInAssembly(Protocol):
    """A mesh cycle in some assembly, see ``MeshCycle``."""

    @property
    def geometry(self) -> PairGeometry:
        """Flanks, ease-off and teeth."""

    @property
    def segments(self) -> CycleSegments:
        """Potential contact segments."""

    @property
    def lines(self) -> MeshLines:
        """Contact lines."""

    def at_rotations(self, rotations: Array) -> CycleInAssembly:
        """The same pair at other pinion rotations [rad]."""


@record(frozen=True, eq=False)
class Round:
    """Contact on supports at torques (t) and mesh positions (k), as one round solved it."""

    cycle: CycleInAssembly
    wrenches: MeshWrenches
    segments: list[Segments | None]
    cases: list[LoadedCase]
    wrench: Array  # gear on pinion about the origin (t, k, 6); NaN if not certified
    parts: Array  # motion under load, see ``PARTS`` (t, k, 6)
    rotation: Array  # of the gear against the drive sense (t, k) [rad], from first contact
    first_contact: Array  # its part by first contact in the mean assembly (t) [rad]
    supports: tuple[Supports, ...]

    def at(self, torque: int) -> Round:
        """The round at one of its torques alone, by its number."""
        one = slice(torque, torque + 1)
        arrays = {name: getattr(self, name)[one] for name in ("wrench", "parts", "rotation", "first_contact")}
        cases = [replace(case, torque=0) for case in self.cases if case.torque == torque]
        return replace(self, cases=cases, **arrays)


@dataclass(frozen=True, eq=False)
class LastRound:
    """The last round at torques (t), by their numbers, and the reason why the rounds ended."""

    torques: tuple[int, ...]
    round: Round
    count: int
    change: float
    status: RoundsStatus
    reason: str
