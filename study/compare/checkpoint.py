"""What has been measured so far, on disk: a comparison that was interrupted goes on where it stopped."""

from __future__ import annotations

import hashlib
import json
import os
from dataclasses import asdict
from pathlib import Path
from typing import Any

import numpy as np

from ...contact.problem.certificate import Certificate
from ...contact.problem.contact_problem import ContactProblem
from ...core.errors import InputError
from .attempt import Attempt


def problem_digest(problem: ContactProblem) -> str:
    """Return a digest of all data of a problem: the same for identical problems only."""
    parts = problem.compliance if isinstance(problem.compliance, tuple) else (problem.compliance,)
    digest = hashlib.sha256(np.float64(problem.torque).tobytes())
    for array in (problem.separation, problem.lever_arm, *parts):
        digest.update(repr(array.shape).encode())
        digest.update(np.ascontiguousarray(array).tobytes())
    return digest.hexdigest()


def key(**inputs: Any) -> str:
    """Return a digest of everything a measurement depends on."""
    return hashlib.sha256(json.dumps(inputs, sort_keys=True).encode()).hexdigest()


class Checkpoint:
    """Measurements by key, appended to a file of one JSON object a line.

    Parameters
    ----------
    path : Path
        The file; made, with its folder, when something is added.
    fresh : bool
        Forget what is in it.

    Raises
    ------
    InputError
        The file cannot be read.
    """

    def __init__(self, path: Path, *, fresh: bool = False) -> None:
        self.path = path
        self._known: dict[str, list[Attempt]] = {}
        if fresh:
            path.unlink(missing_ok=True)
        elif path.exists():
            self._known = _read(path)

    def get(self, key: str) -> list[Attempt] | None:
        """Return the attempts of a measurement, or None if it has not been made."""
        return self._known.get(key)

    def add(self, key: str, attempts: list[Attempt]) -> None:
        """Keep a measurement, on disk before this returns."""
        self._known[key] = attempts
        line = json.dumps({"key": key, "attempts": [asdict(attempt) for attempt in attempts]})
        try:
            self.path.parent.mkdir(parents=True, exist_ok=True)
            # The line feed in front ends a line that an interruption may have left half-written.
            with self.path.open("a", encoding="utf-8") as file:
                file.write(f"\n{line}")
                file.flush()
                os.fsync(file.fileno())
        except OSError as error:
            raise InputError(f"{self.path} cannot be written: {error.strerror or error}") from error


def _read(path: Path) -> dict[str, list[Attempt]]:
    try:
        lines = path.read_text(encoding="utf-8", errors="replace").splitlines()
    except OSError as error:
        raise InputError(f"{path} cannot be read: {error.strerror or error}") from error
    known = {}
    for line in lines:
        try:
            entry = json.loads(line)
            known[str(entry["key"])] = [_attempt(stored) for stored in entry["attempts"]]
        except (ValueError, KeyError, TypeError):
            continue  # half-written, or of another program: measured again
    return known


def _attempt(stored: dict[str, Any]) -> Attempt:
    return Attempt(**{**stored, "certificate": Certificate(**stored["certificate"])})
