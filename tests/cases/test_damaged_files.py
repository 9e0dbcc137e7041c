"""Damaged and hostile files: every reader answers with one message of bounded length, and commands leave nothing."""

from __future__ import annotations

import contextlib
import os
import re
import shutil
import warnings
import zipfile
from collections.abc import Callable
from dataclasses import replace
from functools import cache
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

import h5py
import numpy as np
import pytest
import xarray as xr
from click.testing import Result
from lacking import Damage, damaged, damages
from netCDF4 import Dataset
from runs import SHELLS, call, in_copies, output_of, refusal_of, small_text, text_file
from sweeps import CASE as SWEPT, analyse_points_once

import easeoff
from easeoff import InputError, read_result
from easeoff.cases import case_text, gear_pair, parse_case, read_case, read_rexs, read_session_script
from easeoff.contact import STEEL, ContactProblem, read_npz, read_problems, write_problems
from easeoff.contact.compliance.finite_elements.array_store import kept, key_of
from easeoff.contact.compliance.finite_elements.finite_element_tooth import finite_element_tooth
from easeoff.contact.problem.exchange.programme_file import write_npz
from easeoff.core import forked_process, netcdf_file
from easeoff.core.checkpoint import Checkpoint
from easeoff.core.checks import distinct, shown
from easeoff.core.errors import LINE_LENGTH_LIMIT, message
from easeoff.core.netcdf_file import read_dataset, read_tree
from easeoff.core.regular_file import TOML_SIZE_LIMIT, read_text
from easeoff.friction import lubricant
from easeoff.friction.ehl.study import study_design
from easeoff.friction.ehl.study.friction_formula import read_formula
from easeoff.friction.ehl.study.study_design import NUMBERS
from easeoff.geometry import Deviation, Member
from easeoff.geometry.deviation.corrective_settings import corrective_settings
from easeoff.geometry.formats import cmm_points, measured_grid, read_measured_grid, write_measured_grid
from easeoff.geometry.tooth.tooth_flanks import side
from easeoff.study import case_correction
from easeoff.study.compare import comparison
from easeoff.study.compare.attempt import Attempt
from easeoff.study.compare.comparison_table import write_table
from easeoff.study.deviations import flank_deviations
from easeoff.study.library import entries
from easeoff.study.library.library_files import write_part
from easeoff.study.result import form_faults, load_case_faults
from easeoff.study.sweep import sweep

ESCAPE = "\x1b[2J\x9b2J\u202e"
MESSAGE_LENGTH_LIMIT = 4000


def refused(*arguments: object) -> str:
    """The one message with which the command line refuses a mistake."""
    said = refusal_of(*arguments)
    assert said.count("Error:") == 1
    assert len(said) < MESSAGE_LENGTH_LIMIT
    assert not any(character in said for character in ESCAPE if not character.isprintable())
    return said


@pytest.fixture(scope="module")
def files(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A folder with cases, a small result, a file of wear and one of contact problems."""
    folder = tmp_path_factory.mktemp("files")
    text_file(folder / "case.toml", small_text(more=SHELLS))
    text_file(
        folder / "fe.toml", small_text(more='\n[compliance]\nmodel = "fe"\nfineness = 0.25\nneighbours = false\n')
    )
    text_file(folder / "cases.csv", "name,torque,flank,share,speed\na,50,drive,0.6,500\nb,80,coast,0.4,700\n")
    with contextlib.chdir(folder):
        for kind in ("result", "wear", "problems"):
            output_of(*MADE[kind].split())
    return folder


# Text


@pytest.mark.parametrize(
    ("content", "words"),
    [
        (b"a = " + b"[" * 3000 + b"]" * 3000, "nested too deeply"),
        (b"[" + b".".join([b"a"] * 200) + b"]\n", "nested more than 32 deep"),
        (b".".join([b"a"] * 3000) + b" = 1", "more than 300 points in a key"),
        (b"a = " + b"9" * 5000, "not a TOML file"),
        (b"a = " + b"9" * 400, "must be a whole number of at most 64 bits"),
        (b"a = 0x" + b"f" * 10000, "must be a whole number of at most 64 bits"),
        (b"a = 1\n\0", "line 2 holds a null character"),
        (b"a = 1\nb = \xff", "line 2 is not UTF-8"),
        (b"# " + b"x" * TOML_SIZE_LIMIT, "larger than 1 MB"),
        (b"", "is empty"),
    ],
)
def test_toml_that_no_parser_takes(tmp_path: Path, content: bytes, words: str) -> None:
    path = tmp_path / "case.toml"
    path.write_bytes(content)
    assert words in refused("run", path, "-o", tmp_path / "out.nc")
    if content:
        with pytest.raises(InputError, match=words):
            lubricant(path)
    assert os.listdir(tmp_path) == ["case.toml"]


def test_a_file_that_grows_beyond_any_memory_is_not_read(tmp_path: Path) -> None:
    for name in ("case.toml", "pair.ses", "pair.rexs", "grid.csv", "grid.dmi", "formula.json", "result.nc"):
        with (tmp_path / name).open("wb") as file:
            file.truncate(8 << 30)
    sparse = sorted(os.listdir(tmp_path))
    for words in (
        ("run", tmp_path / "case.toml", "-o", tmp_path / "out.nc"),
        ("convert", tmp_path / "pair.ses", "-o", tmp_path / "out.toml"),
        ("convert", tmp_path / "pair.rexs", "-o", tmp_path / "out.toml"),
        ("correct", "nasa-12x36", "--deviation", f"gear={tmp_path / 'grid.csv'}"),
        ("correct", "nasa-12x36", "--deviation", f"gear={tmp_path / 'grid.dmi'}"),
        ("show", tmp_path / "result.nc"),
    ):
        assert "is larger than" in refused(*words)
    with pytest.raises(InputError, match="is larger than"):
        read_formula(tmp_path / "formula.json")
    assert sorted(os.listdir(tmp_path)) == sparse


@pytest.mark.skipif(not hasattr(os, "mkfifo"), reason="there are no pipes with names here")
def test_pipes_devices_and_folders_are_no_files(tmp_path: Path) -> None:
    os.mkfifo(tmp_path / "pipe")
    for path in (tmp_path / "pipe", Path("/dev/zero")):
        assert "is a device or a pipe" in refused("show", path)
        assert "is a device or a pipe" in refused("run", path, "-o", tmp_path / "out.nc")
        with pytest.raises(InputError, match="is a device or a pipe"):
            read_rexs(path)
    assert "is a folder" in refused("show", tmp_path)


def test_a_byte_order_mark_and_foreign_ends_of_lines_are_read(tmp_path: Path) -> None:
    path = tmp_path / "text"
    path.write_bytes(b"\xef\xbb\xbfone\r\ntwo\rthree\n")
    assert read_text(path, 100) == "one\ntwo\nthree\n"


def test_many_mistakes_and_long_values_make_a_short_message(tmp_path: Path) -> None:
    path, text, cutter = tmp_path / "case.toml", case_text("nasa-12x36"), "[pinion.convex.cutter]\n"
    assert cutter in text
    torques = ", ".join(["50.0"] * 20_000)
    for lines in (
        f"torques = [{torques}]",
        *(f"{'k' * 100_000} = {value}" for value in ("1", '"' + "x" * 300_000 + '"')),
    ):
        path.write_text(text.replace("[contact]", f"[contact]\n{lines}"), encoding="utf-8")
        refused("run", path, "-o", tmp_path / "out.nc")
    path.write_text("easeoff_case = 1\n" + "\n".join(f"k{i} = 1" for i in range(5000)), encoding="utf-8")
    assert "and 4992 more" in refused("run", path, "-o", tmp_path / "out.nc")
    unknown = "\n".join(f"k{i} = 1" for i in range(3000))
    path.write_text(text.replace(cutter, f"{cutter}{unknown}\n"), encoding="utf-8")
    found = refused("run", path, "-o", tmp_path / "out.nc")
    assert found.count("known are") == 1
    assert "and 2988 more" in found
    with pytest.raises(InputError) as caught:
        distinct("speed", [5.0] * 100_000)
    assert len(str(caught.value)) < 300
    assert len(str(InputError("x " * 10**6))) <= LINE_LENGTH_LIMIT
    assert "whole number of too" in shown(10**10000) or len(shown(10**10000)) < 200


@pytest.mark.usefixtures("reading_here")
@pytest.mark.parametrize("drawn", [False, pytest.param(True, marks=pytest.mark.thorough)])
def test_keys_titles_and_paths_do_not_steer_the_terminal(tmp_path: Path, files: Path, drawn: bool) -> None:
    path = text_file(tmp_path / f"{ESCAPE}.toml", small_text(more=SHELLS + '"\\u001b[2J\\u009b\\u202e\\nfake" = 1\n'))
    said = refused("run", path, "-o", tmp_path / "out.nc")
    assert "?[2J??" in said
    assert "\nfake" not in said
    refused("show", tmp_path / f"{ESCAPE}.nc")
    refused("run", "nasa-12x36", "-o", tmp_path / "out.nc", "--torque", ESCAPE)
    refused(ESCAPE)
    result = tmp_path / f"{ESCAPE}r.nc"
    shutil.copy(files / "result.nc", result)
    with Dataset(result, "a") as file:
        file.title = f"{ESCAPE} $x$"
        file.flank = f"drive{ESCAPE}"
    for words in (["show", result], *([["plot", result, tmp_path / "pictures"]] if drawn else [])):
        found = output_of(*words)
        assert not set(ESCAPE) & {c for c in found if not c.isprintable()}
    assert message("Größe µ — ∅") == "Größe µ — ∅"


# netCDF


def spoilt(source: Path, target: Path, change: Callable[[Dataset], object]) -> Path:
    shutil.copy(source, target)
    with Dataset(target, "a") as file:
        change(file)
    return target


CHANGES: dict[str, Callable[[Dataset], object]] = {
    "no attribute": lambda file: file["ease_off"].delncattr("ratio"),
    "no version": lambda file: file.delncattr("easeoff_version"),
    "renamed dimension": lambda file: file["loaded"].renameDimension("torque", "moment"),
    "unknown status": lambda file: file["loaded"]["status"].__setitem__(slice(None), 77),
    "unknown line end": lambda file: file["loaded"]["max_pressure_line_end"].__setitem__(slice(None), -5),
    "not finite torque": lambda file: file["loaded"]["torque"].__setitem__(slice(None), np.nan),
    "falling coordinate": lambda file: file["ease_off"]["profile"].__setitem__(slice(None), 0.5),
    "wild number": lambda file: file["loaded"]["force"].__setitem__(slice(None), -1e300),
    "text for a number": lambda file: file.setncattr("pinion_teeth", "twelve"),
    "list for a text": lambda file: file.setncattr("title", [1.0, 2.0]),
    "broken table": lambda file: file.setncattr("modification_um", "[" * 100_000),
}


@pytest.mark.usefixtures("reading_here")
@pytest.mark.quick(4)
@pytest.mark.parametrize("change", CHANGES)
def test_a_result_that_lacks_something_is_refused(tmp_path: Path, files: Path, change: str) -> None:
    path = spoilt(files / "result.nc", tmp_path / "r.nc", CHANGES[change])
    refused("show", path)
    assert os.listdir(tmp_path) == ["r.nc"]


@pytest.mark.usefixtures("reading_here")
@pytest.mark.parametrize(
    "attributes",
    [
        {"torque": {"units": "days since 1e300"}, "mesh_position": {"units": "s"}},
        {"torque": {"scale_factor": 1e300}},
    ],
)
def test_attributes_that_mislead_the_decoding_bring_no_warning(
    tmp_path: Path, files: Path, attributes: dict[str, dict[str, object]]
) -> None:
    def change(file: Dataset) -> None:
        for name, own in attributes.items():
            file["loaded"][name].setncatts(own)

    path = spoilt(files / "result.nc", tmp_path / "r.nc", change)
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        message = (
            r"holds numbers beyond 1e\+30" if "scale_factor" in attributes["torque"] else "'days since 1e300': must"
        )
        with pytest.raises(InputError, match=f"'torque' .*{message}"):
            read_result(path)


def test_any_name_of_a_file_is_its_name(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    xr.Dataset({"a": ("x", [1.0, 2.0])}).to_netcdf("x.nc", engine="netcdf4")
    for name in (" .nc", " r.nc ", "http:r.nc", "~", "-", "r[1].nc", "ü%20?mode=bytes#.nc"):
        shutil.copy("x.nc", tmp_path / name)
        assert read_dataset(name)["a"].values.tolist() == [1.0, 2.0]


def test_flipped_and_missing_bytes_are_a_message_or_harmless(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(forked_process, "PROCESSOR_TIME_LIMIT", 1)
    path, random = tmp_path / "w.nc", np.random.default_rng(3)
    table = xr.Dataset({"depth": (("member", "node"), np.arange(200.0).reshape(2, 100), {"units": "um"}), "step": 1})
    table = table.assign_coords(member=["pinion", "gear"]).assign_attrs(title="wear")
    table.to_netcdf(path, engine="netcdf4", encoding={"depth": {"zlib": True}})
    content = path.read_bytes()
    for trial in range(20):
        spoilt_bytes = bytearray(content)
        for at in random.integers(0, len(content), 5):
            spoilt_bytes[at] = random.integers(256)
        path.write_bytes(bytes(spoilt_bytes[: random.integers(len(content))] if trial % 5 == 0 else spoilt_bytes))
        with contextlib.suppress(InputError):
            assert set(read_dataset(path)) <= set(table)


def test_a_small_file_that_unpacks_to_75_gigabytes_is_refused_by_its_header(tmp_path: Path) -> None:
    path = tmp_path / "large.nc"
    with Dataset(path, "w") as file:
        inner = file.createGroup("loaded")
        for name in ("x", "y"):
            inner.createDimension(name, 96_825)
        inner.createVariable("force", "f8", ("x", "y"), zlib=True, chunksizes=(1000, 1000))
    assert path.stat().st_size < 20_000
    assert "would take 75 GB in memory" in refused("show", path)
    assert "would take 75 GB" in refused("compare", path, "-o", tmp_path / "comparison", "--solvers", "native")
    assert "would take 75 GB" in refused("correct", "nasa-12x36", "--deviation", f"gear={path}")
    with Dataset(path, "w") as file:
        file.createDimension("x", 10**9)
        file.createVariable("name", str, ("x",))
    with pytest.raises(InputError, match="would take 64 GB"):
        read_tree(path)
    with Dataset(path, "w") as file:
        file.createDimension("x", None)
        file.createVariable("x", "f8", ("x",), chunksizes=(520_000_000,))
    with pytest.raises(InputError, match=r"would take 4\.2 GB"):
        read_tree(path)


@pytest.mark.parametrize(
    ("depth", "words"), [(17, "16 levels of groups"), (1100, "or it is damaged: maximum rec|16 levels of groups")]
)
def test_groups_nested_deeply_are_refused(tmp_path: Path, depth: int, words: str) -> None:
    path = tmp_path / "deep.nc"
    with Dataset(path, "w") as file:
        group = file
        for _ in range(depth):
            group = group.createGroup("g")
    with pytest.raises(InputError, match=words):
        read_tree(path)


def test_types_of_its_own_are_refused(tmp_path: Path) -> None:
    path = tmp_path / "types.nc"
    makers: tuple[Callable[[Dataset], Any], ...] = (
        lambda file: file.createVLType("f8", "row"),
        lambda file: file.createCompoundType(np.dtype([("a", "f8"), ("b", "i4")]), "both"),
        lambda file: file.createEnumType(np.uint8, "either", {"A": 0}),
    )
    for make in makers:
        with Dataset(path, "w") as file:
            file.createDimension("x", 2)
            file.createVariable("v", make(file), ("x",))
        with pytest.raises(InputError, match="data types of its own"):
            read_tree(path)


@pytest.mark.usefixtures("reading_here")
def test_a_dimension_twice_is_refused_but_in_contact_problems(tmp_path: Path, files: Path) -> None:
    path = tmp_path / "twice.nc"
    with Dataset(path, "w") as file:
        file.createDimension("x", 2)
        file.createVariable("v", "f8", ("x", "x"))
    for read in (read_tree, read_dataset):
        with pytest.raises(InputError, match="'v' has a dimension twice: must have each once"):
            read(path)
    assert read_dataset(path, square=True)["v"].shape == (2, 2)
    shutil.copy(files / "result.nc", path)
    with Dataset(path, "a") as file:
        file.createDimension("x", 2)
        file.createVariable("v", "f8", ("x", "x"))
    assert "'v' has a dimension twice" in refusal_of("show", path)


@pytest.mark.parametrize(
    ("words", "add"),
    [
        ("links to other names", lambda file: file.__setitem__("x", h5py.ExternalLink("secret.nc", "/deviation"))),
        ("links to other names", lambda file: file.__setitem__("x", h5py.SoftLink("/deviation"))),
        ("data in other files", lambda file: file.create_dataset("x", (4,), "f8", external=[("secret.bin", 0, 32)])),
        ("data in other files", lambda file: file.create_virtual_dataset("x", virtual_layout())),
        ("a group under two names", lambda file: file.create_group("x").__setitem__("again", file["x"])),
        ("a group under two names", lambda file: file.__setitem__("x", file["/"])),
    ],
)
def test_links_out_of_a_file_or_in_circles_are_refused(
    tmp_path: Path, files: Path, words: str, add: Callable[[Any], object]
) -> None:
    path = tmp_path / "w.nc"
    shutil.copy(files / "wear.nc", path)
    with h5py.File(path, "a") as file:
        add(file)
    with pytest.raises(InputError, match=words):
        read_dataset(path)


def test_a_link_out_of_a_file_is_told(tmp_path: Path, files: Path) -> None:
    path = tmp_path / "w.nc"
    shutil.copy(files / "wear.nc", path)
    with h5py.File(path, "a") as file:
        file["x"] = h5py.SoftLink("/deviation")
    assert "links to other names" in refused("show", path)


def virtual_layout() -> Any:
    layout = h5py.VirtualLayout((4,), "f8")
    layout[:] = h5py.VirtualSource("secret.h5", "x", (4,))
    return layout


WEAR_CHANGES: dict[str, Callable[[Dataset], object]] = {
    "step": lambda file: file.renameDimension("step", "time"),
    "xyz": lambda file: file.renameDimension("xyz", "abc"),
    "lengthwise": lambda file: file.renameVariable("lengthwise", "along"),
    "member": lambda file: file.renameVariable("member", "side"),
    "position": lambda file: file.renameVariable("position", "place"),
    "deviation": lambda file: file.renameVariable("deviation", "gap"),
    "teeth": lambda file: file.setncattr("gear_teeth", "many"),
    "far nodes": lambda file: file["position"].__setitem__(slice(None), -1e300),
    "not finite": lambda file: file["deviation"].__setitem__(slice(None), np.nan),
}


@pytest.mark.usefixtures("reading_here")
def test_a_file_of_wear_that_lacks_something_is_refused(tmp_path: Path, files: Path) -> None:
    pair = gear_pair(read_case(files / "case.toml"))
    for number, change in enumerate(WEAR_CHANGES.values()):
        path = spoilt(files / "wear.nc", tmp_path / f"{number}.nc", change)
        with pytest.raises(InputError):
            flank_deviations(pair, {"gear": path})
        path.unlink()
    path = spoilt(files / "wear.nc", tmp_path / "w.nc", WEAR_CHANGES["deviation"])
    for words in (["correct"], ["run", "-o", tmp_path / "out.nc"]):
        refused(words[0], files / "case.toml", *words[1:], "--deviation", f"gear={path}")
    assert os.listdir(tmp_path) == ["w.nc"]


def count_twice(file: Dataset) -> None:
    file.renameVariable("mode_count", "other_count")
    file.createVariable("mode_count", "i4", ("problem", "problem"))[:] = 1


PROBLEM_CHANGES: dict[str, Callable[[Dataset], object]] = {
    "no separation": lambda file: file.renameVariable("separation", "gap"),
    "renamed dimension": lambda file: file.renameDimension("problem", "item"),
    "version": lambda file: file.setncattr("format_version", "x" * 100_000),
    "size": lambda file: file["size"].__setitem__(slice(None), -5),
    "wild": lambda file: file["separation"].__setitem__(slice(None), -1e300),
    "dimension twice": count_twice,
}


@pytest.mark.usefixtures("reading_here")
@pytest.mark.parametrize("change", PROBLEM_CHANGES)
def test_contact_problems_that_lack_something_are_refused_or_read(tmp_path: Path, files: Path, change: str) -> None:
    path = spoilt(files / "problems.nc", tmp_path / "p.nc", PROBLEM_CHANGES[change])
    try:
        read_problems(path)
    except InputError:
        return
    assert change in ("renamed dimension", "wild")  # names are free, and numbers are the solvers' to judge


def test_problems_of_both_forms_that_lack_a_diagonal_are_refused(tmp_path: Path) -> None:
    gaps, levers = [0.0, 1e-3], [50.0, 50.0]
    dense = ContactProblem(gaps, levers, 1e4, np.diag([1e-5, 1e-5]))
    write_problems([dense, ContactProblem(gaps, levers, 1e4, ([1e-5] * 2, [[1e-3], [2e-3]]))], tmp_path / "p.nc")
    path = spoilt(tmp_path / "p.nc", tmp_path / "q.nc", lambda file: file.renameVariable("compliance_diagonal", "d"))
    with pytest.raises(InputError, match=r"q\.nc: structured of problem 1 = 1: must go with the variable compliance_d"):
        read_problems(path)


# Whatever lacks something is refused by all readers or read by all


#: Commands that read a file of a kind: ``x.nc``, or what they keep beside their output.
SHOWN = ["show x.nc", "cite x.nc", "plot x.nc p"]
REPORTED = [*SHOWN, "report x.nc -o r.html"]
EXPORTED = [*REPORTED, "export x.nc -o x.vtu --nodes 5x5"]
DEVIATED = ["problems case.toml -o o.nc --torque 50 --deviation gear=x.nc", "correct case.toml --deviation gear=x.nc"]
COMPARED = "compare {} -o c --solvers native --repetitions 1"
PROBLEMS = [
    "show x.nc",
    *(f"convert x.nc -o {form} --format {form}" for form in ("npz", "qps")),
    COMPARED.format("x.nc"),
]
FRONT = (
    "optimize fe.toml -o o.nc --torque 50 --form pareto --minimize max_pressure --minimize peak_to_peak "
    "--limit ease_off_change<=50 --free pinion.concave.machine.radial_distance --steps 1 --points 2"
)
READERS: dict[str, list[str]] = {
    **dict.fromkeys(("result", "supported", "film", "fe", "deviated", "modify"), EXPORTED),
    **dict.fromkeys(("wear", "vh", "load_cases"), REPORTED),
    **dict.fromkeys(("worn", "measured"), DEVIATED),
    "front": ["show x.nc", "plot x.nc p", f"{FRONT} --resume x.nc"],
    "sweep": SHOWN,
    **dict.fromkeys(("problems", "library"), PROBLEMS),
    "comparison": [COMPARED.format("problems.nc")],
}
#: How to make them, with a case of shells but for the finite elements and searches.
MADE: dict[str, str] = {
    "result": "run case.toml -o result.nc --torque 50 --speed 500",
    "wear": "wear case.toml -o wear.nc --torque 50 --revolutions 1e4",
    "problems": "problems case.toml -o problems.nc --torque 50",
    "supported": "run case.toml -o supported.nc --torque 50 --supports gearbox-nasa-12x36",
    "film": "run case.toml -o film.nc --torque 50 --speed 500 --film-heating gupta_cheng --friction-feedback",
    "fe": "run fe.toml -o fe.nc --torque 50",
    "deviated": "run case.toml -o deviated.nc --torque 50 --deviation gear=wear.nc",
    "modify": "modify case.toml -o modify.nc --torque 50 --order 2",
    "vh": "vh case.toml -o vh.nc --grid 2x2",
    "sweep": "sweep case.toml -o sweep.nc --over E=-0.1:0.1:3 --torque 50,80",
    "load_cases": "run case.toml -o load_cases.nc --load-cases cases.csv",
    "front": FRONT.replace("o.nc", "front.nc"),
}
#: Of these every damage is tried.
EVERY_DAMAGE = ("wear", "vh", "sweep", "problems", "library")
#: Every which damage of the others is tried, and of what the first of the results has too. Primes: of every variable
#: another kind is among them.
STEP, STEP_AGAIN = 11, 43


@pytest.fixture
def read_again(tmp_path: Path, files: Path, monkeypatch: pytest.MonkeyPatch) -> Callable[..., list[Result]]:
    """Function that lets commands read a tree in place of a file, and returns what they say.

    Fitted settings, measurements of solvers and their report are those of the first file: what is read is tried.
    """
    for name in ("case.toml", "fe.toml", "problems.nc"):
        shutil.copy(files / name, tmp_path)
    monkeypatch.chdir(tmp_path)
    text_file(tmp_path / "x.nc", "")
    held: list[xr.DataTree] = []
    from_file: Any = netcdf_file._read

    def content(path: str | Path, opened: object, **keywords: bool) -> Any:
        if Path(path).name not in ("x.nc", "results.nc"):
            found: xr.DataTree | xr.Dataset = from_file(path, opened, **keywords)
            return found
        tree = held[-1]
        return tree.copy() if opened is netcdf_file.whole_tree else tree.to_dataset()

    fitted: dict[str, Any] = {}
    fit, write = corrective_settings, easeoff.study.compare.write_comparison

    def fitted_once(member: Member, deviation: Deviation, **options: Any) -> Any:
        if (flank := side(member.loaded)) not in fitted:
            fitted[flank] = fit(member, deviation, **options)
        return fitted[flank]

    def write_comparison(table: xr.Dataset, folder: Path) -> list[Path]:
        return [] if (folder / "results.nc").exists() else write(table, folder)

    monkeypatch.setattr(netcdf_file, "_read", content)
    monkeypatch.setattr(case_correction, "corrective_settings", fitted_once)
    monkeypatch.setattr(easeoff.study.compare, "write_comparison", write_comparison)
    give_measurements(monkeypatch)

    def read(tree: xr.DataTree, readers: list[str]) -> list[Result]:
        held[:] = [tree]
        return [call(*words.split()) for words in readers]

    return read


def give_measurements(patch: pytest.MonkeyPatch) -> None:
    """Let comparisons have measurements of solvers that were not made, but given."""
    measured = [replace(Attempt("solved", run_time=0.125, call_time=0.25), elastic_rotation=1e-3)]
    patch.setattr(comparison, "measure", lambda *_: measured)
    patch.setattr(comparison, "launched", lambda *_: set())


def fallen(answers: list[Result]) -> list[str]:
    """Those that are neither done nor refused in one message that names the file, or the option that it goes with."""
    return [
        f"{one.output} {one.exception!r}"
        for one in answers
        if one.exit_code
        and not (
            one.exit_code == 2
            and one.output.count("Error:") == 1
            and re.search(r"x\.nc|^ resume: ", one.output.split("Error:")[1])
        )
    ]


def write_small_library(path: Path) -> None:
    """Problems of the library, of both forms."""
    names = ("nasa-12x36-drive-heavy", "nasa-12x36-dense")
    write_part([entry for entry in entries() if entry.name in names], path)


def write_small_grid(path: Path) -> None:
    """A measured grid of a gear."""
    points = cmm_points(gear_pair(read_case("nasa-12x36")).gear, rows=3, columns=5)
    write_measured_grid(measured_grid(points, np.linspace(1.0, 8.0, 15).reshape(3, 5)), path)


def write_small_comparison(path: Path) -> None:
    """The table of a comparison."""
    with pytest.MonkeyPatch.context() as patch, TemporaryDirectory() as folder:
        give_measurements(patch)
        table = comparison.compare([path.parent / "problems.nc"], folder, solvers=["native"], repetitions=1)
        shutil.copy(write_table(table, Path(folder))[0], path)


#: What no command writes in a second.
WRITTEN: dict[str, Callable[[Path], None]] = {
    "library": write_small_library,
    "measured": write_small_grid,
    "comparison": write_small_comparison,
}


@pytest.fixture(scope="module")
def whole(files: Path) -> Callable[[str], xr.DataTree]:
    """Function that gives a file of a kind, in memory."""

    @cache
    def made(kind: str) -> xr.DataTree:
        path = files / f"{'wear' if kind == 'worn' else kind}.nc"
        with contextlib.chdir(files):
            if kind in WRITTEN:
                WRITTEN[kind](path)
            elif not path.exists():
                output_of(*MADE[kind].split())
        with xr.open_datatree(path, engine="netcdf4") as tree:
            return tree.load()

    return made


@pytest.mark.thorough
@pytest.mark.parametrize("kind", READERS)
def test_what_a_file_lacks_no_command_falls_over(
    kind: str, whole: Callable[[str], xr.DataTree], read_again: Callable[..., list[Result]]
) -> None:
    """Each damage alone is read by one command; what it takes, by all commands with all of the kind at once."""
    tree, readers = whole(kind), READERS[kind]
    assert not [one.output for one in read_again(tree, readers) if one.exit_code]
    taken: dict[str, list[Damage]] = {}
    wrong: list[tuple[str, list[str]]] = []
    known = set() if kind == "result" else {str(one) for one in damages(whole("result"))}
    for number, one in enumerate(damages(tree)):
        again = re.sub(r"^/results/\w+", "", str(one)) in known
        if kind not in EVERY_DAMAGE and number % (STEP_AGAIN if again else STEP):
            continue
        shown = read_again(damaged(tree, [one]), readers[:1])
        wrong += [(str(one), found) for found in [fallen(shown)] if found]
        if shown[0].exit_code == 0:
            taken.setdefault(one.kind, []).append(one)
    waiting = list(taken.values())
    while waiting:
        several = waiting.pop()
        answers = read_again(damaged(tree, several), readers)
        found = fallen(answers)
        if len(several) > 1 and (found or answers[0].exit_code):  # what is taken alone may be refused together
            half = len(several) // 2
            waiting += [several[:half], several[half:]]
        elif found:
            wrong.append((str(several[0]), found))
    assert not wrong, "\n".join(f"{what}: {'; '.join(found)}" for what, found in wrong)


def test_faults_of_a_layout_are_phrases() -> None:
    texts = xr.Dataset({"force": ("torque", ["a", "b"])}, {"torque": [50.0, 50.0]})
    assert list(form_faults(texts)) == ["'force' must hold numbers", "'torque' must hold values that differ"]
    assert load_case_faults(xr.DataTree.from_dict({"/load_cases": xr.Dataset()})) == ["load_cases: no load cases"]


@pytest.mark.quick(8)
@pytest.mark.parametrize(
    ("kind", "what", "words"),
    [
        *(("problems", f"/ nothing along {name}", "must") for name in ("problem", "segment")),
        ("problems", "/ text in reference_force", "reference_force: must hold numbers"),
        ("problems", "/ one value of reference_force", "reference_force: must hold numbers"),
        ("problems", "/ text in pinion_torque", "label pinion_torque"),
        ("worn", "/ other units of position", "no numbers 'position' [mm] over"),
        ("worn", "/ other dimensions of member", "no members 'pinion' and 'gear'"),
        ("measured", "/ other units of deviation", "units of 'deviation' = 'furlong': must be um"),
        ("measured", "/ without normal", "no numbers 'normal'"),
        ("wear", "/ without @ gear_teeth", "'gear_teeth'"),
        ("wear", "/ empty @ edge_contact", "'edge_contact'"),
        ("wear", "/ other dimensions of member", "'member' must"),
        ("wear", "/ empty @ misalignment_shaft_angle_rad", "'misalignment_shaft_angle_rad'"),
        ("front", "/front without front_found", "'front_found' over point, setting"),
        ("front", "/front without @ chosen_point", "no number in the attribute 'chosen_point'"),
        ("modify", "/optimization without stage", "'stage' must be before, after"),
        ("modify", "/modification without", "no group modification beside it"),
        ("modify", "/modification empty modification", "'modification' must hold finite numbers"),
        ("load_cases", "/ of another kind @ edge_contact", "'edge_contact'"),
        ("load_cases", "/duty without duty_efficiency", "'duty_efficiency'"),
        ("load_cases", "/duty nothing along damage_exponent", "0 values along damage_exponent"),
        ("load_cases", "/duty nothing along load_case", "0 values along load_case"),
        ("result", "/unloaded less along end", "1 values along end"),
        ("result", "/friction empty @ rolling_frame", "no fixed or contact_line in the attribute"),
        ("result", "/ease_off without separation_skew", "'separation_skew'"),
        ("result", "/flanks without member", "'member'"),
        ("result", "/ease_off empty action_position", "'action_position'"),
        ("result", "/ease_off empty inside", "'inside'"),
        ("result", "/unloaded without carrying_pair", "'carrying_pair'"),
        ("result", "/unloaded nothing along fine_position", "0 values along fine_position"),
        ("result", "/unloaded one value of fine_envelope", "'fine_envelope' over fine_position"),
        ("result", "/loaded without pinion_rotation", "'pinion_rotation'"),
        ("result", "/loaded empty pinion_rotation", "'pinion_rotation' must hold finite numbers"),
        ("result", "/loaded empty length", "'length' must hold numbers where a segment carries"),
        ("result", "/loaded other order of status", "'status' over torque, mesh_position"),
        ("result", "/loaded other units of max_pressure", "'max_pressure' has the units 'furlong': must be MPa"),
        ("result", "/friction text in torque", "'torque' must hold numbers"),
        ("result", "/friction without mesh_efficiency", "'mesh_efficiency'"),
        ("result", "/friction other dimensions of pressure_velocity", "'pressure_velocity'"),
        ("result", "/friction one value of film_thickness", "'film_thickness'"),
        ("result", "/friction other dimensions of bulk_temperature", "'bulk_temperature'"),
    ],
)
def test_what_commands_fell_over_is_refused(
    kind: str, what: str, words: str, whole: Callable[[str], xr.DataTree], read_again: Callable[..., list[Result]]
) -> None:
    tree = whole(kind)
    (damage,) = (one for one in damages(tree) if str(one) == what)
    for answer in read_again(damaged(tree, [damage]), [one for one in READERS[kind] if not one.startswith("cite")]):
        assert answer.exit_code == 2
        assert words in answer.output
        assert "x.nc" in answer.output


def test_what_is_wrong_with_the_content_of_a_good_file_names_it(
    whole: Callable[[str], xr.DataTree], read_again: Callable[..., list[Result]]
) -> None:
    export = EXPORTED[-1]
    unknown = whole("result").assign()
    unknown.attrs["case"] = ""
    for tree, words in ((unknown, "keeps no case"), (whole("load_cases"), "has no group 'loaded'")):
        (answer,) = read_again(tree, [export])
        assert f"Error: x.nc: the result {words}" in answer.output
        assert answer.exit_code == 2
    path = text_file(Path("grid.csv"), grid_text())
    with pytest.raises(InputError, match=r"deviation pinion = grid\.csv: the measured grid has no concave flank"):
        flank_deviations(gear_pair(read_case("nasa-12x36")), {"pinion": path})


# Measured grids


def grid_text(x: str = "1", rows: int = 3, columns: int = 3, normal: str = "0,0,1") -> str:
    lines = ["# format: easeoff measured grid", "# format_version: 1", "flank,row,column,x,y,z,nx,ny,nz,deviation"]
    lines += [f"convex,{r},{c},{x},0,{r + c},{normal},1" for r in range(1, rows + 1) for c in range(1, columns + 1)]
    return "\n".join(lines)


@pytest.mark.parametrize(
    ("content", "words"),
    [
        (grid_text("-1e300"), "at most 10000"),
        (grid_text(normal="1e300,0,0"), "at most 10000"),
        (grid_text("9" * 60_000), "characters: must be at most"),
        (grid_text().replace("convex,1,1", "convex,1," + "9" * 3000), "must be a whole number from 1 to 1001"),
        ("# rows: root to tip\n" + ",".join(["1.0"] * 12_000), "must be 1 to 1001 each"),
        ("#" + ";" * 49_000 + "x", "must have the form"),
    ],
)
def test_grids_of_wild_numbers_are_refused(tmp_path: Path, content: str, words: str) -> None:
    path = text_file(tmp_path / "grid.csv", content)
    with pytest.raises(InputError, match=words):
        read_measured_grid(path)
    assert words in refused("correct", "nasa-12x36", "--deviation", f"gear={path}")


def test_a_dmis_statement_of_very_many_lines_ends(tmp_path: Path) -> None:
    path = text_file(tmp_path / "grid.dmi", "F(CONCAVE$\n" * 500_000)
    with pytest.raises(InputError, match="no measured points"):
        read_measured_grid(path)


# Other formats


def test_xml_with_entities_or_deep_nesting_is_refused(tmp_path: Path, tmp_path_factory: pytest.TempPathFactory) -> None:
    path = tmp_path / "pair.rexs"
    secret = text_file(tmp_path_factory.mktemp("outside") / "secret.txt", "root:secret")
    bomb = '<?xml version="1.0"?><!DOCTYPE m [<!ENTITY a "x"><!ENTITY b "&a;&a;">]><model>&b;</model>'
    outside = f'<?xml version="1.0"?><!DOCTYPE m [<!ENTITY a SYSTEM "{secret.as_uri()}">]><model>&a;</model>'
    for content in (
        bomb,
        outside,
        "<model>" + "<a>" * 20_000,
        "<model>" + "<a>" * 5_000 + "</a>" * 5_000 + "</model>",
    ):
        path.write_text(content, encoding="utf-8")
        said = refused("convert", path, "-o", tmp_path / "out.toml")
        assert "root:" not in said
    assert os.listdir(tmp_path) == ["pair.rexs"]


def test_a_script_of_very_many_words_ends(tmp_path: Path) -> None:
    path = text_file(tmp_path / "pair.ses", "\n".join(["EXIT " * 9000] * 20))
    with pytest.raises(InputError, match="hand of the pinion"):
        read_session_script(path)


@pytest.mark.parametrize(
    "content",
    ["[" * 100_000, "[]", "null", '{"share": 1}', '{"boundary_friction": ' + "9" * 5000 + "}", "\x00"],
)
def test_a_formula_that_is_none_is_refused(tmp_path: Path, content: str) -> None:
    path = text_file(tmp_path / "formula.json", content)
    with pytest.raises(InputError):
        read_formula(path)


def test_damaged_records_of_a_checkpoint_are_computed_anew(tmp_path: Path) -> None:
    path = tmp_path / "squares.jsonl"
    Checkpoint(path, "table of squares", encode=int, decode=int).add("2", 4)
    with path.open("a", encoding="utf-8") as file:
        file.write(
            "\n" + "[" * 100_000 + '\n{"key": [], "record": {}}\nnull\n"x"\n{"key": "3", "record": ' + "9" * 5000 + "}"
            '\n{"key": "4", "record": 1' + "0" * 400 + "}"
        )
    resumed = Checkpoint(path, "table of squares", encode=int, decode=int)
    assert (resumed.get("2"), resumed.get("3"), resumed.get("4")) == (4, None, None)


@pytest.mark.thorough
def test_measurements_of_a_comparison_that_are_none_are_made_anew(tmp_path: Path) -> None:
    problem = ContactProblem([0.0, 1e-3], [50.0, 50.0], 1e4, ([1e-5, 1e-5], [[1e-3], [2e-3]]))
    write_problems([problem], tmp_path / "p.nc")
    words = ["compare", tmp_path / "p.nc", "-o", tmp_path / "c", "--solvers", "native", "--repetitions", "1"]
    output_of(*words)
    (measured,) = (tmp_path / "c").glob("*.jsonl")
    text = measured.read_text(encoding="utf-8")
    for old, new in (
        ('"equilibrium": ', '"equilibrium": [1], "x": '),
        ('"claim": "solved"', '"claim": 5'),
        ('"polished": ', '"polished": "False", "x": '),
    ):
        assert old in text
        measured.write_text(text.replace(old, new), encoding="utf-8")
        output_of(*words)


def test_arrays_that_unpack_hugely_or_are_damaged_are_refused(tmp_path: Path) -> None:
    problem = ContactProblem([0.0, 1e-3], [50.0, 50.0], 1e4, ([1e-5, 1e-5], [[1e-3], [2e-3]]))
    path = tmp_path / "p.npz"
    write_npz(problem, path)
    assert read_npz(path).identical(problem)
    content = path.read_bytes()
    random = np.random.default_rng(3)
    for trial in range(60):
        spoilt_bytes = bytearray(content[: random.integers(len(content))] if trial % 4 == 0 else content)
        for at in random.integers(0, max(len(spoilt_bytes), 1), 5 if spoilt_bytes else 0):
            spoilt_bytes[at] = random.integers(256)
        path.write_bytes(bytes(spoilt_bytes))
        with contextlib.suppress(InputError):
            read_npz(path)
    header = b"\x93NUMPY\x01\x00" + (118).to_bytes(2, "little")
    header += b"{'descr': '<f8', 'fortran_order': False, 'shape': (10000000000,), }".ljust(117) + b"\n"
    with zipfile.ZipFile(path, "w", zipfile.ZIP_DEFLATED) as archive:
        archive.writestr("contact_separation.npy", header)
    with pytest.raises(InputError, match="longer than its entry"):
        read_npz(path)


# The store of condensed teeth


def test_a_kept_tooth_that_is_not_what_was_kept_is_made_anew(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("EASEOFF_CACHE", str(tmp_path))
    shapes = {"factor": (None, 3), "profile": (2,)}

    def arrays(value: float) -> dict[str, np.ndarray]:
        return {"factor": np.full((2, 3), value), "profile": np.array([0.0, value])}

    def made(value: float, key: str) -> tuple[float, bool]:
        """The value that the store gives, and whether it was made anew."""
        asked = []

        def make() -> dict[str, np.ndarray]:
            asked.append(key)
            return arrays(value)

        return float(kept(key, shapes, make)["factor"][0, 0]), bool(asked)

    mine, other = key_of("mine"), key_of("other")
    assert made(1.0, mine) == (1.0, True)
    assert made(2.0, other) == (2.0, True)
    path, foreign = tmp_path / f"{mine}.npz", (tmp_path / f"{other}.npz").read_bytes()
    good = path.read_bytes()
    assert made(1.0, mine) == (1.0, False)
    with np.load(path) as stored:
        own = {name: stored[name] for name in stored.files}
    spoilt_files: list[Callable[[], object]] = [
        lambda: path.write_bytes(foreign),  # another pair's file under this name
        lambda: np.savez(path, **{**own, **arrays(2.0)}),  # another pair's arrays under this key
        lambda: np.savez(path, **{name: array for name, array in own.items() if name != "profile"}),
        lambda: np.savez(path, **{name: array for name, array in own.items() if name != "digest"}),
        lambda: np.savez(path, **{**own, "factor": np.zeros((2, 4))}),
        lambda: path.write_bytes(good[:200]),
        lambda: path.write_bytes(b""),
    ]
    for spoil in spoilt_files:
        spoil()
        assert made(1.0, mine) == (1.0, True)  # found out
        assert made(1.0, mine) == (1.0, False)  # and replaced


# All that is kept from one run to the next: teeth, batches of a sweep, measurements, rows of a study


def tooth(folder: Path) -> object:
    """The numbers of a coarse tooth. The modes of its body, which are not what is kept, are shared by all tests."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setenv("EASEOFF_CACHE", str(folder))
        made = finite_element_tooth(gear_pair(read_case("nasa-12x36")), "gear", STEEL, fineness=0.25)
    return made.flank.factor


def swept(folder: Path) -> object:
    found = sweep(SWEPT, {"E": [0.0, 0.02]}, torques=[100.0], workers=1, store=folder)
    return [found[name].values for name in ("max_pressure", "status", "reason")]


def compared(folder: Path) -> object:
    """Measurements of a solver that were not made, but given."""
    problem = ContactProblem([0.0, 1e-3], [50.0, 50.0], 1e4, ([1e-5, 1e-5], [[1e-3], [2e-3]]))
    with pytest.MonkeyPatch.context() as patch, TemporaryDirectory() as other:
        give_measurements(patch)
        write_problems([problem], f"{other}/p.nc")
        table = comparison.compare([f"{other}/p.nc"], folder, solvers=["native"], repetitions=1)
    return [table[name].values for name in ("run_time", "call_time", "claim", "rotation_error")]


def studied(folder: Path) -> object:
    row = {**dict.fromkeys(NUMBERS, 0.01), "status": 0.0}
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(study_design, "run_case", lambda *_: row)
        found = study_design.run_study(folder / "study.nc", 2)
    return [found[name].values for name in NUMBERS]


DAMAGE: dict[str, Callable[[bytes], bytes]] = {
    "empty": lambda content: b"",
    "cut": lambda content: content[: len(content) // 2],
    "garbage": lambda content: np.random.default_rng(1).bytes(len(content)),
    **{
        f"bit {place}": lambda content, place=place: flipped(content, place * (len(content) - 1) // 7)  # type: ignore[misc]
        for place in range(8)
    },
}


def flipped(content: bytes, place: int) -> bytes:
    return content[:place] + bytes([content[place] ^ 1 << place % 8]) + content[place + 1 :]


def files_kept(folder: Path) -> list[Path]:
    """What the runs themselves wrote to go on from, without results."""
    return sorted(path for path in folder.iterdir() if path.suffix not in (".nc", ".damaged"))


def owned_by_another(folder: Path) -> None:
    if hasattr(os, "geteuid") and os.geteuid() == 0:
        for path in files_kept(folder):
            os.chown(path, 4711, 4711)


KEPT = {"tooth": tooth, "swept": swept, "compared": compared, "studied": studied}


@pytest.mark.quick(6)
@pytest.mark.filterwarnings("ignore:.*is damaged. it is begun anew")
@pytest.mark.parametrize("damage", DAMAGE)
@pytest.mark.parametrize("run", KEPT)
def test_what_is_kept_is_made_anew_where_it_is_damaged(
    run: str, damage: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Each file and, if there are several, all of them, whoever owns them; what is intact stays."""
    analyse_points_once(monkeypatch)
    right = KEPT[run](tmp_path)
    whole = {path: path.read_bytes() for path in files_kept(tmp_path)}
    assert whole
    for some in {*((path,) for path in whole), tuple(whole)}:
        for path in some:
            path.write_bytes(DAMAGE[damage](whole[path]))
        owned_by_another(tmp_path)
        np.testing.assert_equal(KEPT[run](tmp_path), right, err_msg=str(some))
        made = {path: path.read_bytes() for path in files_kept(tmp_path)}
        assert made.keys() == whole.keys()
        np.testing.assert_equal(KEPT[run](tmp_path), right)
        assert {path: path.read_bytes() for path in files_kept(tmp_path)} == made


@pytest.mark.quick(1)
@pytest.mark.filterwarnings("ignore:.*is damaged. it is begun anew")
@pytest.mark.parametrize("run", KEPT)
def test_four_that_start_at_once_on_damaged_files_are_right(
    run: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    analyse_points_once(monkeypatch)
    right = KEPT[run](tmp_path)
    for path in files_kept(tmp_path):
        path.write_bytes(DAMAGE["garbage"](path.read_bytes()))
    in_copies(4, lambda _: np.testing.assert_equal(KEPT[run](tmp_path), right))
    np.testing.assert_equal(KEPT[run](tmp_path), right)


@pytest.mark.parametrize("run", KEPT)
def test_folder_that_cannot_be_written_is_told_of(run: str, tmp_path: Path) -> None:
    """Teeth are made all the same; what shall be gone on from is refused before the work."""
    folder = text_file(tmp_path / "file", "") / "folder"
    if run == "tooth":
        with pytest.warns(UserWarning, match="is not kept: .*cannot be written"):
            tooth(folder)
    else:
        with pytest.raises(InputError, match="cannot be written"):
            KEPT[run](folder)


# Files that a case names


SECRET = "Kq7-secret-4711"
FRICTION = "\n[friction]\nspeed = 500\noil = '{}'\n"


def test_a_case_opens_no_file_outside_its_folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    folder = tmp_path / "strange"
    folder.mkdir()
    monkeypatch.chdir(tmp_path)
    (tmp_path / "secret.toml").write_text(f'key = 1\n[key]\nx = "{SECRET}"\n[{SECRET}', encoding="utf-8")
    (folder / "link.toml").symlink_to(tmp_path / "secret.toml")
    (folder / "plain").write_text(SECRET, encoding="utf-8")
    case, output = folder / "case.toml", tmp_path / "out.nc"
    outside = [
        "../secret.toml",
        str(tmp_path / "secret.toml"),
        "link.toml",
        "../absent.toml",
        "/etc/passwd",
        "sub/../../x",
    ]
    answers = set()
    for oil in outside:
        case.write_text(small_text(more=SHELLS + FRICTION.format(oil)), encoding="utf-8")
        said = refused("run", case, "-o", output)
        assert "--allow-outside" in said
        assert SECRET not in said
        answers.add(said.replace(repr(oil), "OIL"))
        with pytest.raises(InputError, match="allow_outside=True"):
            read_case(case)
        with pytest.raises(InputError, match="allow_outside=True"):
            parse_case(case.read_text(encoding="utf-8"), folder=folder)
    assert len(answers) == 1  # whether there is such a file is not told
    case.write_text(small_text(more=SHELLS + FRICTION.format("plain")), encoding="utf-8")
    said = refused("run", case, "-o", output)
    assert "ends in .toml" in said
    assert SECRET not in said
    assert sorted(os.listdir(tmp_path)) == ["secret.toml", "strange"]


COMMANDS = {
    "run": ["-o", "out.nc", "--torque", "50"],
    "problems": ["-o", "out.nc", "--torque", "50"],
    "wear": ["-o", "out.nc", "--torque", "50", "--revolutions", "1e3"],
    "modify": ["-o", "out.nc", "--torque", "50", "--order", "2"],
    "verify": ["--torque", "50"],
    "export": ["-o", "out.csv"],
    "convert": ["-o", "out.rexs"],
    "correct": ["--deviation", "gear=nothing"],
}


@pytest.mark.parametrize("command", COMMANDS)
def test_every_command_asks_for_the_word(tmp_path: Path, monkeypatch: pytest.MonkeyPatch, command: str) -> None:
    (tmp_path / "away").mkdir()
    case = text_file(tmp_path / "away" / "case.toml", small_text(more=SHELLS + FRICTION.format("../mine.toml")))
    monkeypatch.chdir(tmp_path)
    assert "--allow-outside" in refused(command, case, *COMMANDS[command])
    said = refused(command, case, *COMMANDS[command], "--allow-outside")  # there is no such oil
    assert "there is no" in said
    assert os.listdir(tmp_path) == ["away"]


def test_with_the_word_it_is_opened(tmp_path: Path) -> None:
    (tmp_path / "away").mkdir()
    oil = Path(easeoff.__file__).parent / "friction" / "lubricants" / "75w90.toml"
    shutil.copy(oil, tmp_path / "mine.toml")
    case = text_file(tmp_path / "away" / "case.toml", small_text(more=SHELLS + FRICTION.format("../mine.toml")))
    table = read_case(case, allow_outside=True).friction
    assert table is not None
    assert table.operation().lubricant.name == "mine"
    output_of("export", case, "-o", tmp_path / "o.csv", "--allow-outside")
