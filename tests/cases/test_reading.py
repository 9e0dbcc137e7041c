"""Reading: in a process of its own, of what xarray keeps in a file, and in threads that write and analyse at once."""

from __future__ import annotations

import os
import resource
import shutil
import signal
import threading
import warnings
from collections.abc import Callable, Iterator
from concurrent.futures import ThreadPoolExecutor
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import xarray as xr
from runs import call, read_only, small

import easeoff
from easeoff import InputError, study
from easeoff.cases import gear_pair
from easeoff.core import forked_process, netcdf_file
from easeoff.core.forked_process import ProcessEndedError, in_forked_process
from easeoff.geometry.formats import cmm_points, measured_grid, read_measured_grid, write_measured_grid
from easeoff.study import plot
from easeoff.study.summary.plausibility import plausibility
from easeoff.study.summary.result_summary import result_summary
from easeoff.study.sweep import percentiles, read_sweep, worst_points
from easeoff.study.sweep.sweep_file import write_sweep

Take = Callable[[xr.DataTree, Path], Any]


@pytest.fixture(scope="module")
def stored(tmp_path_factory: pytest.TempPathFactory) -> Path:
    path = tmp_path_factory.mktemp("stored") / "result.nc"
    easeoff.write_result(easeoff.analyze(small(compliance="shell"), torques=[50.0, 100.0], speed=500.0), path)
    return path


@pytest.fixture(scope="module")
def wanted(stored: Path) -> xr.DataTree:
    """The result in memory."""
    return read_only(easeoff.read_result(stored))


@pytest.fixture(scope="module")
def opened(stored: Path) -> Iterator[xr.DataTree]:
    with xr.open_datatree(stored, chunks={}) as tree:
        yield tree


@pytest.fixture
def chunked(opened: xr.DataTree) -> xr.DataTree:
    """Of variables of its own: what a test loads is no other's."""
    return opened.copy(deep=False)


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


def printed(tree: xr.DataTree, _: Path) -> list[str]:
    summary = tree.easeoff.summary()
    return [str(summary), summary._repr_html_(), *(table.to_html() for table in summary.tables.values())]


def same(mine: Any, other: Any) -> bool:
    return bool(mine.identical(other) if isinstance(mine, xr.DataTree | xr.Dataset) else mine == other)


@pytest.fixture(scope="module")
def in_memory(wanted: xr.DataTree, tmp_path_factory: pytest.TempPathFactory) -> Callable[[Take], Any]:
    """What a function makes of the result in memory, once."""
    return cache(lambda take: take(wanted, tmp_path_factory.mktemp("wanted")))


@pytest.mark.parametrize(
    "take",
    [
        printed,
        lambda tree, _: study.key_numbers(tree),
        lambda tree, _: plausibility(tree),
        lambda tree, folder: [
            path.read_bytes() for path in plot.write_pictures(tree, folder, names="pressure", torque=50.0)
        ],
        written,
        saved,
        reported,
    ],
)
def test_a_chunked_result_is_taken_as_one_in_memory(
    chunked: xr.DataTree, in_memory: Callable[[Take], Any], tmp_path: Path, take: Take
) -> None:
    as_written = written if take is saved else take
    assert same(take(chunked, tmp_path), in_memory(as_written))


@pytest.fixture(scope="module")
def in_zarr(stored: Path, wanted: xr.DataTree) -> Path:
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")  # of zarr, of its own format
        wanted.to_zarr(stored.with_suffix(".zarr"), consolidated=False)
    return stored.with_suffix(".zarr")


@pytest.mark.parametrize(("takes", "chunks"), [((printed, written), {}), ((written,), None), ((reported,), None)])
def test_a_result_in_zarr_is_taken_as_one_in_memory(
    in_zarr: Path,
    in_memory: Callable[[Take], Any],
    tmp_path: Path,
    takes: tuple[Take, ...],
    chunks: dict[str, int] | None,
) -> None:
    with xr.open_datatree(in_zarr, engine="zarr", chunks=chunks, consolidated=False) as lazy:
        for take in takes:
            assert same(take(lazy.copy(deep=False), tmp_path), in_memory(take))


@pytest.mark.parametrize("engine", ["netcdf4", "zarr"])
@pytest.mark.parametrize("chunks", [None, {}])
def test_a_lazy_grid_is_written_as_one_in_memory(tmp_path: Path, engine: Any, chunks: dict[str, int] | None) -> None:
    points = cmm_points(gear_pair(small()).gear, rows=3, columns=5)
    grid = measured_grid(points, np.linspace(-6.0, 6.0, 15).reshape(3, 5))
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")  # of zarr, of its own format
        (grid.to_zarr if engine == "zarr" else grid.to_netcdf)(tmp_path / "given")
    for suffix in (".nc", ".csv"):
        with xr.open_dataset(tmp_path / "given", engine=engine, chunks=chunks) as lazy:
            write_measured_grid(lazy, tmp_path / f"grid{suffix}")
        assert read_measured_grid(tmp_path / f"grid{suffix}").equals(grid)


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
def test_a_lazy_result_replaces_its_own_file(
    stored: Path, wanted: xr.DataTree, tmp_path: Path, chunks: dict[str, int] | None
) -> None:
    path = tmp_path / "own.nc"
    shutil.copy(stored, path)
    with xr.open_datatree(path, chunks=chunks) as lazy:
        easeoff.write_result(lazy, path)
    assert easeoff.read_result(path).identical(wanted)


@pytest.mark.usefixtures("reading_in_copies")
def test_nothing_that_was_read_is_left_in_the_file(stored: Path, wanted: xr.DataTree, tmp_path: Path) -> None:
    """Not even the ease-off, whose group is called as it is."""
    path = tmp_path / "result.nc"
    shutil.copy(stored, path)
    found = easeoff.read_result(path)
    path.unlink()
    assert found.identical(wanted)


def test_values_that_are_gone_are_asked_for_and_no_file_is_left(stored: Path, tmp_path: Path) -> None:
    path = tmp_path / "gone.nc"
    shutil.copy(stored, path)
    with xr.open_datatree(path) as lazy:
        path.unlink()
    for take in (written, lambda tree, _: result_summary(tree)):
        with pytest.raises(
            InputError, match="cannot be read any more: No such file or directory; open it again, call load"
        ):
            take(lazy, tmp_path)
    assert list(tmp_path.iterdir()) == []


def in_pool(work: Callable[[int], bool]) -> list[bool]:
    with ThreadPoolExecutor(6) as pool:
        return list(pool.map(work, range(6)))


def by_dask(work: Callable[[int], bool]) -> list[bool]:
    dask: Any = pytest.importorskip("dask")
    with dask.config.set(scheduler="threads", num_workers=6):
        return list(dask.compute(*(dask.delayed(work)(number) for number in range(6))))


@pytest.mark.usefixtures("reading_in_copies")
@pytest.mark.parametrize("start", [in_pool, pytest.param(by_dask, marks=pytest.mark.thorough)])
def test_threads_read_write_and_analyse_at_once(
    stored: Path, wanted: xr.DataTree, tmp_path: Path, start: Callable[[Callable[[int], bool]], list[bool]]
) -> None:
    """Beside one that computes an array from a file which xarray opened."""
    ended = threading.Event()

    def computing() -> None:
        with xr.open_dataset(stored, group="loaded", chunks={}) as lazy:
            while not ended.wait(0.01):
                lazy["force"].sum().compute(scheduler="synchronous")

    def work(number: int) -> bool:
        if number % 3 == 0:
            return easeoff.analyze(small(compliance="shell"), torques=[50.0])["loaded"].sizes["torque"] == 1
        path = stored
        if number % 3 == 1:
            path = tmp_path / f"{number}.nc"
            easeoff.write_result(wanted, path)
        return easeoff.read_result(path).identical(wanted)

    beside = threading.Thread(target=computing)
    beside.start()
    try:
        assert start(work) == [True] * 6
    finally:
        ended.set()
        beside.join()


@pytest.mark.thorough
def test_threads_read_write_and_analyse_in_the_kernel_of_a_notebook(stored: Path, tmp_path: Path) -> None:
    """Whose event loop and channels are threads, too."""
    kernel: Any = pytest.importorskip("jupyter_client").manager
    manager, client = kernel.start_new_kernel(kernel_name="python3", cwd=str(tmp_path))
    code = f"""
from concurrent.futures import ThreadPoolExecutor
from functools import cache
import easeoff
wanted = easeoff.read_result({str(stored)!r})
def work(number):
    if number % 4 == 0:
        return easeoff.analyze("nasa-12x36", torques=[50.0])["loaded"].sizes["torque"] == 1
    path = {str(stored)!r}
    if number % 4 == 1:
        path = f"{{number}}.nc"
        easeoff.write_result(wanted, path)
    return easeoff.read_result(path).identical(wanted)
with ThreadPoolExecutor(8) as pool:
    print(list(pool.map(work, range(8))))
"""
    said: list[str] = []
    try:
        client.execute_interactive(code, output_hook=lambda message: said.append(str(message["content"])))
    finally:
        client.stop_channels()
        manager.shutdown_kernel(now=True)
    assert str([True] * 8) in "".join(said), said


# --- Processes of their own


def refuse() -> None:
    raise InputError("speed = 0: must be above 0")


def test_a_result_and_a_mistake_come_back() -> None:
    assert in_forked_process(lambda: {"pid": os.getpid()})["pid"] != os.getpid()
    with pytest.raises(InputError, match="speed = 0: must be above 0"):
        in_forked_process(refuse)


@pytest.mark.parametrize("ending", [signal.SIGSEGV, signal.SIGABRT, signal.SIGKILL])
def test_a_crash_is_an_error(ending: signal.Signals, capfd: pytest.CaptureFixture[str]) -> None:
    with pytest.raises(ProcessEndedError):
        in_forked_process(lambda: os.kill(os.getpid(), ending))
    with pytest.raises(ProcessEndedError):
        in_forked_process(lambda: 1 // 0)
    assert capfd.readouterr() == ("", "")


def test_a_library_that_comes_to_no_end_is_stopped(monkeypatch: pytest.MonkeyPatch) -> None:
    """By the system, with a signal that it sends at the first limit; the second one would be another signal's."""
    monkeypatch.setattr(forked_process, "PROCESSOR_TIME_LIMIT", 7)

    def endless() -> None:
        first, second = resource.getrlimit(resource.RLIMIT_CPU)
        if first == 7 and second > first:
            os.kill(os.getpid(), signal.SIGXCPU)

    with pytest.raises(ProcessEndedError, match="the library that reads it comes to no end"):
        in_forked_process(endless)


def test_a_library_that_waits_for_ever_is_stopped(monkeypatch: pytest.MonkeyPatch) -> None:
    """It takes no processor time."""
    monkeypatch.setattr(forked_process, "TIME_LIMIT", 0.01)
    with pytest.raises(ProcessEndedError, match="the library that reads it comes to no end"):
        in_forked_process(signal.pause)


def test_a_copy_that_hangs_holds_up_no_other_thread() -> None:
    """No copy holds the pipe of another: eight end, whatever is still waiting."""
    release, sink = os.pipe()
    with ThreadPoolExecutor(9) as pool:
        with forked_process.netcdf_to_oneself():  # until all of them wait for their copies
            waiting = pool.submit(in_forked_process, lambda: os.read(release, 1))
            others = [pool.submit(in_forked_process, lambda number=number: number) for number in range(8)]
        assert [other.result() for other in others] == list(range(8))
        os.write(sink, b"a")
        assert waiting.result() == b"a"
    os.close(release)
    os.close(sink)


@pytest.mark.usefixtures("reading_in_copies")
def test_a_file_on_which_the_library_crashes_is_damaged(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    path = tmp_path / "good.nc"
    xr.Dataset({"a": ("x", [1.0, 2.0])}).to_netcdf(path, engine="netcdf4")
    assert netcdf_file.read_dataset(path)["a"].values.tolist() == [1.0, 2.0]
    monkeypatch.setattr(netcdf_file, "check_links", lambda _: os.abort())
    for read in (netcdf_file.read_dataset, netcdf_file.read_tree):
        with pytest.raises(InputError, match=r"good\.nc is not a netCDF file, or it is damaged: .* crashed"):
            read(path)


def test_a_file_on_which_the_library_ends_is_read_once(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Not once more for every kind of file that it might be."""
    path = tmp_path / "result.nc"
    xr.Dataset({"a": ("x", [1.0, 2.0])}).to_netcdf(path, engine="netcdf4")
    read: list[int] = []

    def ended(_: object) -> None:
        read.append(1)
        raise ProcessEndedError("the library that reads it comes to no end")

    monkeypatch.setattr(netcdf_file, "in_forked_process", ended)
    for command, *words in (["show"], ["plot", str(tmp_path / "pictures")], ["report", "-o", str(tmp_path / "r.html")]):
        read.clear()
        found = call(command, path, *words)
        assert (found.exit_code, len(read)) == (2, 1)
        assert "or it is damaged: the library that reads it comes to no end" in " ".join(found.output.split())
