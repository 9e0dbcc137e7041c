"""Power loss and efficiency of a pair, from a stored result: the group ``/friction``.

Friction, film and losses are those of the loaded contacts at many operating conditions, a block of contacts at a time.
Arrays are over (speed, temperature, roughness, contact), the contacts last, so that the innermost loops are long; what
does not depend on a dimension has length one there. The hottest contact of a mesh cycle and the least film thickness
with its place are found on the way, at every operating condition.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass
from typing import Any

import numpy as np
import xarray as xr

from ..core.arrays import Array, Integers
from ..core.attributes import labelled
from ..core.checks import instance, one_of
from .coefficient import RANGE_FLAGS, CoefficientModel, checked_coefficient
from .conditions import THERMAL_FACTORS, ContactConditions
from .contact_temperature import flash_temperature
from .kolivand_formula import FLAGS, Flags, LossShares, between_regimes
from .loaded_contacts import LoadedContacts, PotentialSegments, loaded_contacts, potential_segments
from .lubricants.lubricant import lubricant
from .operation import FrictionModel, Operation, checked_model

KEPT_VALUES_LIMIT = 3_000_000  # of a field over segments that is kept without being asked for
FORMULA_OIL = "75w90"  # of the dissertation's formula
OIL_TOLERANCE = 0.02  # of viscosity and pressure-viscosity coefficient, within which an oil is the formula's
OPERATION = ("speed", "temperature", "roughness")
THERMAL_PROPERTIES = ("conductivity", "density", "heat_capacity")  # of pinion and gear, in SI
FIELDS = ("friction_coefficient", "lambda_ratio", "power_loss", "flash_temperature")  # over all conditions
TOLD_FACTOR = "gupta_cheng"  # by which the film's thinning is told where the model leaves it out
BLOCK_SIZE = 200_000  # values: intermediate arrays stay in the processor's cache


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
    >>> losses = friction(easeoff.analyze(case, torques=200.0), Operation(speed=1500.0, temperature=[60.0, 90.0]))
    >>> (100.0 * losses["efficiency"]).values.ravel().round(1)
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
    cycle, shape, group = contacts.solved.shape, operation.shape, contacts.group
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
        added = {"sliding": block.sliding_loss, "rolling": block.rolling_loss, "weighted": force_speed}
        for name, values in added.items():
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
    places, omega = ("mesh_position", "segment"), operation.angular_velocity
    data: dict[str, Any] = {"slide_to_roll": (places, potential.spread(model.slide_to_roll(velocities)))}
    data |= {name: ((*places, "speed"), potential.spread(v[:, None] * omega)) for name, v in per_radian.items()}
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
    of_formula = lubricant(FORMULA_OIL).at(operation.temperatures, out_of_range="clamp")
    given = model.oil_states(operation)
    ratios = given.viscosity / of_formula.viscosity, given.pressure_viscosity / of_formula.pressure_viscosity
    return model.has_regimes and bool(np.any(np.abs(np.subtract(ratios, 1.0)) > OIL_TOLERANCE))


def with_least_film(friction: xr.Dataset, loaded: xr.Dataset) -> xr.Dataset:
    """The group ``/friction`` with the least film over the mesh cycle, if its fields over the segments were kept."""
    if "film_thickness" not in friction:
        return friction
    film = friction["film_thickness"].transpose("mesh_position", "segment", "torque", ...)
    flat = np.where(np.isfinite(film.values), film.values, np.inf).reshape(-1, *film.shape[2:])
    least = np.argmin(flat, axis=0)
    known = np.isfinite(flat.min(axis=0))
    position, segment = np.unravel_index(least, film.shape[:2])
    torque = np.arange(film.sizes["torque"]).reshape(-1, *(1,) * (least.ndim - 1))
    table = loaded[["lengthwise", "profile"]].transpose("torque", "mesh_position", "segment")
    numbers = {
        "min_film_thickness": flat.min(axis=0),
        "min_film_position": loaded["mesh_position"].values[position],
        **{f"min_film_{name}": table[name].values[torque, position, segment] for name in ("lengthwise", "profile")},
    }
    conditions = friction["efficiency"]
    # Without feedback the film is the same at every roughness.
    shape = (*known.shape, *(1,) * (conditions.ndim - known.ndim))
    variables = {}
    for name, value in numbers.items():
        spread = np.broadcast_to(np.where(known, value, np.nan).reshape(shape), conditions.shape)
        variables[name] = (conditions.dims, spread.copy())
    return labelled(friction.assign(variables))


@dataclass(frozen=True)
class Losses:
    """Friction and power loss of contacts (speed, temperature, roughness, c); edges have NaN temperatures."""

    contacts: slice
    conditions: ContactConditions
    coefficient: Array
    sliding_loss: Array  # [W]
    rolling_loss: Array  # [W], length one over the roughness
    flags: Flags | None  # beyond the formula's range, sums of FLAGS; None without one
    between_regimes: Array
    film_thinning: Array  # by inlet heat, by the model's factor, or Gupta's
    flash_temperature: Array  # [K]
    pressure_velocity: Array  # Hertz pressure times sliding velocity [W/m^2], (speed, 1, 1, c)


def conditions_of(
    contacts: LoadedContacts, operation: Operation, model: FrictionModel, block: slice
) -> ContactConditions:
    """Conditions of a block of contacts, over (speed, temperature, roughness, contact)."""
    v = contacts.velocities.chosen(block)
    omega = operation.angular_velocity[:, None, None, None]
    oil = model.oil_states(operation)
    by_temperature = {
        name: np.asarray(getattr(oil, name))[:, None, None]
        for name in ("viscosity", "pressure_viscosity", "temperature_viscosity")
    }
    return ContactConditions(
        hertz_pressure=contacts.hertz_pressure[block],
        equivalent_radius=contacts.equivalent_radius[block],
        rolling_velocity=np.abs(model.rolling(v)) * omega,
        sliding_velocity=v.sliding_speed * omega,
        slide_to_roll=model.slide_to_roll(v),
        temperature=operation.temperatures[:, None, None],
        roughness_pinion=1e-6 * operation.roughnesses[:, :1],
        roughness_gear=1e-6 * operation.roughnesses[:, 1:],
        thermal_conductivity=oil.thermal_conductivity,
        contact_modulus=contacts.contact_modulus,
        film_formula=model.film,
        film_heating=model.film_heating,
        **by_temperature,
    )


def losses(contacts: LoadedContacts, operation: Operation, model: FrictionModel) -> Iterator[Losses]:
    """Friction coefficient and power loss of all contacts (Kolivand 2009, Eq. 5.10 to 5.12), block by block.

    Sliding loss is friction force times whole sliding velocity, rolling loss rolling traction times length and
    velocity.
    """
    materials = model.materials
    heating = TOLD_FACTOR if model.film_heating == "none" else model.film_heating
    per_contact = int(np.prod(operation.shape))
    step = max(1, BLOCK_SIZE // per_contact)
    for start in range(0, contacts.force.size, step):
        block = slice(start, min(start + step, contacts.force.size))
        conditions = conditions_of(contacts, operation, model, block)
        coefficient = checked_coefficient(model.coefficient, conditions)
        friction = np.broadcast_to(coefficient, (*operation.shape, block.stop - start))
        sliding = (contacts.force[block] * conditions.sliding_velocity) * friction
        traction = rolling_traction(conditions, model.thermal_factor) * contacts.length[block]
        velocities = contacts.velocities.chosen(block)
        over_line = [each * operation.angular_velocity[:, None, None, None] for each in velocities.over_line]
        # What rolling costs is sheared in the inlet and carried away by the oil.
        heat = sliding / np.where(contacts.on_line[block], contacts.length[block], np.nan)
        yield Losses(
            block,
            conditions,
            friction,
            sliding,
            traction * conditions.rolling_velocity,
            RANGE_FLAGS[model.name](conditions, friction) if model.has_range else None,
            between_regimes(conditions) if model.has_regimes else np.zeros((), dtype=bool),
            1.0 - THERMAL_FACTORS[heating](conditions),
            flash_temperature(heat, contacts.half_width[block], (over_line[0], over_line[1]), materials),
            np.where(contacts.on_line[block], conditions.hertz_pressure * conditions.sliding_velocity, np.nan),
        )


def isothermal_traction(conditions: ContactConditions) -> Array:
    """Rolling traction without heating of the inlet [N/m of contact length] (...).

    4.318 (G U)^0.658 W^0.0126 R / alpha: Goksem and Hargreaves 1978, doi 10.1115/1.3453183; Kolivand 2009, Eq. 5.10.
    """
    c = conditions
    scale = 4.318 * c.equivalent_radius / c.pressure_viscosity
    return np.asarray(scale * (c.material_parameter * c.speed_parameter) ** 0.658 * c.load_parameter**0.0126)


def rolling_traction(conditions: ContactConditions, thermal_factor: str = "goksem_hargreaves") -> Array:
    """Rolling traction [N/m of contact length] (...). Times rolling velocity and length it is the rolling power loss.

    Parameters
    ----------
    conditions
        Operating conditions of the contacts.
    thermal_factor
        Name of the factor for the inlet's heating, see ``THERMAL_FACTORS``.

    Raises
    ------
    InputError
        If there is no factor of that name.

    Examples
    --------
    >>> from easeoff.friction.coefficient import contact_conditions
    >>> contact = contact_conditions(hertz_pressure=0.7e9, equivalent_radius=0.042, rolling_velocity=2.2,
    ...                              slide_to_roll=0.45, roughness=0.8e-6)
    >>> print(f"{rolling_traction(contact):.1f} N/m")
    67.5 N/m
    """
    instance("conditions", conditions, ContactConditions)
    factor = THERMAL_FACTORS[one_of("thermal_factor", thermal_factor, THERMAL_FACTORS)]
    return np.asarray(isothermal_traction(conditions) * factor(conditions))


class HottestContacts:
    """The hottest contact over (torque, speed, temperature, roughness), found a block of contacts at a time."""

    def __init__(self, shape: tuple[int, int, int, int]) -> None:
        self.flash, self.pressure_velocity = np.full(shape, -np.inf), np.full(shape, -np.inf)
        self.contact: Integers = np.zeros(shape, dtype=np.int64)

    def add(self, torque: Integers, block: Losses) -> None:
        """Add a block of contacts by their sorted torque numbers (c); a flash temperature of NaN does not count."""
        starts = np.flatnonzero(np.diff(torque, prepend=-1))
        flash, product = (
            np.where(np.isnan(values), -np.inf, values) for values in (block.flash_temperature, block.pressure_velocity)
        )
        for start, end in zip(starts, [*starts[1:], torque.size], strict=True):
            at = torque[start]
            hottest = np.argmax(flash[..., start:end], axis=-1)
            greatest = np.take_along_axis(flash[..., start:end], hottest[..., None], axis=-1)[..., 0]
            hotter = greatest > self.flash[at]
            self.flash[at] = np.where(hotter, greatest, self.flash[at])
            self.contact[at] = np.where(hotter, block.contacts.start + start + hottest, self.contact[at])
            self.pressure_velocity[at] = np.maximum(self.pressure_velocity[at], product[..., start:end].max(axis=-1))

    def variables(self, loaded: xr.Dataset, index: Integers, bulk_temperature: Array) -> dict[str, Any]:
        """Variables of the group ``/friction``, NaN where no contact line carries; bulk temperature in [degC].

        Contacts are numbered by torque, mesh position and segment (3, n), which come first in ``/loaded``.
        """
        known = np.isfinite(self.flash)
        values: dict[str, Array] = {
            "max_flash_temperature": self.flash,
            "max_contact_temperature": self.flash + bulk_temperature[:, None],
            "max_pressure_velocity": 1e-6 * self.pressure_velocity,
        }
        if index.size:
            at = tuple(index[:, self.contact])
            values["max_flash_position"] = loaded["mesh_position"].values[at[1]]
            for name in ("lengthwise", "profile"):
                values[f"max_flash_{name}"] = loaded[name].values[at]
        else:
            nowhere = ("position", "lengthwise", "profile")
            values |= {f"max_flash_{name}": np.full(self.flash.shape, np.nan) for name in nowhere}
        return {name: (("torque", *OPERATION), np.where(known, value, np.nan)) for name, value in values.items()}
