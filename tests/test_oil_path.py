"""Where the path of an oil in a case file starts: from the folder of the case, wherever the program runs."""

from __future__ import annotations

import re
from pathlib import Path

import pytest
from runs import SHELLS, output_of, refusal_of, small_text, text_file

import easeoff
from easeoff import InputError
from easeoff.cases import FrictionTable, design_text, parse_case, parse_design, read_case, read_design, write_case
from easeoff.friction import lubricant
from easeoff.friction.lubricants.lubricant import LUBRICANTS_FOLDER
from easeoff.study import DesignReport
from easeoff.study.design import case_design

OWN = (LUBRICANTS_FOLDER / "75w90.toml").read_text(encoding="utf-8")
TABLE = '\n[friction]\nspeed = 500\noil = "oils/mine.toml"\n'


@pytest.fixture
def case(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """A case with an oil beside it; the program runs elsewhere."""
    (tmp_path / "here" / "oils").mkdir(parents=True)
    (tmp_path / "away").mkdir()
    (tmp_path / "here" / "oils" / "mine.toml").write_text(OWN, encoding="utf-8")
    path = text_file(tmp_path / "here" / "case.toml", small_text(more=SHELLS + TABLE))
    monkeypatch.chdir(tmp_path / "away")
    return path


def oil_of(table: FrictionTable | None) -> str:
    assert table is not None
    return table.operation().lubricant.name


def test_it_starts_from_the_folder_of_the_case(case: Path) -> None:
    assert oil_of(read_case(case).friction) == "mine"
    assert oil_of(read_case(Path("..", "here", "case.toml")).friction) == "mine"


def test_a_file_of_that_name_in_the_working_folder_is_not_taken(case: Path) -> None:
    Path("oils").mkdir()
    Path("oils", "mine.toml").write_text("no oil", encoding="utf-8")
    assert oil_of(read_case(case).friction) == "mine"
    (case.parent / "oils" / "mine.toml").unlink()
    with pytest.raises(InputError, match="starts from the folder of the case"):
        read_case(case)


def test_the_folder_stays_where_it_was_when_the_program_moves_on(case: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(case.parent)
    read = read_case("case.toml")
    monkeypatch.chdir(case.parent.parent)
    assert oil_of(read.friction) == "mine"


def test_an_oil_that_is_not_there_is_named_with_the_place_where_it_was_looked_for(case: Path) -> None:
    case.write_text(case.read_text(encoding="utf-8").replace("mine.toml", "other.toml"), encoding="utf-8")
    with pytest.raises(InputError) as caught:
        read_case(case)
    for words in (
        "friction: oil = 'oils/other.toml'",
        "75w90",
        str(case.parent / "oils" / "other.toml"),
        "a relative path starts from the folder of the case",
    ):
        assert words in str(caught.value)


def test_the_same_from_the_command_line_whose_own_paths_start_from_the_working_folder(case: Path) -> None:
    Path("other.toml").write_text(OWN, encoding="utf-8")
    for options, oil in (([], "mine"), (["--oil", "other.toml"], "other")):
        output_of("run", "../here/case.toml", "-o", "out.nc", *options)
        assert easeoff.read_result("out.nc")["friction"].attrs["oil"] == oil
    said = refusal_of("run", "../here/case.toml", "-o", "no.nc", "--oil", "oils/mine.toml")
    assert str(Path("oils", "mine.toml").absolute()) in said
    assert "starts from the working folder" in said


def test_the_text_in_a_result_is_read_with_the_folder_or_refused_with_a_clear_message(case: Path) -> None:
    text = easeoff.analyze(case).attrs["case"]
    assert oil_of(parse_case(text, folder=case.parent).friction) == "mine"
    with pytest.raises(InputError, match=r"oil = 'oils/mine.toml'.*there is no .*away.*starts from the working folder"):
        parse_case(text)


def test_a_case_written_elsewhere_still_finds_its_oil(case: Path, tmp_path: Path) -> None:
    for target, expected in (
        (tmp_path / "here" / "copy.toml", "oils/mine.toml"),
        (tmp_path / "away" / "deep" / "copy.toml", "../../here/oils/mine.toml"),
        (Path("copy.toml"), "../here/oils/mine.toml"),
    ):
        write_case(read_case(case), target)
        table = read_case(target, allow_outside=True).friction
        assert table is not None
        assert table.oil == expected
        assert oil_of(table) == "mine"


@pytest.mark.parametrize("oil", ["75W90", "absolute"])
def test_names_and_absolute_paths_are_written_as_they_are(case: Path, oil: str) -> None:
    given = str(case.parent / "oils" / "mine.toml") if oil == "absolute" else oil
    text = small_text(more=f"\n[friction]\nspeed = 500\noil = '{given}'\n")
    write_case(parse_case(text, allow_outside=True), "copy.toml")
    table = read_case("copy.toml", allow_outside=True).friction
    assert table is not None
    assert table.oil == given


def test_a_design_hands_its_oil_on(case: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """A design without ease-off, which is fitted at once; the pair that comes out is not checked."""
    text = re.sub(r"^(\w+_crowning|bias|\w+_error) = .*$", r"\1 = 0.0", design_text("fh-12x41-45"), flags=re.MULTILINE)
    text = text.replace("follow_root = true", "follow_root = false") + SHELLS + TABLE
    design = text_file(case.with_name("design.toml"), text)
    assert oil_of(read_design(design).friction) == "mine"
    assert oil_of(parse_design(text, folder=design.parent).friction) == "mine"
    monkeypatch.setattr(case_design, "checked_design", lambda _, designed: DesignReport(designed.blank, {}, ()))
    said = output_of("design", "../here/design.toml", "-o", "made.toml")
    assert "--allow-outside" in said.splitlines()[-1]
    assert oil_of(read_case("made.toml", allow_outside=True).friction) == "mine"


def test_a_file_that_cannot_be_read_is_named(case: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    def refused(*_args: object, **_options: object) -> str:
        raise PermissionError(13, "Permission denied")

    monkeypatch.setattr(Path, "open", refused)
    with pytest.raises(InputError, match=r"oil = 'oils/mine.toml': .*mine.toml cannot be read: Permission denied"):
        lubricant("oils/mine.toml", case.parent)
