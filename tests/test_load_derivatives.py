"""Derivatives of root stress, losses and place of the load: against differences of the whole and identities."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
import xarray as xr
from held_teeth import anew
from numpy.typing import NDArray
from whole_differences import OPERATION, Analyses, coarse, coarse_cycle, departures, longest_step

from easeoff.cases import gear_pair, read_case
from easeoff.contact import MeshCycle
from easeoff.contact.compliance import body_coupling
from easeoff.contact.compliance.finite_elements.stress_response import StressResponse
from easeoff.contact.evaluation.derivatives.cycle_slopes import CycleSlopes
from easeoff.contact.evaluation.load_spot import load_spot
from easeoff.contact.load_capacity.tooth_root_stress import root_stress
from easeoff.friction import FrictionModel, friction
from easeoff.geometry.pair.gear_pair import tooth_angles
from easeoff.geometry.pair.pair_setting import PairSetting
from easeoff.geometry.pair.thickness_slopes import mean_thicknesses, thickness_slopes
from easeoff.study import CaseInMesh, derivatives
from easeoff.study.analysis.loss_slopes import loss_slopes, loss_values

Array = NDArray[Any]

SETTINGS = (PairSetting("pinion", "radial_distance"), PairSetting("gear", "pressure_angle"))
TORQUES = [100.0, 250.0]
STEP_SHARE = 2.5e-6  # of the usual step of a setting; errors fall with its square, to 1e-6 here
TOLERANCE = 1e-6


@pytest.fixture(autouse=True)
def all_shared_modes(monkeypatch: pytest.MonkeyPatch) -> None:
    """Those that are left out change no digit of a result, but all digits of a difference over 1e-5."""
    monkeypatch.setattr(body_coupling, "DROPPED_SHARE", 1e-15)


def loss_of(cycle: MeshCycle, loaded: xr.Dataset) -> xr.Dataset:
    tree = xr.DataTree.from_dict({"ease_off": cycle.geometry.ease_off, "loaded": loaded})
    return friction(tree, OPERATION, FrictionModel(), segment_fields=False)


def test_values_are_those_of_the_friction_stage() -> None:
    cycle = coarse_cycle("nasa-12x36")
    loaded, _ = cycle.loaded(TORQUES)
    whole, values = loss_of(cycle, loaded), loss_values(cycle, loaded, OPERATION, FrictionModel())
    for name in values:
        np.testing.assert_array_equal(values[name], whole[name])


@pytest.mark.quick(1)
@pytest.mark.parametrize("setting", SETTINGS, ids=lambda one: f"{one.of}_{one.name}")
def test_losses_and_place_of_the_load_agree_with_differences(setting: PairSetting) -> None:
    cycle = coarse_cycle("nasa-12x36")
    loaded, cases = cycle.loaded(TORQUES)
    found = CycleSlopes.of(cycle, [setting], cases)
    slopes, step = found.datasets(loaded)[1], STEP_SHARE * setting.scale
    values, of_loss = loss_slopes(found, loaded, OPERATION, FrictionModel())
    whole = loss_of(cycle, loaded)
    np.testing.assert_array_equal(values["mean_power_loss"], whole["mean_power_loss"])
    np.testing.assert_array_equal(values["efficiency"], whole["efficiency"])
    moved = [anew(cycle, setting.moved(cycle.geometry.pair, sign * step)) for sign in (1.0, -1.0)]
    both = [(one, one.loaded(TORQUES)[0]) for one in moved]
    spots = [load_spot(one) for _, one in both]
    for name in spots[0]:
        change = (spots[0][name][1] - spots[1][name][1]) / (2.0 * step)
        # At one torque the derivative may be next to nothing, and rounding of the difference is not.
        rounding = 1e-5 * np.abs(change).max()
        np.testing.assert_allclose(slopes[name].values[:, 0], change, rtol=1e-4, atol=rounding, err_msg=name)
    ahead, behind = (loss_of(*one) for one in both)
    for name in ("mean_power_loss", "efficiency", "mean_friction_coefficient"):
        change = ((ahead[name] - behind[name]) / (2.0 * step)).values
        np.testing.assert_allclose(of_loss[name].values[..., 0], change, rtol=1e-5, err_msg=name)


def test_loss_follows_the_torque() -> None:
    cycle, step = coarse_cycle("nasa-12x36"), 1e-3
    loaded, cases = cycle.loaded(TORQUES)
    found = CycleSlopes.of(cycle, SETTINGS[:1], cases)
    slopes = loss_slopes(found, loaded, OPERATION, FrictionModel())[1]
    ahead, behind = (loss_of(cycle, cycle.loaded(np.array(TORQUES) + sign * step)[0]) for sign in (1.0, -1.0))
    change = (ahead["mean_power_loss"].values - behind["mean_power_loss"].values) / (2.0 * step)
    np.testing.assert_allclose(slopes["mean_power_loss"].values[..., -1], change, rtol=1e-5)
    # Twice pi times the speed over a minute is what a newton metre more brings in.
    np.testing.assert_allclose(slopes["input_power"].values[..., -1], np.pi * 1500.0 / 30.0, rtol=1e-9)
    np.testing.assert_allclose(slopes["input_power"].values[..., 0], 0.0, atol=1e-6)


def test_gradient_of_the_largest_stress_gives_it_back() -> None:
    """Stress is linear in the forces, so that its largest principal one is homogeneous."""
    generator = np.random.default_rng(5)
    root = StressResponse(np.linspace(0.1, 0.9, 3), generator.normal(size=(3, 4, 6, 5)))
    forces = generator.uniform(0.5, 1.0, size=(5, 7))
    gradient, largest = root.gradients(forces), root.largest(forces).max(axis=0)
    np.testing.assert_allclose(np.sum(gradient * forces, axis=0), largest, rtol=1e-12)
    change = generator.normal(size=forces.shape)
    ahead, behind = (root.largest(forces + sign * 1e-6 * change).max(axis=0) for sign in (1.0, -1.0))
    np.testing.assert_allclose(np.sum(gradient * change, axis=0), (ahead - behind) / 2e-6, rtol=1e-6)


@pytest.mark.thorough
@pytest.mark.parametrize("name", ["fm-11x41", "fh-12x41-45", "fh-design-a", "fh-design-b"])
def test_root_stress_agrees_with_differences(name: str) -> None:
    state = CaseInMesh.of(coarse(name, "fe"))
    cycle, teeth = state.cycle, state.teeth
    assert teeth is not None
    loaded, cases = cycle.loaded(TORQUES)
    analyses = Analyses(tuple(TORQUES), roots=teeth)
    slopes = analyses.slopes(cycle, list(SETTINGS))
    told, values = root_stress(cycle.fields, teeth, cases, loaded), analyses.numbers(cycle)[0]
    np.testing.assert_array_equal(values["max_root_stress"], told["max_root_stress"])
    for number, setting in enumerate(SETTINGS):
        own = slopes.isel(setting=number)
        found = departures(analyses.along(cycle, setting), own, longest_step(setting, own), TOLERANCE)
        for variable in ("root_stress_history", "max_root_stress"):
            assert found[variable].farther < TOLERANCE, (setting, variable)
            assert found[variable].compared > 0.7, (setting, variable)
    # More torque, more stress, in every root.
    assert (slopes["max_root_stress"].isel(setting=-1) > 0.0).all()


@pytest.mark.parametrize("name", ["fm-11x41", "fh-design-a"])
def test_thickness_follows_the_gear_cutter_alone(name: str) -> None:
    pair = gear_pair(read_case(name))
    by_radius, by_distance = PairSetting("gear", "point_radius"), PairSetting("pinion", "radial_distance")
    slopes = thickness_slopes(pair, [by_radius, by_distance, PairSetting("assembly", "offset")])
    assert slopes[1, 0] > 0.0 > slopes[0, 0]
    # The pinion's other flank follows the loaded one: no more changes than the angle at which the tooth stands.
    assert abs(slopes[0, 1]) < 0.1
    assert slopes[1, 1] == 0.0
    assert np.all(slopes[:, 2] == 0.0)
    # Both teeth fill the pitch: what the gear's angle gains the pinion's loses.
    step = 1e-3 * by_radius.scale
    ahead, behind = (np.array(tooth_angles(by_radius.moved(pair, sign * step))) for sign in (1.0, -1.0))
    counts = np.array([pair.pinion.teeth, pair.gear.teeth])
    assert np.sum(counts * (ahead - behind)) == pytest.approx(0.0, abs=1e-12)
    own = mean_thicknesses(pair)[0] / tooth_angles(pair)[0] * (ahead - behind)[0] / (2.0 * step)
    assert slopes[0, 0] == pytest.approx(own, rel=1e-6)


def test_user_gets_losses_with_a_speed_and_the_torque_alone() -> None:
    tree = derivatives(coarse("nasa-12x36"), ["torque"], torques=TORQUES, speed=[1000.0, 2000.0])
    slopes = tree["derivatives"].to_dataset()
    assert slopes["setting"].values.tolist() == ["torque"]
    assert slopes["mean_power_loss"].dims == ("torque", "speed", "temperature", "roughness", "setting")
    assert slopes["efficiency"].attrs["units"] == "1 per setting_units"
    assert (slopes["mean_power_loss"] > 0.0).all()
    assert tree.attrs["edge_contact"] == 1
    assert (slopes["tooth_thickness"] == 0.0).all()


def test_user_gets_losses_by_deviations() -> None:
    tree = derivatives(coarse("nasa-12x36"), ["modification.bias"], torques=TORQUES, speed=[1000.0])
    slopes = tree["derivatives"].to_dataset()
    share = slopes["mean_power_loss"] / slopes["efficiency"]
    power = np.array(TORQUES) * np.pi * 1000.0 / 30.0
    np.testing.assert_allclose(share.values.ravel(), -power, rtol=1e-9)
