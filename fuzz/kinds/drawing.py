"""The input of a seed."""

from __future__ import annotations

import os
import random
from collections.abc import Callable

from . import damaged_files, odd_surroundings, wrong_words
from .box import Box, Input

#: Kinds of inputs: how often they are drawn, and what draws them.
KINDS: dict[str, tuple[float, Callable[[random.Random, Box], Input]]] = {
    "case": (6.0, damaged_files.case),
    "design": (1.5, damaged_files.design),
    "oil": (2.0, damaged_files.oil),
    "grid": (4.0, damaged_files.grid),
    "points": (1.0, damaged_files.points),
    "result": (4.0, damaged_files.result),
    "sweep": (3.0, damaged_files.sweep),
    "load_cases": (2.0, damaged_files.load_cases),
    "deflections": (2.0, damaged_files.deflections),
    "supports": (2.0, damaged_files.supports),
    "batches": (1.5, damaged_files.batches),
    "problems": (0.25, damaged_files.problems),
    "study": (0.25, damaged_files.study),
    "exchange_file": (2.0, damaged_files.exchange_file),
    "formula": (1.0, damaged_files.formula),
    "teeth": (0.5, damaged_files.teeth),
    "options": (6.0, wrong_words.options),
    "mistaken": (2.0, wrong_words.mistaken),
    "paths": (2.0, odd_surroundings.paths),
    "stranger": (0.5, odd_surroundings.stranger),
    "surroundings": (0.15, odd_surroundings.surroundings),
    "modules": (0.05, odd_surroundings.modules),
}


def draw(seed: int, box: Box, kind: str | None = None) -> Input:
    """The input of a seed, with its files in the box."""
    rng = random.Random(seed)
    kind = kind or rng.choices(list(KINDS), [weight for weight, _ in KINDS.values()])[0]
    made = KINDS[kind][1](rng, box)
    made.kind = kind
    # Few, because a fresh process takes seconds to import what it needs.
    made.fresh = made.fresh or (not made.call and rng.random() < 0.01)
    if kind not in ("paths", "modules") and rng.random() < 0.15:
        _existing_output(rng, box, made)
    return made


def _existing_output(rng: random.Random, box: Box, made: Input) -> None:
    """Let there be an older file where the output goes, with permissions of its own."""
    for flag in ("-o", "--fitted-case"):
        if flag in made.args[:-1]:
            name = made.args[made.args.index(flag) + 1]
            path = box.folder / name
            if name and len(name) < 100 and not os.path.lexists(path) and path.parent.is_dir() and "\0" not in name:
                path.write_bytes(b"older\n")
                path.chmod(rng.choice([0o600, 0o644, 0o664, 0o640]))
