"""The whole analysis of a case: geometry, unloaded contact, loaded contact, friction, as one tree."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import TYPE_CHECKING, Any

import xarray as xr

from ..cases.analysis_size import AnalysisSize
from ..cases.schema.case_schema import Case
from ..cases.schema.usual_torques import TORQUE_LIMIT, TORQUE_MINIMUM, torque_range
from ..contact.evaluation.cycle_numbers import with_loaded_numbers, with_unloaded_numbers
from ..contact.evaluation.marking_print import checked_thickness
from ..contact.load_capacity.tooth_root_stress import root_stress
from ..contact.loaded_cases import LoadedCase
from ..contact.solvers import SolverChoice, require_solver
from ..core.checks import distinct
from ..core.errors import InputError
from ..core.processes.blas_threads import one_blas_thread
from ..geometry.deviation.deviation import Method
from ..geometry.pair.assembly import Misalignment
from ..geometry.pair.gear_pair import FlankName
from ..geometry.pair.modification import Modification
from ..geometry.tooth.tooth_flanks import MemberName
from .case_in_mesh import CaseInMesh, case_attributes, checked_case
from .deviation_source import Deviated, Source, require_line_contact

if TYPE_CHECKING:
    from ..cases.schema.friction_table import FrictionTable
    from ..friction import FrictionModel, Lubricant, Operation
    from ..friction.operation import Array, Numbers, Roughness

RESULT_SCHEMA_VERSION = 1
LIGHT_LOAD_SHARE = 0.01  # of the greatest torque


@dataclass(frozen=True)
class Analysis:
    """An analysis with what does not go into the file.

    Parameters
    ----------
    groups
        The labelled results by the name of their group; ``/`` is that of the whole.
    cases
        Every solved case with its contact problem.

    Examples
    --------
    >>> list(Analysis({"unloaded": xr.Dataset()}, cases=[]).tree.children)
    ['unloaded']
    """

    groups: Mapping[str, xr.Dataset]
    cases: list[LoadedCase]

    @cached_property
    def tree(self) -> xr.DataTree:
        """The labelled results as one tree."""
        return xr.DataTree.from_dict(self.groups)


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
    progress: Callable[[], None] | None = None,
    **options: Any,
) -> Analysis:
    """Analyse a case's pair in mesh without friction, and keep the contact problems.

    Parameters
    ----------
    state
        The pair in mesh.
    torques, edge_contact, marking, solver, progress, **options
        As of ``analyze``.

    Raises
    ------
    InputError, GeometryError, MissingSolverError
        As ``analyze``.

    Examples
    --------
    >>> from easeoff.cases import read_case
    >>> coarse = {"mesh_positions": 2, "segments_per_line": 9, "lengthwise_nodes": 9, "profile_nodes": 7}
    >>> case = read_case("nasa-12x36")
    >>> case = case.model_copy(update={"contact": case.contact.model_copy(update=coarse)})
    >>> analysis = contact_analysis(CaseInMesh.of(case), [100.0])
    >>> [solved.solution.status.name for solved in analysis.cases]
    ['CERTIFIED', 'CERTIFIED']
    """
    case, cycle, geometry = state.case, state.cycle, state.cycle.geometry
    load = case_torques(case, torques)
    AnalysisSize.of(case, load.size).require_memory()
    edges = case.contact.edge_contact if edge_contact is None else edge_contact
    if state.deviations:
        require_line_contact(cycle.lost_contact, state.deviations)
    unloaded = cycle.unloaded(separation=case.contact.separation if marking is None else marking)
    loaded, cases = cycle.loaded(load, edge_contact=edges, solver=solver, progress=progress, **options)
    light, light_cases = cycle.loaded([LIGHT_LOAD_SHARE * load.max()], greater=cases)
    groups = {
        "/": xr.Dataset(attrs=_provenance(state, solver, edge_contact=edges)),
        "flanks": geometry.flanks,
        "ease_off": geometry.ease_off,
        "teeth": geometry.teeth,
        "unloaded": with_unloaded_numbers(cycle, unloaded),
        "light_load": with_loaded_numbers(cycle, light, light_cases),
        "loaded": with_loaded_numbers(cycle, loaded, cases),
    }
    if state.teeth is not None and case.compliance.model == "fe":
        sharp = [tooth.no_root for tooth in state.teeth if tooth.root is None]
        if sharp:
            groups["/"].attrs["root_stress_left_out"] = "; ".join(sharp)
        else:
            groups["root_stress"] = root_stress(cycle.fields, state.teeth, cases, loaded)
    return Analysis(groups, cases)


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
    marking: float | None = None,
    solver: SolverChoice = "auto",
    speed: Numbers | None = None,
    temperature: Numbers | None = None,
    roughness: Roughness | list[Roughness] | Array | None = None,
    oil: str | Lubricant | None = None,
    friction_model: FrictionModel | None = None,
    friction_feedback: bool | None = None,
    progress: Callable[[], None] | None = None,
    stage: Callable[[str], None] | None = None,
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
        Treatment of the deviations: ``ease_off`` updates the ease-off, ``surface`` computes with the deviating flanks.
    interpolation
        Between the nodes of measured grids and datasets: ``spline``, ``smooth`` or ``weighted_average``, see
        ``geometry.Deviation``.
    modification
        Added to the ease-off.
    edge_contact
        Whether tooth edges may touch beside the contact lines; as the case says if left out.
    marking
        Thickness of the marking compound of the unloaded pattern [um]; ``contact.separation`` of the case if left out.
    solver
        Name of a contact solver, see ``contact.available_solvers``; or one of your own: a ``contact.Solver``, a
        function, or ``module:function``.
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
        Called after every solved torque and mesh position, then after every part of the friction.
    stage
        Called with the name of what takes long before it begins: each elastic tooth, the loaded contact, the friction.
    **options
        Passed to the solver: ``tolerance``, ``time_limit``, ``max_iterations`` and what else ``contact.solve`` takes.

    Returns
    -------
    xr.DataTree
        Groups ``flanks``, ``ease_off``, ``teeth``, ``unloaded``, ``light_load`` (1 % of the greatest torque),
        ``loaded``; with finite elements ``root_stress``, unless a blade has no edge radius (the attribute
        ``root_stress_left_out`` says which); if a speed is given ``friction``; where it came from in the attributes.

    Raises
    ------
    InputError
        If an argument is out of range, the case has no such flanks, or the analysis needs more memory than is free.
    GeometryError
        If the settings describe no tooth in the blank, or flanks that do not meet, or if deviations scatter so much
        that there is no line contact.
    MissingSolverError
        If the solver's package is not installed.

    Examples
    --------
    >>> from easeoff.cases import read_case
    >>> coarse = {"mesh_positions": 2, "segments_per_line": 9, "lengthwise_nodes": 9, "profile_nodes": 7}
    >>> case = read_case("nasa-12x36")
    >>> case = case.model_copy(update={"contact": case.contact.model_copy(update=coarse)})
    >>> tree = analyze(case, torques=[100.0, 200.0], misalignment=Misalignment(offset=0.05))
    >>> tree["loaded/peak_to_peak"].sizes["torque"]
    2
    """
    case = checked_case(case)
    require_solver(solver)
    operation = operation_of(case.friction, speed=speed, temperature=temperature, roughness=roughness, oil=oil)
    friction_model, feedback = friction_settings(case, operation, friction_model, friction_feedback)
    load = case_torques(case, torques)  # a torque given twice shows before the work, too
    conditions = (0, 0, 0) if operation is None else operation.shape
    AnalysisSize.of(case, load.size, conditions, feedback=feedback).require_memory()
    if marking is not None:
        checked_thickness(marking)
    state = CaseInMesh.of(
        case,
        flank=flank,
        misalignment=misalignment,
        deviations=deviations,
        deviated=deviated,
        interpolation=interpolation,
        modification=modification,
        stage=stage,
    )
    if stage is not None:
        stage("loaded contact")
    found = contact_analysis(
        state, torques, edge_contact=edge_contact, marking=marking, solver=solver, progress=progress, **options
    )
    if operation is None:
        return found.tree
    return with_friction(
        found, operation, friction_model, feedback=feedback, solver=solver, progress=progress, stage=stage
    ).tree


def with_friction(
    found: Analysis,
    operation: Operation,
    model: FrictionModel | None = None,
    *,
    feedback: bool = False,
    solver: SolverChoice = "auto",
    progress: Callable[[], None] | None = None,
    stage: Callable[[str], None] | None = None,
) -> Analysis:
    """An analysis with the group ``friction`` added to it.

    Parameters
    ----------
    found
        The analysis.
    operation
        Operating conditions.
    model
        Models of friction coefficient, film and rolling; the dissertation's if left out.
    feedback, solver, progress, stage
        As ``friction_feedback`` and so on of ``analyze``.
    """
    from ..friction import friction
    from ..friction import friction_feedback as with_feedback

    if stage is not None:
        stage("friction")
    losses = (
        with_feedback(found.tree, found.cases, operation, model, solver=solver, progress=progress)
        if feedback
        else friction(found.tree, operation, model, progress=progress)
    )
    return Analysis({**found.groups, "friction": losses}, found.cases)


def friction_settings(
    case: Case, operation: Operation | None, model: FrictionModel | None, feedback: bool | None
) -> tuple[FrictionModel | None, bool]:
    """Friction models and whether friction is fed back: what is given, or else the case's own.

    Raises
    ------
    InputError
        If they are given without operating conditions, or the oil has no data for a temperature.

    Examples
    --------
    >>> from easeoff.cases import read_case
    >>> friction_settings(read_case("nasa-12x36"), None, None, None)
    (None, False)
    """
    if case.friction is not None:
        model = model or case.friction.model()
        feedback = case.friction.feedback if feedback is None else feedback
    if operation is not None:
        from ..friction import FrictionModel

        model = model or FrictionModel()
        model.oil_states(operation)  # a temperature the oil has no data for shows before the work, not after
    elif model is not None or feedback:
        raise InputError("speed = None: must be given [1/min] for friction_model and friction_feedback")
    return model, bool(feedback)


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

    Examples
    --------
    >>> operation_of(None, speed=1000.0, temperature=None).temperature
    90.0
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


def _provenance(state: CaseInMesh, solver: SolverChoice, *, edge_contact: bool) -> dict[str, Any]:
    """Origin of a result, as netCDF attributes."""
    flanks = (state.pair.pinion.opposite, state.pair.gear.opposite)
    return {
        **case_attributes(state.case, "analyze"),
        **state.attributes,
        "schema_version": RESULT_SCHEMA_VERSION,
        "solver": solver if isinstance(solver, str) else require_solver(solver),
        "compliance_model": state.case.compliance.model,
        "edge_contact": int(edge_contact),
        "opposite_flanks": "given" if all(flanks) else "assumed from the loaded ones",
    }
