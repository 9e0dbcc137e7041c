"""Changes of the numbers of a case that leave it a case: small ones, large ones, and counts."""

from __future__ import annotations

import copy
import random
import tomllib

import tomli_w

from .case_keys import COMPLIANCE, FRICTION, MISALIGNMENT
from .toml_mutations import Tree, places

COUNTS = (
    "number_of_teeth",
    "number_of_blade_groups",
    "mesh_positions",
    "segments_per_line",
    "lengthwise_nodes",
    "profile_nodes",
)


def disturbed(rng: random.Random, text: str) -> str:
    """Text of a case after a change of some or all of its numbers, small or large."""
    tree = tomllib.loads(text)
    for name, table in (("friction", FRICTION), ("misalignment", MISALIGNMENT), ("compliance", COMPLIANCE)):
        if name not in tree and rng.random() < 0.3:
            tree[name] = copy.deepcopy(table)
    numbers = [(at, key) for at, key in places(tree) if isinstance(at[key], float)]
    chosen = numbers if rng.random() < 0.3 else rng.sample(numbers, min(len(numbers), rng.choice([1, 1, 1, 2, 3, 8])))
    size = 10.0 ** rng.uniform(-12.0, 0.0)
    for at, key in chosen:
        at[key] = _changed(rng, at[key], size)
    if rng.random() < 0.1:
        _change_count(rng, tree)
    return tomli_w.dumps(tree)


def _changed(rng: random.Random, value: float, size: float) -> float:
    way = rng.random()
    if way < 0.8:
        return value * (1.0 + size * rng.uniform(-1.0, 1.0)) if value else size * rng.uniform(-1.0, 1.0)
    if way < 0.95:
        return value * rng.choice([0.0, -1.0, 0.5, 2.0, 10.0, 1e-3, 1e3, 1e-9, 1e9])
    return rng.choice([0.0, 1e-12, 90.0, 180.0, -90.0, 1e6, -1e-300, 5e-324, 1e150])


def _change_count(rng: random.Random, tree: Tree) -> None:
    counts = [(at, key) for at, key in places(tree) if key in COUNTS]
    if counts:
        at, key = rng.choice(counts)
        at[key] = max(1, at[key] + rng.choice([-5, -1, 1, 2, 10]))
