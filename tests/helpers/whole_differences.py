"""Differences of whole analyses along a setting, and how far derivatives are apart from them."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import cache
from typing import Any

import numpy as np
import xarray as xr
from held_teeth import anew
from numpy.typing import NDArray
from runs import small

from easeoff.cases.schema.case_schema import Case
from easeoff.contact import MeshCycle
from easeoff.contact.compliance.finite_elements.finite_element_tooth import FiniteElementTooth
from easeoff.contact.evaluation.cycle_slopes import CycleSlopes, cycle_values
from easeoff.contact.loaded import LoadedCase
from easeoff.friction import FrictionModel, Operation
from easeoff.geometry.pair.modification import Modification, modified_ease_off
from easeoff.geometry.pair.near_pair import PLACES, PairSetting, rate
from easeoff.study import CaseInMesh
from easeoff.study.analysis.setting_derivatives import loss_slopes, loss_values

Array = NDArray[Any]

#: Numbers after a step, and what touches in every case.
Course = Callable[[float], tuple[xr.Dataset, list[Array]]]

OPERATION = Operation(speed=1500.0, roughness=0.8)
LONGEST_STEP = 0.1  # of the ease-off, the most that a step changes it anywhere [um]
LONGEST_SHARE = 0.1  # of the usual step of a setting that hardly moves the flanks
FINER, STEP_COUNT = 10.0**0.5, 8
ENOUGH_STEPS = 6  # after which differences that scatter may end the search
SCATTER_LIMIT = 3e-5  # of a derivative, the most that two differences are apart
LEAST_CHANGE = 3e-6  # of a number over the first step; of less, rounding of its solution could be told for a departure
STILL = 1e-5  # change of the ease-off by a usual step [um], below which a setting does not move the flanks

#: What a number is made of, whose derivative counts where its own all but cancels.
MADE_OF = {
    **dict.fromkeys(("mean_level", "peak_to_peak", "harmonic", "rms"), "transmission_error"),
    **dict.fromkeys(("mean_sliding_loss", "mean_rolling_loss"), "mean_power_loss"),
    "edge_share": "load_share",
    "max_pressure": "pressure",
    "max_root_stress": "root_stress_history",
}


def coarse(name: str, model: str = "solid_shell") -> Case:
    """A small case with coarse teeth, of all but ``nasa-12x36`` each on a body of its own."""
    case = small(name, mesh_positions=4)
    teeth = {"model": model, "fineness": 0.2, "neighbours": name == "nasa-12x36"}
    return case.model_copy(update={"compliance": case.compliance.model_copy(update=teeth)})


@cache
def coarse_cycle(name: str) -> MeshCycle:
    """The mesh of such a case."""
    return CaseInMesh.of(coarse(name)).cycle


@dataclass(frozen=True)
class Analyses:
    """How a pair in mesh is analysed: torques [N m], edges, and teeth by finite elements for root stress."""

    torques: tuple[float, ...]
    edges: bool = True
    roots: tuple[FiniteElementTooth, FiniteElementTooth] | None = None

    def slopes(self, cycle: MeshCycle, settings: list[PairSetting]) -> xr.Dataset:
        """Derivatives by the settings of all numbers of ease-off, loaded contact and losses."""
        loaded, cases = cycle.loaded(self.torques, edge_contact=self.edges)
        found = CycleSlopes.of(cycle, settings, cases)
        slopes = found.datasets(loaded, self.roots, unloaded=False)[1].drop_vars("tooth_thickness")
        return slopes.merge(loss_slopes(found, loaded, OPERATION, FrictionModel())[1], compat="override")

    def numbers(self, cycle: MeshCycle) -> tuple[xr.Dataset, list[Array]]:
        """Their values, and what touches in every case."""
        loaded, cases = cycle.loaded(self.torques, edge_contact=self.edges)
        values = cycle_values(cycle, loaded, cases, self.roots, None).drop_vars("tooth_thickness")
        losses = loss_values(cycle, loaded, OPERATION, FrictionModel())
        ordered = sorted(cases, key=lambda one: (one.torque, one.mesh_position))
        return values.merge(losses, compat="override"), [touching(one) for one in ordered]

    def along(self, cycle: MeshCycle, setting: PairSetting) -> Course:
        """Numbers after a step of a setting."""
        pair, told = cycle.geometry.pair, cycle.geometry.ease_off
        if setting.of == "modification":
            return lambda step: self.numbers(
                cycle.with_ease_off(modified_ease_off(told, Modification({setting.name: step})))
            )
        return lambda step: self.numbers(anew(cycle, setting.moved(pair, step)))

    def along_torque(self, cycle: MeshCycle) -> Course:
        """Numbers after a step of all torques [N m]."""
        return lambda step: replace(self, torques=tuple(torque + step for torque in self.torques)).numbers(cycle)


def touching(case: LoadedCase) -> Array:
    """Tooth pair, edge and element of the segments in contact, on lines their numbers."""
    here = case.segments
    element = np.where(here.edge < 0, np.arange(here.pair.size), here.element)
    return np.stack([here.pair, here.edge, element])[:, case.solution.force > 0.0]


def moves(setting: PairSetting, slopes: xr.Dataset) -> bool:
    """Whether a setting moves the flanks at all."""
    return _greatest(slopes["ease_off"]) * setting.scale > STILL


def longest_step(setting: PairSetting, slopes: xr.Dataset) -> float:
    """The first step of a setting for ``key_numbers``."""
    return min(LONGEST_STEP / _greatest(slopes["ease_off"]), LONGEST_SHARE * setting.scale)


def departures(course: Course, slopes: xr.Dataset, step: float, tolerance: float) -> dict[str, Departure]:
    """How far the derivatives of every number are from differences, down from the first step of a course.

    The search ends when differences of two steps agree with all of them, or their scatter tells no more.
    """
    greatest = {str(name): _greatest(slopes[name]) for name in slopes}
    values, touched = course(0.0)
    least = {name: LEAST_CHANGE * max(_greatest(values[name]), 1e-290) / step for name in greatest}
    size = {name: max(own, greatest.get(MADE_OF.get(name, name), 0.0), least[name]) for name, own in greatest.items()}
    # NaN is no derivative, and needs none.
    farther = {str(name): np.where(np.isfinite(slopes[name].values), np.inf, 0.0) for name in slopes}
    beyond, before = dict(farther), dict.fromkeys(farther, np.asarray(np.nan))
    for count in range(1, STEP_COUNT + 1):
        change = _difference(course, step, touched)
        for name, own in slopes.items():
            same = dict(change[name].sizes) == dict(own.sizes)  # else there are other segments
            by_step = change[name].transpose(*own.dims).values if same else np.nan
            here, last = (by_step - own.values) / size[str(name)], before[str(name)]
            scatter = np.abs(here - last)
            scatter = np.where(scatter < SCATTER_LIMIT, scatter, np.nan)
            farther[str(name)] = np.fmin(farther[str(name)], np.maximum(np.abs(here), np.abs(last)))
            beyond[str(name)] = np.fmin(beyond[str(name)], np.minimum(np.abs(here), np.abs(last)) - scatter)
            before[str(name)] = here
        told = beyond if count >= ENOUGH_STEPS else farther
        if all(np.all(values < tolerance) for values in told.values()):
            break
        step /= FINER
    return {name: Departure.of(farther[name], beyond[name]) for name in farther}


@dataclass(frozen=True)
class Departure:
    """How far derivatives of a number are from differences, relative: the greatest of what could be compared.

    Two differences of fourth order count together, one with a step a third of the other. Of such pairs the nearest
    counts: longer steps curve or meet a change of what touches, and of shorter ones rounding rules.

    Parameters
    ----------
    farther
        Of the farther one of a pair.
    beyond
        Of the nearer one, but for how far both are from each other, ``SCATTER_LIMIT`` at most.
    compared
        The share that could be compared.
    """

    farther: float
    beyond: float
    compared: float

    @classmethod
    def of(cls, farther: Array, beyond: Array) -> Departure:
        """Of all derivatives of a number."""
        known = np.isfinite(beyond)
        greatest = [float(np.max(values[known], initial=0.0)) for values in (farther, beyond)]
        return cls(greatest[0], greatest[1], float(np.mean(known)))


def _greatest(values: xr.DataArray) -> float:
    return float(np.nanmax(np.abs(values.values), initial=0.0))


def _difference(course: Course, step: float, touched: list[Array]) -> xr.Dataset:
    """Difference of fourth order; NaN where other segments touch than at the pair itself."""
    moved = [course(step * place) for place in PLACES]
    same = [all(np.array_equal(at[n], there) for _, at in moved) for n, there in enumerate(touched)]
    values, dims = [one.drop_vars(one.coords) for one, _ in moved], ("torque", "mesh_position")
    found = xr.Dataset({name: _rate([one[name] for one in values], step) for name in values[0]})
    alike = xr.DataArray(np.reshape(same, [values[0].sizes[dim] for dim in dims]), dims=dims)
    for name in [name for name in found if "torque" in found[name].dims]:
        own = alike if "mesh_position" in found[name].dims else alike.all("mesh_position")
        found[name] = found[name].where(own)
    return found


def _rate(values: list[xr.DataArray], step: float) -> xr.DataArray:
    """Their derivative; NaN alone where there are other segments."""
    if len({one.shape for one in values}) > 1:
        return xr.DataArray(np.nan)
    return values[0].copy(data=rate([one.values for one in values], step))
