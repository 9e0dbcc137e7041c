"""Exchange of contact problems through files."""

from __future__ import annotations

import time
from collections.abc import Callable
from pathlib import Path

import netCDF4
import numpy as np
import pytest
import xarray as xr

from easeoff.contact.exchange import read_labels, read_problems, write_problems
from easeoff.contact.problem import ContactProblem
from easeoff.contact.solvers.problem_classes import PROBLEM_CLASSES, problems
from easeoff.core.errors import InputError


def ragged() -> list[ContactProblem]:
    """Problems of all classes and sizes, dense and structured."""
    return [problem for name in PROBLEM_CLASSES for problem in problems(name, 3)]


def dense() -> list[ContactProblem]:
    return list(problems("random_dense", 5))


@pytest.mark.parametrize("kind", ["mixed", "dense", "structured"])
def test_problems_come_back_to_the_bit(tmp_path: Path, kind: str) -> None:
    written = {"mixed": ragged(), "dense": dense(), "structured": list(problems("plain", 5))}[kind]
    path = tmp_path / "problems.nc"
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
    with pytest.raises(InputError, match="no contact problems"):
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
    text = tmp_path / "text.nc"
    text.write_text("not a netCDF file")
    with pytest.raises(InputError, match="not a netCDF file"):
        read_problems(text)
    other = tmp_path / "other.nc"
    xr.Dataset({"a": ("x", np.zeros(3))}).to_netcdf(other, engine="netcdf4")
    with pytest.raises(InputError, match="no contact problems"):
        read_problems(other)
    single = tmp_path / "single.nc"
    dense()[0].to_dataset().to_netcdf(single, engine="netcdf4")
    with pytest.raises(InputError, match="format"):
        read_labels(single)


@pytest.mark.parametrize(
    ("change", "word"),
    [
        (lambda ds: ds.drop_vars("lever_arm"), "incomplete"),
        (lambda ds: ds.assign(size=ds["size"] + 1000), "segments"),
        (lambda ds: ds.assign(torque=-ds["torque"]), "torque"),
        (lambda ds: ds.assign(separation=ds["separation"] * np.nan), "separation"),
        (lambda ds: ds.assign_attrs(format_version=99), "version 99"),
    ],
)
def test_damaged_files_are_refused(tmp_path: Path, change: object, word: str) -> None:
    path, damaged = tmp_path / "problems.nc", tmp_path / "damaged.nc"
    write_problems(dense(), path)
    assert callable(change)
    with xr.open_dataset(path, engine="netcdf4") as dataset:
        change(dataset.load()).to_netcdf(damaged, engine="netcdf4")
    with pytest.raises(InputError, match=word):
        read_problems(damaged)


def foreign(written: list[ContactProblem], tmp_path: Path, change: Callable[[xr.Dataset], xr.Dataset]) -> Path:
    """A file as another program might have written it."""
    path, other = tmp_path / "problems.nc", tmp_path / "foreign.nc"
    write_problems(written, path)
    with xr.open_dataset(path, engine="netcdf4") as dataset:
        changed = change(dataset.load())
        for variable in changed.variables.values():
            variable.encoding.clear()
        changed.to_netcdf(other, engine="netcdf4")
    return other


def without_attributes(dataset: xr.Dataset) -> xr.Dataset:
    bare = dataset.drop_attrs()
    return bare.drop_vars([name for name in ("size", "structured", "mode_count") if name in bare])


@pytest.mark.parametrize("kind", ["mixed", "dense", "structured"])
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
    tmp_path: Path, kind: str, change: Callable[[xr.Dataset], xr.Dataset]
) -> None:
    written = {"mixed": ragged(), "dense": dense(), "structured": list(problems("plain", 5))}[kind]
    read = read_problems(foreign(written, tmp_path, change))
    assert len(read) == len(written)
    assert all(a.identical(b) for a, b in zip(read, written, strict=True))


@pytest.mark.parametrize(
    ("change", "words"),
    [
        (lambda ds: without_attributes(ds).drop_vars("torque"), "no contact problems.*without torque"),
        (lambda ds: without_attributes(ds).drop_vars("compliance"), "without compliance"),
        (lambda ds: ds.assign(separation=ds["separation"].assign_attrs(units="m")), "separation is in 'm'.*'mm'"),
        (lambda ds: ds.assign(torque=ds["torque"].assign_attrs(units="N m")), "torque is in 'N m'.*'N mm'"),
        (lambda ds: ds.assign(lever_arm=ds["torque"]), r"lever_arm has the dimensions \(problem\)"),
        (lambda ds: ds.assign(compliance=-ds["compliance"]), "problem 0: compliance"),
        (lambda ds: ds.assign(lever_arm=ds["lever_arm"].isel(problem=[0, 1]).rename(problem="p")), "2 problems"),
    ],
)
def test_what_cannot_be_told_is_asked_for_by_name(
    tmp_path: Path, change: Callable[[xr.Dataset], xr.Dataset], words: str
) -> None:
    with pytest.raises(InputError, match=words):
        read_problems(foreign(dense(), tmp_path, change))


def test_thousands_of_problems_stay_exact_in_one_file(tmp_path: Path) -> None:
    written = [problem for name in ("realistic", "random_dense") for problem in problems(name, 1000)]
    start = time.process_time()
    write_problems(written, tmp_path / "many.nc")
    read = read_problems(tmp_path / "many.nc")
    assert all(a.identical(b) for a, b in zip(read, written, strict=True))
    assert time.process_time() - start < 20.0  # a second or so; a method that opens the file per problem takes minutes
