"""Loaded contact over a mesh cycle: forces, pressures, transmission error at every torque (Kolivand 2009, ch. 3)."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from typing import Any

import numpy as np
import xarray as xr
from numpy.typing import NDArray

from ..core.checks import array
from ..core.ordered_values import ordered
from ..core.processes.blas_threads import one_blas_thread
from .compliance.elastic_model import ElasticModel, ElasticTeeth, tooth_fields
from .line_contact.line_contact_law import solve_at_torques
from .lines.contact_lines import contact_splines
from .lines.flank_splines import FlankSplines
from .lines.mesh_lines import MeshLines
from .lines.opposite_points import PASSING_FIELDS
from .loaded_cases import LoadedCase, loaded_dataset
from .segments import CycleSegments, LineSegments, Segments
from .solvers import SolverChoice
from .supports.held_members import HeldMembers

Array = NDArray[Any]
EDGE_SEARCH_ROTATION_MINIMUM = 1e-5  # [rad]; start of a search without a known rotation
EDGE_SEARCH_ROTATION_LIMIT = 0.02  # [rad]; beyond it no edge is met
EDGE_SEARCH_POSITIONS = 2  # mesh positions at which the rotation is found first, to search edges for all
EDGE_SEARCH_ROTATION_FACTOR = 1.1  # times the rotation within which an edge must be met to be taken in


def loaded_splines(flanks: xr.Dataset, ease_off: xr.Dataset, teeth: xr.Dataset) -> FlankSplines:
    """Splines of everything the loaded contact needs on the gear flank.

    Parameters
    ----------
    flanks, ease_off, teeth
        Results of ``geometry.pair_geometry``.

    Examples
    --------
    >>> from easeoff.cases import gear_pair, read_case
    >>> from easeoff.geometry import pair_geometry
    >>> geometry = pair_geometry(gear_pair(read_case("nasa-12x36")), (9, 7))
    >>> fields = loaded_splines(geometry.flanks, geometry.ease_off, geometry.teeth)
    >>> fields("position", np.array([0.5, 0.5])).shape
    (3,)
    """
    passing = {name: ordered(ease_off, name, "lengthwise", "profile") for name in PASSING_FIELDS}
    return contact_splines(flanks, ease_off, tooth_fields(teeth) | passing)


def loaded_contact(
    splines: FlankSplines,
    teeth: xr.Dataset,
    mesh: MeshLines,
    *,
    ratio: float,
    torques: Array,
    model: ElasticModel,
    segments_per_line: int = 31,
    edge_contact: bool = True,
    solver: SolverChoice = "auto",
    progress: Callable[[], None] | None = None,
    **options: Any,
) -> tuple[xr.Dataset, list[LoadedCase]]:
    """Loaded contact over one mesh cycle, from its parts; ``MeshCycle.loaded`` has them together.

    Parameters
    ----------
    splines
        Splines from ``loaded_splines``.
    teeth
        The geometry's ``teeth``.
    mesh
        Contact lines from ``lines_in_mesh``.
    ratio
        Gear teeth over pinion teeth.
    model
        Elastic model of the teeth.
    segments_per_line
        Segments of a contact line.
    torques, edge_contact, solver, progress, **options
        As in ``MeshCycle.loaded``.

    Returns
    -------
    tuple
        As of ``MeshCycle.loaded``.

    Raises
    ------
    InputError
        If a torque is not positive.

    Examples
    --------
    >>> from easeoff.cases import gear_pair, read_case
    >>> from easeoff.contact import lines_in_mesh
    >>> from easeoff.contact.compliance.elastic_model import solid_shells
    >>> from easeoff.geometry import pair_geometry
    >>> pair = gear_pair(read_case("nasa-12x36"))
    >>> geometry = pair_geometry(pair, (9, 7))
    >>> fields = loaded_splines(geometry.flanks, geometry.ease_off, geometry.teeth)
    >>> mesh = lines_in_mesh(fields, pair.assembly.pinion_pitch, 2)
    >>> known = {"ratio": 3.0, "torques": np.array([100.0]), "model": solid_shells(pair)}
    >>> loaded, cases = loaded_contact(fields, geometry.teeth, mesh, **known)
    >>> [case.solution.status.name for case in cases]
    ['CERTIFIED', 'CERTIFIED']
    """
    segments = CycleSegments(splines, LineSegments(splines, mesh, ElasticTeeth(teeth, model), segments_per_line))
    return solve_cycle(segments, torques, ratio, edge_contact, solver, options, progress)


@one_blas_thread()
def solve_cycle(
    cycle: CycleSegments,
    torques: Array,
    ratio: float,
    edge_contact: bool,
    solver: SolverChoice,
    options: Mapping[str, Any],
    progress: Callable[[], None] | None = None,
    greater: Sequence[LoadedCase] = (),
) -> tuple[xr.Dataset, list[LoadedCase]]:
    """Loaded contact over one mesh cycle from its segments; arguments, returns and raises as ``MeshCycle.loaded``.

    Examples
    --------
    >>> from easeoff.cases import gear_pair, read_case
    >>> from easeoff.contact import MeshCycle
    >>> from easeoff.geometry import pair_geometry
    >>> geometry = pair_geometry(gear_pair(read_case("nasa-12x36")), (9, 7))
    >>> cycle = MeshCycle.of(geometry, mesh_positions=2, segments_per_line=5)
    >>> loaded, _ = solve_cycle(cycle.segments, np.array([100.0]), cycle.ratio, False, "auto", {})
    >>> loaded["status"].values.tolist()
    [[0, 0]]
    """
    torques = array("torques", torques, "N m", ndim=1, fewest=1, above=0.0)
    segments, cases = cycle_cases(cycle, torques, ratio, edge_contact, solver, options, progress, greater)
    return loaded_dataset(segments, cases, torques, cycle.on_lines.lines.rotations), cases


def cycle_cases(
    cycle: CycleSegments,
    torques: Array,
    ratio: float,
    edge_contact: bool,
    solver: SolverChoice,
    options: Mapping[str, Any],
    progress: Callable[[], None] | None = None,
    greater: Sequence[LoadedCase] = (),
    held: HeldMembers | None = None,
) -> tuple[list[Segments | None], list[LoadedCase]]:
    """The segments that may touch at every mesh position, and the cases of ``solve_cycle``.

    Parameters
    ----------
    cycle, torques, ratio, edge_contact, solver, options, progress, greater
        As of ``solve_cycle``.
    held
        Supports of the members; ``None`` for rigid ones. The segments must then know their wrenches.

    Examples
    --------
    >>> from easeoff.cases import gear_pair, read_case
    >>> from easeoff.contact import MeshCycle
    >>> from easeoff.geometry import pair_geometry
    >>> geometry = pair_geometry(gear_pair(read_case("nasa-12x36")), (9, 7))
    >>> cycle = MeshCycle.of(geometry, mesh_positions=2, segments_per_line=5)
    >>> len(cycle_cases(cycle.segments, np.array([100.0]), cycle.ratio, False, "auto", {})[1])
    2
    """

    def solved(
        segments: list[Segments | None], torques: Array, solver: SolverChoice, *own: Any
    ) -> tuple[list[Segments | None], list[LoadedCase]]:
        segments = segments if held is None else held.holding(segments)
        return segments, solve_all(segments, torques, ratio, solver, *own)

    count = cycle.on_lines.lines.rotations.size
    segments: list[Segments | None]
    if greater:
        segments = [None] * count
        for case in greater:
            segments[case.mesh_position] = case.segments
        return segments, solve_all(segments, torques, ratio, solver, options, progress)
    if not edge_contact:
        return solved(cycle.by_position, torques, solver, options, progress)
    # Edges can only hold the pair back: with contact on lines alone it turns farther.
    some = cycle.to_edges.at_every(max(count // EDGE_SEARCH_POSITIONS, 1))
    turned = _turned(solved(some, np.array([torques.max()]), "auto", {})[1], count, held)
    farthest = EDGE_SEARCH_ROTATION_FACTOR * max(float(turned.max()), EDGE_SEARCH_ROTATION_MINIMUM)
    widest = np.full(count, farthest)
    while True:
        segments, cases = solved(cycle.with_edges(widest), torques, solver, options, progress)
        turned = _turned(cases, count, held)
        # Where there is no line the pair turns until edges hold it, and may meet further ones.
        turned[[here is None for here in segments]] = 2.0 * widest.max()
        if np.all((turned <= widest) | (widest > EDGE_SEARCH_ROTATION_LIMIT)):
            return segments, cases
        widest, progress = np.maximum(widest, EDGE_SEARCH_ROTATION_FACTOR * turned), None


def solve_all(
    segments: list[Segments | None],
    torques: Array,
    ratio: float,
    solver: SolverChoice,
    options: Mapping[str, Any],
    progress: Callable[[], None] | None = None,
) -> list[LoadedCase]:
    """Solve every torque at every mesh position where a tooth pair can touch, each torque starting from the one before.

    Parameters
    ----------
    segments
        Segments of every mesh position.
    torques
        Torques at the pinion (t) [N m].
    ratio
        Gear teeth over pinion teeth.
    solver
        Solver, see `solve`; the native one takes all mesh positions at once.
    options
        Passed to the solver.
    progress
        Called for every torque and mesh position.

    Examples
    --------
    >>> from easeoff.cases import gear_pair, read_case
    >>> from easeoff.contact import MeshCycle
    >>> from easeoff.geometry import pair_geometry
    >>> geometry = pair_geometry(gear_pair(read_case("nasa-12x36")), (9, 7))
    >>> cycle = MeshCycle.of(geometry, mesh_positions=2, segments_per_line=5)
    >>> len(solve_all(cycle.segments.by_position, np.array([100.0, 200.0]), cycle.ratio, "auto", {}))
    4
    """
    present = [(k, here) for k, here in enumerate(segments) if here is not None]
    contacts = [here.line_contact for _, here in present]
    order, problems = np.argsort(torques, kind="stable"), [here.bending_problem for _, here in present]
    cases = []
    at_torques = solve_at_torques(problems, contacts, 1e3 * ratio * torques[order], solver, **options)
    for index, solved in zip(order, at_torques, strict=True):
        for (k, here), (solution, secant) in zip(present, solved, strict=True):
            cases.append(LoadedCase(int(index), k, here, solution, secant))
            if progress is not None:
                progress()
    return sorted(cases, key=lambda case: (case.mesh_position, float(torques[case.torque])))


def _turned(cases: list[LoadedCase], positions: int, held: HeldMembers | None = None) -> Array:
    """Greatest gap that closes at every mesh position, as a gear rotation [rad]; zero where nothing was solved."""
    turned = np.zeros(positions)
    for case in cases:
        if case.solution.certified:
            closing = 0.0 if held is None else held.closing(case.segments, case.solution.force)
            turned[case.mesh_position] = max(turned[case.mesh_position], case.solution.rotation + closing)
    return turned
