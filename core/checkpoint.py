"""Checkpoint of a long computation: records appended to a file one by one, from which an interrupted run resumes."""

from __future__ import annotations

import contextlib
import hashlib
import json
import os
import warnings
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any, BinaryIO, Generic, TypeVar

from .checks import truth
from .errors import InputError
from .output_file import check_writable, existing_folder, wait_for_lock, whole_file
from .regular_file import RECORD_SIZE_LIMIT, parsed_json, read_bytes

Record = TypeVar("Record")

HEADER_SIZE_LIMIT = 1 << 16  # of the first line [bytes]
DAMAGED = ".damaged"  # after the name of a file, of what it held when it was begun anew


class Checkpoint(Generic[Record]):
    """Records by key, each on disk before the next one is computed; runs that share the file take turns.

    A line that is unfinished or damaged is skipped; if the first one, which names the study, is damaged, the file is
    begun anew and the old one kept as ``.damaged``. ``fresh`` replaces the records that are in the file.
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
        if os.path.islink(path):
            raise InputError(f"{path} is a link: a checkpoint must be a file")
        self.path, self._encode, self._fresh = path, encode, fresh
        self._study, self._header = study, _header(study)
        self._records: dict[str, Record] = {}
        exists = not truth("fresh", fresh) and os.path.exists(path)
        text = read_bytes(path, RECORD_SIZE_LIMIT).decode(errors="replace") if exists else ""
        for line in text.splitlines()[1:] if self._is_begun(text) else []:
            with contextlib.suppress(Exception):  # a damaged line may hold anything; its record is computed anew
                entry = parsed_json(line)
                if entry["digest"] == self._digest(entry["key"], entry["record"]):
                    self._records[entry["key"]] = decode(entry["record"])

    def get(self, key: str) -> Record | None:
        """Record of a key; ``None`` if there is none yet."""
        return self._records.get(key)

    def begin(self) -> None:
        """Make the file unless it exists, so that a path that cannot be written is known before any work."""
        if self._fresh:
            with whole_file(self.path) as temporary:
                temporary.write_text(self._header, encoding="utf-8")
            self._fresh = False
        else:
            with self._turn():
                pass

    def add(self, key: str, record: Record) -> None:
        """Keep a record: it is on disk when this returns. If that fails, the records in the file stay as they were."""
        stored = self._encode(record)
        line = json.dumps({"key": key, "record": stored, "digest": self._digest(key, stored)})
        if self._fresh:
            self.begin()
        with self._turn() as file:
            # The line feed in front ends a line that an interruption may have left unfinished.
            _append(file, f"\n{line}")
        self._records[key] = record

    def _digest(self, key: str, stored: Any) -> str:
        return digest(study=self._study, key=key, record=stored)

    @contextlib.contextmanager
    def _turn(self) -> Iterator[BinaryIO]:
        """Open the file for this process alone; one that is not there is made, and begins with its header."""
        try:
            with existing_folder(self.path.parent), _locked(self.path) as file:
                if not self._is_begun(file.readline(HEADER_SIZE_LIMIT).decode("utf-8", "replace")):
                    self._write_header(file)
                yield file
        except OSError as error:
            raise InputError(f"{self.path} cannot be written: {error.strerror or error}") from error

    def _write_header(self, file: BinaryIO) -> None:
        """Begin a file; it is removed if not even its header has room. Of one that is damaged a copy stays."""
        file.seek(0)
        content = file.read()
        if not self._header.encode().startswith(content):
            copy = self.path.with_name(f"{self.path.name}{DAMAGED}")
            with whole_file(copy) as temporary:
                temporary.write_bytes(content)
            warnings.warn(f"{self.path} is damaged: it is begun anew, what it held is in {copy.name}", stacklevel=2)
        file.truncate(0)
        try:
            _append(file, self._header)
        except OSError:
            self.path.unlink(missing_ok=True)
            raise

    def _is_begun(self, start: str) -> bool:
        """True if a file that starts so has a header; the file of another study is refused.

        Less than a header, and nothing after it, is left by an interruption; anything else but a header is damage.
        """
        first = next(iter(start.splitlines()), "")
        if first == self._header:
            return True
        try:
            other = _header(parsed_json(first)["checkpoint"])
        except Exception:  # it may hold anything
            return False
        if first == other:
            raise InputError(
                f"{self.path}: must be the checkpoint of a {self._study}, or not exist; give another name, or remove "
                "the file"
            )
        return False


@contextlib.contextmanager
def _locked(path: Path) -> Iterator[BinaryIO]:
    """Open a file to read and append, make it if it is not there, and lock it; a link is not followed."""
    flags = os.O_RDWR | os.O_CREAT | os.O_APPEND | getattr(os, "O_NOFOLLOW", 0) | getattr(os, "O_BINARY", 0)
    while True:
        with open(os.open(path, flags, 0o666), "r+b", buffering=0) as file:
            wait_for_lock(file.fileno())
            if _is_at(file, path):
                yield file
                return


def _is_at(file: BinaryIO, path: Path) -> bool:
    """True if an open file is still the one of its name: another run may have put a fresh one in its place."""
    try:
        return os.path.samestat(os.fstat(file.fileno()), os.stat(path))
    except FileNotFoundError:
        return False


def _append(file: BinaryIO, text: str) -> None:
    """Append a text to an open file, onto the disk; if not all of it has room, none of it stays."""
    length = file.seek(0, os.SEEK_END)
    content = text.encode()
    try:
        while content:
            content = content[file.write(content) :]
        os.fsync(file.fileno())
    except OSError:
        file.truncate(length)
        raise


def _header(study: str) -> str:
    return json.dumps({"checkpoint": study, "digest": digest(checkpoint=study)})


def digest(**inputs: Any) -> str:
    """Digest of everything that a record depends on, for its key; the order of the inputs does not matter."""
    return hashlib.sha256(json.dumps(inputs, sort_keys=True).encode()).hexdigest()
