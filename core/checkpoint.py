"""Checkpoint of a long computation: records appended to a file one by one, from which an interrupted run resumes."""

from __future__ import annotations

import hashlib
import json
import os
from collections.abc import Callable
from pathlib import Path
from typing import Any, Generic, TypeVar

from .errors import InputError
from .files import check_writable, whole_file
from .reading.json_text import parsed_json
from .reading.regular_file import read_bytes
from .reading.text_file import RECORD_SIZE_LIMIT

Record = TypeVar("Record")


class Checkpoint(Generic[Record]):
    """Records by key, each on disk before the next one is computed.

    The first line of the file names the study. Every other line is a JSON object of a key and its record; a line that
    an interruption left unfinished, or whose record cannot be decoded, is skipped.

    Parameters
    ----------
    path
        The file; it and its folder are made by ``begin`` or with the first record.
    study
        Kind of study, such as ``comparison of solvers``.
    encode
        Turns a record into what JSON can hold.
    decode
        Turns that back into a record; raises ``ValueError``, ``KeyError`` or ``TypeError`` if it cannot.
    fresh
        Ignore the records in the file and replace them.

    Raises
    ------
    InputError
        If the file cannot be read or written, or is not the checkpoint of such a study.

    Examples
    --------
    >>> from tempfile import TemporaryDirectory
    >>> with TemporaryDirectory() as folder:
    ...     path = Path(folder) / "squares.jsonl"
    ...     Checkpoint(path, "table of squares", encode=int, decode=int).add("7", 49)
    ...     resumed = Checkpoint(path, "table of squares", encode=int, decode=int)
    >>> resumed.get("7"), resumed.get("8")
    (49, None)
    """

    def __init__(
        self,
        path: Path,
        study: str,
        *,
        encode: Callable[[Record], Any],
        decode: Callable[[Any], Record],
        fresh: bool = False,
    ) -> None:
        check_writable(path)
        self.path = path
        self._encode = encode
        self._header = json.dumps({"checkpoint": study})
        self._records: dict[str, Record] = {}
        header, *lines = [""] if fresh else _lines(path)
        self._begun = bool(header)
        if header not in ("", self._header):
            raise InputError(
                f"{path}: must be the checkpoint of a {study}, or not exist; give another name, or remove the file"
            )
        for line in lines:
            try:
                entry = parsed_json(line)
                self._records[str(entry["key"])] = decode(entry["record"])
            except Exception:  # a damaged line may hold anything; its record is computed anew
                continue

    def get(self, key: str) -> Record | None:
        """Record of a key; ``None`` if there is none yet."""
        return self._records.get(key)

    def begin(self) -> None:
        """Make the file if it does not exist yet, so that a path that cannot be written is known before any work.

        Raises
        ------
        InputError
            If the file cannot be written.
        """
        if not self._begun:
            with whole_file(self.path) as temporary:
                temporary.write_text(self._header, encoding="utf-8")
            self._begun = True

    def add(self, key: str, record: Record) -> None:
        """Keep a record: it is on disk when this returns.

        Raises
        ------
        InputError
            If the file cannot be written.
        """
        line = json.dumps({"key": key, "record": self._encode(record)})
        self.begin()
        try:
            # The line feed in front ends a line that an interruption may have left unfinished.
            with self.path.open("a", encoding="utf-8") as file:
                file.write(f"\n{line}")
                file.flush()
                os.fsync(file.fileno())
        except OSError as error:
            raise InputError(f"{self.path} cannot be written: {error.strerror or error}") from error
        self._records[key] = record


def digest(**inputs: Any) -> str:
    """Digest of everything that a record depends on, for its key.

    >>> digest(torque=50.0, solver="native") == digest(solver="native", torque=50.0)
    True
    """
    return hashlib.sha256(json.dumps(inputs, sort_keys=True).encode()).hexdigest()


def _lines(path: Path) -> list[str]:
    """Lines of a file, one empty line if it does not exist."""
    if not os.path.exists(path):
        return [""]
    return read_bytes(path, RECORD_SIZE_LIMIT).decode(errors="replace").splitlines() or [""]
