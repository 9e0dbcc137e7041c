"""Batches of a sweep on disk while it runs: a file each, and a map of those that are complete, written last."""

from __future__ import annotations

import hashlib
import io
import json
import os
import re
import shutil
from collections.abc import Iterator
from contextlib import suppress
from itertools import pairwise
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ...core.array_file import read_arrays
from ...core.checkpoint import DAMAGED, Checkpoint, digest
from ...core.errors import InputError, printable
from ...core.output_file import NAME as PRIVATE_NAME, check_folder, clear_remains, whole_file
from ...core.regular_file import TABLE_SIZE_LIMIT, parsed_json, read_text
from .batch_analysis import Block
from .sweep_file import PointStatus

#: File that says which sweep a store is of, and the map of its batches.
PLAN_NAME, MAP_NAME = "sweep.json", "batches.jsonl"
OWN_DIGEST = "own_digest"  # in the plan, of the rest of it
STUDY = "parameter sweep"
BATCH_NAME = re.compile(r"batch-\d+\.npz")
NUMBER = "number."  # before the name of a number in a file of a batch


class BatchStore:
    """Batches of one sweep in a folder, from which an interrupted sweep resumes; ``fresh`` replaces them.

    A batch is written whole and is on the disk before it enters the map with the digest of its content. A batch that is
    not in the map, whose file has other content, or in which a point failed unexpectedly, is computed anew.
    """

    def __init__(self, folder: Path, digest: str, description: str, count: int, *, fresh: bool = False) -> None:
        check_folder(folder, "batches of the sweep")
        self.folder, self._digest, self._description = folder, digest, description
        plan = None if fresh else self._plan()
        if fresh:
            self.remove()
        elif plan is None:
            self._refuse_other_files()
        elif plan.get("digest") != digest:
            raise InputError(
                f"{printable(str(folder))}: must hold the batches of this sweep ({description}), but holds those of "
                f"another ({printable(str(plan.get('description')))}); give another folder, remove it, or begin anew "
                "with --fresh"
            )
        self._refuse_folders()
        self.bounds: list[int] | None = _bounds(plan, count)
        self._map: Checkpoint[str] | None = None
        if os.path.isdir(folder):  # a map that cannot be used shows before anything is written
            self._map = self._completed

    def divide(self, bounds: list[int]) -> None:
        """Record how the points are divided into batches; with what was recorded before, it stays so."""
        plan = {"digest": self._digest, "description": self._description, "bounds": bounds}
        text = json.dumps(plan | {OWN_DIGEST: digest(**plan)})
        with whole_file(self.folder / PLAN_NAME) as temporary:
            temporary.write_text(text, encoding="utf-8")
        self.bounds = bounds
        self._completed.begin()

    def add(self, number: int, block: Block) -> None:
        """Keep a batch: it is on the disk when this returns."""
        content = io.BytesIO()
        arrays: dict[str, Any] = {"rows": block.rows, "status": block.status, "reason": block.reason}
        arrays |= {"layout": block.layout, **{f"{NUMBER}{name}": values for name, values in block.numbers.items()}}
        np.savez(content, **arrays)
        data = content.getvalue()
        with whole_file(self._path(number)) as temporary:
            temporary.write_bytes(data)
        self._completed.add(str(number), hashlib.sha256(data).hexdigest())

    def complete(self, order: NDArray[Any]) -> Iterator[tuple[int, Block]]:
        """The batches that are complete, by their numbers; ``order`` has rows (n) as the bounds divide them."""
        for number, (first, last) in enumerate(pairwise(self.bounds or [])):
            block = self._read(number)
            # Another run of the same sweep may have divided it otherwise.
            same_rows = block is not None and np.array_equal(block.rows, order[first:last])
            # What failed unexpectedly, as for want of memory, may succeed now.
            if block is not None and same_rows and not np.any(block.status == PointStatus.FAILED):
                yield number, block

    def _read(self, number: int) -> Block | None:
        """A batch from its file, if the map has it with that content."""
        recorded = self._completed.get(str(number))
        if recorded is None:
            return None
        try:
            intact = hashlib.sha256(self._path(number).read_bytes()).hexdigest() == recorded
            return _block(self._path(number)) if intact else None
        except (OSError, InputError, KeyError, ValueError):
            return None

    def remove(self) -> None:
        """Remove the batches, and the folder if nothing else is in it."""
        clear_remains(self.folder)
        with suppress(FileNotFoundError), os.scandir(self.folder) as entries:
            for entry in entries:
                # A private folder that is left is that of another run, which writes into it at this moment.
                if _is_own(entry.name) and not PRIVATE_NAME.fullmatch(entry.name):
                    with suppress(FileNotFoundError):
                        shutil.rmtree(entry.path) if entry.is_dir(follow_symlinks=False) else os.unlink(entry.path)
        with suppress(OSError):
            self.folder.rmdir()

    @property
    def _completed(self) -> Checkpoint[str]:
        """Map from the number of a batch to the digest of its file."""
        if self._map is None:
            self._map = Checkpoint(self.folder / MAP_NAME, f"{STUDY} {self._digest}", encode=str, decode=str)
        return self._map

    def _path(self, number: int) -> Path:
        return self.folder / f"batch-{number:06d}.npz"

    def _plan(self) -> dict[str, Any] | None:
        """Record of the folder's sweep; nothing if there is none, or it is damaged."""
        if not os.path.isfile(self.folder / PLAN_NAME):
            return None
        try:
            plan = parsed_json(read_text(self.folder / PLAN_NAME, TABLE_SIZE_LIMIT))
            checksum = plan.pop(OWN_DIGEST)
            return plan if checksum == digest(**plan) else None
        except (ValueError, AttributeError, KeyError, TypeError):
            return None

    def _refuse_folders(self) -> None:
        """Refuse a folder where a batch shall be, before anything is written."""
        with suppress(FileNotFoundError), os.scandir(self.folder) as entries:
            for entry in entries:
                if BATCH_NAME.fullmatch(entry.name) and entry.is_dir():
                    raise InputError(f"{printable(entry.path)} is a folder: remove it, or begin anew with --fresh")

    def _refuse_other_files(self) -> None:
        if os.path.isdir(self.folder):
            foreign = [name for name in os.listdir(self.folder) if not _is_own(name)]
            if foreign:
                raise InputError(
                    f"{printable(str(self.folder))}: must be an empty folder, or not exist, to hold the batches of the "
                    f"sweep; it holds {printable(foreign[0])}"
                )


def _is_own(name: str) -> bool:
    """True if an entry of a folder is one of a store."""
    return name in (PLAN_NAME, MAP_NAME, f"{MAP_NAME}{DAMAGED}") or bool(
        BATCH_NAME.fullmatch(name) or PRIVATE_NAME.fullmatch(name)
    )


def _bounds(plan: dict[str, Any] | None, count: int) -> list[int] | None:
    """Recorded bounds of the batches, if they rise from 0 to the number of points at most."""
    bounds = plan.get("bounds") if plan else None
    if not isinstance(bounds, list) or not all(type(one) is int for one in bounds) or bounds[:1] != [0]:
        return None
    return bounds if all(one < two for one, two in pairwise(bounds)) and bounds[-1] <= count else None


def _block(path: Path) -> Block:
    """A batch from its file."""
    arrays = {name: array for name, array in read_arrays(path).items() if array is not None}
    numbers = {name.removeprefix(NUMBER): values for name, values in arrays.items() if name.startswith(NUMBER)}
    return Block(arrays["rows"], arrays["status"], arrays["reason"], numbers, str(arrays["layout"].item()))
