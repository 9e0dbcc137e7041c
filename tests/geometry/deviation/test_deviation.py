"""Deviations as fields on a flank, global errors by name, and the loop of the workshop: cut, measure, correct, cut."""

from __future__ import annotations

from dataclasses import astuple, replace
from typing import Any

import numpy as np
import pytest
import xarray as xr
from deviations import GEAR_ERRORS
from numpy.typing import NDArray
from pairs import GEAR_BLANK

import easeoff
from easeoff import InputError
from easeoff.cases import gear_pair
from easeoff.geometry import (
    Deviation,
    GeneratingSurface,
    GlobalErrors,
    Member,
    angle_errors,
    corrective_settings,
    deviation_from_formula,
    fit_global_errors,
    usual_settings,
)
from easeoff.geometry.cutting.named_settings import get_setting, scale_of, with_settings
from easeoff.geometry.design.synthesis import FREE_SETTINGS
from easeoff.geometry.deviation.corrective_settings import GIVEN_UP
from easeoff.geometry.deviation.deviation import Method, deviation_from_dataset, smoothed, zeroed
from easeoff.geometry.formats import EdgeMargins, cmm_points
from easeoff.geometry.formats.measuring_points import _grid
from easeoff.geometry.tooth.tooth_flanks import named_member
from easeoff.verification.envelope_condition import distance_along_normals

Array = NDArray[np.float64]
ROWS, COLUMNS = 5, 9


def measuring_grid() -> tuple[Array, Array]:
    """Axial and radial coordinates (columns, rows) of the usual grid, clear of the edges of the flank."""
    axial, radial = _grid(GEAR_BLANK, EdgeMargins().of(GEAR_BLANK), ROWS, COLUMNS)
    return axial.reshape(ROWS, COLUMNS).T, radial.reshape(ROWS, COLUMNS).T


def random_deviation(method: Method = "spline") -> Deviation:
    axial, radial = measuring_grid()
    return Deviation(GEAR_BLANK, axial, radial, 0.01 * np.random.default_rng(1).normal(size=(COLUMNS, ROWS)), method)


def places() -> Array:
    """Axial and radial coordinates (2, n) of points all over the flank."""
    t, h = np.meshgrid(np.linspace(0.0, 1.0, 23), np.linspace(0.0, 1.0, 17))
    return GEAR_BLANK.points(t.ravel(), h.ravel())


@pytest.mark.parametrize("method", ["spline", "weighted_average"])
def test_a_deviation_is_what_was_measured_at_the_nodes(method: Method) -> None:
    deviation = random_deviation(method)
    value, _ = deviation.interpolant(deviation.axial.ravel(), deviation.radial.ravel())
    np.testing.assert_allclose(value.reshape(COLUMNS, ROWS), deviation.value, rtol=0, atol=1e-12)


def test_a_quadratic_surface_is_kept_everywhere_up_to_the_edges() -> None:
    axial, radial = measuring_grid()

    def surface(z: Array, r: Array) -> Array:
        x, y = z - 25.0, r - 95.0
        return np.asarray(0.01 + 2e-3 * x - 1e-3 * y + 1e-4 * x * y - 3e-4 * x**2 + 2e-4 * y**2)

    deviation = Deviation(GEAR_BLANK, axial, radial, surface(axial, radial))
    value, _ = deviation.interpolant(*places())
    np.testing.assert_allclose(value, surface(*places()), rtol=0, atol=1e-14)


def test_the_spline_is_a_better_interpolant_than_the_average() -> None:
    """Between the nodes of a 5 x 9 grid, of a smooth deviation: ten times, and of the order of a cubic."""

    def form(t: Array, h: Array) -> Array:
        return np.asarray(10.0 * np.sin(2.5 * t + 1.5 * h))

    def error(rows: int, columns: int, method: Method) -> float:
        axial, radial = _grid(GEAR_BLANK, EdgeMargins(0.0, 0.0, 0.0, 0.0).of(GEAR_BLANK), rows, columns)
        axial, radial = axial.reshape(rows, columns).T, radial.reshape(rows, columns).T
        t, h = GEAR_BLANK.fractions(axial, radial)
        value, _ = Deviation(GEAR_BLANK, axial, radial, 1e-3 * form(t, h), method).interpolant(*places())
        return float(np.max(np.abs(1e3 * value - form(*GEAR_BLANK.fractions(*places())))))

    assert error(5, 9, "spline") < 0.1 * error(5, 9, "weighted_average")
    assert error(5, 9, "spline") / error(9, 17, "spline") > 2**3.5


@pytest.mark.parametrize("method", ["spline", "weighted_average"])
def test_slopes_are_derivatives_also_beyond_the_grid(method: Method) -> None:
    """The exact path differentiates by complex step: value and slope must carry an imaginary part."""
    interpolant = random_deviation(method).interpolant
    points = places() + 0.013
    _, slope = interpolant(*points)
    for index in range(2):
        stepped = points.astype(complex)
        stepped[index] += 1e-30j
        lifted, lifted_slope = interpolant(*stepped)
        np.testing.assert_allclose(lifted.imag / 1e-30, slope[index], rtol=1e-9, atol=1e-12)
        shift = np.zeros_like(points)
        shift[index] = 1e-6
        ahead, behind = interpolant(*(points + shift)), interpolant(*(points - shift))
        np.testing.assert_allclose((ahead[0] - behind[0]) / 2e-6, slope[index], rtol=0, atol=1e-7)
        np.testing.assert_allclose(
            lifted_slope.imag / 1e-30, (ahead[1] - behind[1]) / 2e-6, rtol=0, atol=2e-3 * np.max(np.abs(slope))
        )


def test_what_is_extrapolated_is_flagged_and_scatter_is_not_magnified() -> None:
    deviation = random_deviation()
    dataset = deviation.on_grid(np.linspace(0.0, 1.0, 41), np.linspace(0.0, 1.0, 21))
    flag = dataset["extrapolated"].values.astype(bool)
    assert flag[0].all()
    assert flag[:, 0].all()
    assert not flag[20, 10]
    assert 0.2 < flag.mean() < 0.5
    assert np.max(np.abs(dataset["deviation"].values)) < 2.5 * 1e3 * np.max(np.abs(deviation.value))
    assert dataset["deviation"].attrs["units"] == "um"
    with pytest.raises(InputError, match="must be fractions of the flank"):
        deviation.on_grid(np.linspace(0.0, 1.1, 5), np.linspace(0.0, 1.0, 5))


def test_a_dataset_and_a_formula_give_the_same_deviation() -> None:
    by_formula = deviation_from_formula(GEAR_BLANK, lambda t, h: 3.0 * t - 5.0 * h**2)
    dataset = by_formula.on_grid(np.linspace(0.0, 1.0, 12), np.linspace(0.0, 1.0, 7))
    by_dataset = deviation_from_dataset(GEAR_BLANK, dataset.transpose("profile", "lengthwise"))
    t, h = np.array([0.03, 0.5, 0.97]), np.array([0.9, 0.41, 0.02])
    np.testing.assert_allclose(by_formula.at(t, h), 1e-3 * (3.0 * t - 5.0 * h**2), rtol=0, atol=1e-15)
    np.testing.assert_allclose(by_dataset.at(t, h), by_formula.at(t, h), rtol=0, atol=1e-15)


def test_bad_input_is_refused() -> None:
    axial, radial = measuring_grid()
    value = np.zeros((COLUMNS, ROWS))
    hole = value.copy()
    hole[4, 2] = np.nan
    with pytest.raises(InputError, match="row 3, column 5"):
        Deviation(GEAR_BLANK, axial, radial, hole)
    with pytest.raises(InputError, match="must be one shape"):
        Deviation(GEAR_BLANK, axial, radial, value.T)
    with pytest.raises(InputError, match="Are the values in um"):
        Deviation(GEAR_BLANK, axial, radial, value + 12.0)
    with pytest.raises(InputError, match="weighted_average"):
        Deviation(GEAR_BLANK, axial, radial, value, "linear")  # type: ignore[arg-type]
    with pytest.raises(InputError, match="interpolation = 'cubic': must be one of spline"):
        easeoff.analyze("fm-11x41", torques=[50.0], interpolation="cubic")  # type: ignore[arg-type]
    with pytest.raises(InputError, match="must have a variable 'deviation'"):
        deviation_from_dataset(GEAR_BLANK, xr.Dataset())
    good = deviation_from_formula(GEAR_BLANK, lambda t, h: t).on_grid(np.linspace(0, 1, 5), np.linspace(0, 1, 5))
    with pytest.raises(InputError, match=r"units of .*: must be um"):
        deviation_from_dataset(GEAR_BLANK, good.assign(deviation=good["deviation"].assign_attrs(units="mm")))
    with pytest.raises(InputError, match="must increase"):
        deviation_from_dataset(GEAR_BLANK, good.isel(profile=slice(None, None, -1)))


def test_the_smooth_surface_takes_the_scatter_and_keeps_a_surface_of_third_order() -> None:
    u, v = np.meshgrid(np.linspace(-1, 1, COLUMNS), np.linspace(-1, 1, ROWS), indexing="ij")
    form = 0.01 * (1.0 + u - 2.0 * v + u * v - u**2 + 0.5 * v**2 + 0.3 * u**3 - 0.2 * u**2 * v + v**3)
    axial, radial = measuring_grid()
    kept = Deviation(GEAR_BLANK, axial, radial, form, "smooth")
    value, _ = kept.interpolant(axial.ravel(), radial.ravel())
    np.testing.assert_allclose(value.reshape(form.shape), form, rtol=0, atol=1e-15)
    assert kept.scatter < 1e-15
    # Of white noise ten of the forty-five degrees of freedom stay.
    noise = np.random.default_rng(3).normal(size=(400, COLUMNS, ROWS))
    left = np.array([smoothed(one) for one in noise])
    assert np.mean(left**2) == pytest.approx(10 / 45, rel=0.05)
    assert np.mean((noise - left) ** 2) == pytest.approx(35 / 45, rel=0.05)
    assert kept.extrapolated(np.array([0.5, 0.0]), np.array([0.5, 0.5])).tolist() == [False, True]


@pytest.mark.parametrize("size", [(2, 2), (3, 2), (3, 4)])
def test_on_few_nodes_the_smooth_surface_keeps_what_they_know(size: tuple[int, int]) -> None:
    u, v = np.meshgrid(np.linspace(-1, 1, size[0]), np.linspace(-1, 1, size[1]), indexing="ij")
    form = 1.0 + u - 2.0 * v + u * v
    np.testing.assert_allclose(smoothed(form), form, rtol=0, atol=5e-14)


# Global errors by name, and the loop of the workshop: cut, measure, correct the settings, cut, measure


def member(case: str, name: str) -> Member:
    return getattr(gear_pair(easeoff.read_case(case), "drive"), name)  # type: ignore[no-any-return]


def measured(designed: Member, real: GeneratingSurface) -> Deviation:
    """What a measuring machine finds on a flank, turned to its middle."""
    points = cmm_points(designed)
    place, normal = (points[name].values[0].transpose(2, 1, 0) for name in ("position", "normal"))
    flat = (v.reshape(3, -1) for v in (place, normal))
    distance = distance_along_normals(real, designed.section, *flat).reshape(place.shape[1:])
    found = Deviation(designed.section, place[2], np.hypot(place[0], place[1]), distance)
    return zeroed(found, designed.loaded)


def changed(surface: GeneratingSurface, changes: dict[str, float]) -> GeneratingSurface:
    return with_settings(surface, {name: get_setting(surface, name) + by for name, by in changes.items()})


def test_the_names_are_found_again() -> None:
    found = fit_global_errors(deviation_from_formula(member("fm-11x41", "gear").section, GEAR_ERRORS, (9, 5)))
    np.testing.assert_allclose(astuple(found.errors), astuple(GEAR_ERRORS), rtol=0, atol=1e-10)
    assert found.rms < 1e-10 < found.rms_before


@pytest.mark.parametrize(
    ("name", "corners"),  # toe-root, toe-tip, heel-root, heel-tip, middle
    [
        ("spiral_angle", (-1, -1, 1, 1, 0)),
        ("pressure_angle", (-1, 1, -1, 1, 0)),
        ("lengthwise_crowning", (-1, -1, -1, -1, 0)),
        ("profile_crowning", (-1, -1, -1, -1, 0)),
        ("twist", (1, -1, -1, 1, 0)),
        ("level", (1, 1, 1, 1, 1)),
    ],
)
def test_the_signs_are_those_of_the_page(name: str, corners: tuple[int, ...]) -> None:
    t, h = np.array([0.0, 0.0, 1.0, 1.0, 0.5]), np.array([0.0, 1.0, 0.0, 1.0, 0.5])
    np.testing.assert_array_equal(GlobalErrors(**{name: 1.0})(t, h), corners)


def test_a_grid_with_a_local_dent_leaves_it_as_residual() -> None:
    section = member("fm-11x41", "gear").section
    deviation = deviation_from_formula(section, GEAR_ERRORS, (9, 5))
    dent = deviation.value.copy()
    dent[4, 2] -= 0.02
    found = fit_global_errors(replace(deviation, value=dent))
    assert int(np.argmin(found.residual)) == np.ravel_multi_index((4, 2), dent.shape)
    assert found.residual[4, 2] < -14.0
    with pytest.raises(InputError, match="at least 3 of each"):
        fit_global_errors(deviation_from_formula(section, GEAR_ERRORS, (9, 2)))


def angles_at_the_middle(designed: Member, surface: GeneratingSurface) -> tuple[float, float]:
    """Spiral and pressure angle [rad] of a flank, from its normal alone."""
    middle = replace(designed, loaded=surface).middle()
    position, normal = middle.position[:, 0], middle.normal[:, 0]
    outward = position[:2] / np.hypot(*position[:2])
    around = outward[0] * normal[1] - outward[1] * normal[0]
    pitch, hand = designed.section.pitch_angle, 1.0 if surface.hand == "right" else -1.0
    along = np.sin(pitch) * outward @ normal[:2] + np.cos(pitch) * normal[2]
    off = np.cos(pitch) * outward @ normal[:2] - np.sin(pitch) * normal[2]
    return float(np.arctan(-hand * along / around)), float(np.arcsin(off))


@pytest.mark.parametrize("flank", ["drive", "coast"])
@pytest.mark.parametrize("name", ["pinion", "gear"])
@pytest.mark.parametrize("change", [{"pressure_angle": 0.002}, {"radial_distance": 0.3, "work_offset": 0.1}])
def test_angles_are_those_of_the_normal(flank: str, name: str, change: dict[str, float]) -> None:
    """Concave and convex flanks, left and right hand: where more metal at the heel means another sign."""
    designed = getattr(gear_pair(easeoff.read_case("fm-11x41"), flank), name)  # type: ignore[arg-type]
    real = changed(designed.loaded, change)
    found = fit_global_errors(measured(designed, real))
    angles = angle_errors(found.errors, designed)
    wanted = np.subtract(angles_at_the_middle(designed, real), angles_at_the_middle(designed, designed.loaded))
    assert np.max(np.abs(wanted)) > 5e-4
    np.testing.assert_allclose(angles, wanted, rtol=0, atol=0.1 * np.max(np.abs(wanted)))


def free_with_blades(surface: GeneratingSurface) -> tuple[str, ...]:
    machine = FREE_SETTINGS if surface.settings.generated else usual_settings(surface)
    return tuple(dict.fromkeys(("point_radius", "pressure_angle", *machine)))


PERTURBED = {"point_radius": 0.15, "pressure_angle": 0.002, "machine_root_angle": 0.0006}
GENERATED = {**PERTURBED, "radial_distance": 0.1, "ratio_of_roll": 0.002}


@pytest.mark.parametrize("case", ["fm-11x41", "fh-12x41-45", "nasa-12x36"])
@pytest.mark.parametrize("name", ["pinion", "gear"])
@pytest.mark.quick(2)
def test_corrective_settings_leave_less_than_five_percent(case: str, name: str) -> None:
    """Cut with wrong settings, measure, correct, cut with the same wrong settings and the correction, measure."""
    designed = member(case, name)
    wrong = GENERATED if designed.loaded.settings.generated else PERTURBED
    first = measured(designed, changed(designed.loaded, wrong))
    correction = corrective_settings(designed, first, free=free_with_blades(designed.loaded))
    second = measured(designed, changed(correction.surface, wrong))
    assert np.max(np.abs(first.value)) > 5e-3
    assert np.max(np.abs(second.value)) < 0.05 * np.max(np.abs(first.value))
    assert correction.rms < 0.01 * correction.rms_before
    # No setting runs away to do what another one does.
    for setting, by in correction.changes.items():
        assert abs(by) < 3.0 * max(wrong.get(setting, 0.0), 0.05), setting


@pytest.mark.parametrize(
    ("case", "flank", "name"),
    [("nasa-12x36", "coast", "gear"), ("fh-design-a", "coast", "pinion"), ("fh-design-b", "drive", "gear")],
)
@pytest.mark.quick(1)
def test_the_loop_closes_for_random_errors_of_all_settings(case: str, flank: Any, name: str) -> None:
    """A tenth of a millimetre off at first, 3 % of that after one pass, and what a fit leaves after another: 1 %."""
    designed = named_member(gear_pair(easeoff.read_case(case), flank), name)
    free = free_with_blades(designed.loaded)
    normal = np.random.default_rng(4).normal(size=len(free))
    wrong = {setting: 0.6 * scale_of(setting) * float(by) for setting, by in zip(free, normal, strict=True)}
    surface, left = designed.loaded, []
    for names in (free, free, free[:1]):  # the third pass only tells what is left
        deviation = measured(designed, changed(surface, wrong))
        correction = corrective_settings(designed, deviation, free=names, rounded=False)
        left.append(correction.rms_before)  # without the rotation of the tooth
        surface = changed(surface, correction.changes)
    assert left[0] > 0.05
    assert left[1] < 0.03 * left[0]
    assert left[2] < GIVEN_UP * left[0]


def test_corrections_with_one_setting_find_that_setting() -> None:
    designed = member("fm-11x41", "gear")
    deviation = measured(designed, changed(designed.loaded, {"point_radius": 0.1}))
    correction = corrective_settings(designed, deviation, free=["point_radius"], rounded=False)
    assert correction.changes["point_radius"] == pytest.approx(-0.1, rel=2e-2)
    with pytest.raises(InputError, match="free setting = 'tilt': must be one of"):
        corrective_settings(designed, deviation, free=["tilt"])
