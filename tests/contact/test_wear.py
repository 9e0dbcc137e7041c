"""Wear: what Archard's law says, whichever way it is added up; steps converge; a file belongs to the flanks it wore."""

from __future__ import annotations

from dataclasses import replace
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import xarray as xr
from runs import call, output_of, refusal_of, small

import easeoff
from easeoff import GeometryError, InputError
from easeoff.cases import Case, gear_pair, write_case
from easeoff.contact import MeshCycle
from easeoff.contact.archard_wear import Engagement, engagement, integral, on_flank, rolling_splines, touched
from easeoff.contact.lines.contact_lines import arc_length, contact_splines
from easeoff.contact.lines.flank_splines import FlankSplines
from easeoff.geometry import FlankName, Misalignment, deviation_from_formula, pair_geometry
from easeoff.geometry.pair.ease_off import rolling
from easeoff.study import WearLaw, wear
from easeoff.study.case_in_mesh import prepared_pair
from easeoff.study.deviations import flank_deviations

SEGMENTS = 15
NODES = (21, 15)


@cache
def small_case(mesh_positions: int = 8) -> Case:
    lengthwise, profile = NODES
    return small(
        "fm-11x41",
        "shell",
        mesh_positions=mesh_positions,
        segments_per_line=SEGMENTS,
        lengthwise_nodes=lengthwise,
        profile_nodes=profile,
    )


@cache
def moving_fields() -> FlankSplines:
    pair = prepared_pair(small_case(), "drive", None)
    geometry = pair_geometry(pair, NODES)
    motion = {name: value.reshape(NODES) for name, value in vars(rolling(geometry.exact)).items()}
    return rolling_splines(geometry.ease_off, motion)


@cache
def one_engagement(mesh_positions: int) -> tuple[Engagement, xr.Dataset]:
    case = small_case(mesh_positions)
    pair = prepared_pair(case, "drive", None)
    tree = easeoff.analyze(case, torques=[200.0], edge_contact=False)
    loaded = tree["loaded"].to_dataset()
    return engagement(loaded, moving_fields(), pair.assembly.pinion_pitch, SEGMENTS), loaded


@cache
def worn(largest_step: float, pinion: float = 1e-12, gear: float = 1e-12) -> xr.Dataset:
    return wear(small_case(), WearLaw(pinion, gear, 3e7, largest_step), torque=200.0)


def test_sliding_is_that_of_the_friction() -> None:
    """Two computations of their own: here from the conjugate motion, there from velocities at the segments."""
    case, speed = small_case(), 1000.0
    tree = easeoff.analyze(case, torques=[200.0], speed=speed)
    found = tree["friction"].to_dataset()["sliding_velocity"].isel(speed=0).values
    loaded = tree["loaded"].to_dataset().isel(torque=0)
    use = np.isfinite(loaded["length"].values)
    place = np.stack([loaded[name].values[use] for name in ("lengthwise", "profile")])
    sliding = moving_fields().evaluate(["sliding"], place)["sliding"]
    np.testing.assert_allclose(1e-3 * sliding * speed * np.pi / 30.0, found[use], rtol=1e-3)


@pytest.mark.parametrize("member", ["pinion", "gear"])
def test_depth_times_area_is_force_times_sliding(member: str) -> None:
    """The volume of a tooth from line loads, area by area, is that from forces and ways."""
    found, _ = one_engagement(8)
    assert float(np.sum(found.passing[member] * found.area[member])) == pytest.approx(found.work, rel=1e-12)


def test_the_lines_sweep_the_whole_common_flank() -> None:
    """Areas swept by the lines add up to the area of the flank between them, on either member."""
    found, _ = one_engagement(32)
    pair = prepared_pair(small_case(), "drive", None)
    for member in ("pinion", "gear"):
        t, h = np.linspace(0, 1, 101), np.linspace(0, 1, 67)
        flank = getattr(pair, member).flank(t, h)
        position = np.moveaxis(flank.position.reshape(3, 101, 67), 0, -1)
        density = np.linalg.norm(np.cross(np.gradient(position, t, axis=0), np.gradient(position, h, axis=1)), axis=-1)
        inside = touched(found, member, t, h)
        area = float(np.sum(density[inside])) * (t[1] - t[0]) * (h[1] - h[0])
        assert float(np.sum(found.area[member])) == pytest.approx(area, rel=0.03)


@pytest.mark.parametrize("member", ["pinion", "gear"])
def test_the_field_on_the_flank_keeps_the_volume(member: str) -> None:
    found, _ = one_engagement(32)
    t, h = np.linspace(0, 1, 201), np.linspace(0, 1, 133)
    field = on_flank(found, member, t, h)
    i, j = (np.round(f * (n - 1)).astype(int) for f, n in zip(found.points[member], (201, 133), strict=True))
    at_samples = field[np.clip(i, 0, 200), np.clip(j, 0, 132)]
    assert float(np.sum(found.area[member] * at_samples)) == pytest.approx(found.work, rel=5e-3)
    assert np.all(field >= 0.0)


def test_removed_volume_is_the_integral_of_the_depth() -> None:
    history = worn(2.0)
    assert history.sizes["step"] > 3
    removed, integrated = history["removed_volume"].values[1:], history["depth_integral"].values[1:]
    np.testing.assert_allclose(integrated, removed, rtol=0.04)
    # Both teeth of one engagement lose the same; the gear's meets as many times fewer as it has more teeth.
    np.testing.assert_allclose(removed[:, 1], removed[:, 0] * 11 / 41, rtol=1e-12)


@pytest.mark.thorough
def test_halving_the_step_halves_the_error() -> None:
    """First order: successive differences of the depth at the same revolutions halve."""
    depths = [worn(step)["wear_depth"].values[-1] for step in (2.0, 1.0, 0.5)]
    assert worn(2.0).sizes["step"] < worn(1.0).sizes["step"] < worn(0.5).sizes["step"]
    coarse, fine = (float(np.sqrt(np.mean((a - b) ** 2))) for a, b in (depths[:2], depths[1:]))
    assert 1.5 < coarse / fine < 2.5
    for step in (2.0, 1.0, 0.5):
        history = worn(step)
        assert history["revolutions"].values[-1] == pytest.approx(3e7, rel=1e-12)
        assert np.max(np.diff(history["wear_depth"].values, axis=0)) <= step * (1.0 + 1e-9)
        assert history.attrs["stop"] == "all revolutions done"
        assert history.attrs["completed"] == 1


@pytest.mark.thorough
def test_wear_begins_in_proportion_to_the_coefficient() -> None:
    """Twice the coefficient for half the revolutions is the same, lapping or not; none wears nothing."""
    first = wear(small_case(), WearLaw(1e-12, 2e-12, 1e6, 5.0), torque=200.0)
    second = wear(small_case(), WearLaw(2e-6, 4e-6, 0.5, 5.0), torque=200.0)
    np.testing.assert_allclose(second["wear_depth"].values, first["wear_depth"].values, rtol=1e-10, atol=1e-12)
    still = wear(small_case(), WearLaw(0.0, 0.0, 1e6), torque=200.0)
    assert still.attrs["stop"] == "nothing wears"
    assert np.all(still["wear_depth"].values == 0.0)


@pytest.mark.thorough
def test_a_run_goes_on_from_where_another_ended() -> None:
    """As lapping does from one position to the next: the deviations left are those to start from."""
    law = WearLaw(1e-12, 1e-12, 4e6, 10.0)
    first = wear(small_case(), law, torque=200.0)
    step = float(first["largest_depth"].max())
    whole = wear(small_case(), WearLaw(1e-12, 1e-12, 8e6, step), torque=200.0)
    left: Any = {m: first[["deviation"]].isel(step=-1).sel(member=m) for m in ("pinion", "gear")}
    second = wear(small_case(), law, torque=200.0, deviations=left)
    both = first["removed_volume"].values[-1] + second["removed_volume"].values[-1]
    np.testing.assert_allclose(both, whole["removed_volume"].values[-1], rtol=1e-3)
    np.testing.assert_allclose(second["deviation"].values[-1], whole["deviation"].values[-1], rtol=0, atol=0.03)


def test_it_stops_at_the_largest_depth() -> None:
    law = WearLaw(1e-12, 0.0, 1e12, 1.0, 1.7)
    history = wear(small_case(), law, torque=200.0)
    assert history.attrs["stop"] == "largest depth reached"
    assert float(history["largest_depth"].max()) == pytest.approx(1.7, rel=1e-9)
    assert np.all(history["wear_depth"].sel(member="gear").values == 0.0)


def test_wear_takes_where_load_and_sliding_are() -> None:
    found, loaded = one_engagement(8)
    force = loaded["force"].isel(torque=0).values
    present = np.isfinite(loaded["length"].isel(torque=0).values)
    np.testing.assert_array_equal(found.passing["gear"] > 0.0, force[present] > 0.0)
    history = worn(2.0)
    assert np.all(np.diff(history["wear_depth"].values, axis=0) >= -1e-12)
    assert history["wear_depth"].attrs["units"] == "um"


def test_bad_input_is_refused() -> None:
    for arguments, message in (
        ((-1.0, 1.0, 1.0), "pinion_coefficient = -1: must be a finite number of 0 or more"),
        ((1e-12, 1e-12, 0.0), "revolutions = 0: must be a finite number above 0"),
        ((1e-12, 1e-12, 1.0, np.nan), "largest_step"),
        ((1.0, 1e-12, 1.0), "mm\\^2/N"),
        ((1e-12, 1e-12, 1e308), r"revolutions = 1e\+308: must be at most 1e\+15$"),
        ((1e-12, 1e-12, 1.0, 1e5), r"largest_step = 100000: must be at most 10000 \[um\]"),
        ((1e-12, 1e-12, 1.0, 0.5, np.inf), "largest_depth = inf: must be a finite number above 0"),
        ((1e-12, 1e-12, 1.0, 0.5, 1.0, 0), "most_steps = 0: must be a whole number of 1 or more"),
    ):
        with pytest.raises(InputError, match=message):
            WearLaw(*arguments)
    found, loaded = one_engagement(8)
    assert found.work > 0.0
    unsolved = loaded.copy(deep=True)
    unsolved["force"].values[0, 3] = np.nan
    pair = prepared_pair(small_case(), "drive", None)
    with pytest.raises(GeometryError, match="not solved at every mesh position"):
        engagement(unsolved, moving_fields(), pair.assembly.pinion_pitch, SEGMENTS)


def test_edges_are_refused_by_the_law_and_left_out_of_the_study() -> None:
    """An edge sweeps no flank; the study takes lines alone whatever the case says, and its file says so."""
    loaded = easeoff.analyze(small_case(), torques=[500.0])["loaded"].to_dataset()
    assert float(loaded["edge_share"].max()) > 0.0
    pitch = prepared_pair(small_case(), "drive", None).assembly.pinion_pitch
    with pytest.raises(InputError, match=r"loaded: must have contact on lines alone .*edge_contact = False"):
        engagement(loaded, moving_fields(), pitch, SEGMENTS)
    history = wear(small_case(), WearLaw(1e-12, 1e-12, 1e5), torque=500.0)
    assert history.attrs["edge_contact"] == 0
    lines = easeoff.analyze(small_case(), torques=[500.0], edge_contact=False)["loaded"].to_dataset()
    assert float(history["peak_to_peak"][0, 0]) == pytest.approx(float(lines["peak_to_peak"][0]), rel=1e-9)


# A file of `easeoff wear` belongs to the flanks it was made for: other teeth, blanks and settings are refused


MEMBERS: Any = ("pinion", "gear")


@pytest.fixture(scope="module")
def file(tmp_path_factory: pytest.TempPathFactory) -> Path:
    path = tmp_path_factory.mktemp("wear") / "worn.nc"
    wear(small_case(), WearLaw(1e-12, 1e-12, 4e6, 10.0), torque=200.0).to_netcdf(path, engine="netcdf4")
    return path


def used(file: Path, case: Case, flank: FlankName = "drive", members: Any = MEMBERS) -> dict[str, Any]:
    return flank_deviations(gear_pair(case, flank), dict.fromkeys(members, file))


def changed(case: Case, *keys: str, by: float) -> Case:
    """The case with one number of it changed."""
    data = case.model_dump()
    table = data
    for key in keys[:-1]:
        table = table[key]
    table[keys[-1]] += by
    return Case.model_validate(data)


def test_the_case_it_was_made_for_takes_it(file: Path) -> None:
    found = used(file, small_case())
    with xr.open_dataset(file, engine="netcdf4") as stored:
        last = 1e-3 * stored["deviation"].isel(step=-1).values
    for index, member in enumerate(MEMBERS):
        np.testing.assert_allclose(found[member].value, last[index], rtol=0, atol=1e-12)


@pytest.mark.usefixtures("reading_here")
def test_loads_friction_assembly_and_small_corrections_make_no_difference(file: Path) -> None:
    """A machine angle 0.005 degrees off moves the flank by hundredths of a millimetre: the wear is still its own."""
    data = small_case().model_dump() | {"friction": {"speed": 800.0}}
    data["contact"]["torques"] = (75.0,)
    data["misalignment"]["offset"] += 0.3
    assert set(used(file, Case.model_validate(data))) == set(MEMBERS)
    nearly = changed(small_case(), "pinion", "concave", "machine", "machine_root_angle", by=0.005)
    assert set(used(file, nearly)) == set(MEMBERS)


def test_a_flank_turned_about_its_axis_is_the_same(file: Path, tmp_path: Path) -> None:
    angle = 1.234
    with xr.open_dataset(file, engine="netcdf4") as stored:
        turned = stored.load()
    x, y = (turned["position"].sel(xyz=axis).values.copy() for axis in "xy")
    turned["position"].loc[{"xyz": "x"}] = np.cos(angle) * x - np.sin(angle) * y
    turned["position"].loc[{"xyz": "y"}] = np.sin(angle) * x + np.cos(angle) * y
    turned.to_netcdf(tmp_path / "turned.nc", engine="netcdf4")
    assert set(used(tmp_path / "turned.nc", small_case())) == set(MEMBERS)


@pytest.mark.usefixtures("reading_here")
@pytest.mark.parametrize(
    "keys",
    [
        ("pinion", "concave", "machine", "radial_distance"),
        ("pinion", "concave", "cutter", "blade_point_radius"),
        ("pinion", "blank", "face_width"),
        ("gear", "convex", "cutter", "blade_pressure_angle"),
    ],
)
def test_other_settings_and_blanks_are_refused(file: Path, keys: tuple[str, ...]) -> None:
    member = keys[0]
    with pytest.raises(InputError, match=rf"deviation {member} = .*worn.nc: made by .* mm off .*0.05 mm are allowed"):
        used(file, changed(small_case(), *keys, by=1.0), members=(member,))


def test_another_number_of_teeth_is_refused_whatever_the_flanks(file: Path, tmp_path: Path) -> None:
    with xr.open_dataset(file, engine="netcdf4") as stored:
        other = stored.load().assign_attrs(gear_teeth=43)
    other.to_netcdf(tmp_path / "other.nc", engine="netcdf4")
    with pytest.raises(InputError, match=r"11 x 43 teeth; this pair has 11 x 41 teeth\. Give the case"):
        used(tmp_path / "other.nc", small_case())


def test_the_other_flanks_are_refused(file: Path) -> None:
    with pytest.raises(InputError, match=r"drive flanks, .* mm off"):
        used(file, small_case(), "coast")


@pytest.mark.parametrize("lost", ["position", "gear_teeth"])
def test_a_file_that_does_not_say_is_refused(file: Path, tmp_path: Path, lost: str) -> None:
    with xr.open_dataset(file, engine="netcdf4") as stored:
        old = stored.load().drop_vars(lost, errors="ignore")
    old.attrs.pop(lost, None)
    old.to_netcdf(tmp_path / "old.nc", engine="netcdf4")
    with pytest.raises(InputError, match="does not say for which flanks it was made"):
        used(tmp_path / "old.nc", small_case())


@pytest.mark.usefixtures("reading_here")
@pytest.mark.parametrize("command", ["run", "correct", "wear"])
def test_every_command_refuses_it_and_leaves_nothing(file: Path, tmp_path: Path, command: str) -> None:
    out = tmp_path / "out.nc"
    more = {"run": ["-o", out], "correct": [], "wear": ["-o", out, "--torque", "50", "--revolutions", "1"]}
    said = refusal_of(command, "nasa-12x36", "--deviation", f"gear={file}", *more[command])
    assert f"deviation gear = {file}" in said
    assert "this pair has 12 x 36 teeth" in said
    assert easeoff.read_case("fm-11x41").title in said
    assert not out.exists()


def test_a_case_written_out_again_takes_it(file: Path, tmp_path: Path) -> None:
    """Numbers of a case file are read as they were written: the flanks are the same."""
    write_case(small_case(), tmp_path / "case.toml")
    assert set(used(file, easeoff.read_case(tmp_path / "case.toml"))) == set(MEMBERS)


# --- Runs of wear, and its command


@pytest.fixture(scope="module")
def case_file(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The file of a small case."""
    path = tmp_path_factory.mktemp("case") / "case.toml"
    write_case(small_case(4), path)
    return path


LAW = WearLaw(1e-12, 1e-12, 4e6, 10.0)


@pytest.mark.thorough
def test_a_duty_cycle_wears_as_its_torques_do_by_turns() -> None:
    """In one step the depth is the sum of what the torques take off, each for its revolutions."""
    together = wear(small_case(), LAW, torque={100.0: 0.7, 300.0: 0.3})
    alone = [
        wear(small_case(), WearLaw(1e-12, 1e-12, share * 4e6, 10.0), torque=torque)
        for torque, share in ((100.0, 0.7), (300.0, 0.3))
    ]
    for name in ("wear_depth", "removed_volume"):
        wanted = sum(history[name].values[-1] for history in alone)
        np.testing.assert_allclose(together[name].values[-1], wanted, rtol=1e-9, atol=1e-15)
    assert together["torque"].values.tolist() == [100.0, 300.0]
    assert together["revolution_share"].values.tolist() == [0.7, 0.3]
    for index, history in enumerate(alone):
        assert float(together["peak_to_peak"][0, index]) == pytest.approx(
            float(history["peak_to_peak"][0, 0]), rel=1e-9
        )


@pytest.mark.parametrize("torque", [-1.0, {100.0: 0.7, 200.0: 0.2}, {100.0: 1.5, 200.0: -0.5}, {}, np.nan])
def test_a_duty_cycle_that_is_none_is_refused(torque: Any) -> None:
    with pytest.raises(InputError, match=r"shares of the revolutions|torque = nan: must be a finite number"):
        wear(small_case(), LAW, torque=torque)


def left_by(history: xr.Dataset) -> Any:
    return {m: history[["deviation"]].isel(step=-1).sel(member=m) for m in ("pinion", "gear")}


def pattern(misalignment: Misalignment, deviations: Any = None) -> float:
    """Mean length of the contact lines of the unloaded pattern [mm]."""
    tree = easeoff.analyze(small_case(16), torques=[10.0], misalignment=misalignment, deviations=deviations)
    return float(tree["unloaded"]["line_length"].sel(pair=0).mean())


@cache
def lapped() -> tuple[list[xr.Dataset], list[Misalignment]]:
    """The pair lapped in two positions to either side of its own, one after the other, with much compound."""
    own = prepared_pair(small_case(), "drive", None).assembly.misalignment
    positions = [replace(own, offset=own.offset + by) for by in (-0.1, 0.1)]
    histories: list[xr.Dataset] = []
    for position in positions:
        left = left_by(histories[-1]) if histories else None
        law = WearLaw(1e-8, 1e-8, 300.0, 1.0)
        histories.append(wear(small_case(16), law, torque=100.0, misalignment=position, deviations=left))
    return histories, positions


@pytest.mark.thorough
def test_lapping_in_displaced_positions_extends_the_pattern_there() -> None:
    histories, positions = lapped()
    left = left_by(histories[-1])
    for position in positions:
        assert pattern(position, left) > 1.02 * pattern(position)


def test_lapping_conserves_the_volume_over_all_positions() -> None:
    """What Archard's law takes off position by position is the volume between the designed and the lapped flanks."""
    histories, _ = lapped()
    for history in histories:
        last = history.isel(step=-1)
        np.testing.assert_allclose(last["depth_integral"].values, last["removed_volume"].values, rtol=0.04)
    deep = sum(history["wear_depth"].values[-1] for history in histories)
    gone = -histories[-1]["deviation"].values[-1]
    worn = np.all([history["wear_depth"].values[-1] > 0.0 for history in histories], axis=0)
    np.testing.assert_allclose(gone[worn], deep[worn], rtol=0, atol=0.02 * deep.max())


def test_flanks_without_line_contact_do_not_wear() -> None:
    pair = prepared_pair(small_case(), "drive", None)
    wavy = deviation_from_formula(pair.gear.section, lambda t, h: 5.0 * np.sin(40.0 * t) * np.sin(40.0 * h))
    with pytest.raises(GeometryError, match="no line contact"):
        wear(small_case(), LAW, torque=200.0, deviations={"gear": wavy})


def test_the_command_line_wears_and_goes_on_from_what_it_left(case_file: Path, tmp_path: Path) -> None:
    out, again = tmp_path / "worn.nc", tmp_path / "again.nc"
    common = ["wear", case_file, "--torque", "100=0.5,200=0.5", "--revolutions", "2e6", "--largest-step", "5"]
    said = output_of(*common, "--coefficient", "1e-12/2e-12", "-o", out)
    assert "all revolutions done" in said
    assert "\ngreatest wear depth" in said
    assert "peak to peak at 200 N m" in said
    assert "contact on lines alone, without tooth edges" in said
    with xr.open_dataset(out, engine="netcdf4") as stored:
        first = stored.load()
    assert first["wear_depth"].attrs["units"] == "um"
    assert first.attrs["gear_coefficient_mm2_per_N"] == 2e-12
    law = WearLaw(1e-12, 2e-12, 2e6, 5.0)
    history = wear(small_case(4), law, torque={100.0: 0.5, 200.0: 0.5})
    np.testing.assert_allclose(first["wear_depth"].values, history["wear_depth"].values, rtol=1e-9)
    worn = ["--deviation", f"pinion={out}", "--deviation", f"gear={out}"]
    output_of(*common, *worn, "-o", again)
    with xr.open_dataset(again, engine="netcdf4") as stored:
        start = stored["deviation"].isel(step=0).values
    np.testing.assert_allclose(start, first["deviation"].isel(step=-1).values, rtol=0, atol=1e-6)
    assert [path.name for path in sorted(tmp_path.iterdir())] == ["again.nc", "worn.nc"]


@pytest.mark.parametrize(
    ("options", "message"),
    [
        (["--torque", "heavy"], "must be a torque in N m"),
        (["--torque", "100=0.5,200=0.4"], "the shares add up to 0.9, not 1"),
        (["--torque", "100=0.5,100=0.5"], "100 comes twice"),
        (["--coefficient", "1/2/3"], "must be a coefficient in mm^2/N"),
        (["--coefficient", "1.0"], "pinion_coefficient = 1: must be at most 0.001 [mm^2/N]"),
        (["--torque", "1e308"], "torque = 1e+308: must be at least 1e-06 and below 1e+07 N m"),
        (["--torque", "100=0.5,1e-308=0.5"], "torque = 1e-308: must be at least 1e-06 and below 1e+07 N m"),
        (["--most-steps", "0"], "most_steps = 0: must be a whole number of 1 or more"),
        (["--largest-step", "1e-9"], "largest_step = 1e-09: would take about"),
        (["--revolutions", "0"], "revolutions = 0: must be a finite number above 0"),
        (["-o", "worn.csv"], "ends in .nc"),
        (["--deviation", "axle=worn.nc"], "must be pinion=FILE or gear=FILE"),
        (["--deviation", "pinion=worn.nc"], "there is no such file"),
        (["--flank", "left"], "'left' is not one of 'drive', 'coast'"),
    ],
)
def test_mistakes_on_the_command_line_are_named(
    options: list[str], message: str, case_file: Path, tmp_path: Path
) -> None:
    usual = {"--torque": "200", "--revolutions": "1e6", "-o": str(tmp_path / "worn.nc")}
    given = usual | dict(zip(options[::2], options[1::2], strict=True))
    said = refusal_of("wear", case_file, *(part for pair in given.items() for part in pair))
    assert message in " ".join(said.replace("│", " ").split())
    assert not list(tmp_path.iterdir())


def test_steps_are_counted_before_they_are_taken() -> None:
    """By the rate at the start, which the run keeps to within what the contact changes; a depth ends it earlier."""
    law = WearLaw(1e-12, 1e-12, 3e7, 2.0)
    history = wear(small_case(), law, torque=200.0)
    first = history.isel(step=1)
    rate = 1e-3 * float(first["largest_depth"].max() / first["revolutions"])
    assert law.steps(rate) == pytest.approx(history.sizes["step"] - 1, abs=2)
    assert replace(law, largest_depth=3.0).steps(rate) == 2.0
    assert replace(law, largest_depth=1e4, revolutions=1e15, largest_step=1e-320).steps(rate) == np.inf
    assert law.steps(0.0) == 1.0


@pytest.mark.parametrize("step", [1e-9, 1e-300])
def test_steps_without_end_are_refused_with_what_they_cost(step: float) -> None:
    with pytest.raises(InputError) as refused:
        wear(small_case(), WearLaw(1e-12, 1e-12, 3e7, step), torque=200.0)
    for part in (f"largest_step = {step:g}: would take about", "8 contact problems", "years in all", "--most-steps"):
        assert part in str(refused.value)
    least = float(str(refused.value).partition("must be ")[2].partition(" [um]")[0])
    law = WearLaw(1e-12, 1e-12, 3e7, least)
    assert 800 < law.steps(1e-3 * step * float(str(refused.value).split()[6]) / 3e7) <= 1000


def test_the_smallest_step_that_the_message_names_is_taken() -> None:
    with pytest.raises(InputError, match="most_steps") as refused:
        wear(small_case(), WearLaw(1e-12, 1e-12, 3e7, 0.1, most_steps=3), torque=200.0)
    least = float(str(refused.value).partition("must be ")[2].partition(" [um]")[0])
    history = wear(small_case(), WearLaw(1e-12, 1e-12, 3e7, least, most_steps=3), torque=200.0)
    assert history.attrs["most_steps"] == 3
    assert history.sizes["step"] <= 4


def test_wear_that_grows_faster_than_it_began_ends_at_the_most_steps(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(WearLaw, "steps", lambda law, fastest: 1.0)
    history = wear(small_case(), WearLaw(1e-12, 1e-12, 3e7, 1.0, most_steps=2), torque=200.0)
    assert history.attrs["stop"] == "most_steps = 2 taken: the flanks wear faster than at the start"
    assert (history.attrs["completed"], history.sizes["step"]) == (0, 3)


@pytest.mark.thorough
def test_wear_beyond_the_last_contact_stops_with_a_reason_of_its_own(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    """The step that lost it is not kept, the reason speaks of wear, not of measuring, and the exit code is 1."""
    solved: list[float] = []

    def lost_in_the_end(*arguments: Any) -> float:
        solved.append(0.0)
        return 0.0 if len(solved) < 4 else 0.03

    monkeypatch.setattr(MeshCycle, "lost_contact", property(lost_in_the_end))
    out = tmp_path / "worn.nc"
    arguments = ["wear", "fm-11x41", "--torque", "200", "--revolutions", "1e8", "--largest-step", "1", "-o", str(out)]
    ended = call(*arguments)
    assert ended.exit_code == 1
    for part in ("contact lost: at 3.0 % of the points", "ended early", "% of the revolutions"):
        assert part in ended.output
    assert "easure" not in ended.output
    with xr.open_dataset(out, engine="netcdf4") as stored:
        assert stored.sizes["step"] == 3
        assert stored.attrs["completed"] == 0
        assert float(stored["largest_depth"].max()) <= 2.0 + 1e-9


def test_wear_whose_contact_is_not_solved_says_so(monkeypatch: pytest.MonkeyPatch) -> None:
    calls: list[int] = []
    solve = MeshCycle.loaded

    def failing(*arguments: Any, **options: Any) -> Any:
        loaded, cases = solve(*arguments, **options)
        calls.append(1)
        if len(calls) == 3:
            loaded["status"][0, 2:4] = 1
        return loaded, cases

    monkeypatch.setattr(MeshCycle, "loaded", failing)
    history = wear(small_case(), WearLaw(1e-12, 1e-12, 3e7, 1.0), torque=200.0)
    assert history.attrs["stop"] == "contact not solved: 2 of 8 mesh positions of the worn flanks"
    assert history.attrs["completed"] == 0
    assert history.sizes["step"] == 2


def test_a_corner_where_points_coincide_has_no_length() -> None:
    """One such curve once counted as 27 m, and all others as too short beside it."""
    pair = prepared_pair(small_case(), "drive", None)
    geometry = pair_geometry(pair, (21, 15))
    fields = contact_splines(geometry.flanks, geometry.ease_off)
    along = np.array([0.2, 0.2, 0.2 + 1e-9, 0.2 + 1e-9, 0.21, 0.22])
    curve = np.stack([along, np.full(along.size, 0.5)])[:, None]
    length = arc_length(fields, curve)[0]
    chords = np.linalg.norm(np.diff(fields("position", curve)[:, 0], axis=-1), axis=0).sum()
    assert np.all(np.isfinite(length))
    assert length[-1] == pytest.approx(chords, rel=0.05)


def test_integral_of_one_over_a_plane_is_its_area() -> None:
    t, h = np.linspace(0.0, 1.0, 5), np.linspace(0.0, 1.0, 3)
    plane = np.stack(np.meshgrid(20.0 * t, 5.0 * h, [0.0], indexing="ij"), axis=-1)[:, :, 0]
    assert integral(np.ones((5, 3)), plane, t, h) == pytest.approx(100.0)
