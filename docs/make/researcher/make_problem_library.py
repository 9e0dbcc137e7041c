"""Write the tables and lists of ``problem_library.md`` from the description of the library and its reference answers.

``python docs/make problem_library`` updates the page; with ``--print`` it only prints the tables; with ``--answers``
it first makes every problem and proves its reference answer anew, which takes minutes and belongs to a new version of
the library; with ``--new-answers`` it proves those that are missing.

After a change of the library, or of the model behind it, with ``--answers``; raise ``LIBRARY_VERSION`` first.
"""

from __future__ import annotations

import math
import sys
from collections.abc import Iterable
from pathlib import Path

from folders import RESEARCHER
from generated_part import with_generated
from proved_answers import proved_answer, write_answers

import easeoff.study.library
from easeoff.study.library import ReferenceAnswer, entries, generate, reference_answers
from easeoff.study.library.library_entries import KINDS, PARTS, TABLE
from easeoff.study.library.library_files import CHANGES

PAGE = RESEARCHER / "problem_library.md"


def kind_table() -> str:
    """One row a kind."""
    answers, every = reference_answers(), entries()
    rows = []
    for kind, why in KINDS.items():
        chosen = [entry for entry in every if entry.kind == kind]
        found = [answers[entry.name] for entry in chosen]
        rows.append([f"`{kind}`", str(len(chosen)), _conditions(found), why])
    return _table(["kind", "problems", "condition of *C*", "what"], rows)


def part_table() -> str:
    """One line a file."""
    answers, lines = reference_answers(), []
    for part in PARTS:
        chosen = [entry for entry in entries() if entry.part == part]
        lines.append(
            f"- `{part}.nc`: {len(chosen)} problems, *n* {_range(answers[entry.name].size for entry in chosen)}"
        )
    return "\n".join(lines)


def change_table() -> str:
    """One line a change."""
    lines = []
    for change, function in CHANGES.items():
        said = (function.__doc__ or "").split("\n")[0].removesuffix(".")
        lines.append(f"- `{change}`: {said[:1].lower()}{said[1:]}")
    return "\n".join(lines)


def proof_table() -> str:
    """One line a method that proves answers."""
    every, lines = reference_answers().values(), []
    for method in ("refined", "lemke"):
        found = {a.name: getattr(a, f"{method}_difference") for a in every}
        known = {name: value for name, value in found.items() if math.isfinite(value)}
        worst = max(known, key=lambda name: known[name])
        lines.append(f"- {method}, {len(known)} problems: {known[worst]:.0e}, `{worst}`")
    return "\n".join(lines)


def _range(numbers: Iterable[int]) -> str:
    every = sorted(set(numbers))
    return str(every[0]) if len(every) == 1 else f"{every[0]} to {every[-1]}"


def _conditions(found: Iterable[ReferenceAnswer]) -> str:
    every = sorted(answer.condition_number for answer in found)
    return f"{_condition(every[0])} to {_condition(every[-1])}"


def _condition(number: float) -> str:
    return f"{number:.0e}" if math.isfinite(number) and number >= 1000 else f"{number:.0f}" if number < 1000 else "∞"


def _table(head: list[str], rows: list[list[str]]) -> str:
    lines = [head, ["---"] * len(head), *rows]
    return "\n".join("| " + " | ".join(line) + " |" for line in lines)


TABLES = {
    "parts": part_table,
    "kinds": kind_table,
    "changes": change_table,
    "proofs": proof_table,
}


def updated(page: str) -> str:
    """The page with its generated parts, each between two comments, made anew."""
    for name, table in TABLES.items():
        page = with_generated(page, name, table())
    return page


def main() -> None:
    """Prove the answers if asked to; print the tables or update the page."""
    arguments = sys.argv[1:]
    if "--answers" in arguments or "--new-answers" in arguments:
        found = reference_answers() if "--new-answers" in arguments else {}
        for entry, problem in generate(entry for entry in entries() if entry.name not in found):
            found[entry.name] = proved_answer(entry.name, problem)
            print(found[entry.name], flush=True)
        write_answers([found[entry.name] for entry in entries()], Path(easeoff.study.library.__file__).with_name(TABLE))
    if "--print" in arguments:
        print("\n\n".join(table() for table in TABLES.values()))
        return
    PAGE.write_text(updated(PAGE.read_text(encoding="utf-8")), encoding="utf-8")


if __name__ == "__main__":
    main()
