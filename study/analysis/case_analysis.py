"""The whole analysis of a case: geometry, unloaded contact, loaded contact, friction, as one tree.

Further keywords of an analysis: settings of its solver, told from misspelt arguments before any work.
"""

from __future__ import annotations

import difflib
import math
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import replace
from inspect import Parameter, signature
from os import PathLike
from pathlib import Path
from typing import TYPE_CHECKING, Any

import xarray as xr
from pydantic import BaseModel

from ...cases.analysis_size import KEPT_VALUES_LIMIT
from ...cases.deflection_table import MisalignmentSource
from ...cases.reading import with_supports
from ...cases.schema.case_schema import Case, ComplianceTable, ContactTable
from ...contact.backlash import backlash
from ...contact.solvers import SOLVERS, SolverChoice
from ...contact.solvers.registry import chosen_solver
from ...contact.solvers.solver_declaration import ChosenSolver
from ...contact.solvers.solver_limits import Limits
from ...core.checks import one_of, shown
from ...core.errors import GeometryError, InputError, suggestion
from ...geometry.deviation.deviation import Method
from ...geometry.pair.gear_pair import FlankName
from ...geometry.pair.modification import Modification
from ...geometry.tooth.tooth_flanks import MemberName
from ..case_in_mesh import CaseInMesh, FlanksInMesh, checked_case
from ..deviations import Deviated, Source
from ..progress import callback, shows_progress
from .contact_analysis import OVER_TORQUE, Analysis, contact_analysis, joined_analysis
from .operating import Friction, FrictionConditions, Operating, analysis_size

if TYPE_CHECKING:
    from ...contact.supports.assembly_rounds import AssemblyRounds
    from ...contact.supports.support import LoadedSupports
    from ...core.arrays import Array
    from ...friction import FrictionModel, Lubricant
    from ...friction.operation import Numbers, Roughness


def with_friction(
    analysis: Analysis,
    given: Friction | None,
    solver: SolverChoice = "auto",
    progress: Callable[[], None] | None = None,
    stage: Callable[[str], None] | None = None,
) -> Analysis:
    """An analysis with the group ``friction`` added, if there are operating conditions."""
    if given is None:
        return analysis
    if stage is not None:
        stage("friction")
    from ...friction import friction, friction_feedback

    def losses(part: Analysis, segment_fields: bool | None = None) -> xr.Dataset:
        tree = xr.DataTree.from_dict({name: part.groups[name] for name in ("ease_off", "loaded")})
        if given.feedback:
            return friction_feedback(tree, part.cases, given.operation, given.model, solver=solver, progress=progress)
        return friction(tree, given.operation, given.model, segment_fields=segment_fields, progress=progress)

    if not analysis.parts:
        return Analysis({**analysis.groups, "friction": losses(analysis)}, analysis.cases)
    # All parts keep fields over the segments, or none, by the size of the whole.
    loaded = analysis.groups["loaded"].sizes
    size = loaded["torque"] * loaded["mesh_position"] * loaded["segment"] * math.prod(given.operation.shape)
    parts = [
        (places, replace(part, groups={**part.groups, "friction": losses(part, size <= KEPT_VALUES_LIMIT)}))
        for places, part in analysis.parts
    ]
    return joined_analysis(parts, {name: group for name, group in analysis.groups.items() if name not in OVER_TORQUE})


def with_backlash(analysis: Analysis, state: CaseInMesh) -> Analysis:
    """An analysis with the group ``backlash``, or with the reason why there is none as an attribute."""
    groups = dict(analysis.groups)
    try:
        groups["backlash"] = backlash(state.cycle.geometry, groups["unloaded"])
    except GeometryError as error:
        groups["/"] = groups["/"].assign_attrs(backlash_left_out=str(error))
    return replace(analysis, groups=groups)


#: What ``contact.solve`` takes of an analysis, whichever solver it calls. Starts are those of the torque before.
OPTIONS = ("tolerance", "time_limit", "max_iterations", "polish", "form")
#: Tables of a case whose keys are no arguments.
TABLES: Mapping[str, type[BaseModel]] = {"contact": ContactTable, "compliance": ComplianceTable}
#: Likeness of an argument and a name that may be a setting of a solver, and least length of such a name.
LIKENESS, LENGTH_MINIMUM = 0.8, 5


def require_solver_options(
    options: Mapping[str, Any], solver: SolverChoice, function: Callable[..., Any]
) -> ChosenSolver:
    """Refuse keywords that no solver can mean, with the nearest argument of the called function; return the solver.

    The native solver takes ``OPTIONS`` and ``method``; for others only a name near an argument is refused.
    """
    chosen = chosen_solver(solver)
    native, name = chosen.is_native, chosen.name
    Limits(*(options.get(limit) for limit in OPTIONS[:3]))
    known = (*OPTIONS, "method") if native else (*OPTIONS, *_settings(name))
    words = [key for key, one in signature(function).parameters.items() if one.kind is not Parameter.VAR_KEYWORD]
    for option, value in options.items():
        if option in known:
            continue
        near = suggestion(option, [*words, *OPTIONS, *(("method",) if native else ())])
        table = next((key for key, fields in TABLES.items() if option in fields.model_fields), "")
        head = f"{option} = {shown(value)}: must be an argument of {function.__name__} or an option of its solver"
        if table:
            change = f'update={{"{table}": case.{table}.model_copy(update={{"{option}": ...}})}}'
            raise InputError(f"{head}; it is a key of the case's [{table}]: change it by case.model_copy({change})")
        if native or _is_near(option, words):
            raise InputError(head + (near or f"; native takes {', '.join(known)}"))
    if native and "method" in options:
        from ...contact.solvers.native import METHODS

        one_of("method", options["method"], ("cascade", *METHODS))
    return chosen


def _settings(name: str) -> tuple[str, ...]:
    """Settings of a solver that its table knows; there may be others."""
    if name not in SOLVERS:
        return ()
    entry = SOLVERS[name]
    return tuple(filter(None, (*entry.settings, entry.time_setting, entry.step_setting)))


def _is_near(option: str, words: Iterable[str]) -> bool:
    """True if a name is a misspelt argument rather than a setting that is not known here."""
    near = difflib.get_close_matches(option.lower(), words, n=1, cutoff=LIKENESS)
    return len(option) >= LENGTH_MINIMUM and bool(near)


@shows_progress("analysis", "solve")
def analyze(
    case: Case | str | Path,
    *,
    flank: FlankName = "drive",
    torques: float | Sequence[float] | None = None,
    misalignment: MisalignmentSource | None = None,
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
    supports: LoadedSupports | str | Path | None = None,
    rounds: AssemblyRounds | None = None,
    progress: Callable[[], None] | bool | None = None,
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
        Assembly errors, or ``cases.Deflections`` over the torque, or the path of a table of them; the case's own if
        left out.
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
    supports
        Shafts, bearings and housing: ``contact`` supports, the name of shipped ones, or the path of a file of them; the
        case's own if left out, and rigid if it has none.
    rounds
        How far the ease-off follows the assembly that the supports give under load, see ``MeshCycle.supported``; as the
        case says of its supports if left out.
    progress
        ``True`` for a line that shows it; or a function, called after every solved torque and mesh position, then after
        every part of the friction.
    stage
        Called with the name of what takes long before it begins: each elastic tooth, the loaded contact, the friction.
    **options
        Passed to the solver: ``tolerance``, ``time_limit``, ``max_iterations``, ``polish`` and ``form`` of
        ``contact.solve``, ``method`` of the native solver, settings of another one.

    Returns
    -------
    xr.DataTree
        Groups ``flanks``, ``ease_off``, ``teeth``, ``unloaded``, ``light_load`` (1 % of the greatest torque),
        ``misalignment``, ``loaded``; on supports ``supports``; with finite elements ``root_stress``, unless a blade has
        no edge radius (the attribute ``root_stress_left_out`` says which); if a speed is given ``friction``; where it
        came from in the attributes. Where the misalignment depends on the torque, ``flanks`` to ``unloaded`` are those
        without torque.

    Raises
    ------
    InputError
        If an argument is unknown or out of range, the case has no such flanks, or the analysis needs more memory than
        is free.
    GeometryError
        If the settings describe no tooth in the blank, or flanks that do not meet, or if deviations scatter so much
        that there is no line contact.
    MissingSolverError
        If the solver's package is not installed.

    Examples
    --------
    >>> from easeoff.cases import read_case
    >>> coarse = {"mesh_positions": 3, "segments_per_line": 9, "lengthwise_nodes": 9, "profile_nodes": 7}
    >>> case = read_case("nasa-12x36")
    >>> case = case.model_copy(update={"contact": case.contact.model_copy(update=coarse)})
    >>> from easeoff.geometry import Misalignment
    >>> tree = analyze(case, torques=[100.0, 200.0], misalignment=Misalignment(offset=0.05))
    >>> tree["loaded/peak_to_peak"].sizes["torque"]
    2
    """
    solver = require_solver_options(options, solver, analyze)
    case = checked_case(case)
    flanks = FlanksInMesh(flank, misalignment, deviations, deviated, interpolation, modification)
    conditions = FrictionConditions(speed, temperature, roughness, oil, friction_model, friction_feedback)
    if isinstance(supports, str | bytes | PathLike):
        case, supports = with_supports(case, supports), None
    operating = Operating(flanks, torques, edge_contact, marking, solver, conditions, supports, rounds)
    friction, load = conditions.of_case(case), operating.load(case)
    analysis_size(case, load.size, friction).require_memory()
    state = CaseInMesh.meshed(case, flanks, stage)
    if stage is not None:
        stage("loaded contact")
    report = callback(progress)
    analysis = with_backlash(contact_analysis(state, load, **operating.contact, progress=report, **options), state)
    return with_friction(analysis, friction, solver, report, stage).tree
