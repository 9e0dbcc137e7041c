"""A file of `easeoff wear` belongs to the flanks it was made for: other teeth, blanks and settings are refused."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest
import xarray as xr
from runs import refusal_of
from test_wear import small_case

import easeoff
from easeoff import InputError
from easeoff.cases import Case, gear_pair, write_case
from easeoff.geometry import FlankName
from easeoff.study import WearLaw, flank_deviations, wear

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
