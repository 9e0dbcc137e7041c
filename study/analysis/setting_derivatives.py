"""Derivatives of an analysis by machine and cutter settings, assembly errors, deviations and torque."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

import xarray as xr

from ...cases.deflection_table import MisalignmentSource
from ...cases.schema.case_schema import Case
from ...core.checks import instance
from ...core.process_settings import one_blas_thread
from ...geometry.pair.gear_pair import FlankName
from ...geometry.pair.modification import Modification
from ..case_in_mesh import CaseInMesh, case_attributes, checked_case
from .friction_analysis import friction_settings, operation_of
from .named_setting import chosen_settings
from .solved_contact import SolvedContact

if TYPE_CHECKING:
    from ...friction import FrictionModel, Lubricant, Operation
    from ...friction.operation import Array, Numbers, Roughness


def derivatives(
    case: Case | str | Path,
    settings: Sequence[str] | None = None,
    *,
    flank: FlankName = "drive",
    torques: float | Sequence[float] | None = None,
    misalignment: MisalignmentSource | None = None,
    modification: Modification | None = None,
    edge_contact: bool | None = None,
    speed: Numbers | None = None,
    temperature: Numbers | None = None,
    roughness: Roughness | list[Roughness] | Array | None = None,
    oil: str | Lubricant | None = None,
    friction_model: FrictionModel | None = None,
) -> xr.DataTree:
    """Differentiate an analysis of a case by settings, assembly errors, deviations and torque.

    Supports are rigid; the elastic teeth are held. See `Derivatives of an analysis
    <../python/derivatives.html>`_.

    Parameters
    ----------
    case
        A checked case, or what ``read_case`` takes.
    settings
        Names as of ``sweep``: dotted keys of machine and cutter settings of the flanks in mesh, ``E``, ``P``, ``G``,
        ``Sigma``, ``modification.TERM`` and ``torque``; all of ``derivative_settings`` if left out.
    flank, torques, misalignment, modification, edge_contact, speed, temperature, roughness, oil, friction_model
        As of ``analyze``. What friction takes of the torque is not fed back.

    Returns
    -------
    xr.DataTree
        ``values`` with ease-off and roll angle, unloaded and loaded transmission error and their numbers, load shares,
        forces, pressures, centre and extent of the load; with finite elements root stresses, with a speed losses;
        ``derivatives`` with the same variables over ``setting`` as well, in their units per ``setting_units``. NaN
        where the contact has a kink.

    Raises
    ------
    InputError
        If there is no such setting, or the case has what derivatives do not cover.
    GeometryError
        As ``analyze``; or if a contact line ends at a hole of the flank.

    Examples
    --------
    >>> from easeoff.cases import read_case
    >>> coarse = {"mesh_positions": 3, "segments_per_line": 9, "lengthwise_nodes": 9, "profile_nodes": 7}
    >>> case = read_case("nasa-12x36")
    >>> case = case.model_copy(update={"contact": case.contact.model_copy(update=coarse)})
    >>> tree = derivatives(case, ["pinion.concave.machine.radial_distance", "Sigma", "torque"], torques=[100.0])
    >>> tree["derivatives/peak_to_peak"].dims, tree["derivatives/setting_units"].values.tolist()
    (('torque', 'setting'), ['mm', 'degree', 'N m'])
    """
    case = checked_case(case)
    operation = operation_of(case.friction, speed=speed, temperature=temperature, roughness=roughness, oil=oil)
    friction_model, _ = friction_settings(case, operation, friction_model, None)
    state = CaseInMesh.of(case, flank=flank, misalignment=misalignment, modification=modification)
    given: dict[str, Any] = {"edge_contact": edge_contact, "operation": operation, "friction_model": friction_model}
    return contact_derivatives(state, settings, torques, **given)


@one_blas_thread()
def contact_derivatives(
    state: CaseInMesh,
    settings: Sequence[str] | None = None,
    torques: float | Sequence[float] | None = None,
    *,
    edge_contact: bool | None = None,
    operation: Operation | None = None,
    friction_model: FrictionModel | None = None,
) -> xr.DataTree:
    """Differentiate the contact of a pair in mesh.

    Parameters
    ----------
    state
        A case in mesh.
    settings, torques, edge_contact
        As of ``derivatives``, which tells what is returned and raised as well.
    operation
        Operating conditions of friction; the case's own if left out.
    friction_model
        Models of friction; the case's own or the dissertation's if left out.

    Examples
    --------
    >>> from easeoff.cases import read_case
    >>> coarse = {"mesh_positions": 3, "segments_per_line": 9, "lengthwise_nodes": 9, "profile_nodes": 7}
    >>> case = read_case("nasa-12x36")
    >>> case = case.model_copy(update={"contact": case.contact.model_copy(update=coarse)})
    >>> tree = contact_derivatives(CaseInMesh.of(case), ["E", "torque"], [100.0])
    >>> tree["values/transmission_error"].dims
    ('torque', 'mesh_position')
    """
    instance("state", state, CaseInMesh)
    given: dict[str, Any] = {"edge_contact": edge_contact, "operation": operation, "friction_model": friction_model}
    chosen_settings(state.pair, state.flank, settings)  # refused before anything is solved
    solved = SolvedContact.of(state, torques, **given)
    values, changes = solved.differentiated(settings)
    attributes: dict[str, Any] = {
        **case_attributes(state.case, "derivatives"),
        **state.attributes,
        "edge_contact": int(solved.edge_contact),
        "friction_feedback": 0,
        "held": "elastic teeth and tooth bodies",
    }
    return xr.DataTree.from_dict({"/": xr.Dataset(attrs=attributes), "values": values, "derivatives": changes})
