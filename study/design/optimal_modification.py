"""The low-order modification of a case's ease-off that makes its loads small or even, proved by a fresh analysis."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Any

import numpy as np
import xarray as xr

from ...cases.analysis_size import AnalysisSize
from ...cases.conversion import materials
from ...cases.deflection_table import MisalignmentSource, misalignments_of
from ...cases.deflections import assembly_columns
from ...cases.schema.case_schema import Case
from ...contact.modification import convex_programme
from ...contact.modification.convex_programme import (
    Goal,
    LoadResponse,
    Objective,
    end_loads,
    figures,
    stacked,
    worst_assembly,
)
from ...contact.modification.modification_search import ModificationSearch, optimal_modification
from ...contact.modification.modified_contact import ModifiedContact
from ...contact.solvers import require_solver
from ...core.arrays import Array
from ...core.attributes import labelled
from ...core.checks import number, positive, whole
from ...core.errors import GeometryError, InputError
from ...geometry.pair.gear_pair import FlankName
from ...geometry.pair.modification import Modification, basis, terms
from ..analysis.contact_analysis import case_torques, contact_analysis, in_assembly_under_load
from ..case_in_mesh import CaseInMesh, checked_case
from ..progress import callback, shows_progress

STAGES = ("before", "after")
LARGEST_MODIFICATION_MINIMUM, LARGEST_MODIFICATION_LIMIT = 1e-4, 1000.0  # [um]
TRANSMISSION_ERROR_MINIMUM = 1e-3  # [urad]


@shows_progress("modification", "programme")
def modify(
    case: Case | str | Path,
    *,
    flank: FlankName = "drive",
    torques: Sequence[float] | None = None,
    misalignments: Sequence[MisalignmentSource] = (),
    objective: str = "peak_load",
    order: int = 3,
    transmission_error: float | None = None,
    end_load: float | None = None,
    largest: float = 50.0,
    programmes: int = 40,
    solver: str = "auto",
    progress: Callable[[], None] | bool | None = None,
    stage: Callable[[str], None] | None = None,
) -> xr.DataTree:
    """Find the modification of a case's ease-off that is best under load, and analyse the case with it.

    The contact is that on lines alone, whatever the case says of edges: the convex programmes know no others. It keeps
    loads off the ends of the lines, where edges begin (``end_load``); ``analyze`` shows what edges carry.

    Parameters
    ----------
    case
        A checked case, or what ``read_case`` takes.
    flank
        ``drive`` or ``coast``.
    torques
        Torques at the pinion [N m]; the case's own if left out. All count in relation to what they have at the start;
        the one that fares worst decides.
    misalignments
        Further assemblies that count as much as the case's own, see ``analyze``. One that depends on the torque is
        at every torque another.
    objective
        ``peak_load``: the greatest line load over the mesh cycle; ``peak_pressure``: the greatest contact pressure;
        ``even_load``: the mean square of the line load.
    order
        Greatest total order of the surface's terms: 2, 3 or 4.
    transmission_error
        Limit of the loaded transmission error's peak to peak at every torque and assembly [urad]; none if left out.
    end_load
        Limit of the line load at the ends of the contact lines, on the edges of the flanks [N/mm]. If left out, no
        torque may load the edges more than it did; infinite for no limit.
    largest
        Limit of the modification anywhere on the flank [um].
    programmes
        The most convex programmes to solve in each search.
    solver
        Name of the contact solver.
    progress
        ``True`` for a line that shows it; or a function, called after every programme.
    stage
        Called with the name of what takes long before it begins: each elastic tooth, then the convex programmes.

    Returns
    -------
    xr.DataTree
        The analysis of the modified case, with the groups ``modification`` (terms and surface) and ``optimization``
        (before and after for each assembly and torque, and every programme).

    Raises
    ------
    InputError
        If an argument is out of range.
    GeometryError
        If the pair cannot be analysed as it is.

    Examples
    --------
    >>> from easeoff.cases import read_case
    >>> coarse = {"mesh_positions": 3, "segments_per_line": 9, "lengthwise_nodes": 9, "profile_nodes": 7}
    >>> case = read_case("nasa-12x36")
    >>> case = case.model_copy(update={"contact": case.contact.model_copy(update=coarse)})
    >>> tree = modify(case, torques=[200.0], order=2, programmes=1)
    >>> before, after = tree["optimization/max_line_load"].values.ravel()
    >>> bool(after <= before)
    True
    """
    checked = checked_case(case)
    if transmission_error is not None:
        positive("transmission_error", transmission_error, "urad", infinite=True)
        if transmission_error < TRANSMISSION_ERROR_MINIMUM:
            raise InputError(
                f"transmission_error = {transmission_error:g}: must be at least {TRANSMISSION_ERROR_MINIMUM:g} [urad]"
            )
    if end_load is not None:
        positive("end_load", end_load, "N/mm", zero=True, infinite=True)
    number("largest", largest, "um", above=0.0, most=LARGEST_MODIFICATION_LIMIT)
    if largest < LARGEST_MODIFICATION_MINIMUM:
        raise InputError(f"largest = {largest:g}: must be at least {LARGEST_MODIFICATION_MINIMUM:g} [um]")
    whole("programmes", programmes, 1)
    chosen, names = convex_programme.checked_objective(objective), terms(order)
    require_solver(solver)
    load = case_torques(checked, torques)
    others = misalignments_of(misalignments)
    AnalysisSize.of(checked, load.size * (1 + len(others))).require_memory()
    unloaded = CaseInMesh.of(checked, flank=flank, stage=stage)
    case_state = in_assembly_under_load(unloaded, load)
    if stage is not None:
        stage("convex programmes")
    assemblies = case_state.assemblies(load)
    least = np.empty(load.size)
    for places, at in assemblies:
        loaded, _ = at.cycle.loaded(load[list(places)], edge_contact=False, solver=solver)
        least[list(places)] = _least_line_load(loaded, at.cycle.ratio)
    states = [case_state, *(in_assembly_under_load(unloaded.misaligned(other), load) for other in others)]
    contacts = [
        ([number * load.size + place for place in places], ModifiedContact(at.cycle, load[list(places)], names, solver))
        for number, state in enumerate(states)
        for places, at in (assemblies if state is case_state else state.assemblies(load))
    ]

    def solved(coefficients: Array) -> LoadResponse | None:
        parts = [contact.loads(coefficients, cycles) for cycles, contact in contacts]
        known = [part for part in parts if part is not None]
        return stacked(known) if len(known) == len(parts) else None

    none = np.zeros(len(names))
    start = solved(none)
    if start is None:
        raise GeometryError(
            "the case as it is has mesh positions without a certified solution: see 'easeoff run', and choose other "
            "torques or misalignments"
        )
    goal = _goal(start, chosen, load.size, names, transmission_error, end_load, largest)
    full = stacked([contact.full_contact(none, cycles) for cycles, contact in contacts])
    optimum = optimal_modification(solved, start, full, goal, programmes=programmes, progress=callback(progress))
    best = contacts[0][1].modification(optimum.coefficients)
    tree = contact_analysis(case_state.modified(best), load, edge_contact=False, solver=solver).tree
    least_loads = xr.Dataset({"least_line_load": ("torque", least)}, {"torque": load})
    record = _compared(checked, start, optimum, least_loads, states)
    record.attrs |= {
        "objective": chosen,
        "edge_contact": 0,
        "transmission_error_limit_urad": math.inf if transmission_error is None else transmission_error,
        "end_load_limit_N_per_mm": goal.end_load,
        "largest_modification_um": largest,
        "converged": int(optimum.converged),
    }
    tree["optimization"] = xr.DataTree(record)
    tree["modification"] = xr.DataTree(_surface(best, tree["ease_off"].to_dataset()))
    return tree


def _goal(
    start: LoadResponse,
    objective: Objective,
    torques: int,
    names: tuple[str, ...],
    transmission_error: float | None,
    end_load: float | None,
    largest: float,
) -> Goal:
    load = worst_assembly(figures(start, "peak_load"), torques)
    at_ends = worst_assembly(end_loads(start), torques)
    points = np.meshgrid(np.linspace(0.0, 1.0, 15), np.linspace(0.0, 1.0, 11), indexing="ij")
    return Goal(
        objective=objective,
        reference=worst_assembly(figures(start, objective), torques),
        load_reference=load,
        transmission_error=math.inf if transmission_error is None else transmission_error,
        end_load=np.maximum(at_ends, 0.0) if end_load is None else np.full(torques, end_load),
        surface=basis(names, points[0].ravel(), points[1].ravel()),
        largest=largest,
    )


def _least_line_load(loaded: xr.Dataset, ratio: float) -> Array:
    """Least line load (t) [N/mm] of any surface: even along all contact lines of the worst mesh position."""
    arms = (loaded["lever_arm"] * loaded["length"]).sum("segment")
    return np.asarray((1e3 * ratio * loaded["torque"] / arms).max("mesh_position").values)


def _compared(
    case: Case, start: LoadResponse, search: ModificationSearch, least: xr.Dataset, states: Sequence[CaseInMesh]
) -> xr.Dataset:
    """The group ``optimization``."""
    torque = least["torque"].values
    stages = (start, search.loads)
    shape = (len(states), torque.size)

    def both(of: Callable[[LoadResponse], Array]) -> Array:
        return np.stack([of(loads).reshape(shape) for loads in stages])

    flexibility = sum(1.0 / material.plane_strain_modulus for material in materials(case))
    grid = ("stage", "assembly", "torque")
    data: dict[str, Any] = {
        "max_line_load": (grid, both(lambda loads: figures(loads, "peak_load"))),
        "max_pressure": (grid, both(lambda loads: figures(loads, "peak_pressure")) / math.sqrt(math.pi * flexibility)),
        "load_norm": (grid, both(lambda loads: figures(loads, "even_load"))),
        "max_end_load": (grid, np.maximum(both(end_loads), 0.0)),
        "peak_to_peak": (grid, both(convex_programme.peak_to_peaks)),
        "least_line_load": least["least_line_load"].variable,
    }
    depends = np.array([one.deflections is not None for one in states], dtype=np.int8)
    data |= assembly_columns([state.pair.assembly.misalignment for state in states])
    data["depends_on_torque"] = ("assembly", depends)
    steps = search.steps
    by_step = {
        "reach": [s.trust_radius for s in steps],
        "promised_objective": [s.promised.objective for s in steps],
        "fresh_objective": [s.fresh.objective for s in steps],
        "promised_violation": [s.promised.violation for s in steps],
        "fresh_violation": [s.fresh.violation for s in steps],
        "accepted": np.array([s.accepted for s in steps], dtype=np.int8),
        "mending": np.array([s.mending for s in steps], dtype=np.int8),
        "search": [s.search for s in steps],
        "programme_status": [s.status for s in steps],
    }
    data |= {name: ("programme", values) for name, values in by_step.items()}
    coords = {
        "stage": list(STAGES),
        "assembly": np.arange(len(states)),
        "torque": torque,
        "programme": np.arange(1, 1 + len(steps)),
    }
    return labelled(xr.Dataset(data, coords=coords))


def _surface(modification: Modification, ease_off: xr.Dataset) -> xr.Dataset:
    """The group ``modification``."""
    lengthwise, profile = ease_off["lengthwise"].values, ease_off["profile"].values
    values = modification(*np.meshgrid(lengthwise, profile, indexing="ij"))
    names, coefficients = list(modification.coefficients), list(modification.coefficients.values())
    data = {"coefficient": ("term", coefficients), "modification": (("lengthwise", "profile"), values)}
    return labelled(xr.Dataset(data, coords={"term": names, "lengthwise": lengthwise, "profile": profile}))
