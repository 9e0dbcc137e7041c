"""Film, friction coefficient and rolling traction of line contacts, against published and restored numbers."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from easeoff import InputError
from easeoff.friction import (
    COEFFICIENTS,
    FILMS,
    THERMAL_FACTORS,
    ContactConditions,
    formula_flags,
    friction_coefficient,
    kolivand_formula as module,
    lubricant,
    rolling_traction,
)
from easeoff.friction.coefficient import coefficient_model, contact_conditions, xu_kahraman
from easeoff.friction.conditions import dowson_higginson, pan_hamrock
from easeoff.friction.efficiency import isothermal_traction

# Pressure GPa, radius mm, rolling m/s, slide-to-roll, degC, roughness um: film um, lambda, coefficient; then, where
# they are known too, the expressions of the other regimes there. From another implementation of the restored Eq. 5.11.
GOLDEN = [
    (0.7, 42.0, 2.2, 0.45, 90.0, 0.8, 0.8, 0.2169, 0.1917, 0.05099, None, None),
    (1.0, 20.0, 1.0, 0.1, 100.0, 1.0, 1.0, 0.0728, 0.0515, 0.05630, None, None),
    (1.5, 20.0, 10.0, 0.5, 75.0, 0.35, 0.6, 0.5678, 0.8175, 0.02340, 0.02409, 0.02442),
    (1.0, 20.0, 10.0, 0.25, 50.0, 0.1, 0.35, 1.2941, 3.5551, 0.01879, 0.01950, None),
    (0.5, 40.0, 20.0, 0.05, 75.0, 0.35, 0.35, 1.5045, 3.0396, 0.00335, 0.00323, None),
    (2.0, 40.0, 10.0, 0.5, 25.0, 0.1, 0.1, 3.5221, 24.905, 0.01941, 0.02270, None),
]


def conditions(
    pressure: Any = 1.0,
    radius: Any = 20.0,
    rolling: Any = 5.0,
    ratio: Any = 0.3,
    temperature: Any = 75.0,
    pinion: Any = 0.5,
    gear: Any = 0.5,
    **others: Any,
) -> ContactConditions:
    """Conditions in the units of the table above."""
    return contact_conditions(
        hertz_pressure=1e9 * np.asarray(pressure),
        equivalent_radius=1e-3 * np.asarray(radius),
        rolling_velocity=rolling,
        slide_to_roll=ratio,
        temperature=temperature,
        roughness=(1e-6 * np.asarray(pinion), 1e-6 * np.asarray(gear)),
        **others,
    )


def as_tabulated(*values: float) -> ContactConditions:
    """Conditions with the viscosity on a straight line of its logarithm, as in the table above."""
    here = conditions(*values)
    state = lubricant("75w90").at(here.temperature, interpolation="log_linear")
    return replace(here, viscosity=state.viscosity)


def half_a_digit(number: float, digits: int) -> float:
    """Tolerance of a number printed with so many decimals."""
    return 0.51 * 10.0**-digits


@pytest.mark.parametrize("row", GOLDEN)
def test_golden_numbers_to_their_digits(row: tuple[float, ...]) -> None:
    here = as_tabulated(*row[:7])
    assert 1e6 * here.film_thickness == pytest.approx(row[7], abs=half_a_digit(row[7], 4))
    assert here.lambda_ratio == pytest.approx(row[8], abs=half_a_digit(row[8], 3 if row[8] > 10 else 4))
    assert module.formula_coefficient(here) == pytest.approx(row[9], abs=half_a_digit(row[9], 5))
    ratio, _, groups = module._arguments(here)
    for expression, expected in zip((module._transition, module._full_film), row[10:], strict=True):
        if expected is not None:
            assert np.exp(expression(groups, ratio)) == pytest.approx(expected, abs=half_a_digit(expected, 5))


def as_printed(c: ContactConditions) -> float:
    """Eq. 5.11 as a product of powers, one contact, with the coefficients typed in once more."""
    a = [-0.62538, -51.411, -0.0371532, 2.06770, -0.031750, -0.046276, -7.754e-5, 1.18821, 0.170432, -0.136892, -7.8882]
    b = [16.1512, -0.60156, -0.0466305, -0.348239, -0.358514, 22.568, -11.2295, -6.49095, -1.31986, -0.881279, -4398.1]
    k = [5.0435, -0.00576307, 248228480.0, -0.396002, -0.405254, 35.618, -0.109382, -0.112364, -0.00016056, -0.0690238,
         -0.00038810, 0.052821]  # fmt: skip
    radius, first, second = float(c.equivalent_radius), float(c.roughness_pinion), float(c.roughness_gear)
    modulus, velocity, viscosity = c.contact_modulus, float(c.rolling_velocity), float(c.viscosity)
    u, g = viscosity * velocity / (modulus * radius), float(c.pressure_viscosity) * modulus
    h, sr = float(c.hertz_pressure) / modulus, float(c.slide_to_roll)
    load = 2 * np.pi * h**2
    ratio = radius * 1.714 * u**0.694 * g**0.568 * load**-0.128 / np.sqrt(first**2 + second**2)
    sc = np.sqrt(first**2 + second**2) / radius
    seq = first * second / (first + second) / radius
    ln = np.log
    if ratio < 1.0:
        return float(
            np.exp(a[0] + h * (a[1] * sr + a[2] * g) + a[3] * ratio**2)
            * sr ** (a[4] * ln(g) + a[5] * ln(sc))
            * h ** (a[6] * g + a[7] * ratio)
            * ratio ** (a[8] * ln(ratio) + a[9] * ln(sc))
            * seq ** (a[10] * h)
        )
    if ratio < 3.0:
        return float(
            np.exp(b[0] + b[1] * sr)
            * sr ** (b[2] * ln(u) + b[3] * ln(g) + b[4] * ln(h) + b[5] * h)
            * u ** (b[6] * h)
            * g ** (b[7] + b[8] * ln(h))
            * h ** (b[9] * ln(h))
            * ratio ** (b[10] * sc)
        )
    return float(
        np.exp(k[0] + k[1] * g + k[2] * sr * u)
        * sr ** (k[3] * ln(g) + k[4] * ln(h) + k[5] * h + k[6] * ln(ratio) + k[7] * ln(sc))
        * u ** (k[8] * g + k[9] * ln(h))
        * h ** (k[10] * g)
        * seq ** (k[11] * sr)
    )


def in_the_study(count: int, seed: int = 0) -> ContactConditions:
    """Random conditions within the data of the regression."""
    draw = np.random.default_rng(seed).uniform
    return conditions(
        draw(0.5, 2.5, count),
        draw(5.0, 40.0, count),
        draw(1.0, 20.0, count),
        draw(0.025, 1.0, count),
        draw(25.0, 100.0, count),
        draw(0.1, 1.0, count),
        draw(0.1, 1.0, count),
    )


def one(c: ContactConditions, i: int) -> ContactConditions:
    names = [n for n, v in vars(c).items() if isinstance(v, np.ndarray) and n in ContactConditions.__dataclass_fields__]
    return replace(c, **{name: getattr(c, name)[i] for name in names})


def test_formula_is_the_printed_product_in_all_regimes() -> None:
    many = in_the_study(300)
    found = module.formula_coefficient(many)
    ratio = many.lambda_ratio
    assert min(np.sum(ratio < 1.0), np.sum((ratio >= 1.0) & (ratio < 3.0)), np.sum(ratio >= 3.0)) > 20
    for i in range(300):
        assert found[i] == pytest.approx(as_printed(one(many, i)), rel=1e-11)
    assert not np.any(formula_flags(many))


def test_formula_stays_where_the_study_found_it() -> None:
    """Over the whole design: between 0.0009 and 0.16, the median below 0.04 in every regime."""
    many = in_the_study(20_000, 1)
    found, ratio = module.formula_coefficient(many), many.lambda_ratio
    assert found.min() > 0.0005
    assert found.max() < 0.2
    for low, high in ((0.0, 1.0), (1.0, 3.0), (3.0, np.inf)):
        assert 0.01 < np.median(found[(ratio >= low) & (ratio < high)]) < 0.045


def the_study() -> ContactConditions:
    """All conditions of Table 5.1; of a pair of roughnesses the order does not matter."""
    levels = (
        [0.5, 1.0, 1.5, 2.0, 2.5],
        [5.0, 20.0, 40.0],
        [1.0, 5.0, 10.0, 15.0, 20.0],
        [0.025, 0.05, 0.1, 0.25, 0.5, 0.75, 1.0],
        [25.0, 50.0, 75.0, 100.0],
        [0.1, 0.35, 0.6, 0.85, 1.0],
        [0.1, 0.35, 0.6, 0.85, 1.0],
    )
    grid = np.stack([axis.ravel() for axis in np.meshgrid(*levels, indexing="ij")])
    return conditions(*grid[:, grid[5] <= grid[6]])


def test_limits_are_those_of_the_study() -> None:
    """31,500 conditions, as many as the dissertation counts: none is clamped, and the limits lie close about them."""
    study = the_study()
    found = module.formula_coefficient(study)
    assert found.size == 31_500
    assert not np.any(formula_flags(study))
    low, high = module.COEFFICIENT_LIMITS
    assert 0.99 * found.min() < low < found.min()
    assert found.max() < high < 1.001 * found.max()
    assert 0.999 < float(study.lambda_ratio.min()) / module.LAMBDA_MINIMUM < 1.01


@pytest.mark.parametrize("blend", [False, True])
def test_far_outside_the_coefficient_stays_within_the_study_and_is_flagged(blend: bool) -> None:
    """Rough flanks at a crawl would have more than one, thick cold films next to nothing."""
    axes = (
        [1e-3, 0.1, 1.0, 4.0],
        [1.0, 20.0, 200.0],
        [1e-3, 1.0, 100.0],
        [0.0, 0.3, 5.0],
        [25.0, 100.0],
        [0.0, 1.0, 9.0],
        [0.5],
    )
    far = conditions(*(axis.ravel() for axis in np.meshgrid(*axes, indexing="ij")))
    found, flags = module.formula_coefficient(far, blend=blend), formula_flags(far)
    assert (found.min(), found.max()) == module.COEFFICIENT_LIMITS
    if not blend:
        np.testing.assert_array_equal(np.isin(found, module.COEFFICIENT_LIMITS), flags & 512 != 0)
        # Nothing is limited that is not outside in some other way.
        assert np.all(flags[flags & 512 != 0] > 512)


def test_trends_of_the_text() -> None:
    """Smooth flanks: hotter oil, less friction; rough ones: more. Fast: less than slow (Kolivand 2009, section 5.3)."""
    hot = [50.0, 75.0, 100.0]
    smooth = module.formula_coefficient(conditions(0.7, 42.0, 2.2, 0.45, hot, 0.1, 0.1))
    rough = module.formula_coefficient(conditions(0.7, 42.0, 2.2, 0.45, hot, 0.5, 0.5))
    np.testing.assert_allclose(smooth, [0.0168, 0.0146, 0.0117], atol=0.51e-4)
    np.testing.assert_allclose(rough, [0.0152, 0.0313, 0.0401], atol=1.01e-4)
    speeds = module.formula_coefficient(
        conditions(0.7, 42.0, 2.2 * np.array([500, 1500, 3000]) / 1500, 0.45, 90, 0.8, 0.8)
    )
    assert np.all(np.diff(speeds) < 0.0)


def test_blend_is_smooth_and_leaves_the_rest_alone() -> None:
    rolling = np.geomspace(1.0, 400.0, 4001)
    here = conditions(1.0, 20.0, rolling, 0.3, 60.0, 0.6, 0.6)
    ratio = here.lambda_ratio
    assert ratio.min() < 0.8
    assert ratio.max() > 4.0
    sharp, smooth = (module.formula_coefficient(here, blend=blend) for blend in (False, True))
    steps = np.abs(np.diff(np.log(smooth)))
    assert steps.max() < 0.006
    assert np.abs(np.diff(np.log(sharp))).max() > 0.05
    away = (ratio < 0.9) | ((ratio > 1.1) & (ratio < 2.7)) | (ratio > 3.3)
    np.testing.assert_array_equal(sharp[away], smooth[away])
    np.testing.assert_array_equal(friction_coefficient("kolivand_blended", **arguments(rolling)), smooth)


def arguments(rolling: Any) -> dict[str, Any]:
    return {
        "hertz_pressure": 1e9,
        "equivalent_radius": 0.02,
        "rolling_velocity": rolling,
        "slide_to_roll": 0.3,
        "temperature": 60.0,
        "roughness": 0.6e-6,
    }


THICK = {"rolling": 19.0, "film": "same", "pinion": 0.2, "gear": 0.2}


@pytest.mark.parametrize(
    ("clamped", "taken", "flag"),
    [
        ({"ratio": 0.0}, {"ratio": 0.025}, 1),
        ({"ratio": 2.0}, {"ratio": 1.0}, 1),
        ({"pinion": 0.0, "gear": 0.0, "rolling": 1.5}, {"pinion": 0.1, "gear": 0.1, "rolling": 1.5}, 4),
        ({"pressure": 3.0, "rolling": 2.0, "film": "same"}, {"pressure": 2.5, "rolling": 2.0, "film": "same"}, 2),
        ({"pressure": 0.3, **THICK}, {"pressure": 0.5, **THICK}, 2),
    ],
)
def test_clamped_inputs_count_as_the_limit_and_are_flagged(
    clamped: dict[str, Any], taken: dict[str, Any], flag: int, monkeypatch: pytest.MonkeyPatch
) -> None:
    # The lambda ratio is that of the true pressure; a film that knows no load shows the rest.
    monkeypatch.setitem(FILMS, "same", lambda u, g, w: 12.0 * u**0.7 * g**0.54)
    limit = conditions(**taken)
    assert formula_flags(limit) == 0
    beyond = conditions(**clamped)
    assert formula_flags(beyond) == flag
    assert module.formula_coefficient(beyond) == pytest.approx(float(module.formula_coefficient(limit)), rel=1e-12)


def test_a_crawl_counts_as_the_least_lambda_of_the_study() -> None:
    """Without that the expression grows without limit as lambda goes to zero."""
    crawl = conditions(rolling=np.array([1e-6, 1e-4, 1e-2]), pinion=1.0, gear=1.0)
    found = module.formula_coefficient(crawl)
    np.testing.assert_allclose(found, found[0], rtol=1e-13)
    assert np.all(formula_flags(crawl) == 256 + 32)
    # The film grows with the velocity to the power of 0.694.
    fast = conditions(rolling=1.0, pinion=1.0, gear=1.0)
    limit = (0.0266 / float(fast.lambda_ratio)) ** (1 / 0.694)
    assert as_printed(conditions(rolling=limit, pinion=1.0, gear=1.0)) == pytest.approx(found[0], rel=1e-10)
    corner = conditions(2.5, 5.0, 1.0, 0.3, 100.0, 1.0, 1.0)
    assert corner.lambda_ratio == pytest.approx(0.0266, abs=0.51e-4)


@pytest.mark.parametrize(
    ("changed", "flag"),
    [
        ({"pressure": 0.3, "rolling": 1.0}, 8),
        ({"radius": 42.0}, 16),
        ({"radius": 4.0}, 16),
        ({"rolling": 0.5}, 32),
        ({"gear": 1.2}, 64),
        ({"temperature": 120.0, "out_of_range": "clamp"}, 128),
        ({"radius": 42.0, "rolling": 21.0, "ratio": 0.0}, 49),
    ],
)
def test_extrapolated_inputs_are_flagged(changed: dict[str, Any], flag: int) -> None:
    assert formula_flags(conditions(**changed)) == flag


def test_limits_are_finite() -> None:
    """No sliding, no roughness, almost no load, a crawl: a coefficient, not a division by zero."""
    here = conditions([1e-6, 1.0, 5.0], 20.0, np.array([[1e-4], [1.0], [1e3]]), 0.0, 75.0, 0.0, 0.0)
    for model in COEFFICIENTS.values():
        found = np.broadcast_to(model(here), (3, 3))
        assert np.all(np.isfinite(found))
        assert np.all((found >= 0.0) & (found < 0.3))
    assert np.all(np.isinf(here.lambda_ratio))


@pytest.mark.parametrize("film", ["pan_hamrock", "dowson_higginson"])
def test_no_result_depends_on_the_units(film: str) -> None:
    """Other units of length, time and mass: ratios stay, the traction changes as a force over a length does."""
    here = conditions(film=film)
    length, time, mass = 1.1, 0.93, 1.04  # small: the formula's clamps are in Pa and m
    pressure, velocity = mass / (length * time**2), length / time
    other = replace(
        here,
        hertz_pressure=here.hertz_pressure * pressure,
        contact_modulus=here.contact_modulus * pressure,
        equivalent_radius=here.equivalent_radius * length,
        roughness_pinion=here.roughness_pinion * length,
        roughness_gear=here.roughness_gear * length,
        rolling_velocity=here.rolling_velocity * velocity,
        sliding_velocity=here.sliding_velocity * velocity,
        viscosity=here.viscosity * pressure * time,
        pressure_viscosity=here.pressure_viscosity / pressure,
        thermal_conductivity=here.thermal_conductivity * mass * length / time**3,
    )
    assert other.lambda_ratio == pytest.approx(float(here.lambda_ratio), rel=1e-13)
    assert other.film_thickness == pytest.approx(float(here.film_thickness * length), rel=1e-13)
    assert module.formula_coefficient(other) == pytest.approx(float(module.formula_coefficient(here)), rel=1e-12)
    for name in THERMAL_FACTORS:
        expected = float(rolling_traction(here, name) * mass / time**2)
        assert rolling_traction(other, name) == pytest.approx(expected, rel=1e-12)


def test_load_is_that_of_hertz() -> None:
    """p = sqrt(f E' / (2 pi R)), and half the width times it times pi/2 is the load."""
    here = conditions(1.3, 25.0)
    pressure = np.sqrt(here.load * here.contact_modulus / (2 * np.pi * here.equivalent_radius))
    assert pressure == pytest.approx(1.3e9)
    half_width = 4.0 * here.equivalent_radius * here.pressure_parameter
    assert here.load == pytest.approx(0.5 * np.pi * half_width * here.hertz_pressure)


# Smooth steady line contacts, U, G, W and what the two formulas give in um at the radius in mm.
SMOOTH = [
    (2.20e-11, 3159.0, 3.04e-5, 20.0, 0.5058, 0.5500),
    (2.29e-11, 2591.0, 5.96e-5, 20.0, 0.4267, 0.4660),
    (5.49e-11, 3159.0, 1.22e-4, 20.0, 0.8000, 0.8722),
    (3.06e-12, 2364.0, 1.22e-4, 40.0, 0.1829, 0.1976),
]


@pytest.mark.parametrize(("u", "g", "w", "radius", "pan", "dowson"), SMOOTH)
def test_film_formulas(u: float, g: float, w: float, radius: float, pan: float, dowson: float) -> None:
    speed, material, load = np.array(u), np.array(g), np.array(w)
    assert 1e3 * radius * pan_hamrock(speed, material, load) == pytest.approx(pan, rel=4e-3)
    assert 1e3 * radius * dowson_higginson(speed, material, load) == pytest.approx(dowson, rel=4e-3)


def test_rolling_traction_is_the_isothermal_part_of_the_thermal_formula() -> None:
    """Goksem and Hargreaves: F = f R K / alpha with ln K linear in ln D; without heating it is Eq. 5.10."""
    many = in_the_study(200, 2)
    group = 11.81221 * many.material_parameter * many.speed_parameter / many.load_parameter**1.5
    factor = np.exp(0.658228 * np.log(group) - 0.162625)
    whole = many.load_parameter * many.equivalent_radius / many.pressure_viscosity * factor
    np.testing.assert_allclose(isothermal_traction(many), whole, rtol=8e-3)


def test_whole_thermal_formula_is_traction_times_factor() -> None:
    """The formula with its thermal terms left in one exponent."""
    many = in_the_study(200, 3)
    heat = many.thermal_parameter
    group = 11.81221 * many.material_parameter * many.speed_parameter / many.load_parameter**1.5
    exponent = (0.658228 + 0.0106383 * heat**0.31746) * np.log(group)
    exponent -= 0.162625 + np.log(1.0 + 0.411483 * heat**0.707071)
    whole = many.load_parameter * many.equivalent_radius / many.pressure_viscosity * np.exp(exponent)
    np.testing.assert_allclose(rolling_traction(many), whole, rtol=8e-3)


@pytest.mark.parametrize(
    ("here", "parameter", "factors"),
    [
        (
            (0.7, 42.0, 2.2, 0.45, 90.0),
            0.0168,
            {"goksem_hargreaves": 0.973, "murch_wilson": 0.980, "gupta_cheng": 0.961},
        ),
        (
            (1.0, 20.0, 10.0, 0.45, 50.0),
            1.25,
            {"goksem_hargreaves": 0.684, "murch_wilson": 0.775, "gupta_cheng": 0.613},
        ),
    ],
)
def test_thermal_factors(here: tuple[float, ...], parameter: float, factors: dict[str, float]) -> None:
    c = replace(as_tabulated(*here), temperature_viscosity=0.035)
    assert c.thermal_parameter == pytest.approx(parameter, rel=3e-3)
    for name, expected in factors.items():
        assert THERMAL_FACTORS[name](c) == pytest.approx(expected, abs=6e-4)
    cold = replace(c, temperature_viscosity=0.0)
    assert [float(f(cold)) for f in THERMAL_FACTORS.values()] == pytest.approx([1.0] * 4, abs=1e-12)


def test_xu_kahraman_has_its_size() -> None:
    """0.0234 for 0.7 GPa, 42 mm, 2.2 m/s, slide-to-roll 0.45, 13.88 mPa s, 0.8 um."""
    assert xu_kahraman(as_tabulated(*GOLDEN[0][:7])) == pytest.approx(0.0234, abs=0.51e-4)


def test_benedict_kelly_is_the_original_in_its_own_units() -> None:
    """0.0127 log10(3.17e8 W / (mu Vs Vt^2)), with lbf/in, mPa s and in/s."""
    here = conditions(1.0, 20.0, 5.0, 0.4)
    inch, pound = 0.0254, 4.4482216
    load = float(here.load) / pound * inch
    sliding, total = 2.0 / inch, 10.0 / inch
    expected = 0.0127 * np.log10(3.17e8 * load / (1e3 * float(here.viscosity) * sliding * total**2))
    assert friction_coefficient("benedict_kelly", **points(here)) == pytest.approx(expected, abs=2e-6)
    assert 0.02 < expected < 0.08


def points(c: ContactConditions) -> dict[str, Any]:
    return {
        "hertz_pressure": c.hertz_pressure,
        "equivalent_radius": c.equivalent_radius,
        "rolling_velocity": c.rolling_velocity,
        "slide_to_roll": c.slide_to_roll,
        "temperature": c.temperature,
        "roughness": (c.roughness_pinion, c.roughness_gear),
    }


def test_constant_and_own_models() -> None:
    here = points(conditions([0.8, 1.0]))
    assert friction_coefficient("constant", **here) == 0.05
    assert friction_coefficient(0.031, **here) == 0.031

    def own(c: ContactConditions) -> Any:
        return 0.01 + 1e-12 * c.hertz_pressure

    np.testing.assert_allclose(friction_coefficient(own, **here), [0.0108, 0.011])


def test_conditions_broadcast() -> None:
    found = friction_coefficient(
        **(points(conditions()) | {"hertz_pressure": [[0.8e9], [1e9]], "temperature": [50, 75, 90]})
    )
    assert found.shape == (2, 3)
    assert found[1, 1] == friction_coefficient(**points(conditions()))


@pytest.mark.parametrize(
    ("changed", "message"),
    [
        ({"hertz_pressure": 0.0}, "hertz_pressure = 0: must be a finite number above 0"),
        ({"equivalent_radius": -1.0}, "equivalent_radius = -1"),
        ({"rolling_velocity": np.nan}, "rolling_velocity = nan"),
        ({"slide_to_roll": -0.1}, "slide_to_roll = -0.1: must be a finite number of 0 or more"),
        ({"roughness": (-1e-6, 1e-6)}, "roughness_pinion = -1e-06"),
        ({"temperature": 10.0}, "temperature = 10: must be from 25 to 100"),
        ({"oil": "water"}, "oil = 'water'"),
        ({"film": "thick"}, "film = 'thick'"),
        ({"model": "sandpaper"}, "'sandpaper': must be one of kolivand_blended"),
        ({"model": 1000.0}, "coefficient = 1000: must be a number from 0 to 1"),
        ({"model": 1e308}, r"coefficient = 1e\+308: must be a number from 0 to 1"),
        ({"model": lambda conditions: 1000.0}, r"coefficient = <lambda>: gives 1000 at 1 of 1 .* from 0 to 1$"),
        ({"model": lambda conditions: 1e308}, r"coefficient = <lambda>: gives 1e\+308 at 1 of 1 .* from 0 to 1$"),
        ({"model": -0.1}, "coefficient = -0.1: must be a number from 0 to 1"),
    ],
)
def test_mistakes_are_named(changed: dict[str, Any], message: str) -> None:
    with pytest.raises(InputError, match=message):
        friction_coefficient(**(points(conditions()) | changed))


def test_unknown_thermal_factor() -> None:
    with pytest.raises(InputError, match="thermal_factor = 'hot'"):
        rolling_traction(conditions(), "hot")


def test_benedict_kelly_and_lambda_ratio_of_a_contact() -> None:
    contact = contact_conditions(
        hertz_pressure=0.7e9, equivalent_radius=0.042, rolling_velocity=2.2, slide_to_roll=0.45, roughness=0.8e-6
    )
    assert coefficient_model("benedict_kelly")(contact) == pytest.approx(0.0611, abs=5e-5)
    contact = contact_conditions(
        hertz_pressure=[0.7e9, 1e9],
        equivalent_radius=0.042,
        rolling_velocity=2.2,
        slide_to_roll=0.45,
        roughness=(0.8e-6, 0.4e-6),
        oil="pao-vg100",
    )
    np.testing.assert_allclose(contact.lambda_ratio, [0.264, 0.241], atol=5e-4)
