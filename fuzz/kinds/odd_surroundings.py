"""Odd surroundings: what stands where a file is wanted, environments, modules in the folder, files of strangers."""

from __future__ import annotations

import os
import random

from mutations import path_mutations
from oracle import EXECUTED

from .box import Box, Input
from .damaged_files import case_commands

OIL = ("oil", "--viscosity-40", "100", "--viscosity-100", "14", "--density", "880", "--base-oil", "pao")


def paths(rng: random.Random, box: Box) -> Input:
    """Something else than a file where one is read or written."""
    pair = box.copy("nasa.toml", "case.toml")
    files = {name: box.copy(base, name) for name, base in (("r.nc", "nasa.nc"), ("s.nc", "sweep.nc"),
        ("duty.csv", "duty.csv"), ("grid.csv", "grid.csv"), ("oil.toml",
        "oil-75w90.toml"),
             ("problems.nc", "problems.nc"), ("file.rexs", "fm.rexs"), ("file.ses", "pair.ses"), ("design.toml",
             "design-fm-11x41.toml"))}  # fmt: skip
    words = rng.choice(
        [
            ["run", pair, "-o", "out.nc", "--torque", "50"],
            ["run", pair, "-o", "out.nc", "--torque", "50", "--plots", "pictures"],
            ["run", pair, "-o", "out.nc", "--torque", "50", "--speed", "500", "--oil", "oil.toml"],
            ["run", pair, "-o", "out.nc", "--torque", "50", "--deviation", "gear=grid.csv"],
            ["run", pair, "-o", "out.nc", "--load-cases", "duty.csv", "--temperature", "60"],
            *[
                ["sweep", pair, "-o", "out.nc", "--over", "E=0,0.05", "--torque", "50", "--workers", "1", *more]
                for more in ([], ["--store", "store"], ["--plots", "pictures"])
            ],
            ["sweep", pair, "-o", "out.nc", "--load-cases", "duty.csv", "--temperature", "60", "--workers", "1"],
            ["vh", pair, "-o", "out.nc", "--plots", "pictures", "--grid", "2x2"],
            ["show", "r.nc"],
            ["show", "s.nc"],
            ["plot", "r.nc", "pictures"],
            ["plot", "s.nc", "pictures"],
            ["compare", "problems.nc", "-o", "study", "--solvers", "native", "--repetitions", "1"],
            ["problems", pair, "-o", "out.nc", "--torque", "50"],
            ["wear", pair, "-o", "out.nc", "--torque", "50", "--revolutions", "1e3"],
            ["modify", pair, "-o", "out.nc", "--order", "2", "--torque", "50", "--fitted-case", "fit.toml"],
            ["convert", "file.rexs", "-o", "o.toml"],
            ["convert", "file.ses", "-o", "o.toml"],
            ["convert", pair, "-o", "o.rexs"],
            ["design", "design.toml", "-o", "o.toml", *rng.choice([[], ["--force"]])],
            ["export", pair, "-o", rng.choice(["o.csv", "o.stl", "o.nc"]), "--nodes", "9x7"],
            ["verify", pair, "--torque", "50", "-o", "table.nc"],
            ["correct", pair, "--deviation", "gear=grid.csv"],
            [
                *OIL,
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
            "store",
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
    if words[0] == "sweep" and rng.random() < 0.3:
        place = rng.choice(["out.nc.batches", "out.nc.batches/sweep.json", "out.nc.batches/batches.jsonl"])
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
                *OIL,
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
             "tomllib", "easeoff", "sip_qp_python", "pyqpmad", "tqdm", "encodings")  # fmt: skip
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
    way = rng.choice(["case", "case", "case", "design", "rexs", "session", "load_cases"])
    if way == "rexs":
        text = f'<?xml version="1.0"?><!DOCTYPE model [<!ENTITY e SYSTEM "{path}">]><model>&e;</model>'
        return Input("", ["convert", box.put("x.rexs", text.encode()), "-o", "o.toml"])
    if way == "session":
        text = box.bases["pair.ses"].read_text(encoding="utf-8")
        text = text.replace("SESFILENAME", f"SESFILENAME {path}\nREAD {path}\nINCLUDE {path}\nSESFILENAME")
        return Input("", ["convert", box.put("x.ses", text.encode()), "-o", "o.toml"])
    if way == "load_cases":
        head = rng.choice(["torque,oil,speed", "torque,deviation.gear,speed", "torque,name,speed", path])
        table = box.put("duty.csv", f"{head}\n50,{path},500\n".encode())
        given = ["-o", "out.nc", "--load-cases", table]
        pair = box.copy("nasa.toml", "case.toml")
        return Input("", rng.choice([["run", pair, *given], *[["sweep", pair, *given, "--workers", "1"]] * 3]))
    base = "design-fm-11x41.toml" if way == "design" else "nasa.toml"
    text = box.bases[base].read_text(encoding="utf-8")
    name = box.put("case.toml", f"{text}\n[friction]\nspeed = 500.0\ntemperature = 60.0\noil = '{path}'\n".encode())
    words = ["design", name, "-o", "o.toml"] if way == "design" else rng.choice(case_commands(name))
    return Input("", words, [name])
