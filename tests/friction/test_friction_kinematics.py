"""Surface velocities: identities that hold to rounding, closed forms, and motions differentiated numerically."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
import xarray as xr
from numpy.typing import NDArray
from pairs import conjugate_pair
from spur_pair import shape_operators, spur

from easeoff import InputError
from easeoff.cases import gear_pair, read_case
from easeoff.friction.loaded_contacts import Axes, SurfaceVelocities, action_splines, axes_of, surface_velocities
from easeoff.geometry import GearPair, Misalignment
from easeoff.geometry.pair.ease_off import EaseOff, drift, exact_ease_off
from easeoff.geometry.pair.gear_pair import ease_off_dataset
from easeoff.geometry.vectors import column, cross, dot, rotate

Array = NDArray[Any]
NODES = (17, 13)


def pair_of(name: str) -> GearPair:
    case, _, flank = name.partition(":")
    pair = gear_pair(read_case(case), "coast" if flank == "coast" else "drive")
    return pair.misaligned(Misalignment(0.1, -0.05, 0.03, 1e-3))


@pytest.fixture(scope="module", params=["fh-design-b", "nasa-12x36:coast", "fm-11x41"])
def surface(request: pytest.FixtureRequest) -> EaseOff:
    pair = pair_of(request.param)
    gear = pair.gear.flank(*grid())
    return exact_ease_off(gear, pair.pinion.loaded, pair.pinion.section, pair.assembly)


def grid() -> tuple[Array, Array]:
    return np.linspace(0.0, 1.0, NODES[0]), np.linspace(0.0, 1.0, NODES[1])


@pytest.fixture(scope="module")
def dataset(surface: EaseOff) -> xr.Dataset:
    return ease_off_dataset(*grid(), surface, drift(surface))


def nodes(dataset: xr.Dataset) -> tuple[Array, Array]:
    """Fractions (2, n) of the common flank's nodes, and where they are in the grid."""
    inside = dataset["inside"].values == 1
    points = np.stack(np.meshgrid(dataset["lengthwise"], dataset["profile"], indexing="ij"))
    return points[:, inside], inside


def at_nodes(dataset: xr.Dataset) -> SurfaceVelocities:
    return surface_velocities(axes_of(dataset), action_splines(dataset), nodes(dataset)[0])


def test_both_members_have_the_same_normal_velocity(dataset: xr.Dataset) -> None:
    """Kolivand 2009, Eq. 5.2, at the stored points of action: to rounding, misaligned or not."""
    _, inside = nodes(dataset)
    position = 1e-3 * np.moveaxis(dataset["action_position"].values[inside], -1, 0)
    normal = np.moveaxis(dataset["action_normal"].values[inside], -1, 0)
    pinion, gear = axes_of(dataset).velocities(position)
    size = np.linalg.norm(pinion, axis=0)
    assert np.max(np.abs(dot(pinion - gear, normal)) / size) < 1e-13
    # Between the nodes, to the error of the interpolation.
    points = np.random.default_rng(0).uniform(0.3, 0.7, (2, 200))
    between = surface_velocities(axes_of(dataset), action_splines(dataset), points)
    assert np.max(np.abs(dot(between.sliding, between.normal))) < 1e-6 * size.max()


def test_the_gears_own_normal_would_not_do() -> None:
    """With ease-off the flanks' normals differ; on a conjugate pair they are the same and either will do."""
    for pair, exact in ((pair_of("fh-design-b").misaligned(Misalignment()), False), (conjugate_pair(), True)):
        gear = pair.gear.flank(*grid())
        found = exact_ease_off(gear, pair.pinion.loaded, pair.pinion.section, pair.assembly)
        motion, inside = found.motion, found.inside
        turn = (found.roll_angle + motion.center) / motion.assembly.ratio - found.angle
        normal = rotate(motion.gear_axis, turn, gear.normal)
        data = ease_off_dataset(*grid(), found, drift(found))
        pinion, driven = axes_of(data).velocities(1e-3 * found.action_position)
        worst = np.max(np.abs(dot(pinion - driven, normal))[inside])
        assert (worst < 1e-12) == exact
        if exact:
            np.testing.assert_allclose(found.action_normal[:, inside], -normal[:, inside], atol=1e-9)


def test_sliding_is_how_the_pinion_moves_over_a_gear_that_stands_still(surface: EaseOff, dataset: xr.Dataset) -> None:
    """Change of frame: a pinion point, seen from the turning gear, differentiated by the rotation."""
    motion, rotation = surface.motion, surface.roll_angle + surface.motion.center
    step = 1e-4

    def seen(turn: float) -> Array:
        position, _ = motion.action_point(surface.pinion_parameters, rotation + turn)
        return motion.in_gear(position, rotation + turn)

    relative = (8 * (seen(step) - seen(-step)) - (seen(2 * step) - seen(-2 * step))) / (12 * step)
    in_space = rotate(motion.gear_axis, rotation / motion.assembly.ratio, relative)
    found = at_nodes(dataset)
    _, inside = nodes(dataset)
    expected = 1e-3 * in_space[:, inside.ravel()]
    np.testing.assert_allclose(found.sliding, expected, atol=1e-10 * np.abs(expected).max() + 1e-12)
    np.testing.assert_allclose(found.sliding_speed, np.linalg.norm(expected, axis=0), rtol=1e-8)


def test_directions_are_an_orthonormal_frame_in_the_flank(dataset: xr.Dataset) -> None:
    found = at_nodes(dataset)
    for first in (found.normal, found.along, found.across):
        np.testing.assert_allclose(dot(first, first), 1.0, atol=1e-12)
    for pair in ((found.normal, found.along), (found.normal, found.across), (found.along, found.across)):
        assert np.max(np.abs(dot(*pair))) < 1e-12
    # Along: towards the heel. Across: the way the line moves, with the roll angle.
    fields = action_splines(dataset)
    points = np.random.default_rng(4).uniform(0.3, 0.7, (2, 50))
    here, step = surface_velocities(axes_of(dataset), fields, points), 1e-4
    ahead = fields("position", on_level(fields, points, fields("roll_angle", points) + step)) - fields(
        "position", points
    )
    on_gear = ahead - step * here.gear
    assert np.all(dot(on_gear, here.across) > 0.0)
    slope = np.stack([fields("roll_angle", points, d) for d in ((1, 0), (0, 1))])
    along_level = points + step * np.array([[1.0], [0.0]]) - step * np.stack([0.0 * slope[0], slope[0] / slope[1]])
    assert np.all(dot(fields("position", along_level) - fields("position", points), here.along) > 0.0)


def on_level(fields: Any, points: Array, level: Array) -> Array:
    """Points moved onto levels of the roll angle, along its gradient in the unit square."""
    for _ in range(4):
        slope = np.stack([fields("roll_angle", points, d) for d in ((1, 0), (0, 1))])
        points = points + (level - fields("roll_angle", points)) * slope / np.sum(slope**2, axis=0)
    return points


def test_rolling_over_the_line_is_rolling_less_the_lines_own_motion(dataset: xr.Dataset) -> None:
    """Change of frame: the contact lines of two neighbouring moments tell how fast the line moves across itself."""
    fields, axes = action_splines(dataset), axes_of(dataset)
    points = np.random.default_rng(1).uniform(0.3, 0.7, (2, 50))
    here = surface_velocities(axes, fields, points)
    level, step = fields("roll_angle", points), 1e-4
    ahead, behind = (fields("position", on_level(fields, points, level + sign * step)) for sign in (1.0, -1.0))
    line = dot((ahead - behind) / (2 * step), here.across)
    np.testing.assert_allclose(here.rolling_over_line, here.rolling - line, atol=1e-7 * np.abs(here.rolling).max())
    # Either member's surface, relative to the line, differs by the sliding: it does not matter whose frame it is.
    pinion, gear = (dot(v, here.across) - line for v in (here.pinion, here.gear))
    np.testing.assert_allclose(pinion - gear, here.sliding_across, atol=1e-14)
    np.testing.assert_allclose(-gear, here.line_over_gear, rtol=1e-6)


def test_points_of_action_of_one_moment_lie_along_the_line() -> None:
    """Chords of a level set of the roll angle: along the line, and in the flank."""
    pair = conjugate_pair()
    found = exact_ease_off(pair.gear.flank(*grid()), pair.pinion.loaded, pair.pinion.section, pair.assembly)
    data = ease_off_dataset(*grid(), found, drift(found))
    fields = action_splines(data)
    points = np.random.default_rng(2).uniform(0.3, 0.7, (2, 20))
    here = surface_velocities(axes_of(data), fields, points)
    slope = np.stack([fields("roll_angle", points, d) for d in ((1, 0), (0, 1))])
    aside = np.stack([-slope[1], slope[0]]) / np.linalg.norm(slope, axis=0)
    level, step = fields("roll_angle", points), 1e-3
    one, other = (fields("position", on_level(fields, points + s * step * aside, level)) for s in (1.0, -1.0))
    chord = (one - other) / np.linalg.norm(one - other, axis=0)
    np.testing.assert_allclose(np.abs(dot(chord, here.along)), 1.0, atol=1e-6)
    assert np.max(np.abs(dot(chord, here.normal))) < 1e-5


def test_involute_spur_gears_roll_and_slide_as_in_the_textbook() -> None:
    """u1 = r1 sin a + s, u2 = (r2 sin a - s)/R, sliding (1 + 1/R)|s|; the line of contact stays where it is."""
    radius, ratio, angle = 0.05, 2.5, 0.35
    data, s = spur(radius, ratio, angle)
    points = np.stack(np.meshgrid(data["lengthwise"], data["profile"], indexing="ij"))
    found = surface_velocities(axes_of(data), action_splines(data), points)
    first = radius * np.sin(angle) + s
    second = (ratio * radius * np.sin(angle) - s) / ratio
    np.testing.assert_allclose(np.abs(found.sliding_along), 0.0, atol=1e-14)
    np.testing.assert_allclose(found.sliding_speed, (1.0 + 1.0 / ratio) * np.abs(s), atol=1e-13)
    np.testing.assert_allclose(np.abs(found.rolling), 0.5 * (first + second), rtol=1e-12)
    # The plane of action holds the normals: the line does not move across the flank's normal.
    np.testing.assert_allclose(found.rolling_over_line, found.rolling, rtol=1e-11)
    np.testing.assert_allclose(found.line_over_gear, second, rtol=1e-11)
    pitch_point = np.isclose(s, 0.0)
    assert np.max(found.sliding_speed[pitch_point]) < 1e-13


def test_equivalent_radius_goes_with_the_rolling_velocity(dataset: xr.Dataset) -> None:
    """Both members' normals at the contact turn alike: (K_g - K_p) v = (K_g + K_p) v_s / 2 + w x n, v the rolling.

    Along the contact line there is no relative curvature, across it one over the equivalent radius.
    """
    axes, fields = axes_of(dataset), action_splines(dataset)
    points = np.random.default_rng(7).uniform(0.3, 0.7, (2, 200))
    here = surface_velocities(axes, fields, points)
    pinion, gear = shape_operators(axes, fields, points)
    relative = [gear(t) - pinion(t) for t in (here.along, here.across)]
    curvature = dot(relative[1], here.across)
    for tangent, change in ((here.along, relative[0]), (here.along, relative[1])):
        assert np.max(np.abs(dot(tangent, change) / curvature)) < 1e-5
    sliding = here.along * here.sliding_along + here.across * here.sliding_across
    spin = cross(column(axes.pinion_axis - axes.gear_axis / axes.ratio, here.normal), here.normal)
    turning = dot(0.5 * (gear(sliding) + pinion(sliding)) + spin, here.across)
    np.testing.assert_allclose(curvature * here.rolling_over_line, turning, rtol=1e-9)


def test_velocities_do_not_depend_on_the_point_taken_on_an_axis(dataset: xr.Dataset) -> None:
    axes = axes_of(dataset)
    other = Axes(
        axes.pinion_axis,
        axes.pinion_origin + 0.3 * axes.pinion_axis,
        axes.gear_axis,
        axes.gear_origin - 2.0 * axes.gear_axis,
        axes.ratio,
    )
    point = np.random.default_rng(3).normal(size=(3, 10))
    for one, two in zip(axes.velocities(point), other.velocities(point), strict=True):
        np.testing.assert_allclose(one, two, atol=1e-14)
    pinion, gear = axes.velocities(column(axes.gear_origin, point) + 0.0 * point)
    np.testing.assert_allclose(gear, 0.0, atol=1e-15)
    assert np.all(np.linalg.norm(pinion, axis=0) > 0.0)


def test_points_of_action_have_the_axial_and_radial_coordinates_of_the_gears_nodes() -> None:
    pair = pair_of("fm-11x41")
    gear = pair.gear.flank(*grid())
    found = exact_ease_off(gear, pair.pinion.loaded, pair.pinion.section, pair.assembly)
    x, y, z = found.action_position - column(pair.assembly.gear_origin, found.action_position)
    inside = found.inside
    np.testing.assert_allclose(z[inside], gear.position[2][inside], atol=1e-9)
    np.testing.assert_allclose(np.hypot(x, y)[inside], np.hypot(*gear.position[:2])[inside], atol=1e-9)


def test_an_older_result_is_refused(dataset: xr.Dataset) -> None:
    with pytest.raises(InputError, match="older version"):
        axes_of(dataset.drop_vars("action_position"))
    with pytest.raises(InputError, match="older version"):
        axes_of(dataset.drop_attrs())
