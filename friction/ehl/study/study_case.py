"""One case of the parameter study: a combination of conditions, computed with the film model."""

from __future__ import annotations

import math
import time
from dataclasses import dataclass
from functools import lru_cache
from typing import Literal

import numpy as np

from ....core import checks
from ....core.errors import EaseoffError
from ..equations.film_certificate import Status
from ..film import FEWEST_NODES, MOST_NODES, Film, domain, mixed_film, smooth_film
from ..rolling_contact.asperities import Asperities
from ..rolling_contact.lubricated_contact import LubricatedContact
from ..rolling_contact.surface_roughness import generated_profile
from ..rough_passage import ROUGH_INLET_GAP_RATIO, TOUCHING_FILM, rough_passage
from ..shear_traction import BOUNDARY_FRICTION, traction
from .study_design import Condition

#: Of the model and its numerics. To be raised with every change that changes results: rows of another version that a
#: study finds on disk are not used.
MODEL_VERSION = 2
#: A case whose certified steps are fewer than this share is not converged.
CERTIFIED_SHARE_MINIMUM = 0.9
#: Lubricant that the others may make or lose, of all that flows through.
LEAKAGE_LIMIT = 0.01
RAMP_STEPS = 20


@dataclass(frozen=True)
class Resolution:
    """Model, assumptions and grid of a study.

    Parameters
    ----------
    model
        ``load_sharing``: roughness by its statistics, see ``Asperities``, which needs ``correlation_length``,
        ``fewest``, ``boundary_friction`` and ``thermal`` alone of what follows. ``passage``: profiles that move through
        the contact, see ``rough_passage``.
    correlation_length
        Of the roughness of both surfaces [m].
    points
        Grid spacings in a correlation length.
    fewest, most
        Bounds of the number of nodes. Where the upper one cuts in, the profile is coarser.
    travel
        How far the mean flow moves while averages are taken: as many correlation lengths, or one half width of the
        contact if that is more. Before, it moves from the inlet to the middle.
    smooth_from
        Lambda ratio from which on the smooth film stands for the rough one.
    flooded
        See ``domain``.
    order
        Of the differences in space and time, see ``rough_passage``.
    seed
        Of the profiles; the surfaces have different ones.
    touching_film, boundary_friction
        [m], [1].
    thermal
        Lower the viscosity in the shear stress by the film's own heat.

    Raises
    ------
    InputError
        If there is no such model, or a number cannot be used.

    Examples
    --------
    >>> Resolution(model="passage", fewest=97).most
    1025
    """

    model: Literal["load_sharing", "passage"] = "load_sharing"
    correlation_length: float = 20e-6
    points: float = 3.0
    fewest: int = 257
    most: int = 1025
    travel: float = 30.0
    smooth_from: float = 3.0
    flooded: float = ROUGH_INLET_GAP_RATIO
    order: int = 2
    seed: int = 1
    touching_film: float = TOUCHING_FILM
    boundary_friction: float = BOUNDARY_FRICTION
    thermal: bool = True

    def __post_init__(self) -> None:
        checks.one_of("model", self.model, ("load_sharing", "passage"))
        checked = {
            "correlation_length": checks.positive("correlation_length", self.correlation_length, "m"),
            "points": checks.positive("points", self.points, "1"),
            "fewest": checks.whole("fewest", self.fewest, FEWEST_NODES, MOST_NODES),
            "most": checks.whole(
                "most", self.most, self.fewest if self.model == "passage" else FEWEST_NODES, MOST_NODES
            ),
            "travel": checks.positive("travel", self.travel, "1", zero=True),
            "smooth_from": checks.positive("smooth_from", self.smooth_from, "1", zero=True, infinite=True),
            "flooded": checks.number("flooded", self.flooded, above=1.0),
            "order": checks.whole("order", self.order, 1, 2),
            "seed": checks.whole("seed", self.seed, 0),
            "touching_film": checks.positive("touching_film", self.touching_film, "m"),
            "boundary_friction": checks.positive("boundary_friction", self.boundary_friction, "1", zero=True),
            "thermal": checks.truth("thermal", self.thermal),
        }
        for name, value in checked.items():
            object.__setattr__(self, name, value)


Row = dict[str, float]

#: Numbers of a row besides the condition and the status; NaN where there is no answer.
NUMBERS = (
    "film_friction",
    "asperity_friction",
    "asperity_share",
    "mean_film",
    "smooth_film",
    "lambda_ratio",
    "certified_share",
    "newton_steps",
    "nodes",
    "run_time",
)


def run_case(condition: Condition, resolution: Resolution | None = None) -> Row:
    """Compute one combination.

    Returns
    -------
    dict
        ``status`` and the numbers of the dataset, in its units. A case that the model or its arithmetic fails at is a
        row with the status ``FAILED`` and a ``message``; a mistake in the program is an exception as ever.

    Examples
    --------
    >>> row = run_case(Condition(0.5, 5.0, 20.0, 0.5, 50.0, 0.2, 0.2), Resolution(fewest=97))
    >>> Status(int(row["status"])).name, round(row["lambda_ratio"], 1)
    ('CERTIFIED', 6.0)
    """
    checks.instance("condition", condition, Condition)
    resolution = Resolution() if resolution is None else resolution
    checks.instance("resolution", resolution, Resolution)
    start = time.perf_counter()
    row: Row = {**dict.fromkeys(NUMBERS, math.nan), "status": float(Status.FAILED)}
    try:
        row.update(_computed(condition, resolution))
    except (EaseoffError, ArithmeticError, np.linalg.LinAlgError) as error:  # the study goes on
        row["message"] = f"{type(error).__name__}: {error}"  # type: ignore[assignment]
    row["run_time"] = time.perf_counter() - start
    return row


def _computed(condition: Condition, resolution: Resolution) -> Row:
    contact = condition.contact
    smooth = _smooth_film(contact)
    if not smooth.certified:
        return {"status": float(Status.NOT_CONVERGED)}
    film = smooth.minimum_film
    row = {"smooth_film": 1e6 * film, "lambda_ratio": film / condition.composite_roughness}
    if resolution.model == "load_sharing":
        roughness = Asperities(condition.composite_roughness, resolution.correlation_length)
        return row | _steady(mixed_film(contact, roughness, nodes=resolution.fewest), resolution)
    if row["lambda_ratio"] >= resolution.smooth_from:
        return row | _steady(smooth, resolution)
    return row | _rough(condition, contact, resolution)


#: Cases in a row often differ by the roughness alone.
_smooth_film = lru_cache(maxsize=8)(smooth_film)


def _steady(film: Film, resolution: Resolution) -> Row:
    cost = {"newton_steps": float(film.iterations), "nodes": float(film.position.size)}
    if not film.certified:
        return cost | {"status": float(Status.NOT_CONVERGED), "certified_share": 0.0}
    shear = traction(
        film.contact,
        film.position,
        film.pressure - film.asperity_pressure,
        film.film,
        asperity_pressure=film.asperity_pressure,
        boundary_friction=resolution.boundary_friction,
        thermal=resolution.thermal,
    )
    settled = math.isfinite(shear.film)
    within = np.abs(film.position) < film.contact.half_width
    numbers = {
        "film_friction": shear.film,
        "asperity_friction": shear.asperities,
        "asperity_share": film.asperity_share,
        "mean_film": 1e6 * float(film.film[within].mean()),
    }
    return (
        cost
        | (numbers if settled else {})
        | {
            "status": float(Status.CERTIFIED if settled else Status.NOT_CONVERGED),
            "certified_share": float(settled),
        }
    )


def _rough(condition: Condition, contact: LubricatedContact, resolution: Resolution) -> Row:
    span = domain(contact, resolution.flooded)
    length = (span[1] - span[0]) * contact.half_width
    wanted = math.ceil(resolution.points * length / resolution.correlation_length) + 1
    nodes = min(max(wanted, resolution.fewest), resolution.most)
    spacing = length / (nodes - 1)
    settle = max(RAMP_STEPS, math.ceil(-span[0] * contact.half_width / spacing))
    averaged = math.ceil(max(resolution.travel * resolution.correlation_length, contact.half_width) / spacing)
    period = max(2.0 * length, 50.0 * resolution.correlation_length)
    first, second = (
        generated_profile(1e-6 * rms, resolution.correlation_length, period, seed)
        for rms, seed in (
            (condition.roughness_1, 2 * resolution.seed),
            (condition.roughness_2, 2 * resolution.seed + 1),
        )
    )
    passage = rough_passage(
        contact,
        first,
        second,
        steps=settle + averaged,
        nodes=nodes,
        ramp=RAMP_STEPS,
        settle=settle,
        span=span,
        touching_film=resolution.touching_film,
        order=resolution.order,
        boundary_friction=resolution.boundary_friction,
        thermal=resolution.thermal,
    )
    friction = passage.friction_coefficient
    enough = (
        passage.certified_share >= CERTIFIED_SHARE_MINIMUM
        and passage.leakage <= LEAKAGE_LIMIT
        and math.isfinite(friction)
    )
    return {
        "status": float(Status.CERTIFIED if enough else Status.NOT_CONVERGED),
        "film_friction": passage.average("film_friction"),
        "asperity_friction": passage.average("asperity_friction"),
        "asperity_share": passage.average("asperity_share"),
        "mean_film": 1e6 * passage.average("mean_film"),
        "certified_share": passage.certified_share,
        "newton_steps": float(passage.iterations.mean()),
        "nodes": float(nodes),
    }
