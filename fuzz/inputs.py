"""Mutated inputs: each is drawn from a seed, run in a process of its own, and judged."""

from __future__ import annotations

import shlex
import shutil
from collections.abc import Mapping
from dataclasses import dataclass
from itertools import pairwise
from pathlib import Path

import oracle
from mutations import path_mutations
from bases import Bases
from kinds.box import INNER, Box, Input
from kinds.drawing import draw
from processes import Outcome, command_line, forked, fresh
from readers import reading, written_files
from writing_runs import content, equal


@dataclass(frozen=True)
class Verdict:
    """What came of a seed."""

    seed: int
    made: Input
    outcome: Outcome
    faults: list[str]

    @property
    def where(self) -> str:
        """Where in the package an exception came from."""
        return oracle.place(self.outcome.stderr)


def judge(seed: int, bases: Bases, work: Path, kind: str | None = None) -> Verdict:
    """Run the input of a seed and judge it.

    Parameters
    ----------
    seed
        Of what is drawn.
    bases
        Files to be mutated.
    work
        Folder in which the input has a folder while it runs.
    kind
        One of the kinds, instead of one that is drawn.
    """
    root = work / f"input-{seed}"
    try:
        box = Box(root, bases)
        made = draw(seed, box, kind)
        before = oracle.snapshot(root)
        outcome = run(made, box)
        after = oracle.snapshot(root)
        faults = oracle.process_faults(outcome, made.command)
        faults += oracle.folder_faults(before, after, outcome, [*made.args, *made.environment.values()], INNER)
        faults += _input_faults(made, before, after)
        if outcome.code in (0, 1) and not made.call:
            faults += _reading_faults(made, before, after, box)
    finally:
        path_mutations.release(root)
    return Verdict(seed, made, outcome, faults)


def keep(verdict: Verdict, bases: Bases, folder: Path, kind: str | None = None) -> Path:
    """Keep the input of a verdict as it was before it ran, with its output; return the folder of its files."""
    root = folder / f"input-{verdict.seed}"
    if root.exists():
        path_mutations.release(root)
    box = Box(root, bases)
    draw(verdict.seed, box, kind)
    (root / "stdout.txt").write_text(verdict.outcome.stdout, errors="backslashreplace")
    (root / "stderr.txt").write_text(verdict.outcome.stderr, errors="backslashreplace")
    words = ["cd", str(box.folder), "&&", *(f"{k}={shlex.quote(v)}" for k, v in verdict.made.environment.items())]
    command = " ".join([*words, "easeoff", *(shlex.quote(word) for word in verdict.made.args)])
    (root / "command.txt").write_text(command + "\n" + "\n".join(verdict.faults) + "\n", errors="backslashreplace")
    return box.folder


def run(made: Input, box: Box) -> Outcome:
    """Run an input in its box."""
    own = {"EASEOFF_CACHE": str(box.bases.cache), "EASEOFF_PROGRESS": "off", "TMPDIR": str(box.temporary)}
    environment = {**own, **made.environment}
    if any("\0" in word for word in made.args):
        return Outcome(2, "", "Error: no argument of a process can hold this", 0.0, 0.0)
    if made.fresh:
        return fresh(made.args, box.folder, environment=environment)
    call = reading(made.call, made.args[0]) if made.call else command_line(made.args)
    return forked(call, box.folder, environment=environment)


def _input_faults(made: Input, before: Mapping[str, oracle.Entry], after: Mapping[str, oracle.Entry]) -> list[str]:
    written = {b for a, b in pairwise(made.args) if a in ("-o", "--output", "--fitted-case")}
    names = [f"{INNER}/{name}" for name in made.inputs if name not in written]
    return [f"{name} is an input and was changed" for name in names if before.get(name) != after.get(name)]


def _reading_faults(
    made: Input, before: Mapping[str, oracle.Entry], after: Mapping[str, oracle.Entry], box: Box
) -> list[str]:
    """Whether what was written can be read back."""
    touched = [name for name in made.args if after.get(f"{INNER}/{name}") not in (None, before.get(f"{INNER}/{name}"))]
    faults = []
    if made.same_as and not equal(content(box.folder / "out.nc"), content(box.bases[made.same_as])):
        faults.append(f"out.nc is not what it is without the mutated files: {made.same_as}")
    for kind, path in written_files(made.command, made.args, touched):
        outcome = forked(reading(kind, path), box.folder)
        if outcome.code != 0:
            faults.append(f"{path} was written and cannot be read: {outcome.stderr.strip()[-160:]}")
    return faults


def clear(folder: Path) -> None:
    """Remove what an earlier search kept."""
    shutil.rmtree(folder, ignore_errors=True)
