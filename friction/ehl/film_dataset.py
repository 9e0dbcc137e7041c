"""Films and passages as labelled datasets, in the units in which people read them."""

from __future__ import annotations

from typing import Any

import numpy as np
import xarray as xr

from ...core.attributes import labelled
from ...core.checks import instance
from .film import Film
from .reynolds_equation import State, Status
from .rough_passage import RoughPassage


def film_dataset(film: Film) -> xr.Dataset:
    """Pressure, asperities' part, film thickness and state by position, with the status and certificate of the answer.

    Returns
    -------
    xarray.Dataset
        Dimension ``rolling_position`` [um].

    Examples
    --------
    >>> from easeoff.friction.ehl import LubricatedContact, Oil, smooth_film
    >>> contact = LubricatedContact(1e9, 0.02, 5.0, Oil(0.02, 1.1e-8), slide_to_roll=0.25)
    >>> dict(film_dataset(smooth_film(contact, nodes=129)).sizes)
    {'rolling_position': 129}
    """
    instance("film", film, Film)
    data: dict[str, Any] = {
        "film_pressure": ("rolling_position", 1e-6 * film.pressure),
        "asperity_pressure": ("rolling_position", 1e-6 * film.asperity_pressure),
        "film": ("rolling_position", 1e6 * film.film),
        "asperity_share": film.asperity_share,
        "node_state": ("rolling_position", film.state, State.flag_attributes()),
        "status": ((), np.int8(film.status), Status.flag_attributes()),
        "worst_residual": film.certificate.worst,
        "iterations": film.iterations,
    }
    return labelled(xr.Dataset(data, coords={"rolling_position": 1e6 * film.position}))


def passage_dataset(passage: RoughPassage) -> xr.Dataset:
    """Friction, film and status of a passage by time step, and the fields that were kept.

    Returns
    -------
    xarray.Dataset
        Dimensions ``time`` [us], and ``kept_time`` and ``rolling_position`` [um] of the fields.

    Examples
    --------
    >>> from easeoff.friction.ehl import LubricatedContact, Oil, generated_profile, rough_passage
    >>> contact = LubricatedContact(1e9, 0.02, 5.0, Oil(0.02, 1.1e-8), slide_to_roll=0.25)
    >>> profile = generated_profile(0.1e-6, 40e-6, 1e-3, seed=1)
    >>> passage = rough_passage(contact, profile, steps=40, nodes=65, settle=30, keep=20)
    >>> dict(passage_dataset(passage).sizes)
    {'time': 40, 'kept_time': 2, 'rolling_position': 65}
    """
    instance("passage", passage, RoughPassage)
    time = 1e6 * passage.time
    data: dict[str, Any] = {
        "status": ("time", passage.status, Status.flag_attributes()),
        "settled": ("time", passage.settled.astype(np.int8)),
        "iterations": ("time", passage.iterations),
        "worst_residual": ("time", passage.violation),
        "leak": ("time", passage.leak),
        "film_friction": ("time", passage.film_friction),
        "asperity_friction": ("time", passage.asperity_friction),
        "asperity_share": ("time", passage.asperity_share),
        "minimum_film": ("time", 1e6 * passage.minimum_film),
        "mean_film": ("time", 1e6 * passage.mean_film),
        "film_pressure": (("kept_time", "rolling_position"), 1e-6 * passage.pressure),
        "film": (("kept_time", "rolling_position"), 1e6 * passage.film),
        "node_state": (("kept_time", "rolling_position"), passage.state, State.flag_attributes()),
    }
    coords = {"time": time, "kept_time": time[passage.kept - 1], "rolling_position": 1e6 * passage.position}
    return labelled(xr.Dataset(data, coords=coords))
