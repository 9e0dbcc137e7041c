"""Deviations as fields on a flank: exact at the nodes, exact for simple forms, flagged where nothing was measured."""

from __future__ import annotations

import numpy as np
import pytest
import xarray as xr
from numpy.typing import NDArray
from pairs import GEAR_BLANK

import easeoff
from easeoff import InputError
from easeoff.geometry import Deviation, deviation_from_dataset, deviation_from_formula
from easeoff.geometry.deviation.deviation import Method
from easeoff.geometry.deviation.interpolation import smoothed
from easeoff.geometry.formats import EdgeMargins
from easeoff.geometry.formats.measuring_points import _grid

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
