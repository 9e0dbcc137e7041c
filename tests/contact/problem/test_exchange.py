"""Exchange of contact problems through files."""

from __future__ import annotations

import time
from collections.abc import Callable
from functools import cache
from pathlib import Path
from typing import Any, Literal

import netCDF4
import numpy as np
import pytest
import xarray as xr
from runs import text_file

from easeoff import InputError
from easeoff.contact import ContactProblem, ProblemSet, export_problems, read_problems, write_problems
from easeoff.contact.problem.exchange.problem_file import joined, read_labels, set_checksum
from easeoff.contact.problem.exchange.programme_file import ProblemUnits
from easeoff.verification import problems
from easeoff.verification.problem_classes import PROBLEM_CLASSES


@cache
def ragged() -> list[ContactProblem]:
    """Problems of all classes and sizes, dense and structured."""
    return [problem for name in PROBLEM_CLASSES for problem in problems(name, 3)]


@cache
def dense() -> list[ContactProblem]:
    return list(problems("random_dense", 5))


@cache
def structured() -> list[ContactProblem]:
    return list(problems("plain", 5))


KINDS = {"mixed": ragged, "dense": dense, "structured": structured}


@pytest.mark.parametrize("kind", KINDS)
def test_problems_come_back_to_the_bit(tmp_path: Path, kind: str) -> None:
    written, path = KINDS[kind](), tmp_path / "problems.nc"
    write_problems(written, path)
    read = read_problems(path)
    assert len(read) == len(written)
    assert all(a.identical(b) for a, b in zip(read, written, strict=True))


def test_odd_numbers_survive() -> None:
    odd = np.array([5e-324, -0.0, 1.0 / 3.0, 1e300])
    problem = ContactProblem(odd, np.array([1.0, -0.0, 2.0, 1e-300]), 5e-324, np.diag(np.abs(odd)))
    assert ContactProblem.from_dataset(problem.to_dataset()).identical(problem)


def test_labels_come_back(tmp_path: Path) -> None:
    path = tmp_path / "problems.nc"
    labels = {"torque_index": np.arange(5), "mesh_position": np.linspace(0, 0.8, 5), "case": np.array(list("abcde"))}
    write_problems(dense(), path, labels)
    read = read_labels(path)
    assert set(read) == set(labels)
    assert all(np.array_equal(read[name], labels[name]) for name in labels)


def test_file_can_be_read_without_this_package(tmp_path: Path) -> None:
    path = tmp_path / "problems.nc"
    write_problems(ragged(), path)
    ds = xr.open_dataset(path, engine="netcdf4")
    for i, problem in enumerate(ragged()):
        n = int(ds["size"][i])
        separation = ds["separation"][i, :n].values
        lever_arm = ds["lever_arm"][i, :n].values
        torque = float(ds["torque"][i])
        if ds["structured"][i] == 0:
            compliance = ds["compliance"][i, :n, :n].values
        else:
            factor = ds["compliance_factor"][i, :n, : int(ds["mode_count"][i])].values
            compliance = np.diag(ds["compliance_diagonal"][i, :n].values) + factor @ factor.T
        assert np.array_equal(separation, problem.separation)
        assert np.array_equal(lever_arm, problem.lever_arm)
        assert torque == problem.torque
        assert np.allclose(compliance, problem.dense_compliance, rtol=1e-14, atol=0.0)
    ds.close()


def test_every_variable_says_its_unit_and_meaning(tmp_path: Path) -> None:
    path = tmp_path / "problems.nc"
    write_problems(ragged(), path)
    with netCDF4.Dataset(path) as file:
        assert all({"units", "long_name"} <= set(variable.ncattrs()) for variable in file.variables.values())


def test_failed_write_leaves_the_old_file_alone(tmp_path: Path) -> None:
    path = tmp_path / "problems.nc"
    write_problems(dense(), path)
    before = path.read_bytes()
    with pytest.raises(InputError, match="mesh_position"):
        write_problems(dense(), path, {"mesh_position": np.zeros(3)})
    with pytest.raises(InputError, match="torque"):
        write_problems(dense(), path, {"torque": np.zeros(5)})
    with pytest.raises(InputError, match="object"):
        write_problems(dense(), path, {"note": np.array([None] * 5)})
    with pytest.raises(InputError, match="must hold at least one"):
        write_problems([], path)
    assert path.read_bytes() == before
    assert [file.name for file in tmp_path.iterdir()] == ["problems.nc"]


def test_writing_replaces_the_file(tmp_path: Path) -> None:
    path = tmp_path / "problems.nc"
    write_problems(ragged(), path)
    write_problems(dense(), path)
    assert len(read_problems(path)) == 5
    assert [file.name for file in tmp_path.iterdir()] == ["problems.nc"]


def test_files_from_elsewhere_are_refused(tmp_path: Path) -> None:
    with pytest.raises(InputError, match="no such file"):
        read_problems(tmp_path / "missing.nc")
    text = text_file(tmp_path / "text.nc", "not a netCDF file")
    with pytest.raises(InputError, match="not a netCDF file"):
        read_problems(text)
    other = tmp_path / "other.nc"
    xr.Dataset({"a": ("x", np.zeros(3))}).to_netcdf(other, engine="netcdf4")
    with pytest.raises(InputError, match="no contact problems"):
        read_problems(other)
    foreign_format = tmp_path / "format.nc"
    dense()[0].to_dataset().assign_attrs(format="another").to_netcdf(foreign_format, engine="netcdf4")
    with pytest.raises(InputError, match="'format' is not"):
        read_labels(foreign_format)


@pytest.fixture(scope="module")
def stored(tmp_path_factory: pytest.TempPathFactory) -> dict[str, xr.Dataset]:
    """What a file of each kind of problems holds."""
    folder, found = tmp_path_factory.mktemp("stored"), {}
    for kind, written in KINDS.items():
        write_problems(written(), folder / f"{kind}.nc")
        found[kind] = xr.load_dataset(folder / f"{kind}.nc", engine="netcdf4")
    return found


@pytest.mark.usefixtures("reading_here")
@pytest.mark.parametrize(
    ("change", "word"),
    [
        (lambda ds: ds.drop_vars("lever_arm"), "incomplete"),
        (lambda ds: ds.assign(size=ds["size"] + 1000), "size of problem 0 = .*: must be a whole number"),
        (lambda ds: ds.assign(torque=-ds["torque"]), "torque"),
        (lambda ds: ds.assign(separation=ds["separation"] * np.nan), "separation"),
        (lambda ds: ds.assign_attrs(format_version=99), "version 99"),
    ],
)
def test_damaged_files_are_refused(stored: dict[str, xr.Dataset], tmp_path: Path, change: object, word: str) -> None:
    assert callable(change)
    change(stored["dense"]).to_netcdf(tmp_path / "damaged.nc", engine="netcdf4")
    with pytest.raises(InputError, match=word):
        read_problems(tmp_path / "damaged.nc")


def foreign(dataset: xr.Dataset, tmp_path: Path, change: Callable[[xr.Dataset], xr.Dataset]) -> Path:
    """A file as another program might have written it."""
    path, changed = tmp_path / "foreign.nc", change(dataset.copy())
    for variable in changed.variables.values():
        variable.encoding.clear()
    changed.to_netcdf(path, engine="netcdf4")
    return path


def without_attributes(dataset: xr.Dataset) -> xr.Dataset:
    bare = dataset.drop_attrs()
    return bare.drop_vars([name for name in ("size", "structured", "mode_count") if name in bare])


@pytest.mark.usefixtures("reading_here")
@pytest.mark.parametrize("kind", KINDS)
@pytest.mark.parametrize(
    "change",
    [
        lambda ds: ds.drop_attrs(),
        without_attributes,
        lambda ds: without_attributes(ds).transpose(),
        lambda ds: ds.assign_attrs(format_version=1).drop_vars("mode_count"),
    ],
)
def test_file_of_another_program_reads_without_what_can_be_told_from_the_numbers(
    stored: dict[str, xr.Dataset], tmp_path: Path, kind: str, change: Callable[[xr.Dataset], xr.Dataset]
) -> None:
    written, read = KINDS[kind](), read_problems(foreign(stored[kind], tmp_path, change))
    assert len(read) == len(written)
    assert all(a.identical(b) for a, b in zip(read, written, strict=True))


@pytest.mark.usefixtures("reading_here")
@pytest.mark.parametrize(
    ("change", "words"),
    [
        (lambda ds: without_attributes(ds).drop_vars("torque"), "no contact problems.*without torque"),
        (lambda ds: without_attributes(ds).drop_vars("compliance"), "without compliance"),
        (
            lambda ds: ds.assign(separation=ds["separation"].assign_attrs(units="m")),
            "units of separation = 'm': must be 'mm'",
        ),
        (
            lambda ds: ds.assign(torque=ds["torque"].assign_attrs(units="N m")),
            "units of torque = 'N m': must be 'N mm'",
        ),
        (lambda ds: ds.assign(lever_arm=ds["torque"]), r"lever_arm = array over \(problem\): must have the dimensions"),
        (lambda ds: ds.assign(compliance=-ds["compliance"]), "problem 0: compliance"),
        (
            lambda ds: ds.assign(lever_arm=ds["lever_arm"].isel(problem=[0, 1]).rename(problem="p")),
            r"lever_arm = .*: must hold 5 problems",
        ),
    ],
)
def test_what_cannot_be_told_is_asked_for_by_name(
    stored: dict[str, xr.Dataset], tmp_path: Path, change: Callable[[xr.Dataset], xr.Dataset], words: str
) -> None:
    with pytest.raises(InputError, match=words):
        read_problems(foreign(stored["dense"], tmp_path, change))


@pytest.mark.thorough
def test_thousands_of_problems_stay_exact_in_one_file(tmp_path: Path) -> None:
    written = [problem for name in ("realistic", "random_dense") for problem in problems(name, 1000)]
    start = time.process_time()
    write_problems(written, tmp_path / "many.nc")
    read = read_problems(tmp_path / "many.nc")
    assert all(a.identical(b) for a, b in zip(read, written, strict=True))
    assert time.process_time() - start < 20.0  # a second or so; a method that opens the file per problem takes minutes


@pytest.mark.usefixtures("reading_here")
@pytest.mark.parametrize("kind", ["dense", "structured"])
def test_single_problem_needs_no_dimension_of_the_problem(tmp_path: Path, kind: str) -> None:
    problem = next(problems("random_dense" if kind == "dense" else "plain", 1))
    dataset = problem.to_dataset().assign_coords(mesh_position=0.25)
    for name, changed in {"own": dataset, "bare": dataset.drop_attrs().transpose()}.items():
        path = tmp_path / f"{name}.nc"
        changed.to_netcdf(path, engine="netcdf4")
        (read,) = read_problems(path)
        assert read.identical(problem)
        assert read_labels(path) == {"mesh_position": [0.25]}


def by_hand(
    path: Path,
    written: list[ContactProblem],
    *,
    dims: tuple[str, str, str] = ("problem", "segment", "segment_other"),
    unlimited: bool = False,
    number: str = "f8",
    fill: float | None = None,
    model: Literal["NETCDF4", "NETCDF3_CLASSIC"] = "NETCDF4",
) -> Path:
    """A file of dense problems made with netCDF4 alone, wider than the widest, nothing written behind the segments."""
    with netCDF4.Dataset(path, "w", format=model) as file:
        width = max(problem.size for problem in written) + 2
        for name, length in dict(zip(dims, (len(written), width, width), strict=True)).items():
            file.createDimension(name, None if unlimited else length)
        for name, many in (("separation", 2), ("lever_arm", 2), ("torque", 1), ("compliance", 3)):
            variable = file.createVariable(name, number, dims[:many], fill_value=fill)
            for i, problem in enumerate(written):
                value = problem.dense_compliance if name == "compliance" else getattr(problem, name)
                variable[(i, *(slice(0, problem.size) for _ in range(many - 1)))] = value
    return path


@pytest.mark.usefixtures("reading_here")
@pytest.mark.filterwarnings("ignore:Duplicate dimension names")
@pytest.mark.parametrize(
    "style",
    [
        {},  # netCDF's own fill value where nothing is written
        {"fill": np.nan},
        {"fill": -999.0},
        {"unlimited": True},
        {"dims": ("case", "i", "j")},
        {"dims": ("problem", "segment", "segment"), "fill": np.nan},
        {"model": "NETCDF3_CLASSIC"},
    ],
)
def test_file_made_by_other_habits_is_read(tmp_path: Path, style: dict[str, Any]) -> None:
    read = read_problems(by_hand(tmp_path / "other.nc", dense(), **style))
    assert all(a.identical(b) for a, b in zip(read, dense(), strict=True))


@pytest.mark.parametrize("fill", [None, np.nan])
def test_single_precision_is_read_as_it_is(tmp_path: Path, fill: float | None) -> None:
    read = read_problems(by_hand(tmp_path / "other.nc", dense(), number="f4", fill=fill))
    for a, b in zip(read, dense(), strict=True):
        assert a.size == b.size
        assert np.array_equal(a.separation, b.separation.astype(np.float32))
        np.testing.assert_allclose(a.dense_compliance, b.dense_compliance, rtol=1e-6)


def test_what_does_not_belong_to_the_problems_is_left_alone(tmp_path: Path) -> None:
    path = by_hand(tmp_path / "other.nc", dense())
    with netCDF4.Dataset(path, "a") as file:
        file.createDimension("x", 3)
        file.createVariable("curve", "f8", ("x",))[:] = 1.0
        file.createVariable("scalar", "f8", ())[...] = 2.0
        file.createVariable("map", "f8", ("problem", "x"))[:] = 2.0
        note = file.createVariable("note", str, ("problem",))
        for i in range(5):
            note[i] = f"number {i}"
        packed = file.createVariable("load", "i2", ("problem",))
        packed.setncatts({"scale_factor": 0.5, "units": "kN"})
        packed[:] = np.arange(5) * 0.5
    assert len(read_problems(path)) == 5
    labels = read_labels(path)
    assert set(labels) == {"note", "load"}
    assert labels["note"].tolist() == [f"number {i}" for i in range(5)]
    assert labels["load"].tolist() == [0.0, 0.5, 1.0, 1.5, 2.0]


@pytest.mark.usefixtures("reading_here")
@pytest.mark.parametrize(
    ("name", "units"),
    [("compliance", "mm N-1"), ("compliance", "mm / N"), ("torque", "N*mm"), ("torque", "N.mm"), ("lever_arm", "mm")],
)
def test_units_may_be_spelt_otherwise(tmp_path: Path, name: str, units: str) -> None:
    path = by_hand(tmp_path / "other.nc", dense())
    with netCDF4.Dataset(path, "a") as file:
        file[name].units = units
    assert len(read_problems(path)) == 5


@pytest.mark.parametrize("version", ["1", 1.0, np.int16(1)])
def test_version_may_be_any_kind_of_number(tmp_path: Path, version: Any) -> None:
    path = by_hand(tmp_path / "other.nc", dense())
    with netCDF4.Dataset(path, "a") as file:
        file.format_version = version
    assert len(read_problems(path)) == 5


@pytest.mark.usefixtures("reading_here")
@pytest.mark.parametrize(
    ("change", "words"),
    [
        (
            lambda ds: ds.assign(mode_count=ds["mode_count"] + 100),
            r"mode_count of problem 0 = 1\d+: must be a whole number",
        ),
        (lambda ds: ds.assign(mode_count=-ds["mode_count"]), "mode_count of problem 0 = -"),
        (lambda ds: ds.assign(size=ds["size"] + 0.5), r"size of problem 0 = \d+\.5: must be a whole number"),
        (lambda ds: ds.assign(size=ds["size"] * np.nan), "size of problem 0 = nan"),
        (lambda ds: ds.assign(size=ds["size"] * 0), "size of problem 0 = 0"),
        (lambda ds: ds.assign(structured=ds["structured"] + 6), "structured of problem 0 = 7"),
        (
            lambda ds: ds.assign(structured=ds["structured"] * 0),
            r"structured of problem 0 = 0: must go with .* compliance",
        ),
        (lambda ds: ds.assign(torque=ds["torque"].astype(str)), r"torque = array of .*: must hold numbers"),
        (lambda ds: ds.assign(torque=ds["torque"] * np.nan), "problem 0: torque"),
        (lambda ds: ds.assign_attrs(format_version="two"), "format version 'two'"),
        (lambda ds: ds.assign_attrs(format_version=[1, 2]), "format version"),
        (lambda ds: ds.assign_attrs(format=[1, 2]), "'format' is not"),
    ],
)
def test_file_that_contradicts_itself_is_refused_in_words(
    stored: dict[str, xr.Dataset], tmp_path: Path, change: Callable[[xr.Dataset], xr.Dataset], words: str
) -> None:
    with pytest.raises(InputError, match=words):
        read_problems(foreign(stored["structured"], tmp_path, change))


@pytest.mark.parametrize("wrong", ["swapped", "single", "mixed"])
def test_what_is_no_list_of_problems_is_refused_by_name(tmp_path: Path, wrong: str) -> None:
    springs = ContactProblem([0.0, 0.0], [40.0, 40.0], 8.0e4, [[1e-6, 0.0], [0.0, 1e-6]])
    target = tmp_path / "own.nc"
    given: Any = {"swapped": str(target), "single": springs, "mixed": [springs, 1.0]}[wrong]
    for write in (write_problems, export_problems):
        path: Any = [springs] if wrong == "swapped" else target
        with pytest.raises(InputError, match=r"^problems(\[1\])? = .*: must be a "):
            write(given, path)
    assert not target.exists()


def test_joined_sets_keep_the_labels_that_all_have() -> None:
    one = ProblemSet(dense()[:1], {"name": np.array(["springs"]), "step": np.array([0])})
    both = joined([one, ProblemSet(dense()[:1], {"name": np.array(["again"])})])
    assert {name: labels.tolist() for name, labels in both.labels.items()} == {"name": ["springs", "again"]}


def test_checksum_of_a_set_depends_on_the_names() -> None:
    assert set_checksum(["one"], dense()[:1]) != set_checksum(["two"], dense()[:1])


def test_unit_of_rotations_follows_from_the_others() -> None:
    assert ProblemUnits(force=8.0, compliance=2.0**-20, lever_arm=32.0).rotation == 2.0**-22
