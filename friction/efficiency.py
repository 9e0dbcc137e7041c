"""Power loss and efficiency of a pair, from a stored result: the group ``/friction``.

With the least film thickness of the mesh cycle, and where it is.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
import xarray as xr

from ..core.arrays import Array
from ..core.attributes import labelled
from ..core.checks import instance
from .coefficient import CoefficientModel
from .kolivand_formula import FLAGS, LossShares
from .loaded_contacts import LoadedContacts, PotentialSegments, loaded_contacts, potential_segments
from .losses import HottestContacts, losses
from .lubricants.lubricant import lubricant
from .operation import FrictionModel, Operation, checked_model

KEPT_VALUES_LIMIT = 3_000_000  # of a field over segments that is kept without being asked for
FORMULA_OIL = "75w90"  # of the dissertation's formula
OIL_TOLERANCE = 0.02  # of viscosity and pressure-viscosity coefficient, within which an oil is the formula's
OPERATION = ("speed", "temperature", "roughness")
THERMAL_PROPERTIES = ("conductivity", "density", "heat_capacity")  # of pinion and gear, in SI
FIELDS = ("friction_coefficient", "lambda_ratio", "power_loss", "flash_temperature")  # over all conditions


def friction(
    tree: xr.DataTree,
    operation: Operation,
    model: FrictionModel | str | float | CoefficientModel | None = None,
    *,
    segment_fields: bool | None = None,
    progress: Callable[[], None] | None = None,
) -> xr.Dataset:
    """Friction, power loss and efficiency of a result at every combination of speed, temperature and roughness.

    The load distribution is that of the result, without friction; see ``friction_feedback`` for more.

    Parameters
    ----------
    tree
        A result of ``analyze`` or ``read_result``.
    operation
        Speeds, temperatures, roughnesses and oil.
    model
        Models of friction coefficient, film and rolling, or that of the coefficient alone; ``FrictionModel()`` if left
        out.
    segment_fields
        Whether to keep the fields over the segments, not just sums and means. Left out: if each has less than three
        million values.
    progress
        Called after every block of contacts.

    Returns
    -------
    xr.Dataset
        The group ``/friction``. Where a mesh position has no certified solution, its losses and the means are NaN.

    Raises
    ------
    InputError
        If the result is of an older version or lacks a dimension, an argument is of another kind, or a temperature is
        out of the oil's range.

    Examples
    --------
    >>> import easeoff
    >>> case = easeoff.read_case("nasa-12x36")
    >>> coarse = {"mesh_positions": 4, "lengthwise_nodes": 21, "profile_nodes": 15}
    >>> case = case.model_copy(update={"contact": case.contact.model_copy(update=coarse)})
    >>> found = friction(easeoff.analyze(case, torques=200.0), Operation(speed=1500.0, temperature=[60.0, 90.0]))
    >>> (100.0 * found["efficiency"]).values.ravel().round(1)
    array([97.8, 97.6])
    """
    model = checked_model(operation, model)
    instance("segment_fields", segment_fields, bool | None)
    instance("progress", progress, Callable | None)
    potential = potential_segments(tree)
    contacts = loaded_contacts(tree, potential)
    loaded = tree["loaded"].to_dataset().transpose("torque", "mesh_position", "segment", ...)
    segments = loaded.sizes["segment"]
    size = contacts.solved.size * segments * int(np.prod(operation.shape))
    keep = size <= KEPT_VALUES_LIMIT if segment_fields is None else segment_fields
    result, hottest = losses_dataset(contacts, operation, model, segments if keep else 0, progress)
    result = result.assign(hottest.variables(loaded, contacts.index, operation.bulk_temperatures))
    coords = {name: loaded[name] for name in ("torque", "mesh_position")}
    result = result.assign_coords(coords).merge(velocities_dataset(potential, operation, model))
    return with_least_film(labelled(result.assign_attrs(_provenance(operation, model))), loaded)


def losses_dataset(
    contacts: LoadedContacts,
    operation: Operation,
    model: FrictionModel,
    segments: int = 0,
    progress: Callable[[], None] | None = None,
) -> tuple[xr.Dataset, HottestContacts]:
    """Losses and efficiency over (torque, mesh_position, speed, temperature, roughness), and the hottest contacts.

    With fields over the segments unless their number is zero; progress is told after every block.
    """
    cycle, shape = contacts.solved.shape, operation.shape
    group = contacts.group
    sums = {name: np.zeros((*shape, contacts.solved.size)) for name in ("sliding", "rolling", "weighted")}
    fields: dict[str, Array] = {}
    shares, hottest = LossShares((cycle[0], *shape)), HottestContacts((cycle[0], *shape))
    if segments:
        whole = (*cycle, segments, *shape)
        fields = {name: np.full(whole, np.nan) for name in FIELDS}
        fields["film_thickness"] = np.full((*whole[:-1],), np.nan)
        fields["pressure_velocity"] = np.full((*whole[:-2],), np.nan)
        if model.has_range:
            fields["formula_flags"] = np.zeros(whole, dtype=np.uint16)
    for block in losses(contacts, operation, model):
        groups = group[block.contacts]
        starts = np.flatnonzero(np.diff(groups, prepend=-1))
        force_speed = contacts.force[block.contacts] * block.conditions.sliding_velocity
        for name, values in (
            ("sliding", block.sliding_loss),
            ("rolling", block.rolling_loss),
            ("weighted", force_speed),
        ):
            sums[name][..., groups[starts]] += np.add.reduceat(values, starts, axis=-1)
        loss, torque = block.sliding_loss + block.rolling_loss, contacts.index[0, block.contacts]
        shares.add(torque, loss, block.flags, block.between_regimes, block.film_thinning)
        hottest.add(torque, block)
        if segments:
            at = tuple(contacts.index[:, block.contacts])
            block_fields = {
                "friction_coefficient": block.coefficient,
                "lambda_ratio": block.conditions.lambda_ratio,
                "film_thickness": 1e6 * block.conditions.film_thickness[..., 0, :],
                "power_loss": loss,
                "flash_temperature": block.flash_temperature,
                "pressure_velocity": 1e-6 * block.pressure_velocity[:, 0, 0],
            }
            if block.flags is not None:
                block_fields["formula_flags"] = block.flags
            for name, values in block_fields.items():
                fields[name][at] = np.moveaxis(values, -1, 0)
        if progress is not None:
            progress()
    sliding, rolling, weighted = (
        np.where(contacts.solved[..., None, None, None], np.moveaxis(value, -1, 0).reshape(*cycle, *shape), np.nan)
        for value in (sums["sliding"], sums["rolling"], sums["weighted"])
    )
    power = contacts.torque[:, None] * operation.angular_velocity
    loss = sliding + rolling
    data: dict[str, Any] = {
        name: (("torque", "mesh_position", "segment", *OPERATION[: values.ndim - 3]), values)
        for name, values in fields.items()
    }
    mesh, mean = ("torque", "mesh_position", *OPERATION), ("torque", *OPERATION)
    data |= {
        "mesh_power_loss": (mesh, loss),
        "mesh_efficiency": (mesh, 1.0 - loss / power[:, None, :, None, None]),
        "mean_power_loss": (mean, loss.mean(axis=1)),
        "mean_sliding_loss": (mean, sliding.mean(axis=1)),
        "mean_rolling_loss": (mean, rolling.mean(axis=1)),
        "efficiency": (mean, 1.0 - loss.mean(axis=1) / power[:, :, None, None]),
        "mean_friction_coefficient": (mean, sliding.sum(axis=1) / weighted.sum(axis=1)),
        "input_power": (("torque", "speed"), power),
    }
    data |= shares.variables(mean, ranged=model.has_range, joined=model.has_regimes)
    if "formula_flags" in fields:
        data["formula_flags"] = (
            *data["formula_flags"],
            {"flag_masks": np.array(list(FLAGS), dtype=np.uint16), "flag_meanings": " ".join(FLAGS.values())},
        )
    return xr.Dataset(data, coords=_coordinates(operation, model)), hottest


def velocities_dataset(potential: PotentialSegments, operation: Operation, model: FrictionModel) -> xr.Dataset:
    """Sliding and rolling at all potential segments over (mesh_position, segment, speed), NaN where there is none."""
    velocities = potential.velocities
    per_radian = {
        "sliding_velocity": velocities.sliding_speed,
        "sliding_along": velocities.sliding_along,
        "sliding_across": velocities.sliding_across,
        "rolling_velocity": np.abs(model.rolling(velocities)),
    }
    ratio = potential.spread(model.slide_to_roll(velocities))
    data: dict[str, Any] = {"slide_to_roll": (("mesh_position", "segment"), ratio)}
    for name, values in per_radian.items():
        field = potential.spread(values[:, None] * operation.angular_velocity)
        data[name] = (("mesh_position", "segment", "speed"), field)
    return xr.Dataset(data, coords={"speed": operation.speeds})


def _coordinates(operation: Operation, model: FrictionModel) -> dict[str, Any]:
    """Operating conditions as coordinates; a pair of unlike roughnesses goes by its quadratic mean."""
    oil = model.oil_states(operation)
    rough = operation.roughnesses
    return {
        "speed": operation.speeds,
        "temperature": operation.temperatures,
        "roughness": operation.mean_roughnesses,
        "roughness_pinion": ("roughness", rough[:, 0]),
        "roughness_gear": ("roughness", rough[:, 1]),
        "viscosity": ("temperature", 1e3 * oil.viscosity),
        "pressure_viscosity": ("temperature", 1e9 * oil.pressure_viscosity),
        "temperature_clamped": ("temperature", oil.clamped.astype(np.int8)),
        "bulk_temperature": ("temperature", operation.bulk_temperatures),
    }


def _provenance(operation: Operation, model: FrictionModel) -> dict[str, Any]:
    oil = operation.lubricant
    return {
        "oil": oil.name,
        "oil_title": oil.title,
        "oil_source": oil.source,
        "oil_temperature_range_degC": list(oil.temperature_range),
        "friction_coefficient": model.name,
        "film": model.film,
        "film_heating": model.film_heating,
        "thermal_factor": model.thermal_factor,
        "rolling_frame": model.rolling_frame,
        **{f"tooth_{name}": [getattr(m, name) for m in model.materials] for name in THERMAL_PROPERTIES},
        "sliding_of_ratio": "across",
        "radius_direction": "across",
        **({"formula_oil": FORMULA_OIL} if _made_for_another_oil(operation, model) else {}),
    }


def _made_for_another_oil(operation: Operation, model: FrictionModel) -> bool:
    """True if the coefficient's formula was made for one oil, and this is not like it."""
    if not model.has_regimes:
        return False
    of_formula = lubricant(FORMULA_OIL).at(operation.temperatures, out_of_range="clamp")
    given = model.oil_states(operation)
    return any(
        bool(np.any(np.abs(getattr(given, name) / getattr(of_formula, name) - 1.0) > OIL_TOLERANCE))
        for name in ("viscosity", "pressure_viscosity")
    )


def with_least_film(friction: xr.Dataset, loaded: xr.Dataset) -> xr.Dataset:
    """The group ``/friction`` with the least film over the mesh cycle, if its fields over the segments were kept."""
    if "film_thickness" not in friction:
        return friction
    film = friction["film_thickness"].transpose("mesh_position", "segment", "torque", ...)
    flat = np.where(np.isfinite(film.values), film.values, np.inf).reshape(-1, *film.shape[2:])
    least = np.argmin(flat, axis=0)
    known = np.isfinite(flat.min(axis=0))
    position, segment = np.unravel_index(least, film.shape[:2])
    dims = film.dims[2:]
    torque = np.arange(film.sizes["torque"]).reshape(-1, *(1,) * (least.ndim - 1))
    table = loaded[["lengthwise", "profile"]].transpose("torque", "mesh_position", "segment")
    points = {f"min_film_{name}": table[name].values[torque, position, segment] for name in ("lengthwise", "profile")}
    numbers = {
        "min_film_thickness": flat.min(axis=0),
        "min_film_position": loaded["mesh_position"].values[position],
        **points,
    }
    conditions = friction["efficiency"]
    # Without feedback the film is the same at every roughness.
    missing = len(conditions.dims) - len(dims)
    variables = {}
    for name, value in numbers.items():
        known_value = np.where(known, value, np.nan)
        spread = np.broadcast_to(known_value.reshape(*known_value.shape, *[1] * missing), conditions.shape)
        variables[name] = (conditions.dims, spread.copy())
    return labelled(friction.assign(variables))
