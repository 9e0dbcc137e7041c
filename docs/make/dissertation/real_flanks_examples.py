"""The two examples of chapter 4 as measured grids, written into ``cases/deviations`` by ``make_real_flanks.py``.

The dissertation prints greatest deviations and pictures, no values. These are **made to resemble** what it says: where
the greatest deviations are, how large, and that they compensate one another. Their coefficients were **found by least
squares from random starts** so that what the contact does comes as near as possible to what it prints of it: of the
worn flanks both transmission errors, the relieved edge, no other edge much worse, longer contact lines; of the
measured ones both errors, the shift to the heel, and the compensation. Then they were rounded. So the trends of these
examples are no evidence for the theory: they show that such deviations exist, of the size and at the places it prints.
"""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

import easeoff
from easeoff.cases import gear_pair
from easeoff.geometry.formats import EdgeMargins, cmm_points, measured_grid, write_measured_grid
from easeoff.geometry.tooth.tooth_flanks import named_member

Array = NDArray[Any]
FOLDER = Path(easeoff.__file__).parent / "cases" / "deviations"
NARROW = EdgeMargins(1.0, 1.0, 0.3, 0.3)
MADE = "made to resemble Kolivand 2009, {}, of which greatest deviations and places are known; not measured"


def worn(
    dent: tuple[float, float],
    size: tuple[float, float],
    lean: float,
    depth: float,
    relief: float,
    begin: float,
    end: float,
) -> Callable[[Array, Array], Array]:
    """Worn metal [um]: a dent, leaning with the contact lines, and a relief towards an edge.

    Parameters
    ----------
    dent
        Fractions of the middle of the dent, lengthwise and up the profile.
    size
        Its half widths along the face and up the profile.
    lean
        How far it moves along the face over the whole profile.
    depth, relief
        Of the dent in its middle, and of the relief at the edge [um].
    begin, end
        Profile fractions between which the relief grows with the square.
    """

    def form(t: Array, h: Array) -> Array:
        across, up = (t - dent[0] - lean * (h - dent[1])) / size[0], (h - dent[1]) / size[1]
        to_edge = np.maximum((h - begin) / (end - begin), 0.0)
        return np.asarray(-depth * np.exp(-(across**2) - up**2) - relief * to_edge**2)

    return form


def global_error(*coefficients: float) -> Callable[[Array, Array], Array]:
    """A surface of second order [um] with a little of what a measurement adds to it; metal missing as counted there."""

    def form(t: Array, h: Array) -> Array:
        x, y = 2.0 * t - 1.0, 2.0 * h - 1.0
        terms = (np.ones_like(x), x, y, x**2, x * y, y**2)
        missing = sum(c * term for c, term in zip(coefficients, terms, strict=True))
        return np.asarray(-(missing + 0.6 * np.sin(7.0 * t + 2.0) * np.cos(9.0 * h)))

    return form


# (case, member, rows, columns, margins, form, where in the dissertation)
EXAMPLES: dict[str, tuple[str, str, tuple[int, int], EdgeMargins | None, Callable[[Array, Array], Array], str]] = {
    # Relieved at the pinion's tip and the gear's root, which meet there, and worn along the contact lines.
    "fm-11x41-worn-pinion": (
        "fm-11x41", "pinion", (15, 25), NARROW, worn((0.29, 1.07), (0.33, 0.54), 1.07, 3.6, 7.4, 0.69, 1.0), "Fig. 4.5",
    ),
    "fm-11x41-worn-gear": (
        "fm-11x41", "gear", (15, 25), NARROW, worn((0.63, 0.8), (0.29, 0.51), 0.65, 3.1, 5.5, 0.26, 0.0), "Fig. 4.5",
    ),
    # Greatest at heel and top of the pinion, at toe and root of the gear.
    "fh-12x41-45-measured-pinion": (
        "fh-12x41-45", "pinion", (5, 9), None, global_error(15.5, 22, 1.5, 3, 10, 13), "Fig. 4.10",
    ),
    "fh-12x41-45-measured-gear": (
        "fh-12x41-45", "gear", (5, 9), None, global_error(15.5, -14.5, 0, -5.5, 1, 1.5), "Fig. 4.10",
    ),
}  # fmt: skip


def write_examples() -> None:
    """Write the grids of the drive flanks."""
    for name, (case, who, size, margins, form, where) in EXAMPLES.items():
        member = named_member(gear_pair(easeoff.read_case(case), "drive"), who)
        points = cmm_points(member, *size, margins)
        place = points["position"].values
        fractions = member.section.fractions(place[..., 2], np.hypot(place[..., 0], place[..., 1]))
        grid = measured_grid(points, np.round(form(*fractions), 1) + 0.0)
        rounded = {k: grid[k].round(7) for k in ("position",)}
        titled = {"member": who, "title": f"{who} of {case}", "source": MADE.format(where)}
        write_measured_grid(grid.assign(rounded).assign_attrs(titled), FOLDER / f"{name}.csv")
