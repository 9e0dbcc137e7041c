"""Tolerances by accuracy grade: their steps, rounding and range; the usual backlash by module."""

from __future__ import annotations

import math

import pytest

from easeoff.core.errors import InputError
from easeoff.geometry.design.tolerances import accuracy_tolerances, usual_backlash


def test_tolerances_are_those_of_the_formulas() -> None:
    """ISO 17485, 5.4, at grade 4, where the step factor is one; by hand."""
    found = accuracy_tolerances(4, 5.0, 40, 200.0)
    assert found["single_pitch"] == 7.0  # 0.6 + 1.5 + 5 = 7.1, to a half
    assert found["total_cumulative_pitch"] == round(0.025 * 200.0 + 1.5 + 19.0)  # 25.5
    assert found["run_out"] == round(0.8 * 25.5)


def test_two_grades_double_a_tolerance() -> None:
    for grade in range(2, 9):
        finer, coarser = (accuracy_tolerances(each, 5.0, 40, 200.0) for each in (grade, grade + 2))
        for name, value in finer.items():
            assert coarser[name] == pytest.approx(2.0 * value, abs=1.6)  # both are rounded
    assert "run_out" not in accuracy_tolerances(3, 5.0, 40, 200.0)


@pytest.mark.parametrize(
    ("grade", "module", "teeth", "diameter", "word"),
    [
        (1, 5.0, 40, 200.0, "accuracy_grade = 1"),
        (12, 5.0, 40, 200.0, "accuracy_grade = 12"),
        (6, 0.8, 40, 32.0, "mean normal module = 0.8 mm"),
        (6, 5.0, 4, 20.0, "number of teeth = 4"),
        (6, 49.0, 60, 2600.0, "tolerance diameter = 2600 mm"),
    ],
)
def test_beyond_the_range_of_the_standard_there_are_none(
    grade: int, module: float, teeth: int, diameter: float, word: str
) -> None:
    with pytest.raises(InputError, match=word):
        accuracy_tolerances(grade, module, teeth, diameter)


def test_usual_backlash_rises_with_the_module() -> None:
    """Rows of the published table in inches: 0.006 to 0.008 at diametral pitch 4; none for coarser teeth than 1."""
    assert usual_backlash(25.4 / 4.5) == pytest.approx((0.1524, 0.2032))
    assert usual_backlash(30.0) is None
    rising = [usual_backlash(module) or (math.inf, math.inf) for module in (0.2, 0.5, 1.0, 2.0, 4.0, 8.0, 16.0, 25.0)]
    assert rising == sorted(rising)
