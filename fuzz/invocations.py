"""Inputs by kind: the files of one run, mutated, and the words of its command line, all drawn from a seed."""

from __future__ import annotations

import os
import random
import shutil
from collections.abc import Callable
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import byte_mutations
import markup_mutations
import netcdf_mutations
import option_values
import path_mutations
import table_mutations
import text_mutations
import toml_mutations
from bases import Bases
from case_keys import CASE_KEYS, COMPLIANCE, DESIGN_KEYS, FRICTION, MISALIGNMENT
from oracle import EXECUTED, SECRET

INNER = "outer/inner"
"""Folder of a run within its box, deep enough for paths that lead out of it."""


@dataclass
class Input:
    """One run.

    Attributes
    ----------
    kind
        Which of the kinds it is.
    args
        Words of the command line; for ``call``, the file to read.
    inputs
        Files that it reads and must leave alone.
    call
        A reader that no command has, instead of a command.
    environment
        Variables of the environment.
    fresh
        In a fresh interpreter instead of a forked one.
    """

    kind: str
    args: list[str]
    inputs: list[str] = field(default_factory=list)
    call: str = ""
    environment: dict[str, str] = field(default_factory=dict)
    fresh: bool = False

    @property
    def command(self) -> str:
        """Name of the command, or of the reader."""
        return self.call or next((word for word in self.args if word in option_values.OPTIONS), "none")


class Box:
    """Folder of a run, within folders that it must leave alone."""

    def __init__(self, root: Path, bases: Bases) -> None:
        self.root, self.bases = root, bases
        self.folder = root / INNER
        self.folder.mkdir(parents=True)
        (root / "secret.toml").write_text(f"{SECRET} = \"{SECRET}\"\ntitle = '{SECRET}'\n[{SECRET}\n")

    def copy(self, base: str, name: str = "") -> str:
        """Put a base file into the folder; return its name there."""
        name = name or Path(base).name
        target = self.folder / name
        target.parent.mkdir(parents=True, exist_ok=True)
        shutil.copyfile(self.bases[base], target)
        return name

    def put(self, name: str, data: bytes) -> str:
        """Put bytes into the folder; return their name."""
        path = self.folder / name
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_bytes(data)
        return name


def draw(seed: int, box: Box, kind: str | None = None) -> Input:
    """The input of a seed, with its files in the box."""
    rng = random.Random(seed)
    kind = kind or rng.choices(list(KINDS), [weight for weight, _ in KINDS.values()])[0]
    made = KINDS[kind][1](rng, box)
    made.kind = kind
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


# --- mutated files -------------------------------------------------------------------------------------------------


def any_mutation(rng: random.Random, box: Box, base: str, name: str = "") -> str:
    """Put a mutated copy of a base file into the folder, by the mutations of its format; return its name."""
    name = name or Path(base).name
    source = box.bases[base]
    suffix = source.suffix
    if suffix == ".nc":
        if rng.random() < 0.4:
            return box.put(name, byte_mutations.mutated(rng, source.read_bytes()))
        (box.folder / name).parent.mkdir(parents=True, exist_ok=True)
        netcdf_mutations.mutate(rng, source, box.folder / name)
        return name
    text = source.read_text(encoding="utf-8")
    if suffix == ".toml":
        keys = DESIGN_KEYS if base.startswith("design-") else None if base.startswith("oil-") else CASE_KEYS
        text = toml_mutations.mutated(rng, _with_tables(rng, text) if keys else text, keys)
    elif suffix in (".csv", ".dmi"):
        text = table_mutations.mutated(rng, text)
    elif suffix in (".rexs", ".xml"):
        text = markup_mutations.mutated_xml(rng, text)
    elif suffix in (".jsonl", ".json"):
        text = markup_mutations.mutated_json_lines(rng, text)
    else:
        text = text_mutations.mutated(rng, text)
    return box.put(name, text_mutations.encoded(rng, text))


def _with_tables(rng: random.Random, text: str) -> str:
    """Text of a case with optional tables, in which mutations find more to change."""
    import tomli_w

    for name, table, chance in (
        ("friction", FRICTION, 0.5),
        ("compliance", COMPLIANCE, 0.3),
        ("misalignment", MISALIGNMENT, 0.3),
    ):
        if f"[{name}]" not in text and rng.random() < chance:
            text += "\n" + tomli_w.dumps({name: table})
    return text


# --- kinds ---------------------------------------------------------------------------------------------------------


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
        ["problems", name, "-o", "out.nc"],
        ["wear", name, "-o", "out.nc", "--torque", "50", "--revolutions", "1e3"],
        ["optimize", name, "-o", "out.nc", "--order", "2", "--torque", "50", "--fitted-case", "fit.toml"],
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
    name = any_mutation(rng, box, rng.choice(box.bases.of("result", "result", "wear", "problems", "table")), "r.nc")
    return Input("", rng.choice([*[["show", name]] * 5, ["plot", name, "pictures"]]), [name])


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
    """Mutated, exchanged or foreign files of condensed teeth in the cache."""
    files = box.bases.teeth()
    way = rng.choice(["bytes", "bytes", "exchange", "text", "folder", "empty", "link"])
    for path in files:
        box.put(f"teeth/{path.name}", path.read_bytes())
    chosen = box.folder / "teeth" / rng.choice(files).name
    if way == "bytes":
        chosen.write_bytes(byte_mutations.mutated(rng, chosen.read_bytes()))
    elif way == "exchange" and len(files) > 1:
        shutil.copyfile(rng.choice(files), chosen)
    elif way == "text":
        chosen.write_text("text")
    else:
        path_mutations.occupy(rng, chosen, {"folder": "folder", "link": "circle of links"}.get(way, "empty"))
    name = box.copy("fe.toml", "case.toml")
    return Input("", ["run", name, "-o", "out.nc", "--torque", "50"], [name], environment={"EASEOFF_CACHE": "teeth"})


def options(rng: random.Random, box: Box) -> Input:
    """Good files, and options as nobody should write them."""
    pair = box.copy(rng.choice(["nasa.toml", "fm.toml"]), "case.toml")
    command = rng.choice([*["run"] * 6, *option_values.OPTIONS])
    pair = rng.choice(
        [*[pair] * 8, "nasa", "nasa-12x37", "", "case", ".", "no.toml", "FM-11X41", "x" * 300, "\x1b[2J", "é.toml"]
    )
    output = rng.choice([*["out.nc"] * 12, *option_values.PATHS])
    words: dict[str, list[str]] = {
        "run": ["run", pair, "-o", output, "--torque", "50"],
        "problems": ["problems", pair, "-o", output, "--torque", "50"],
        "wear": ["wear", pair, "-o", output, "--torque", "50", "--revolutions", "1e3"],
        "optimize": ["optimize", pair, "-o", output, "--torque", "50", "--order", "2"],
        "verify": ["verify", pair, "--torque", "50"],
        "export": ["export", pair, "-o", rng.choice([output, "o.csv", "o.stl", "o.nc", "o.vtk", "o.x"]), "--nodes",
        "9x7"],
        "correct": ["correct", pair, "--deviation", "gear=fm-11x41-worn-gear"],
        "oil": ["oil", "--viscosity-40", "100", "--viscosity-100", "14", "--density", "880", "--base-oil", "mineral",
                "-o", rng.choice(["my.toml", "my.toml", output, "case.toml"])],
        "design": ["design", rng.choice(["fm-11x41", pair, "nothing"]), "-o", rng.choice(["new.toml", "case.toml",
        output])],
        "convert": ["convert", rng.choice(["fm-11x41", pair]), "-o", rng.choice(["o.toml", "o.rexs", "case.toml",
        output])],
        "cases": ["cases"],
        "library": ["library", "-o", "parts", "--parts", "x"],
    }  # fmt: skip
    if command in ("show", "plot"):
        name = box.copy(rng.choice(box.bases.of("result", "wear")), "r.nc")
        words[command] = [command, name, "pictures"][: 2 + (command == "plot")]
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
    return Input("", option_values.spoilt(rng, command, words[command]), ["case.toml"])


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
            ["show", name],
            ["plot", name, "pictures"],
            ["compare", name, "-o", "study", "--solvers", "native", "--repetitions", "1"],
            ["compare", name, "-o", name, "--solvers", "native"],
            ["convert", name, "-o", "o.toml"],
            ["convert", name, "-o", name],
            ["design", name, "-o", name],
            ["run", pair, "-o", name],
        ]
    )
    return Input("", words, [pair])


def paths(rng: random.Random, box: Box) -> Input:
    """Something else than a file where one is read or written."""
    pair = box.copy("nasa.toml", "case.toml")
    files = {name: box.copy(base, name) for name, base in (("r.nc", "nasa.nc"), ("grid.csv", "grid.csv"), ("oil.toml",
        "oil-75w90.toml"),
             ("problems.nc", "problems.nc"), ("file.rexs", "fm.rexs"), ("file.ses", "pair.ses"), ("design.toml",
             "design-fm-11x41.toml"))}  # fmt: skip
    words = rng.choice(
        [
            ["run", pair, "-o", "out.nc", "--torque", "50"],
            ["run", pair, "-o", "out.nc", "--torque", "50", "--plots", "pictures"],
            ["run", pair, "-o", "out.nc", "--torque", "50", "--speed", "500", "--oil", "oil.toml"],
            ["run", pair, "-o", "out.nc", "--torque", "50", "--deviation", "gear=grid.csv"],
            ["show", "r.nc"],
            ["plot", "r.nc", "pictures"],
            ["compare", "problems.nc", "-o", "study", "--solvers", "native", "--repetitions", "1"],
            ["problems", pair, "-o", "out.nc", "--torque", "50"],
            ["wear", pair, "-o", "out.nc", "--torque", "50", "--revolutions", "1e3"],
            ["optimize", pair, "-o", "out.nc", "--order", "2", "--torque", "50", "--fitted-case", "fit.toml"],
            ["convert", "file.rexs", "-o", "o.toml"],
            ["convert", "file.ses", "-o", "o.toml"],
            ["convert", pair, "-o", "o.rexs"],
            ["design", "design.toml", "-o", "o.toml", *rng.choice([[], ["--force"]])],
            ["export", pair, "-o", rng.choice(["o.csv", "o.stl", "o.nc"]), "--nodes", "9x7"],
            ["verify", pair, "--torque", "50", "-o", "table.nc"],
            ["correct", pair, "--deviation", "gear=grid.csv"],
            [
                "oil",
                "--viscosity-40",
                "100",
                "--viscosity-100",
                "14",
                "--density",
                "880",
                "--base-oil",
                "pao",
                "-o",
                "o.toml",
            ],
        ]
    )
    named = [word.rpartition("=")[2] for word in words]
    places = [
        word
        for word in named
        if word
        in (
            *files,
            pair,
            "out.nc",
            "pictures",
            "study",
            "fit.toml",
            "o.toml",
            "o.rexs",
            "o.csv",
            "o.stl",
            "o.nc",
            "table.nc",
        )
    ]
    place = rng.choice([*places, "study/measurements.jsonl"] if "study" in places else places)
    if not (box.folder / place).exists():
        box.put(place, b"older\n")
    path_mutations.occupy(rng, box.folder / place)
    return Input("", words, [])


def surroundings(rng: random.Random, box: Box) -> Input:
    """Odd surroundings: language, terminal, cache and home, and names that are no UTF-8; in a fresh process."""
    pair = box.copy("nasa.toml", "case.toml")
    name = rng.choice(
        [
            "out.nc",
            os.fsdecode(b"\xff\xfe.nc"),
            "größe.nc",
            "\u202eout.nc",
            "a\nb.nc",
            "\x1b[31m.nc",
            "x" * 240 + ".nc",
            "-.nc",
        ]
    )
    folder = rng.choice(["", "", "größe/", os.fsdecode(b"\xff/")])
    source = rng.choice([pair, pair, os.fsdecode(b"\xe9.toml"), "größe.toml", "\x1b[31m.toml"])
    box.copy("nasa.toml", source)
    environment = rng.choice(
        [
            {"LC_ALL": "C"}, {"LC_ALL": "C", "PYTHONUTF8": "0", "PYTHONCOERCECLOCALE": "0"},
                {"PYTHONIOENCODING": "ascii"},
            {"PYTHONIOENCODING": "latin-1"}, {"COLUMNS": "1"}, {"COLUMNS": "-3"}, {"EASEOFF_CACHE": "case.toml"},
                {"EASEOFF_CACHE": "\x1b[2J"},
            {"EASEOFF_CACHE": "/proc/x"}, {"HOME": "/nonexistent", "XDG_CACHE_HOME": "/proc"},
                {"TMPDIR": "/nonexistent"}, {"TERM": ""},
            {"MPLBACKEND": "nothing"}, {"LANG": "de_DE.UTF-8"}, {"MPLCONFIGDIR": "/proc/x"}, {"EASEOFF_CACHE": ""},
        ]
    )  # fmt: skip
    words = rng.choice(
        [
            ["run", source, "-o", folder + name, "--torque", "50", *rng.choice([[], ["--plots", folder + "pictures"]])],
            ["run", box.copy("fe.toml"), "-o", folder + name, "--torque", "50"],
            ["convert", source, "-o", folder + name.replace(".nc", ".toml")],
            ["show", box.copy("nasa.nc", name)],
            ["problems", source, "-o", folder + name, "--torque", "50"],
            [
                "oil",
                "--viscosity-40",
                "100",
                "--viscosity-100",
                "14",
                "--density",
                "880",
                "--base-oil",
                "pao",
                "--title",
                name,
                "-o",
                "my.toml",
            ],
            ["cases"],
        ]
    )
    return Input("", words, [source], environment=environment, fresh=True)


def modules(rng: random.Random, box: Box) -> Input:
    """Python files in the current folder under the names of packages: none of them may run."""
    names = ("quadprog", "proxsuite", "numpy", "json", "osqp", "daqp", "sitecustomize", "OCP", "dask", "piqp",
        "qpalm", "ecos", "cvxopt", "scs", "highspy",
             "tomllib", "easeoff", "sip_qp_python", "pyqpmad", "sksparse", "tqdm", "encodings")  # fmt: skip
    for name in names:
        box.put(f"{name}.py", f"open({EXECUTED!r}, 'a').write('{name}\\n')\n".encode())
    pair = box.copy("nasa.toml", "case.toml")
    words = rng.choice(
        [
            *[["compare", box.copy("problems.nc"), "-o", "study", "--repetitions", "1", "--time-limit", "2"]] * 2,
            [
                "run",
                pair,
                "-o",
                "out.nc",
                "--torque",
                "50",
                "--solver",
                rng.choice(["auto", "quadprog", "proxsuite", "osqp"]),
            ],
            ["wear", pair, "-o", "out.nc", "--torque", "50", "--revolutions", "1e3"],
            ["plot", box.copy("nasa.nc"), "pictures"],
            ["export", pair, "-o", "o.step"],
            ["verify", pair, "--torque", "50"],
        ]
    )
    return Input("", words, [pair], fresh=True)


def stranger(rng: random.Random, box: Box) -> Input:
    """A stranger's file that names a file outside its folder: nothing of that may be shown."""
    (box.folder / "link.toml").symlink_to("../../secret.toml")
    path = rng.choice(
        ["../../secret.toml", str((box.root / "secret.toml").absolute()), "link.toml", "../inner/../../secret.toml"]
    )
    way = rng.choice(["case", "case", "case", "design", "rexs", "session"])
    if way == "rexs":
        text = f'<?xml version="1.0"?><!DOCTYPE model [<!ENTITY e SYSTEM "{path}">]><model>&e;</model>'
        return Input("", ["convert", box.put("x.rexs", text.encode()), "-o", "o.toml"])
    if way == "session":
        text = box.bases["pair.ses"].read_text(encoding="utf-8")
        text = text.replace("SESFILENAME", f"SESFILENAME {path}\nREAD {path}\nINCLUDE {path}\nSESFILENAME")
        return Input("", ["convert", box.put("x.ses", text.encode()), "-o", "o.toml"])
    base = "design-fm-11x41.toml" if way == "design" else "nasa.toml"
    text = box.bases[base].read_text(encoding="utf-8")
    name = box.put("case.toml", f"{text}\n[friction]\nspeed = 500.0\ntemperature = 60.0\noil = '{path}'\n".encode())
    words = ["design", name, "-o", "o.toml"] if way == "design" else rng.choice(case_commands(name))
    return Input("", words, [name])


KINDS: dict[str, tuple[float, Callable[[random.Random, Box], Any]]] = {
    "case": (6.0, case), "design": (1.5, design), "oil": (2.0, oil), "grid": (4.0, grid), "points": (1.0, points),
    "result": (4.0, result),
    "problems": (0.25, problems), "study": (0.25, study), "exchange_file": (2.0, exchange_file), "formula": (1.0,
    formula), "teeth": (0.5, teeth),
    "options": (6.0, options), "mistaken": (2.0, mistaken), "paths": (2.0, paths), "stranger": (0.5, stranger),
    "surroundings": (0.15, surroundings), "modules": (0.05, modules),
}  # fmt: skip
