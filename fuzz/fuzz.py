"""Look for whatever breaks easeoff: mutated inputs, kills, full disks, concurrent runs, false claims of solvers.

Usage: python fuzz/fuzz.py [PART...] [--seed FIRST] [--count N], see fuzz/README.md
"""

from __future__ import annotations

import os

for variable in ("OPENBLAS_NUM_THREADS", "OMP_NUM_THREADS", "MKL_NUM_THREADS"):
    os.environ[variable] = "1"  # before numpy is imported: forked processes must find no threads
os.environ["MPLBACKEND"] = "Agg"

import argparse
import random
import sys
import tempfile
from collections import Counter
from collections.abc import Callable, Iterator
from dataclasses import dataclass, field
from pathlib import Path

import disturbed_analyses
import faults_while_writing
import imports
import inputs
from bases import Bases
from contact_problems import claims
from kinds.drawing import KINDS
from oracle import place
from writing_runs import RUNS, Reference, WritingRun, reference

HERE = Path(__file__).parent
#: Where inputs that found something are kept.
KEPT = HERE / "kept"
#: Times that a finding is shown; more of the same kind are counted.
SHOWN = 3


@dataclass(frozen=True)
class Case:
    """One thing tried.

    Attributes
    ----------
    what
        Its kind and command, for the count.
    faults
        What was wrong.
    where
        Where in the package an exception came from.
    detail
        Where its input is kept.
    """

    what: str
    faults: list[str]
    where: str = ""
    detail: str = ""


Part = Callable[[range, "Place"], Iterator[tuple[int, Case]]]


@dataclass(frozen=True)
class Place:
    """Folders of a search, what is asked for, and what undisturbed runs gave."""

    bases: Bases
    work: Path
    kind: str | None = None
    command: str | None = None
    references: dict[WritingRun, Reference] = field(default_factory=dict)


def mutated_inputs(seeds: range, place: Place) -> Iterator[tuple[int, Case]]:
    """Mutated inputs for every reader and command."""
    seen: Counter[str] = Counter()
    for seed in seeds:
        verdict = inputs.judge(seed, place.bases, place.work, place.kind)
        detail = ""
        if verdict.faults:
            seen[verdict.faults[0][:20] + verdict.where] += 1
            if seen[verdict.faults[0][:20] + verdict.where] <= SHOWN:
                detail = str(inputs.keep(verdict, place.bases, KEPT, place.kind))
        what = f"{verdict.made.kind} {verdict.made.command} {verdict.outcome.code}"
        yield seed, Case(what, verdict.faults, verdict.where, detail)


def analyses(seeds: range, folders: Place) -> Iterator[tuple[int, Case]]:
    """Analyses of disturbed cases, with warnings as errors."""
    for seed in seeds:
        outcome, faults = disturbed_analyses.judge(seed, folders.bases, folders.work)
        yield seed, Case(f"analysis {outcome.code}", faults, place(outcome.stderr))


def contact_problems(seeds: range, place: Place) -> Iterator[tuple[int, Case]]:
    """Random and degenerate contact problems, every claim about them judged in rational numbers."""
    for seed in seeds:
        what, faults = claims.judge(seed)
        yield seed, Case(what, faults)


def while_writing(name: str) -> Part:
    """A part that disturbs commands while they write, each in turn."""
    disturb = getattr(faults_while_writing, name)

    def tried(seeds: range, place: Place) -> Iterator[tuple[int, Case]]:
        runs = [run for run in RUNS if place.command in (None, run.words.split()[0])]
        for seed in seeds:
            run = runs[seed % len(runs)]
            if run not in place.references:
                place.references[run] = reference(run, place.bases, place.work)
            faults = disturb(random.Random(f"{name} {seed}"), run, place.references[run], place.bases, place.work)
            if faults is None:
                yield seed, Case("not tried: no disk can be mounted here", [])
            else:
                yield seed, Case(run.words.split()[0], faults, "", str(run))

    return tried


#: Parts, and how many they try for a hundred inputs.
PARTS: dict[str, tuple[Part, int]] = {
    "inputs": (mutated_inputs, 100),
    "analyses": (analyses, 20),
    "kill": (while_writing("kill"), 8),
    "fill": (while_writing("fill"), 4),
    "fill_disk": (while_writing("fill_disk"), 4),
    "together": (while_writing("together"), 2),
    "contact_problems": (contact_problems, 2000),
}


def main() -> None:
    """Run what the command line asks for; the exit code is 1 if anything was found."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("part", nargs="*", help=f"one of {', '.join(PARTS)}; all if left out")
    parser.add_argument("--seed", type=int, default=1, help="the first seed")
    parser.add_argument("--count", type=int, default=100, help="number of inputs; a part alone tries as many seeds")
    parser.add_argument("--kind", choices=list(KINDS), help="of inputs")
    parser.add_argument("--command", help="of parts that disturb writing")
    parser.add_argument(
        "--bases", type=Path, help="folder of unmutated files, kept from run to run; made anew if left out"
    )
    given = parser.parse_args()
    wrong = [part for part in given.part if part not in PARTS]
    if wrong:
        parser.error(f"{wrong[0]!r} is no part")
    imports.load()
    found = 0
    with tempfile.TemporaryDirectory(prefix="easeoff-fuzz-") as name:
        work = Path(name)
        bases = Bases(given.bases or work / "bases", work / "cache")
        bases.write_texts()
        place = Place(bases, work, given.kind, given.command)
        for part in given.part or PARTS:
            count = given.count if len(given.part) == 1 else max(1, given.count * PARTS[part][1] // 100)
            found += _run(part, range(given.seed, given.seed + count), place)
    sys.exit(1 if found else 0)


def _run(name: str, seeds: range, place: Place) -> int:
    """Run a part and print what it finds; return the number of findings."""
    tried: Counter[str] = Counter()
    found: Counter[tuple[str, str]] = Counter()
    for seed, case in PARTS[name][0](seeds, place):
        tried[case.what] += 1
        if not case.faults:
            continue
        key = (case.faults[0][:24], case.where)
        found[key] += 1
        if found[key] <= SHOWN:
            kind = f" --kind {place.kind}" if place.kind else ""
            text = "; ".join(case.faults).encode("unicode_escape").decode()
            print(f"{name} {seed}: {case.what}: {text} {case.where}")
            print(f"    python fuzz/fuzz.py {name} --seed {seed} --count 1{kind}")
            if case.detail:
                print(f"    {case.detail}")
            sys.stdout.flush()
    print(f"{name}: {len(seeds)} tried from seed {seeds.start}, {found.total()} findings of {len(found)} kinds")
    for what, count in sorted(tried.items()):
        print(f"    {count:6d} {what}")
    for (what, where), count in found.most_common():
        print(f"    found {count} times: {what} {where}")
    sys.stdout.flush()
    return found.total()


if __name__ == "__main__":
    main()
