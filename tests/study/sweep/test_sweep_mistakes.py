"""Sweeps asked for wrongly, or whose files are damaged: one message and nothing left, or the right result."""

from __future__ import annotations

import json
import shutil
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import xarray as xr
from runs import call, output_of, refusal_of, text_file
from sweeps import CASE, SETTING, analyse_points_once, case_file

from easeoff import InputError, plot
from easeoff.cases import read_load_cases
from easeoff.core.checkpoint import digest
from easeoff.core.output_file import private_folder
from easeoff.study import key_numbers
from easeoff.study.analysis.case_analysis import analyze
from easeoff.study.analysis.key_numbers import number_names
from easeoff.study.analysis.operating import Operating
from easeoff.study.sweep import percentiles, read_sweep, sensitivities, sweep
from easeoff.study.sweep.batch_analysis import _bounds
from easeoff.study.sweep.parameter_sweep import batch_store, run_plan
from easeoff.study.sweep.reductions import numbers
from easeoff.study.sweep.sweep_file import PointStatus, checked_sweep, sweep_faults, write_sweep
from easeoff.study.sweep.sweep_plan import file_digest, planned_sweep

THREE = {"E": [0.0, 0.04, 0.08]}
SECRET = "kept-to-itself"


@pytest.fixture
def points_once(monkeypatch: pytest.MonkeyPatch) -> None:
    """Points of another test are not analysed again."""
    analyse_points_once(monkeypatch)


@pytest.fixture
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """The working folder, with a case in it."""
    (tmp_path / "work").mkdir()
    (tmp_path / "secret.toml").write_text(f"{SECRET} = 1\n[{SECRET}\n", encoding="utf-8")
    monkeypatch.chdir(tmp_path / "work")
    case_file(tmp_path / "work")
    return tmp_path / "work"


#: A sweep of the case of the folder into ``out.nc``.
SWEEP = ("sweep", "case.toml", "-o", "out.nc", "--torque", "100", "--workers", "1")


def names(folder: Path) -> list[str]:
    return sorted(path.name for path in folder.iterdir())


@pytest.mark.parametrize(
    ("over", "given", "reduced"),
    [
        ({"torque": [100.0, 50.0, 200.0]}, {}, "peak_to_peak"),
        ({"speed": [500.0, 900.0]}, {"torques": 99.0}, "efficiency"),
    ],
)
def test_a_sweep_over_loads_alone_is_shown_and_drawn(
    over: dict[str, Any], given: dict[str, Any], reduced: str, tmp_path: Path
) -> None:
    found = sweep(CASE, over, workers=1, edge_contact=False, **given)
    name = next(iter(over))
    assert set(found["status"].dims) == {"torque"}
    assert (found["status"] == PointStatus.CERTIFIED).all()
    tree = analyze(CASE, torques=over.get("torque", 99.0), speed=over.get("speed"), edge_contact=False)
    np.testing.assert_array_equal(found[reduced].values, key_numbers(tree)[reduced].values)
    values = found[reduced].values.ravel()
    assert percentiles(found, [0.0, 100.0], [reduced])[reduced].values.ravel().tolist() == [values.min(), values.max()]
    write_sweep(found, tmp_path / "out.nc")
    said = output_of("show", tmp_path / "out.nc")
    assert f"\n{reduced}" in said
    assert plot.pictures(found) == ("sweep_curves", "sweep_pattern")
    for picture in ("curves", "pattern"):
        plot.sweep(found, picture).draw_without_rendering()
    assert name in said


@pytest.mark.parametrize(
    ("words", "wanted"),
    [
        (["--over", "E=inf:1:3"], "E = inf: must be a number above -10"),
        (["--over", "E=nan:1:3"], "E = nan: must be a number above -10"),
        (["--over", "E=-inf:inf:3"], "E = -inf: must be a number above -10"),
        (["--over", "flank=drive,left"], "flank = 'left': must be one of drive, coast"),
        (["--over", "oil=75w90,none", "--speed", "500"], "oil = 'none': neither one of"),
        (["--over", "deviation.gear=fm-11x41-worn-gear,no.csv"], "no.csv: there is no such file"),
        (["--over", "deviation.gear=/dev/zero"], "is a device or a pipe"),
        (["--over", "E=0.1", "--deviation", "gear=nothing"], "deviation 'nothing': there is no such file"),
        (["--over", "E=0.1", "--deviation", "gear=/dev/zero"], "/dev/zero"),
        (["--over", "E=0.1", "--deviation", "gear=fm-11x41-worn-gear"], "nominal points"),
        (["--over", "E=0.1", "--keep", "worst=nothing:1"], "--keep = 'worst=nothing:1': must name one of"),
        (["--over", "E=0.1", "--keep", "least=efficiency:1"], "must name one of"),
        (["--over", "E=0.1", "--store", "./out.nc"], "--store = 'out.nc': must be another name"),
        (["--over", "E=0.1", "--plots", "out.nc/"], "--plots = 'out.nc': must be another name"),
        (["--over", "torque=50,100"], "must be left out, as torque is swept"),
        (["--over", "speed=500,900", "--speed", "700"], "must be left out, as speed is swept"),
        (
            ["--over", "oil=75w90", "--speed", "500", "--oil", "75w90"],
            "oil = '75w90': must be left out, as oil is swept",
        ),
    ],
)
def test_a_mistake_shows_before_the_work_and_leaves_nothing(words: list[str], wanted: str, folder: Path) -> None:
    assert wanted in refusal_of(*SWEEP, *words)
    assert names(folder) == ["case.toml"]


@pytest.mark.parametrize("command", ["run", "vh"])
def test_pictures_have_another_name_than_the_file(command: str, folder: Path) -> None:
    said = refusal_of(command, "case.toml", "-o", "out.nc", "--plots", "out.nc")
    assert "--plots = 'out.nc': must be another name" in said
    assert names(folder) == ["case.toml"]


def test_a_device_has_no_digest() -> None:
    assert file_digest("/dev/zero") == ""


def test_a_scheduler_is_asked_before_the_work(folder: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Also for so few points that it would get none of them."""
    pytest.importorskip("distributed")
    from easeoff.study.sweep import engine

    monkeypatch.setattr(engine, "CONNECTION_TIME_LIMIT", 0.2)
    said = refusal_of(*SWEEP, "--over", "E=0.1", "--scheduler", "tcp://127.0.0.1:1")
    assert "must be the address of a dask scheduler that runs" in said
    assert names(folder) == ["case.toml"]


def test_without_a_number_there_are_no_pictures(folder: Path) -> None:
    found = call(*SWEEP, "--over", f"{SETTING}=10000", "--plots", "pictures", "--keep", "worst=max_pressure:1")
    assert found.exit_code == 1, found.output
    assert "no point has numbers: there are no pictures" in found.output
    assert names(folder) == ["case.toml", "out.nc"]


def test_a_table_of_load_cases_opens_no_file_outside_its_folder(folder: Path) -> None:
    for head in ("torque,speed,oil", "torque,speed,deviation.gear"):
        Path("duty.csv").write_text(f"{head}\n100,500,../secret.toml\n", encoding="utf-8")
        words = ["sweep", "case.toml", "-o", "out.nc", "--load-cases", "duty.csv", "--workers", "1"]
        said = refusal_of(*words)
        assert SECRET not in said
        assert "inside the folder of the table; if you trust the table, --allow-outside" in said
        assert names(folder) == ["case.toml", "duty.csv"]
        assert "inside the folder" not in call(*words, "--allow-outside").output
        for left in folder.glob("out.nc*"):
            left.unlink()
    Path("duty.csv").write_text("torque,speed,oil\n100,500,75w90\n", encoding="utf-8")
    output_of(*words)


def test_one_table_is_read_by_an_analysis_and_by_a_sweep(tmp_path: Path) -> None:
    table = text_file(
        tmp_path / "duty.csv", '"torque"\tname\tE\tshare\n"100,5"\tcruise\t0,05\t2\n# low\n50\tclimb\t-0,01\t1\n'
    )
    rows = read_load_cases(table)
    found = sweep(CASE, load_cases=table, workers=1)
    for name in ("torque", "name", "E", "share"):
        assert found[name].values.tolist() == [getattr(row, name) for row in rows]


def recorded(store: Path, bounds: list[int]) -> None:
    """Record other bounds of the batches than those of their files."""
    plan = json.loads((store / "sweep.json").read_text(encoding="utf-8"))
    del plan["own_digest"]
    plan["bounds"] = bounds
    (store / "sweep.json").write_text(json.dumps(plan | {"own_digest": digest(**plan)}), encoding="utf-8")


@pytest.fixture(scope="module")
def kept(tmp_path_factory: pytest.TempPathFactory) -> tuple[Path, xr.Dataset]:
    """A store of three batches, and their sweep."""
    store = tmp_path_factory.mktemp("kept") / "store"
    return store, sweep(CASE, THREE, torques=[100.0], workers=1, store=store)


def divided(kept: tuple[Path, xr.Dataset], bounds: list[int], folder: Path) -> None:
    """Go on from a copy of the store with other bounds; the result is the same to the bit."""
    store = shutil.copytree(kept[0], folder / "store")
    recorded(store, bounds)
    again = sweep(CASE, THREE, torques=[100.0], workers=1, store=store)
    assert again.drop_attrs(deep=False).identical(kept[1].drop_attrs(deep=False))


@pytest.mark.usefixtures("points_once")
@pytest.mark.parametrize("bounds", [[0, 2], [0, 2, 3], [0, 1, 2, 9]])
def test_batches_divided_otherwise_are_not_taken_for_others(
    bounds: list[int], kept: tuple[Path, xr.Dataset], tmp_path: Path
) -> None:
    """As two runs of one sweep at the same time may leave them."""
    divided(kept, bounds, tmp_path)


@pytest.mark.parametrize("bounds", [[0, 1, 2, 9], [0, 1, 5], [], [1, 2], [0, True, 3], [0, 2, 1], "0", None])
def test_bounds_that_do_not_rise_from_the_first_point_to_the_last_are_not_taken(bounds: Any) -> None:
    assert _bounds({"bounds": bounds}, 3) is None
    for rising in ([0], [0, 2], [0, 2, 3]):
        assert _bounds({"bounds": rising}, 3) == rising


def test_points_in_one_batch_have_the_numbers_of_three(kept: tuple[Path, xr.Dataset], tmp_path: Path) -> None:
    divided(kept, [0, 3], tmp_path)


@pytest.mark.usefixtures("points_once")
def test_a_folder_in_place_of_a_batch_is_refused_before_the_work(folder: Path) -> None:
    words = ["--over", "E=0,0.04,0.08", "--store", "store"]
    output_of(*SWEEP, *words)
    for name in ("batch-000001.npz", "batch-000002.npz"):
        (folder / "store" / name).unlink()
    (folder / "store" / "batch-000002.npz").mkdir()
    before = names(folder / "store")
    assert "batch-000002.npz is a folder: remove it" in refusal_of(*SWEEP, *words)
    assert names(folder / "store") == before
    output_of(*SWEEP, *words, "--fresh")


def test_a_map_of_batches_that_is_a_link_is_refused_before_the_work(folder: Path) -> None:
    (folder / "store").mkdir()
    (folder / "store" / "batches.jsonl").symlink_to("nowhere")
    assert "batches.jsonl is a link" in refusal_of(*SWEEP, "--over", "E=0,0.04", "--store", "store")
    assert names(folder / "store") == ["batches.jsonl"]


@pytest.mark.usefixtures("points_once")
def test_a_sweep_that_cannot_write_says_where_its_batches_are(folder: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    import easeoff.study.sweep.sweep_file as package

    def full(_dataset: xr.Dataset, path: Path) -> None:
        raise InputError(f"{path} cannot be written: no space left on device")

    with monkeypatch.context() as patch:
        patch.setattr(package, "write_sweep", full)
        said = refusal_of(*SWEEP, "--over", "E=0,0.04")
    assert "the batches so far are kept in out.nc.batches; the same command goes on from them" in said
    output_of(*SWEEP, "--over", "E=0,0.04")
    assert names(folder) == ["case.toml", "out.nc"]


@pytest.mark.usefixtures("points_once")
def test_batches_are_removed_but_not_what_another_run_writes(tmp_path: Path) -> None:
    plan = planned_sweep(CASE, {"E": [0.0]}, Operating(torques=[100.0]))
    run_plan(plan, workers=1, store=tmp_path / "store")
    with private_folder(tmp_path / "store") as other:
        batch_store(plan, tmp_path / "store").remove()
        assert names(tmp_path / "store") == [other.name]
        assert other.is_dir()
    batch_store(plan, tmp_path / "store").remove()
    assert names(tmp_path) == []


def test_samples_that_are_all_alike_have_no_sensitivity() -> None:
    rng = np.random.default_rng(2)
    e = rng.normal(0.0, 1.0, 20)
    y = xr.DataArray(3.0 * e + 1.0, dims="sample")
    status = xr.zeros_like(y, dtype=np.int8)
    coords = {"E": ("sample", e), "P": ("sample", np.full(20, 0.1))}
    dataset = xr.Dataset({"y": y, "status": status}, coords=coords, attrs={"swept": '["E", "P"]'})
    found = sensitivities(dataset, "y")
    np.testing.assert_allclose(found["slope"], [3.0, np.nan], rtol=1e-12)
    np.testing.assert_allclose(found["variance_share"], [1.0, np.nan], rtol=1e-12)


@pytest.fixture(scope="module")
def whole() -> xr.Dataset:
    """As much of a sweep as its file must have."""
    found = sweep(CASE, {"E": [0.0, 0.05]}, torques=[100.0, 200.0], workers=1)
    return found[["status", "reason", "rms", "max_pressure", "max_pressure_line_end"]]


CHANGES: dict[str, Callable[[xr.Dataset], xr.Dataset]] = {
    "no status": lambda d: d.drop_vars("status"),
    "wild status": lambda d: d.assign(status=d["status"] + 7),
    "status of reals": lambda d: d.assign(status=d["status"].astype(float)),
    "other status": lambda d: d.assign(status=d["status"].isel(E=0, drop=True)),
    "no reason": lambda d: d.drop_vars("reason"),
    "reason of numbers": lambda d: d.assign(reason=d["status"]),
    "no coordinate": lambda d: d.drop_vars("E"),
    "wild coordinate": lambda d: d.assign_coords(E=[0.0, np.nan]),
    "equal coordinates": lambda d: d.assign_coords(E=[0.0, 0.0]),
    "torque of texts": lambda d: d.assign_coords(torque=["a", "b"]),
    "other name of a dimension": lambda d: d.rename(torque="position"),
    "number over another dimension": lambda d: d.assign(rms=d["rms"].expand_dims(x=2)),
    "number of texts": lambda d: d.assign(rms=d["reason"]),
    "huge number": lambda d: d.assign(rms=d["rms"] + 1e300),
    "swept no list": lambda d: d.assign_attrs(swept="3"),
    "swept no text": lambda d: d.assign_attrs(swept=3),
    "no teeth": lambda d: d.assign_attrs(gear_teeth="many"),
    "no title": lambda d: d.assign_attrs(title=1),
    "units of numbers": lambda d: d.assign(rms=d["rms"].assign_attrs(units=[1.0, 2.0])),
}


def test_a_file_of_a_sweep_that_lacks_nothing_is_shown(whole: xr.Dataset, folder: Path) -> None:
    write_sweep(whole, "r.nc")
    output_of("show", "r.nc")
    assert read_sweep("r.nc").identical(whole)
    assert names(folder) == ["case.toml", "r.nc"]


@pytest.mark.parametrize("change", CHANGES)
def test_a_file_of_a_sweep_that_lacks_something_is_refused(change: str, whole: xr.Dataset, tmp_path: Path) -> None:
    file = tmp_path / "r.nc"
    write_sweep(CHANGES[change](whole), file)
    with (
        xr.open_dataset(file, engine="netcdf4") as stored,
        pytest.raises(InputError, match="is damaged, changed by hand or made by another version of easeoff"),
    ):
        checked_sweep(stored.load(), file)


def test_faults_of_a_sweep_are_phrases(whole: xr.Dataset) -> None:
    assert sweep_faults(whole) == []
    assert sweep_faults(whole.drop_vars("status")) == ["no whole numbers 'status' from 0 to 4"]


def test_every_reader_of_a_sweep_refuses_what_lacks_something(whole: xr.Dataset, folder: Path) -> None:
    write_sweep(CHANGES["no coordinate"](whole), "r.nc")
    for words in (["show", "r.nc"], ["plot", "r.nc", "pictures"]):
        said = refusal_of(*words)
        assert "r.nc is damaged, changed by hand or made by another version of easeoff" in said
        assert "Traceback" not in said
    with pytest.raises(InputError, match="is damaged"):
        read_sweep("r.nc")
    assert names(folder) == ["case.toml", "r.nc"]


@pytest.mark.parametrize("friction", [False, True])
def test_names_of_numbers_are_those_of_a_sweep(friction: bool) -> None:
    found = sweep(CASE, {"E": [0.0]}, torques=[100.0], speed=500.0 if friction else None, workers=1)
    own = {
        name for name in numbers(found) if found[name].dims[-1:] not in (("temperature",), ("roughness",)) or friction
    }
    own -= {"viscosity", "pressure_viscosity", "temperature_clamped", "bulk_temperature"}
    own -= {"roughness_pinion", "roughness_gear"}
    assert own <= set(number_names(friction=friction)) <= own | {"max_root_stress", "max_edge_share"}


def test_a_path_that_begins_with_a_tilde_is_a_path(folder: Path) -> None:
    """And not one in the home folder, as a library takes it."""
    Path("~").mkdir()
    output_of("run", "case.toml", "-o", "~/r.nc", "--torque", "100")
    assert names(folder / "~") == ["r.nc"]
