"""The analyses behind worn_and_measured_flanks.md, and what the dissertation prints of them."""

from __future__ import annotations

from functools import cache
from typing import Any

import xarray as xr
from dissertation_method import by_its_method

import easeoff

TORQUE = 200.0
EDGE = 0.2  # of the flank
Row = tuple[float, tuple[float, float, float], float]  # peak to peak, harmonics, rms [urad]
# Tables 4.2 and 4.4: (unloaded, loaded at 200 N m), theoretical and deviated.
PRINTED: dict[str, dict[str, tuple[Row, Row]]] = {
    "worn": {
        "designed": ((21.1, (8.3, 3.7, 2.0), 9.3), (14.2, (7.3, 0.3, 0.5), 7.4)),
        "deviating": ((15.0, (4.3, 4.3, 1.4), 6.3), (10.2, (4.5, 1.4, 0.4), 4.7)),
    },
    "measured": {
        "designed": ((36.9, (15.1, 4.0, 1.8), 15.7), (23.9, (12.1, 0.5, 0.7), 12.1)),
        "deviating": ((61.5, (28.9, 2.1, 1.5), 29.0), (29.8, (15.8, 2.8, 2.3), 16.2)),
    },
}
CASES = {"worn": "fm-11x41", "measured": "fh-12x41-45"}
MEMBERS = ("pinion", "gear")


def files(example: str, members: tuple[str, ...] = MEMBERS) -> dict[str, str]:
    """Shipped grids of an example."""
    return {member: f"{CASES[example]}-{example}-{member}" for member in members}


@cache
def analysed(example: str, members: tuple[str, ...] = MEMBERS, deviated: str = "ease_off") -> xr.DataTree:
    """The pair of an example with the deviations of these members, by the method of the dissertation."""
    options: Any = {"deviations": files(example, members), "deviated": deviated}
    return easeoff.analyze(by_its_method(CASES[example]), torques=[TORQUE], **options)


def ours(tree: xr.DataTree) -> tuple[Row, Row]:
    """What the dissertation's tables print."""
    unloaded, loaded = tree["unloaded"].attrs, tree["loaded"].to_dataset().isel(torque=0)
    first, second = unloaded["harmonics"], loaded["harmonic"].values
    return (
        (unloaded["peak_to_peak"], (first[0], first[1], first[2]), unloaded["rms"]),
        (float(loaded["peak_to_peak"]), (second[0], second[1], second[2]), float(loaded["rms"])),
    )


def pressures(tree: xr.DataTree) -> dict[str, float]:
    """Greatest pressure within a fifth of either edge of the gear, and anywhere [MPa]."""
    loaded = tree["loaded"].to_dataset()
    t, h = loaded["lengthwise"], loaded["profile"]
    places = {"root": h < EDGE, "tip": h > 1.0 - EDGE, "toe": t < EDGE, "heel": t > 1.0 - EDGE, "anywhere": h >= 0.0}
    return {name: float(loaded["pressure"].where(here).max()) for name, here in places.items()}


def ratios(example: str, part: int) -> tuple[float, float]:
    """Peak to peak with deviations over that without: ours and the dissertation's."""
    own = ours(analysed(example))[part][0] / ours(analysed(example, ()))[part][0]
    return own, PRINTED[example]["deviating"][part][0] / PRINTED[example]["designed"][part][0]
