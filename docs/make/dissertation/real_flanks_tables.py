"""What the dissertation prints and says of its two examples, beside ours: tables of worn_and_measured_flanks.md."""

from __future__ import annotations

import numpy as np
from dissertation_tables import HEADS, compared, statements, table
from real_flanks_analyses import MEMBERS, PRINTED, analysed, ours, pressures, ratios


def amplitudes(example: str) -> str:
    """Table 4.2 or 4.4, ours and printed."""
    rows: list[tuple[object, ...]] = []
    for which, members in (("designed", ()), ("deviating", MEMBERS)):
        for load, own, theirs in zip(
            ("unloaded", "200 N m"), ours(analysed(example, members)), PRINTED[example][which], strict=True
        ):
            rows.append(compared(f"{which}, {load}: peak to peak [µrad]", own[0], theirs[0]))
            rows.append(compared(f"{which}, {load}: harmonic 1", own[1][0], theirs[1][0]))
    return table(rows, HEADS)


def said_worn() -> str:
    """What the dissertation says of figures 4.6 to 4.9."""
    tree, plain = analysed("worn"), analysed("worn", ())
    unloaded, loaded = ratios("worn", 0), ratios("worn", 1)
    lengths = [float(t["unloaded"]["line_length"].sel(pair=0).mean()) for t in (plain, tree)]
    before, after = pressures(plain), pressures(tree)
    both = [t["loaded"].to_dataset()["transmission_error"].values[0] for t in (tree, plain)]
    difference = both[0] - both[1]
    return statements(
        [
            ("the unloaded peak to peak is reduced", f"by {100 - 100 * unloaded[0]:.0f} %", unloaded[0] < 1.0),
            ("the loaded one is reduced, too", f"by {100 - 100 * loaded[0]:.0f} %", loaded[0] < 1.0),
            ("contact lines grow longer", f"{lengths[0]:.1f} to {lengths[1]:.1f} mm", lengths[1] > lengths[0]),
            (
                "edge loading at the gear's root is reduced significantly",
                f"{before['root']:.0f} to {after['root']:.0f} MPa",
                after["root"] < 0.8 * before["root"],
            ),
            (
                "loaded curves agree where the dents are not in contact",
                f"they differ by {np.abs(difference).min():.1f} to {np.abs(difference).max():.1f} µrad",
                bool(np.abs(difference).min() < 0.5),
            ),
        ]
    )


def said_measured() -> str:
    """What the dissertation says of figures 4.11 to 4.14."""

    def changed(members: tuple[str, ...]) -> float:
        ease_off = analysed("measured", members)["ease_off"]
        return float(ease_off["ease_off_change"].where(ease_off["inside"] == 1).std())

    alone, both = [changed((m,)) for m in MEMBERS], changed(MEMBERS)
    peaks = [pressures(analysed("measured", m))["anywhere"] for m in ((), MEMBERS)]
    unloaded, loaded = ratios("measured", 0), ratios("measured", 1)
    centre = [float(analysed("measured", m)["unloaded"]["path_lengthwise"].sel(pair=0).mean()) for m in ((), MEMBERS)]
    return statements(
        [
            (
                "either deviation alone changes the ease-off considerably, both together compensate",
                f"rms change by the pinion {alone[0]:.1f} µm, by the gear {alone[1]:.1f}; by both {both:.1f} µm",
                both < 0.7 * min(alone),
            ),
            (
                "the unloaded peak to peak grows, by two thirds",
                f"by {100 * unloaded[0] - 100:.0f} %",
                unloaded[0] > 1.2,
            ),
            (
                "the loaded one grows less, by a quarter",
                f"by {100 * loaded[0] - 100:.0f} %",
                1.0 < loaded[0] < unloaded[0],
            ),
            (
                "the contact moves slightly to the heel",
                f"{centre[0]:.3f} to {centre[1]:.3f} of the face",
                centre[1] > centre[0] + 0.005,
            ),
            (
                "contact pressures are rather close",
                f"greatest {peaks[0]:.0f} to {peaks[1]:.0f} MPa",
                abs(peaks[1] / peaks[0] - 1.0) < 0.1,
            ),
        ]
    )
