"""Derivatives of an analysis by machine and cutter settings, assembly errors, deviations and torque."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
import xarray as xr

from ...cases.deflection_table import MisalignmentSource
from ...cases.schema.case_schema import Case
from ...contact.evaluation.derivatives.cycle_slopes import CycleSlopes
from ...contact.solvers import Status
from ...core.attributes import labelled
from ...core.checks import shown
from ...core.errors import InputError
from ...core.processes.blas_threads import one_blas_thread
from ...core.suggestion import suggestion
from ...geometry.cutting.named_settings import MACHINE_STEPS, MODIFIED_ROLL_ORDERS
from ...geometry.pair.gear_pair import FlankName, GearPair
from ...geometry.pair.modification import TERM_POWERS, Modification
from ...geometry.pair.pair_setting import PairSetting, is_angle
from ..case_in_mesh import CaseInMesh, case_attributes, checked_case
from ..sweep.swept_quantity import swept_quantity
from .contact_analysis import case_torques
from .friction_analysis import friction_settings, operation_of

if TYPE_CHECKING:
    from ...friction import FrictionModel, Lubricant, Operation
    from ...friction.operation import Array, Numbers, Roughness

#: Keys of the cutter in a case file, and the settings of the blade that they are.
CUTTER_KEYS = {
    "blade_point_radius": "point_radius",
    "blade_pressure_angle": "pressure_angle",
    "blade_rake_angle": "rake_angle",
    "blade_hook_angle": "hook_angle",
    "blade_spheric_radius": "blade_curvature",
}
ERRORS = {"E": "offset", "P": "pinion_axial", "G": "gear_axial", "Sigma": "shaft_angle"}
SIDES = {"drive": {"pinion": "concave", "gear": "convex"}, "coast": {"pinion": "convex", "gear": "concave"}}


@dataclass(frozen=True)
class _Named:
    """A setting under the name that sweeps have for it; ``factor`` takes its derivative to the unit of the name."""

    name: str
    setting: PairSetting
    factor: float


def derivative_settings(pair: GearPair, flank: FlankName = "drive") -> list[str]:
    """Names of all settings by which an analysis of a pair can be differentiated, as sweeps have them.

    Examples
    --------
    >>> from easeoff.cases import gear_pair, read_case
    >>> names = derivative_settings(gear_pair(read_case("fm-11x41")))
    >>> names[0], "gear.convex.machine.ratio_of_roll" in names, names[-1]
    ('pinion.concave.machine.radial_distance', False, 'torque')
    """
    return [*(one.name for one in _settings(pair, flank)), "torque"]


def _settings(pair: GearPair, flank: FlankName) -> list[_Named]:
    found = []
    for member, side in SIDES[flank].items():
        surface = (pair.pinion if member == "pinion" else pair.gear).loaded.designed
        names = {f"machine.{name}": name for name in (*MACHINE_STEPS, *MODIFIED_ROLL_ORDERS)}
        names |= {f"cutter.{key}": name for key, name in CUTTER_KEYS.items()}
        for key, name in names.items():
            setting = PairSetting("pinion" if member == "pinion" else "gear", name)
            factor = math.radians(1.0) if is_angle(setting) else 1.0
            if name == "blade_curvature":
                radius = surface.blade.spheric_radius
                if radius is None:
                    continue  # a straight blade has no radius in the case
                factor = -1.0 / radius**2
            if setting.acts_on(pair):
                found.append(_Named(f"{member}.{side}.{key}", setting, factor))
    for name, error in ERRORS.items():
        found.append(_Named(name, PairSetting("assembly", error), math.radians(1.0) if name == "Sigma" else 1.0))
    return found


def _chosen(pair: GearPair, flank: FlankName, names: Sequence[str] | None) -> tuple[list[_Named], list[str]]:
    """The settings to differentiate by, and the names asked for, in their order."""
    known = {one.name: one for one in _settings(pair, flank)}
    known |= {
        f"modification.{term}": _Named(f"modification.{term}", PairSetting("modification", term), 1.0)
        for term in TERM_POWERS
    }
    wanted = list(derivative_settings(pair, flank)) if names is None else list(names)
    for name in wanted:
        if name not in known and name != "torque":
            raise InputError(
                f"setting = {shown(name)}: must be a machine or cutter setting of the {flank} flanks such as "
                f"{next(iter(known))}, E, P, G, Sigma, modification.TERM or torque"
                f"{suggestion(name, [*known, 'torque'])}"
            )
    if not wanted or len(set(wanted)) != len(wanted):
        raise InputError(f"settings = {shown(wanted)}: must be one or more names, none of them twice")
    # The torque comes with any other setting; alone it takes one along.
    return [known[name] for name in wanted if name != "torque"] or [next(iter(known.values()))], wanted


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
    >>> coarse = {"mesh_positions": 4, "segments_per_line": 9, "lengthwise_nodes": 9, "profile_nodes": 7}
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
    >>> coarse = {"mesh_positions": 4, "segments_per_line": 9, "lengthwise_nodes": 9, "profile_nodes": 7}
    >>> case = read_case("nasa-12x36")
    >>> case = case.model_copy(update={"contact": case.contact.model_copy(update=coarse)})
    >>> tree = contact_derivatives(CaseInMesh.of(case), ["E", "torque"], [100.0])
    >>> tree["values/transmission_error"].dims
    ('torque', 'mesh_position')
    """
    case, cycle = state.case, state.cycle
    if state.deflections is not None or case.supports is not None:
        raise InputError("derivatives need rigid supports: leave out [supports] and deflections over the torque")
    if state.deviations:
        raise InputError("derivatives need flanks without measured deviations: take modification.TERM for small ones")
    if case.compliance.model == "shell":
        raise InputError("compliance.model = 'shell': must be 'solid_shell' or 'fe' for derivatives")
    chosen, names = _chosen(state.pair, state.flank, settings)
    load = case_torques(case, torques)
    edges = case.contact.edge_contact if edge_contact is None else edge_contact
    loaded, cases = cycle.loaded(load, edge_contact=edges)
    if not all(one.solution.status == Status.CERTIFIED for one in cases):
        raise InputError(f"torques = {shown(load.tolist())}: must be such that every contact problem is certified")
    with_roots = case.compliance.model == "fe" and all(tooth.root is not None for tooth in state.teeth or ())
    roots = state.teeth if with_roots else None
    found = CycleSlopes.of(cycle, [one.setting for one in chosen], cases)
    values, slopes = found.datasets(loaded, roots)
    operation = operation or operation_of(case.friction)
    model, _ = friction_settings(case, operation, friction_model, None)
    if operation is not None:
        from ...friction import FrictionModel
        from .loss_slopes import loss_slopes

        of_loss = loss_slopes(found, loaded, operation, model or FrictionModel())
        values, slopes = (one.merge(other) for one, other in zip((values, slopes), of_loss, strict=True))
    order = [len(chosen) if name == "torque" else [one.name for one in chosen].index(name) for name in names]
    factors = xr.DataArray(np.array([*(one.factor for one in chosen), 1.0])[order], dims="setting")
    changes = (slopes.isel(setting=order) * factors).assign_coords(
        setting=("setting", names),
        setting_units=("setting", [swept_quantity(name).units for name in names]),
    )
    attributes: dict[str, Any] = {
        **case_attributes(case, "derivatives"),
        **state.attributes,
        "edge_contact": int(edges),
        "friction_feedback": 0,
        "held": "elastic teeth and tooth bodies",
    }
    changes = labelled(changes)
    for variable in changes.data_vars.values():
        variable.attrs["units"] += " per setting_units"
        variable.attrs["long_name"] = f"derivative of: {variable.attrs['long_name']}"
    return xr.DataTree.from_dict({"/": xr.Dataset(attrs=attributes), "values": values, "derivatives": changes})
