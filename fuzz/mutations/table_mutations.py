"""Mutations of tables of measured points: cells, columns, separators, heads, and matrices of other programs."""

from __future__ import annotations

import contextlib
import random
from collections.abc import Callable

from . import text_mutations

ODD_CELLS = (
    "nan",
    "inf",
    "",
    "x",
    "1e300",
    "-1e300",
    "-1",
    "0",
    "1e-9",
    "1,5",
    "999",
    "9" * 5000,
    "1.5",
    "-",
    "#",
    '"1"',
    "\x1b[31m",
)
HEADS = (
    (), ("# rows: root to tip", "# columns: toe to heel", "# flank: concave", "# deviation_unit: um"),
    ("# rows: tip to root", "# columns: heel to toe", "# flank: convex", "# deviation_unit: mm"), ("# rows: sideways",),
    ("# flank: \x1b[2J",), ("# deviation_unit: parsec",),
)  # fmt: skip


def cell(rng: random.Random, text: str) -> str:
    """Write something odd into a cell."""
    lines = text.split("\n")
    at = rng.randrange(len(lines))
    cells = lines[at].split(",")
    cells[rng.randrange(len(cells))] = rng.choice(ODD_CELLS)
    lines[at] = ",".join(cells)
    return "\n".join(lines)


def separators(rng: random.Random, text: str) -> str:
    """Write the table as other programs and countries do."""
    old, new, decimal = rng.choice(
        [(",", ";", "."), (",", ";", ","), (",", "\t", "."), (",", " ", "."), (",", ",", ","), (",", "|", ".")]
    )
    return _in_body(text, lambda line: line.replace(old, new).replace(".", decimal))


def column(rng: random.Random, text: str) -> str:
    """Drop, exchange or scale a column."""
    at, other = rng.randrange(8), rng.randrange(8)
    factor = rng.choice([1e3, 1e-3, -1.0, 100.0, 0.0, 1e300, float("nan")])
    way = rng.choice(["drop", "exchange", "scale"])

    def changed(line: str) -> str:
        cells = line.split(",")
        if len(cells) > max(at, other):
            if way == "drop":
                del cells[at]
            elif way == "exchange":
                cells[at], cells[other] = cells[other], cells[at]
            else:
                with contextlib.suppress(ValueError):
                    cells[at] = repr(float(cells[at]) * factor)
        return ",".join(cells)

    return _in_body(text, changed)


def head(rng: random.Random, text: str) -> str:
    """Drop or replace the comments in front."""
    return "\n".join([*rng.choice(HEADS), *(line for line in text.split("\n") if not line.startswith("#"))])


def rows(rng: random.Random, text: str) -> str:
    """Shuffle the rows, keep a few, or repeat all."""
    lines = text.split("\n")
    way = rng.choice(["shuffle", "keep", "repeat", "reverse"])
    if way == "shuffle":
        rng.shuffle(lines)
    return "\n".join(
        {"keep": lines[: rng.randrange(12)], "repeat": lines * rng.choice([2, 2, 3000]), "reverse": lines[::-1]}.get(
            way, lines
        )
    )


def matrix(rng: random.Random, text: str) -> str:
    """Replace everything by a matrix of deviations, as measuring machines print it."""
    mark = rng.choice([",", " ", "\t", ";"])
    decimal = "," if mark == ";" else "."
    count = rng.choice([(5, 9), (9, 5), (3, 3), (1, 9), (5, 1), (2, 2), (300, 300)])
    spoil = rng.choice([0.0, 0.0, 0.02])
    largest = rng.choice([5.0, 20.0, 1e4])

    def entry() -> str:
        return (
            rng.choice(ODD_CELLS)
            if rng.random() < spoil
            else f"{rng.uniform(-largest, largest):.1f}".replace(".", decimal)
        )

    body = [mark.join(entry() for _ in range(count[1])) for _ in range(count[0])]
    return "\n".join([*rng.choice(HEADS), *body])


def _in_body(text: str, change: Callable[[str], str]) -> str:
    return "\n".join(line if line.startswith("#") else change(line) for line in text.split("\n"))


MUTATIONS = (cell, cell, cell, separators, column, column, head, rows, matrix, *text_mutations.MUTATIONS)


def mutated(rng: random.Random, text: str) -> str:
    """Text after some of these mutations or those of any text."""
    return text_mutations.mutated(rng, text, MUTATIONS)
