"""Comparison table: a row an attempt, labelled, as netCDF and CSV."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
import xarray as xr

from ...contact.problem.certificate import CERTIFICATE_FIELDS, CERTIFICATE_LIMITS
from ...core.attributes import labelled
from ...core.checks import instance, is_number
from ...core.errors import InputError
from ...core.netcdf_file import read_dataset, write_netcdf
from ...core.output_file import whole_file
from .attempt import Attempt, Method, PosedProblem

#: File of the table in the folder of a comparison.
TABLE_FILE = "results.nc"
FORMAT = "easeoff comparison of solvers"
RESIDUALS = CERTIFICATE_FIELDS


@dataclass(frozen=True, eq=False)
class Row:
    """Row of the table: an attempt with its problem and method."""

    posed: PosedProblem
    method: Method
    repetition: int
    attempt: Attempt


def comparison_table(rows: Sequence[Row], tolerance: float, attributes: Mapping[str, Any]) -> xr.Dataset:
    """Table of a comparison along the dimension ``attempt``; residuals are NaN without an answer."""
    posed, methods, attempts = ([getattr(row, name) for row in rows] for name in ("posed", "method", "attempt"))
    columns: dict[str, list[Any]] = {
        "problem_file": [p.file for p in posed],
        "problem": [p.number for p in posed],
        "problem_name": [p.name for p in posed],
        "kind": [p.kind for p in posed],
        "size": [p.problem.size for p in posed],
        "gear_torque": [p.problem.torque * 1e-3 for p in posed],
        "solver": [m.solver for m in methods],
        "settings": [m.settings for m in methods],
        "solver_tolerance": [m.tolerance for m in methods],
        "start": [m.start for m in methods],
        "repetition": [row.repetition for row in rows],
        "load_factor": [a.load_factor for a in attempts],
        "claim": [a.claim for a in attempts],
        "certified": [int(a.certificate.passes(tolerance)) for a in attempts],
    }
    for name in (*RESIDUALS, *CERTIFICATE_LIMITS):
        columns[name] = [_finite(getattr(a.certificate, name)) for a in attempts]
    columns["worst_residual"] = [_finite(a.certificate.worst) for a in attempts]
    columns["posed_residual"] = [a.posed_residual for a in attempts]
    columns["rotation_error"] = [rotation_error(a.elastic_rotation, a.reference_rotation) for a in attempts]
    for name in ("run_time", "processor_time", "call_time", "setup_time", "solve_time", "time_source", "polish_time"):
        columns[name] = [getattr(a, name) for a in attempts]
    columns["iterations"] = [a.iterations for a in attempts]
    columns["polished"] = [int(a.polished) for a in attempts]
    columns["exchanges"] = [a.exchanges for a in attempts]
    columns["message"] = [a.message for a in attempts]
    whole = {"problem", "size", "repetition", "iterations", "exchanges"}
    dataset = xr.Dataset(
        {name: ("attempt", _column(values, name in whole)) for name, values in columns.items()},
        attrs={"format": FORMAT, "format_version": 3, "Conventions": "CF-1.11", "tolerance": tolerance, **attributes},
    )
    for name in ("certified", "polished"):
        dataset[name] = dataset[name].astype(np.int8)
        dataset[name].attrs = {"flag_values": np.array([0, 1], dtype=np.int8), "flag_meanings": "no yes"}
    return labelled(dataset)


def rotation_error(rotation: float, reference: float) -> float:
    """Relative error of a rotation beyond first contact; NaN without an answer, a reference, or a load."""
    if not (math.isfinite(rotation) and math.isfinite(reference)) or reference == 0.0:
        return math.nan
    return abs(rotation - reference) / abs(reference)


def write_table(dataset: xr.Dataset, folder: Path) -> list[Path]:
    """Write a table as ``results.nc`` and ``results.csv``; returns their paths."""
    require_comparison(dataset, "dataset")
    paths = [folder / TABLE_FILE, folder / "results.csv"]
    write_netcdf(dataset, paths[0])
    frame: Any = dataset.to_dataframe()
    with whole_file(paths[1]) as temporary:
        frame.to_csv(temporary, index=False)
    return paths


def read_table(path: Path) -> xr.Dataset:
    """Table from the file ``results.nc`` of a comparison, as ``compare`` returned it."""
    dataset = read_dataset(path)
    require_comparison(dataset, str(path))
    return dataset


def require_comparison(dataset: xr.Dataset, origin: str) -> None:
    """Refuse what is not the table of a comparison, or not all of it."""
    instance("dataset", dataset, xr.Dataset)
    if dataset.attrs.get("format") != FORMAT:
        raise InputError(f"{origin} holds no comparison of solvers: make one with 'easeoff compare'")
    wanted = comparison_table([], 0.0, {}).data_vars
    tolerance = dataset.attrs.get("tolerance")
    lacking = [name for name in wanted if name not in dataset or dataset[name].dims != ("attempt",)]
    lacking += [] if is_number(tolerance) and math.isfinite(tolerance) else ["tolerance"]
    if lacking:
        raise InputError(f"{origin} is incomplete, without {', '.join(map(str, lacking))}: make it anew")


def _finite(value: float) -> float:
    return value if math.isfinite(value) else math.nan


def _column(values: list[Any], whole: bool) -> Any:
    if whole:
        return np.array(values, dtype=np.int32)
    return np.array(values, dtype=np.float64 if values and isinstance(values[0], float) else None)
