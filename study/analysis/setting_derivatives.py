"""Derivatives of an analysis by machine and cutter settings, assembly errors, deviations and torque.

The settings bear the names that sweeps have for them. A pair is solved in mesh as in its analysis; derivatives are made
when they are asked for. Forces, lengths, radii and places of the loaded segments, points of action and axes have
derivatives. Friction follows from these inputs in closed form: a contact's losses once ahead and once behind for every
setting, and nothing is solved.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
import xarray as xr

from ...cases.deflection_table import MisalignmentSource
from ...cases.deflections import ERROR_FIELDS
from ...cases.schema.case_schema import Case
from ...contact.compliance.finite_elements.finite_element_tooth import FiniteElementTooth
from ...contact.evaluation.cycle_slopes import CycleSlopes, cycle_values
from ...contact.evaluation.unloaded_slopes import unloaded_slopes
from ...contact.loaded import LoadedCase
from ...contact.mesh_cycle import MeshCycle
from ...contact.solvers import Status
from ...core.attributes import labelled
from ...core.checks import instance, one_of, shown, truth, words
from ...core.errors import InputError, suggestion
from ...core.process_settings import one_blas_thread
from ...geometry.cutting.named_settings import MACHINE_STEPS, MODIFIED_ROLL_ORDERS
from ...geometry.pair.gear_pair import FlankName, GearPair
from ...geometry.pair.modification import TERM_POWERS, Modification
from ...geometry.pair.near_pair import PairSetting, is_angle
from ..case_in_mesh import CaseInMesh, case_attributes, checked_case
from .contact_analysis import case_torques
from .operating import Friction, FrictionConditions, friction_of
from .swept_quantity import swept_quantity

if TYPE_CHECKING:
    from ...core.arrays import Array
    from ...friction import FrictionModel, Lubricant, Operation
    from ...friction.loaded_contacts import LoadedContacts
    from ...friction.operation import Numbers, Roughness

#: Keys of the cutter in a case file, and the settings of the blade that they are.
CUTTER_KEYS = {
    "blade_point_radius": "point_radius",
    "blade_pressure_angle": "pressure_angle",
    "blade_rake_angle": "rake_angle",
    "blade_hook_angle": "hook_angle",
    "blade_spheric_radius": "blade_curvature",
}
SIDES = {"drive": {"pinion": "concave", "gear": "convex"}, "coast": {"pinion": "convex", "gear": "concave"}}


@dataclass(frozen=True)
class NamedSetting:
    """A setting under the name that sweeps have for it."""

    name: str
    setting: PairSetting
    factor: float  # from the derivative by the setting to that in the unit of the name


def derivative_settings(pair: GearPair, flank: FlankName = "drive") -> list[str]:
    """Names of all settings by which an analysis of a pair can be differentiated, as sweeps have them.

    Examples
    --------
    >>> from easeoff.cases import gear_pair, read_case
    >>> names = derivative_settings(gear_pair(read_case("fm-11x41")))
    >>> names[0], "gear.convex.machine.ratio_of_roll" in names, names[-1]
    ('pinion.concave.machine.radial_distance', False, 'torque')
    """
    instance("pair", pair, GearPair)
    return [*(one.name for one in _settings(pair, flank)), "torque"]


def _settings(pair: GearPair, flank: FlankName) -> list[NamedSetting]:
    settings = []
    for member, side in SIDES[one_of("flank", flank, SIDES)].items():
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
                settings.append(NamedSetting(f"{member}.{side}.{key}", setting, factor))
    for name, error in ERROR_FIELDS.items():
        factor = math.radians(1.0) if name == "Sigma" else 1.0
        settings.append(NamedSetting(name, PairSetting("assembly", error), factor))
    return settings


def chosen_settings(
    pair: GearPair, flank: FlankName, names: Sequence[str] | None
) -> tuple[list[NamedSetting], list[str]]:
    """Settings of ``derivative_settings``, all or by name, or ``modification.TERM``; and the names asked for."""
    known = {one.name: one for one in _settings(pair, flank)}
    terms = {f"modification.{term}": PairSetting("modification", term) for term in TERM_POWERS}
    known |= {name: NamedSetting(name, setting, 1.0) for name, setting in terms.items()}
    wanted = list(derivative_settings(pair, flank)) if names is None else list(words("settings", names))
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


@dataclass(frozen=True, eq=False)
class SolvedContact:
    """Contact problems of a pair in mesh, solved and certified; ``of`` makes it."""

    state: CaseInMesh
    loaded: xr.Dataset
    cases: list[LoadedCase]
    edge_contact: bool
    friction: Friction | None  # without it no losses

    @classmethod
    @one_blas_thread()
    def of(
        cls,
        state: CaseInMesh,
        torques: float | Sequence[float] | None = None,
        *,
        edge_contact: bool | None = None,
        operation: Operation | None = None,
        friction_model: FrictionModel | None = None,
    ) -> SolvedContact:
        """Solve the contact; arguments and errors as of ``contact_derivatives``."""
        case = state.case
        if state.deflections is not None or case.supports is not None:
            raise InputError("derivatives need rigid supports: leave out [supports] and deflections over the torque")
        if state.deviations:
            raise InputError(
                "derivatives need flanks without measured deviations: take modification.TERM for small ones"
            )
        if case.compliance.model == "shell":
            raise InputError("compliance.model = 'shell': must be 'solid_shell' or 'fe' for derivatives")
        load = case_torques(case, torques)
        edges = case.contact.edge_contact if edge_contact is None else truth("edge_contact", edge_contact)
        loaded, cases = state.cycle.loaded(load, edge_contact=edges)
        if not all(one.solution.status == Status.CERTIFIED for one in cases):
            raise InputError(f"torques = {shown(load.tolist())}: must be such that every contact problem is certified")
        return cls(state, loaded, cases, edges, friction_of(case, operation, friction_model))

    def values(self, *, unloaded: bool = True) -> xr.Dataset:
        """The ``values`` of ``contact_derivatives``; those without load only if asked."""
        cycle = self.state.cycle
        errors = unloaded_slopes(cycle.geometry, cycle.lines, (), {}) if unloaded else None
        values = cycle_values(cycle, self.loaded, self.cases, self._roots, errors)
        if self.friction is None:
            return values
        return values.merge(loss_values(cycle, self.loaded, self.friction.operation, self.friction.model))

    @one_blas_thread()
    def differentiated(
        self, settings: Sequence[str] | None = None, *, unloaded: bool = True
    ) -> tuple[xr.Dataset, xr.Dataset]:
        """Values and derivatives, as ``contact_derivatives`` has them; without load only if asked."""
        chosen, names = chosen_settings(self.state.pair, self.state.flank, settings)
        cycle_slopes = CycleSlopes.of(self.state.cycle, [one.setting for one in chosen], self.cases)
        values, slopes = cycle_slopes.datasets(self.loaded, self._roots, unloaded=unloaded)
        if self.friction is not None:
            of_loss = loss_slopes(cycle_slopes, self.loaded, self.friction.operation, self.friction.model)
            values, slopes = (one.merge(other) for one, other in zip((values, slopes), of_loss, strict=True))
        order = [len(chosen) if name == "torque" else [one.name for one in chosen].index(name) for name in names]
        factors = xr.DataArray(np.array([*(one.factor for one in chosen), 1.0])[order], dims="setting")
        units = [swept_quantity(name).units for name in names]
        changes = (slopes.isel(setting=order) * factors).assign_coords(setting=("setting", names))
        changes = labelled(changes.assign_coords(setting_units=("setting", units)))
        for variable in changes.data_vars.values():
            variable.attrs["units"] += " per setting_units"
            variable.attrs["long_name"] = f"derivative of: {variable.attrs['long_name']}"
        return values, changes

    @property
    def _roots(self) -> tuple[FiniteElementTooth, FiniteElementTooth] | None:
        """Teeth whose root stress is known."""
        teeth = self.state.teeth
        with_roots = self.state.case.compliance.model == "fe" and all(tooth.root is not None for tooth in teeth or ())
        return teeth if with_roots else None


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
    friction = FrictionConditions(speed, temperature, roughness, oil, friction_model).of_case(case)
    state = CaseInMesh.of(case, flank=flank, misalignment=misalignment, modification=modification)
    operation, model = (None, None) if friction is None else (friction.operation, friction.model)
    return contact_derivatives(
        state, settings, torques, edge_contact=edge_contact, operation=operation, friction_model=model
    )


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
    chosen_settings(state.pair, state.flank, settings)  # refused before anything is solved
    solved = SolvedContact.of(
        state, torques, edge_contact=edge_contact, operation=operation, friction_model=friction_model
    )
    values, changes = solved.differentiated(settings)
    attributes: dict[str, Any] = {
        **case_attributes(state.case, "derivatives"),
        **state.attributes,
        "edge_contact": int(solved.edge_contact),
        "friction_feedback": 0,
        "held": "elastic teeth and tooth bodies",
    }
    return xr.DataTree.from_dict({"/": xr.Dataset(attrs=attributes), "values": values, "derivatives": changes})


STEP = 1e-5  # of forces, sizes, places and points of action, relative to the greatest
SMALL_FORCE_STEP = 1e-3  # of each force, relative to itself: friction is no linear function of it
SHORTEST_STEP = 1e-3  # of ``STEP``, below which rounding rules
LEAST_SHARE = 1e-3  # of a small force that a step leaves
OF_LOSS = (
    "mean_power_loss",
    "mean_sliding_loss",
    "mean_rolling_loss",
    "efficiency",
    "mean_friction_coefficient",
    "input_power",
)


def loss_slopes(
    cycle: CycleSlopes, loaded: xr.Dataset, operation: Operation, model: FrictionModel
) -> tuple[xr.Dataset, xr.Dataset]:
    """Power loss, efficiency and mean friction coefficient, and their derivatives by settings, last by the torque.

    The torque that friction takes is not fed back.
    """
    inputs = _FrictionInputs.of(cycle, loaded)
    values = loss_values(cycle.cycle, loaded, operation, model)
    columns: list[xr.Dataset] = []
    for number, step in enumerate(inputs.steps):
        ahead, behind = (_losses(inputs.moved(number, sign * step), operation, model) for sign in (1.0, -1.0))
        columns.append((ahead - behind) / (2.0 * step))
    slopes = xr.concat(columns, "setting")
    # Of the small loss, not of a number near one, whose rounding a short step makes large.
    share = values["mean_power_loss"] / values["input_power"]
    of_efficiency = (share * slopes["input_power"] - slopes["mean_power_loss"]) / values["input_power"]
    slopes["efficiency"] = of_efficiency.assign_attrs(values["efficiency"].attrs)
    slopes = slopes.transpose(*values["efficiency"].dims, "setting")
    return values, slopes.assign_coords({"torque": loaded["torque"]})


def loss_values(cycle: MeshCycle, loaded: xr.Dataset, operation: Operation, model: FrictionModel) -> xr.Dataset:
    """The values alone; arguments as of ``loss_slopes``."""
    values = _losses(_contacts(cycle, loaded), operation, model)
    return labelled(values.assign_coords({"torque": loaded["torque"]}))


def _losses(contacts: LoadedContacts, operation: Operation, model: FrictionModel) -> xr.Dataset:
    from ...friction.efficiency import losses_dataset

    return losses_dataset(contacts, operation, model)[0][list(OF_LOSS)]


def _contacts(cycle: MeshCycle, loaded: xr.Dataset) -> LoadedContacts:
    from ...friction.loaded_contacts import loaded_contacts

    return loaded_contacts(xr.DataTree.from_dict({"ease_off": cycle.geometry.ease_off, "loaded": loaded}))


@dataclass(frozen=True)
class _FrictionInputs:
    """Inputs of friction from a mesh cycle, with their derivatives by the settings, and last by the torque (j)."""

    slopes: CycleSlopes
    contacts: LoadedContacts
    point: Array  # (2, n), as fractions of the gear flank
    force: Array  # derivatives (n, j) of forces [N]
    length: Array  # (n, j) of lengths [mm]
    radius: Array  # (n, j) of radii [mm]
    place: Array

    @classmethod
    def of(cls, slopes: CycleSlopes, loaded: xr.Dataset) -> _FrictionInputs:
        """Of solved cases and their dataset."""
        parts = []
        for one in sorted(slopes.cases, key=lambda each: (each.case.torque, each.case.mesh_position)):
            segments = one.case.solution.force > 0.0
            known = one.force[segments], one.length[segments], one.equivalent_radius[segments], one.place[:, segments]
            parts.append((one.case.segments.point[:, segments], *known))
        point, *by_segment, place = zip(*parts, strict=True)
        force, length, radius = (np.concatenate(each) for each in by_segment)
        return cls(slopes, _contacts(slopes.cycle, loaded), np.hstack(point), force, length, radius, np.hstack(place))

    @property
    def steps(self) -> Array:
        """Steps (j) that change no input by more than ``STEP``, and no small force by much of it."""
        contacts, nodes = self.contacts, self.slopes.nodes
        sizes = [
            np.abs(self.force).max(axis=0) / contacts.force.max(),
            np.abs(self.length * 1e-3 / contacts.length[:, None]).max(axis=0),
            np.abs(self.radius * 1e-3 / contacts.equivalent_radius[:, None]).max(axis=0),
            np.abs(self.place).max(axis=(0, 1)),
            np.append(np.nanmax(np.abs(nodes["action_normal"]), axis=(0, 1, 2)), 0.0),
        ]
        steps = STEP / np.maximum(np.max(sizes, axis=0), 1e-300)
        force_changes = np.abs(self.force / contacts.force[:, None]).max(axis=0)
        return np.asarray(np.clip(SMALL_FORCE_STEP / np.maximum(force_changes, 1e-300), SHORTEST_STEP * steps, steps))

    def moved(self, setting: int, step: float) -> LoadedContacts:
        """The contacts after a step of one setting."""
        from ...friction.loaded_contacts import action_splines, axes_of, surface_velocities

        contacts, geometry = self.contacts, self.slopes.cycle.geometry
        ease_off, torque = geometry.ease_off, contacts.torque
        if setting < len(self.slopes.settings):
            one = self.slopes.settings[setting]
            names = ("action_position", "action_normal", "roll_angle")
            changes = {name: step * self.slopes.nodes[name][..., setting] for name in names}
            ease_off = ease_off.transpose("lengthwise", "profile", ...)
            moved_points = {name: ease_off[name].copy(data=ease_off[name].values + c) for name, c in changes.items()}
            ease_off = ease_off.assign(moved_points)
            moved = one.moved(geometry.pair, step) if one.of == "assembly" else geometry.pair
            motion = replace(geometry.exact.motion, assembly=moved.assembly)
            origins = {"pinion_origin_mm": motion.assembly.pinion_origin, "gear_origin_mm": motion.assembly.gear_origin}
            ease_off = ease_off.assign_attrs(pinion_axis=motion.pinion_axis, gear_axis=motion.gear_axis, **origins)
        else:
            torque = torque + step
        force = np.maximum(contacts.force + step * self.force[:, setting], LEAST_SHARE * contacts.force)
        length = contacts.length + 1e-3 * step * self.length[:, setting]
        radius = contacts.equivalent_radius + 1e-3 * step * self.radius[:, setting]
        grown = force / contacts.force * contacts.length / length * contacts.equivalent_radius / radius
        points = self.point + step * self.place[..., setting]
        return replace(
            contacts,
            torque=torque,
            force=force,
            length=length,
            equivalent_radius=radius,
            hertz_pressure=contacts.hertz_pressure * np.sqrt(grown),
            velocities=surface_velocities(axes_of(ease_off), action_splines(ease_off), points),
        )
