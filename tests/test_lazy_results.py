"""Results that xarray keeps in a file or as work to be done, and threads that read, write and analyse at once."""

from __future__ import annotations

import threading
from collections.abc import Callable, Iterator
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path
from typing import Any

import pytest
import xarray as xr
from runs import analysed, small

import easeoff
from easeoff import InputError, study
from easeoff.study import plot
from easeoff.study.sweep import percentiles, read_sweep, worst_points, write_sweep


@pytest.fixture(scope="module")
def stored(tmp_path_factory: pytest.TempPathFactory) -> Path:
    path = tmp_path_factory.mktemp("stored") / "result.nc"
    easeoff.write_result(analysed(torques=[50.0, 100.0], speed=[500.0, 1500.0]), path)
    return path


@pytest.fixture
def chunked(stored: Path) -> Iterator[xr.DataTree]:
    with xr.open_datatree(stored, chunks={}) as tree:
        yield tree


@pytest.fixture(scope="module")
def sweep() -> xr.Dataset:
    return easeoff.sweep(small(compliance="shell"), {"E": [0.0, 0.02]}, torques=[100.0])


def written(tree: xr.DataTree, folder: Path) -> xr.DataTree:
    easeoff.write_result(tree, folder / "again.nc")
    return easeoff.read_result(folder / "again.nc")


def saved(tree: xr.DataTree, folder: Path) -> xr.DataTree:
    tree.easeoff.save(folder / "again.nc")
    return easeoff.read_result(folder / "again.nc")


def reported(tree: xr.DataTree, folder: Path) -> str:
    tree.easeoff.report(folder / "report.html")
    return (folder / "report.html").read_text(encoding="utf-8")


def sweep_again(found: xr.Dataset, folder: Path) -> xr.Dataset:
    write_sweep(found, folder / "again.nc")
    return read_sweep(folder / "again.nc")


def same(mine: Any, other: Any) -> bool:
    return bool(mine.identical(other) if isinstance(mine, xr.DataTree | xr.Dataset) else mine == other)


@pytest.mark.parametrize(
    "take",
    [
        lambda tree, _: str(tree.easeoff.summary()),
        lambda tree, _: tree.easeoff.summary()._repr_html_(),
        lambda tree, _: [table.to_html() for table in tree.easeoff.summary().tables.values()],
        lambda tree, _: study.key_numbers(tree),
        lambda tree, _: study.plausibility(tree),
        lambda tree, folder: [
            path.read_bytes() for path in plot.write_pictures(tree, folder, names="pressure", torque=50.0)
        ],
        written,
        saved,
        reported,
    ],
)
def test_a_chunked_result_is_taken_as_one_in_memory(
    chunked: xr.DataTree, stored: Path, tmp_path: Path, take: Callable[[xr.DataTree, Path], Any]
) -> None:
    assert same(take(chunked, tmp_path), take(easeoff.read_result(stored), tmp_path))


@pytest.mark.parametrize(
    "take",
    [
        lambda found, _: percentiles(found, [50.0], ["peak_to_peak"]),
        lambda found, _: worst_points(found, "peak_to_peak", 1),
        lambda found, _: str(found.easeoff.summary()),
        sweep_again,
    ],
)
def test_a_chunked_sweep_is_taken_as_one_in_memory(
    sweep: xr.Dataset, tmp_path: Path, take: Callable[[xr.Dataset, Path], Any]
) -> None:
    assert same(take(sweep.chunk(), tmp_path), take(sweep, tmp_path))


@pytest.mark.parametrize("chunks", [None, {}])
def test_a_lazy_result_replaces_its_own_file(stored: Path, tmp_path: Path, chunks: dict[str, int] | None) -> None:
    path, wanted = tmp_path / "own.nc", easeoff.read_result(stored)
    easeoff.write_result(wanted, path)
    with xr.open_datatree(path, chunks=chunks) as lazy:
        easeoff.write_result(lazy, path)
    assert easeoff.read_result(path).identical(wanted)


def test_nothing_that_was_read_is_left_in_the_file(tmp_path: Path) -> None:
    """Not even the ease-off, whose group is called as it is."""
    wanted, path = analysed(torques=[50.0]), tmp_path / "result.nc"
    easeoff.write_result(wanted, path)
    found = easeoff.read_result(path)
    path.unlink()
    assert found.identical(wanted)


def test_values_that_are_gone_are_asked_for_and_no_file_is_left(stored: Path, tmp_path: Path) -> None:
    path = tmp_path / "gone.nc"
    easeoff.write_result(easeoff.read_result(stored), path)
    with xr.open_datatree(path) as lazy:
        path.unlink()
    for take in (written, lambda tree, _: study.result_summary(tree)):
        with pytest.raises(
            InputError, match="cannot be read any more: No such file or directory; open it again, call load"
        ):
            take(lazy, tmp_path)
    assert list(tmp_path.iterdir()) == []


def in_pool(work: Callable[[int], bool]) -> list[bool]:
    with ThreadPoolExecutor(8) as pool:
        return list(pool.map(work, range(8)))


def by_dask(work: Callable[[int], bool]) -> list[bool]:
    dask: Any = pytest.importorskip("dask")
    with dask.config.set(scheduler="threads", num_workers=8):
        return list(dask.compute(*(dask.delayed(work)(number) for number in range(8))))


@pytest.mark.parametrize("start", [in_pool, pytest.param(by_dask, marks=pytest.mark.thorough)])
def test_threads_read_write_and_analyse_at_once(
    stored: Path, tmp_path: Path, start: Callable[[Callable[[int], bool]], list[bool]]
) -> None:
    """Beside one that computes an array from a file which xarray opened."""
    wanted, ended = easeoff.read_result(stored), threading.Event()

    def computing() -> None:
        with xr.open_dataset(stored, group="loaded", chunks={}) as lazy:
            while not ended.is_set():
                lazy["force"].sum().compute(scheduler="synchronous")

    def work(number: int) -> bool:
        if number % 4 == 0:
            return easeoff.analyze(small(compliance="shell"), torques=[50.0])["loaded"].sizes["torque"] == 1
        path = stored
        if number % 4 == 1:
            path = tmp_path / f"{number}.nc"
            easeoff.write_result(wanted, path)
        return easeoff.read_result(path).identical(wanted)

    beside = threading.Thread(target=computing)
    beside.start()
    try:
        assert start(work) == [True] * 8
    finally:
        ended.set()
        beside.join()
