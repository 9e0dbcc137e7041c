"""Strips that an edge cuts: against pressures found cell by cell, and consistency of deflection and slope."""

from __future__ import annotations

import numpy as np
import pytest

from easeoff import InputError
from easeoff.contact import STEEL, ContactProblem, Material, WeberLineContact, solve
from easeoff.contact.compliance.pressed_strip import PressedStrip

BRONZE = Material(105000.0, 0.34)
RADIUS, DEEP = 40.0, 4000.0  # so deep that the logarithm is exact


def cut(overhang: float, depth: float = DEEP, gear: Material = STEEL) -> WeberLineContact:
    one = np.ones(1)
    floor = 1e-3 if depth < DEEP else 1e-9
    size = (one, RADIUS * one, depth * one, depth * one)
    return WeberLineContact(*size, STEEL, gear, floor_ratio=floor, overhang=overhang * one)


def by_cells(overhang: float, load: float, cells: int) -> tuple[float, float]:
    """Deflection beyond the first touch and width of the strip [mm], of half planes under even pressures."""
    law = cut(overhang)
    flexibility, contraction = law.flexibility, 0.3 / 0.7
    width = 2.6 * float(law.half_width(load)[0])
    # Narrow cells towards the edge, where the pressure is a root of the distance.
    ends = overhang + width * np.linspace(0.0, 1.0, cells + 1) ** 2
    middle, size = 0.5 * (ends[1:] + ends[:-1]), np.diff(ends)

    def integral(x: np.ndarray) -> np.ndarray:
        return np.asarray(x * (np.log(np.abs(x)) - 1.0))

    logarithm = integral(ends[None, 1:] - middle[:, None]) - integral(ends[None, :-1] - middle[:, None])
    matrix = -2.0 * logarithm / size + 2.0 * np.log(DEEP) - 1.0 - contraction
    matrix = flexibility / np.pi * 0.5 * (matrix + matrix.T)
    separation = (middle**2 - max(overhang, 0.0) ** 2) / (2.0 * RADIUS)
    found = solve(ContactProblem(separation, np.ones(cells), load, matrix))
    assert found.certified
    return found.rotation, float(size[found.force > 0.0].sum())


@pytest.mark.parametrize("overhang", [-0.02, 0.0, 0.05, 0.3, 1.5])
@pytest.mark.parametrize("load", [5.0, 300.0])
def test_pressures_found_cell_by_cell(overhang: float, load: float) -> None:
    law = cut(overhang)
    coarse, fine = (by_cells(overhang, load, n) for n in (60, 240))
    deflection, width = float(law.deflection(load)[0]), 2.0 * float(law.half_width(load)[0])
    assert fine[0] == pytest.approx(deflection, rel=2e-6)
    assert fine[1] == pytest.approx(width, rel=0.007)
    assert fine[1] - width < 0.4 * (coarse[1] - width)


@pytest.mark.parametrize("depth", [0.05, 1.0, DEEP])
@pytest.mark.parametrize("overhang", [-0.3, -0.02, 0.0, 0.02, 0.3, 3.0])
def test_slope_is_the_derivative_and_the_energy_convex(depth: float, overhang: float) -> None:
    """Stiffer with every newton, never stiff without limit, from below the floor to strips far wider than deep."""
    law = cut(overhang, depth, BRONZE)
    forces = np.geomspace(1e-9, 1e8, 100)
    slopes = np.array([law.tangent(f)[0] for f in forces])
    step = 1e-5
    numeric = [(law.deflection(f * (1 + step)) - law.deflection(f * (1 - step)))[0] / (2 * step * f) for f in forces]
    np.testing.assert_allclose(slopes, numeric, rtol=1e-6)
    assert slopes.min() > 0.0
    assert np.all(np.diff(slopes) <= 1e-13 * slopes[1:])


def test_a_cut_strip_gives_way_more_than_a_whole_one() -> None:
    one = np.ones(1)
    whole = WeberLineContact(one, RADIUS * one, 3.0 * one, 3.0 * one, STEEL, STEEL)
    deflections = [cut(e, 3.0).deflection(400.0)[0] for e in (0.0, 0.1, 0.4, 1.0)]
    assert np.all(np.diff([whole.deflection(400.0)[0], *deflections]) > 0.0)
    widths = [cut(e, 3.0).half_width(400.0)[0] for e in (0.0, 0.1, 0.4, 1.0)]
    assert np.all(np.diff([whole.half_width(400.0)[0], *widths]) < 0.0)
    b = whole.half_width(400.0)[0]
    assert widths[0] == pytest.approx(b / np.sqrt(3.0))
    assert np.isnan(cut(0.1).pressure(400.0)[0])
    assert np.isnan(cut(0.1).energy(400.0)[0])


def test_strips_without_an_edge_are_whole() -> None:
    strip = PressedStrip.of(np.array([np.nan, 0.0]), np.array([0.04, 0.04]))
    np.testing.assert_allclose(strip.half_width, [0.2, 0.2 / np.sqrt(3.0)])
    np.testing.assert_array_equal(strip.growth, [0.5, 0.5])
    np.testing.assert_array_equal([strip.cut, strip.cut_slope], np.zeros((2, 2)))


def test_a_strip_is_whole_until_it_reaches_the_edge() -> None:
    """From there on deflection and slope go on without a jump, and the strip becomes narrower than a whole one."""
    one = np.ones(1)
    whole = WeberLineContact(one, RADIUS * one, 3.0 * one, 3.0 * one, STEEL, STEEL)
    reach = float(whole.half_width(400.0)[0])
    for force in (4.0, 399.99):
        assert cut(-reach, 3.0).deflection(force)[0] == pytest.approx(whole.deflection(force)[0], rel=1e-12)
        assert cut(-reach, 3.0).pressure(force)[0] == pytest.approx(whole.pressure(force)[0], rel=1e-12)
    for depth in (0.05, 1.0, 10.0):
        law, there = cut(-reach, depth), 400.0
        for value in (law.deflection, law.tangent, law.half_width):
            assert value(there * (1.0 + 1e-9))[0] == pytest.approx(value(there * (1.0 - 1e-9))[0], rel=1e-8)
    assert cut(-0.5 * reach, 3.0).half_width(400.0)[0] < reach


@pytest.mark.parametrize("overhang", [np.inf, -np.inf])
def test_overhang_is_a_distance(overhang: float) -> None:
    with pytest.raises(InputError, match="must be finite or NaN"):
        cut(overhang)
