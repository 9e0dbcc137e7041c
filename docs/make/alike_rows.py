"""One row of a table for keys or variables that have the same meaning but for a word or two."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from typing import TypeVar

Row = TypeVar("Row")
MOST_WORDS = 3  # in which meanings may differ


def joined(meanings: list[str]) -> str | None:
    """One meaning for several: theirs if they agree, or the common words around those that differ; None if neither.

    >>> joined(["roughness of the pinion", "roughness of the gear"])
    'roughness of the pinion, gear'
    """
    if len(set(meanings)) == 1:
        return meanings[0]
    words = [meaning.split() for meaning in meanings]
    shortest = min(map(len, words))
    before = next((i for i in range(shortest) if len({w[i] for w in words}) > 1), shortest)
    after = next((i for i in range(shortest - before) if len({w[-1 - i] for w in words}) > 1), shortest - before)
    between = [w[before : len(w) - after] for w in words]
    longest = MOST_WORDS if not after else 2
    if len(set(map(tuple, between))) < len(between) or not before + after:
        return None
    if not all(1 <= len(w) <= longest and not set("".join(w)) & set(";,`(") for w in between):
        return None
    return " ".join([*words[0][:before], ", ".join(map(" ".join, between)), *words[0][len(words[0]) - after :]])


def in_few_rows(
    rows: Iterable[Row], meaning: Callable[[Row], str], alike: Callable[[Row], object]
) -> list[tuple[list[Row], str]]:
    """Groups of neighbours whose other cells agree and whose meanings can be joined, with the joined meaning."""
    groups: list[tuple[list[Row], str]] = []
    for row in rows:
        last = groups[-1][0] if groups else []
        said = joined([meaning(each) for each in (*last, row)]) if last and alike(last[0]) == alike(row) else None
        if said is None:
            groups.append(([row], meaning(row)))
        else:
            groups[-1] = ([*last, row], said)
    return groups
