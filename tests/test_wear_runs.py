"""Wear under a duty cycle, lapping, and both from the command line."""

from __future__ import annotations

from dataclasses import replace
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import xarray as xr
from runs import call, output_of, refusal_of
from test_wear import small_case

import easeoff
from easeoff import GeometryError, InputError
from easeoff.cases import write_case
from easeoff.contact import MeshCycle
from easeoff.contact.lines.contact_lines import arc_length, contact_splines
from easeoff.geometry import Misalignment, deviation_from_formula, pair_geometry
from easeoff.study import WearLaw, wear
from easeoff.study.case_in_mesh import prepared_pair


@pytest.fixture(scope="module")
def file(tmp_path_factory: pytest.TempPathFactory) -> Path:
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
    with pytest.raises(InputError, match="shares of the revolutions"):
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


def test_the_command_line_wears_and_goes_on_from_what_it_left(file: Path, tmp_path: Path) -> None:
    out, again = tmp_path / "worn.nc", tmp_path / "again.nc"
    common = ["wear", file, "--torque", "100=0.5,200=0.5", "--revolutions", "2e6", "--largest-step", "5"]
    said = output_of(*common, "--coefficient", "1e-12/2e-12", "-o", out)
    assert "all revolutions done" in said
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
def test_mistakes_on_the_command_line_are_named(options: list[str], message: str, file: Path, tmp_path: Path) -> None:
    usual = {"--torque": "200", "--revolutions": "1e6", "-o": str(tmp_path / "worn.nc")}
    given = usual | dict(zip(options[::2], options[1::2], strict=True))
    said = refusal_of("wear", file, *(part for pair in given.items() for part in pair))
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
