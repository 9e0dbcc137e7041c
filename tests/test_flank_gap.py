"""The gap between flanks along a ray, against conventional contact analysis."""

from __future__ import annotations

import numpy as np

from easeoff.cases import gear_pair, read_case
from easeoff.geometry import exact_ease_off
from easeoff.geometry.pair.gear_pair import grid
from easeoff.verification import flank_gap, path_of_contact


def test_no_gap_where_the_flanks_touch() -> None:
    """At the points of contact of the five equations gap and place agree; turning on closes by the lever arm."""
    pair = gear_pair(read_case("fm-11x41"))
    gear = pair.gear.flank(*grid((9, 7)))
    surface = exact_ease_off(gear, pair.pinion.loaded, pair.pinion.section, pair.assembly)
    motion = surface.motion
    for rotation in (-0.15, 0.0, 0.2):
        contact = path_of_contact(gear, surface, np.array([rotation]))
        assert contact.converged.all()
        position, normal, _ = pair.gear.loaded.evaluate(contact.gear_parameters)
        turned, closing = rotation + motion.center, float(contact.closing_angle[0])
        start = contact.pinion_parameters + 0.01
        found = flank_gap(motion, position, normal, turned, closing, start)
        assert abs(found.gap[0]) < 1e-8
        np.testing.assert_allclose(found.pinion_position, contact.pinion_position, atol=1e-7)
        np.testing.assert_allclose(found.facing, 1.0, atol=1e-12)
        arm = np.abs(position[0] * normal[1] - position[1] * normal[0])
        further = flank_gap(motion, position, normal, turned, closing - 1e-5, start)
        np.testing.assert_allclose(further.gap, 1e-5 * arm, rtol=1e-3)


def test_no_gap_is_a_number_where_no_flank_is() -> None:
    pair = gear_pair(read_case("fm-11x41"))
    gear = pair.gear.flank(*grid((5, 5)))
    surface = exact_ease_off(gear, pair.pinion.loaded, pair.pinion.section, pair.assembly)
    far = gear.position[:, :1] + np.array([[0.0], [0.0], [300.0]])
    found = flank_gap(surface.motion, far, gear.normal[:, :1], 0.0, 0.0, surface.pinion_parameters[:, :1])
    assert np.all(np.isnan(found.gap))
