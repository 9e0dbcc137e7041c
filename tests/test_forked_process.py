"""What a damaged file makes a library do stays in the process that reads it."""

from __future__ import annotations

import os
import resource
import signal
from pathlib import Path

import pytest
import xarray as xr
from runs import call

from easeoff import InputError
from easeoff.core.processes import forked_process
from easeoff.core.processes.forked_process import ProcessEndedError, in_forked_process
from easeoff.core.reading import netcdf_file


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
