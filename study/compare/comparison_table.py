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
from ...core.checks import is_number
from ...core.errors import InputError
from ...core.reading.netcdf_file import read_dataset
from ...core.writing.output_file import whole_file
from .attempt import Attempt

FORMAT = "easeoff comparison of solvers"
RESIDUALS = CERTIFICATE_FIELDS


@dataclass(frozen=True)
class Row:
    """Row of the table: an attempt with its problem and method.

    Parameters
    ----------
    problem_file
        File of the problem.
    problem
        Number of the problem in its file, from 0.
    problem_name, kind
        Labels ``name`` and ``kind`` of the file; empty if it has none.
    size
        Number of segments.
    gear_torque
        Torque about the gear axis [N m].
    solver, settings, start
        The method.
    repetition
        Number of the attempt among those alike, from 1.
    attempt
        Outcome of the attempt.
    reference_rotation
        Certified rotation beyond first contact [rad]; NaN if there is none.
    """

    problem_file: str
    problem: int
    problem_name: str
    kind: str
    size: int
    gear_torque: float
    solver: str
    settings: str
    start: str
    repetition: int
    attempt: Attempt
    reference_rotation: float


def comparison_table(rows: Sequence[Row], tolerance: float, attributes: Mapping[str, Any]) -> xr.Dataset:
    """Table of a comparison as a labelled dataset.

    Parameters
    ----------
    rows
        The rows.
    tolerance
        Largest violation of a condition in a certified answer.
    attributes
        Further attributes of the dataset.

    Returns
    -------
    xr.Dataset
        Variables along the dimension ``attempt``. Residuals are NaN without an answer.
    """
    given = ("problem_file", "problem", "problem_name", "kind", "size", "gear_torque")
    columns: dict[str, list[Any]] = {
        name: [getattr(row, name) for row in rows] for name in (*given, "solver", "settings", "start", "repetition")
    }
    attempts = [row.attempt for row in rows]
    columns["run_time"] = [a.run_time for a in attempts]
    columns["claim"] = [a.claim for a in attempts]
    columns["certified"] = [int(a.certificate.passes(tolerance)) for a in attempts]
    for name in (*RESIDUALS, *CERTIFICATE_LIMITS):
        columns[name] = [_finite(getattr(a.certificate, name)) for a in attempts]
    columns["worst_residual"] = [_finite(a.certificate.worst) for a in attempts]
    columns["rotation_error"] = [rotation_error(row.attempt.elastic_rotation, row.reference_rotation) for row in rows]
    columns["iterations"] = [a.iterations for a in attempts]
    columns["polished"] = [int(a.polished) for a in attempts]
    columns["message"] = [a.message for a in attempts]
    whole = {"problem", "size", "repetition", "iterations"}
    dataset = xr.Dataset(
        {name: ("attempt", _column(values, name in whole)) for name, values in columns.items()},
        attrs={"format": FORMAT, "format_version": 1, "Conventions": "CF-1.11", "tolerance": tolerance, **attributes},
    )
    for name in ("certified", "polished"):
        dataset[name] = dataset[name].astype(np.int8)
        dataset[name].attrs = {"flag_values": np.array([0, 1], dtype=np.int8), "flag_meanings": "no yes"}
    return labelled(dataset)


def rotation_error(rotation: float, reference: float) -> float:
    """Relative error of a rotation beyond first contact; NaN without an answer, a reference, or a load.

    >>> rotation_error(1.5, 1.0), rotation_error(0.0, 0.0)
    (0.5, nan)
    """
    if not (math.isfinite(rotation) and math.isfinite(reference)) or reference == 0.0:
        return math.nan
    return abs(rotation - reference) / abs(reference)


def write_table(dataset: xr.Dataset, folder: Path) -> list[Path]:
    """Write a table as ``results.nc`` and ``results.csv``; returns their paths.

    Raises
    ------
    InputError
        If a file cannot be written.
    """
    paths = [folder / "results.nc", folder / "results.csv"]
    with whole_file(paths[0]) as temporary:
        dataset.to_netcdf(temporary, engine="netcdf4", format="NETCDF4")
    frame: Any = dataset.to_dataframe()
    with whole_file(paths[1]) as temporary:
        frame.to_csv(temporary, index=False)
    return paths


def read_table(path: Path) -> xr.Dataset:
    """Read the table of a comparison.

    Parameters
    ----------
    path
        The file ``results.nc`` of a comparison.

    Returns
    -------
    xr.Dataset
        The table, as ``compare`` returned it.

    Raises
    ------
    InputError
        If there is no such file, or it is not the table of a comparison.

    Examples
    --------
    >>> from tempfile import TemporaryDirectory
    >>> with TemporaryDirectory() as folder:
    ...     written = write_table(comparison_table([], 1e-5, {"repetitions": 1}), Path(folder))
    ...     float(read_table(written[0]).attrs["tolerance"])
    1e-05
    """
    dataset = read_dataset(path)
    if dataset.attrs.get("format") != FORMAT:
        raise InputError(f"{path} holds no comparison of solvers: make one with 'easeoff compare'")
    wanted = comparison_table([], 0.0, {}).data_vars
    tolerance = dataset.attrs.get("tolerance")
    lacking = [name for name in wanted if name not in dataset or dataset[name].dims != ("attempt",)]
    lacking += [] if is_number(tolerance) and math.isfinite(tolerance) else ["tolerance"]
    if lacking:
        raise InputError(f"{path} is incomplete, without {', '.join(map(str, lacking))}: make it anew")
    return dataset


def _finite(value: float) -> float:
    return value if math.isfinite(value) else math.nan


def _column(values: list[Any], whole: bool) -> Any:
    if whole:
        return np.array(values, dtype=np.int32)
    return np.array(values, dtype=np.float64 if values and isinstance(values[0], float) else None)
