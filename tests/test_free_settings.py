"""Settings by name: what is set is what is read, and a motion means what a case file means by it."""

from __future__ import annotations

import math

import numpy as np
import pytest
from pairs import conjugate_pair

from easeoff import InputError
from easeoff.geometry import EaseOffTarget, fit_pinion, get_setting, machine_pose, with_settings
from easeoff.geometry.cutting.named_settings import (
    BLADE_STEPS,
    CURVATURE_STEPS,
    MACHINE_STEPS,
    MODIFIED_ROLL_ORDERS,
    scale_of,
)

NAMES = [
    *BLADE_STEPS,
    *CURVATURE_STEPS,
    *MACHINE_STEPS,
    *MODIFIED_ROLL_ORDERS,
    "sliding_base_motion_1",
    "cutter_tilt_motion_3",
]


@pytest.mark.parametrize("name", NAMES)
def test_a_setting_reads_back_and_leaves_the_others_alone(name: str) -> None:
    start = conjugate_pair().pinion.loaded
    moved = with_settings(start, {name: get_setting(start, name) + scale_of(name)})
    for other in NAMES:
        change = scale_of(name) if other == name else 0.0
        assert get_setting(moved, other) - get_setting(start, other) == pytest.approx(change, rel=1e-9)


def test_motion_moves_its_setting_by_the_derivatives() -> None:
    start = conjugate_pair().pinion.loaded
    moved = with_settings(start, {"sliding_base_motion_1": 1.5, "sliding_base_motion_3": -4.0})
    increment = 0.2
    basic = get_setting(start, "sliding_base")
    wanted = basic + 1.5 * increment - 4.0 * increment**3 / math.factorial(3)
    still = with_settings(start, {"sliding_base": wanted})
    cradle = np.array([moved.sense * increment])
    one, two = (machine_pose(s.settings, cradle, s.sense).origin for s in (moved, still))
    np.testing.assert_allclose(one, two, rtol=0, atol=1e-12)


def test_several_orders_of_one_motion_stand_together() -> None:
    start = conjugate_pair().pinion.loaded
    moved = with_settings(start, {"work_offset_motion_2": 3.0, "work_offset_motion_1": 2.0, "modified_roll_24e": 1.2})
    assert dict(moved.settings.motions) == {"work_offset": (2.0, 1.5)}
    assert moved.settings.modified_roll == pytest.approx((0.0, 0.0, 0.05))


@pytest.mark.parametrize("name", ["blade", "sliding_base_motion_7", "ratio_of_roll_motion_1", "modified_roll"])
def test_other_names_are_refused(name: str) -> None:
    with pytest.raises(InputError, match=name):
        scale_of(name)


@pytest.mark.thorough
def test_curved_blade_gives_profile_crowning_that_a_straight_one_cannot() -> None:
    """A hollow blade crowns the pinion; its curvature is near that of the wanted parabola over the flank's depth."""
    pair, target = conjugate_pair(), EaseOffTarget(profile_crowning=0.02)
    free = ("point_radius", "pressure_angle", "radial_distance", "work_offset", "machine_center_to_crossing_point")
    straight = fit_pinion(pair, target, free=free)
    curved = fit_pinion(pair, target, free=(*free, "blade_curvature"))
    rms = [float(np.sqrt(np.mean(fit.residual**2))) for fit in (straight, curved)]
    assert rms[1] < 0.3 * rms[0]
    corners = pair.gear.section.corners
    half_depth = 0.5 * float(np.mean(np.linalg.norm(corners[:, 1] - corners[:, 0], axis=1)))
    curvature = curved.moved["blade_curvature"][1]
    assert curvature == pytest.approx(2.0 * 0.02 / half_depth**2, rel=0.2)
    assert curved.surface.blade.spheric_radius == pytest.approx(1.0 / curvature)
