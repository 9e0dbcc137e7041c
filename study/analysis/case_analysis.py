"""The whole analysis of a case: geometry, unloaded contact, loaded contact, friction, as one tree."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from os import PathLike
from pathlib import Path
from typing import TYPE_CHECKING, Any

import xarray as xr

from ...cases.analysis_size import AnalysisSize
from ...cases.deflection_table import MisalignmentSource
from ...cases.reading import with_supports
from ...cases.schema.case_schema import Case
from ...contact.evaluation.marking_print import checked_thickness
from ...contact.solvers import SolverChoice
from ...core.checks import instance
from ...geometry.deviation.deviation import Method
from ...geometry.pair.gear_pair import FlankName
from ...geometry.pair.modification import Modification
from ...geometry.tooth.tooth_flanks import MemberName
from ..case_in_mesh import CaseInMesh, checked_case, require_kinds
from ..deviations.deviation_source import Deviated, Source
from .contact_analysis import case_torques, contact_analysis
from .friction_analysis import friction_settings, operation_of, with_friction
from .shown_progress import shows_progress, told
from .solver_options import require_solver_options

if TYPE_CHECKING:
    from ...contact.supports.assembly_rounds import AssemblyRounds
    from ...contact.supports.support import LoadedSupports
    from ...friction import FrictionModel, Lubricant
    from ...friction.operation import Array, Numbers, Roughness


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
    require_solver_options(options, solver, analyze)
    case = checked_case(case)
    require_kinds(
        deviations=deviations,
        modification=modification,
        edge_contact=edge_contact,
        friction_feedback=friction_feedback,
    )
    if isinstance(supports, str | bytes | PathLike):
        case, supports = with_supports(case, supports), None
    if supports is not None or rounds is not None:
        from ...contact.supports.assembly_rounds import AssemblyRounds
        from ...contact.supports.support import LoadedSupports

        instance("supports", supports, LoadedSupports | None)
        instance("rounds", rounds, AssemblyRounds | None)
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
        state,
        torques,
        edge_contact=edge_contact,
        marking=marking,
        solver=solver,
        supports=supports,
        rounds=rounds,
        progress=told(progress),
        **options,
    )
    if operation is None:
        return found.tree
    return with_friction(
        found, operation, friction_model, feedback=feedback, solver=solver, progress=told(progress), stage=stage
    ).tree
