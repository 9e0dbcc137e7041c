"""Tolerances of bevel gears: teeth by accuracy grade (ISO 17485:2006, 5.4), and the usual backlash by module (AGMA)."""

from __future__ import annotations

from bisect import bisect_right

from ...core.checks import whole
from ...core.errors import InputError

GRADES = (2, 11)
#: Range of the formulas: mean normal module [mm], teeth, tolerance diameter [mm].
MODULES, TEETH, DIAMETERS = (1.0, 50.0), (5, 400), (5.0, 2500.0)
RUN_OUT_GRADE = 4  # the finest with a tolerance of run-out
INCH = 25.4  # [mm]
#: Normal backlash recommended by AGMA for qualities 7 to 13: diametral pitches from which on [1/in], least and greatest
#: of each [in].
PITCHES = (1.0, 1.25, 1.5, 1.75, 2.0, 2.5, 3.0, 3.5, 4.0, 5.0, 6.0, 8.0, 10.0, 16.0, 20.0, 50.0, 80.0)
LEAST = (0.02, 0.018, 0.016, 0.014, 0.012, 0.01, 0.008, 0.007, 0.006, 0.005, 0.004, 0.003, 0.002, 0.001, 0.0, 0.0, 0.0)
GREATEST = (
    *(0.03, 0.026, 0.022, 0.018, 0.016, 0.013, 0.011, 0.009, 0.008, 0.007, 0.006, 0.005, 0.004, 0.003, 0.002, 0.001),
    0.0007,
)


def accuracy_tolerances(grade: int, module: float, teeth: int, tolerance_diameter: float) -> dict[str, float]:
    """Tolerances of one member.

    Parameters
    ----------
    grade
        Accuracy grade of ISO 17485, 2 to 11; each has the square root of two times the tolerances of the one before.
    module
        Mean normal module [mm].
    teeth
        Number of teeth.
    tolerance_diameter
        Where the middle of the working depth meets the mean cone distance [mm].

    Returns
    -------
    dict
        ``single_pitch``, ``total_cumulative_pitch`` and, from grade 4 on, ``run_out`` [um], rounded as the standard
        does: above 10 um to whole ones, above 5 to halves, else to tenths.

    Raises
    ------
    InputError
        If the grade is none, or module, teeth or diameter are outside the range of the formulas.

    Examples
    --------
    >>> accuracy_tolerances(4, 1.0, 20, 1000.0 / 3.0)
    {'single_pitch': 6.5, 'total_cumulative_pitch': 28.0, 'run_out': 22.0}
    """
    grade = whole("accuracy_grade", grade, *GRADES)
    for name, value, (least, most), unit in (
        ("mean normal module", module, MODULES, " mm"),
        ("number of teeth", teeth, TEETH, ""),
        ("tolerance diameter", tolerance_diameter, DIAMETERS, " mm"),
    ):
        if not least <= value <= most:
            raise InputError(f"{name} = {value:.4g}{unit}: ISO 17485 has tolerances from {least:g} to {most:g}{unit}")
    step = 2.0 ** (0.5 * (grade - 4))
    cumulative = (0.025 * tolerance_diameter + 0.3 * module + 19.0) * step
    values = {
        "single_pitch": (0.003 * tolerance_diameter + 0.3 * module + 5.0) * step,
        "total_cumulative_pitch": cumulative,
    }
    if grade >= RUN_OUT_GRADE:
        values["run_out"] = 0.8 * cumulative
    return {name: _rounded(value) for name, value in values.items()}


def usual_backlash(outer_module: float) -> tuple[float, float] | None:
    """Least and greatest normal backlash that AGMA recommends at an outer transverse module [mm]; ``None`` above 25.4.

    Examples
    --------
    >>> [round(value, 2) for value in usual_backlash(5.0)]
    [0.13, 0.18]
    """
    place = bisect_right(PITCHES, INCH / outer_module) - 1
    return (INCH * LEAST[place], INCH * GREATEST[place]) if place >= 0 else None


def _rounded(value: float) -> float:
    """A tolerance [um] as the standard rounds it (5.3)."""
    return float(round(value)) if value > 10.0 else round(2.0 * value) / 2.0 if value > 5.0 else round(value, 1)
