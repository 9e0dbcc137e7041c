"""Load distribution with the torque of friction: input power = output power + losses at every mesh position.

Friction takes part of the pinion's torque before it reaches the normal forces. With the forces F, lever arms r about
the gear axis and the ratio R, the input torque T holds

    T = sum F r / R + sum mu F f + rolling,

f the velocity of the pinion's surface along the sliding, per angular velocity. Friction does not deform the teeth here,
so the forces are those of the frictionless contact at a lower torque, and that torque alone is iterated. What friction
takes is nearly in proportion to the torque N that is left, so that N/(N + taken) of the input torque is left next.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import replace

import numpy as np
import xarray as xr

from ..contact.line_contact.line_contact_solution import solve_line_contacts
from ..contact.loaded import LoadedCase
from ..contact.solvers import SolverChoice, Status
from ..core.arrays import Array, Bools
from ..core.attributes import labelled
from ..core.checks import instance, instances
from .coefficient import CoefficientModel
from .efficiency import OPERATION, friction, losses, with_least_film
from .loaded_contacts import LoadedContacts, loaded_contacts, loaded_segments, potential_segments
from .operation import FrictionModel, Operation, checked_model

ITERATION_LIMIT = 30
TORQUE_TOLERANCE = 1e-11  # of the torque


def friction_torques(contacts: LoadedContacts, operation: Operation, model: FrictionModel) -> tuple[Array, Array]:
    """Torque that friction takes from the pinion, and what it gives to the gear over the ratio (t, k) [N m].

    Their difference is power loss over the pinion's angular velocity; rolling traction acts half on each surface,
    against its motion. One speed, temperature and roughness.
    """
    v = contacts.velocities
    # Surface speeds across the line as parts of the rolling velocity, to share the rolling loss by.
    share = 0.5 + 0.25 * v.sliding_across / model.rolling(v)
    pinion_arm, gear_arm = contacts.friction_arms
    torques, group = np.zeros((2, contacts.solved.size)), contacts.group
    for block in losses(contacts, operation, model):
        part = block.contacts
        force = block.coefficient[0, 0, 0] * contacts.force[part]
        drag = block.rolling_loss[0, 0, 0] / operation.angular_velocity[0]
        np.add.at(torques[0], group[part], force * pinion_arm[part] + drag * share[part])
        np.add.at(torques[1], group[part], force * gear_arm[part] - drag * (1.0 - share[part]))
    pinion, gear = torques.reshape(2, *contacts.solved.shape)
    return pinion, gear


def _solved_again(
    cases: Sequence[LoadedCase], torque: Array, due: Bools, loaded: xr.Dataset, ratio: float, solver: SolverChoice
) -> xr.Dataset:
    """The loaded contact with other pinion torques (t, k) [N m] at the cases that are due."""
    result = loaded.copy(deep=True)
    if not np.any(due):
        return result
    force, status = (result[name].values for name in ("force", "status"))
    chosen = [case for case in cases if due[case.torque, case.mesh_position]]
    at = [(case.torque, case.mesh_position) for case in chosen]
    torques = [1e3 * ratio * float(torque[i]) for i in at]
    problems = [c.segments.bending_problem.with_torque(one) for c, one in zip(chosen, torques, strict=True)]
    starts = [force[i][: case.segments.pair.size].copy() for case, i in zip(chosen, at, strict=True)]
    contacts = [case.segments.line_contact for case in chosen]
    solved = solve_line_contacts(problems, contacts, starts, solver)
    for i, start, (solution, _) in zip(at, starts, solved, strict=True):
        status[i] = solution.status
        force[i][: start.size] = solution.force
    return result


def _one_operation(
    tree: xr.DataTree, cases: Sequence[LoadedCase], operation: Operation, model: FrictionModel, solver: SolverChoice
) -> xr.Dataset:
    """Friction with feedback at one speed, temperature and roughness."""
    loaded = loaded_segments(tree)
    ratio = float(tree["ease_off"].attrs["ratio"])
    potential = potential_segments(tree)
    contacts = loaded_contacts(tree, potential)
    given = np.broadcast_to(contacts.torque[:, None], contacts.solved.shape)
    effective, current = given, tree
    for count in range(ITERATION_LIMIT + 1):
        taken, _ = friction_torques(contacts, operation, model)
        moving = contacts.solved & (np.abs(given - taken - effective) > TORQUE_TOLERANCE * given)
        if not np.any(moving):
            break
        # Where friction drives the pinion faster than the forces hold it, and where the iteration does not end: NaN.
        failed = moving & ((effective + taken <= 0.0) | (count == ITERATION_LIMIT))
        with np.errstate(divide="ignore", invalid="ignore"):
            wanted = given * effective / (effective + taken)
        loaded = _solved_again(cases, wanted, moving & ~failed, loaded, ratio, solver)
        loaded["status"].values[failed] = Status.NOT_CONVERGED
        loaded["force"].values[failed] = np.nan
        effective = np.where(moving, wanted, effective)
        current = tree.assign({"loaded": xr.DataTree(loaded)})
        contacts = loaded_contacts(current, potential)
    taken, passed = friction_torques(contacts, operation, model)
    # What the normal forces carry over, from the forces themselves.
    carried = 1e-3 * (loaded["force"] * loaded["lever_arm"]).sum("segment").values / ratio
    output = np.where(contacts.solved, ratio * (carried + passed), np.nan)
    result = friction(current, operation, model, segment_fields=True)
    # The forces go with the roughness here, and the film with the forces.
    result["film_thickness"] = result["film_thickness"].expand_dims("roughness", axis=-1)
    result["pressure_velocity"] = result["pressure_velocity"].expand_dims(["temperature", "roughness"], axis=[4, 5])
    result = with_least_film(result, loaded)
    result["force"] = loaded["force"].expand_dims(dict.fromkeys(OPERATION, 1), axis=[3, 4, 5])
    mesh = ("torque", "mesh_position", *OPERATION)
    result["output_torque"] = (mesh, output[..., None, None, None])
    result["status"] = (mesh, loaded["status"].values[..., None, None, None], Status.flag_attributes())
    power_in = given * operation.angular_velocity[0]
    power_out = output * operation.angular_velocity[0] / ratio
    loss = result["mesh_power_loss"].values[..., 0, 0, 0]
    result["energy_balance"] = (mesh, ((power_in - power_out - loss) / power_in)[..., None, None, None])
    return result


def friction_feedback(
    tree: xr.DataTree,
    cases: Sequence[LoadedCase],
    operation: Operation,
    model: FrictionModel | str | float | CoefficientModel | None = None,
    *,
    solver: SolverChoice = "auto",
    progress: Callable[[], None] | None = None,
) -> xr.Dataset:
    """Friction and efficiency as ``friction``, with loads that balance the torque of friction, too.

    Parameters
    ----------
    tree, cases
        Of ``study.analysis.contact_analysis``.
    operation
        Speeds, temperatures, roughnesses; the contact is solved anew for every combination.
    model
        As in ``friction``.
    solver
        Of the contact problem.
    progress
        Called after every combination.

    Returns
    -------
    xr.Dataset
        The variables of ``friction``, the film's thickness at each roughness too, and ``force``, ``output_torque``,
        ``energy_balance``: input power less output power less losses, over the input power, and ``status``.

    Raises
    ------
    InputError
        As ``friction``.

    Examples
    --------
    As an option of an analysis:

    >>> import easeoff
    >>> case = easeoff.read_case("nasa-12x36")
    >>> coarse = {"mesh_positions": 4, "lengthwise_nodes": 21, "profile_nodes": 15}
    >>> case = case.model_copy(update={"contact": case.contact.model_copy(update=coarse)})
    >>> losses = easeoff.analyze(case, torques=200.0, speed=1500.0, friction_feedback=True)["friction"]
    >>> bool(abs(losses["energy_balance"]).max() < 1e-9)
    True
    """
    model = checked_model(operation, model)
    instances("cases", cases, LoadedCase)
    instance("progress", progress, Callable | None)

    def at(speed: float, temperature: float, roughness: Array) -> xr.Dataset:
        pair = (float(roughness[0]), float(roughness[1]))
        one = replace(operation, speed=speed, temperature=temperature, roughness=pair)
        result = _one_operation(tree, cases, one, model, solver)
        if progress is not None:
            progress()
        return result

    def joined(results: list[xr.Dataset], dimension: str) -> xr.Dataset:
        return xr.concat(results, dimension, data_vars="minimal", coords="minimal", compat="override", join="override")

    def at_speed(speed: float) -> xr.Dataset:
        each = [joined([at(speed, t, r) for r in operation.roughnesses], "roughness") for t in operation.temperatures]
        return joined(each, "temperature")

    return labelled(joined([at_speed(speed) for speed in operation.speeds], "speed"))
