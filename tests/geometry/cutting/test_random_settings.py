"""Random machine settings, from gentle to wild: a message or a sound flank, never anything else."""

from __future__ import annotations

import warnings
from dataclasses import replace
from functools import cache
from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray

from easeoff import EaseoffError
from easeoff.cases import gear_pair, read_case, shipped_cases
from easeoff.geometry import Blade, Flank, FlankName, GearPair, GeneratingSurface, Member, Misalignment, pair_geometry
from easeoff.geometry.cutting.blade import Relief
from easeoff.geometry.cutting.machine import MOVING_SETTINGS
from easeoff.geometry.flanks.flank import NodeStatus, on_parts
from easeoff.geometry.pair.ease_off import EaseOff, exact_ease_off
from easeoff.geometry.pair.gear_pair import grid
from easeoff.geometry.vectors import column, cross, dot, rotate

NODES = (5, 5)
BATCHES, SAMPLES = 19, 50
SIZES = {  # what a wild change is: mm, rad, 1
    "radial_distance": 10.0,
    "cradle_angle": 0.3,
    "machine_root_angle": 0.3,
    "work_offset": 10.0,
    "sliding_base": 10.0,
    "machine_center_to_crossing_point": 10.0,
    "cutter_tilt": 0.3,
    "cutter_swivel": 0.5,
    "ratio_of_roll": 0.5,
}
Random = np.random.Generator


@cache
def shipped_pairs() -> list[GearPair]:
    flanks: tuple[FlankName, ...] = ("drive", "coast")
    return [gear_pair(read_case(name), flank) for name in shipped_cases() for flank in flanks]


def shaken_surface(surface: GeneratingSurface, rng: Random, scale: float) -> GeneratingSurface:
    """Every setting moved at random; sometimes with modified roll, motions or face hobbing."""
    settings, blade = surface.settings, surface.blade
    changes = {}
    for name, size in SIZES.items():
        old = getattr(settings, name)
        if old is not None:
            changes[name] = old + size * scale * rng.normal()
    settings = replace(settings, **changes)
    if settings.generated and rng.random() < 0.5:
        settings = replace(settings, modified_roll=tuple(0.2 * scale * rng.normal(size=rng.integers(1, 5))))
    if settings.generated and rng.random() < 0.3:
        moving = rng.choice(MOVING_SETTINGS, size=2, replace=False)
        motions = tuple((str(m), tuple(SIZES[m] * scale * rng.normal(size=rng.integers(1, 4)))) for m in moving)
        settings = replace(settings, motions=motions)
    turned = (0.0, 0.0, 0.0)
    if rng.random() < 0.3:
        settings = replace(settings, indexing_ratio=float(rng.uniform(0.0, 1.5)))
        turned = tuple(0.3 * scale * rng.normal(size=3))
    radius = blade.point_radius + 10.0 * scale * rng.normal()
    angle = blade.pressure_angle + 0.3 * scale * rng.normal()
    whole: dict[str, Any] = {}
    if rng.random() < 0.3:
        whole |= {"spheric_radius": float(rng.choice([-1, 1]) * 10.0 ** rng.uniform(1.5, 6.0))}
    if rng.random() < 0.3:
        whole |= {"edge_radius": float(rng.uniform(0.0, 1.5))}
    if rng.random() < 0.15:
        whole |= {"toprem": Relief(float(rng.uniform(0.5, 4.0)), float(rng.uniform(0.0, 0.1)), 50.0)}
    if rng.random() < 0.15:
        whole |= {"flankrem": Relief(float(rng.uniform(4.0, 9.0)), float(rng.uniform(0.0, 0.1)), 80.0)}
    return replace(surface, settings=settings, blade=Blade(radius, angle, blade.side, *turned, **whole))


def shaken_pair(rng: Random) -> GearPair:
    """A shipped pair with one or both members and the assembly shaken."""
    pair = shipped_pairs()[rng.integers(len(shipped_pairs()))]
    scale = 10.0 ** rng.uniform(-4.0, 0.5)

    def shaken(member: Member) -> Member:
        return replace(member, loaded=shaken_surface(member.loaded, rng, scale))

    which = rng.integers(3)
    pinion = pair.pinion if which == 0 else shaken(pair.pinion)
    gear = pair.gear if which == 1 else shaken(pair.gear)
    errors = Misalignment(*(scale * rng.normal(size=4) * np.array([1.0, 1.0, 1.0, 0.02])))
    return replace(pair, pinion=pinion, gear=gear).misaligned(errors)


def check_flank(member: Member, flank: Flank) -> None:
    """Nodes marked usable are points of the flank with its normal; all others carry a reason."""
    inside = flank.inside
    t, h = grid(NODES)
    axial, radial = member.section.points(*(a.ravel() for a in np.meshgrid(t, h, indexing="ij")))
    position, normal = flank.position[:, inside], flank.normal[:, inside]
    assert np.all(np.isfinite(position))
    assert np.all(np.isfinite(flank.blade_distance[inside]))
    assert np.all(flank.blade_distance[inside] >= -1e-9)
    np.testing.assert_allclose(dot(normal, normal), 1.0, rtol=0, atol=1e-12)
    np.testing.assert_allclose(position[2], axial[inside], rtol=0, atol=1e-8)
    np.testing.assert_allclose(np.hypot(position[0], position[1]), radial[inside], rtol=0, atol=1e-8)
    assert np.all(np.isin(flank.status, list(NodeStatus)))
    check_normals(flank, inside)


def position_of(surface: GeneratingSurface, parameters: NDArray[np.float64]) -> NDArray[np.float64]:
    return surface.evaluate(parameters)[0]


def check_normals(flank: Flank, inside: NDArray[np.bool_]) -> None:
    """At right angles to the chords between neighbours, and on one side of the surface all over the flank."""
    parameters = flank.parameters[:, inside]
    size = 2e-6 * np.array([1.0, 1.0 if flank.surface.settings.generated else 100.0])
    chords = []
    for k in range(2):
        step = np.zeros((2, 1))
        step[k] = size[k]
        ahead, behind = (
            on_parts(flank.surface.flank_parts, flank.part[inside], parameters + sign * step, position_of)
            for sign in (1.0, -1.0)
        )
        chords.append(ahead - behind)
    for chord in chords:
        length = np.sqrt(dot(chord, chord))
        assert np.all(np.abs(dot(chord, flank.normal[:, inside])) < 1e-6 * length + 1e-11)
    side = dot(cross(chords[0], chords[1]), flank.normal[:, inside])
    assert np.all(side > -1e-15) or np.all(side < 1e-15)


def check_ease_off(pair: GearPair, gear: Flank, surface: EaseOff) -> None:
    """Where the ease-off says inside, gear node and conjugate point belong together and lie on their flanks."""
    inside, motion = surface.inside, surface.motion
    assert np.all(np.isin(surface.status, list(NodeStatus)))
    assert np.all(gear.inside[inside])
    for values in (
        surface.roll_angle,
        surface.angle,
        surface.lever_arm,
        surface.separation_curvature,
        surface.separation_skew,
    ):
        assert np.all(np.isfinite(values[inside]))
    for fraction in (surface.pinion_lengthwise[inside], surface.pinion_profile[inside]):
        assert np.all((fraction >= 0.0) & (fraction <= 1.0))
    rotation = surface.roll_angle[inside] + motion.center
    position, normal = motion.assembly.pinion_to_global(
        surface.pinion_position[:, inside], surface.pinion_normal[:, inside]
    )
    origin = column(motion.assembly.pinion_origin, position)
    position = rotate(motion.pinion_axis, rotation, position - origin) + origin
    normal = rotate(motion.pinion_axis, rotation, normal)
    assert np.all(np.abs(motion.closing_velocity(position, normal)) < 1e-9)
    point = motion.in_gear(position, rotation)
    np.testing.assert_allclose(point[2], gear.position[2, inside], rtol=0, atol=1e-8)
    radius = np.hypot(gear.position[0, inside], gear.position[1, inside])
    np.testing.assert_allclose(np.hypot(point[0], point[1]), radius, rtol=0, atol=1e-8)


def outcome(pair: GearPair, *, teeth: bool) -> str:
    """Run the geometry of a pair with every check; ``sound`` or the message it was refused with."""
    t, h = grid(NODES)
    try:
        gear = pair.gear.flank(t, h)
        check_flank(pair.gear, gear)
        check_flank(pair.pinion, pair.pinion.flank(t, h))
        check_ease_off(pair, gear, exact_ease_off(gear, pair.pinion.loaded, pair.pinion.section, pair.assembly))
        if teeth:
            pair_geometry(pair, NODES)
    except EaseoffError as error:
        return str(error)
    return "sound"


@pytest.mark.parametrize("seed", range(BATCHES))
@pytest.mark.quick(1)
@pytest.mark.random
def test_random_settings_give_a_message_or_a_sound_flank(seed: int, request: pytest.FixtureRequest) -> None:
    other = request.config.getoption("hypothesis_seed")  # of `make random`
    rng = np.random.default_rng(seed if other is None else [seed, int(other)])
    outcomes = []
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        for sample in range(SAMPLES):
            try:
                pair = shaken_pair(rng)
            except EaseoffError as error:
                outcomes.append(str(error))
                continue
            outcomes.append(outcome(pair, teeth=sample % 25 == 0))
    assert outcomes.count("sound") > SAMPLES / 2
    assert len(set(outcomes)) > 3  # wild enough to be refused, for more than one reason or place
    assert min(len(message) for message in outcomes if message != "sound") > 40
