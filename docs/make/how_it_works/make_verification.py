"""Write verification.md from fresh verifications of the shipped cases: python docs/make verification.

``python docs/make verification --without-split`` solves the contact without the split anew as well, which takes some
minutes a case; else its rows stay as they are in the page.

After a change of numbers or limits; takes a quarter of an hour.
"""

from __future__ import annotations

import itertools
import re
import sys
from pathlib import Path

from folders import HOW_IT_WORKS
from tabulate import tabulate

from easeoff.cases import shipped_cases
from easeoff.core.output_file import whole_file
from easeoff.geometry import FlankName
from easeoff.verification import RowStatus, Verification, VerificationRow, verify

HERE = Path(__file__).parent
FLANKS: tuple[FlankName, ...] = ("drive", "coast")
UNSPLIT = "without the split"
FINER = ("grid of the flank", "segments of a line", "mesh positions", "fineness of the teeth")
GROUPS = (
    "unloaded transmission error",
    "transmission error",
    "greatest pressure",
    "greatest pressure, at a line's end",
    "shares, ratios and places",
    "other numbers",
)
UNSPLIT_CASES = ("fh-12x41-45", "fm-11x41", "nasa-12x36")
UNSPLIT_START, UNSPLIT_END = "<!-- without the split -->\n", "\n<!-- end -->"


def of_solvers(rows: list[VerificationRow]) -> VerificationRow:
    """One row for all polished solvers: the worst."""
    worst = max(rows, key=lambda row: (row.status == RowStatus.OUTSIDE, row.difference))
    return VerificationRow("other solvers, polished", "", worst.difference, worst.limit, worst.unit)


def shown(rows: tuple[VerificationRow, ...], *, unsplit: bool) -> dict[str, VerificationRow]:
    """Rows of a table by quantity, the worse of both members: of the contact without the split, or all others."""
    chosen = [row for row in rows if (UNSPLIT in row.compared or UNSPLIT in row.quantity) == unsplit]
    solvers = [row for row in chosen if row.quantity.startswith("solver ") and row.applicable]
    found: dict[str, VerificationRow] = {}
    for row in chosen:
        if row in solvers:
            found.setdefault("other solvers, polished", of_solvers(solvers))
        else:
            quantity = re.sub(", (pinion|gear)$", "", row.quantity)
            found[quantity] = worse([row, *([found[quantity]] if quantity in found else [])])
    return found


def cell(row: VerificationRow | None) -> str:
    """A difference; in bold outside its limit."""
    if row is None or not row.applicable:
        return "-"
    text = f"{row.difference:.2g}"
    return text if row.status == RowStatus.WITHIN else f"**{text}**"


def worse(rows: list[VerificationRow]) -> VerificationRow:
    """The row that is nearest to its limit, or farthest beyond it."""
    return max(rows, key=lambda row: (row.applicable, row.status == RowStatus.OUTSIDE, row.difference))


def greatest(found: dict[str, list[Verification]], *, unsplit: bool = False) -> dict[str, dict[str, VerificationRow]]:
    """Worst row of each quantity among the verifications of each column."""
    columns: dict[str, dict[str, VerificationRow]] = {}
    for name, verifications in found.items():
        sides = [shown(one.rows, unsplit=unsplit) for one in verifications]
        quantities = dict.fromkeys(key for side in sides for key in side)
        columns[name] = {key: worse([side[key] for side in sides if key in side]) for key in quantities}
    return columns


def table(found: dict[str, list[Verification]], *, unsplit: bool = False) -> str:
    """A row a quantity but those of convergence, with the worst of the verifications of each column."""
    columns = greatest(found, unsplit=unsplit)
    every = [shown(one.rows, unsplit=unsplit) for verifications in found.values() for one in verifications]
    lines = []
    for key in dict.fromkeys(key for rows in columns.values() for key in rows):
        known = [side[key] for side in every if key in side and side[key].applicable]
        if key.split(": ")[0] in FINER:
            continue
        unit = f" [{known[0].unit}]" if known and known[0].unit != "1" else ""
        limit = [f"{known[0].limit:.2g}" if known else ""] * unsplit  # of the others the page gives it above
        lines.append([f"{key}{unit}", *(cell(rows.get(key)) for rows in columns.values()), *limit])
    return tabulate(lines, ["quantity", *columns, *["limit"] * unsplit], "github", disable_numparse=True)


def convergence_table(found: list[Verification]) -> str:
    """A row for what is finer, a column for a group of numbers."""
    rows = greatest({"": found})[""]
    lines = [[finer, *(cell(rows.get(f"{finer}: {group}")) for group in GROUPS)] for finer in FINER]
    return tabulate(lines, ["finer", *GROUPS], "github", disable_numparse=True)


def kept_unsplit(page: str) -> str:
    """What the page has of the contact without the split."""
    return page.split(UNSPLIT_START)[1].split(UNSPLIT_END)[0]


def main() -> None:
    """Write the page."""
    anew = "--without-split" in sys.argv[1:]
    target = HOW_IT_WORKS / "verification.md"
    found: dict[str, list[Verification]] = {name: [] for name in shipped_cases()}
    for flank, name in itertools.product(FLANKS, found):
        unsplit = anew and flank == "drive" and name in UNSPLIT_CASES
        found[name].append(verify(name, flank=flank, without_split=unsplit))
        print(f"{name}, {flank}: {len(found[name][-1].outside)} outside", flush=True)
    if anew:
        solved = table({f"`{name}`": found[name][:1] for name in UNSPLIT_CASES}, unsplit=True)
    else:
        solved = kept_unsplit(target.read_text(encoding="utf-8"))
    page = (HERE / "verification.md.in").read_text(encoding="utf-8")
    parts = {
        "cases": table({"greatest": [*itertools.chain(*found.values())]}),
        "convergence": convergence_table([*itertools.chain(*found.values())]),
        "unsplit": f"{UNSPLIT_START}{solved}{UNSPLIT_END}",
    }
    for name, text in parts.items():
        page = page.replace(f"{{{name}}}", text)
    with whole_file(target) as temporary:
        temporary.write_text(page, encoding="utf-8")
    print("wrote docs/how_it_works/verification.md")


if __name__ == "__main__":
    main()
