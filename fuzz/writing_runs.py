"""Runs of every command that writes: the files they need, what they write, and whether it is whole."""

from __future__ import annotations

import contextlib
import os
import re
import shutil
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from mutations import netcdf_mutations
import numpy as np
from bases import Bases
from processes import Outcome, command_line, forked

OLDER = b"older\n"
#: What two runs on the same input do not have in common.
CHANGING_ATTRIBUTES = ("history", "case_name")  # with the time, and with the name of the file of the case
CHANGING_TEXT = re.compile(rb'(?<= date=)"[^"]*"')


@dataclass(frozen=True)
class WritingRun:
    """A command that writes.

    Attributes
    ----------
    words
        Its command line.
    sources
        Base files that it reads.
    outputs
        Files, or folders, that it writes.
    """

    words: str
    sources: tuple[str, ...]
    outputs: tuple[str, ...]

    def __str__(self) -> str:
        return f"easeoff {self.words}"


OIL = "oil --viscosity-40 100 --viscosity-100 14 --density 880 --base-oil pao"
#: The cheap ones first.
RUNS = (
    WritingRun("run nasa.toml -o out.nc --torque 50,150 --speed 500,1500", ("nasa.toml",), ("out.nc",)),
    WritingRun("run nasa.toml -o out.nc --torque 50 --plots pictures", ("nasa.toml",), ("out.nc", "pictures")),
    WritingRun("plot nasa.nc pictures", ("nasa.nc",), ("pictures",)),
    WritingRun("report nasa.nc held.nc -o report.html", ("nasa.nc", "held.nc"), ("report.html",)),
    WritingRun(
        "run nasa.toml -o out.nc --load-cases duty.csv --temperature 60", ("nasa.toml", "duty.csv"), ("out.nc",)
    ),
    WritingRun(
        "sweep nasa.toml -o out.nc --over E=-0.05:0.05:4 --torque 50,150 --workers 1", ("nasa.toml",), ("out.nc",)
    ),
    WritingRun(
        "sweep nasa.toml -o out.nc --over E~normal(0,0.03) --over P~uniform(-0.02,0.02) --samples 5 --torque 50 "
        "--workers 1 --keep worst=max_pressure:2 --plots pictures",
        ("nasa.toml",),
        ("out.nc", "out-points", "pictures"),
    ),
    WritingRun("vh nasa.toml -o out.nc --grid 2x2 --plots pictures", ("nasa.toml",), ("out.nc", "pictures")),
    WritingRun("problems nasa.toml -o out.nc --torque 50", ("nasa.toml",), ("out.nc",)),
    WritingRun("wear fm.toml -o out.nc --torque 100 --revolutions 1e5", ("fm.toml",), ("out.nc",)),
    WritingRun(
        "modify nasa.toml -o out.nc --torque 100 --order 2 --fitted-case fit.toml --force",
        ("nasa.toml",),
        ("out.nc", "fit.toml"),
    ),
    WritingRun("design design-fm-11x41.toml -o out.toml --force", ("design-fm-11x41.toml",), ("out.toml",)),
    WritingRun("convert fm.rexs -o out.toml --force", ("fm.rexs",), ("out.toml",)),
    WritingRun("convert nasa.toml -o out.rexs --force", ("nasa.toml",), ("out.rexs",)),
    *(
        WritingRun(f"export fm.toml -o out{suffix} --nodes 31x21", ("fm.toml",), (f"out{suffix}",))
        for suffix in (".stl", ".vtk", ".vtu")
    ),
    *(WritingRun(f"export fm.toml -o out{suffix}", ("fm.toml",), (f"out{suffix}",)) for suffix in (".csv", ".nc")),
    WritingRun(f"{OIL} -o out.toml", (), ("out.toml",)),
    WritingRun(
        "compare problems.nc -o study --solvers native --repetitions 1 --test-set", ("problems.nc",), ("study",)
    ),
    WritingRun("run fe.toml -o out.nc --torque 50", ("fe.toml",), ("out.nc",)),
    WritingRun("verify nasa.toml --torque 50 -o out.nc", ("nasa.toml",), ("out.nc",)),
    WritingRun("library -o parts --parts small", (), ("parts",)),
)


class Stage:
    """A folder with the sources of a run and a cache of its own, in which it can be run again and again."""

    def __init__(self, folder: Path, run: WritingRun, bases: Bases, *, older: bool = True) -> None:
        self.folder, self.run, self.bases = folder, run, bases
        self.cache = folder.with_name(folder.name + "-cache")
        self.temporary = folder.with_name(folder.name + "-temporary")
        for place in (folder, self.temporary):
            place.mkdir(parents=True)
        for name in run.sources:
            shutil.copyfile(bases[name], folder / name)
        for name in run.outputs:
            if older and Path(name).suffix:
                (folder / name).write_bytes(OLDER)
                (folder / name).chmod(0o640)

    @property
    def environment(self) -> dict[str, str]:
        """Variables of the environment of its runs."""
        return {"EASEOFF_CACHE": str(self.cache), "TMPDIR": str(self.temporary)}

    def again(self) -> Outcome:
        """Run the command to its end."""
        return forked(command_line(self.run.words.split()), self.folder, environment=self.environment)

    def contents(self) -> dict[str, Any]:
        """What stands in the outputs, by path."""
        found: dict[str, Any] = {}
        for output in self.run.outputs:
            path = self.folder / output
            files = [path] if path.is_file() else sorted(p for p in path.rglob("*") if p.is_file())
            found |= {str(file.relative_to(self.folder)): content(file) for file in files}
        return found

    def remains(self) -> list[str]:
        """Files that are neither sources nor outputs."""
        found = []
        for path in [*self.folder.rglob("*"), *self.cache.rglob("*")]:
            if path.is_file() and (path.name.startswith(".") or path.suffix == ".tmp"):
                found.append(path.name)
        known = {*self.run.sources, *self.run.outputs}
        found += os.listdir(self.temporary)
        return found + [name for name in os.listdir(self.folder) if name not in known and name not in found]

    def clear(self) -> None:
        """Remove everything."""
        for folder in (self.folder, self.cache, self.temporary):
            shutil.rmtree(folder, ignore_errors=True)


@dataclass(frozen=True)
class Reference:
    """What an undisturbed run gives.

    Attributes
    ----------
    code
        Exit code.
    time
        From start to end [s].
    contents
        What stands in the outputs; ``None`` for a file that two runs do not write alike.
    size
        Of the largest output [bytes].
    """

    code: int
    time: float
    contents: Mapping[str, Any]
    size: int

    def same(self, contents: Mapping[str, Any]) -> bool:
        """Whether outputs are as they must be."""
        return contents.keys() == self.contents.keys() and all(
            value is None or equal(value, contents[name]) for name, value in self.contents.items()
        )


def reference(run: WritingRun, bases: Bases, work: Path) -> Reference:
    """Result of two undisturbed runs."""
    found = []
    for number in (1, 2):
        stage = Stage(work / f"reference-{number}", run, bases)
        outcome = stage.again()
        if outcome.code not in (0, 1):
            raise RuntimeError(f"{run}: exit code {outcome.code}\n{outcome.stderr}")
        sizes = [file.stat().st_size for file in stage.folder.rglob("*") if file.is_file()]
        found.append((outcome, stage.contents(), max(sizes)))
        stage.clear()
    (outcome, first, size), (_, second, _) = found
    contents = {name: value if equal(value, second.get(name)) else None for name, value in first.items()}
    return Reference(outcome.code, outcome.wall_time, contents, size)


def content(path: Path) -> Any:
    """Content of a file to compare: groups of a netCDF file, or a text that it is damaged; bytes of any other file."""
    if path.suffix != ".nc" or path.read_bytes() == OLDER:
        return CHANGING_TEXT.sub(b"", path.read_bytes())
    try:
        return netcdf_mutations.load(path)
    except (OSError, RuntimeError, ValueError) as error:
        return f"damaged: {error}"


def equal(a: Any, b: Any) -> bool:
    """Whether two contents are equal, except for what changes from run to run."""
    if isinstance(a, netcdf_mutations.Group) and isinstance(b, netcdf_mutations.Group):
        return (
            _equal_attributes(a.attrs, b.attrs)
            and a.dims == b.dims
            and a.variables.keys() == b.variables.keys()
            and all(_equal_values(v.data, b.variables[k].data) for k, v in a.variables.items())
            and a.groups.keys() == b.groups.keys()
            and all(equal(group, b.groups[name]) for name, group in a.groups.items())
        )
    return type(a) is type(b) and bool(a == b)


def _equal_attributes(a: Mapping[str, Any], b: Mapping[str, Any]) -> bool:
    return a.keys() == b.keys() and all(name in CHANGING_ATTRIBUTES or _equal_values(a[name], b[name]) for name in a)


def _equal_values(a: Any, b: Any) -> bool:
    first, second = np.asarray(a), np.asarray(b)
    if first.dtype.kind == "f" and second.dtype.kind == "f":
        return first.shape == second.shape and np.array_equal(first, second, equal_nan=True)
    with contextlib.suppress(ValueError, TypeError):
        return bool(np.array_equal(first, second))
    return False
