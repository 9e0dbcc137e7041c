"""Mutations of TOML: values of other types and sizes in place of its values, keys, tables, and its syntax."""

from __future__ import annotations

import copy
import random
import tomllib
from collections.abc import Callable, Mapping
from datetime import date, time
from fractions import Fraction
from typing import Any

from . import text_mutations
import tomli_w

Tree = dict[str, Any]
Place = tuple[Any, Any]
"""A table or array, and the key or number of an entry in it."""

ODD_VALUES: tuple[Any, ...] = (
    float("nan"), float("inf"), -float("inf"), 0, 0.0, -0.0, -1, 1, 2, 1e300, -1e300, 1e-300, 5e-324, 2**63 - 1,
        -(2**63),
    10**400, True, False, "", "text", "nan", "1.0", "x" * 100_000, "\x1b[2J\x1b]0;owned\x07", "\u202etxt", "\u0000",
        "a\nb",
    "../../secret.toml", "/etc/passwd", "%s %n {0}", [], {}, [[]], [{}], [1.0], [1.0, 2.0], [float("nan")], [[1.0],
    [2.0]],
    ["x"], [True], [1, "x"], {"x": 1}, {"": 1}, date(1979, 5, 27), time(7, 32), [0.0] * 20_000, list(range(2000)),
)  # fmt: skip
#: Raw syntax that a writer of TOML never makes.
FRAGMENTS = (
    "x = " + "[" * 3000 + "]" * 3000, "x = " + "{a=" * 3000 + "1" + "}" * 3000, "[" + ".".join(["a"] * 3000) + "]",
    "x." + ".".join(["a"] * 2000) + " = 1", "x = " + "9" * 5000, "x = 1e" + "9" * 5000, "x = 0x" + "f" * 5000,
    "x = 0." + "1" * 5000,
    "[pair]", "[pair]\n[pair]", "[[pair]]", "[pair.x]\n[pair]", "x = 1\nx = 2", '"" = 1', '"\\u001b[31m" = 1',
    "x = '''", 'x = """',
    "= 1", "x =", "x = 1 2", "[", "[]", "[a", "a]", "x = inf", "x = 1979-13-45", 'x = "\\q"', 'x = "\\uD800"',
    "x = {a = 1, a = 2}",
    "\n".join(f"k{n} = {n}" for n in range(3000)), "\n".join(f"[t{n}]" for n in range(2000)),
)  # fmt: skip


def mutated(rng: random.Random, text: str, keys: Mapping[str, tuple[Any, ...]] | None = None) -> str:
    """Text of a TOML file after mutations of its values, its keys or its text.

    Parameters
    ----------
    rng
        Draws what is changed.
    text
        A valid TOML file.
    keys
        Dotted keys that the file may have, and values that reach more of the code than odd ones.
    """
    way = rng.random()
    if way < 0.35:
        return text_mutations.mutated(rng, text)
    if way < 0.42:
        return _with_fragment(rng, text)
    tree = tomllib.loads(text)
    for _ in range(rng.choice([1, 1, 1, 2, 3])):
        if keys and rng.random() < 0.4:
            _set_key(rng, tree, keys)
        else:
            rng.choice(CHANGES)(rng, tree)
    try:
        return tomli_w.dumps(tree)
    except (TypeError, ValueError, RecursionError):
        return _with_fragment(rng, text)


def _with_fragment(rng: random.Random, text: str) -> str:
    lines = text.split("\n")
    lines.insert(rng.randrange(len(lines) + 1), rng.choice(FRAGMENTS))
    return "\n".join(lines)


def places(tree: Any) -> list[Place]:
    """Every entry of a tree, tables and arrays among them."""
    entries = list(tree.items() if isinstance(tree, dict) else enumerate(tree) if isinstance(tree, list) else [])
    return [(tree, key) for key, _ in entries] + [place for _, value in entries for place in places(value)]


def _place(rng: random.Random, tree: Tree, *types: type) -> Place | None:
    found = [(at, key) for at, key in places(tree) if not types or isinstance(at[key], types)]
    return rng.choice(found) if found else None


def odd_value(rng: random.Random, tree: Tree) -> None:
    """Another value, mostly of another type."""
    place = _place(rng, tree)
    if place:
        place[0][place[1]] = copy.deepcopy(rng.choice(ODD_VALUES))


def scale(rng: random.Random, tree: Tree) -> None:
    """A number in other units, with another sign, or slightly off."""
    place = _place(rng, tree, float, int)
    if place:
        factor = rng.choice(
            [1e-3, 1e3, 25.4, 1 / 25.4, 0.1, 10.0, 0.5, 2.0, 0.9, 1.1, 0.99, 1.01, -1.0, 57.29578, 1 / 57.29578]
        )
        old = place[0][place[1]]
        place[0][place[1]] = old * factor if isinstance(old, float) else round(old * Fraction(factor))


def other_type(rng: random.Random, tree: Tree) -> None:
    """The same value as text, in an array, in a table, or as a whole number."""
    place = _place(rng, tree, float, int, str)
    if place:
        old = place[0][place[1]]
        whole = round(old) if isinstance(old, float) and abs(old) < 1e300 else 1
        place[0][place[1]] = rng.choice([str(old), [old], [old, old], {"value": old}, whole, [[old]]])


def delete(rng: random.Random, tree: Tree) -> None:
    """Delete a key, a table or an entry of an array."""
    place = _place(rng, tree)
    if place:
        del place[0][place[1]]


def rename(rng: random.Random, tree: Tree) -> None:
    """Misspell a key, or give it odd characters."""
    found = [(at, key) for at, key in places(tree) if isinstance(at, dict)]
    if found:
        at, key = rng.choice(found)
        at[
            rng.choice(
                [
                    key[:-1],
                    key + "s",
                    key.upper(),
                    key.replace("_", "-"),
                    key + rng.choice(text_mutations.ODD_CHARACTERS),
                ]
            )
        ] = at.pop(key)


def exchange(rng: random.Random, tree: Tree) -> None:
    """Exchange two values."""
    first, second = _place(rng, tree, float, int, str, list), _place(rng, tree, float, int, str, list)
    if first and second:
        (a, i), (b, j) = first, second
        a[i], b[j] = b[j], a[i]


def move(rng: random.Random, tree: Tree) -> None:
    """Copy a table to another place, or take its content up to the root."""
    place = _place(rng, tree, dict)
    if place:
        value = copy.deepcopy(place[0][place[1]])
        into, content = rng.choice([(tree, value), (tree, {"more": value}), (value, {"pair": value.copy()})])
        into.update(content)
        place[0][place[1]] = value if rng.random() < 0.5 else [value, value]


def resize(rng: random.Random, tree: Tree) -> None:
    """Make an array shorter, longer or unsorted."""
    place = _place(rng, tree, list)
    if place:
        old = place[0][place[1]]
        place[0][place[1]] = rng.choice([old[:-1], old[::-1], old * 2, old[:1], old * 5000, [old, old]])


CHANGES: tuple[Callable[[random.Random, Tree], None], ...] = (
    odd_value, odd_value, odd_value, scale, scale, scale, other_type, delete, delete, rename, exchange, exchange,
        move, resize,
)  # fmt: skip


def _set_key(rng: random.Random, tree: Tree, keys: Mapping[str, tuple[Any, ...]]) -> None:
    name = rng.choice(list(keys))
    *tables, last = name.split(".")
    at = tree
    for table in tables:
        below = at.setdefault(table, {})
        if not isinstance(below, dict):
            return
        at = below
    at[last] = copy.deepcopy(rng.choice(keys[name]))
