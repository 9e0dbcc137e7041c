"""Contact analysis of a case, in one assembly or, where the misalignment depends on the torque, in several.

It has labelled groups; analyses of several assemblies, such as those that supports take under load, are joined along
the torque into one.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from typing import TYPE_CHECKING, Any

import numpy as np
import xarray as xr

from ...cases.deflections import Deflections, misalignment_at
from ...cases.schema.case_schema import Case
from ...cases.schema.usual_torques import TORQUE_LIMIT, TORQUE_MINIMUM, torque_range
from ...contact.evaluation.cycle_numbers import with_loaded_numbers, with_unloaded_numbers
from ...contact.loaded import LoadedCase
from ...contact.mesh_cycle import MeshCycle
from ...contact.solvers import SolverChoice
from ...contact.solvers.registry import chosen_solver
from ...contact.solvers.solver_declaration import ChosenSolver
from ...contact.tooth_root_stress import root_stress
from ...core.arrays import Array
from ...core.attributes import labelled
from ...core.checks import distinct
from ...core.errors import GeometryError, InputError
from ...core.process_settings import one_blas_thread
from ...geometry.pair.assembly import Misalignment
from ...geometry.pair.tooth_thickness import contradictions
from ..case_in_mesh import CaseInMesh, case_attributes, deflection_attributes
from ..deviations import require_line_contact
from ..result import RESULT_SCHEMA_VERSION

if TYPE_CHECKING:
    from ...contact.supports.assembly_rounds import AssemblyRounds
    from ...contact.supports.support import LoadedSupports


#: Groups over the torque, joined from those of the assemblies.
OVER_TORQUE = ("misalignment", "supports", "loaded", "root_stress", "friction")
#: Attributes of a group that count something in one assembly: of several the greatest stands.
COUNTS = ("searched_segments",)


@dataclass(frozen=True)
class Analysis:
    """An analysis with what does not go into the file.

    Parameters
    ----------
    groups
        The labelled results by the name of their group; ``/`` is that of the whole.
    cases
        Every solved case with its contact problem.
    parts
        Analyses of the assemblies it is joined from, with the numbers of their torques; empty if there is one assembly.

    Examples
    --------
    >>> list(Analysis({"unloaded": xr.Dataset()}, cases=[]).tree.children)
    ['unloaded']
    """

    groups: Mapping[str, xr.Dataset]
    cases: list[LoadedCase]
    parts: tuple[tuple[tuple[int, ...], Analysis], ...] = ()

    @cached_property
    def tree(self) -> xr.DataTree:
        """The labelled results as one tree."""
        return xr.DataTree.from_dict(self.groups)


def joined_analysis(parts: Sequence[tuple[Sequence[int], Analysis]], common: Mapping[str, xr.Dataset]) -> Analysis:
    """Analyses of several assemblies, each with the numbers of its torques in the whole, as one along the torque.

    All have the same groups, variables and mesh positions; ``common`` are groups of the whole that are not over the
    torque. Segments are padded with NaN; tooth pairs that an assembly does not know carry nothing.
    """
    numbered = tuple((tuple(places), part) for places, part in parts)
    groups = dict(common)
    for name in OVER_TORQUE:
        if name in numbered[0][1].groups:
            groups[name] = _joined([part.groups[name] for _, part in numbered], [places for places, _ in numbered])
    cases = [replace(case, torque=places[case.torque]) for places, part in numbered for case in part.cases]
    torques = groups["loaded"]["torque"].values
    # In the order of one analysis: neighbouring torques of a mesh position stand together.
    cases.sort(key=lambda case: (case.mesh_position, float(torques[case.torque])))
    return Analysis(groups, cases, numbered)


def misalignment_group(misalignments: Sequence[Misalignment], torques: Array, mesh_positions: Array) -> xr.Dataset:
    """The group ``misalignment`` of a result, from that of every torque (t) [N m], alike at all mesh positions (k)."""
    names = ("offset", "pinion_axial", "gear_axial", "shaft_angle")
    columns = {name: np.array([[getattr(one, name)] for one in misalignments]) for name in names}
    data = {
        name: (("torque", "mesh_position"), np.repeat(v, len(mesh_positions), axis=1)) for name, v in columns.items()
    }
    return labelled(xr.Dataset(data, coords={"torque": torques, "mesh_position": mesh_positions}))


def _joined(parts: list[xr.Dataset], places: list[tuple[int, ...]]) -> xr.Dataset:
    """Datasets joined along the torque, in the order of its numbers."""
    order = np.argsort(np.concatenate([np.asarray(one) for one in places]), kind="stable")
    segments = max(part.sizes.get("segment", 0) for part in parts)
    pairs = np.unique(np.concatenate([part["pair"].values for part in parts])) if "pair" in parts[0].dims else None
    data: dict[str, xr.Variable] = {}
    for name, first in parts[0].variables.items():
        variables = [part.variables[name] for part in parts]
        if name == "pair":
            data["pair"] = xr.Variable("pair", pairs, first.attrs)
        elif "torque" in first.dims or "segment" in first.dims:
            # What depends on the segments alone is another thing in every assembly.
            if "torque" not in first.dims:
                variables = [_repeated(one, len(at)) for one, at in zip(variables, places, strict=True)]
            if "pair" in first.dims and pairs is not None:
                known = [part["pair"].values for part in parts]
                variables = [_of_pairs(one, at, pairs) for one, at in zip(variables, known, strict=True)]
            if "segment" in first.dims:
                variables = [_padded(one, segments) for one in variables]
            variables = [one.transpose(*variables[0].dims) for one in variables]
            axis = variables[0].dims.index("torque")
            values = np.take(np.concatenate([one.values for one in variables], axis=axis), order, axis=axis)
            data[str(name)] = xr.Variable(variables[0].dims, values, first.attrs)
        else:
            data[str(name)] = first
    attributes = {name: value for part in reversed(parts) for name, value in part.attrs.items()}
    attributes |= {name: max(part.attrs[name] for part in parts) for name in COUNTS if name in attributes}
    coordinates = {name: data.pop(str(name)) for name in map(str, parts[0].coords)}
    return xr.Dataset(data, coords=coordinates, attrs=attributes)


def _repeated(variable: xr.Variable, torques: int) -> xr.Variable:
    """A variable over as many torques, the same at each."""
    values = np.broadcast_to(variable.values, (torques, *variable.shape))
    return xr.Variable(("torque", *variable.dims), values, variable.attrs)


def _of_pairs(variable: xr.Variable, known: Array, pairs: Array) -> xr.Variable:
    """A variable over further tooth pairs, which carry nothing: zero, or NaN where there is no solution."""
    axis = variable.dims.index("pair")
    zero = 0.0 * np.take(variable.values, [0], axis=axis)
    values = np.repeat(zero, pairs.size, axis=axis)
    values[(slice(None),) * axis + (np.searchsorted(pairs, known),)] = variable.values
    return xr.Variable(variable.dims, values, variable.attrs)


def _padded(variable: xr.Variable, segments: int) -> xr.Variable:
    """A variable over further segments, which there are none: NaN, or zero for numbers of flags."""
    more = segments - variable.sizes["segment"]
    fill = np.nan if variable.dtype.kind == "f" else 0
    return variable if more == 0 else variable.pad(segment=(0, more), constant_values=fill)


@dataclass(frozen=True)
class LoadedPart:
    """Loaded contact at some torques, in one assembly, as of ``MeshCycle.loaded``."""

    places: tuple[int, ...]  # numbers of the torques among all
    state: CaseInMesh
    loaded: xr.Dataset
    cases: list[LoadedCase]
    groups: dict[str, xr.Dataset]  # ``misalignment`` and ``supports``; empty without supports


def supported_parts(
    state: CaseInMesh,
    places: Sequence[int],
    torques: Array,
    supports: LoadedSupports,
    rounds: AssemblyRounds | None = None,
    **options: Any,
) -> list[LoadedPart]:
    """Loaded contact on supports at torques (t) [N m], in the assemblies whose ease-off it was found with."""
    states = {state.pair.assembly.misalignment: state}

    def assembled(misalignment: Misalignment) -> MeshCycle:
        if misalignment not in states:
            states[misalignment] = state.misaligned(misalignment)
        return states[misalignment].cycle

    contact = state.cycle.supported(torques, supports, rounds=rounds, assembled=assembled, **options)
    parts = []
    for numbers, cycle in contact.assemblies:
        rows = {number: row for row, number in enumerate(numbers)}
        cases = [replace(case, torque=rows[case.torque]) for case in contact.cases if case.torque in rows]
        groups = {name: getattr(contact, name).isel(torque=list(numbers)) for name in ("misalignment", "supports")}
        there = states[cycle.geometry.pair.assembly.misalignment]
        chosen = tuple(places[number] for number in numbers)
        parts.append(LoadedPart(chosen, there, contact.loaded.isel(torque=list(numbers)), cases, groups))
    return parts


def case_rounds(case: Case) -> AssemblyRounds | None:
    """Rounds as a case on supports has them; ``None`` without supports."""
    if case.supports is None:
        return None
    from ...contact.supports.assembly_rounds import AssemblyRounds

    return AssemblyRounds(case.supports.rounds)


def case_supports(case: Case) -> LoadedSupports | None:
    """Supports of a case as ``cases.support_conversion`` makes them; ``None`` if it has none."""
    if case.supports is None:
        return None
    from ...cases.support_conversion import support_system

    return support_system(case)


def in_assembly_under_load(state: CaseInMesh, torques: Sequence[float] | Array) -> CaseInMesh:
    """A pair on the supports of its case, in the mean assembly at each of some torques [N m]; else as it is.

    Its ``deflections`` are exact at the torques, its case has no supports. GeometryError if an assembly is not known:
    the contact is not certified, or the rounds do not end.
    """
    case, load = state.case, np.sort(np.asarray(torques, dtype=np.float64))
    supports = case_supports(case)
    if supports is None:
        return state
    from ...contact.supports.supported_contact import PARTS

    rows = {0.0: list(vars(misalignment_at(state.misalignment, 0.0, state.flank)).values())}
    for places, assembly in state.assemblies(load):
        chosen = load[list(places)]
        edges = case.contact.edge_contact
        for part in supported_parts(assembly, places, chosen, supports, case_rounds(case), edge_contact=edges):
            reason = part.groups["supports"].attrs.get("rounds_not_ended", "")
            means = [part.groups["misalignment"][name].mean("mesh_position").values for name in PARTS[:4]]
            if reason or not np.isfinite(means).all():
                raise GeometryError(
                    f"the assembly under load is not known: {reason or 'the contact has no certified solution'}; see "
                    "'easeoff run', and choose other torques or stiffer supports"
                )
            rows |= {load[place]: list(row) for place, row in zip(part.places, np.transpose(means), strict=True)}
    offset, pinion_axial, gear_axial, shaft_angle = np.transpose([rows[torque] for torque in sorted(rows)])
    table = Deflections(sorted(rows), offset, pinion_axial, gear_axial, shaft_angle)
    rigid = case.model_copy(update={"supports": None})
    return replace(state.misaligned(table), case=rigid)


LIGHT_LOAD_SHARE = 0.01  # of the greatest torque


def case_torques(case: Case, torques: float | Sequence[float] | None = None) -> Array:
    """Torques at the pinion [N m], distinct and within limits: the case's own if none are given."""
    load = distinct("torques", case.contact.torques if torques is None else torques, "N m", above=0.0)
    wrong = load[(load < TORQUE_MINIMUM) | (load >= TORQUE_LIMIT)]
    if wrong.size:
        raise InputError(f"torques = {wrong[0]:g}: must be {torque_range()}")
    return load


@one_blas_thread()
def contact_analysis(
    state: CaseInMesh,
    torques: Sequence[float] | Array,
    *,
    edge_contact: bool | None = None,
    marking: float | None = None,
    solver: SolverChoice = "auto",
    supports: LoadedSupports | None = None,
    rounds: AssemblyRounds | None = None,
    progress: Callable[[], None] | None = None,
    **options: Any,
) -> Analysis:
    """Analysis of a case's pair in mesh without friction, with its contact problems.

    Torques (t) [N m] that ``case_torques`` has checked; other arguments as of ``analyze``. Where the misalignment
    depends on the torque, every torque is analysed in its assembly.
    """
    case, cycle, geometry, solver = state.case, state.cycle, state.cycle.geometry, chosen_solver(solver)
    edges = case.contact.edge_contact if edge_contact is None else edge_contact
    load = np.asarray(torques, dtype=np.float64)
    assemblies = state.assemblies(load)
    for assembly in (state, *(assembly for _, assembly in assemblies)):
        if assembly.deviations:
            require_line_contact(assembly.cycle.lost_contact, assembly.deviations)
    unloaded = cycle.unloaded(separation=case.contact.separation if marking is None else marking)
    chosen_supports = case_supports(case) if supports is None else supports
    if rounds is None and supports is None:
        rounds = case_rounds(case)
    settings: dict[str, Any] = {"edge_contact": edges, "solver": solver, "progress": progress, **options}
    solved: list[LoadedPart] = []
    light, light_load = LIGHT_LOAD_SHARE * load.max(), None
    light_state = state.assemblies([light])[0][1]
    # The native solver takes the light load with the others, where nobody counts the solves; others start from it.
    with_light = chosen_supports is None and progress is None and solver.is_native and not options
    for places, assembly in assemblies:
        at = load[list(places)]
        if chosen_supports is not None:
            solved += supported_parts(assembly, places, at, chosen_supports, rounds, **settings)
        elif with_light and light_load is None and _same_assembly(assembly, light_state):
            loaded, cases = assembly.cycle.loaded(np.append(at, light), **settings)
            light_load = with_loaded_numbers(assembly.cycle, *_part_over_torque(loaded, cases, slice(at.size, None)))
            solved.append(LoadedPart(places, assembly, *_part_over_torque(loaded, cases, slice(at.size)), {}))
        else:
            solved.append(LoadedPart(places, assembly, *assembly.cycle.loaded(at, **settings), {}))
    parts = [(one.places, Analysis(_loaded_groups(one), one.cases)) for one in solved]
    if light_load is None:
        light_load = _light_load(state, light, edges, solved, chosen_supports, rounds)
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
    analysis = joined_analysis(parts, groups)
    if reasons := [reason for one in solved if (reason := _not_ended(one))]:
        analysis.groups["supports"].attrs["rounds_not_ended"] = "; ".join(reasons)
    return analysis


def _part_over_torque(loaded: xr.Dataset, cases: list[LoadedCase], part: slice) -> tuple[xr.Dataset, list[LoadedCase]]:
    """Loaded contact at some of its torques."""
    chosen = range(loaded.sizes["torque"])[part]
    chosen_cases = [replace(case, torque=case.torque - chosen.start) for case in cases if case.torque in chosen]
    return loaded.isel(torque=part), chosen_cases


def _not_ended(part: LoadedPart) -> str:
    """Reason why rounds of a part did not end; empty if they did."""
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
    supports: LoadedSupports | None,
    rounds: AssemblyRounds | None,
) -> xr.Dataset:
    """The group ``light_load``, in the assembly at its torque [N m]; segments of a greater torque there are taken."""
    ((places, assembly),) = state.assemblies([torque])
    greater = next((one.cases for one in parts if _same_assembly(one.state, assembly)), [])
    if supports is not None:
        from ...contact.supports.support import Supports

        first_order = isinstance(supports, Supports) and rounds is not None and rounds.update == "none"
        settings: dict[str, Any] = {"edge_contact": edges, "greater": greater if first_order else ()}
        (one,) = supported_parts(assembly, places, np.array([torque]), supports, rounds, **settings)
        return with_loaded_numbers(one.state.cycle, one.loaded, one.cases)
    return with_loaded_numbers(assembly.cycle, *assembly.cycle.loaded([torque], edge_contact=edges, greater=greater))


def _same_assembly(state: CaseInMesh, other: CaseInMesh) -> bool:
    return state.pair.assembly == other.pair.assembly


def _sharp_roots(state: CaseInMesh) -> list[str]:
    """Reasons why teeth by finite elements have no root stress; empty if both have it."""
    return [tooth.no_root for tooth in state.teeth or () if tooth.root is None]


def _provenance(state: CaseInMesh, torques: Array, solver: ChosenSolver, *, edge_contact: bool) -> dict[str, Any]:
    """Origin of a result, as netCDF attributes."""
    flanks = (state.pair.pinion.opposite, state.pair.gear.opposite)
    return {
        **case_attributes(state.case, "analyze"),
        **state.attributes,
        **deflection_attributes(state.misalignment, state.flank, torques),
        "schema_version": RESULT_SCHEMA_VERSION,
        "solver": solver.asked,
        "compliance_model": state.case.compliance.model,
        "edge_contact": int(edge_contact),
        **({"contradictions": "; ".join(conflicts)} if (conflicts := contradictions(state.pair)) else {}),
        "opposite_flanks": "given" if all(flanks) else "assumed from the loaded ones",
    }
