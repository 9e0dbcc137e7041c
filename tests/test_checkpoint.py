"""Checkpoint: records survive an interruption, and a file of another kind is never touched."""

from __future__ import annotations

from pathlib import Path

import pytest

from easeoff import InputError
from easeoff.core.checkpoint import Checkpoint


def squares(path: Path, study: str = "table of squares", *, fresh: bool = False) -> Checkpoint[int]:
    return Checkpoint(path, study, encode=int, decode=int, fresh=fresh)


def test_records_are_on_disk_as_soon_as_they_are_added(tmp_path: Path) -> None:
    path = tmp_path / "new" / "squares.jsonl"
    first = squares(path)
    assert not path.parent.exists()
    for number in (2, 3):
        first.add(str(number), number**2)
        assert squares(path).get(str(number)) == number**2
    assert squares(path).get("4") is None


def test_an_unfinished_line_is_skipped_and_its_record_added_again(tmp_path: Path) -> None:
    path = tmp_path / "squares.jsonl"
    squares(path).add("2", 4)
    whole = path.read_text(encoding="utf-8")
    squares(path).add("3", 9)
    added = path.read_text(encoding="utf-8")
    for end in range(len(whole), len(added)):
        path.write_text(added[:end], encoding="utf-8")
        resumed = squares(path)
        assert (resumed.get("2"), resumed.get("3")) == (4, None)
        resumed.add("3", 9)
        assert (squares(path).get("2"), squares(path).get("3")) == (4, 9)


def test_a_file_of_another_study_is_refused_and_kept(tmp_path: Path) -> None:
    path = tmp_path / "squares.jsonl"
    for content in ("precious", '{"checkpoint": "table of cubes"}\n{"key": "2", "record": 8}'):
        path.write_text(content, encoding="utf-8")
        with pytest.raises(InputError, match=r"squares\.jsonl: must be the checkpoint of a table of squares"):
            squares(path)
        assert path.read_text(encoding="utf-8") == content


def test_a_fresh_start_replaces_the_records_once_there_is_a_new_one(tmp_path: Path) -> None:
    path = tmp_path / "squares.jsonl"
    squares(path).add("2", 4)
    fresh = squares(path, fresh=True)
    assert fresh.get("2") is None
    assert squares(path).get("2") == 4
    fresh.add("3", 9)
    assert (squares(path).get("2"), squares(path).get("3")) == (None, 9)
