"""Derivatives of power loss and efficiency: differences of the friction stage along the directions of its inputs.

Forces, lengths, radii and places of the loaded segments, points of action and axes have derivatives. Friction follows
from them in closed form: a contact's losses once ahead and once behind for every setting, and nothing is solved.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Any

import numpy as np
import xarray as xr
from numpy.typing import NDArray

from ...contact.evaluation.cycle_slopes import CycleSlopes
from ...contact.mesh_cycle import MeshCycle
from ...core.attributes import labelled

if TYPE_CHECKING:
    from ...friction import FrictionModel, Operation
    from ...friction.loaded_contacts import LoadedContacts

Array = NDArray[Any]

STEP = 1e-5  # of forces, sizes, places and points of action, relative to the greatest
SMALL_FORCE_STEP = 1e-3  # of each force, relative to itself: friction is no linear function of it
SHORTEST_STEP = 1e-3  # of ``STEP``, below which rounding rules
LEAST_SHARE = 1e-3  # of a small force that a step leaves
OF_LOSS = (
    *("mean_power_loss", "mean_sliding_loss", "mean_rolling_loss", "efficiency", "mean_friction_coefficient"),
    "input_power",
)


def loss_slopes(
    found: CycleSlopes, loaded: xr.Dataset, operation: Operation, model: FrictionModel
) -> tuple[xr.Dataset, xr.Dataset]:
    """Power loss, efficiency and mean friction coefficient, and their derivatives by settings, last by the torque.

    Parameters
    ----------
    found
        Derivatives of the mesh cycle.
    loaded
        From ``cycle.loaded``.
    operation
        Operating conditions.
    model
        Models of friction coefficient, film and rolling. What friction takes of the torque is not fed back.

    Examples
    --------
    >>> from easeoff.cases import read_case
    >>> from easeoff.friction import FrictionModel, Operation
    >>> from easeoff.geometry.pair.near_pair import PairSetting
    >>> from easeoff.study import CaseInMesh
    >>> coarse = {"mesh_positions": 3, "segments_per_line": 9, "lengthwise_nodes": 9, "profile_nodes": 7}
    >>> case = read_case("nasa-12x36")
    >>> state = CaseInMesh.of(case.model_copy(update={"contact": case.contact.model_copy(update=coarse)}))
    >>> loaded, cases = state.cycle.loaded([100.0])
    >>> found = CycleSlopes.of(state.cycle, [PairSetting("assembly", "offset")], cases)
    >>> values, slopes = loss_slopes(found, loaded, Operation(speed=1500.0), FrictionModel())
    >>> slopes["mean_power_loss"].dims
    ('torque', 'speed', 'temperature', 'roughness', 'setting')
    """
    from ...friction.efficiency import losses_dataset

    inputs = _FrictionInputs.of(found, loaded)
    values = loss_values(found.cycle, loaded, operation, model)
    columns: list[xr.Dataset] = []
    for number, step in enumerate(inputs.steps):
        ahead, behind = (
            losses_dataset(inputs.moved(number, sign * step), operation, model)[0][list(OF_LOSS)]
            for sign in (1.0, -1.0)
        )
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
    from ...friction.efficiency import losses_dataset

    values = losses_dataset(_contacts(cycle, loaded), operation, model)[0][list(OF_LOSS)]
    return labelled(values.assign_coords({"torque": loaded["torque"]}))


def _contacts(cycle: MeshCycle, loaded: xr.Dataset) -> LoadedContacts:
    from ...friction.loaded_contacts import loaded_contacts

    return loaded_contacts(xr.DataTree.from_dict({"ease_off": cycle.geometry.ease_off, "loaded": loaded}))


@dataclass(frozen=True)
class _FrictionInputs:
    """What friction takes of a mesh cycle, and how it changes with the settings, and last with the torque (j).

    Parameters
    ----------
    found
        Derivatives of the mesh cycle.
    contacts
        Loaded contacts (n).
    point
        Their places (2, n), as fractions on the gear.
    force, length, radius, place
        Derivatives of forces [N], lengths and radii [mm] (n, j), and of the places (2, n, j).
    """

    found: CycleSlopes
    contacts: LoadedContacts
    point: Array
    force: Array
    length: Array
    radius: Array
    place: Array

    @classmethod
    def of(cls, found: CycleSlopes, loaded: xr.Dataset) -> _FrictionInputs:
        """Of solved cases and their dataset."""
        parts = []
        for one in sorted(found.cases, key=lambda each: (each.case.torque, each.case.mesh_position)):
            own = one.case.solution.force > 0.0
            sizes = one.force[own], one.length[own], one.equivalent_radius[own], one.place[:, own]
            parts.append((one.case.segments.point[:, own], *sizes))
        point, force, length, radius, place = zip(*parts, strict=True)
        return cls(
            found,
            _contacts(found.cycle, loaded),
            np.concatenate(point, axis=1),
            np.concatenate(force),
            np.concatenate(length),
            np.concatenate(radius),
            np.concatenate(place, axis=1),
        )

    @property
    def steps(self) -> Array:
        """Steps (j) that change no input by more than ``STEP``, and no small force by much of it."""
        contacts, nodes = self.contacts, self.found.nodes
        sizes = [
            np.abs(self.force).max(axis=0) / contacts.force.max(),
            np.abs(self.length * 1e-3 / contacts.length[:, None]).max(axis=0),
            np.abs(self.radius * 1e-3 / contacts.equivalent_radius[:, None]).max(axis=0),
            np.abs(self.place).max(axis=(0, 1)),
            np.append(np.nanmax(np.abs(nodes["action_normal"]), axis=(0, 1, 2)), 0.0),
        ]
        steps = STEP / np.maximum(np.max(sizes, axis=0), 1e-300)
        own = np.abs(self.force / contacts.force[:, None]).max(axis=0)
        return np.asarray(np.clip(SMALL_FORCE_STEP / np.maximum(own, 1e-300), SHORTEST_STEP * steps, steps))

    def moved(self, setting: int, step: float) -> LoadedContacts:
        """The contacts after a step of one setting."""
        from ...friction.loaded_contacts import action_splines, axes_of, surface_velocities

        contacts, geometry = self.contacts, self.found.cycle.geometry
        told, torque = geometry.ease_off, contacts.torque
        if setting < len(self.found.settings):
            one = self.found.settings[setting]
            names = ("action_position", "action_normal", "roll_angle")
            changes = {name: step * self.found.nodes[name][..., setting] for name in names}
            order = ("lengthwise", "profile")
            told = told.transpose(*order, ...)
            told = told.assign({name: told[name].copy(data=told[name].values + c) for name, c in changes.items()})
            moved = one.moved(geometry.pair, step) if one.of == "assembly" else geometry.pair
            motion = replace(geometry.exact.motion, assembly=moved.assembly)
            origins = {"pinion_origin_mm": motion.assembly.pinion_origin, "gear_origin_mm": motion.assembly.gear_origin}
            told = told.assign_attrs(pinion_axis=motion.pinion_axis, gear_axis=motion.gear_axis, **origins)
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
            velocities=surface_velocities(axes_of(told), action_splines(told), points),
        )
