"""The whole analysis of a case: geometry, unloaded contact, loaded contact, as one tree."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
import xarray as xr

from ..cases.conversion import edges_touch, elastic_model, finite_elements, gear_pair
from ..cases.reading import read_case
from ..cases.schema.case_schema import Case
from ..contact.lines.mesh_lines import lines_in_mesh, lost_contact
from ..contact.loaded import loaded_contact, loaded_splines
from ..contact.loaded_cases import LoadedCase
from ..contact.root_stress import root_stress
from ..contact.solvers import require_solver
from ..contact.unloaded import unloaded_contact
from ..core.errors import InputError
from ..geometry.deviation.deviation import Method
from ..geometry.pair.assembly import Misalignment
from ..geometry.pair.gear_pair import FlankName, GearPair
from ..geometry.pair.modification import Modification, modified_ease_off
from ..geometry.tooth.tooth_flanks import MemberName
from .flank_deviations import (
    Deviated,
    Source,
    deviated_geometry,
    deviation_attributes,
    flank_deviations,
    require_line_contact,
)
from .provenance import provenance

if TYPE_CHECKING:
    from ..cases.schema.friction_table import FrictionTable
    from ..friction import FrictionModel, Lubricant, Operation
    from ..friction.operation import Array, Numbers, Roughness


@dataclass(frozen=True)
class Analysis:
    """An analysis with what does not go into the file.

    Parameters
    ----------
    tree
        The labelled results.
    cases
        Every solved case with its contact problem.
    """

    tree: xr.DataTree
    cases: list[LoadedCase]


def prepared_pair(case: Case, flank: FlankName, misalignment: Misalignment | None) -> GearPair:
    """The gear pair of a case, with its own misalignment or another."""
    pair = gear_pair(case, flank)
    return pair if misalignment is None else pair.misaligned(misalignment)


def analyze_in_full(
    case: Case,
    *,
    flank: FlankName = "drive",
    torques: float | Sequence[float] | None = None,
    misalignment: Misalignment | None = None,
    deviations: Mapping[MemberName, Source] | None = None,
    deviated: Deviated = "ease_off",
    interpolation: Method = "spline",
    modification: Modification | None = None,
    edge_contact: bool | None = None,
    solver: str = "auto",
    operation: Operation | None = None,
    friction_model: FrictionModel | None = None,
    friction_feedback: bool = False,
    progress: Callable[[], None] | None = None,
    **options: Any,
) -> Analysis:
    """As ``analyze``, with the operating conditions in one, and keeps the contact problems."""
    require_solver(solver)
    if operation is not None:
        from ..friction import FrictionModel, friction
        from ..friction import friction_feedback as with_feedback

        friction_model = friction_model or FrictionModel()
        friction_model.oil_states(operation)  # a temperature the oil has no data for shows before the work, not after
    elif friction_model is not None or friction_feedback:
        raise InputError("friction_model and friction_feedback need the speed of the pinion in 1/min")
    pair = prepared_pair(case, flank, misalignment)
    settings = case.contact
    load = np.atleast_1d(np.asarray(settings.torques if torques is None else torques, dtype=float))
    if np.unique(load).size != load.size:
        raise InputError(f"torques = {load.tolist()}: a value comes twice; give every torque in N m once")
    edges = edges_touch(case) if edge_contact is None else edge_contact
    teeth = finite_elements(case, pair)
    departures = flank_deviations(pair, deviations or {}, interpolation)
    geometry = deviated_geometry(pair, (settings.lengthwise_nodes, settings.profile_nodes), departures, deviated)
    if modification is not None:
        geometry = replace(geometry, ease_off=modified_ease_off(geometry.ease_off, modification))
    fields = loaded_splines(geometry.flanks, geometry.ease_off, geometry.teeth)
    mesh = lines_in_mesh(fields, pair.assembly.pinion_pitch, settings.mesh_positions)
    if departures:
        require_line_contact(lost_contact(fields, mesh), departures)
    unloaded = unloaded_contact(fields, mesh, separation=settings.separation)
    loaded, cases = loaded_contact(
        fields,
        geometry.teeth,
        mesh,
        ratio=pair.assembly.ratio,
        torques=load,
        model=elastic_model(case, teeth),
        segments_per_line=settings.segments_per_line,
        edge_contact=edges,
        solver=solver,
        progress=progress,
        **options,
    )
    groups = {
        "/": xr.Dataset(
            attrs=provenance(case, pair, flank, solver, modification, edge_contact=edges)
            | deviation_attributes(departures, deviated),
        ),
        "/flanks": geometry.flanks,
        "/ease_off": geometry.ease_off,
        "/teeth": geometry.teeth,
        "/unloaded": unloaded,
        "/loaded": loaded,
    }
    if teeth is not None and case.compliance.model == "fe":
        groups["/root_stress"] = root_stress(fields, teeth, cases, loaded)
    tree = xr.DataTree.from_dict(groups)
    if operation is not None:
        if friction_feedback:
            losses = with_feedback(tree, cases, operation, friction_model, solver=solver)
        else:
            losses = friction(tree, operation, friction_model)
        tree = xr.DataTree.from_dict({**groups, "/friction": losses})
    return Analysis(tree, cases)


def analyze(
    case: Case | str | Path,
    *,
    flank: FlankName = "drive",
    torques: float | Sequence[float] | None = None,
    misalignment: Misalignment | None = None,
    deviations: Mapping[MemberName, Source] | None = None,
    deviated: Deviated = "ease_off",
    interpolation: Method = "spline",
    modification: Modification | None = None,
    edge_contact: bool | None = None,
    solver: str = "auto",
    speed: Numbers | None = None,
    temperature: Numbers | None = None,
    roughness: Roughness | list[Roughness] | Array | None = None,
    oil: str | Lubricant | None = None,
    friction_model: FrictionModel | None = None,
    friction_feedback: bool | None = None,
    progress: Callable[[], None] | None = None,
    **options: Any,
) -> xr.DataTree:
    """Analyse a case from machine settings to certified loaded contact.

    Parameters
    ----------
    case
        A checked case, or what ``read_case`` takes: the name of a shipped case or the path of a case file.
    flank
        ``drive``: pinion concave with gear convex; ``coast``: the other two.
    torques
        Torque at the pinion [N m], one or several; the case's own if left out.
    misalignment
        Assembly errors; the case's own if left out.
    deviations
        What the flanks depart from the designed ones: for ``pinion``, ``gear`` or both a ``Deviation``, a dataset, or
        the file of a measured grid.
    deviated
        How they are taken in: ``ease_off`` updates the ease-off, ``surface`` computes with the deviating flanks.
    interpolation
        Between the nodes of measured grids and datasets: ``spline``, ``smooth`` or ``weighted_average``, see
        ``geometry.Deviation``.
    modification
        Added to the ease-off.
    edge_contact
        Whether tooth edges may touch beside the contact lines; as the case says, or with ``fe`` and ``solid_shell``, if
        left out.
    solver
        Name of a contact solver, see ``contact.available_solvers``.
    speed
        Speed of the pinion [1/min], one or several; the case's own if left out. With it the result has friction, power
        loss and efficiency, at every combination of speeds, temperatures and roughnesses.
    temperature, roughness, oil
        Of the oil [degC], of the flanks (RMS, um), and which oil; if left out the case's own, or 90, 0.8 and 75w90. See
        ``friction.Operation``.
    friction_model
        Models of friction coefficient, film and rolling; the case's own or the dissertation's if left out.
    friction_feedback
        Let friction take its part of the torque from the normal forces, see ``friction.feedback``; the case's own or
        not if left out.
    progress
        Called after every solved torque and mesh position.
    **options
        Passed to the solver.

    Returns
    -------
    xr.DataTree
        Groups ``flanks``, ``ease_off``, ``teeth``, ``unloaded``, ``loaded``; with finite elements ``root_stress``, and
        if a speed is given ``friction``; where it came from in the attributes.

    Raises
    ------
    InputError
        If an argument is out of range or the case has no such flanks.
    GeometryError
        If the settings describe no tooth in the blank, or flanks that do not meet, or if deviations scatter so much
        that there is no line contact.
    MissingSolverError
        If the solver's package is not installed.
    """
    checked = case if isinstance(case, Case) else read_case(case)
    table = checked.friction
    if table is not None:
        friction_model = friction_model or table.model()
        friction_feedback = table.feedback if friction_feedback is None else friction_feedback
    return analyze_in_full(
        checked,
        flank=flank,
        torques=torques,
        misalignment=misalignment,
        deviations=deviations,
        deviated=deviated,
        interpolation=interpolation,
        modification=modification,
        edge_contact=edge_contact,
        solver=solver,
        operation=operation_of(table, speed=speed, temperature=temperature, roughness=roughness, oil=oil),
        friction_model=friction_model,
        friction_feedback=bool(friction_feedback),
        progress=progress,
        **options,
    ).tree


def operation_of(table: FrictionTable | None, **conditions: Any) -> Operation | None:
    """Operating conditions from what was given of them and else from a case; ``None`` without a speed in either.

    Parameters
    ----------
    table
        The case's own conditions.
    **conditions
        Arguments of ``friction.Operation``; those that are ``None`` count as not given.

    Raises
    ------
    InputError
        If other conditions are given and no speed, or a value is not possible.
    """
    given = {name: value for name, value in conditions.items() if value is not None}
    if table is not None:
        return table.operation(**given)
    if "speed" not in given:
        if given:
            raise InputError(
                f"{' and '.join(given)} without a speed: friction needs the speed of the pinion in 1/min, here or in a "
                "table [friction] of the case"
            )
        return None
    from ..friction import Operation

    return Operation(**given)
