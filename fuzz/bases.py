"""Files to be mutated, made by the commands themselves, each small."""

from __future__ import annotations

import re
from collections.abc import Sequence
from importlib import resources
from pathlib import Path

import tomli_w
from mutations.support_keys import SUPPORTS
from processes import command_line, forked

#: Small enough that an analysis takes a tenth of a second.
SMALL = "mesh_positions = 3\nsegments_per_line = 9\nlengthwise_nodes = 9\nprofile_nodes = 7\n"
CASES = {"nasa.toml": "nasa-12x36", "fm.toml": "fm-11x41", "fh.toml": "fh-12x41-45", "fha.toml": "fh-design-a"}
COMMANDS = {
    "nasa.nc": "run nasa.toml -o nasa.nc --torque 50,150 --speed 500,1500",
    "fm.nc": "run fm.toml -o fm.nc --torque 100 --deviation gear=fm-11x41-worn-gear",
    "fe.nc": "run fe.toml -o fe.nc --torque 50",
    "problems.nc": "problems nasa.toml -o problems.nc --torque 50",
    "wear.nc": "wear fm.toml -o wear.nc --torque 100 --revolutions 1e5",
    "best.nc": "modify nasa.toml -o best.nc --torque 100 --order 2",
    "table.nc": "verify nasa.toml -o table.nc --torque 50",
    "sweep.nc": "sweep nasa.toml -o sweep.nc --over E=-0.05:0.05:3 --over P=0,0.02 --torque 50,150 --workers 1 "
    "--store batches",
    "samples.nc": "sweep nasa.toml -o samples.nc --over E~normal(0,0.03) --over G~uniform(-0.02,0.02) --samples 6 "
    "--torque 50 --speed 500,1500 --workers 1",
    "rows.nc": "sweep nasa.toml -o rows.nc --load-cases duty.csv --temperature 60 --workers 1",
    "axle.nc": "run nasa.toml -o axle.nc --misalignment axle.csv --torque 50,100 --speed 500",
    "held.nc": "run nasa.toml -o held.nc --supports gearbox-nasa-12x36 --torque 50,100",
    "duty.nc": "run nasa.toml -o duty.nc --load-cases duty.csv --temperature 60",
    "vh.nc": "vh nasa.toml -o vh.nc --grid 2x2",
    "fm.rexs": "convert fm-11x41 -o fm.rexs",
    "points.csv": "export fm-11x41 -o points.csv --member gear",
    "points.nc": "export fm-11x41 -o points.nc --member gear",
    "study/measurements.jsonl": "compare problems.nc -o study --solvers native --repetitions 1",
}
DUTY = """# hours on the road
name,torque,E,P,Sigma,speed,share
cruise,100,0.01,0,0,1500,0.7
climb,300,0.05,-0.02,0.01,500,0.2
stand still,50,0,0,0,100,0.1
"""
AXLE = """# deflections of an axle
torque,E,P,G,Sigma,flank
0,0,0,0,0,drive
40,0.01,-0.005,0.004,0.002,drive
90,0.02,-0.015,0.009,0.004,drive
60,-0.01,0.02,0.004,-0.002,coast
"""
#: Files by what they are.
KINDS: dict[str, tuple[str, ...]] = {
    "case": tuple(CASES),
    "result": ("nasa.nc", "fm.nc", "best.nc", "axle.nc", "held.nc"),
    "problems": ("problems.nc",),
    "wear": ("wear.nc",),
    "grid": ("grid.csv", "grid.nc", "grid.dmi", "matrix.csv"),
    "points": ("points.csv", "points.nc"),
    "rexs": ("fm.rexs",),
    "session": ("pair.ses",),
    "table": ("table.nc",),
    "study": ("study/measurements.jsonl",),
    "formula": ("formula.json",),
    "sweep": ("sweep.nc", "samples.nc", "rows.nc"),
    "duty": ("duty.nc",),
    "vh": ("vh.nc",),
    "load_cases": ("duty.csv",),
    "deflections": ("axle.csv",),
}


class Bases:
    """The folder of the files to be mutated.

    Parameters
    ----------
    folder
        Where they are, or are made.
    cache
        Folder of condensed teeth for all inputs.
    """

    def __init__(self, folder: Path, cache: Path) -> None:
        self.folder, self.cache = folder, cache

    def __getitem__(self, name: str) -> Path:
        path = self.folder / name
        words = COMMANDS.get(name)
        if words and not path.exists():
            for word in words.split():
                if word in COMMANDS and word != name:
                    self[word]
            cache = self.folder / "teeth" if name == "fe.nc" else self.cache
            done = forked(command_line(words.split()), self.folder, environment={"EASEOFF_CACHE": str(cache)})
            if not path.exists():
                raise RuntimeError(f"easeoff {words}: exit code {done.code}\n{done.stderr}")
        return path

    def of(self, *kinds: str) -> list[str]:
        """Names of the files of some kinds; of all, if none is named."""
        return [name for kind in kinds or (*KINDS, "design", "oil", "supports") for name in self._of(kind)]

    def _of(self, kind: str) -> Sequence[str]:
        return KINDS.get(kind) or sorted(path.name for path in self.folder.glob(f"{kind}-*.toml"))

    def teeth(self) -> list[Path]:
        """Files of condensed teeth."""
        return sorted(self["fe.nc"].with_name("teeth").iterdir())

    def batches(self) -> list[Path]:
        """Files in the folder of batches of the finished sweep ``sweep.nc``."""
        return sorted(self["sweep.nc"].with_name("batches").iterdir())

    def write_texts(self) -> None:
        """Write what no command makes; the rest is made when it is asked for."""
        self.folder.mkdir(parents=True, exist_ok=True)
        from easeoff.cases import case_text, design_text, shipped_designs
        from easeoff.geometry.formats import read_measured_grid, write_measured_grid

        for name, case in CASES.items():
            self._put(name, small(case_text(case)))
        self._put("fe.toml", small(case_text("nasa-12x36")) + '\n[compliance]\nmodel = "fe"\nfineness = 0.5\n')
        for design in shipped_designs():
            self._put(f"design-{design}.toml", design_text(design))
        head = 'easeoff_support = 1\ntitle = "Supports"\n\n'
        for number, supports in enumerate(SUPPORTS):
            self._put(f"supports-{number}.toml", head + tomli_w.dumps({"supports": supports}))
        for oil in resources.files("easeoff.friction").joinpath("lubricants").iterdir():
            if oil.name.endswith(".toml"):
                self._put(f"oil-{oil.name}", oil.read_text(encoding="utf-8"))
        self._put("formula.json", resources.files("easeoff.friction.ehl.study").joinpath("formula.json").read_text())
        self._put("pair.ses", (Path(__file__).parent / "pair.ses").read_text(encoding="utf-8"))
        rows = "\n".join(",".join(f"{(i - 2) ** 2 + (j - 4) ** 2 / 2:.1f}" for j in range(9)) for i in range(5))
        head = "# rows: root to tip\n# columns: toe to heel\n# flank: concave\n# deviation_unit: um\n"
        self._put("matrix.csv", head + rows + "\n")
        self._put("duty.csv", DUTY)
        self._put("axle.csv", AXLE)
        with resources.as_file(resources.files("easeoff.cases").joinpath("deviations/fm-11x41-worn-gear.csv")) as file:
            grid = read_measured_grid(file)
        for suffix in (".csv", ".nc", ".dmi"):
            write_measured_grid(grid, self[f"grid{suffix}"])

    def _put(self, name: str, text: str) -> None:
        self[name].write_text(text, encoding="utf-8")


def small(text: str) -> str:
    """Text of a case with small grids."""
    text = re.sub(
        r"^(mesh_positions|segments_per_line|lengthwise_nodes|profile_nodes)\s*=.*\n", "", text, flags=re.MULTILINE
    )
    return text.replace("[contact]", f"[contact]\n{SMALL}", 1) if "[contact]" in text else f"{text}\n[contact]\n{SMALL}"
