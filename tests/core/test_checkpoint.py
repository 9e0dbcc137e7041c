"""Checkpoint: records survive an interruption, and what a file of another kind held stays."""

from __future__ import annotations

import errno
import json
import os
from pathlib import Path

import pytest
from runs import in_copies

from easeoff import InputError
from easeoff.core.checkpoint import DAMAGED, Checkpoint, digest


def squares(path: Path, study: str = "table of squares", *, fresh: bool = False) -> Checkpoint[int]:
    return Checkpoint(path, study, encode=int, decode=int, fresh=fresh)


def test_a_digest_does_not_depend_on_the_order_of_the_inputs() -> None:
    assert digest(torque=50.0, solver="native") == digest(solver="native", torque=50.0)


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
    squares(path, "table of cubes").add("2", 8)
    content = path.read_text(encoding="utf-8")
    with pytest.raises(InputError, match=r"squares\.jsonl: must be the checkpoint of a table of squares"):
        squares(path)
    assert path.read_text(encoding="utf-8") == content


@pytest.mark.parametrize("content", ["precious", "{\n", "\nprecious", '{"checkpoint": "table of squares"}\n', "\0\0"])
def test_a_file_that_is_none_is_begun_anew_and_what_it_held_stays(content: str, tmp_path: Path) -> None:
    path = tmp_path / "squares.jsonl"
    path.write_text(content, encoding="utf-8")
    with pytest.warns(UserWarning, match=r"squares\.jsonl is damaged: it is begun anew, what it held is in squares"):
        squares(path).add("2", 4)
    assert squares(path).get("2") == 4
    assert (tmp_path / f"squares.jsonl{DAMAGED}").read_text(encoding="utf-8") == content


def test_a_fresh_start_replaces_the_records_once_there_is_a_new_one(tmp_path: Path) -> None:
    path = tmp_path / "squares.jsonl"
    squares(path).add("2", 4)
    fresh = squares(path, fresh=True)
    assert fresh.get("2") is None
    assert squares(path).get("2") == 4
    fresh.add("3", 9)
    assert (squares(path).get("2"), squares(path).get("3")) == (None, 9)


def test_processes_that_share_a_file_keep_every_record_whole(tmp_path: Path) -> None:
    """They begin it together, too: none replaces what another has added."""
    path = tmp_path / "squares.jsonl"

    def add(process: int) -> None:
        shared = Checkpoint(path, "long texts", encode=str, decode=str)
        for number in range(12):
            shared.add(f"{process}/{number}", 30_000 * str(process))

    in_copies(4, add)
    header, *lines = path.read_text(encoding="utf-8").splitlines()
    assert json.loads(header)["checkpoint"] == "long texts"
    records = {entry["key"]: entry["record"] for entry in map(json.loads, lines)}
    assert records == {f"{p}/{n}": 30_000 * str(p) for p in range(4) for n in range(12)}
    assert [child.name for child in tmp_path.iterdir()] == ["squares.jsonl"]


def test_a_run_goes_on_in_the_file_that_another_has_put_in_place(tmp_path: Path) -> None:
    path = tmp_path / "squares.jsonl"
    first = squares(path)
    first.add("2", 4)
    squares(path, fresh=True).add("3", 9)
    first.add("4", 16)
    assert [squares(path).get(key) for key in "234"] == [None, 9, 16]
    path.unlink()
    first.add("5", 25)
    assert squares(path).get("5") == 25


def test_a_record_that_has_no_room_leaves_those_before_it(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    path = tmp_path / "new" / "squares.jsonl"

    def full(_: int) -> None:
        raise OSError(errno.ENOSPC, "No space left on device")

    with monkeypatch.context() as patch:
        patch.setattr(os, "fsync", full)
        with pytest.raises(InputError, match=r"squares\.jsonl cannot be written: No space left on device"):
            squares(path).add("2", 4)
        assert list(tmp_path.iterdir()) == []
    squares(path).add("2", 4)
    before = path.read_bytes()
    with monkeypatch.context() as patch:
        patch.setattr(os, "fsync", full)
        with pytest.raises(InputError, match="No space left on device"):
            squares(path).add("3", 9)
    assert path.read_bytes() == before


def test_a_header_that_was_interrupted_is_written_again(tmp_path: Path) -> None:
    path = tmp_path / "squares.jsonl"
    squares(path).begin()
    header = path.read_text(encoding="utf-8")
    for end in range(len(header)):
        path.write_text(header[:end], encoding="utf-8")
        squares(path).add("2", 4)
        assert squares(path).get("2") == 4
    assert [child.name for child in tmp_path.iterdir()] == ["squares.jsonl"]


def test_a_link_is_refused(tmp_path: Path) -> None:
    """Records would be appended to whatever it points to."""
    (tmp_path / "squares.jsonl").symlink_to(tmp_path / "precious")
    with pytest.raises(InputError, match="is a link"):
        squares(tmp_path / "squares.jsonl")
    assert not (tmp_path / "precious").exists()
