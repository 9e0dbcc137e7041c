"""Files of every version are read, shown, plotted and run by the code as it is; ``keep_files.py`` makes them."""

from __future__ import annotations

import json
import os
import shutil
import tarfile
from collections.abc import Callable, Iterator, Mapping
from functools import cache
from importlib.metadata import version
from pathlib import Path
from typing import Any

import pytest
import xarray as xr
from keep_files import COMMANDS, KEPT, KINDS, READERS, call
from netCDF4 import Dataset

import easeoff
from easeoff import InputError
from easeoff.core import netcdf_file
from easeoff.study.sweep.sweep_file import read_sweep

VERSIONS = sorted(path.name for path in KEPT.iterdir())
#: Numbers by which a run of today means the same as the kept one, whatever models and grids have become.
OF_ONE_MEANING = (
    *("/loaded/transmission_error", "/loaded/max_pressure", "/loaded/lever_arm", "/unloaded/transmission_error"),
    *("/ease_off/roll_angle", "/friction/efficiency", "/friction/mean_power_loss", "/root_stress/max_root_stress"),
    *("/max_pressure", "/mean_level", "/efficiency", "/largest_depth", "/misalignment/offset", "/supports/mesh_force"),
    *("/total_v", "/total_h", "/peak_to_peak"),
    *("/load_cases/max_pressure", "/load_cases/torque"),
)
CHANGE = 0.1  # greatest change of these, relative


def archive(name: str) -> dict[str, Any]:
    """What is recorded of the files of a version."""
    with tarfile.open(KEPT / name / "results.tar.xz") as packed:
        content = packed.extractfile("kept.json")
        assert content is not None
        found: dict[str, Any] = json.load(content)
    return found


RECORDS = {name: archive(name) for name in VERSIONS}
INPUTS = [(name, file) for name in VERSIONS for file in RECORDS[name]["inputs"]]
RESULTS = [(name, file) for name in VERSIONS for file in RECORDS[name]["results"]]
SHOWN = [each for each in RESULTS if RECORDS[each[0]]["results"][each[1]]["kind"] in ("result", "sweep")]
REPORTED = [each for each in RESULTS if RECORDS[each[0]]["results"][each[1]]["kind"] in ("result", "dataset")]
DRAWN = [each for each in RESULTS if RECORDS[each[0]]["results"][each[1]]["kind"] in ("dataset", "sweep")]
DRAWN += [each for each in RESULTS if RECORDS[each[0]]["results"][each[1]]["kind"] == "result"]
WITH_CASE = [each for each in SHOWN if each[1] != "duty.nc"]  # that one is run over the case's own load cases


@pytest.fixture(scope="module")
def kept(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Folder with the inputs and results of every version."""
    folder = tmp_path_factory.mktemp("kept")
    for name in VERSIONS:
        shutil.copytree(KEPT / name / "inputs", folder / name / "inputs")
        with tarfile.open(KEPT / name / "results.tar.xz") as packed:
            packed.extractall(folder / name, filter="data")
    return folder


@pytest.fixture(scope="module", autouse=True)
def read_once() -> Iterator[None]:
    """Whatever asks for the content of a netCDF file, it comes from the disk once; all are whole, and read here."""
    read = netcdf_file._read

    @cache
    def content(path: str, _changed: int) -> xr.DataTree:
        with pytest.MonkeyPatch.context() as patch:
            patch.setattr(netcdf_file, "in_forked_process", lambda work: work())
            return read(path, netcdf_file.whole_tree, square=True)

    def kept_content(path: str | os.PathLike[str], opened: object, **_: bool) -> xr.DataTree | xr.Dataset:
        tree = content(os.path.abspath(path), os.stat(path).st_mtime_ns)
        return tree.copy() if opened is netcdf_file.whole_tree else tree.to_dataset()

    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(netcdf_file, "_read", kept_content)
        yield


#: What version 1 of a case called otherwise.
VERSION_1 = {"mean_normal_circular_thickness": "mid_flank_normal_circular_thickness"}


def of_this_version(recorded: Any, renamed: Mapping[str, str] | None = None) -> Any:
    """A record with the names of today, where it holds a case of version 1."""
    if isinstance(recorded, list):
        return [of_this_version(value, renamed) for value in recorded]
    if not isinstance(recorded, Mapping):
        return recorded
    names = VERSION_1 if recorded.get("easeoff_case") == 1 else renamed or {}
    today = {names.get(key, key): of_this_version(value, names) for key, value in recorded.items()}
    return today | ({"easeoff_case": 2} if names is VERSION_1 and "easeoff_case" in today else {})


def check(recorded: Any, found: Any, place: str = "") -> None:
    """That everything recorded is found again; what was added since is not looked at."""
    if isinstance(recorded, Mapping):
        assert isinstance(found, Mapping), place
        missing = recorded.keys() - found.keys()
        assert not missing, f"{place}: {sorted(missing)}"
        for key, value in recorded.items():
            check(value, found[key], f"{place}/{key}")
    elif isinstance(recorded, list):
        assert len(recorded) == len(found), place
        for number, (value, other) in enumerate(zip(recorded, found, strict=True)):
            check(value, other, f"{place}/{number}")
    elif isinstance(recorded, float):
        assert found == pytest.approx(recorded, rel=1e-12, abs=1e-300), place
    else:
        assert found == recorded, place


def same_meaning(recorded: Mapping[str, Any], found: Mapping[str, Any]) -> int:
    """Count of the numbers of one meaning that agree in size with the recorded ones; none may differ."""
    names = [name for name in recorded if name.endswith(OF_ONE_MEANING) and "largest" in recorded[name]]
    for name in names:
        assert found[name]["largest"] == pytest.approx(recorded[name]["largest"], rel=CHANGE, abs=1e-9), name
    return len(names)


def test_files_of_this_version_are_kept() -> None:
    """If not: run tests/keep_files.py."""
    mine = RECORDS[version("easeoff")]
    assert set(mine["results"]) == set(COMMANDS)
    assert {file for file, kind in KINDS.items() if file not in COMMANDS} == set(mine["inputs"])
    assert all(record["version"] == name for name, record in RECORDS.items())


@pytest.mark.filterwarnings("ignore:.* is of version 1")
@pytest.mark.parametrize(
    ("folder", "name", "file"), [*(("inputs", *each) for each in INPUTS), *(("results", *each) for each in RESULTS)]
)
def test_files_are_read_as_they_were(folder: str, name: str, file: str, kept: Path) -> None:
    record = RECORDS[name][folder][file]
    check(of_this_version(record["read"]), json.loads(json.dumps(READERS[record["kind"]](kept / name / folder / file))))


@pytest.mark.parametrize(("name", "file"), SHOWN)
def test_results_are_shown(name: str, file: str, kept: Path) -> None:
    assert len(call(kept / name / "results", ["show", file]).splitlines()) > 3


@pytest.mark.quick(1)
@pytest.mark.parametrize(("name", "file"), DRAWN)
def test_results_are_plotted(name: str, file: str, kept: Path, tmp_path: Path) -> None:
    call(kept / name / "results", ["plot", file, str(tmp_path)])
    pictures = list(tmp_path.rglob("*.png"))
    assert pictures
    assert all(picture.stat().st_size > 5000 for picture in pictures)


@pytest.mark.quick(1)
@pytest.mark.parametrize(("name", "file"), REPORTED)
def test_reports_are_made_of_results(name: str, file: str, kept: Path, tmp_path: Path) -> None:
    call(kept / name / "results", ["report", file, "-o", str(tmp_path / "report.html")])
    assert "</html>" in (tmp_path / "report.html").read_text(encoding="utf-8")


@pytest.mark.quick(3)
@pytest.mark.parametrize(("name", "file"), RESULTS)
def test_commands_run_on_the_inputs(name: str, file: str, kept: Path, tmp_path: Path) -> None:
    """What they find may become more accurate; it keeps its meaning, units and names."""
    record = RECORDS[name]["results"][file]
    shutil.copytree(kept / name / "inputs", tmp_path / "inputs")
    (tmp_path / "results").mkdir()
    shutil.copy(kept / name / "results/problems.nc", tmp_path / "results")
    call(tmp_path / "inputs", [*record["command"], *(["--force"] if file == "designed.toml" else [])])
    found = READERS[record["kind"]](tmp_path / "results" / file)
    if isinstance(record["read"], dict) and record["kind"] in ("result", "sweep", "dataset"):
        assert same_meaning(record["read"], found) >= 2


@pytest.mark.quick(1)
@pytest.mark.parametrize(("name", "file"), WITH_CASE)
def test_the_case_in_a_result_is_run(name: str, file: str, kept: Path, tmp_path: Path) -> None:
    """Its attribute ``case`` is the case as it was read, with supports."""
    record = RECORDS[name]["results"][file]
    with xr.open_dataset(kept / name / "results" / file, engine="netcdf4") as opened:
        text = opened.attrs["case"]
    shutil.copytree(kept / name / "inputs", tmp_path / "inputs")
    (tmp_path / "inputs/case.toml").write_text(text, encoding="utf-8")
    command, _, *words = record["command"][:-2]
    if "--supports" in words:
        del words[words.index("--supports") : words.index("--supports") + 2]
    call(tmp_path / "inputs", [command, "case.toml", *words, "-o", str(tmp_path / file)])
    assert same_meaning(record["read"], READERS[record["kind"]](tmp_path / file)) >= 2


@pytest.mark.thorough
@pytest.mark.parametrize("name", VERSIONS)
def test_worn_flanks_are_those_of_the_kept_wear(name: str, kept: Path, tmp_path: Path) -> None:
    results = kept / name / "results"
    words = [f"--deviation={member}={results / 'wear.nc'}" for member in ("pinion", "gear")]
    call(kept / name / "inputs", ["run", "spiral_bevel.toml", "--torque", "150", *words, "-o", str(tmp_path / "x.nc")])
    assert easeoff.read_result(tmp_path / "x.nc").attrs["largest_deviation_pinion_um"] > 0.0


@pytest.mark.parametrize(
    ("file", "mark", "read"),
    [("run.nc", "schema_version", easeoff.read_result), ("sweep.nc", "sweep_schema_version", read_sweep)],
)
def test_a_file_of_a_later_layout_names_the_version_that_reads_it(
    file: str, mark: str, read: Callable[[Path], Any], kept: Path, tmp_path: Path
) -> None:
    shutil.copy(kept / version("easeoff") / "results" / file, tmp_path)
    with Dataset(tmp_path / file, "a") as changed:
        changed.setncattr(mark, 2)
        changed.setncattr("easeoff_version", "9.1.0")
    with pytest.raises(InputError, match=rf"was written by easeoff 9.1.0 and this is .* {mark} = 2 is later than 1"):
        read(tmp_path / file)
