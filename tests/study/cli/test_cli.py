"""The command line: options, results, mistakes and help, and the completion of its words."""

from __future__ import annotations

import gc
import os
import re
import resource
import shutil
import signal
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest
import xarray as xr
from click.testing import CliRunner
from runs import SHELLS, call, output_of, read_only, refusal_of, small_text, text_file
from session_scripts import MACHINES, script

import easeoff
from easeoff import InputError
from easeoff.cases import case_text, design_text, shipped_cases, shipped_designs, shipped_supports
from easeoff.contact import read_problems
from easeoff.contact.problem.exchange.problem_file import read_labels
from easeoff.core.forked_process import in_forked_process
from easeoff.core.process_settings import without_garbage_collection
from easeoff.friction import available_lubricants
from easeoff.study import shipped_deviations
from easeoff.study.analysis.contact_analysis import case_torques
from easeoff.study.cli import main
from easeoff.study.cli.command import PROGRAM
from easeoff.study.compare.problem_export import check_problem_output
from easeoff.study.plot import write_pictures
from easeoff.study.plot.written_pictures import PICTURES
from easeoff.study.summary.result_summary import result_summary

RUN = ["run", "nasa-12x36", "-o", "{tmp}/x.nc"]
WEAR = ["wear", "nasa-12x36", "--torque", "5", "--revolutions", "1"]


@pytest.fixture(scope="module")
def case(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The published pair with few mesh positions."""
    return text_file(tmp_path_factory.mktemp("case") / "small.toml", small_text(more=SHELLS))


@pytest.fixture(scope="module")
def result(case: Path, tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A result of the small case."""
    path = tmp_path_factory.mktemp("result") / "small.nc"
    output_of("run", case, "-o", path)
    return path


def test_cases_lists_names_and_titles() -> None:
    assert "nasa-12x36" in output_of("cases")


def test_cases_lists_everything_shipped_by_kind_and_how_it_is_given() -> None:
    groups = [group.splitlines() for group in call("cases").output.split("\n\n")]
    heads = ["run CASE", "design DESIGN", "--supports NAME", "--oil NAME", "--deviation MEMBER=NAME"]
    assert [head in lines[0] for head, lines in zip(heads, groups, strict=True)] == [True] * 5
    names = [[line.split()[0] for line in lines[1:]] for lines in groups]
    known = [shipped_cases(), shipped_designs(), shipped_supports(), available_lubricants(), shipped_deviations()]
    assert names == [list(kind) for kind in known]
    assert all(len(line.split()) > 1 for lines in groups for line in lines)


@pytest.fixture(scope="module")
def tree(result: Path) -> xr.DataTree:
    """The same, read."""
    return read_only(easeoff.read_result(result))


@pytest.fixture(scope="module")
def foreign_file(tmp_path_factory: pytest.TempPathFactory) -> bytes:
    """Content of a netCDF file of another program."""
    path = tmp_path_factory.mktemp("foreign") / "x.nc"
    xr.Dataset({"x": ("t", [1.0, 2.0])}).to_netcdf(path)
    return path.read_bytes()


def test_edges_touch_if_asked_and_the_summary_says_what_they_carry(case: Path, tmp_path: Path) -> None:
    for word, touch in (("--edge-contact", 1), ("--lines-only", 0)):
        out = tmp_path / f"{touch}.nc"
        output_of("run", case, "-o", out, "--torque", "900", word)
        tree = easeoff.read_result(out)
        assert tree.attrs["edge_contact"] == touch
        assert (float(tree["loaded/edge_share"].max()) > 0.01) == bool(touch)
        assert ("on edges" in result_summary(tree)) == bool(touch)


def test_run_writes_a_result_and_says_so_without_progress(case: Path, tmp_path: Path) -> None:
    out = tmp_path / "new" / "folder" / "out.nc"
    said = output_of("run", case, "-o", out, "--torque", "100,200", "--misalignment", "E=0.1,P=-0.05,Sigma=0.1")
    wrote, *notes, following = said.splitlines()
    assert all("tooth edges" in note or "the end of a contact line" in note for note in notes)
    assert wrote.startswith(f"wrote {out}: 6 of 6 mesh positions certified at 100, 200 N m; greatest pressure ")
    assert following == f"next: easeoff show {out}, or easeoff plot {out} FOLDER"
    tree = easeoff.read_result(out)
    assert tree["loaded"].to_dataset()["torque"].values.tolist() == [100.0, 200.0]
    assert tree.attrs["misalignment_offset_mm"] == 0.1
    assert tree.attrs["misalignment_shaft_angle_rad"] == pytest.approx(np.radians(0.1))
    assert [p.name for p in out.parent.iterdir()] == ["out.nc"]


def test_run_prints_the_notes_of_the_summary(case: Path, tmp_path: Path) -> None:
    """With edges that carry load, and a flank that the case leaves out."""
    text = case.read_text(encoding="utf-8")
    (tmp_path / "half.toml").write_text(re.sub(r"\[gear\.concave\..*?(?=\n\[(?!gear\.concave))", "", text, flags=re.S))
    found = call(
        "run", f"{tmp_path}/half.toml", "-o", f"{tmp_path}/x.nc", "--torque", "100", "--misalignment", "Sigma=2"
    )
    assert found.exit_code == 0, found.output
    told = [line for line in found.stderr.splitlines() if line.startswith("Note:")]
    shown = result_summary(easeoff.read_result(tmp_path / "x.nc")).split("\nNote:", 1)[1]
    assert " ".join(told) == " ".join(f"Note:{shown}".split())
    assert sum("assumed" in line for line in told) == 1


def test_problems_are_those_that_were_solved(case: Path, tmp_path: Path, tree: xr.DataTree) -> None:
    out = text_file(tmp_path / "problems.nc", "what was there")
    output_of("problems", case, "-o", out, "--torque", "150")
    problems, labels = read_problems(out), read_labels(out)
    assert len(problems) == 3
    assert labels["pinion_torque"].tolist() == [150.0] * 3
    rotations = [easeoff.contact.solve(p).rotation * 1e6 for p in problems]
    loaded = tree["loaded"].to_dataset()
    np.testing.assert_allclose(rotations, loaded["transmission_error"].sel(torque=150).values, rtol=1e-9)


def test_problems_of_a_shipped_case_may_be_written_again(tmp_path: Path) -> None:
    """Its name is no file that the output could be."""
    out = text_file(tmp_path / "problems.nc", "what was there")
    check_problem_output(out, None, None, "nasa-12x36", count=2)
    assert out.read_text() == "what was there"
    assert easeoff.read_case("nasa-12x36").contact.mesh_positions == 32


def contents(folder: Path) -> dict[str, bytes]:
    return {path.name: path.read_bytes() if path.is_file() else b"" for path in folder.iterdir()}


def test_a_full_disk_is_one_message_and_leaves_nothing(case: Path, tmp_path: Path) -> None:
    """In a process of its own, whose files may not grow beyond some kilobytes."""
    out = tmp_path / "out.nc"

    def limited() -> tuple[int, str]:
        signal.signal(signal.SIGXFSZ, signal.SIG_IGN)
        resource.setrlimit(resource.RLIMIT_FSIZE, (30_000, 30_000))
        found = call("run", case, "-o", out)
        return found.exit_code, found.stderr

    code, said = in_forked_process(limited)
    assert code == 2, said
    assert f"{out} cannot be written" in said
    assert "is there room on the disk?" in said
    assert "Traceback" not in said
    assert not list(tmp_path.iterdir())


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        (["run", "nowhere.toml", "-o", "{tmp}/x.nc"], ["nowhere.toml", "shipped cases"]),
        (["run", "nasa-12x36", "-o", "{tmp}/x.nc", "--torque", "0"], ["--torque", "0", "greater than 0"]),
        (["run", "nasa-12x36", "-o", "{tmp}/x.nc", "--torque", "-5"], ["--torque", "-5", "greater than 0"]),
        (["run", "nasa-12x36", "-o", "{tmp}/x.nc", "--torque", "nan"], ["--torque", "nan"]),
        (["run", "nasa-12x36", "-o", "{tmp}/x.nc", "--torque", "many"], ["--torque", "many", "50,250,500"]),
        (["run", "nasa-12x36", "-o", "{tmp}/x.nc", "--flank", "left"], ["--flank", "left", "drive", "coast"]),
        (["run", "nasa-12x36", "-o", "{tmp}/x.nc", "--misalignment", "Q=1"], ["Q", "E, P, G, Sigma"]),
        (["run", "nasa-12x36", "-o", "{tmp}/x.nc", "--misalignment", "E"], ["E=0.15,P=-0.12"]),
        (["run", "nasa-12x36", "-o", "{tmp}/x.nc", "--misalignment", "E=inf"], ["E=inf", "between"]),
        (["run", "nasa-12x36", "-o", "{tmp}/x.nc", "--solver", "magic"], ["magic", "native", "clarabel"]),
        (["run", "nasa-12x36", "-o", "{tmp}/x.nc", "--torque", "50,60,50"], ["50 comes twice"]),
        (["run", "nasa-12x36", "-o", "{tmp}/new/deep/x.nc", "--solver", "magic"], ["magic", "native"]),
        (["run", "nasa-12x36", "-o", "{tmp}"], ["{tmp}", "folder"]),
        (["run", "{foreign}", "-o", "{tmp}/x.nc"], ["foreign.nc", "a case is a text file, in TOML"]),
        (["run", "{design}", "-o", "{tmp}/x.nc"], ["design.toml is a design", "easeoff design"]),
        (["design", "{case}", "-o", "{tmp}/x.toml"], ["case.toml is a case already", "easeoff run"]),
        (["run", "{case}", "-o", "{case}"], ["case.toml is the file that is read"]),
        (["run", "{case}", "-o", "{tmp}/../{name}/case.toml"], ["case.toml is the file that is read"]),
        (["run", "nasa-12x36", "--deviation", "gear={foreign}", "-o", "{foreign}"], ["is the file that is read"]),
        (["run", "nasa-12x36", "--speed", "5", "--oil", "{text}", "-o", "{text}"], ["is the file that is read"]),
        (["design", "{design}", "-o", "{design}"], ["design.toml is the file that is read"]),
        (["convert", "{case}", "-o", "{case}"], ["case.toml is the file that is read"]),
        (["problems", "{case}", "-o", "{case}"], ["case.toml is the file that is read"]),
        (["modify", "{case}", "-o", "{case}"], ["case.toml is the file that is read"]),
        (["modify", "{case}", "-o", "{tmp}/x.nc", "--fitted-case", "{case}"], ["is the file that is read"]),
        (
            [
                "wear",
                "{case}",
                "--torque",
                "5",
                "--revolutions",
                "1",
                "--deviation",
                "gear={foreign}",
                "-o",
                "{foreign}",
            ],
            ["is the file that is read"],
        ),
        (["compare", "{foreign}", "-o", "{tmp}/study"], ["foreign.nc", "no contact problems"]),
        (["run", "nasa-12x36", "-o", "/proc/nothing/x.nc"], ["/proc/nothing/x.nc", "cannot be written"]),
        (["run", "nasa-12x36", "-o", "{pipe}"], ["pipe is a device or a pipe"]),
        (["run", "nasa-12x36"], ["--output"]),
        (["run", "nasa-12x36", "-o", "{tmp}/x.txt"], ["x.txt", "netCDF", "ends in .nc"]),
        (["problems", "nasa-12x36", "-o", "{tmp}/x.txt"], ["x.txt", "netCDF", "ends in .nc"]),
        (["modify", "nasa-12x36", "-o", "{tmp}/x.csv"], ["x.csv", "netCDF", "ends in .nc"]),
        ([*WEAR, "-o", "{tmp}/x.csv"], ["x.csv", "netCDF", "ends in .nc"]),
        ([*WEAR, "-o", "{tmp}/x.nc", "--coefficient", "0"], ["'0': nothing wears", "greater than zero"]),
        ([*WEAR, "-o", "{tmp}/x.nc", "--coefficient", "0/0"], ["'0/0': nothing wears", "greater than zero"]),
        (
            [*WEAR, "-o", "{tmp}/x.nc", "--interpolation", "smooth"],
            ["--interpolation = smooth: must go with --deviation"],
        ),
        ([*RUN, "--interpolation", "spline"], ["--interpolation = spline: must go with --deviation"]),
        ([*RUN, "--deviated", "surface"], ["--deviated = surface: must go with --deviation"]),
        ([*RUN, "--misalignment", "E=0.1,E=0.2"], ["E comes twice"]),
        (["export", "nasa-12x36", "-o", "{tmp}/x.csv", "--margins", "toe=1,toe=3"], ["toe comes twice"]),
        (["compare", "{foreign}", "{foreign}", "-o", "{tmp}/s"], ["foreign.nc comes twice"]),
        (["compare", "{foreign}", "{tmp}/../{name}/foreign.nc", "-o", "{tmp}/s"], ["foreign.nc comes twice"]),
        (["compare", "{foreign}", "-o", "{tmp}/s", "--solvers", "native,native"], ["native comes twice"]),
        ([*RUN, "--deviation", "pinion={result}"], ["result.nc is a result of an analysis, not a measured grid"]),
        (["show", "{tmp}"], ["{tmp} is a folder"]),
        (["show", "/proc/x"], ["/proc/x: there is no such file"]),
        (["plot", "{result}", "/proc/x"], ["/proc/x cannot be written"]),
        (["plot", "{result}", "{text}"], ["text.toml is a file: give a folder for the pictures"]),
        (["run", "{long}", "-o", "{tmp}/x.nc"], ["there is no such file"]),
        (["run", "{long}.toml", "-o", "{tmp}/x.nc"], ["there is no such file"]),
        (["run", "nasa-12x36", "-o", "{tmp}/{long}.nc"], ["cannot be written: File name too long"]),
        (["run", "nasa-12x36", "-o", "{tmp}/{long}/x.nc"], ["cannot be written: File name too long"]),
        ([*RUN, "--plots", "{tmp}/{long}"], ["cannot be written: File name too long"]),
        (["plot", "{long}", "{tmp}/pictures"], ["there is no such file"]),
        (["show", "{long}.nc"], ["there is no such file"]),
        ([*RUN, "--deviation", "gear={long}"], ["there is no such file"]),
        ([*RUN, "--deviation", "gear={long}.nc"], ["there is no such file"]),
        ([*RUN, "--deviation", "gear={long}.csv"], ["there is no such file"]),
        ([*RUN, "--speed", "5", "--oil", "{long}"], ["nor the path of a TOML file"]),
        (["compare", "{long}", "-o", "{tmp}/s"], ["there is no such file"]),
        (["run", "{text}", "-o", "{tmp}/x.nc"], ["not a TOML file"]),
        (["show", "{tmp}/none.nc"], ["none.nc", "no such file"]),
        (["show", "{text}"], ["not a netCDF file"]),
        (["show", "{foreign}"], ["no result of 'easeoff run'", "easeoff run"]),
        (["plot", "{foreign}", "{tmp}/pictures"], ["no result of 'easeoff run'"]),
        (["plot", "{foreign}", "{text}"], ["no result of 'easeoff run'"]),
        (["convert", "nasa-12x36", "-o", "{tmp}/x.nc"], ["x.nc", "'.nc'", ".toml", ".rexs", ".xml"]),
        (["convert", "{foreign}", "-o", "{tmp}/x.toml"], ["x.toml", "ends in .nc", ".mat"]),
        (["convert", "nowhere", "-o", "{tmp}/x.rexs"], ["nowhere", "shipped cases"]),
        (["convert", "{tmp}/none.rexs", "-o", "{tmp}/x.toml"], ["Error: {tmp}/none.rexs: there is no such file"]),
        (["convert", "{tmp}/none.ses", "-o", "{tmp}/x.toml"], ["Error: {tmp}/none.ses: there is no such file"]),
        (["convert", "{text}", "-o", "{tmp}/x.rexs"], ["not a TOML file"]),
        (["convert", "nasa-12x36"], ["--output"]),
    ],
)
def test_mistakes_give_one_message_and_exit_code_2(
    arguments: list[str], words: list[str], tmp_path: Path, result: Path, foreign_file: bytes
) -> None:
    text, foreign, case, design = (tmp_path / f for f in ("text.toml", "foreign.nc", "case.toml", "design.toml"))
    text.write_text("no case at all", encoding="utf-8")
    case.write_text(case_text("nasa-12x36"), encoding="utf-8")
    design.write_text(design_text("fh-design-a"), encoding="utf-8")
    foreign.write_bytes(foreign_file)
    pipe = tmp_path / "pipe"
    os.mkfifo(pipe)
    files = {"text": str(text), "foreign": str(foreign), "case": str(case), "design": str(design), "pipe": str(pipe)}
    files["result"] = str(tmp_path / "result.nc")
    if "{result}" in "".join(arguments):
        shutil.copy(result, files["result"])
    before = contents(tmp_path)
    places = {"tmp": str(tmp_path), "name": tmp_path.name, "long": 300 * "x", **files}
    found = call(*(a.format(**places) for a in arguments))
    assert found.exit_code == 2, found.output
    assert isinstance(found.exception, SystemExit)
    # A long message may be framed and broken into lines.
    said = " ".join(found.output.split())
    for word in words:
        assert word.format(**places) in said, found.output
    assert "picture.png" not in found.output
    assert "Traceback" not in found.output
    assert contents(tmp_path) == before


def test_a_result_with_the_longest_name_is_written_over_an_old_one_and_shown(
    case: Path, result: Path, tmp_path: Path
) -> None:
    out = Path(shutil.copy(result, tmp_path / (252 * "x" + ".nc")))
    output_of("run", case, "-o", out, "--torque", "50")
    assert out.read_bytes() != result.read_bytes()
    said = output_of("show", out)
    for word in ("NASA 12x36", "peak to peak", "certified", "3 of 3", "drive"):
        assert word in said
    assert [path.name for path in tmp_path.iterdir()] == [out.name]


def test_a_name_of_a_case_is_no_file(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    for _ in range(2):
        output_of("convert", "nasa-12x36", "-o", "nasa-12x36.toml")


def test_python_takes_one_torque_as_a_number_too_and_its_result_survives_a_file(case: Path, tmp_path: Path) -> None:
    tree = easeoff.analyze(case, torques=75.0)
    easeoff.write_result(tree, tmp_path / "x.nc")
    assert easeoff.read_result(tmp_path / "x.nc").identical(tree)
    assert tree["loaded"].to_dataset()["torque"].values.tolist() == [75.0]
    for torques in (75.0, [75.0], np.array([75.0])):
        assert list(case_torques(easeoff.read_case(case), torques)) == [75.0]  # type: ignore[arg-type]


@pytest.mark.parametrize(("torques", "words"), [([5.0, 5.0], "comes twice"), ([], "1 or more"), (-5.0, "above 0")])
def test_python_refuses_torques_that_are_none(case: Path, torques: object, words: str) -> None:
    with pytest.raises(InputError, match=words):
        easeoff.analyze(case, torques=torques)  # type: ignore[arg-type]


def test_convert_goes_to_rexs_and_back_and_says_what_is_lost(tmp_path: Path) -> None:
    said = output_of("convert", "nasa-12x36", "-o", str(tmp_path / "new" / "nasa.rexs"))
    assert said.endswith(f"wrote {tmp_path / 'new' / 'nasa.rexs'}\n")
    assert "contact: left out" in said
    back = call("convert", str(tmp_path / "new" / "nasa.rexs"), "-o", str(tmp_path / "nasa.toml"))
    assert back.output == f"wrote {tmp_path / 'nasa.toml'}\n"
    case, shipped = easeoff.read_case(tmp_path / "nasa.toml"), easeoff.read_case("nasa-12x36")
    assert (case.pinion, case.gear) == (shipped.pinion, shipped.gear)
    assert "nasa.rexs" in case.text.splitlines()[0]
    output_of("convert", str(tmp_path / "nasa.toml"), "-o", str(tmp_path / "again.xml"))
    assert (tmp_path / "again.xml").is_file()


def test_convert_reads_session_scripts_and_keeps_the_terminal_safe(tmp_path: Path) -> None:
    (tmp_path / "pair.ses").write_text(script("LEFT", MACHINES) + "PAINT \x1b[2J RED\n", encoding="utf-8")
    said = output_of("convert", str(tmp_path / "pair.ses"), "-o", str(tmp_path / "pair.toml"))
    assert "PAINT ?[2J RED" in said
    assert "\x1b" not in said
    assert "# not understood: line" in (tmp_path / "pair.toml").read_text(encoding="utf-8")
    case = easeoff.read_case(tmp_path / "pair.toml")
    assert case.pinion.number_of_teeth == 12


def test_a_blank_without_a_tooth_is_the_users_mistake(case: Path, tmp_path: Path) -> None:
    broken = text_file(
        tmp_path / "broken.toml", case.read_text().replace("radial_distance = 74.87", "radial_distance = 374.87")
    )
    assert "no tooth in this blank" in refusal_of("run", broken, "-o", tmp_path / "x.nc")
    assert not (tmp_path / "x.nc").exists()


def test_uncertified_results_are_reported_with_exit_code_1(
    case: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """A solver that fails at one mesh position leaves NaN there, a status, everything else, and pictures."""
    import easeoff.contact.loaded as loaded
    from easeoff.contact import Status
    from easeoff.contact.line_contact.line_contact_solution import solve_at_torques
    from easeoff.contact.solvers.solution import no_solution

    calls = iter(range(10**6))

    def sometimes(problems, *arguments):  # type: ignore[no-untyped-def]
        found = list(solve_at_torques(problems, *arguments))
        if next(calls) == 1:  # the first call looks how far the pair turns, in search of edges
            nothing = no_solution(problems[1].size, Status.SOLVER_FAILED, "native", message="on purpose")
            found[-1][1] = (nothing, problems[1])
        return found

    monkeypatch.setattr(loaded, "solve_at_torques", sometimes)
    out = tmp_path / "x.nc"
    said = call("run", case, "-o", out, "--torque", "150")
    assert said.exit_code == 1
    assert "1 of 3" in said.output
    assert "solver_failed" in said.output
    tree = easeoff.read_result(out)
    found = tree["loaded"].to_dataset()
    assert np.count_nonzero(found["status"].values) == 1
    assert np.count_nonzero(np.isnan(found["transmission_error"].values)) == 1
    assert "2 of 3" in result_summary(tree)
    loaded_pictures = [name for name in PICTURES if name != "ease_off"]
    drawn = write_pictures(tree, tmp_path / "p", names=loaded_pictures, dpi=30)
    assert [path.name for path in drawn] == [f"small-drive-{name}.png" for name in loaded_pictures]


def test_the_search_for_garbage_waits_for_the_end_of_the_context() -> None:
    with without_garbage_collection():
        assert not gc.isenabled()
    assert gc.isenabled()


def test_only_a_process_that_ends_with_a_command_is_never_searched_for_garbage() -> None:
    for of_process, frozen in ((PROGRAM, True), (None, False)):
        before = gc.get_freeze_count()  # what lasts as long as the tests
        done = CliRunner().invoke(main, ["cases"], obj=of_process)
        assert (done.exit_code, gc.isenabled(), gc.get_freeze_count() > before) == (0, True, frozen)


def test_help_names_commands_in_whole_sentences() -> None:
    _, listed = call("--help").output.split("Commands:")
    assert listed.count("\n") > 20
    assert "..." not in listed


def test_every_variable_of_a_result_has_units_or_is_a_label(tree: xr.DataTree) -> None:
    for node in tree.subtree:
        for name, variable in node.dataset.variables.items():
            assert variable.attrs.get("long_name"), f"{node.path}/{name}"
            if variable.dtype.kind == "f":
                assert variable.attrs.get("units"), f"{node.path}/{name}"


def test_provenance_names_case_version_and_settings(tree: xr.DataTree, case: Path) -> None:
    attrs = tree.attrs
    assert attrs["case"] == case.read_text(encoding="utf-8")
    assert attrs["easeoff_version"]
    assert attrs["history"]
    assert attrs["Conventions"] == "CF-1.11"


# Completion of the words of a command line, in bash as the script of ``easeoff completion`` does it


BASH = shutil.which("bash")
#: The script completes by the name of the program; here that is a file which runs the commands of this checkout.
COMPLETED = "#!{python}\nimport sys\nsys.argv[0] = 'easeoff'\nfrom easeoff.study.cli import main\nmain()\n"
COMPLETE = """
source <(easeoff completion bash)
complete -p easeoff >/dev/null || exit 3
while read -r -a COMP_WORDS; do
    [ "${{COMP_WORDS[-1]}}" = "''" ] && COMP_WORDS[-1]=""
    COMP_CWORD=$((${{#COMP_WORDS[@]}} - 1)); COMPREPLY=()
    _easeoff_completion easeoff 2>/dev/null
    echo "${{COMPREPLY[*]}}"
done <<'WORDS'
{lines}
WORDS
"""


@pytest.mark.thorough
@pytest.mark.skipif(BASH is None, reason="no bash here")
def test_bash_completes_commands_options_and_names(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    program = text_file(tmp_path / "easeoff", COMPLETED.format(python=sys.executable))
    program.chmod(0o755)
    monkeypatch.setenv("PATH", str(tmp_path), prepend=":")
    wanted = {
        "easeoff sho": "show",
        "easeoff run nasa": "nasa-12x36",
        "easeoff run fm-11x41 --supp": "--supports",
        "easeoff wear fm-11x41 --supports a": "axle-fm-11x41",
        "easeoff design ''": " ".join(shipped_designs()),
        "easeoff new case face": "face-milled face-hobbed",
        "easeoff new oil p": "pao-vg100",
        "easeoff run fm-11x41 --oil h": "heavy-mineral",
        "easeoff run fm-11x41 --flank c": "coast",
        "easeoff compare p.nc --solvers native,clar": "native,clarabel",
        "easeoff run fm-11x41 --friction-model benedict": "benedict_kelly",
        "easeoff completion f": "fish",
        "easeoff run ./": "",  # files, by the shell itself
    }
    script = COMPLETE.format(lines="\n".join(wanted))
    done = subprocess.run([str(BASH), "--norc", "-c", script], capture_output=True, text=True, check=True)
    assert dict(zip(wanted, done.stdout.split("\n"), strict=False)) == wanted


@pytest.mark.parametrize(
    ("shell", "mark"), [("bash", "complete -o"), ("zsh", "#compdef easeoff"), ("fish", "complete ")]
)
def test_every_shell_has_its_script(shell: str, mark: str) -> None:
    made = call("completion", shell)
    assert made.exit_code == 0
    assert mark in made.stdout
    assert f"_EASEOFF_COMPLETE={shell}_complete" in made.stdout
    found = shutil.which(shell)
    if found is not None:
        subprocess.run([found, "-n"], input=made.stdout, text=True, check=True)  # reads it without running it


def test_another_shell_is_a_mistake() -> None:
    refusal_of("completion", "tcsh")


def test_help_has_the_command_of_each_shell_on_a_line_of_its_own() -> None:
    words = call("completion", "--help").output
    assert "\\b" not in words
    lines = [line.split() for line in words.splitlines()]
    for shell in ("bash", "zsh", "fish"):
        assert [shell, "easeoff", "completion", shell] in [line[:4] for line in lines]
