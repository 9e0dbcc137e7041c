"""Keep files of this version for all later ones: ``python tests/keep_files.py`` (re)makes ``tests/kept/VERSION``.

The folder holds an input file of each kind in ``inputs``, and in ``results.tar.xz`` a small result of each kind and
``kept.json``, the commands that made the results and what was read from every file. ``test_kept_files.py`` reads,
shows, plots and runs all of them with the code as it is. A folder is remade until its version is released, and never
after; making it takes a minute.

- Every version reads the input files of all versions kept, with the same meaning. A key may be added with a default
  that means what its absence meant. A key may get another name only if the old one is still read.
- Every version reads the results of all versions kept. Groups, variables and attributes may be added: readers take them
  as optional (``study/result_layout.txt``). Name, unit, sign and
  dimensions of what is there stay.
- What has to change all the same raises ``RESULT_SCHEMA_VERSION`` or ``SWEEP_SCHEMA_VERSION``. Readers then convert
  older layouts, or refuse them with the version that reads them (``core/netcdf_file.py``), and the test of that version
  says so. A later layout than the reader knows is refused in the same way.
- Numbers may change when a model becomes more accurate, with a row in the changelog: what, from, to.
- Public names and options of commands are removed one minor version after a warning at the earliest.
"""

from __future__ import annotations

import hashlib
import json
import os
import shlex
import shutil
import sys
import tarfile
import tempfile
from collections.abc import Callable, Mapping
from importlib.metadata import version
from pathlib import Path
from typing import Any

import numpy as np
import xarray as xr
from click.testing import CliRunner

import easeoff
from easeoff.cases import (
    case_text,
    design_text,
    read_deflections,
    read_design,
    read_load_cases,
    read_rexs,
    read_session_script,
    read_supports,
)
from easeoff.contact import read_problems
from easeoff.core.netcdf_file import read_dataset
from easeoff.friction import lubricant
from easeoff.geometry.formats.measured_grid import read_measured_grid
from easeoff.study.cli import main
from easeoff.study.compare.comparison_table import read_table
from easeoff.study.sweep.sweep_file import read_sweep

KEPT = Path(__file__).with_name("kept")
ROOT = Path(__file__).parents[1]
COARSE = "mesh_positions = 3\nsegments_per_line = 5\nlengthwise_nodes = 9\nprofile_nodes = 7\n"
FRICTION = '\n[friction]\nspeed = 1500.0\noil = "oil.toml"\nroughness = [[0.8, 0.4]]\n'
LOAD_CASES = """
[[load_cases]]
name = "cruise"
torque = 100.0
speed = 2500.0
share = 0.9

[[load_cases]]
name = "climb"
torque = 300.0
E = 0.05
share = 0.1
flank = "drive"
"""
#: Commands that make the results, run in the folder of the inputs; what they write is in the folder of the results.
COMMANDS = {
    "run.nc": "run spiral_bevel.toml --speed 1500 --oil oil.toml --friction-feedback --torque 150",
    "deflected.nc": "run spiral_bevel.toml --misalignment deflections.csv",
    "supported.nc": "run spiral_bevel.toml --supports supports.toml --torque 150",
    "deviated.nc": "run hypoid.toml --deviation gear=deviation.csv --torque 100",
    "finite_elements.nc": "run finite_elements.toml --torque 100",
    "load_cases.nc": "run spiral_bevel.toml --load-cases load_cases.csv",
    "duty.nc": "run hypoid.toml --load-cases case",
    "sweep.nc": "sweep spiral_bevel.toml --over E=-0.05:0.05:3 --over speed=500,1500",
    "optimize.nc": "modify spiral_bevel.toml --order 2",
    "wear.nc": "wear spiral_bevel.toml --torque 150 --revolutions 1e6",
    "vh.nc": "vh spiral_bevel.toml",
    "problems.nc": "problems spiral_bevel.toml --torque 150",
    "problems.mat": "problems spiral_bevel.toml --torque 150",
    "comparison": "compare ../results/problems.nc --solvers native,clarabel --repetitions 1",
    "designed.toml": "design design.toml",
    "fitted.rexs": "convert hypoid.toml",
    "mixed.toml": "oil --viscosity-40 220 --viscosity-100 19 --density 895 --base-oil mineral",
}
#: Kind of every file that is not a result of an analysis.
KINDS = {
    **dict.fromkeys(("spiral_bevel.toml", "hypoid.toml", "finite_elements.toml", "designed.toml"), "case"),
    **{"design.toml": "design", "oil.toml": "oil", "mixed.toml": "oil", "supports.toml": "supports"},
    **{"load_cases.csv": "load cases", "deflections.csv": "deflections", "deviation.csv": "measured grid"},
    **{"pair.ses": "session script", "fitted.rexs": "REXS", "sweep.nc": "sweep", "wear.nc": "dataset"},
    **{"vh.nc": "dataset", "problems.nc": "problems", "problems.mat": "MATLAB", "comparison": "comparison"},
}


def write_inputs(folder: Path) -> None:
    """An input file of each kind."""
    shell, coarse = '\n[compliance]\nmodel = "shell"\n', f"[contact]\n{COARSE}"
    spiral, hypoid = (case_text(name).replace("[contact]\n", coarse) for name in ("nasa-12x36", "fh-12x41-45"))
    elastic = '\n[compliance]\nmodel = "fe"\nfineness = 0.25\nrim_depth = [10.0, 12.0]\n'
    deflections = "".join(f"    {{ torque = {t}, E = {t * 2e-4}, P = {-1e-4 * t} }},\n" for t in (0, 100, 300))
    texts = {
        "spiral_bevel.toml": spiral + shell,
        "finite_elements.toml": spiral + elastic,
        "hypoid.toml": f"{hypoid}\n[misalignment]\ndeflections = [\n{deflections}]\n{shell}{FRICTION}{LOAD_CASES}",
        "design.toml": design_text("fm-11x41"),
        "load_cases.csv": "name,torque,speed,E,P,share\ncruise,50,2500,,,0.9\nclimb,150,1500,0.05,-0.02,0.1\n",
        "deflections.csv": "torque, E, P, Sigma\n0, 0, 0, 0\n50, 0.012, -0.008, 0.002\n150, 0.02, -0.02, 0\n",
    }
    for name, text in texts.items():
        (folder / name).write_text(text, encoding="utf-8")
    package = Path(easeoff.__file__).parent
    shutil.copy(package / "friction/lubricants/mineral-vg100.toml", folder / "oil.toml")
    shutil.copy(package / "cases/supports/gearbox-nasa-12x36.toml", folder / "supports.toml")
    shutil.copy(package / "cases/deviations/fh-12x41-45-measured-gear.csv", folder / "deviation.csv")
    shutil.copy(ROOT / "fuzz/pair.ses", folder / "pair.ses")


def _dumped(models: Any) -> Any:
    return json.loads(json.dumps([model.model_dump(mode="json") for model in models]))


def _oil(path: Path) -> dict[str, float]:
    state = lubricant(path).at(70.0)
    return {"viscosity": float(state.viscosity), "pressure_viscosity": float(state.pressure_viscosity)}


def _deflections(path: Path) -> dict[str, float]:
    found = read_deflections(path).at(75.0)
    return {name: float(getattr(found, name)) for name in ("offset", "pinion_axial", "gear_axial", "shaft_angle")}


def _problems(path: Path) -> list[dict[str, float]]:
    return [
        {"size": p.size, "torque": p.torque, "separation": float(p.separation.sum()), "arm": float(p.lever_arm.sum())}
        for p in read_problems(path)
    ]


def _matlab(path: Path) -> list[dict[str, float]]:
    from easeoff.contact.problem.exchange.problem_formats import read_mat

    return [{"size": p.size, "torque": p.torque, "arm": float(p.lever_arm.sum())} for p in read_mat(path).problems]


def numbers(tree: xr.DataTree | xr.Dataset) -> dict[str, dict[str, Any]]:
    """Dimensions, unit and content of every variable, and every attribute of the outermost group, in few numbers."""
    nodes = tree.subtree if isinstance(tree, xr.DataTree) else [xr.DataTree(tree)]
    found: dict[str, dict[str, Any]] = {}
    for node in nodes:
        for name, variable in node.dataset.variables.items():
            values = variable.values
            row: dict[str, Any] = {
                "dimensions": list(map(str, variable.dims)),
                "units": variable.attrs.get("units", ""),
            }
            if values.dtype.kind in "fiub":
                finite = values[np.isfinite(values)].astype(float)
                row |= {
                    "count": finite.size,
                    "sum": float(finite.sum()),
                    "largest": float(np.abs(finite).max(initial=0)),
                }
            else:
                row["digest"] = hashlib.sha256("\n".join(map(str, values.ravel())).encode()).hexdigest()
            found[f"{node.path.rstrip('/')}/{name}"] = row
    return found


#: What is read from a file of each kind.
READERS: dict[str, Callable[[Path], Any]] = {
    "result": lambda path: numbers(easeoff.read_result(path)),
    "sweep": lambda path: numbers(read_sweep(path)),
    "dataset": lambda path: numbers(read_dataset(path)),
    "comparison": lambda path: numbers(read_table(path / "results.nc")),
    "problems": _problems,
    "MATLAB": _matlab,
    "case": lambda path: _dumped([easeoff.read_case(path)]),
    "REXS": lambda path: _dumped([read_rexs(path)[0]]),
    "session script": lambda path: _dumped([read_session_script(path)[0]]),
    "design": lambda path: _dumped([read_design(path)]),
    "supports": lambda path: _dumped([read_supports(path)]),
    "load cases": lambda path: _dumped(read_load_cases(path)),
    "deflections": _deflections,
    "oil": _oil,
    "measured grid": lambda path: numbers(read_measured_grid(path)),
}


def call(folder: Path, words: list[str]) -> str:
    """What a command prints that is run in a folder.

    Raises
    ------
    RuntimeError
        If it fails.
    """
    before = Path.cwd()
    os.chdir(folder)
    try:
        done = CliRunner().invoke(main, words)
    finally:
        os.chdir(before)
    if done.exit_code:
        raise RuntimeError(f"easeoff {shlex.join(words)}: {done.output}") from done.exception
    return done.output


def keep(folder: Path, commands: Mapping[str, str] = COMMANDS) -> None:
    """Make the files, and write what is read from them."""
    inputs, results = folder / "inputs", folder / "results"
    inputs.mkdir(parents=True)
    results.mkdir()
    write_inputs(inputs)
    kept: dict[str, Any] = {"version": version("easeoff"), "inputs": {}, "results": {}}
    for path in sorted(inputs.iterdir()):
        kept["inputs"][path.name] = {"kind": KINDS[path.name], "read": READERS[KINDS[path.name]](path)}
    for name, line in commands.items():
        words = [*shlex.split(line), "-o", f"../results/{name}"]
        call(inputs, words)
        if name == "comparison":
            for part in ("figures", "tables"):
                shutil.rmtree(results / name / part)
        kind = KINDS.get(name, "result")
        kept["results"][name] = {"kind": kind, "command": words, "read": READERS[kind](results / name)}
    (folder / "kept.json").write_text(json.dumps(kept, indent=1) + "\n", encoding="utf-8")
    with tarfile.open(folder / "results.tar.xz", "w:xz", preset=9) as archive:
        for name in ("kept.json", "results"):
            archive.add(folder / name, name)


if __name__ == "__main__":
    with tempfile.TemporaryDirectory() as place:
        made, target = Path(place) / "kept", KEPT / version("easeoff")
        keep(made)
        shutil.rmtree(target, ignore_errors=True)
        shutil.copytree(made / "inputs", target / "inputs")
        shutil.copy(made / "results.tar.xz", target)
    size = sum(path.stat().st_size for path in target.rglob("*") if path.is_file())
    sys.stdout.write(f"{target}: {size / 1e3:.0f} kB\n")
