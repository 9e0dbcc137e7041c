"""Contact analysis of a case, in one assembly or, where the misalignment depends on the torque, in several."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import replace
from typing import TYPE_CHECKING, Any

import numpy as np
import xarray as xr
from numpy.typing import NDArray

from ...cases.analysis_size import AnalysisSize
from ...cases.schema.case_schema import Case
from ...cases.schema.usual_torques import TORQUE_LIMIT, TORQUE_MINIMUM, torque_range
from ...contact.evaluation.cycle_numbers import with_loaded_numbers, with_unloaded_numbers
from ...contact.loaded import LoadedCase
from ...contact.solvers import SolverChoice, require_solver
from ...contact.tooth_root_stress import root_stress
from ...core.checks import distinct
from ...core.errors import InputError
from ...core.process_settings import one_blas_thread
from ...geometry.pair.tooth_thickness import contradictions
from ..case_in_mesh import CaseInMesh, case_attributes, deflection_attributes
from ..deviations.deviation_source import require_line_contact
from ..result_layout import RESULT_SCHEMA_VERSION
from .joined_analysis import OVER_TORQUE, Analysis, joined_analysis, misalignment_group
from .supported_analysis import LoadedPart, case_rounds, case_supports, supported_parts

if TYPE_CHECKING:
    from ...contact.supports.assembly_rounds import AssemblyRounds
    from ...contact.supports.support import LoadedSupports

Array = NDArray[Any]

LIGHT_LOAD_SHARE = 0.01  # of the greatest torque


def case_torques(case: Case, torques: float | Sequence[float] | None = None) -> Array:
    """Torques at the pinion [N m]: the case's own if none are given.

    Raises
    ------
    InputError
        If a torque comes twice, or is not from ``TORQUE_MINIMUM`` to ``TORQUE_LIMIT``.

    Examples
    --------
    >>> from easeoff.cases import read_case
    >>> case_torques(read_case("nasa-12x36"), 250.0).tolist()
    [250.0]
    """
    found = distinct("torques", case.contact.torques if torques is None else torques, "N m", above=0.0)
    wrong = found[(found < TORQUE_MINIMUM) | (found >= TORQUE_LIMIT)]
    if wrong.size:
        raise InputError(f"torques = {wrong[0]:g}: must be {torque_range()}")
    return found


@one_blas_thread()
def contact_analysis(
    state: CaseInMesh,
    torques: float | Sequence[float] | None = None,
    *,
    edge_contact: bool | None = None,
    marking: float | None = None,
    solver: SolverChoice = "auto",
    supports: LoadedSupports | None = None,
    rounds: AssemblyRounds | None = None,
    progress: Callable[[], None] | None = None,
    **options: Any,
) -> Analysis:
    """Analyse a case's pair in mesh without friction, and keep the contact problems.

    Parameters
    ----------
    state
        The pair in mesh. Where its misalignment depends on the torque, every torque is analysed in its assembly.
    torques, edge_contact, marking, solver, rounds, progress, **options
        As of ``analyze``.
    supports
        Supports of the members; the case's own if left out.

    Raises
    ------
    InputError, GeometryError, MissingSolverError
        As ``analyze``.

    Examples
    --------
    >>> from easeoff.cases import read_case
    >>> coarse = {"mesh_positions": 3, "segments_per_line": 9, "lengthwise_nodes": 9, "profile_nodes": 7}
    >>> case = read_case("nasa-12x36")
    >>> case = case.model_copy(update={"contact": case.contact.model_copy(update=coarse)})
    >>> analysis = contact_analysis(CaseInMesh.of(case), [100.0])
    >>> [solved.solution.status.name for solved in analysis.cases]
    ['CERTIFIED', 'CERTIFIED', 'CERTIFIED']
    """
    case, cycle, geometry = state.case, state.cycle, state.cycle.geometry
    load = case_torques(case, torques)
    AnalysisSize.of(case, load.size).require_memory()
    edges = case.contact.edge_contact if edge_contact is None else edge_contact
    assemblies = state.assemblies(load)
    for own in (state, *(own for _, own in assemblies)):
        if own.deviations:
            require_line_contact(own.cycle.lost_contact, own.deviations)
    unloaded = cycle.unloaded(separation=case.contact.separation if marking is None else marking)
    held = case_supports(case) if supports is None else supports
    if rounds is None and supports is None:
        rounds = case_rounds(case)
    how: dict[str, Any] = {"edge_contact": edges, "solver": solver, "progress": progress, **options}
    solved: list[LoadedPart] = []
    light, light_load = LIGHT_LOAD_SHARE * load.max(), None
    light_state = state.assemblies([light])[0][1]
    # The native solver takes the light load with the others, where nobody counts the solves; others start from it.
    native = require_solver(solver) == "native" and not options
    with_light = held is None and progress is None and native
    for places, own in assemblies:
        at = load[list(places)]
        if held is not None:
            solved += supported_parts(own, places, at, held, rounds, **how)
        elif with_light and light_load is None and _same_assembly(own, light_state):
            loaded, cases = own.cycle.loaded(np.append(at, light), **how)
            light_load = with_loaded_numbers(own.cycle, *_part_over_torque(loaded, cases, slice(at.size, None)))
            solved.append(LoadedPart(places, own, *_part_over_torque(loaded, cases, slice(at.size)), {}))
        else:
            solved.append(LoadedPart(places, own, *own.cycle.loaded(at, **how), {}))
    parts = [(one.places, Analysis(_loaded_groups(one), one.cases)) for one in solved]
    if light_load is None:
        light_load = _light_load(state, light, edges, solved, held, rounds)
    groups = {
        "/": xr.Dataset(attrs=_provenance(state, load, solver, edge_contact=edges)),
        "flanks": geometry.flanks,
        "ease_off": geometry.ease_off,
        "teeth": geometry.teeth,
        "unloaded": with_unloaded_numbers(cycle, unloaded),
        "light_load": light_load,
    }
    if state.teeth is not None and case.compliance.model == "fe" and (sharp := _sharp_roots(state)):
        groups["/"].attrs["root_stress_left_out"] = "; ".join(sharp)
    if len(parts) == 1 and _same_assembly(solved[0].state, state):
        only = parts[0][1]
        return Analysis(groups | {name: only.groups[name] for name in OVER_TORQUE if name in only.groups}, only.cases)
    found = joined_analysis(parts, groups)
    if reasons := [reason for one in solved if (reason := _not_ended(one))]:
        found.groups["supports"].attrs["rounds_not_ended"] = "; ".join(reasons)
    return found


def _part_over_torque(loaded: xr.Dataset, cases: list[LoadedCase], part: slice) -> tuple[xr.Dataset, list[LoadedCase]]:
    """Loaded contact at some of its torques."""
    chosen = range(loaded.sizes["torque"])[part]
    own = [replace(case, torque=case.torque - chosen.start) for case in cases if case.torque in chosen]
    return loaded.isel(torque=part), own


def _not_ended(part: LoadedPart) -> str:
    """Why rounds of a part did not end; empty if they did."""
    return str(part.groups["supports"].attrs.get("rounds_not_ended", "")) if part.groups else ""


def _loaded_groups(part: LoadedPart) -> dict[str, xr.Dataset]:
    """Groups over the torque of a pair in one assembly, and its ease-off."""
    state, loaded, cases = part.state, part.loaded, part.cases
    torques, positions = loaded["torque"].values, loaded["mesh_position"].values
    errors = [state.pair.assembly.misalignment] * torques.size
    groups = {
        "ease_off": state.cycle.geometry.ease_off,
        "misalignment": misalignment_group(errors, torques, positions),
        **part.groups,
        "loaded": with_loaded_numbers(state.cycle, loaded, cases),
    }
    if state.teeth is not None and state.case.compliance.model == "fe" and not _sharp_roots(state):
        groups["root_stress"] = root_stress(state.cycle.fields, state.teeth, cases, loaded)
    return groups


def _light_load(
    state: CaseInMesh,
    torque: float,
    edges: bool,
    parts: list[LoadedPart],
    held: LoadedSupports | None,
    rounds: AssemblyRounds | None,
) -> xr.Dataset:
    """The group ``light_load``, in the assembly at its torque [N m]; segments of a greater torque there are taken."""
    ((places, own),) = state.assemblies([torque])
    greater = next((one.cases for one in parts if _same_assembly(one.state, own)), [])
    if held is not None:
        from ...contact.supports.support import Supports

        first_order = isinstance(held, Supports) and rounds is not None and rounds.update == "none"
        how: dict[str, Any] = {"edge_contact": edges, "greater": greater if first_order else ()}
        (one,) = supported_parts(own, places, np.array([torque]), held, rounds, **how)
        return with_loaded_numbers(one.state.cycle, one.loaded, one.cases)
    return with_loaded_numbers(own.cycle, *own.cycle.loaded([torque], edge_contact=edges, greater=greater))


def _same_assembly(state: CaseInMesh, other: CaseInMesh) -> bool:
    return state.pair.assembly == other.pair.assembly


def _sharp_roots(state: CaseInMesh) -> list[str]:
    """Why teeth by finite elements have no root stress; empty if both have it."""
    return [tooth.no_root for tooth in state.teeth or () if tooth.root is None]


def _provenance(state: CaseInMesh, torques: Array, solver: SolverChoice, *, edge_contact: bool) -> dict[str, Any]:
    """Origin of a result, as netCDF attributes."""
    flanks = (state.pair.pinion.opposite, state.pair.gear.opposite)
    return {
        **case_attributes(state.case, "analyze"),
        **state.attributes,
        **deflection_attributes(state.misalignment, state.flank, torques),
        "schema_version": RESULT_SCHEMA_VERSION,
        "solver": solver if isinstance(solver, str) else require_solver(solver),
        "compliance_model": state.case.compliance.model,
        "edge_contact": int(edge_contact),
        **({"contradictions": "; ".join(found)} if (found := contradictions(state.pair)) else {}),
        "opposite_flanks": "given" if all(flanks) else "assumed from the loaded ones",
    }
