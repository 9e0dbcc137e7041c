"""Flash temperature: moving bands against closed forms and the heat equation, partition of the heat, and results."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest
import xarray as xr
from numpy.typing import NDArray
from runs import output_of, small
from scipy.special import ellipe, ellipk, j1, kve

import easeoff
from easeoff.cases import write_case
from easeoff.cases.schema.friction_table import FrictionTable
from easeoff.core.errors import InputError
from easeoff.friction import FrictionModel, Operation, blok_flash_temperature, flash_temperature, friction, matched_band
from easeoff.friction.contact_temperature import (
    BLOK_FACTOR,
    FAST_LIMIT,
    HOTTEST_PARAMETER,
    Distribution,
    band_temperature,
    greatest_temperature,
    peclet_number,
    rise_per_heat,
    searched_greatest,
)
from easeoff.friction.loaded_contacts import loaded_contacts
from easeoff.friction.operation import ThermalMaterial
from easeoff.study.analysis.key_numbers import key_numbers
from easeoff.study.summary.result_summary import result_summary

Array = NDArray[Any]
STEEL = ThermalMaterial()
POSITIONS = np.array([-0.95, -0.5, 0.0, 0.4, 0.65, 0.95])
WIDTH = 0.2e-3


def velocity_of(peclet: float, material: ThermalMaterial = STEEL) -> float:
    """Velocity at a Peclet number with the half width of these tests."""
    return 2.0 * peclet * material.diffusivity / WIDTH


def uniform_band(position: Array, peclet: Array) -> Array:
    """Temperature (...) within a uniform band at any Peclet number, in closed form; see ``band_temperature``.

    From the integral of exp(z) K0(|z|), which is z exp(z) (K0(|z|) + sign(z) K1(|z|)).
    """
    behind, ahead = peclet * (1.0 + position), peclet * (1.0 - position)
    with np.errstate(invalid="ignore"):
        first, second = (
            np.where(z > 0.0, z * (kve(0, z) + sign * kve(1, z)) * (1.0 if sign > 0 else np.exp(-2.0 * z)), sign)
            for z, sign in ((behind, 1.0), (ahead, -1.0))
        )
    return np.asarray((first + second) / (2.0 * np.pi * peclet))


def fast_band(position: Array, distribution: Distribution = "elliptic") -> Array:
    """Limit of the temperature times the root of the Peclet number, for large ones, in closed form (...).

    Heat flows straight into the material. With m = (1 + xi)/2, uniform sqrt(m/pi); elliptic 8/(3 pi^1.5) [(2 m - 1) E +
    (1 - m) K] with complete elliptic integrals of the parameter m.
    """
    m = 0.5 * (1.0 + np.asarray(position, float))
    if distribution == "uniform":
        return np.sqrt(m / np.pi)
    with np.errstate(invalid="ignore"):
        tail = np.where(m < 1.0, (1.0 - m) * ellipk(m), 0.0)
    return np.asarray(8.0 / (3.0 * np.pi**1.5) * ((2.0 * m - 1.0) * ellipe(m) + tail))


def slow_band(position: Array, peclet: Array, distribution: Distribution = "elliptic") -> Array:
    """Limit of the temperature for small Peclet numbers, in closed form (...).

    Elliptic, [ln(4/L) - gamma + 1/2 - xi^2]/pi; uniform, [ln(2/L) - gamma + 1 - sum of (1 +- xi) ln(1 +- xi)/2]/pi.
    """
    xi = np.asarray(position, float)
    if distribution == "elliptic":
        return np.asarray((np.log(4.0 / peclet) - np.euler_gamma + 0.5 - xi**2) / np.pi)
    ends = sum(0.5 * (1.0 + side * xi) * np.log(np.maximum(1.0 + side * xi, 1e-300)) for side in (1.0, -1.0))
    return np.asarray((np.log(2.0 / peclet) - np.euler_gamma + 1.0 - ends) / np.pi)


def by_fourier(position: Array, peclet: float, distribution: Distribution) -> Array:
    """Surface temperature from the heat equation by Fourier transform along the surface.

    u dT/dx = a (T_xx + T_zz) gives k T~(s) = q~(s)/sqrt(s^2 + i s u/a), u/a = 2 L over the half width.
    """
    nodes, weights = np.polynomial.legendre.leggauss(16)
    panels = np.arange(0.0, 3000.0)
    s = (panels[:, None] + 0.5 * (nodes + 1.0)).ravel()
    ds = np.tile(0.5 * weights, panels.size)
    # The first panels by the root of the wave number: the transform is singular at zero.
    few = 6
    root = np.sqrt(few) * (np.arange(60)[:, None] + 0.5 * (nodes + 1.0)).ravel() / 60
    s = np.concatenate([root**2, s[few * 16 :]])
    ds = np.concatenate([np.tile(0.5 * weights, 60) * np.sqrt(few) / 60 * 2.0 * root, ds[few * 16 :]])
    source = 2.0 * j1(s) / s if distribution == "elliptic" else np.sin(s) / s
    transform = source / np.sqrt(s**2 + 2j * peclet * s)
    return np.asarray((ds * transform * np.exp(1j * s * position[:, None])).sum(axis=1).real / np.pi)


@pytest.mark.parametrize("peclet", [1e-3, 0.1, 1.0, 10.0, 1e3, 1e5])
def test_quadrature_of_a_uniform_band_is_its_closed_form(peclet: float) -> None:
    found = band_temperature(POSITIONS, np.array(peclet), "uniform")
    np.testing.assert_allclose(found, uniform_band(POSITIONS, np.array(peclet)), rtol=1e-9)


@pytest.mark.parametrize("peclet", [0.1, 1.0, 5.0, 30.0])
@pytest.mark.parametrize(("distribution", "tolerance"), [("elliptic", 1e-7), ("uniform", 3e-5)])
def test_bands_solve_the_heat_equation(peclet: float, distribution: Distribution, tolerance: float) -> None:
    """By a way that has no Bessel kernel; the sum over waves converges more slowly where the heat jumps."""
    found = band_temperature(POSITIONS, np.array(peclet), distribution)
    np.testing.assert_allclose(found, by_fourier(POSITIONS, peclet, distribution), rtol=tolerance)


@pytest.mark.parametrize("distribution", ["elliptic", "uniform"])
def test_limits_of_fast_and_slow_bands(distribution: Distribution) -> None:
    inside = POSITIONS[1:-1]
    fast = band_temperature(inside, np.array(1e6), distribution) * np.sqrt(1e6)
    np.testing.assert_allclose(fast, fast_band(inside, distribution), rtol=1e-6)
    slow = band_temperature(POSITIONS, np.array(1e-9), distribution)
    np.testing.assert_allclose(slow, slow_band(POSITIONS, np.array(1e-9), distribution), rtol=1e-8)


def test_published_factors_of_fast_bands() -> None:
    """Uniform heat q over the width d: 2/sqrt(pi) = 1.128 q sqrt(d/(k rho c u)) (Carslaw and Jaeger, section 10.7).

    Its mean over the band is 1.064 q/k sqrt(a b/u) (Jaeger 1942).

    Elliptic heat Q = f w v: 1.11 Q/(sqrt(k rho c u) sqrt(d)) (Blok 1937), at 0.652 of the half width.
    """
    heat_flux, width, velocity = 3e7, 2.0 * WIDTH, 50.0
    effusivity = STEEL.thermal_contact_coefficient
    peclet = velocity * WIDTH / (2.0 * STEEL.diffusivity)
    uniform = float(fast_band(np.array(1.0), "uniform")) / np.sqrt(peclet) * heat_flux * width / STEEL.conductivity
    assert uniform == pytest.approx(
        2.0 / np.sqrt(np.pi) * heat_flux * np.sqrt(width / velocity) / effusivity, rel=1e-12
    )
    nodes, weights = np.polynomial.legendre.leggauss(4)  # of the root of the distance from the front, squared
    root = 0.5 * (nodes + 1.0)
    mean = float(np.sum(weights * root * fast_band(2.0 * root**2 - 1.0, "uniform")))
    factor = mean / np.sqrt(peclet) * 2.0 * WIDTH / np.sqrt(STEEL.diffusivity * WIDTH / velocity)
    assert factor == pytest.approx(1.064, abs=5e-4)
    assert pytest.approx(1.11, abs=2e-3) == BLOK_FACTOR
    assert ellipk(HOTTEST_PARAMETER) == pytest.approx(2.0 * ellipe(HOTTEST_PARAMETER), rel=1e-12)
    fine = np.linspace(-1.0, 1.0, 200_001)
    profile = fast_band(fine)
    assert profile.max() == pytest.approx(FAST_LIMIT, rel=1e-9)
    assert fine[np.argmax(profile)] == pytest.approx(2.0 * HOTTEST_PARAMETER - 1.0, abs=1e-4)


@pytest.mark.parametrize("peclet", [1e-6, 1e-4, 0.03, 1.0, 7.0, 50.0, 999.0, 1001.0, 1e5])
def test_greatest_temperature_is_that_of_the_profile(peclet: float) -> None:
    positions = np.linspace(-0.05, 0.75, 801)
    greatest = band_temperature(positions, np.array(peclet)).max()
    assert float(greatest_temperature(np.array(peclet))) == pytest.approx(float(greatest), rel=1e-6)


def test_greatest_temperature_follows_its_quadrature_and_falls_with_speed() -> None:
    peclet = np.geomspace(1e-4, 1e3, 97)
    np.testing.assert_allclose(greatest_temperature(peclet), searched_greatest(peclet), rtol=1e-7)
    assert np.all(np.diff(greatest_temperature(np.geomspace(1e-14, 1e8, 2000))) <= 0.0)
    assert np.all(np.isfinite(greatest_temperature(np.array([0.0, 1e-300, 1e30]))))


def test_equal_flanks_take_half_the_heat_each() -> None:
    velocity = velocity_of(8.0)
    pinion, gear = rise_per_heat(WIDTH, (velocity, velocity))
    assert pinion == gear
    assert float(flash_temperature(1e4, WIDTH, (velocity, velocity))) == pytest.approx(0.5e4 * float(pinion), rel=1e-14)
    assert matched_band(1e4, WIDTH, (velocity, velocity)).pinion_share == pytest.approx(0.5, rel=1e-12)


@pytest.mark.parametrize("peclet", [0.1, 1.0, 3.0, 10.0, 40.0])
@pytest.mark.parametrize(("ratio", "tolerance"), [(1.0, 2e-4), (0.5, 1.2e-3), (0.2, 5.5e-3), (0.05, 1.5e-2)])
def test_equal_maxima_are_close_to_equal_temperatures_everywhere(peclet: float, ratio: float, tolerance: float) -> None:
    """By the ratio of velocities, at any Peclet number: the range that the page on friction states."""
    velocities = (velocity_of(peclet), ratio * velocity_of(peclet))
    band = matched_band(1e4, WIDTH, velocities, strips=120)
    assert float(flash_temperature(1e4, WIDTH, velocities)) == pytest.approx(band.temperature.max(), rel=tolerance)


def test_flanks_that_move_against_each_other_are_hotter_than_equal_maxima_say() -> None:
    """Each is warmest at another end of the band; gears have no such velocities beside a slide-to-roll ratio of two."""
    velocities = (velocity_of(10.0), -0.5 * velocity_of(10.0))
    excess = matched_band(1e4, WIDTH, velocities).temperature.max() / float(flash_temperature(1e4, WIDTH, velocities))
    assert 1.13 < excess < 1.16


def test_matched_band_by_the_kernel_of_a_point_source_on_either_flank() -> None:
    """One temperature on both: with all of the heat, one flank has the elliptic profile of the quadrature."""
    insulator = ThermalMaterial(conductivity=0.01, density=10.0, heat_capacity=1.0)
    band = matched_band(1e4, WIDTH, (velocity_of(5.0), 1e-3), (STEEL, insulator), strips=400)
    alone = 1e4 / STEEL.conductivity * band_temperature(band.position, np.array(5.0))
    assert band.pinion_share == pytest.approx(1.0, abs=2e-3)
    np.testing.assert_allclose(band.temperature, alone, rtol=2e-3, atol=2e-3 * alone.max())


def test_fast_flanks_follow_blok_and_slow_ones_stay_below() -> None:
    for peclet, excess in ((1.0, 0.0625), (10.0, 9.1e-4), (100.0, 8.2e-6)):
        velocities = (velocity_of(peclet),) * 2
        ratio = float(blok_flash_temperature(1e4, WIDTH, velocities) / flash_temperature(1e4, WIDTH, velocities))
        assert ratio - 1.0 == pytest.approx(excess, rel=0.02)


def test_a_flank_that_stands_still_takes_no_heat() -> None:
    moving, still = velocity_of(20.0), velocity_of(1e-12)
    alone = BLOK_FACTOR * 1e4 / (STEEL.thermal_contact_coefficient * np.sqrt(moving) * np.sqrt(2.0 * WIDTH))
    assert float(blok_flash_temperature(1e4, WIDTH, (moving, 0.0))) == pytest.approx(alone, rel=1e-12)
    pinion, gear = rise_per_heat(WIDTH, (moving, np.array([velocity_of(p) for p in (1.0, 1e-4, 1e-8)])))
    assert np.all(np.diff(pinion / (pinion + gear)) < 0.0)  # the part of the gear, as slowly as a logarithm
    assert np.isfinite(float(flash_temperature(1e4, WIDTH, (moving, still))))
    assert float(flash_temperature(0.0, WIDTH, (0.0, 0.0))) == 0.0


def test_agma_925() -> None:
    """AGMA 925-A03: 31.62 K mu X w/sqrt(b) (v1 - v2)/(B1 sqrt(v1) + B2 sqrt(v2)), N/mm, mm, m/s, N/(mm s^0.5 K).

    K = 0.80 for semi-elliptic heat is 1.11/sqrt(2) = 0.786 rounded up, so that the formula is 1.8 % higher.
    """
    friction_coefficient, load, width, first, second = 0.06, 450.0, 0.25, 30.0, 18.0
    materials = (ThermalMaterial(46.0, 7850.0, 460.0), ThermalMaterial(50.0, 7800.0, 487.0))
    coefficients = [1e-3 * material.thermal_contact_coefficient for material in materials]
    assert coefficients[1] == pytest.approx(13.78, abs=0.01)

    def agma(factor: float) -> float:
        slowed = coefficients[0] * np.sqrt(first) + coefficients[1] * np.sqrt(second)
        load_part = 31.62 * factor * friction_coefficient * load / float(np.sqrt(width))
        return load_part * (first - second) / float(slowed)

    heat = friction_coefficient * 1e3 * load * (first - second)
    found = float(flash_temperature(heat, 1e-3 * width, (first, second), materials))
    assert agma(BLOK_FACTOR / np.sqrt(2.0)) == pytest.approx(found, rel=3e-4)
    assert agma(0.80) / found == pytest.approx(1.018, abs=1e-3)


def test_flash_temperature_is_one_of_dimensionless_numbers() -> None:
    """The same Peclet numbers, heat over conductivity: the same rise, in whatever size and material."""
    other = ThermalMaterial(conductivity=3.0 * 46.0, density=2700.0, heat_capacity=900.0)
    peclets = (12.0, 5.0)
    steel = flash_temperature(1e4, WIDTH, (velocity_of(peclets[0]), velocity_of(peclets[1])))
    scaled = tuple(2.0 * each * other.diffusivity / (7.0 * WIDTH) for each in peclets)
    assert float(flash_temperature(3e4, 7.0 * WIDTH, (scaled[0], scaled[1]), (other, other))) == pytest.approx(
        float(steel), rel=1e-12
    )


def coarse(name: str, **changed: Any) -> easeoff.cases.Case:
    """A case with few mesh positions and nodes, and other tables."""
    return small(name, "shell").model_copy(update=changed)


@pytest.fixture(scope="module")
def tree() -> xr.DataTree:
    return easeoff.analyze(
        coarse("fh-design-a"), torques=[100.0, 500.0], speed=[500.0, 1500.0], temperature=[60.0, 90.0]
    )


def test_heat_over_the_band_is_the_power_loss_of_the_segment(tree: xr.DataTree) -> None:
    """Elliptic pressure over the band of the flash temperature, and what the rolling traction costs."""
    contacts, found = loaded_contacts(tree), tree["friction"].to_dataset()
    at = tuple(contacts.index)
    coefficient = found["friction_coefficient"].values[at]
    sliding = found["sliding_velocity"].values[at[1:]][:, :, None, None]
    across, weights = np.polynomial.chebyshev.chebgauss(64)  # of the weight 1/sqrt(1 - x^2)
    elliptic = np.sum(weights * (1.0 - across**2))
    line_load = elliptic * contacts.hertz_pressure * contacts.half_width
    np.testing.assert_allclose(line_load * contacts.length, contacts.force, rtol=1e-12)
    heat = coefficient * (line_load * contacts.length)[:, None, None, None] * sliding
    whole = np.zeros(found["mesh_power_loss"].shape[:2] + heat.shape[1:])
    np.add.at(whole, at[:2], heat)
    np.testing.assert_allclose(whole.mean(axis=1), found["mean_sliding_loss"], rtol=1e-12)
    lines = contacts.on_line
    assert lines.any()
    assert not lines.all()
    u = [each[:, None, None, None] * Operation([500.0, 1500.0]).angular_velocity[:, None, None]
         for each in contacts.velocities.over_line]  # fmt: skip
    expected = flash_temperature(
        heat / contacts.length[:, None, None, None], contacts.half_width[:, None, None, None], (u[0], u[1])
    )
    np.testing.assert_allclose(found["flash_temperature"].values[at][lines], expected[lines], rtol=1e-12)


def test_values_are_where_contact_lines_carry(tree: xr.DataTree) -> None:
    found, loaded = tree["friction"].to_dataset(), tree["loaded"].to_dataset()
    carries = (loaded["force"] > 0.0) & loaded["overhang"].isnull()
    flash, product = found["flash_temperature"], found["pressure_velocity"]
    np.testing.assert_array_equal(flash.notnull(), carries.broadcast_like(flash).transpose(*flash.dims))
    expected = (loaded["pressure"] * found["sliding_velocity"]).where(carries).transpose(*product.dims)
    np.testing.assert_allclose(product, expected, rtol=1e-12)
    assert (flash.attrs["units"], product.attrs["units"]) == ("K", "MPa m s-1")
    assert float(flash.min()) >= 0.0


def test_greatest_values_and_their_place(tree: xr.DataTree) -> None:
    found, loaded = tree["friction"].to_dataset(), tree["loaded"].to_dataset()
    over = ("mesh_position", "segment")
    greatest = found["flash_temperature"].max(over)
    np.testing.assert_array_equal(found["max_flash_temperature"], greatest.transpose(*found["efficiency"].dims))
    bulk = found["max_contact_temperature"] - found["max_flash_temperature"]
    np.testing.assert_allclose(bulk - found["temperature"], 0.0, atol=1e-12)
    np.testing.assert_array_equal(found["bulk_temperature"], found["temperature"])
    product = found["pressure_velocity"].max(over)
    np.testing.assert_array_equal(found["max_pressure_velocity"].isel(temperature=1, roughness=0), product)
    at = {"torque": 1, "speed": 0, "temperature": 1, "roughness": 0}
    field, hottest = found["flash_temperature"].isel(at), found.isel(at)
    position, segment = np.unravel_index(int(np.nanargmax(field.values)), field.shape)
    assert float(hottest["max_flash_position"]) == float(found["mesh_position"][position])
    for name in ("lengthwise", "profile"):
        assert float(hottest[f"max_flash_{name}"]) == float(loaded[name][1, position, segment])


def test_greatest_values_do_not_need_the_fields(tree: xr.DataTree) -> None:
    """A study of many conditions keeps none over the segments."""
    operation = Operation([500.0, 1500.0], temperature=[60.0, 90.0])
    found = friction(tree, operation, segment_fields=False)
    assert "flash_temperature" not in found
    for name in ("max_flash_temperature", "max_flash_lengthwise", "max_contact_temperature", "max_pressure_velocity"):
        np.testing.assert_array_equal(found[name], tree["friction"][name])


def test_blocks_of_contacts_make_no_difference(tree: xr.DataTree, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("easeoff.friction.efficiency.BLOCK_SIZE", 50)
    found = friction(tree, Operation([500.0, 1500.0], temperature=[60.0, 90.0]))
    for name in (str(each) for each in found.data_vars if str(each).startswith("max_")):
        np.testing.assert_array_equal(found[name], tree["friction"][name])


def test_flash_temperature_does_not_depend_on_the_frame_of_rolling(tree: xr.DataTree) -> None:
    """The heat moves with the contact line, in whatever frame the rolling velocity of the film is taken."""
    operation = Operation(1500.0)
    fixed, moving = (
        friction(tree, operation, model)
        for model in (FrictionModel(0.05), FrictionModel(0.05, rolling_frame="contact_line"))
    )
    np.testing.assert_allclose(fixed["flash_temperature"], moving["flash_temperature"], rtol=1e-12)


def test_velocities_over_the_line_differ_by_the_sliding_and_have_the_rolling_as_mean(tree: xr.DataTree) -> None:
    v = loaded_contacts(tree).velocities
    pinion, gear = v.over_line
    np.testing.assert_allclose(pinion - gear, v.sliding_across, rtol=1e-12, atol=1e-12 * np.abs(pinion).max())
    np.testing.assert_allclose(0.5 * (pinion + gear), v.rolling_over_line, rtol=1e-12)
    assert np.all(np.sign(pinion) == np.sign(gear))


def test_teeth_of_another_material_and_temperature(tree: xr.DataTree) -> None:
    operation = Operation(1500.0, bulk_temperature=110.0)
    steel = friction(tree, operation, FrictionModel(0.05))
    mixed = friction(
        tree, operation, FrictionModel(0.05, tooth_conductivity=(46.0, 0.3), tooth_density=(7850.0, 1400.0))
    )
    ratio = mixed["max_flash_temperature"] / steel["max_flash_temperature"]
    assert float(ratio.min()) > 1.5  # a gear of plastic leaves nearly all of the heat to the pinion
    np.testing.assert_allclose(steel["max_contact_temperature"], 110.0 + steel["max_flash_temperature"], rtol=1e-14)
    assert list(mixed.attrs["tooth_conductivity"]) == [46.0, 0.3]


@pytest.mark.thorough
def test_friction_fed_back() -> None:
    """Fields of its own loads, and maxima that are those of the fields."""
    found = easeoff.analyze(
        coarse("nasa-12x36"), torques=200.0, speed=1500.0, temperature=[60.0, 90.0], friction_feedback=True
    )["friction"].to_dataset()
    over = ("mesh_position", "segment")
    for field, greatest in (
        ("flash_temperature", "max_flash_temperature"),
        ("pressure_velocity", "max_pressure_velocity"),
    ):
        assert set(found[field].dims) == {"torque", *over, "speed", "temperature", "roughness"}
        values = found[field].max(over).transpose(*found[greatest].dims)
        np.testing.assert_array_equal(values, found[greatest])


def test_summary_and_key_numbers_tell_them(tree: xr.DataTree) -> None:
    numbers, text = key_numbers(tree), result_summary(tree)
    hottest = float(numbers["max_flash_temperature"].max())
    assert "Contact temperature" in text
    assert f"{hottest:.1f}" in text
    assert max(map(len, text.splitlines())) <= 100
    old = tree.copy()
    old["friction"] = xr.DataTree(
        tree["friction"].to_dataset().drop_vars([n for n in tree["friction"].data_vars if "flash" in str(n)])
    )
    assert "Contact temperature" not in result_summary(old)


def test_keys_of_a_case(tmp_path: Path) -> None:
    table = FrictionTable(speed=(1500.0,), bulk_temperature=70.0, tooth_conductivity=(46.0, 20.0))
    case = coarse("nasa-12x36", friction=table)
    write_case(case, tmp_path / "case.toml")
    read = easeoff.read_case(tmp_path / "case.toml")
    assert read.friction is not None
    assert (read.friction.bulk_temperature, read.friction.tooth_conductivity) == (70.0, (46.0, 20.0))
    output_of("run", tmp_path / "case.toml", "-o", tmp_path / "a.nc", "--torque", 100)
    found = easeoff.read_result(tmp_path / "a.nc")["friction"].to_dataset()
    assert float(found["bulk_temperature"][0]) == 70.0
    assert list(found.attrs["tooth_conductivity"]) == [46.0, 20.0]


@pytest.mark.parametrize(
    ("values", "message"),
    [
        ({"tooth_conductivity": 0.0}, r"tooth_conductivity = 0.*: must be a number from 0.01 to 10000 \[W/\(m K\)\]"),
        ({"tooth_density": (7850.0,)}, "tooth_density = .*: must be a number, or a pair for pinion and gear"),
        ({"tooth_heat_capacity": (460.0, "x")}, "tooth_heat_capacity = 'x': must be a number from 1 to"),
    ],
)
def test_impossible_materials_are_refused(values: dict[str, Any], message: str) -> None:
    with pytest.raises(InputError, match=message):
        FrictionModel(**values)


def test_impossible_conditions_are_refused() -> None:
    with pytest.raises(InputError, match=r"bulk_temperature = -300: must be a number above -273\.15"):
        Operation(1000.0, bulk_temperature=-300.0)
    with pytest.raises(InputError, match="half_width"):
        matched_band(1e4, 0.0, (1.0, 1.0))
    with pytest.raises(InputError, match="velocity"):
        matched_band(1e4, WIDTH, (1.0, 0.0))
    with pytest.raises(InputError, match="conductivity = -1"):
        ThermalMaterial(conductivity=-1.0)
    assert float(peclet_number(-2.0, WIDTH, STEEL)) == float(peclet_number(2.0, WIDTH, STEEL))


@pytest.mark.parametrize(
    ("found", "known"),
    [
        (band_temperature(np.array(0.65), np.array(10.0)), 0.1755),
        (fast_band(np.array(1.0), "uniform"), 0.5642),
        (fast_band(np.array(1.0)), 0.4789),
        (slow_band(np.array(0.0), np.array(1e-4)), 3.3484),
        (greatest_temperature(np.array([0.1, 1.0, 10.0, 100.0])), [1.1571, 0.5231, 0.1756, 0.0556]),
        (1e-3 * peclet_number(2.0, 0.3e-3, ThermalMaterial()), 0.0235),
        (1e-5 * ThermalMaterial().thermal_contact_coefficient, 0.12888),
    ],
)
def test_temperatures_of_bands_have_their_known_values(found: Array, known: Any) -> None:
    np.testing.assert_allclose(found, known, atol=5.1e-5)


def test_the_slower_flank_is_heated_more_by_the_root_of_the_velocities() -> None:
    pinion, gear = rise_per_heat(0.3e-3, (4.0, 1.0))
    assert gear / pinion == pytest.approx(1.999, abs=5e-4)
