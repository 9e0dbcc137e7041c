"""Flanks cut by a curved blade, read from a session script, against that program's own chain of joints."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest
from session_chain import curved, flank_points
from test_session_script import CUTTERS, GEAR_EXTRAS, PINION_EXTRAS, points_of, read, script, with_extras


@pytest.mark.parametrize("hand", ["LEFT", "RIGHT"])
@pytest.mark.parametrize("flank", ["CONCAVE", "CONVEX"])
@pytest.mark.parametrize("member", ["PINION", "GEAR"])
@pytest.mark.parametrize("radius", [300.0, 900.0])
@pytest.mark.quick(4)
def test_curved_blades_cut_the_flanks_of_the_programs_own_chain(
    member: str, flank: str, hand: str, radius: float, tmp_path: Path
) -> None:
    machines = with_extras(member, PINION_EXTRAS if member == "PINION" else GEAR_EXTRAS)
    blade = {"TYPE": "CURVED", "RHO": radius, "EDGERADIUS": 0.5}
    cutters: dict[str, dict[str, dict[str, Any]]] = {
        name: {side: dict(values) | (blade if (name, side) == (member, flank) else {}) for side, values in both.items()}
        for name, both in CUTTERS.items()
    }
    case, _ = read(script(hand, machines, cutters=cutters), tmp_path)
    edge = curved(cutters[member][flank], flank)
    points = points_of(case, member, flank)
    theirs = flank_points(member, hand, machines[member][flank], edge, points)
    np.testing.assert_allclose(points, theirs, rtol=0, atol=1e-9)
