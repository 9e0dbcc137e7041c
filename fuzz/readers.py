"""Readers of files by kind: those that no command has, and those that read back what a command wrote."""

from __future__ import annotations

import sys
from collections.abc import Callable, Sequence
from itertools import pairwise
from pathlib import Path
from typing import Any

#: What a command writes, by suffix.
WRITTEN: dict[str, dict[str, str]] = {
    "run": {".nc": "result"},
    "sweep": {".nc": "sweep"},
    "vh": {".nc": "netcdf"},
    "modify": {".nc": "result", ".toml": "case"},
    "optimize": {".nc": "result", ".toml": "case"},
    "problems": {".nc": "problems"},
    "wear": {".nc": "wear"},
    "design": {".toml": "case"},
    "convert": {".toml": "case", ".rexs": "rexs", ".xml": "rexs"},
    "export": {".csv": "points", ".nc": "points"},
    "oil": {".toml": "oil"},
    "verify": {".nc": "netcdf"},
}


def reader(kind: str) -> Callable[[Path], Any]:
    """Function that reads a file of some kind."""
    import easeoff
    import xarray as xr
    from easeoff.cases import read_rexs
    from easeoff.contact import read_problems
    from easeoff.friction import lubricant
    from easeoff.friction.ehl.study.friction_formula import read_formula
    from easeoff.geometry.formats import read_cmm_points
    from easeoff.study.sweep import read_sweep

    def netcdf(path: Path) -> None:
        with xr.open_dataset(path, engine="netcdf4") as opened:
            opened.load()

    readers: dict[str, Callable[[Path], Any]] = {
        "result": easeoff.read_result,
        "sweep": read_sweep,
        "case": easeoff.read_case,
        "problems": read_problems,
        "wear": netcdf,
        "rexs": read_rexs,
        "points": read_cmm_points,
        "formula": read_formula,
        "oil": lambda path: lubricant(str(path)),
        "netcdf": netcdf,
    }
    return readers[kind]


def reading(kind: str, path: str) -> Callable[[], None]:
    """A reader as a call that ends as a command does: with 2 for a mistake."""

    def call() -> None:
        from easeoff.core.errors import EaseoffError

        try:
            reader(kind)(Path(path))
        except EaseoffError as error:
            sys.stderr.write(f"Error: {error}\n")
            sys.exit(2)

    return call


def written_files(command: str, args: Sequence[str], touched: Sequence[str]) -> list[tuple[str, str]]:
    """Files that a command was told to write and has written, with what reads them."""
    kinds = WRITTEN.get(command, {})
    wanted = [b for a, b in pairwise(args) if a in ("-o", "--output", "--fitted-case")]
    return [(kinds[Path(path).suffix], path) for path in wanted if Path(path).suffix in kinds and path in touched]
