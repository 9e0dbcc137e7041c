"""What a new user types or leaves lying about: refused with a message that says what to write, never misread."""

from __future__ import annotations

import hashlib
import shutil
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
import xarray as xr
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure
from netCDF4 import Dataset
from runs import SHELLS, call, output_of, read_only, refusal_of, small_file

import easeoff
from easeoff.cases import case_text, read_case, write_case
from easeoff.core.netcdf_file import FAULT_COUNT_LIMIT
from easeoff.friction import lubricant
from easeoff.study.cli import main
from easeoff.study.cli.command import Command
from easeoff.study.cli.result_commands import draw
from easeoff.study.plot import written_pictures
from easeoff.study.plot.written_pictures import PICTURES, pictures_of_results
from easeoff.study.result import faults
from easeoff.study.summary.result_summary import result_summary

RUN = ["run", "nasa-12x36", "-o", "{tmp}/x.nc"]
WEAR = ["wear", "nasa-12x36", "-o", "{tmp}/x.nc"]
FRICTION = "\n[friction]\nspeed = 500.0\n"


@pytest.fixture(scope="module")
def result(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A result with friction."""
    folder = tmp_path_factory.mktemp("result")
    output_of("run", small_file(folder, more=SHELLS + FRICTION), "-o", folder / "x.nc", "--torque", "50")
    return folder / "x.nc"


@pytest.fixture(scope="module")
def read(result: Path) -> xr.DataTree:
    """The same, read."""
    return read_only(easeoff.read_result(result))


@pytest.fixture
def blank_pictures(monkeypatch: pytest.MonkeyPatch) -> None:
    """Every picture is an empty page."""
    monkeypatch.setattr(written_pictures, "draw_picture", lambda *_, **__: FigureCanvasAgg(Figure((1, 1))).figure)


def test_every_command_refuses_what_comes_twice() -> None:
    assert all(isinstance(command, Command) for command in main.commands.values())


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        ([*RUN, "--misalignment", "E=0.1", "--misalignment", "P=0.1"], "--misalignment: must come once, but comes tw"),
        ([*RUN, "--torque", "5", "--torque", "6", "--torque=7"], "--torque: must come once, but comes 3 times"),
        ([*RUN, "--output", "{tmp}/y.nc"], "--output: must come once"),
        ([*RUN, "--flank", "drive", "--flank", "coast"], "--flank: must come once"),
        ([*RUN, "--edge-contact", "--lines-only"], "--edge-contact/--lines-only: must come once"),
        (["export", "nasa-12x36", "-o", "{tmp}/x.csv", "--rows", "3", "--rows", "4"], "--rows: must come once"),
        ([*RUN, "--misalignment", "E=0.1,", "P=-0.1"], "--misalignment = 'E=0.1,': ends in a comma; leave out"),
        ([*RUN, "--misalignment", "E=0.1", "P=-0.1"], "'P=-0.1': belongs to no option; a blank ends a value"),
        ([*RUN, "--torque", "50,", "150"], "--torque = '50,': ends in a comma"),
        ([*RUN, "--torque", "50", ",150"], "',150': belongs to no option"),
        ([*RUN, "--torque", "50", "150"], "'150': belongs to no option"),
        ([*RUN, "--torque", "50,5"], "in a list must increase, as in 5,50; a decimal has a point: 50.5"),
        ([*RUN, "--torque", "50,5,100"], "in a list must increase, as in 5,50,100"),
        ([*RUN, "--torque", "800,400"], "in a list must increase, as in 400,800"),
        ([*RUN, "--torque", "30,0"], "'30,0': a decimal has a point: 30.0"),
        ([*RUN, "--torque", "0,5"], "'0,5': a decimal has a point: 0.5"),
        ([*RUN, "--torque", "50,05"], "'50,05': a decimal has a point: 50.05"),
        ([*RUN, "--torque", "9" * 5000 + ",5"], "a decimal has a point"),
        ([*RUN, "--speed", "500,5"], "whole numbers in a list must increase"),
        ([*RUN, "--speed", "500", "--temperature", "90,5"], "a decimal has a point: 90.5"),
        ([*RUN, "--speed", "500", "--roughness", "0,8"], "'0,8': a decimal has a point: 0.8"),
        ([*RUN, "--speed", "500", "--roughness", "0.8/0,5"], "'0,5': a decimal has a point: 0.5"),
        ([*RUN, "--speed", "500", "--friction-model", "0,06"], "decimals have a point: 0.06"),
        ([*RUN, "--speed", "5:6:1"], "COUNT = 1: must lie between 2 and 10000"),
        ([*RUN, "--misalignment", "E=0,1"], "'1' has no key; a decimal has a point"),
        ([*WEAR, "--torque", "50,5", "--revolutions", "9"], "'50' has no share"),
        ([*WEAR, "--torque", "100=0,7,300=0,3", "--revolutions", "9"], "'7' has no share"),
        ([*WEAR, "--torque", "50", "--revolutions", "9,5"], "--revolutions = '9,5': must be one number; decimals"),
        ([*WEAR, "--torque", "5", "--revolutions", "9", "--coefficient", "1,5e-12"], "a decimal has a point"),
    ],
)  # fmt: skip
def test_values_that_would_be_misread_are_refused(arguments: list[str], words: str, tmp_path: Path) -> None:
    said = refusal_of(*(argument.format(tmp=tmp_path) for argument in arguments))
    assert words in " ".join(said.split())
    assert not list(tmp_path.iterdir())


def test_blanks_after_commas_and_lists_with_a_point_are_read(tmp_path: Path) -> None:
    friction = ("--speed", "500", "--temperature", "40.0,30", "--roughness", "0.8 / 0.4, 0.2")
    for misalignment, torque in (("E=0.1, P=-0.1", "50, 150"), (" E = 0.1 , P = -0.1 ", "150.0,50")):
        options = ["--misalignment", misalignment, "--torque", torque]
        given = main.commands["run"].make_context("run", ["nasa-12x36", "-o", "x.nc", *options]).params
        assert (given["misalignment"].offset, given["misalignment"].pinion_axial) == (0.1, -0.1)
        assert given["torques"] == (50.0, 150.0)
    output_of("run", small_file(tmp_path, more=SHELLS), "-o", tmp_path / "x.nc", *options, *friction)
    tree = easeoff.read_result(tmp_path / "x.nc")
    assert [tree.attrs[f"misalignment_{key}_mm"] for key in ("offset", "pinion_axial")] == [0.1, -0.1]
    assert list(tree["loaded"].to_dataset()["torque"].values) == [50.0, 150.0]
    assert list(tree["friction"].to_dataset()["roughness_pinion"].values) == [0.8, 0.2]
    assert list(tree["friction"].to_dataset()["temperature"].values) == [40.0, 30.0]


@pytest.mark.usefixtures("blank_pictures")
def test_pictures_of_an_earlier_result_do_not_stay(
    result: Path, read: xr.DataTree, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    """Of the same case and flank; those of other cases, and what is no picture of a result, stay."""
    folder, ours = tmp_path / "pictures", "nasa-12x36-drive-"
    said = output_of("plot", result, folder)
    assert "replaced" not in said
    assert "removed" not in said
    first = {path.name for path in pictures_of_results(folder)}
    assert first == {f"{ours}{name}.png" for name in (*PICTURES, "friction_maps", "efficiency")}
    own = {"photo.png": b"no picture", "notes.txt": b"mine", f"{ours}mine.png": b"", f"{ours}mine.svg": b"<"}
    for name, content in own.items():
        (folder / name).write_bytes(content)
    tree = read.copy(deep=False)
    del tree["friction"]
    other = tree.copy(deep=False)
    other.attrs |= {"case_name": "fm-11x41", "title": "Another pair"}
    draw(other, folder)
    assert "removed" not in capsys.readouterr().out
    others = {f"fm-11x41-drive-{name}.png" for name in PICTURES}
    assert {path.name for path in folder.iterdir()} == {*own, *first, *others}
    for suffix in ("svg", "pdf"):
        written_pictures.write_pictures(read, folder, names="efficiency", file_format=suffix)
    draw(tree, folder)
    told = capsys.readouterr().out
    for name in ("friction_maps.png", "efficiency.png", "efficiency.svg", "efficiency.pdf"):
        assert f"removed {folder / ours}{name}, a picture of an earlier result" in told
    assert {path.name for path in folder.iterdir()} == {*own, *others, *(f"{ours}{name}.png" for name in PICTURES)}
    assert all((folder / name).read_bytes() == content for name, content in own.items())


def test_an_edited_case_is_not_replaced_unless_asked(tmp_path: Path) -> None:
    path = tmp_path / "mine.toml"
    write = ("convert", "nasa-12x36", "-o", path)
    output_of(*write)
    output_of(*write)  # nobody edited it
    path.write_text(path.read_text(encoding="utf-8").replace("300.0", "250.0"), encoding="utf-8")
    edited = path.read_bytes()
    for refused in (write, ("design", "fm-11x41", "-o", path)):
        assert f"{path} was edited after easeoff wrote it: give another name, or --force" in refusal_of(*refused)
        assert path.read_bytes() == edited
    said = call("modify", "nasa-12x36", "-o", tmp_path / "best.nc", "--fitted-case", path)
    assert "was edited after easeoff wrote it" in said.output
    assert [found.name for found in tmp_path.iterdir()] == ["mine.toml"]
    output_of(*write, "--force")
    assert read_case(path).contact.torques == read_case("nasa-12x36").contact.torques


@pytest.mark.parametrize("content", [b"", b"# by hand\n", b"\xff\xfe", b"checksum"])
def test_a_file_by_hand_is_not_replaced(content: bytes, tmp_path: Path) -> None:
    path = tmp_path / "hand.toml"
    path.write_bytes(content)
    said = refusal_of("convert", "nasa-12x36", "-o", path)
    assert "hand.toml was not written by easeoff: give another name, or --force" in said
    assert path.read_bytes() == content


def test_the_checksum_is_of_the_lines_above_it(tmp_path: Path) -> None:
    write_case(read_case("nasa-12x36"), tmp_path / "x.toml", "my pair")
    *above, last = (tmp_path / "x.toml").read_text(encoding="utf-8").splitlines(keepends=True)
    assert last.split()[-1] == hashlib.sha256("".join(above).encode()).hexdigest()[:12]


@pytest.mark.usefixtures("blank_pictures")
def test_what_is_written_names_the_next_command(tmp_path: Path) -> None:
    case = small_file(tmp_path, more=SHELLS)
    problems, wear = tmp_path / "problems.nc", tmp_path / "wear.nc"
    said = call("problems", case, "-o", problems, "--torque", "50")
    assert said.output.endswith(f"next: easeoff compare {problems}\n")
    said = call("wear", case, "-o", wear, "--torque", "50", "--revolutions", "1")
    assert f"easeoff run {case} --deviation pinion={wear} --deviation gear={wear} -o RESULT.nc" in said.output
    refusal_of("run", case, "-o", tmp_path / "x.nc", "--torque", "5:6:3", "--plots", tmp_path / "p")  # no such form
    many = ",".join(str(torque) for torque in range(10, 20))
    said = call("run", case, "-o", tmp_path / "x.nc", "--torque", many, "--plots", tmp_path / "p")
    assert "30 of 30 mesh positions certified at 10 torques from 10 to 19 N m; greatest pressure" in said.output
    assert said.output.splitlines()[-1] == f"next: easeoff show {tmp_path / 'x.nc'}"


@pytest.mark.parametrize(
    ("old", "new", "words"),
    [
        ("ratio_of_roll = 3.", "ratio_of_roll = 3,", "a decimal has a point: 3.2"),
        ("[50.0, 150.0, 300.0]", "[50,5]", "'torques = [50,5]': a list of two values, 50 and 5; if that is meant"),
        ("cradle_angle", "cradel_angle", "did you mean 'cradle_angle'?"),
        ("[contact]", "[contcat]", "did you mean 'contact'?"),
        ("\n[pinion]", f"\nx = {'[' * 5000}", "is not a TOML file"),
        ("[pair]", f"[pair]\nshaft_angle = {'9' * 5000}", "is not a TOML file"),
    ],
)
def test_mistakes_in_a_case_file_show_what_to_write(old: str, new: str, words: str, tmp_path: Path) -> None:
    path = tmp_path / "mine.toml"
    text = case_text("nasa-12x36")
    assert old in text
    path.write_text(text.replace(old, new), encoding="utf-8")
    assert words in refusal_of("run", path, "-o", tmp_path / "x.nc")
    assert not (tmp_path / "x.nc").exists()


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        (["run", "nasa-12x36"], "Missing option '-o' / '--output'. netCDF file to write."),
        (["show", "nasa-12x36"], "nasa-12x36 is a case, not a result: make one with 'easeoff run nasa-12x36 -o FILE'"),
        (
            ["plot", "mine.toml", "p"],
            "mine.toml is not a netCDF file; of a case make a result: 'easeoff run",
        ),
        (["design", "nasa-12x36", "-o", "x.toml"], "nasa-12x36 is a case already: analyse it with 'easeoff run"),
        (["show", "{tmp}/empty.nc"], "empty.nc is empty"),
        (["run", "{tmp}/empty.toml", "-o", "x.nc"], "empty.toml is empty"),
    ],
)
def test_a_file_of_another_kind_or_none_is_named(arguments: list[str], words: str, tmp_path: Path) -> None:
    for name in ("empty.nc", "empty.toml"):
        (tmp_path / name).touch()
    said = refusal_of(*(argument.format(tmp=tmp_path) for argument in arguments))
    assert words in " ".join(said.split())


def test_a_number_out_of_range_is_told_with_its_unit(tmp_path: Path) -> None:
    steel = "\n[pinion.material]\nelastic_modulus = 210\n"
    (tmp_path / "mine.toml").write_text(case_text("nasa-12x36") + steel, encoding="utf-8")
    said = call("run", tmp_path / "mine.toml", "-o", tmp_path / "x.nc")
    assert "pinion.material.elastic_modulus = 210: must be greater than 500 [MPa]" in said.output


@pytest.mark.parametrize(
    ("name", "words"),
    [
        ("FM-11X41", "did you mean 'fm-11x41'?"),
        ("{tmp}/mine.tml", "did you mean '{tmp}/mine.toml'?"),
        ("{tmp}/mine", "did you mean '{tmp}/mine.toml'?"),
        ("{tmp}", "is a folder: give the name of a file"),
        ("{tmp}/pair.rexs", "is a REXS file: make a case of it with 'easeoff convert'"),
        ("{tmp}/pair.nc", "is a netCDF file, such as a result: 'easeoff show' shows one"),
    ],
)
def test_names_of_cases_that_are_none_are_told_what_is_near(name: str, words: str, tmp_path: Path) -> None:
    for file in ("mine.toml", "pair.rexs", "pair.nc"):
        (tmp_path / file).touch()
    assert words.format(tmp=tmp_path) in refusal_of("run", name.format(tmp=tmp_path), "-o", tmp_path / "x.nc")


def test_a_case_with_a_byte_order_mark_is_read(tmp_path: Path) -> None:
    (tmp_path / "mine.toml").write_text(case_text("nasa-12x36"), encoding="utf-8-sig")
    assert read_case(tmp_path / "mine.toml").text == case_text("nasa-12x36")


def test_an_oil_with_a_number_no_float_holds_is_refused(tmp_path: Path) -> None:
    (tmp_path / "oil.toml").write_text(
        f'title = "x"\nsource = "y"\ntemperature = [40, {10**400}]\ndynamic_viscosity = [0.1, 0.01]\n'
        "pressure_viscosity = [20, 15]\n",
        encoding="utf-8",
    )
    with pytest.raises(easeoff.InputError, match="temperature: must be a whole number of at most 64 bits"):
        lubricant(tmp_path / "oil.toml")


@pytest.mark.usefixtures("reading_here")
def test_a_result_without_a_title_is_shown(result: Path, tmp_path: Path) -> None:
    path = Path(shutil.copy(result, tmp_path / "x.nc"))
    with Dataset(path, "a") as file:
        file.setncattr("title", "")
    assert result_summary(easeoff.read_result(path)).startswith("untitled\n========\n")


@pytest.mark.usefixtures("reading_here")
def test_a_result_file_that_was_changed_is_refused_with_what_it_lacks(result: Path, tmp_path: Path) -> None:
    path = Path(shutil.copy(result, tmp_path / "x.nc"))
    with Dataset(path, "a") as file:
        file["loaded"].renameVariable("force", "load")
        file.delncattr("pinion_teeth")
        file.setncattr("edge_contact", "x")
    for arguments in (("show", path), ("plot", path, tmp_path / "pictures")):
        said = refusal_of(*arguments)
        assert "x.nc is damaged, changed by hand or made by another version of easeoff: " in said
        for words in ("loaded: no numbers 'force' over torque", "root: no number in the attribute 'pinion_teeth'"):
            assert words in said
        assert "root: no number in the attribute 'edge_contact'" in said
    assert [file.name for file in tmp_path.iterdir()] == ["x.nc"]


@pytest.mark.parametrize(
    ("group", "change", "words"),
    [
        ("loaded", lambda data: data.rename(force="load"), "loaded: no numbers 'force' over torque"),
        ("flanks", lambda data: data.rename_dims(lengthwise="x"), "flanks: no numbers 'position' over member"),
        ("friction", lambda data: data.rename_dims(speed="x"), "friction: no numbers 'friction_coefficient'"),
        ("loaded", lambda data: data.assign_attrs(searched_segments="many"), "no number in the attribute 'searched_"),
        ("/", lambda data: data.assign_attrs(pinion_teeth=None), "root: no number in the attribute 'pinion_teeth'"),
        ("ease_off", lambda data: data.assign_attrs(gear_axis=np.ones(2)), "no vector in the attribute 'gear_axis'"),
        ("flanks", lambda data: data + 1e300, "'position' holds numbers beyond 1e+30"),
        ("teeth", None, "no group teeth"),
        ("/", lambda data: data.assign_attrs(edge_contact="x"), "root: no number in the attribute 'edge_contact'"),
        (
            "/",
            lambda data: data.assign_attrs(largest_deviation_gear_um=np.ones(2)),
            "no number in the attribute 'largest_deviation_gear_um'",
        ),
        ("/", lambda data: data.assign_attrs(modification_um="{"), "no table of numbers in the attribute 'modif"),
        ("unloaded", lambda data: data.assign_attrs(harmonics=-1.0), "no vector in the attribute 'harmonics'"),
        ("unloaded", lambda data: data.rename(contact_ratio="x"), "unloaded: no numbers 'contact_ratio'"),
        ("light_load", lambda data: data.rename(pattern_length="x"), "light_load: no numbers 'pattern_length'"),
        ("friction", lambda data: data.rename_dims(formula_flag="x"), "friction: no numbers 'flagged_share'"),
    ],
)
def test_what_a_changed_result_lacks_is_told(
    group: str, change: Callable[[xr.Dataset], xr.Dataset] | None, words: str, read: xr.DataTree
) -> None:
    tree = read.copy(deep=False)
    assert faults(tree) == []
    if change is None:
        del tree[group]
    else:
        tree[group].dataset = change(tree[group].to_dataset())
    assert words in "; ".join(faults(tree)[:FAULT_COUNT_LIMIT])
