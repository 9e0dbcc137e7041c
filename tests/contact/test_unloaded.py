"""Unloaded contact: against conventional contact analysis, closed forms and its own grid."""

from __future__ import annotations

import math
from dataclasses import replace
from functools import cache
from typing import Literal

import numpy as np
import pytest
import xarray as xr
from pairs import conjugate_pair, contact_path, relieved
from scipy.optimize import brentq, minimize_scalar

from easeoff import GeometryError, InputError
from easeoff.cases import gear_pair, read_case
from easeoff.contact import MeshCycle, lines_in_mesh, unloaded_contact
from easeoff.contact.lines import touching_points, turned_flanks
from easeoff.contact.lines.closest_approach import closest_approach
from easeoff.contact.lines.contact_lines import (
    POINTS_PER_LINE,
    ContactLines,
    arc_length,
    boundary_distance,
    contact_splines,
    trace,
)
from easeoff.contact.lines.flank_splines import fit
from easeoff.contact.lines.mesh_lines import gauss_points, mesh_rotations
from easeoff.contact.lines.turned_flanks import BOUNDS, TurnedFlanks, TurnedGap
from easeoff.contact.loaded import continuous_range, harmonics, peak_to_peak, rms
from easeoff.contact.unloaded import CONTACT_EDGES, PairErrors
from easeoff.geometry import (
    FlankName,
    GearPair,
    GlobalErrors,
    Misalignment,
    PairGeometry,
    deviation_from_formula,
    newton,
    pair_geometry,
)
from easeoff.geometry.cutting.blade import Relief
from easeoff.geometry.deviation.deviated_flank import deviated_ease_off, deviated_pair
from easeoff.verification import smallest_gap
from easeoff.verification.smallest_gap import smallest_envelope

PARTS = BOUNDS.index("gear_joint")  # the bounds from there on are infinite on a flank of one part


@cache
def shipped(name: str, flank: FlankName = "drive") -> PairGeometry:
    """A shipped pair on the default grid."""
    return pair_geometry(gear_pair(read_case(name), flank))


@pytest.fixture(scope="module")
def nasa() -> tuple[GearPair, PairGeometry]:
    geometry = shipped("nasa-12x36")
    return geometry.pair, geometry


@pytest.fixture(scope="module")
def conjugate() -> tuple[GearPair, PairGeometry]:
    pair = conjugate_pair()
    return pair, pair_geometry(pair, (41, 27))


def with_ease_off(geometry: PairGeometry, angle: np.ndarray) -> PairGeometry:
    """The same pair with another ease-off, as a gear rotation over the grid."""
    changed = geometry.ease_off.copy()
    changed["ease_off_angle"] = (("lengthwise", "profile"), angle)
    return replace(geometry, ease_off=changed)


@pytest.mark.parametrize("flank", ["drive", "coast"])
@pytest.mark.parametrize(("name", "error", "distance"), [("nasa-12x36", 0.1, 0.01), ("fm-11x41", 0.01, 0.002)])
def test_agrees_with_conventional_contact_analysis(
    name: str, error: float, distance: float, flank: Literal["drive", "coast"]
) -> None:
    """Transmission error [urad] and path [mm] against the five-equation solution, wherever both flanks exist."""
    geometry = shipped(name, flank)
    pair = geometry.pair
    fields = contact_splines(geometry.flanks, geometry.ease_off)
    result = unloaded_contact(geometry, fields, lines_in_mesh(fields, pair.assembly.pinion_pitch, 8))
    own = result.sel(pair=0)
    rotations = np.degrees(own["pinion_rotation"].values)
    exact = contact_path(pair, rotations)
    pinion = pair.pinion.section.fractions(exact.pinion_position[2], np.hypot(*exact.pinion_position[:2]))
    # A point contact is the end of the story only where both members really have a flank.
    inside = exact.converged & (np.abs(pinion[1] - 0.5) < 0.5) & (np.abs(pinion[0] - 0.5) < 0.5)
    assert inside.sum() > 3
    zero = geometry.ease_off.attrs["first_contact_rad"]
    difference = 1e6 * (exact.closing_angle - zero) - own["transmission_error"].values
    assert np.abs(difference[inside]).max() < error
    t, h = pair.gear.section.fractions(exact.gear_position[2], np.hypot(*exact.gear_position[:2]))
    assert pair.gear.section.face_width * np.abs(t - own["path_lengthwise"].values)[inside].max() < distance
    assert 8.0 * np.abs(h - own["path_profile"].values)[inside].max() < distance


def test_without_the_closest_approach_correction_it_would_not_agree(nasa: tuple[GearPair, PairGeometry]) -> None:
    """The correction next to the level set is worth microradians on a pair with a steep ease-off."""
    pair, geometry = nasa
    fields = contact_splines(geometry.flanks, geometry.ease_off)
    mesh = lines_in_mesh(fields, pair.assembly.pinion_pitch, 8)
    plain = fields("ease_off_angle", mesh.lines.points)
    corrected = closest_approach(fields, mesh.lines.points).separation_angle
    assert np.all(corrected <= plain + 1e-15)
    assert 1e6 * np.abs(plain - corrected).max() > 5.0


def test_conjugate_pair_has_no_transmission_error(conjugate: tuple[GearPair, PairGeometry]) -> None:
    pair, geometry = conjugate
    fields = contact_splines(geometry.flanks, geometry.ease_off)
    result = unloaded_contact(geometry, fields, lines_in_mesh(fields, pair.assembly.pinion_pitch, 12))
    assert np.nanmax(np.abs(result["transmission_error"].values)) < 1e-6
    assert result.attrs["peak_to_peak"] < 1e-6


def test_parabolic_ease_off_gives_a_parabolic_error(conjugate: tuple[GearPair, PairGeometry]) -> None:
    """With a = (1/2) k Q^2 over the roll angle Q the error is (1/2) k q^2 / (1 + k/c), c the separation curvature."""
    pair, geometry = conjugate
    roll = geometry.ease_off["roll_angle"].values
    k = 4e-4
    geometry = with_ease_off(geometry, 0.5 * k * roll**2)
    fields = contact_splines(geometry.flanks, geometry.ease_off)
    pitch = pair.assembly.pinion_pitch
    result = unloaded_contact(geometry, fields, lines_in_mesh(fields, pitch, 16))
    q = result["pinion_rotation"].values
    moving = np.abs(q) > 1e-9
    ratio = result["transmission_error"].sel(pair=0).values[moving] / (1e6 * 0.5 * k * q[moving] ** 2)
    curvature = geometry.ease_off["separation_curvature"].values
    assert 1.0 / (1.0 + k / curvature.min()) - 1e-9 < ratio.min()
    assert ratio.max() < 1.0 / (1.0 + k / curvature.max()) + 1e-9
    assert result.attrs["peak_to_peak"] == pytest.approx(1e6 * 0.5 * k * (pitch / 2) ** 2, rel=1e-2)


def test_crossing_of_adjacent_pairs_is_the_largest_error(conjugate: tuple[GearPair, PairGeometry]) -> None:
    pair, geometry = conjugate
    roll = geometry.ease_off["roll_angle"].values
    geometry = with_ease_off(geometry, 2e-4 * roll**2)
    fields = contact_splines(geometry.flanks, geometry.ease_off)
    result = unloaded_contact(geometry, fields, lines_in_mesh(fields, pair.assembly.pinion_pitch, 16))
    envelope = result["transmission_error_envelope"].values
    assert np.all(envelope <= np.nanmin(result["transmission_error"].values, axis=0) + 1e-12)
    assert int(np.argmax(envelope)) == 0  # half a pitch from the middle, where two pairs carry alike
    assert set(result["carrying_pair"].values.tolist()) <= {-1, 0}


@pytest.mark.thorough
def test_error_converges_with_the_grid(nasa: tuple[GearPair, PairGeometry]) -> None:
    """Between grids the error shrinks by far more than the fourth order; the default is within 0.1 %."""
    pair, _ = nasa
    levels = {}
    for nodes in ((9, 7), (13, 9), (17, 13), (31, 21), (61, 41)):
        geometry = pair_geometry(pair, nodes)
        fields = contact_splines(geometry.flanks, geometry.ease_off)
        result = unloaded_contact(geometry, fields, lines_in_mesh(fields, pair.assembly.pinion_pitch, 16))
        levels[nodes] = result.attrs["peak_to_peak"]
    reference = levels.pop((61, 41))
    errors = [abs(value / reference - 1.0) for value in levels.values()]
    assert errors[3] < 1e-4
    assert np.log2(errors[0] / errors[2]) > 4.0


def test_lines_end_on_the_boundary(nasa: tuple[GearPair, PairGeometry]) -> None:
    pair, geometry = nasa
    fields = contact_splines(geometry.flanks, geometry.ease_off)
    lines = lines_in_mesh(fields, pair.assembly.pinion_pitch, 9).lines
    for end in (0, -1):
        points = lines.points[:, :, end]
        on_gear_edge = np.min(np.minimum(points, 1.0 - points), axis=0)
        distance = np.minimum(boundary_distance(fields, points), on_gear_edge)
        assert np.abs(distance).max() < 1e-6
    inner = lines.points[:, :, 1:-1]
    assert boundary_distance(fields, inner).min() > -1e-9


def test_points_of_a_line_share_its_roll_angle_and_are_evenly_spaced(nasa: tuple[GearPair, PairGeometry]) -> None:
    _, geometry = nasa
    fields = contact_splines(geometry.flanks, geometry.ease_off)
    levels = np.linspace(-0.5, 0.4, 7)
    lines = trace(fields, levels)
    roll = fields("roll_angle", lines.points)
    np.testing.assert_allclose(roll, np.repeat(levels[lines.level][:, None], roll.shape[1], 1), rtol=0, atol=2e-7)
    np.testing.assert_allclose(
        roll[:, 1:-1] - roll[:, [32]], 0.0, rtol=0, atol=1e-10
    )  # its ends stop at the flank's edge
    steps = np.diff(arc_length(fields, lines.points), axis=1)
    np.testing.assert_allclose(steps / steps.mean(axis=1, keepdims=True), 1.0, rtol=0, atol=2e-3)
    points, weights = gauss_points(lines, 20)
    roll = fields("roll_angle", points)
    np.testing.assert_allclose(roll, np.repeat(levels[lines.level][:, None], roll.shape[1], 1), rtol=0, atol=1e-7)
    assert weights.sum() == pytest.approx(1.0)


def test_arc_length_of_a_known_curve() -> None:
    """A circle of radius 50 mm drawn on the flank, to fourth order in the number of points."""
    t = h = np.linspace(0.0, 1.0, 25)
    grid_t, grid_h = np.meshgrid(t, h, indexing="ij")
    angle = 0.6 * grid_t
    position = np.stack([50 * np.cos(angle), 50 * np.sin(angle), 8 * grid_h], axis=-1)
    fields = fit(t, h, {"position": position})
    errors = []
    for count in (9, 17):
        points = np.stack([np.linspace(0, 1, count), np.full(count, 0.5)])[:, None, :]
        errors.append(abs(float(arc_length(fields, points)[0, -1]) - 30.0))
    assert errors[1] < 1e-6
    assert errors[0] / max(errors[1], 1e-12) > 6.0


def test_holes_are_bridged_but_never_read() -> None:
    t, h = np.linspace(0, 1, 15), np.linspace(0, 1, 11)
    values = np.sin(2 * t)[:, None] * np.cos(h)[None, :]
    values[3, 4] = np.nan
    fields = fit(t, h, {"a": values})
    hole = np.array([[t[3] + 0.01], [h[4] - 0.01]])
    assert fields.in_hole(hole).all()
    away = np.array([[0.8], [0.8]])
    assert not fields.in_hole(away).any()
    assert fields("a", away)[0] == pytest.approx(np.sin(1.6) * np.cos(0.8), abs=1e-6)
    values[:, :6] = np.nan
    with pytest.raises(InputError, match="too few"):
        fit(t, h, {"a": values})


def test_harmonics_of_a_known_cycle() -> None:
    phase = 2 * np.pi * np.arange(32) / 32
    cycle = 3.0 + 8.3 * np.cos(phase + 0.4) + 3.7 * np.cos(2 * phase) + 2.0 * np.sin(3 * phase)
    amplitudes = harmonics(cycle)
    np.testing.assert_allclose(amplitudes, [8.3, 3.7, 2.0], rtol=1e-12)
    assert rms(amplitudes) == pytest.approx(9.3, abs=0.05)  # as the dissertation's Table 4.2 adds them up
    assert peak_to_peak(np.array([1.0, 4.0, 2.0])) == 3.0


def test_contact_line_ends_lie_at_the_chosen_separation(nasa: tuple[GearPair, PairGeometry]) -> None:
    pair, geometry = nasa
    fields = contact_splines(geometry.flanks, geometry.ease_off)
    result = unloaded_contact(geometry, fields, lines_in_mesh(fields, pair.assembly.pinion_pitch, 12), separation=6.0)
    middle = result.sel(pair=0)
    ends = np.stack([middle["line_lengthwise"].values, middle["line_profile"].values])
    closest = closest_approach(fields, ends)
    excess = 1e3 * closest.lever_arm * (closest.separation_angle - 1e-6 * middle["transmission_error"].values[:, None])
    edge = np.minimum(boundary_distance(fields, ends), np.min(np.minimum(ends, 1 - ends), axis=0)) < 1e-3
    assert np.all((np.abs(excess - 6.0) < 0.01) | edge)
    assert np.all(excess < 6.01)


def test_mesh_positions_divide_one_pitch_about_the_middle_of_the_flank() -> None:
    assert mesh_rotations(0.5, 4).tolist() == [-0.25, -0.125, 0.0, 0.125]


def test_traced_lines_end_on_a_boundary_and_lie_on_their_level(nasa: tuple[GearPair, PairGeometry]) -> None:
    """To rounding: the search for the ends converges, and points that no border holds back are moved until they do."""
    pair, geometry = nasa
    fields = contact_splines(geometry.flanks, geometry.ease_off)
    mesh = lines_in_mesh(fields, pair.assembly.pinion_pitch, 12)
    points, levels = mesh.lines.points, mesh.rotations[mesh.position] - mesh.pair * mesh.pinion_pitch
    border = np.min(np.minimum(points, 1.0 - points), axis=0)
    ends = points[:, :, [0, -1]]
    assert np.abs(np.minimum(boundary_distance(fields, ends), border[:, [0, -1]])).max() < 1e-9
    off = np.abs(fields("roll_angle", points) - levels[:, None])
    assert off[border > 0.0].max() < 1e-14


def envelopes(geometry: PairGeometry, positions: int) -> tuple[xr.Dataset, np.ndarray]:
    """Unloaded contact, and the envelope by direct search of the smallest gap over both bounded flanks [urad]."""
    cycle = MeshCycle.of(geometry, mesh_positions=positions)
    found, _ = smallest_envelope(geometry, cycle.lines.rotations)
    return cycle.unloaded(), 1e6 * (found.closing_angle - geometry.ease_off.attrs["first_contact_rad"])


def assembled(name: str, flank: FlankName, offset: float, pinion: float, gear: float, angle: float) -> PairGeometry:
    """A shipped pair with E, P, G [mm] and Sigma [deg], on the default grid."""
    pair = gear_pair(read_case(name), flank)
    return pair_geometry(pair.misaligned(Misalignment(offset, pinion, gear, math.radians(angle))))


@pytest.mark.parametrize(("flank", "published"), [("drive", 464.6), ("coast", 566.5)])
def test_envelope_where_an_edge_of_the_pinion_holds_the_gear(flank: FlankName, published: float) -> None:
    """Peak to peak at 16 positions as a separate search of the smallest gap over bounded flanks found it."""
    cycle = MeshCycle.of(shipped("nasa-12x36", flank), mesh_positions=16)
    own = cycle.unloaded()
    assert np.ptp(own["transmission_error_envelope"].values) == pytest.approx(published, abs=0.05)
    carries = own["carrying_pair"].astype(int)
    edges = own["contact_edge"].sel(pair=carries).values
    assert set(edges.tolist()) == {0, list(CONTACT_EDGES.values()).index("pinion_tip") - 1}


def test_error_at_an_edge_is_that_of_a_direct_search() -> None:
    """One position, for the quick tests."""
    cycle = MeshCycle.of(shipped("nasa-12x36", "coast"), mesh_positions=16).at(13)
    own, geometry = cycle.unloaded(), cycle.geometry
    pair = int(own["carrying_pair"].item())
    found = smallest_gap(geometry, cycle.lines.rotations - pair * cycle.pinion_pitch)
    assert found.edge.tolist() == ["pinion tip"]
    wanted = 1e6 * (found.closing_angle[0] - geometry.ease_off.attrs["first_contact_rad"])
    assert own["transmission_error"].sel(pair=pair).item() == pytest.approx(wanted, abs=1e-3)


def test_direct_search_finds_nothing_where_no_flank_faces_the_other(nasa: tuple[GearPair, PairGeometry]) -> None:
    assert np.isnan(smallest_gap(nasa[1], np.array([3.0])).closing_angle).all()


@pytest.mark.thorough
@pytest.mark.parametrize("assembly", [(0, 0, 0, 0), (0.1, -0.1, 0.05, 0.05), (-0.3, 0.2, 0.1, 0.1)])
@pytest.mark.parametrize("flank", ["drive", "coast"])
@pytest.mark.parametrize("name", ["nasa-12x36", "fm-11x41", "fh-12x41-45", "fh-design-a", "fh-design-b"])
def test_envelope_is_that_of_a_direct_search(
    name: str, flank: FlankName, assembly: tuple[float, float, float, float]
) -> None:
    """Within 1e-3 urad at any position, edges of either member included."""
    own, wanted = envelopes(assembled(name, flank, *assembly), 4)
    np.testing.assert_allclose(own["transmission_error_envelope"].values, wanted, rtol=0, atol=1e-3)


@pytest.mark.thorough
def test_fine_envelope_is_that_of_a_direct_search() -> None:
    """With the kinks where the contact moves onto an edge and where the next pair takes over."""
    geometry = assembled("fm-11x41", "drive", 0.1, -0.1, 0.05, 0.05)
    cycle = MeshCycle.of(geometry, mesh_positions=3)
    fine = 1e6 * PairErrors.of(TurnedFlanks(geometry), cycle.lines).fine_envelope()
    rotations = cycle.lines.rotations[0] + np.arange(fine.size) / fine.size * cycle.pinion_pitch
    found, _ = smallest_envelope(geometry, rotations)
    assert {"", "gear toe", "pinion toe"} <= set(found.edge.tolist())
    wanted = 1e6 * (found.closing_angle - geometry.ease_off.attrs["first_contact_rad"])
    np.testing.assert_allclose(fine, wanted, rtol=0, atol=1e-3)
    assert peak_to_peak(fine) == pytest.approx(np.ptp(wanted), abs=1e-3)
    # The greatest error, at a kink, lies between these rotations.
    assert 0.5 < cycle.unloaded().attrs["peak_to_peak"] - np.ptp(wanted) < 1.5


@pytest.mark.thorough
def test_envelope_of_a_relieved_pinion_is_that_of_a_direct_search() -> None:
    """Its flank has two parts, each with a surface of its own."""
    pair = gear_pair(read_case("fh-design-a"))
    blade = replace(pair.pinion.loaded.blade, toprem=Relief(1.5, math.radians(1.0)))
    loaded = replace(pair.pinion.loaded, blade=blade)
    geometry = pair_geometry(replace(pair, pinion=replace(pair.pinion, loaded=loaded)))
    assert set(geometry.exact.part.tolist()) == {0, 1}
    own, wanted = envelopes(geometry, 3)
    np.testing.assert_allclose(own["transmission_error_envelope"].values, wanted, rtol=0, atol=1e-3)


def continuous_peak_to_peak(geometry: PairGeometry, samples: int) -> float:
    """Of the direct search, from where it finds two pairs to touch at once, or one least or most, between samples."""
    pitch = geometry.pair.assembly.pinion_pitch
    rotations = np.arange(-1, samples + 2) * pitch / samples
    found, carrying = smallest_envelope(geometry, rotations)

    def of_pair(rotation: float, pair: int) -> float:
        return float(smallest_gap(geometry, np.array([rotation - pair * pitch])).closing_angle[0])

    def highest(sign: float, start: int) -> float:
        first, second = carrying[start : start + 2].tolist()
        begin, end = rotations[start : start + 2].tolist()
        if first == second:
            most = minimize_scalar(lambda r: -sign * of_pair(r, first), bounds=(begin, end), options={"maxiter": 12})
            return float(-most.fun)
        place = brentq(lambda r: of_pair(r, first) - of_pair(r, second), begin, end, xtol=1e-7)
        return sign * of_pair(float(place), first)

    extremes = []
    for sign in (1.0, -1.0):
        best = 1 + int(np.argmax(sign * found.closing_angle[1:-1]))
        extremes.append(max(highest(sign, best - 1), highest(sign, best)))
    return 1e6 * sum(extremes)


@pytest.mark.thorough
@pytest.mark.parametrize("flank", ["drive", "coast"])
@pytest.mark.parametrize("name", ["nasa-12x36", "fm-11x41"])
def test_peak_to_peak_is_that_between_samples_too(name: str, flank: FlankName) -> None:
    """The greatest error is at the kink where the next pair takes over, whatever the number of mesh positions."""
    geometry = shipped(name, flank)
    wanted = continuous_peak_to_peak(geometry, 16)
    for positions in (5, 32):
        own = MeshCycle.of(geometry, mesh_positions=positions).unloaded().attrs["peak_to_peak"]
        assert own == pytest.approx(wanted, abs=0.02)


ONE_DEGREE = math.radians(1.0)


@pytest.mark.thorough
@pytest.mark.parametrize("flank", ["drive", "coast"])
@pytest.mark.parametrize(
    ("member", "reliefs"),
    [
        ("pinion", {"toprem": Relief(0.3, ONE_DEGREE)}),
        ("pinion", {"flankrem": Relief(0.75, ONE_DEGREE)}),
        ("gear", {"toprem": Relief(0.3, ONE_DEGREE)}),
        ("gear", {"toprem": Relief(0.3, ONE_DEGREE), "flankrem": Relief(0.7, ONE_DEGREE)}),
        ("gear", {"toprem": Relief(0.3, 0.0, 30.0), "flankrem": Relief(0.6, 0.0, 50.0)}),
    ],
)
def test_envelope_of_relieved_flanks_is_that_of_a_direct_search(
    member: Literal["pinion", "gear"], reliefs: dict[str, Relief], flank: FlankName
) -> None:
    """Every part has a surface of its own; at a kink the deeper cut counts, and contact may run along it."""
    geometry = relieved(gear_pair(read_case("nasa-12x36"), flank), member, **reliefs)
    parts = geometry.exact.part if member == "pinion" else geometry.members.gear.part
    assert set(parts.tolist()) == set(range(len(reliefs) + 1))
    own, wanted = envelopes(geometry, 4)
    np.testing.assert_allclose(own["transmission_error_envelope"].values, wanted, rtol=0, atol=0.02)


@pytest.mark.parametrize(
    ("member", "name", "height", "angle"), [("gear", "toprem", 0.3, 1.0), ("pinion", "flankrem", 0.75, 1.0)]
)
def test_contact_along_a_kink_is_that_of_a_direct_search(
    member: Literal["pinion", "gear"], name: str, height: float, angle: float
) -> None:
    """One position at which the smallest gap lies where two parts cut equally deep."""
    pair = gear_pair(read_case("nasa-12x36"))
    geometry = relieved(pair, member, **{name: Relief(height, math.radians(angle))})
    cycle = MeshCycle.of(geometry, mesh_positions=6).at(5)
    own = cycle.unloaded()
    carrying = int(own["carrying_pair"].item())
    found = smallest_gap(geometry, cycle.lines.rotations - carrying * cycle.pinion_pitch)
    wanted = 1e6 * (found.closing_angle[0] - geometry.ease_off.attrs["first_contact_rad"])
    assert found.edge.tolist() == [""]
    assert own["transmission_error_envelope"].item() == pytest.approx(wanted, abs=0.02)


def test_range_of_a_cycle_with_a_kink() -> None:
    """The least of two sine waves, from a few samples."""

    def cycle(x: np.ndarray) -> np.ndarray:
        return np.minimum(np.sin(2 * np.pi * (x - 0.011)), 0.7 * np.cos(2 * np.pi * (x + 0.007)))

    fine = cycle(np.arange(1_000_000) / 1_000_000)
    assert continuous_range(cycle(np.arange(24) / 24), cycle, 1e-6) == pytest.approx(np.ptp(fine), abs=3e-6)
    assert abs(np.ptp(cycle(np.arange(24) / 24)) - np.ptp(fine)) > 0.01


def test_point_of_contact_lies_on_its_edge() -> None:
    """On an edge of the gear exactly, and that is said; every pair with a contact line has a point."""
    own = MeshCycle.of(assembled("fm-11x41", "drive", 0.1, -0.1, 0.05, 0.05), mesh_positions=16).unloaded()
    edge, t = own["contact_edge"].values, own["path_lengthwise"].values
    assert own["contact_edge"].attrs["flag_meanings"].split() == list(CONTACT_EDGES.values())
    toe = edge == 1
    assert np.count_nonzero(toe) > 3
    np.testing.assert_allclose(t[toe], 0.0, atol=1e-6)
    inside = edge == 0
    assert np.all((t[inside] > 0.0) & (t[inside] < 1.0))
    assert np.array_equal(edge == -1, np.isnan(own["transmission_error"].values))
    assert not np.any((edge == -1) & np.isfinite(own["line_length"].values))


@pytest.mark.parametrize("flank", ["drive", "coast"])
def test_gap_on_an_edge_is_that_of_the_edge_itself(flank: FlankName) -> None:
    """Further steps along the curved edges of the pinion leave it as it is, but for rounding."""
    geometry = shipped("nasa-12x36", flank)
    errors = PairErrors.of(TurnedFlanks(geometry), MeshCycle.of(geometry, mesh_positions=8).lines)
    ahead = np.arange(128) / 128
    carrying, found = errors.carrying_at(ahead)
    rotations, on_pinion = errors.rotations_at(ahead, carrying), found.bound >= BOUNDS.index("pinion_toe")
    assert on_pinion.sum() > 60
    points, parameters = found.points, found.parameters
    for _ in range(4):
        here = errors.flanks.at(points, rotations, parameters, found.part)
        step, promised = touching_points._bounded_step(here, np.full(128, touching_points.DAMPING_MINIMUM))
        points, parameters = points + step, here.parameters + np.einsum("kin,in->kn", here.following, step)
    assert np.max(np.abs(here.gap + promised - found.gap)) < 2e-15
    # The points lie on their edges to rounding as well.
    at = errors.flanks.at(found.points, rotations, found.parameters, found.part)
    assert np.max(np.abs(np.min(at.margins, axis=0)[on_pinion])) < 1e-13


def test_derivatives_of_the_gap_are_those_of_differences(nasa: tuple[GearPair, PairGeometry]) -> None:
    """By both fractions: slope, bend, margins; the rotation closes the gap as the expansion says near conjugacy."""
    _, geometry = nasa
    flanks, exact = TurnedFlanks(geometry), geometry.exact
    t, h = np.meshgrid(geometry.members.lengthwise, geometry.members.profile, indexing="ij")
    chosen = np.flatnonzero(exact.inside & (np.abs(t.ravel() - 0.5) < 0.4) & (np.abs(h.ravel() - 0.5) < 0.4))[::7]
    points, part = np.stack([t.ravel(), h.ravel()])[:, chosen], exact.part[chosen]

    def converged(points: np.ndarray, left: float) -> TurnedGap:
        found = flanks.at(points, exact.roll_angle[chosen] + left, exact.pinion_parameters[:, chosen], part)
        for _ in range(4):
            found = flanks.at(points, exact.roll_angle[chosen] + left, found.parameters, part)
        assert found.miss.max() < 1e-9
        return found

    here = converged(points, 0.05)
    for k, step in enumerate(1e-4 * np.eye(2)[..., None]):
        ahead, behind = converged(points + step, 0.05), converged(points - step, 0.05)
        np.testing.assert_allclose((ahead.gap - behind.gap) / 2e-4, here.slope[k], atol=1e-8)
        np.testing.assert_allclose((ahead.slope - behind.slope) / 2e-4, here.bend[:, k], atol=1e-6)
        margins = (ahead.margins[:PARTS] - behind.margins[:PARTS]) / 2e-4
        np.testing.assert_allclose(margins, here.margin_slopes[:PARTS, k], atol=1e-6)
    left = 0.003
    expanded = exact.angle + exact.separation_curvature * left**2 / 2 + exact.separation_skew * left**3 / 6
    zero = geometry.ease_off.attrs["first_contact_rad"]
    np.testing.assert_allclose(converged(points, left).gap, expanded[chosen] - zero, rtol=0, atol=1e-10)


def test_an_ease_off_put_in_by_hand_moves_the_gap_alone(nasa: tuple[GearPair, PairGeometry]) -> None:
    """A constant is a later contact by just that; a deviation as a surface and as an update agree to first order."""
    _, geometry = nasa
    own = MeshCycle.of(geometry, mesh_positions=8)
    moved = own.with_ease_off(geometry.ease_off.assign(ease_off_angle=geometry.ease_off["ease_off_angle"] + 3e-5))
    difference = moved.unloaded()["transmission_error"] - own.unloaded()["transmission_error"]
    np.testing.assert_allclose(difference.values[np.isfinite(difference.values)], 30.0, rtol=0, atol=1e-5)


@pytest.mark.parametrize("member", ["pinion", "gear"])
def test_an_updated_ease_off_gives_the_error_of_the_deviated_flanks(member: str) -> None:
    """At edges as well: of a deviation of microns, the update is off by a few percent of a microradian."""
    pair = gear_pair(read_case("nasa-12x36"))
    geometry = pair_geometry(pair, (17, 11))
    section = getattr(pair, member).section
    known = {member: deviation_from_formula(section, GlobalErrors(lengthwise_crowning=2.0, spiral_angle=2.0))}
    cycle = MeshCycle.of(geometry, mesh_positions=4)
    updated = cycle.with_ease_off(deviated_ease_off(geometry, **known)).unloaded()["transmission_error_envelope"].values
    surfaces = MeshCycle.of(pair_geometry(deviated_pair(pair, **known), (17, 11)), mesh_positions=4).unloaded()
    exact = surfaces["transmission_error_envelope"].values
    before = cycle.unloaded()["transmission_error_envelope"].values
    assert np.ptp(exact - before) > 5.0
    # Both count from their own zero, the least node of the ease-off.
    difference = (updated - exact) - np.mean(updated - exact)
    assert np.abs(difference).max() < 0.3


def test_the_piece_of_a_line_that_comes_closest_has_its_ends_listed(nasa: tuple[GearPair, PairGeometry]) -> None:
    """A level set in two pieces, in either order."""
    _, geometry = nasa
    cycle = MeshCycle.of(geometry, mesh_positions=1)
    mesh = cycle.lines
    row = int(np.flatnonzero(mesh.pair == 0)[0])
    points, middle = mesh.lines.points[:, row], POINTS_PER_LINE // 2
    along = np.linspace(0, middle, POINTS_PER_LINE)
    halves = [
        np.stack([np.interp(start + along, np.arange(POINTS_PER_LINE), p) for p in points]) for start in (0, middle)
    ]
    length = np.full(2, 0.5 * mesh.lines.length[row])
    whole = cycle.unloaded().sel(pair=0)
    for pieces in (halves, halves[::-1]):
        lines = ContactLines(np.zeros(2, dtype=np.int64), np.stack(pieces, axis=1), length)
        cut = replace(mesh, lines=lines, position=np.zeros(2, dtype=np.int64), pair=np.zeros(2, dtype=np.int64))
        own = unloaded_contact(geometry, cycle.fields, cut).sel(pair=0)
        assert own["transmission_error"].item() == pytest.approx(whole["transmission_error"].item(), abs=1e-9)
        ends = own["line_lengthwise"].values[0]
        closest = [float(np.min(closest_approach(cycle.fields, p[:, None]).separation_angle)) for p in pieces]
        near = pieces[int(np.argmin(closest))][0]
        assert ends.min() >= near.min() - 1e-9
        assert ends.max() <= near.max() + 1e-9


def test_unloaded_contact_does_not_depend_on_the_size_of_blocks(monkeypatch: pytest.MonkeyPatch) -> None:
    """Points are computed in blocks; each has a rotation of its own, in whatever block it comes."""
    geometry = pair_geometry(gear_pair(read_case("nasa-12x36")), (9, 7))

    def unloaded() -> xr.Dataset:
        return MeshCycle.of(geometry, mesh_positions=6, segments_per_line=5).unloaded()

    whole = unloaded()
    for module in (newton, turned_flanks):
        monkeypatch.setattr(module, "COLUMNS_PER_BLOCK", 7)
    xr.testing.assert_allclose(unloaded(), whole, rtol=1e-9, atol=1e-9)


def test_starts_do_not_depend_on_the_size_of_blocks(monkeypatch: pytest.MonkeyPatch) -> None:
    geometry = pair_geometry(gear_pair(read_case("nasa-12x36")), (15, 9))
    rotations = np.linspace(-1.0, 1.0, 23)
    row, node = touching_points.lowest_nodes(geometry, rotations)
    assert np.all(np.diff(row) >= 0)
    assert np.unique(row).size > 5
    for nodes in (1, 500):
        monkeypatch.setattr(touching_points, "NODES_PER_BLOCK", nodes)
        for found, wanted in zip(touching_points.lowest_nodes(geometry, rotations), (row, node), strict=True):
            np.testing.assert_array_equal(found, wanted)


@pytest.mark.parametrize("name", ["nasa-12x36", "fh-12x41-45"])
def test_parameters_alone_are_those_of_the_circles_met(name: str) -> None:
    exact = pair_geometry(gear_pair(read_case(name)), (9, 7)).exact
    known = np.flatnonzero(np.isfinite(exact.pinion_parameters[0]))
    parameters = exact.pinion_parameters[:, known] + 1e-3
    rotations = np.full(known.size, 0.02)
    motion = exact.motion
    place = np.array([[60.0], [90.0]]) + np.linspace(0.0, 5.0, known.size)
    met = turned_flanks.circles_met(exact, motion.surface, parameters, rotations, place)
    found = turned_flanks.nearer_parameters(motion, motion.surface, parameters, rotations, place)
    np.testing.assert_allclose(found, met.parameters, rtol=1e-11, atol=1e-11)


def test_a_pair_that_nowhere_comes_near_contact_is_refused() -> None:
    case = read_case("nasa-12x36")
    assert case.pinion.concave is not None
    cutter = case.pinion.concave.cutter.model_copy(update={"blade_pressure_angle": -44.9})
    concave = case.pinion.concave.model_copy(update={"cutter": cutter})
    case = case.model_copy(update={"pinion": case.pinion.model_copy(update={"concave": concave})})
    with pytest.raises(GeometryError, match=r"no tooth pair comes within 0\.02 rad of contact at any rotation"):
        MeshCycle.of(pair_geometry(gear_pair(case), (9, 7)), mesh_positions=3).unloaded()
