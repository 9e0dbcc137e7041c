"""Tables of the page about chapter 5: the equivalent radius, ours and that of the dissertation."""

from __future__ import annotations

import numpy as np
from dissertation_tables import table
from efficiency_tables import AT, DESIGNS, DIRECTIONS, PRINTED, result


def everywhere() -> str:
    """Table: equivalent radius by each reading, where there is load and at the ends of the flank."""
    rows: list[tuple[object, ...]] = []
    printed = dict(zip(DESIGNS, PRINTED["equivalent radius [mm]"], strict=True))
    for letter in DESIGNS:
        for direction, words in DIRECTIONS.items():
            found = result(letter, direction)["loaded"].to_dataset().sel(torque=AT["torque"])
            radius, force = found["equivalent_radius"], found["force"]
            middle = radius.where(np.abs(found["profile"] - 0.5) < 0.1)
            ends = (middle.where(found["lengthwise"] < 0.1), middle.where(found["lengthwise"] > 0.9))
            rows.append(
                (
                    f"{letter.upper()}, {words}",
                    f"{float(radius.where(force > 0).min()):.0f} to {float(radius.where(force > 0).max()):.0f}",
                    " to ".join(f"{float(end.mean()):.0f}" for end in ends),
                    printed[letter],
                )
            )
    heads = ["radius [mm]", "loaded segments", "toe to heel, at half height", "dissertation"]
    return table(rows, heads)
