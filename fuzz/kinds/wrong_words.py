"""Good files and wrong words: options as nobody should write them, and files of one kind where another is wanted."""

from __future__ import annotations

import random
from pathlib import Path

from mutations import option_values

from .box import Box, Input
from .damaged_files import case_commands


def options(rng: random.Random, box: Box) -> Input:
    """Good files, and options as nobody should write them."""
    pair = box.copy(rng.choice(["nasa.toml", "fm.toml"]), "case.toml")
    command = rng.choice([*["run"] * 6, *["sweep"] * 5, "vh", *option_values.OPTIONS])
    pair = rng.choice(
        [*[pair] * 8, "nasa", "nasa-12x37", "", "case", ".", "no.toml", "FM-11X41", "x" * 300, "\x1b[2J", "é.toml"]
    )
    output = rng.choice([*["out.nc"] * 12, *option_values.PATHS])
    words: dict[str, list[str]] = {
        "run": ["run", pair, "-o", output, "--torque", "50"],
        "sweep": ["sweep", pair, "-o", output, "--over", rng.choice(["E=0:0.05:2", rng.choice(option_values.OVER)]),
        "--torque", "50", "--workers", "1"],
        "vh": ["vh", pair, "-o", output],
        "problems": ["problems", pair, "-o", output, "--torque", "50"],
        "wear": ["wear", pair, "-o", output, "--torque", "50", "--revolutions", "1e3"],
        "modify": ["modify", pair, "-o", output, "--torque", "50", "--order", "2"],
        "optimize": ["optimize", pair, "-o", output, "--torque", "50", "--steps", "1", "--free",
        "pinion.*.machine.radial_distance"],
        "verify": ["verify", pair, "--torque", "50"],
        "export": ["export", pair, "-o", rng.choice([output, "o.csv", "o.stl", "o.nc", "o.vtk", "o.x"]), "--nodes",
        "9x7"],
        "correct": ["correct", pair, "--deviation", "gear=fm-11x41-worn-gear"],
        "oil": ["oil", "--viscosity-40", "100", "--viscosity-100", "14", "--density", "880", "--base-oil", "mineral",
                "-o", rng.choice(["my.toml", "my.toml", output, "case.toml"])],
        "design": ["design", rng.choice(["fm-11x41", pair, "nothing"]), "-o", rng.choice(["new.toml", "case.toml",
        output])],
        "sheet": ["sheet", pair, "-o", rng.choice(["sheet.txt", "sheet.html", "case.toml", output])],
        "convert": ["convert", rng.choice(["fm-11x41", pair]), "-o", rng.choice(["o.toml", "o.rexs", "case.toml",
        output])],
        "cases": ["cases"],
        "completion": ["completion", rng.choice(["bash", "zsh", "fish", "sh", ""])],
        "new": ["new", rng.choice(["case", "design", "supports", "oil", "load-cases", "cases"]),
        *rng.choice([[], ["face-hobbed"], ["fm-11x41"], ["nothing"], ["../x"], ["--ratio", "4", "--torque", "9"]]),
        "-o", rng.choice(["new.toml", "new.csv", "case.toml", output])],
        "library": ["library", "-o", "parts", "--parts", "x"],
    }  # fmt: skip
    if command in ("show", "plot", "cite"):
        name = box.copy(rng.choice(box.bases.of("result", "wear", "sweep", "duty", "vh")), "r.nc")
        words[command] = [command, name, "pictures"][: 2 + (command == "plot")]
    elif command == "report":
        names = [box.copy(rng.choice(box.bases.of("result", "duty", "vh")), f"r{number}.nc") for number in range(2)]
        words[command] = ["report", *names[: rng.choice([1, 1, 2])], "-o", rng.choice(["report.html", output])]
    elif command == "compare":
        name = box.copy("problems.nc")
        words[command] = [
            "compare",
            name,
            "-o",
            "study",
            "--solvers",
            "native",
            "--repetitions",
            "1",
            "--time-limit",
            "5",
        ]
    elif command == "convert" and rng.random() < 0.4:
        target = rng.choice(["o.mat", "o.nc", "o.qps", "files", "problems.nc", output])
        words[command] = ["convert", box.copy("problems.nc"), "-o", target]
    made = option_values.spoilt(rng, command, words[command])
    if "--load-cases" in made:
        box.copy("duty.csv")
    if "supports.toml" in made:
        box.copy("supports-1.toml", "supports.toml")
    return Input("", made, ["case.toml"])


def mistaken(rng: random.Random, box: Box) -> Input:
    """A good file of one kind where another is wanted, under any name."""
    base = rng.choice(box.bases.of())
    suffix = rng.choice([Path(base).suffix, Path(base).suffix, ".nc", ".toml", ".csv", ".rexs", ".ses", ".dmi", ""])
    name = box.copy(base, f"file{suffix}")
    pair = box.copy("nasa.toml", "case.toml")
    words = rng.choice(
        [
            *case_commands(name)[5:],
            ["run", pair, "-o", "out.nc", "--torque", "50", "--deviation", f"gear={name}"],
            ["run", pair, "-o", "out.nc", "--torque", "50", "--deviation", f"pinion={name}", "--deviated", "surface"],
            ["correct", pair, "--deviation", f"pinion={name}"],
            ["run", pair, "-o", "out.nc", "--torque", "50", "--speed", "500", "--oil", name],
            ["run", pair, "-o", "out.nc", "--load-cases", name],
            ["sweep", pair, "-o", "out.nc", "--load-cases", name, "--workers", "1"],
            ["sweep", pair, "-o", "out.nc", "--over", f"deviation.gear={name}", "--torque", "50", "--workers", "1"],
            ["sweep", pair, "-o", "out.nc", "--over", "E=0,0.05", "--store", name, "--workers", "1"],
            ["vh", pair, "-o", "out.nc", "--deviation", f"gear={name}"],
            ["show", name],
            ["cite", name],
            ["plot", name, "pictures"],
            ["report", name, "-o", "report.html"],
            ["run", pair, "-o", "out.nc", "--torque", "50", "--supports", name],
            ["compare", name, "-o", "study", "--solvers", "native", "--repetitions", "1"],
            ["compare", name, "-o", name, "--solvers", "native"],
            ["convert", name, "-o", "o.toml"],
            ["convert", name, "-o", name],
            ["design", name, "-o", name],
            ["run", pair, "-o", name],
        ]
    )
    return Input("", words, [pair])
