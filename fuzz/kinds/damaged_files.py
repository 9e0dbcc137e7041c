"""Damaged files for every reader and every command that reads."""

from __future__ import annotations

import random
import shutil
from pathlib import Path

from bases import COMMANDS
from mutations import array_mutations, byte_mutations, markup_mutations, path_mutations

from .box import Box, Input
from .mutated_file import any_mutation


#: Sweep that resumes from the batches of the one in the base files.
SWEEP = COMMANDS["sweep.nc"].replace("nasa.toml -o sweep.nc", "case.toml -o out.nc")


def case(rng: random.Random, box: Box) -> Input:
    """A mutated case, for every command that takes one."""
    name = any_mutation(rng, box, rng.choice([*box.bases.of("case"), "nasa.toml", "nasa.toml"]), "case.toml")
    return Input("", rng.choice(case_commands(name)), [name])


def case_commands(name: str) -> list[list[str]]:
    """Command lines for a case; the analysis more often than others."""
    run = ["run", name, "-o", "out.nc"]
    return [
        *[run] * 6,
        [*run, "--plots", "pictures"],
        [*run, "--flank", "coast"],
        [*run, "--speed", "800"],
        [*run, "--deviation", "gear=fm-11x41-worn-gear"],
        [*run, "--load-cases", "case"],
        ["sweep", name, "-o", "out.nc", "--over", "E=0,0.05", "--torque", "50", "--workers", "1"],
        ["vh", name, "-o", "out.nc"],
        ["problems", name, "-o", "out.nc"],
        ["wear", name, "-o", "out.nc", "--torque", "50", "--revolutions", "1e3"],
        ["modify", name, "-o", "out.nc", "--order", "2", "--torque", "50", "--fitted-case", "fit.toml"],
        ["correct", name, "--deviation", "gear=fm-11x41-worn-gear"],
        ["verify", name, "--torque", "50", "-o", "table.nc"],
        ["design", name, "-o", "o.toml"],
        ["convert", name, "-o", "o.rexs"],
        ["convert", name, "-o", "o.toml"],
        *[["export", name, "-o", output, "--nodes", "9x7"] for output in ("o.csv", "o.stl", "o.nc", "o.vtu")],
    ]


def design(rng: random.Random, box: Box) -> Input:
    """A mutated design."""
    name = any_mutation(rng, box, rng.choice(box.bases.of("design")), "design.toml")
    return Input("", ["design", name, "-o", "o.toml", *rng.choice([[], ["--report"]])], [name])


def oil(rng: random.Random, box: Box) -> Input:
    """A mutated lubricant, given as an option or by the case."""
    name = any_mutation(rng, box, rng.choice(box.bases.of("oil")), "oil.toml")
    pair = box.copy("nasa.toml", "case.toml")
    if rng.random() < 0.3:
        with open(box.folder / pair, "a", encoding="utf-8") as stream:
            stream.write('\n[friction]\nspeed = 500.0\ntemperature = 60.0\noil = "oil.toml"\n')
        return Input("", ["run", pair, "-o", "out.nc", "--torque", "50"], [pair, name])
    words = ["--torque", "50", "--speed", "500", "--temperature", "60", "--oil", name]
    return Input("", ["run", pair, "-o", "out.nc", *words], [pair, name])


def grid(rng: random.Random, box: Box) -> Input:
    """A mutated grid of deviations, measuring points, or wear, as a deviation."""
    base = rng.choice(box.bases.of("grid", "grid", "points", "wear"))
    name = any_mutation(rng, box, base, "grid" + Path(base).suffix)
    pair = box.copy("fm.toml", "case.toml")
    given = ["--deviation", f"gear={name}"]
    words = rng.choice(
        [
            *[["run", pair, "-o", "out.nc", "--torque", "100", *given]] * 3,
            [
                "run",
                pair,
                "-o",
                "out.nc",
                "--torque",
                "100",
                *given,
                "--interpolation",
                rng.choice(["smooth", "weighted_average"]),
            ],
            ["run", pair, "-o", "out.nc", "--torque", "100", *given, "--deviated", "surface"],
            ["correct", pair, *given],
            ["problems", pair, "-o", "out.nc", "--torque", "100", *given],
            ["wear", pair, "-o", "out.nc", "--torque", "100", "--revolutions", "1e3", *given],
        ]
    )
    return Input("", words, [pair, name])


def points(rng: random.Random, box: Box) -> Input:
    """Mutated measuring points, read by the function for them."""
    base = rng.choice(box.bases.of("points", "grid"))
    name = any_mutation(rng, box, base, "points" + Path(base).suffix)
    return Input("", [name], [name], call="points")


def result(rng: random.Random, box: Box) -> Input:
    """A mutated result, shown or drawn."""
    base = rng.choice(box.bases.of("result", "result", "duty", "duty", "sweep", "wear", "problems", "table", "vh"))
    name = any_mutation(rng, box, base, "r.nc")
    drawn = [
        ["plot", name, "pictures"],
        ["report", name, "-o", "report.html"],
        ["cite", name],
        ["cite", name, "--bibtex"],
    ]
    return Input("", rng.choice([*[["show", name]] * 5, *drawn]), [name])


def sweep(rng: random.Random, box: Box) -> Input:
    """A mutated file of a sweep, shown or drawn."""
    name = any_mutation(rng, box, rng.choice(box.bases.of("sweep")), "r.nc")
    return Input("", rng.choice([*[["show", name]] * 3, ["plot", name, "pictures"]]), [name])


def load_cases(rng: random.Random, box: Box) -> Input:
    """A mutated table of load cases, for an analysis or as points of a sweep."""
    name = any_mutation(rng, box, "duty.csv", "duty.csv")
    pair = box.copy("nasa.toml", "case.toml")
    given = ["-o", "out.nc", "--load-cases", name, *rng.choice([[], ["--temperature", "60"]])]
    words = rng.choice([["run", pair, *given], ["sweep", pair, *given, "--workers", "1"]])
    return Input("", words, [pair, name])


def deflections(rng: random.Random, box: Box) -> Input:
    """A mutated table of deflections, for one of the commands that take it."""
    name = any_mutation(rng, box, "axle.csv", "axle.csv")
    pair = box.copy("nasa.toml", "case.toml")
    given = [pair, "-o", "out.nc", "--misalignment", name, "--flank", rng.choice(["drive", "coast"])]
    duty = box.copy("duty.csv")
    words = rng.choice(
        [
            *[["run", *given, *rng.choice([[], ["--speed", "500"], ["--torque", "40,500"]])]] * 3,
            ["run", *given, "--load-cases", duty],
            ["sweep", *given, "--over", "E=0,0.1", "--workers", "1"],
            ["vh", *given],
            ["problems", *given],
            ["wear", *given, "--torque", "40=0.5,100=0.5", "--revolutions", "1e4"],
        ]
    )
    return Input("", words, [pair, name, duty])


def supports(rng: random.Random, box: Box) -> Input:
    """A mutated file of supports, for one of the commands that take it."""
    name = any_mutation(rng, box, rng.choice(box.bases.of("supports")), "supports.toml")
    pair = box.copy("nasa.toml", "case.toml")
    given = [pair, "-o", "out.nc", "--supports", name, "--flank", rng.choice(["drive", "coast"])]
    words = rng.choice(
        [
            *[["run", *given, *rng.choice([[], ["--speed", "500"], ["--torque", "40,500"]])]] * 3,
            ["sweep", *given, "--over", "E=0,0.1", "--workers", "1"],
            ["problems", *given],
        ]
    )
    return Input("", words, [pair, name])


def batches(rng: random.Random, box: Box) -> Input:
    """Damaged, exchanged, foreign or missing files of a sweep that resumes: the result is the same without them."""
    files = box.bases.batches()
    for path in files:
        box.put(f"batches/{path.name}", path.read_bytes())
    texts = [path.name for path in files if path.suffix != ".npz"]
    numbers = [path.name for path in files if path.suffix == ".npz"]
    for _ in range(rng.choice([1, 1, 2, 3])):
        chosen = box.folder / "batches" / rng.choice([*texts * 2, *numbers])
        way = rng.choice(
            ["bytes", "bytes", "text", "text", "exchange", "missing", "foreign", "folder", "empty", "link"]
        )
        if chosen.is_file() and way in ("bytes", "text"):
            data = chosen.read_bytes()
            if way == "text" and chosen.name in texts:
                lines = markup_mutations.mutated_json_lines(rng, data.decode("utf-8", "replace"))
                chosen.write_bytes(lines.encode("utf-8", "surrogatepass"))
            else:
                chosen.write_bytes(byte_mutations.mutated(rng, data))
        elif chosen.is_file() and way in ("exchange", "missing"):
            shutil.copyfile(box.bases["sweep.nc"].with_name("batches") / rng.choice(numbers), chosen)
            if way == "missing":
                chosen.unlink()
        elif way == "foreign":
            names = ("notes.txt", "batch-000099.npz", "batch-1.npz", "batch-000001.npz.tmp", ".easeoff-x.tmp", "a/b")
            box.put(f"batches/{rng.choice(names)}", b"foreign\n")
        else:
            path_mutations.occupy(rng, chosen, {"folder": "folder", "link": "circle of links"}.get(way, "empty"))
    name = box.copy("nasa.toml", "case.toml")
    words = SWEEP.split()
    return Input("", [*words, *rng.choice([[], [], [], ["--fresh"]])], [name], same_as="sweep.nc")


def problems(rng: random.Random, box: Box) -> Input:
    """Mutated contact problems, compared."""
    name = any_mutation(rng, box, "problems.nc")
    words = ["--solvers", "native", "--repetitions", "1", "--time-limit", "5"]
    return Input("", ["compare", name, "-o", "study", *words], [name])


def study(rng: random.Random, box: Box) -> Input:
    """A comparison that resumes from a mutated file of measurements."""
    name = box.copy("problems.nc")
    any_mutation(rng, box, "study/measurements.jsonl", "study/measurements.jsonl")
    return Input("", ["compare", name, "-o", "study", "--solvers", "native", "--repetitions", "1"], [name])


def exchange_file(rng: random.Random, box: Box) -> Input:
    """A mutated REXS file or session script."""
    base = rng.choice(["fm.rexs", "pair.ses"])
    name = any_mutation(rng, box, base)
    words = rng.choice(
        [*[["convert", name, "-o", "o.toml"]] * 5, ["convert", name, "-o", "o.rexs"], ["run", name, "-o", "out.nc"]]
    )
    return Input("", words, [name])


def formula(rng: random.Random, box: Box) -> Input:
    """A mutated friction formula."""
    name = any_mutation(rng, box, "formula.json")
    return Input("", [name], [name], call="formula")


def teeth(rng: random.Random, box: Box) -> Input:
    """Mutated, exchanged or foreign files of condensed teeth in the cache: the result is the same without them."""
    files = box.bases.teeth()
    way = rng.choice(["arrays", "arrays", "arrays", "bytes", "bytes", "exchange", "text", "folder", "empty", "link"])
    for path in files:
        box.put(f"teeth/{path.name}", path.read_bytes())
    chosen = box.folder / "teeth" / rng.choice(files).name
    if way == "bytes":
        chosen.write_bytes(byte_mutations.mutated(rng, chosen.read_bytes()))
    elif way == "arrays":
        array_mutations.mutate(rng, chosen)
    elif way == "exchange" and len(files) > 1:
        shutil.copyfile(rng.choice(files), chosen)
    elif way == "text":
        chosen.write_text("text")
    else:
        path_mutations.occupy(rng, chosen, {"folder": "folder", "link": "circle of links"}.get(way, "empty"))
    name = box.copy("fe.toml", "case.toml")
    words = ["run", name, "-o", "out.nc", "--torque", "50"]
    return Input("", words, [name], environment={"EASEOFF_CACHE": "teeth"}, same_as="fe.nc")
