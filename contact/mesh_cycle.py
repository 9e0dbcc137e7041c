"""A pair in mesh over one pitch of the pinion: geometry, contact lines and elastic teeth, for any load and state."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from typing import TYPE_CHECKING, Any

import numpy as np
import xarray as xr

from ..core.arrays import Array
from ..core.checks import array, check_fields, instance, instances, truth, whole
from ..core.errors import InputError
from ..geometry.pair.assembly import Misalignment
from ..geometry.pair.gear_pair import PairGeometry
from .compliance.elastic_model import ElasticModel, ElasticTeeth, ElasticTooth
from .lines.closest_approach import PASSING_FIELDS, SEPARATION_FIELDS
from .lines.flank_splines import FlankSplines
from .lines.mesh_lines import MeshLines, lines_at, lost_contact, mesh_rotations, roll_limits
from .loaded import CycleSolver, LoadedCase, loaded_splines
from .segments import CycleSegments, LineSegments
from .solvers import SolverChoice
from .unloaded import unloaded_contact

if TYPE_CHECKING:
    from .supports.assembly_rounds import AssemblyRounds
    from .supports.support import LoadedSupports
    from .supports.supported_contact import SupportedContact

#: Splines on which neither contact lines nor compliance depend.
GAP_FIELDS = {"ease_off_angle", "lever_arm", *SEPARATION_FIELDS, *PASSING_FIELDS}


@dataclass(frozen=True)
class MeshCycle:
    """A pair in mesh over one pitch of the pinion.

    ``of`` makes one. What is computed of it is kept, and passed on to the cycles that are made from it as far as it is
    the same there.

    Parameters
    ----------
    geometry
        Flanks, ease-off and teeth.
    segments
        Potential contact segments at every mesh position, with the flank splines, contact lines and elastic teeth that
        they are made from.

    Examples
    --------
    >>> from easeoff.cases import gear_pair, read_case
    >>> from easeoff.geometry import Misalignment, pair_geometry
    >>> geometry = pair_geometry(gear_pair(read_case("nasa-12x36")), (9, 7))
    >>> cycle = MeshCycle.of(geometry, mesh_positions=2, segments_per_line=9)
    >>> loaded, cases = cycle.loaded([100.0, 200.0])
    >>> loaded["transmission_error"].shape
    (2, 2)
    >>> away = cycle.misaligned(Misalignment(offset=0.05))
    >>> away.elastic is cycle.elastic
    True
    """

    geometry: PairGeometry
    segments: CycleSegments

    def __post_init__(self) -> None:
        check_fields(self)

    @classmethod
    def of(
        cls,
        geometry: PairGeometry,
        model: ElasticModel | None = None,
        *,
        mesh_positions: int = 32,
        segments_per_line: int = 31,
    ) -> MeshCycle:
        """Trace the contact lines of a pair.

        Parameters
        ----------
        geometry
            From ``geometry.pair_geometry``.
        model
            Elastic model of the teeth; solid shells of steel if left out.
        mesh_positions
            Pinion rotations in one pitch.
        segments_per_line
            Segments of a contact line.

        Raises
        ------
        GeometryError
            If no tooth pair can touch at any rotation.
        """
        instance("geometry", geometry, PairGeometry)
        instance("model", model, ElasticModel | None)
        whole("segments_per_line", segments_per_line, 1)
        pitch = geometry.pair.assembly.pinion_pitch
        fields = _fields(geometry)
        lines = lines_at(fields, pitch, mesh_rotations(pitch, mesh_positions))
        teeth = ElasticTeeth(geometry.teeth, model, geometry.pair)
        return cls(geometry, CycleSegments(fields, LineSegments(fields, lines, teeth, segments_per_line)))

    @property
    def fields(self) -> FlankSplines:
        """Splines of everything the contact needs on the gear flank."""
        return self.segments.fields

    @property
    def lines(self) -> MeshLines:
        """Contact lines of every tooth pair."""
        return self.segments.on_lines.lines

    @property
    def elastic(self) -> tuple[ElasticTooth, ElasticTooth]:
        """Elastic teeth of pinion and gear, built when they are first asked for.

        Raises
        ------
        GeometryError
            If a tooth cannot be made a solid shell.
        """
        return self.segments.on_lines.teeth.both

    @property
    def ratio(self) -> float:
        """Gear teeth over pinion teeth."""
        return self.geometry.pair.assembly.ratio

    @property
    def pinion_pitch(self) -> float:
        """Angular pitch of the pinion [rad]."""
        return self.geometry.pair.assembly.pinion_pitch

    @property
    def segments_per_line(self) -> int:
        """Segments of a contact line."""
        return self.segments.on_lines.count

    @property
    def lost_contact(self) -> float:
        """Share of the points of the contact lines without line contact, see ``mesh_lines.lost_contact``."""
        return lost_contact(self.fields, self.lines)

    @cached_property
    def roll_limits(self) -> tuple[float, float]:
        """Least and greatest roll angle on the common flank [rad], see ``mesh_lines.roll_limits``."""
        return roll_limits(self.fields)

    def unloaded(self, *, separation: float = 6.0) -> xr.Dataset:
        """Unloaded contact: transmission error, path of contact, contact lines that end at a separation [um]."""
        return unloaded_contact(self.geometry, self.fields, self.lines, separation=separation)

    def loaded(
        self,
        torques: Sequence[float] | Array,
        *,
        edge_contact: bool = True,
        solver: SolverChoice = "auto",
        progress: Callable[[], None] | None = None,
        greater: Sequence[LoadedCase] = (),
        supports: LoadedSupports | None = None,
        **options: Any,
    ) -> tuple[xr.Dataset, list[LoadedCase]]:
        """Loaded contact.

        Parameters
        ----------
        torques
            Torques at the pinion (t) [N m].
        edge_contact
            Whether edges of the teeth may touch beside the contact lines, or these alone.
        solver
            Name of the solver, see ``contact.available_solvers``, or one of your own, see ``contact.solve``.
        progress
            Called for every torque and mesh position where a tooth pair can touch.
        greater
            Cases of this cycle at greater torques. Their segments are taken: under less no further edge touches.
        supports
            Shafts, bearings and housing; rigid if left out. ``supported`` gives what they do, too.
        **options
            Passed to the solver.

        Returns
        -------
        tuple
            The dataset over (torque, mesh_position, segment), and every case with its contact problem.

        Raises
        ------
        InputError
            If a torque is not positive.
        GeometryError
            If a tooth cannot be made a solid shell.
        """
        _check_options(edge_contact, progress, greater)
        load = np.asarray(torques)
        if supports is not None:
            options |= {"edge_contact": edge_contact, "solver": solver, "progress": progress}
            contact = self.supported(load, supports, **options)
            return contact.loaded, contact.cases
        return CycleSolver(self.ratio, edge_contact, solver, options, progress, greater).loaded(self.segments, load)

    def supported(
        self,
        torques: Sequence[float] | Array,
        supports: LoadedSupports,
        *,
        rounds: AssemblyRounds | None = None,
        assembled: Callable[[Misalignment], MeshCycle] | None = None,
        edge_contact: bool = True,
        solver: SolverChoice = "auto",
        progress: Callable[[], None] | None = None,
        greater: Sequence[LoadedCase] = (),
        **options: Any,
    ) -> SupportedContact:
        """Loaded contact on shafts, bearings and housing, with the motion of the members under load.

        Parameters
        ----------
        torques, edge_contact, solver, progress, **options
            As of ``loaded``.
        supports
            The supports, about whose motion the assembly of this cycle is that without load.
        rounds
            How far the ease-off follows the assembly found under load; by default at every torque with the mean over
            the mesh cycle, until it changes gaps by less than 10 nm.
        assembled
            The pair in another assembly, with its deviations and modification; ``misaligned`` if left out.
        greater
            As of ``loaded``; cases on these supports, for constant ones and contact to first order.

        Returns
        -------
        SupportedContact
            Its ``loaded`` and ``cases`` are as of ``loaded``.

        Raises
        ------
        InputError, GeometryError
            As ``loaded``.

        Examples
        --------
        >>> from easeoff.cases import gear_pair, read_case
        >>> from easeoff.contact.supports.support import Support, Supports
        >>> from easeoff.geometry import pair_geometry
        >>> geometry = pair_geometry(gear_pair(read_case("nasa-12x36")), (9, 7))
        >>> cycle = MeshCycle.of(geometry, mesh_positions=2, segments_per_line=9)
        >>> spring = Support((0.0, 0.0, 0.0), np.diag([5e-6, 5e-6, 5e-6, 1e-10, 1e-10, 1e-10]))
        >>> supported = cycle.supported([100.0], Supports(spring, spring))
        >>> supported.supports["rounds_status"].values.tolist()
        [0]
        """
        from .supports.assembly_rounds import AssemblyRounds
        from .supports.support import LoadedSupports, Supports
        from .supports.supported_contact import SupportedContact, SupportedPair

        rounds = AssemblyRounds() if rounds is None else rounds
        _check_options(edge_contact, progress, greater)
        instance("supports", supports, LoadedSupports)
        instance("rounds", rounds, AssemblyRounds)
        assembled = self.misaligned if assembled is None else assembled
        instance("assembled", assembled, Callable)
        if greater and not (isinstance(supports, Supports) and rounds.update == "none"):
            raise InputError("greater: must go with constant supports and rounds = 'none', whose segments stay")
        load = array("torques", torques, "N m", ndim=1, fewest=1, above=0.0)
        cycle_solver = CycleSolver(self.ratio, edge_contact, solver, options, greater=greater)
        pair = SupportedPair(self, supports, assembled, cycle_solver, progress)
        return SupportedContact(pair, load, tuple(pair.solved(load, rounds)))

    def solved(self, torques: Sequence[float] | Array, solver: SolverChoice = "auto") -> list[LoadedCase]:
        """The cases of ``loaded`` alone, with contact on lines."""
        return CycleSolver(self.ratio, solver=solver).solved(self.segments.by_position, np.asarray(torques, float))

    def with_ease_off(self, ease_off: xr.Dataset) -> MeshCycle:
        """The same pair with another ease-off on the same grid, as of deviating or modified flanks.

        Flanks and elastic teeth stay; so do contact lines and bending compliance unless the roll angle changes.
        """
        return self.with_geometry(replace(self.geometry, ease_off=ease_off))

    def misaligned(self, misalignment: Misalignment) -> MeshCycle:
        """The same pair in another assembly; flanks and elastic teeth stay.

        The ease-off is that of the flanks: one that ``with_ease_off`` put in its place is not carried over.

        Raises
        ------
        GeometryError
            If the flanks do not meet.
        """
        instance("misalignment", misalignment, Misalignment)
        return self.with_geometry(self.geometry.misaligned(misalignment))

    def with_geometry(self, geometry: PairGeometry) -> MeshCycle:
        """The same teeth in another mesh: a geometry made from that of this cycle."""
        instance("geometry", geometry, PairGeometry)
        fields, on_lines = _fields(geometry), self.segments.on_lines
        if not _same(fields, self.fields):
            lines = lines_at(fields, self.pinion_pitch, self.lines.rotations)
            on_lines = replace(on_lines, fields=fields, lines=lines)
        return MeshCycle(geometry, replace(self.segments, fields=fields, on_lines=on_lines))

    def at(self, mesh_position: int) -> MeshCycle:
        """The same pair at one of its mesh positions alone."""
        return self._divided(lines=self.lines.at(mesh_position))

    def at_rotations(self, rotations: Array) -> MeshCycle:
        """The same pair at other pinion rotations (k) [rad] than those of its mesh positions."""
        wanted = array("rotations", rotations, "rad", ndim=1, fewest=1)
        return self._divided(lines=lines_at(self.fields, self.pinion_pitch, wanted))

    def with_segments(self, segments_per_line: int) -> MeshCycle:
        """The same pair with another number of segments of a contact line."""
        return self._divided(count=whole("segments_per_line", segments_per_line, 1))

    def _divided(self, **changed: Any) -> MeshCycle:
        return replace(self, segments=replace(self.segments, on_lines=replace(self.segments.on_lines, **changed)))


def _check_options(edge_contact: bool, progress: Callable[[], None] | None, greater: Sequence[LoadedCase]) -> None:
    """Refuse other kinds of what ``MeshCycle.loaded`` and ``MeshCycle.supported`` take alike."""
    truth("edge_contact", edge_contact)
    instance("progress", progress, Callable | None)
    instances("greater", greater, LoadedCase)


def _fields(geometry: PairGeometry) -> FlankSplines:
    return loaded_splines(geometry.flanks, geometry.ease_off, geometry.teeth)


def _same(splines: FlankSplines, other: FlankSplines) -> bool:
    """True if splines agree to the bit in all that contact lines and compliance depend on."""
    coefficients, others = splines.spline.coefficients, other.spline.coefficients
    if not np.array_equal(splines.holes, other.holes) or coefficients.shape != others.shape:
        return False
    columns = [column for name, (column, _) in splines.columns.items() if name not in GAP_FIELDS]
    return all(np.array_equal(coefficients[column], others[column]) for column in columns)
