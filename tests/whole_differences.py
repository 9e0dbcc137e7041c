"""Differences of whole analyses along a setting, and how far derivatives are apart from them."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
import xarray as xr
from held_teeth import anew
from numpy.typing import NDArray

from easeoff.contact import MeshCycle
from easeoff.contact.compliance.finite_elements.finite_element_tooth import FiniteElementTooth
from easeoff.contact.evaluation.derivatives.cycle_slopes import CycleSlopes, cycle_values
from easeoff.contact.loaded_cases import LoadedCase
from easeoff.friction import FrictionModel, Operation
from easeoff.geometry.pair.near_pair import at_places, rate
from easeoff.geometry.pair.pair_setting import PairSetting
from easeoff.study.analysis.loss_slopes import loss_slopes, loss_values

Array = NDArray[Any]

OPERATION = Operation(speed=1500.0, roughness=0.8)
LONGEST_STEP = 0.3  # of the ease-off, the most that a step changes it anywhere [um]
LONGEST_SHARE = 0.1  # of the usual step of a setting that hardly moves the flanks
FINER, STEP_COUNT = 10.0**0.5, 8
STILL = 1e-5  # change of the ease-off by a usual step [um], below which a setting does not move the flanks

#: What a number is made of, whose derivative counts where its own all but cancels.
MADE_OF = {
    **dict.fromkeys(("mean_level", "peak_to_peak", "harmonic", "rms"), "transmission_error"),
    **dict.fromkeys(("mean_sliding_loss", "mean_rolling_loss"), "mean_power_loss"),
    "edge_share": "load_share",
    "max_pressure": "pressure",
    "max_root_stress": "root_stress_history",
}


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
        values = cycle_values(cycle, loaded, cases, self.roots).drop_vars("tooth_thickness")
        losses = loss_values(cycle, loaded, OPERATION, FrictionModel())
        ordered = sorted(cases, key=lambda one: (one.torque, one.mesh_position))
        return values.merge(losses, compat="override"), [touching(one) for one in ordered]

    def change(self, cycle: MeshCycle, setting: PairSetting, step: float, touched: list[Array]) -> xr.Dataset:
        """Differences of fourth order; NaN where other segments touch than at the pair itself."""
        moved = [self.numbers(anew(cycle, pair)) for pair in at_places(setting, cycle.geometry.pair, step)]
        same = [all(np.array_equal(at[n], there) for _, at in moved) for n, there in enumerate(touched)]
        values = [one for one, _ in moved]
        found = xr.Dataset({name: _rate([one[name] for one in values], step) for name in values[0]})
        dims = ("torque", "mesh_position")
        alike = xr.DataArray(np.reshape(same, [values[0].sizes[dim] for dim in dims]), dims=dims)
        for name in [name for name in found if "torque" in found[name].dims]:
            own = alike if "mesh_position" in found[name].dims else alike.all("mesh_position")
            found[name] = found[name].where(own)
        return found


def touching(case: LoadedCase) -> Array:
    """Tooth pair, edge and element of the segments in contact, on lines their numbers."""
    here = case.segments
    element = np.where(here.edge < 0, np.arange(here.pair.size), here.element)
    return np.stack([here.pair, here.edge, element])[:, case.solution.force > 0.0]


def departures(
    cycle: MeshCycle, setting: PairSetting, slopes: xr.Dataset, analyses: Analyses, tolerance: float
) -> dict[str, tuple[float, float]]:
    """How far the derivatives by a setting are from differences, relative, and the share that could be compared.

    It is as far as the farther of two differences, one with a step a third of the other. Of such pairs, from long steps
    down, the nearest counts: longer steps curve or meet a change of what touches, and of shorter ones rounding rules.
    """
    own = {str(name): slopes[name].values for name in slopes}
    greatest = {name: float(np.nanmax(np.abs(values), initial=0.0)) for name, values in own.items()}
    size = {name: max(greatest[name], greatest.get(MADE_OF.get(name, name), 0.0), 1e-300) for name in own}
    apart = {name: np.where(np.isfinite(values), np.inf, 0.0) for name, values in own.items()}
    touched, before = analyses.numbers(cycle)[1], dict.fromkeys(own, np.asarray(np.inf))
    step = min(LONGEST_STEP / greatest["ease_off"], LONGEST_SHARE * setting.scale)
    for _ in range(STEP_COUNT):
        change = analyses.change(cycle, setting, step, touched)
        for name, values in own.items():
            by_step = change[name].transpose(*slopes[name].dims).values if change[name].ndim else np.nan
            here = np.nan_to_num(np.abs(by_step - values) / size[name], nan=np.inf)
            apart[name] = np.minimum(apart[name], np.maximum(here, before[name]))
            before[name] = here
        if all(np.all(values < tolerance) for values in apart.values()):
            break
        step /= FINER
    found = {}
    for name, values in apart.items():
        compared = np.isfinite(values)
        found[name] = float(np.max(values[compared], initial=0.0)), float(np.mean(compared))
    return found


def moves(setting: PairSetting, slopes: xr.Dataset) -> bool:
    """Whether a setting moves the flanks at all."""
    return float(np.nanmax(np.abs(slopes["ease_off"].values))) * setting.scale > STILL


def _rate(values: list[xr.DataArray], step: float) -> xr.DataArray:
    """Their derivative; NaN where there are other segments."""
    if len({one.shape for one in values}) > 1:
        return xr.DataArray(np.nan)
    return values[0].copy(data=rate([one.values for one in values], step)).drop_vars(values[0].coords)
