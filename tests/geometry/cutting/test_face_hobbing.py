"""Face hobbing: one formulation with face milling, exact conjugacy, and a whole analysis of a face-hobbed pair."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest
from pairs import COAST, DRIVE, GENERATED, GROUPS, PARAMETERS, hobbed_pair
from scipy.spatial.transform import Rotation

from easeoff import InputError
from easeoff.cases import case_text, gear_pair, parse_case, read_case
from easeoff.contact import ElasticModel, MeshCycle
from easeoff.geometry import (
    Blade,
    EaseOffTarget,
    GeneratingSurface,
    Hand,
    fit_pinion,
    pair_geometry,
)
from easeoff.geometry.cutting.machine import work_rotation
from easeoff.geometry.flanks.flank import NodeStatus
from easeoff.geometry.pair.ease_off import exact_ease_off
from easeoff.geometry.pair.gear_pair import grid
from easeoff.geometry.vectors import column, cross, dot, rotate_z
from easeoff.verification.conventional_analysis import both_methods, point_differences


def test_face_milling_is_the_case_without_indexing() -> None:
    """The general quadratic gives the classical linear solution s = -(N . V0) / (N . V1) of a cone, to rounding."""
    surface = GeneratingSurface(Blade(75.0, math.radians(18.0), "outside"), GENERATED, "right", -1)
    angle, cradle_rotation = PARAMETERS
    frame = Rotation.from_euler("ZX", [-GENERATED.cutter_swivel, GENERATED.cutter_tilt]).as_matrix()
    x_axis, y_axis, axis = (column(frame[:, i], angle[None]) for i in range(3))
    radial = x_axis * np.cos(angle) + y_axis * np.sin(angle)
    sine, cosine = math.sin(surface.blade.pressure_angle), math.cos(surface.blade.pressure_angle)
    normal, edge = -cosine * radial - sine * axis, sine * radial - cosine * axis
    tip = column(np.array([75.0, 0.0, 0.0]), radial) + 75.0 * radial
    back = -(GENERATED.cradle_angle + cradle_rotation)
    work_axis = np.array([math.cos(0.3), 0.0, math.sin(0.3)])
    crossing_point = np.array([0.0, 4.0, 0.7]) - 1.1 * work_axis
    work, origin = (rotate_z(back, tuple(v)) for v in (work_axis, crossing_point))
    _, ratio = work_rotation(GENERATED, cradle_rotation, -1)
    spin = -ratio * work
    spin[2] += 1.0
    classical = -dot(normal, cross(spin, tip) + ratio * cross(work, origin)) / dot(normal, cross(spin, edge))
    _, found_normal, found = surface.evaluate(PARAMETERS)
    np.testing.assert_allclose(found, classical, rtol=1e-12, atol=1e-12)
    turned = replace(surface, blade=replace(surface.blade, side="outside"), settings=replace(GENERATED))
    np.testing.assert_array_equal(turned.evaluate(PARAMETERS)[1], found_normal)


def test_edge_is_a_unit_vector_and_plain_without_turns() -> None:
    for blade in (DRIVE, COAST):
        assert np.linalg.norm(blade.edge) == pytest.approx(1.0, abs=1e-15)
        assert math.hypot(*blade.tip) == pytest.approx(blade.point_radius)
    plain = Blade(90.0, 0.3, "outside")
    assert plain.edge == pytest.approx((math.sin(0.3), 0.0, -math.cos(0.3)))


@pytest.mark.parametrize("blade", [DRIVE, COAST])
def test_hobbed_flank_satisfies_the_equation_of_meshing(blade: Blade) -> None:
    """Distance, cutter and cradle derivatives of the blade points lie in one plane (Kolivand 2009, Eq. 2.8)."""
    settings = replace(GENERATED, indexing_ratio=GROUPS / 11)
    surface = GeneratingSurface(blade, settings, "right", -1)
    still = replace(settings, ratio_of_roll=None, modified_roll=())

    def family(angle: float, distance: float, cradle: float) -> np.ndarray:
        turned = replace(surface, settings=replace(still, cradle_angle=settings.cradle_angle + cradle))
        point = turned.evaluate(np.array([[angle], [distance]]))[0]
        roll, _ = work_rotation(settings, np.array([cradle]), -1)
        return rotate_z(-roll, point)[:, 0]

    distances = surface.evaluate(PARAMETERS)[2]
    for (angle, cradle), distance in zip(PARAMETERS.T, distances, strict=True):
        here, h = np.array([angle, distance, cradle]), 1e-5
        d = [(family(*(here + h * e)) - family(*(here - h * e))) / (2 * h) for e in np.eye(3)]
        triple = np.dot(np.cross(d[1], d[0]), d[2]) / np.prod([np.linalg.norm(v) for v in d])
        assert abs(triple) < 1e-8
        normal = surface.evaluate(np.array([[angle], [cradle]]))[1][:, 0]
        assert max(abs(v @ normal) / np.linalg.norm(v) for v in d) < 1e-7


@pytest.mark.parametrize("coast", [False, True])
@pytest.mark.parametrize("hand", ["left", "right"])
def test_hobbed_conjugate_pinion_has_no_ease_off(hand: Hand, coast: bool) -> None:
    pair = hobbed_pair(hand, coast=coast)
    t, h = grid((9, 7))
    result = exact_ease_off(pair.gear.flank(t, h), pair.pinion.loaded, pair.pinion.section, pair.assembly)
    known = np.isfinite(result.angle)
    assert known.mean() > 0.8
    values = result.angle[known] * result.lever_arm[known]
    lever = result.lever_arm[known]
    values = values - lever * (lever @ values) / (lever @ lever)
    assert np.abs(values).max() < 1e-9


def test_hobbed_pair_goes_through_the_whole_analysis() -> None:
    """Crowned by a fit, then unloaded and loaded: certified at every position."""
    pair, free = hobbed_pair("left"), ("point_radius", "pressure_angle", "radial_distance", "modified_roll_2c")
    fitted = fit_pinion(pair, EaseOffTarget(0.02, 0.015, 0.0, 0.0, -0.005), free=free, nodes=(5, 5))
    assert np.abs(fitted.residual).max() < 0.02  # a straight blade cannot give a hobbed flank every form
    crowned = replace(pair, pinion=replace(pair.pinion, loaded=fitted.surface))
    geometry = pair_geometry(crowned, (17, 13))
    # A quarter of the pinion's flank is undercut: there is no whole tooth for another model than the shell.
    loaded, _ = MeshCycle.of(geometry, ElasticModel(), mesh_positions=4).loaded([100.0, 300.0])
    assert np.all(loaded["status"].values == 0)
    assert np.all(np.diff(loaded["mean_level"].values) > 0.0)


@pytest.mark.thorough
def test_undercut_does_not_disturb_the_rest_of_the_flank() -> None:
    """A quarter of this pinion cannot be cut, and curvatures grow without limit towards it: the error stays right."""
    pair = hobbed_pair("left")
    fitted = fit_pinion(pair, EaseOffTarget(0.02, 0.015, 0.0, 0.0, -0.005))
    both = both_methods(replace(pair, pinion=replace(pair.pinion, loaded=fitted.surface)))
    missing = pair.pinion.flank(*grid((31, 21))).status == NodeStatus.NO_SOLUTION
    assert 0.2 < missing.mean() < 0.4
    error, _ = point_differences(both)
    assert np.isfinite(error).sum() > 80
    assert np.nanmax(np.abs(error)) < 5e-6
    assert np.nanmedian(np.abs(error)) < 1e-8


def test_case_file_takes_hobbing_data() -> None:
    text = case_text("fm-11x41").replace(
        "[gear.convex.cutter]", "[gear.convex.cutter]\nnumber_of_blade_groups = 13\nblade_offset_angle = 12.0"
    )
    surface = gear_pair(parse_case(text)).gear.loaded
    assert surface.settings.indexing_ratio == pytest.approx(13 / 41)
    assert surface.blade.offset_angle == pytest.approx(math.radians(12.0))
    assert gear_pair(read_case("fm-11x41")).gear.loaded.settings.indexing_ratio == 0.0
    with pytest.raises(InputError, match="number_of_blade_groups"):
        parse_case(text.replace("number_of_blade_groups = 13\n", ""))
