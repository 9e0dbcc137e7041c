"""Pictures: what is drawn follows from the result, and every file is written whole or not at all."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import xarray as xr
from matplotlib.figure import Figure
from matplotlib.image import imread
from matplotlib.path import Path as Outline
from matplotlib.tri import LinearTriInterpolator, Triangulation
from numpy.typing import NDArray
from pages import drawn_pages, drawn_result
from runs import read_only, small
from scipy.interpolate import RegularGridInterpolator

from easeoff import InputError, analyze
from easeoff.contact import Status
from easeoff.contact.evaluation.pressure_map import Line, loaded_parts, pressure_map, surface
from easeoff.contact.evaluation.tooth_passage import envelope, pairs_in_view, tooth_passage, two_cycles, unloaded_curves
from easeoff.contact.lines.contact_lines import boundary_distance
from easeoff.friction import Operation, friction
from easeoff.geometry import Misalignment
from easeoff.study import CaseInMesh
from easeoff.study.plot import write_pictures, written_pictures
from easeoff.study.plot.contact_pattern_chart import bent_lines, unloaded_pattern
from easeoff.study.plot.contours import (
    drop_short,
    label_points,
    outlined,
    points_per_unit,
    triangulated,
    without_border,
    without_steep,
)
from easeoff.study.plot.friction_charts import (
    GRID,
    efficiency,
    loaded_map,
    roughness_name,
    velocity_maps,
)
from easeoff.study.plot.mesh_cycle_charts import (
    transmission_error,
)
from easeoff.study.plot.page import even_lines, small_print
from easeoff.study.plot.panel_grid import evenly_chosen
from easeoff.study.plot.tooth_view import ToothView, tick_step, tooth_view
from easeoff.study.plot.topography_chart import contour_levels, ease_off_map
from easeoff.study.plot.written_pictures import PICTURES
from easeoff.study.summary.curves import mean_pairs_in_contact, share_passage, torque_name

Array = NDArray[Any]


@pytest.fixture(scope="module")
def trees() -> dict[str, xr.DataTree]:
    case = small(compliance="shell", mesh_positions=8, segments_per_line=15, lengthwise_nodes=21, profile_nodes=15)
    return {flank: read_only(analyze(case, flank=flank, torques=[50.0, 300.0])) for flank in ("drive", "coast")}


@pytest.fixture(scope="module", params=["drive", "coast"])
def tree(request: pytest.FixtureRequest, trees: dict[str, xr.DataTree]) -> xr.DataTree:
    return trees[request.param]


@pytest.fixture(scope="module")
def drive(trees: dict[str, xr.DataTree]) -> xr.DataTree:
    return trees["drive"]


@pytest.fixture(scope="module")
def view(tree: xr.DataTree) -> ToothView:
    return tooth_view(tree)


def changed(tree: xr.DataTree, group: str, change: Callable[[xr.Dataset], xr.Dataset]) -> xr.DataTree:
    """A copy of a tree with another dataset in one group."""
    groups = dict(tree.to_dict())
    groups[f"/{group}"] = change(tree[group].to_dataset())
    return xr.DataTree.from_dict(groups)


def without(dataset: xr.Dataset, positions: list[int], torque: int | None = None) -> xr.Dataset:
    """The loaded group as if mesh positions had no certified solution."""
    result = dataset.copy(deep=True)
    for variable in result.data_vars.values():
        dims = [d for d in ("torque", "mesh_position") if d in variable.dims]
        if dims != ["torque", "mesh_position"]:
            continue
        at = {"mesh_position": positions} | ({} if torque is None else {"torque": torque})
        variable[at] = Status.NOT_CERTIFIED if variable.dtype.kind == "i" else np.nan
    return result


# --- friction


@pytest.fixture(scope="module")
def lubricated(drive: xr.DataTree) -> xr.DataTree:
    operation = Operation([500.0, 1500.0, 3000.0], [60.0, 90.0], [0.3, 0.8])
    with_friction = xr.DataTree.from_dict({**drive.to_dict(), "/friction": friction(drive, operation)})
    with_friction.attrs = drive.attrs
    return with_friction


def test_every_picture_is_written_and_shows_something(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Those of friction, too."""
    monkeypatch.setattr(written_pictures, "draw_picture", lambda _, name, **__: drawn_pages()[name])
    folder = tmp_path / "new" / "pictures"
    written = write_pictures(drawn_result(), folder)
    names = [*PICTURES, "friction_maps", "efficiency"]
    assert [path.name for path in written] == [f"nasa-12x36-drive-{name}.png" for name in names]
    assert sorted(folder.iterdir()) == sorted(written)  # nothing temporary is left
    for path in written:
        assert_shows_something(path)


def assert_shows_something(path: Path) -> None:
    """A picture has many colours, and nothing runs off the page."""
    pixels = imread(path)[..., :3]
    assert min(pixels.shape[:2]) > 500
    colours = (255.0 * pixels[::4, ::4]).round().astype(np.int64) @ np.array([65536, 256, 1])
    assert np.unique(colours).size > 50
    assert np.all(pixels[[0, -1]] == 1.0)
    assert np.all(pixels[:, [0, -1]] == 1.0)


@pytest.mark.parametrize("missing", [[1, 2, 6], list(range(8))])
@pytest.mark.thorough
def test_friction_of_uncertified_positions_leaves_gaps(
    lubricated: xr.DataTree, tmp_path: Path, missing: list[int]
) -> None:
    gaps = changed(lubricated, "loaded", lambda ds: without(ds, missing))
    one = Operation(1500.0)
    gaps = changed(gaps, "friction", lambda _: friction(gaps, one))
    assert len(write_pictures(gaps, tmp_path)) == len(PICTURES) + 2


@pytest.mark.thorough
def test_friction_without_fields_can_be_drawn(lubricated: xr.DataTree, tmp_path: Path) -> None:
    lean = changed(lubricated, "friction", lambda _: friction(lubricated, Operation(1500.0), segment_fields=False))
    assert len(write_pictures(lean, tmp_path)) == len(PICTURES) + 2


def test_velocity_maps_are_the_velocities_of_the_segments(lubricated: xr.DataTree) -> None:
    """The map over the flank, interpolated at the segments' places."""
    maps = velocity_maps(lubricated, tooth_view(lubricated), 1500.0)
    loaded = lubricated["loaded"].to_dataset().isel(torque=0)
    found = lubricated["friction"].to_dataset().sel(speed=1500.0)
    places = np.stack([loaded[name].values for name in ("lengthwise", "profile")], axis=-1)
    inner = np.all((places > 0.1) & (places < 0.9), axis=-1)
    axes = [np.linspace(0.0, 1.0, n) for n in GRID]
    for name in ("rolling_velocity", "sliding_velocity", "slide_to_roll"):
        interpolated = RegularGridInterpolator(axes, maps[name].values.reshape(GRID))(places[inner])
        expected = found[name].transpose("mesh_position", "segment").values[inner]
        away = expected > 0.05  # at zero the ratio has a kink
        np.testing.assert_allclose(interpolated[away], expected[away], atol=2e-3 * np.nanmax(expected))


def test_loaded_map_leaves_edges_out(lubricated: xr.DataTree) -> None:
    """They have no pressure; they stand where lines end, and slide over other places."""
    loaded = lubricated["loaded"].to_dataset().isel(torque=0)
    field = loaded["equivalent_radius"]
    edge = loaded.assign(pressure=loaded["pressure"].where(loaded["profile"] < 0.5))
    assert 0 < loaded_map(edge, field).values.size < loaded_map(loaded, field).values.size
    assert loaded_map(edge, field).points[1].max() < 0.5


def test_loaded_map_holds_every_loaded_segment_of_the_lines(lubricated: xr.DataTree) -> None:
    loaded = lubricated["loaded"].to_dataset().isel(torque=0)
    field = lubricated["friction"].to_dataset()["lambda_ratio"].isel(torque=0, speed=1, temperature=1, roughness=1)
    found = loaded_map(loaded, field)
    assert found.values.size == int(((loaded["force"] > 0.0) & loaded["overhang"].isnull()).sum())
    assert found.values.max() == float(field.where(loaded["overhang"].isnull()).max())


# --- the files


@pytest.mark.thorough
def test_every_picture_of_the_other_flank_shows_something(trees: dict[str, xr.DataTree], tmp_path: Path) -> None:
    written = write_pictures(trees["coast"], tmp_path)
    assert [path.name for path in written] == [f"nasa-12x36-coast-{name}.png" for name in PICTURES]
    for path in written:
        assert_shows_something(path)


@pytest.mark.parametrize("missing", [[1, 2, 6], list(range(8))])
@pytest.mark.thorough
def test_uncertified_positions_leave_gaps(drive: xr.DataTree, tmp_path: Path, missing: list[int]) -> None:
    assert len(write_pictures(changed(drive, "loaded", lambda ds: without(ds, missing)), tmp_path)) == len(PICTURES)


@pytest.mark.thorough
def test_missing_values_of_the_unloaded_contact_leave_gaps(drive: xr.DataTree, tmp_path: Path) -> None:
    def hole(dataset: xr.Dataset) -> xr.Dataset:
        return dataset.where(~dataset["mesh_position"].isin(dataset["mesh_position"][2:4])).assign(
            carrying_pair=dataset["carrying_pair"], fine_envelope=dataset["fine_envelope"]
        )

    assert len(write_pictures(changed(drive, "unloaded", hole), tmp_path)) == len(PICTURES)
    nothing = changed(drive, "unloaded", lambda ds: (ds * np.nan).assign(carrying_pair=ds["carrying_pair"]))
    assert len(write_pictures(nothing, tmp_path)) == len(PICTURES)


@pytest.mark.thorough
def test_a_hundred_torques_can_be_drawn(drive: xr.DataTree, tmp_path: Path) -> None:
    many = changed(drive, "loaded", lambda ds: ds.isel(torque=[1] * 100))
    assert len(write_pictures(many, tmp_path)) == len(PICTURES)


def test_one_torque_at_one_mesh_position_can_be_drawn(drive: xr.DataTree, tmp_path: Path) -> None:
    few = changed(drive, "unloaded", lambda ds: ds.isel(mesh_position=[5]))
    few = changed(few, "loaded", lambda ds: ds.isel(mesh_position=[5], torque=[0]))
    few.attrs = {**drive.attrs, "title": r"plain text: $\frac{1}{ 5 $ of a_pair" + 200 * " long"}
    assert len(write_pictures(few, tmp_path, dpi=30)) == len(PICTURES)


def test_a_folder_that_cannot_be_made_is_the_users_mistake(drive: xr.DataTree, tmp_path: Path) -> None:
    (tmp_path / "file").write_text("")
    with pytest.raises(InputError, match="cannot be written"):
        write_pictures(drive, tmp_path / "file")
    assert list(tmp_path.iterdir()) == [tmp_path / "file"]


def test_a_picture_that_cannot_replace_another_leaves_nothing_behind(drive: xr.DataTree, tmp_path: Path) -> None:
    there = tmp_path / "nasa-12x36-drive-ease_off.png"
    there.mkdir()
    with pytest.raises(InputError, match=r"ease_off\.png is a folder"):
        write_pictures(drive, tmp_path)
    assert list(tmp_path.iterdir()) == [there]


# --- the flank


def test_flank_is_drawn_true_to_scale(tree: xr.DataTree, view: ToothView) -> None:
    """Distances between nodes are those in the gear's axial plane, toe left and tip up."""
    flanks = tree["flanks"].to_dataset()
    position = flanks["position"].sel(member="gear").values
    section = np.stack([position[..., 2], np.hypot(position[..., 0], position[..., 1])])
    grid = np.stack(np.meshgrid(flanks["lengthwise"], flanks["profile"], indexing="ij"))
    drawn = view.in_plane(grid)
    for axis in (1, 2):
        np.testing.assert_allclose(
            np.linalg.norm(np.diff(drawn, axis=axis), axis=0),
            np.linalg.norm(np.diff(section, axis=axis), axis=0),
            rtol=1e-9,
        )
    assert np.all(np.diff(drawn[0], axis=0) > 0.0)
    assert np.all(np.diff(drawn[1], axis=1) > 0.0)


def test_missing_nodes_do_not_move_the_flank(tree: xr.DataTree, view: ToothView) -> None:
    holes = changed(tree, "flanks", lambda ds: ds.where(ds["profile"] > 0.12))
    np.testing.assert_allclose(tooth_view(holes).plane.coefficients, view.plane.coefficients, atol=1e-9)


def test_common_flank_holds_the_usable_nodes_and_no_others(tree: xr.DataTree, view: ToothView) -> None:
    ease_off = tree["ease_off"].to_dataset()
    grid = np.stack(np.meshgrid(ease_off["lengthwise"], ease_off["profile"], indexing="ij"))
    distance = boundary_distance(view.fields, grid)
    clear = np.abs(distance) > 0.02  # farther from the boundary than the fine grid resolves
    enclosed = view.outline(view.common).contains_points(view.in_plane(grid).reshape(2, -1).T, radius=1e-6)
    np.testing.assert_array_equal(enclosed.reshape(distance.shape)[clear], distance[clear] > 0.0)


def test_ease_off_of_the_picture_is_that_of_the_result(tree: xr.DataTree, view: ToothView) -> None:
    ease_off = tree["ease_off"].to_dataset()
    grid, gap, inside = ease_off_map(view)
    at_nodes = xr.DataArray(
        gap, coords={"lengthwise": grid[0][:, 0], "profile": grid[1][0]}, dims=("lengthwise", "profile")
    )
    again = at_nodes.interp(lengthwise=ease_off["lengthwise"], profile=ease_off["profile"])
    usable = ease_off["inside"] == 1
    np.testing.assert_allclose(again.values[usable], ease_off["ease_off"].values[usable], atol=0.02)
    assert 0.5 < np.mean(inside) <= 1.0


@pytest.mark.parametrize("gap", [np.zeros(5), np.linspace(-0.3, 156.0, 50), np.linspace(0.0, 0.02, 50), np.zeros(0)])
def test_contour_levels_cover_the_ease_off_in_even_round_steps(gap: Array) -> None:
    levels = contour_levels(gap)
    assert 2 <= levels.size <= 20
    np.testing.assert_allclose(np.diff(levels), levels[1] - levels[0])
    if gap.size:
        assert levels[0] <= gap.min()
        assert levels[-1] >= gap.max()


# --- the mesh cycle


def test_passage_joins_the_pairs_without_a_break() -> None:
    """A parabola of the pinion's rotation, cut into cycles, comes back as one parabola."""
    per_cycle, pairs = 8, np.array([-1, 0, 1])
    rotation = np.arange(per_cycle)[None, :] - per_cycle * pairs[:, None]
    course = tooth_passage(pairs, 0.1 * (rotation - 4.0) ** 2)
    np.testing.assert_allclose(course.values, 0.1 * (course.steps - 4.0) ** 2)
    times = np.linspace(0.0, 2.0, 2 * per_cycle + 1)
    lowest = envelope(course, times)
    expected = np.min([0.1 * (times * per_cycle - per_cycle * k - 4.0) ** 2 for k in range(-1, 4)], axis=0)
    np.testing.assert_allclose(lowest, expected)
    assert pairs_in_view(course, 2.0) == range(-1, 4)


def test_values_beside_missing_ones_are_kept_and_nothing_is_made_up() -> None:
    course = tooth_passage(np.array([0]), np.array([[1.0, np.nan, 3.0, 4.0]]))
    np.testing.assert_array_equal(course.at(np.array([-1.0, 0.0, 0.5, 1.0, 2.0, 2.5, 3.0, 3.5])), [
        np.nan, 1.0, np.nan, np.nan, 3.0, 3.5, 4.0, np.nan,
    ])  # fmt: skip


def test_two_cycles_are_continuous() -> None:
    times, values = two_cycles(np.array([3.0, 1.0, 2.0]))
    np.testing.assert_allclose(times, np.arange(7) / 3.0)
    np.testing.assert_array_equal(values, [3.0, 1.0, 2.0, 3.0, 1.0, 2.0, 3.0])


def test_drawn_envelope_is_that_of_the_result_and_periodic(tree: xr.DataTree) -> None:
    unloaded = tree["unloaded"].to_dataset()
    stored = unloaded["transmission_error_envelope"].values
    course, times, lowest = unloaded_curves(unloaded)
    between = (times.size - 1) // (2 * stored.size)
    np.testing.assert_allclose(lowest[::between], two_cycles(stored)[1])
    np.testing.assert_allclose(lowest[: stored.size * between], lowest[stored.size * between : -1], atol=1e-9)
    for pair in pairs_in_view(course, 2):
        own = course.at((times[::between] - pair) * course.per_cycle)
        assert not np.any(own < lowest[::between] - 1e-6)  # each is searched anew


def test_an_older_result_has_the_envelope_of_its_curves(tree: xr.DataTree) -> None:
    unloaded = tree["unloaded"].to_dataset()
    times, lowest = unloaded_curves(unloaded.drop_vars(["fine_envelope", "fine_position"]))[1:]
    fine = np.interp(times, *unloaded_curves(unloaded)[1:])
    assert np.abs(lowest - fine).max() < 0.05 * np.ptp(fine)


def test_a_pair_is_drawn_until_the_next_one_carries() -> None:
    """On an edge the error rises steeply between two mesh positions, until the next pair carries."""
    case = small("fm-11x41", "shell", mesh_positions=16, lengthwise_nodes=21, profile_nodes=15)
    state = CaseInMesh.of(case, misalignment=Misalignment(0.05, -0.03))
    unloaded = state.cycle.unloaded()
    lowest = unloaded_curves(unloaded)[2]
    assert np.ptp(lowest) == pytest.approx(unloaded.attrs["peak_to_peak"], rel=0.01)
    assert np.abs(np.diff(lowest)).max() < 0.1 * unloaded.attrs["peak_to_peak"]


def test_shares_of_all_pairs_add_up_at_any_time(tree: xr.DataTree) -> None:
    at_torque = tree["loaded"].to_dataset().isel(torque=1)
    course = share_passage(at_torque)
    steps = np.arange(2 * course.per_cycle + 1)
    total = sum(np.nan_to_num(course.at(steps - pair * course.per_cycle)) for pair in pairs_in_view(course, 2))
    np.testing.assert_allclose(total, 1.0, rtol=1e-9)


def test_mean_number_of_pairs_counts_those_under_load() -> None:
    def dataset(share: list[list[float]]) -> xr.Dataset:
        return xr.Dataset({"load_share": (("pair", "mesh_position"), np.array(share))}, coords={"pair": [0, 1]})

    assert mean_pairs_in_contact(dataset([[0.5, 0.0], [0.5, 1.0]])) == 1.5
    assert np.isnan(mean_pairs_in_contact(dataset([[0.5, np.nan], [0.5, np.nan]])))


# --- the contact pattern


def test_pattern_lies_on_the_flank_and_within_its_outline(tree: xr.DataTree, view: ToothView) -> None:
    pattern = unloaded_pattern(tree["unloaded"].to_dataset(), view.fields)
    assert len(pattern.ranges) == 1
    span = pattern.ranges[0]
    for points in (span.outline, span.path):
        assert points.min() >= 0.0
        assert points.max() <= 1.0
    outline = Outline(span.outline.T)
    inner = np.moveaxis(pattern.lines[pattern.carrying][:, :, 1:-1], 1, -1).reshape(-1, 2)
    assert np.mean(outline.contains_points(inner, radius=1e-3) | outline.contains_points(inner, radius=-1e-3)) > 0.99
    # The pinion's and the gear's edges end the pattern, also where the result's path runs beyond them in edge contact.
    assert np.min(boundary_distance(view.fields, span.outline)) > -0.01
    assert np.min(boundary_distance(view.fields, span.path)) > -1e-3
    everywhere = pattern.path[np.isfinite(pattern.path[:, 0])].T
    assert everywhere.min() >= 0.0
    assert everywhere.max() <= 1.0
    assert np.min(boundary_distance(view.fields, everywhere)) > -1e-6


def test_carrying_range_is_one_pitch_long(tree: xr.DataTree, view: ToothView) -> None:
    """From the pair before to the pair after it, the roll angle on the path grows by the pinion's pitch."""
    unloaded = tree["unloaded"].to_dataset()
    pattern = unloaded_pattern(unloaded, view.fields)
    assert np.sum(pattern.carrying) == unloaded.sizes["mesh_position"]
    span = pattern.ranges[0]
    assert span.path.shape[1] == unloaded.sizes["mesh_position"] + 2
    count = 17
    first, last = span.outline[:, -count:], span.outline[:, span.path.shape[1] : span.path.shape[1] + count]
    roll = [float(np.mean(view.fields("roll_angle", line))) for line in (first, last)]
    assert abs(abs(roll[1] - roll[0]) / (2 * np.pi / tree.attrs["pinion_teeth"]) - 1.0) < 1e-3


def test_contact_lines_bend_with_the_roll_angle(tree: xr.DataTree, view: ToothView) -> None:
    pattern = unloaded_pattern(tree["unloaded"].to_dataset(), view.fields)
    lines = np.moveaxis(pattern.lines[np.isfinite(pattern.lines[:, 0, 0])], 1, 0)
    roll = view.fields("roll_angle", lines)
    assert np.max(np.ptp(roll, axis=-1)) < 1e-3
    nothing = bent_lines(view.fields, np.full((2, 2, 2), np.nan))
    assert np.all(np.isnan(nothing))


# --- the pressure


def test_surface_is_nowhere_below_a_segment(tree: xr.DataTree, view: ToothView) -> None:
    """At the middle of every loaded segment the surface has at least its pressure, and its greatest is the result's."""
    loaded = tree["loaded"].to_dataset()
    for index in range(loaded.sizes["torque"]):
        at_torque = loaded.isel(torque=index)
        shape = pressure_map(at_torque)
        assert shape.peak == pytest.approx(float(loaded["max_pressure"][index]))
        drawn = view.in_plane(shape.points)
        mesh = Triangulation(drawn[0], drawn[1], shape.triangles)
        pressure = at_torque["pressure"].values
        carries = pressure > 1e-3 * shape.peak
        places = view.in_plane(np.stack([at_torque["lengthwise"].values, at_torque["profile"].values])[:, carries])
        at_segments = LinearTriInterpolator(mesh, shape.pressure)(places[0], places[1]).filled(np.nan)
        found = np.isfinite(at_segments)  # rounding may put a place on the rim just outside
        assert np.mean(found) > 0.95
        np.testing.assert_array_less(pressure[carries][found] - 1e-6 * shape.peak, at_segments[found])


def test_nothing_is_coloured_where_nothing_is_loaded(tree: xr.DataTree, view: ToothView) -> None:
    """Middles of unloaded segments lie outside the surface, but for those on the way to the next mesh position."""
    at_torque = tree["loaded"].to_dataset().isel(torque=0)
    shape = pressure_map(at_torque)
    drawn = view.in_plane(shape.points)
    mesh = Triangulation(drawn[0], drawn[1], shape.triangles)
    free = at_torque["pressure"].values == 0.0
    places = view.in_plane(np.stack([at_torque["lengthwise"].values, at_torque["profile"].values])[:, free])
    values = LinearTriInterpolator(mesh, shape.pressure)(places[0], places[1]).filled(0.0)
    assert np.max(values) < 0.05 * shape.peak


def test_triangles_do_not_overlap(tree: xr.DataTree, view: ToothView) -> None:
    """No place on the flank lies in two triangles: there is one pressure everywhere."""
    at = view.in_plane(np.random.default_rng(1).random((2, 1000)))
    for index in range(tree["loaded"].sizes["torque"]):
        shape = pressure_map(tree["loaded"].to_dataset().isel(torque=index))
        a, b, c = np.moveaxis(view.in_plane(shape.points)[:, shape.triangles], -1, 0)[..., None]  # (2, m, 1) each

        def turn(p: Array, q: Array) -> Array:
            """Which side of a side the places lie on, as a signed area (m, places)."""
            return np.asarray((q[0] - p[0]) * (at[1] - p[1]) - (q[1] - p[1]) * (at[0] - p[0]))

        sides = np.stack([turn(a, b), turn(b, c), turn(c, a)])
        holding = np.all(sides > 1e-9, axis=0) | np.all(sides < -1e-9, axis=0)
        assert np.max(np.sum(holding, axis=0)) == 1
        assert np.sum(holding) > 50


def straight(pressure: list[float], at: float, turned: bool = False) -> Line:
    """A contact line along the face at some profile fraction."""
    points = np.stack([np.linspace(0.2, 0.8, len(pressure)), np.full(len(pressure), at)])
    line = Line(points, np.array(pressure))
    return Line(line.points[:, ::-1], line.pressure[::-1]) if turned else line


def test_load_ends_where_the_squared_pressure_leads_to_zero() -> None:
    x = np.linspace(-1.0, 1.0, 41)
    for half in (0.52, 0.63, 0.71):
        load = np.maximum(1.0 - (x / half) ** 2, 0.0)
        (part,) = loaded_parts([Line(np.stack([x, np.zeros_like(x)]), np.sqrt(load))])
        assert part is not None
        assert part.pressure[0] == part.pressure[-1] == 0.0
        np.testing.assert_allclose([part.points[0, 0], part.points[0, -1]], [-half, half], atol=0.02)
    nothing, whole = loaded_parts([straight([0.0, 0.0, 0.0], 0.5), straight([1.0, 2.0, 3.0], 0.5)])
    assert nothing is None
    assert whole is not None  # loaded to both ends of the line
    assert whole.points.shape == (2, 3)


def test_missing_step_leaves_a_gap_and_turned_lines_are_joined() -> None:
    lines = {step: [straight([0.0, 2.0, 5.0, 4.0, 0.0], 0.1 * step, turned=step % 2 == 0)] for step in (1, 2, 3, 5, 6)}
    shape = surface(lines)
    rows = np.round(shape.points[1][shape.triangles] / 0.1).astype(int)
    spans = {(int(row.min()), int(row.max())) for row in rows}
    assert spans == {(1, 2), (2, 3), (5, 6)}
    centre = shape.points[0][shape.triangles]
    assert np.max(np.ptp(centre, axis=1)) < 0.35  # no triangle reaches across from one end to the other


def test_load_comes_to_a_point_before_an_unloaded_line() -> None:
    free = straight([0.0] * 5, 0.2)
    shape = surface(
        {0: [straight([0.0, 3.0, 6.0, 3.0, 0.0], 0.0)], 1: [straight([0.0, 2.0, 4.0, 2.0, 0.0], 0.1)], 2: [free]}
    )
    top = shape.points[1].max()
    assert 0.1 < top <= 0.2
    assert np.all(shape.pressure[shape.points[1] > 0.1] == 0.0)
    assert surface({0: [free]}).triangles.shape == (0, 3)
    assert np.isnan(surface({}).peak)


# --- the small things


def test_torques_are_chosen_evenly_with_both_ends() -> None:
    torques = np.array([500.0, 10.0, 300.0, 20.0, 400.0, 100.0, 200.0, 50.0])
    chosen = evenly_chosen(torques)
    assert chosen.size == 6
    assert np.all(np.diff(torques[chosen]) > 0.0)
    assert (torques[chosen[0]], torques[chosen[-1]]) == (10.0, 500.0)
    assert evenly_chosen(np.array([7.0])).tolist() == [0]


@pytest.mark.parametrize(("torque", "shown"), [(108.9899, "109 N m"), (12000.0, "12000 N m")])
def test_torques_are_shown_rounded_and_without_an_exponent(torque: float, shown: str) -> None:
    assert torque_name(torque) == shown


@pytest.mark.parametrize("extent", [0.7, 11.0, 30.0, 250.0])
def test_round_ticks_divide_an_axis_into_about_six_parts(extent: float) -> None:
    assert f"{tick_step(extent):e}"[0] in "125"
    assert 3.5 < extent / tick_step(extent) < 8.5


def test_small_print_names_flanks_and_misalignment(tree: xr.DataTree) -> None:
    text = " ".join(
        small_print({**tree.attrs, "misalignment_pinion_axial_mm": -0.12, "misalignment_shaft_angle_rad": 0.0})
    )
    assert tree.attrs["flank"] in text
    assert "P −0.12 mm" in text
    assert "E" not in text.split("misalignment")[1].split("easeoff")[0]
    assert "misalignment none" in " ".join(small_print({"flank": "coast"}))


# --- contour lines and their numbers


def test_contour_lines_get_one_number_each_apart_and_inside() -> None:
    axes = Figure().subplots()
    axes.set(xlim=(0.0, 40.0), ylim=(0.0, 10.0))
    x, y = np.meshgrid(np.linspace(0, 40, 81), np.linspace(0, 10, 41))
    lines = axes.contour(x, y, y + 0.02 * x, levels=np.arange(1.0, 10.0))
    outline = Outline([[2, 1], [38, 1], [38, 6], [2, 6], [2, 1]])
    places = np.array(label_points(axes, lines, outlined(outline), 7.0))
    assert 4 <= len(places) <= 9
    assert np.all(outline.contains_points(places))
    levels = places[:, 1] + 0.02 * places[:, 0]
    np.testing.assert_allclose(levels, np.round(levels), atol=1e-9)
    assert np.unique(np.round(levels)).size == len(places)
    gaps = np.abs(places[:, None] - places) * points_per_unit(axes)
    assert np.all(np.any(gaps > 5.2, axis=2) | np.eye(len(places), dtype=bool))  # as high as a number


def test_crowded_contour_lines_get_no_numbers() -> None:
    axes = Figure().subplots()
    axes.set(xlim=(0.0, 40.0), ylim=(0.0, 10.0))
    x, y = np.meshgrid(np.linspace(0, 40, 81), np.linspace(0, 10, 401))
    outline = Outline([[0, 0], [40, 0], [40, 10], [0, 10], [0, 0]])
    crowded = axes.contour(x, y, y, levels=np.arange(0.5, 10.0, 0.1))  # 3 points apart
    assert label_points(axes, crowded, outlined(outline), 7.0) == []
    assert len(label_points(axes, axes.contour(x, y, y, levels=[5.0]), outlined(outline), 7.0)) == 1
    narrow = Outline([[0, 4.9], [40, 4.9], [40, 5.1], [0, 5.1], [0, 4.9]])
    assert label_points(axes, axes.contour(x, y, y, levels=[5.0]), outlined(narrow), 7.0) == []


def test_lines_are_drawn_away_from_border_and_jumps() -> None:
    x, y = (v.ravel() for v in np.meshgrid(np.linspace(0, 10, 21), np.linspace(0, 5, 11)))
    mesh = Triangulation(x, y)
    inner = without_border(mesh).get_masked_triangles()
    assert x[inner].min() == 0.5
    assert y[inner].max() == 4.5
    jump = without_steep(mesh, np.where(x > 5.0, 10.0, 0.0) + 0.1 * y, 1.0).get_masked_triangles()
    assert not np.any((x[jump].min(axis=1) < 5.2) & (x[jump].max(axis=1) > 5.2))
    assert x[jump].min() == 0.0
    assert x[jump].max() == 10.0
    region = triangulated(mesh)
    np.testing.assert_array_equal(region.holds(np.array([[5.0, 2.0], [5.0, 6.0]])), [True, False])
    at_side = np.isclose(region.border[:, 0] % 10.0, 0.0) | np.isclose(region.border[:, 1] % 5.0, 0.0)
    assert np.all(at_side)


def test_short_contour_lines_are_dropped() -> None:
    axes = Figure().subplots()
    x, y = np.meshgrid(np.linspace(-4, 4, 161), np.linspace(-4, 4, 161))
    lines = axes.contour(x, y, np.minimum(np.hypot(x + 2, y) - 1.0, np.hypot(x - 3, y) - 0.1), levels=[0.0])
    assert len(lines.allsegs[0]) == 2
    drop_short(lines, 3.0)
    (left,) = lines.allsegs[0]
    assert np.hypot(*np.diff(left, axis=0).T).sum() == pytest.approx(2.0 * np.pi, rel=1e-2)


def test_pictures_say_how_many_torques_they_name(drive: xr.DataTree, lubricated: xr.DataTree) -> None:
    figure = transmission_error(changed(drive, "loaded", lambda ds: ds.isel(torque=[1] * 12)))
    legends = [axes.get_legend() for axes in figure.axes]
    headings = [legend.get_title().get_text() for legend in legends if legend is not None]
    assert headings == ["", "8 of 12 torques, the others pale", "8 of 12 torques, the others pale", ""]
    many = changed(lubricated, "friction", lambda _: friction(drive, Operation(list(np.arange(1.0, 8.0) * 300.0))))
    texts = [axes.get_legend() for axes in efficiency(many).axes if axes.get_visible()]
    assert "5 of 7 speeds" in [legend.get_title().get_text() for legend in texts if legend is not None]


def test_two_roughnesses_are_both_named(drive: xr.DataTree, lubricated: xr.DataTree) -> None:
    found = friction(drive, Operation(1500.0, [60.0, 90.0], [(0.8, 0.4), 0.5, (0.2, 0.4)]))
    assert [roughness_name(found, index) for index in range(3)] == ["0.8/0.4 µm", "0.5 µm", "0.2/0.4 µm"]
    *_, over_temperature, over_roughness = efficiency(changed(lubricated, "friction", lambda _: found)).axes
    legend = over_temperature.get_legend()
    assert legend is not None
    assert {text.get_text() for text in legend.get_texts()} == {"0.8/0.4 µm", "0.5 µm", "0.2/0.4 µm"}
    assert [label.get_text() for label in over_roughness.get_xticklabels()] == ["0.2/0.4", "0.5", "0.8/0.4"]


def test_small_print_has_even_lines_that_part_no_number_and_unit() -> None:
    parts = ["12 x 36", "coast: pinion convex, gear concave", "solid shell, edges", "contact lines within 6 µm"]
    for longest in (40, 60, 90):
        lines = even_lines(parts, longest)
        assert " ".join(lines).replace(" ·", "") == " ".join(parts)
        assert not any(line.endswith("·") or line.startswith("·") for line in lines)
        assert max(map(len, lines)) <= longest
        assert not any(line.endswith(" 6") for line in lines)
    assert even_lines(parts, 90) == [" · ".join(parts[:2]), " · ".join(parts[2:])]
    assert even_lines([]) == []
