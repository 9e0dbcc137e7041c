"""Rows of convergence: the key numbers of a result at the case's resolution against a finer one."""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any

import numpy as np
import xarray as xr
from numpy.typing import NDArray

from ...cases.schema.case_schema import Case
from ...study.report.key_numbers import key_numbers
from .verification_row import VerificationRow, not_applicable
from .verified_pair import VerifiedPair

Array = NDArray[Any]
GRID_FACTOR, SEGMENTS_FACTOR, POSITIONS_FACTOR, MODES_FACTOR, FINENESS_FACTOR = 1.5, 2.0, 2.0, 1.4, 1.4
#: Numbers that tell the state of the solution or count what a finer resolution has more of; and of the greatest
#: pressure all but its value: between two that are nearly as great its place jumps.
NOT_COMPARED = {
    "common_flank",
    "certified_positions",
    "worst_certificate",
    "max_pressure_lengthwise",
    "max_pressure_profile",
    "max_pressure_position",
    "max_pressure_pair",
    "max_pressure_line_end",
}
ERRORS, UNLOADED, SHARES, OTHERS = "transmission error", "unloaded error", "shares and places", "other numbers"
UNLOADED_ERROR_MINIMUM = 1.0  # [urad]; the errors of a pair without any are compared with this


@dataclass(frozen=True)
class Refinement:
    """One way of computing a case more finely.

    Parameters
    ----------
    name
        What is finer.
    table
        Table of the case file.
    values
        Finer values of its keys.
    limits
        Greatest change of the key numbers by group [%].
    """

    name: str
    table: str
    values: dict[str, int | float]
    limits: dict[str, float]

    def described(self, case: Case) -> str:
        """Coarse and fine values."""
        table = getattr(case, self.table)
        coarse = " x ".join(f"{getattr(table, key):g}" for key in self.values)
        return f"{coarse} against {' x '.join(f'{value:g}' for value in self.values.values())}"


def _limits(errors: float, unloaded: float, shares: float, others: float) -> dict[str, float]:
    return {ERRORS: errors, UNLOADED: unloaded, SHARES: shares, OTHERS: others}


def refinements(case: Case) -> list[Refinement]:
    """Refinements that make sense for a case; those of the elastic teeth depend on its model.

    Examples
    --------
    >>> from easeoff.cases import read_case
    >>> [one.name for one in refinements(read_case("nasa-12x36"))][:3]
    ['grid of the flank', 'segments of a line', 'mesh positions']
    """
    contact, elastic = case.contact, case.compliance
    nodes = {
        key: math.ceil((getattr(contact, key) - 1) * GRID_FACTOR) + 1 for key in ("lengthwise_nodes", "profile_nodes")
    }
    segments = {"segments_per_line": round(SEGMENTS_FACTOR * contact.segments_per_line)}
    positions = {"mesh_positions": round(POSITIONS_FACTOR * contact.mesh_positions)}
    found = [
        Refinement("grid of the flank", "contact", nodes, _limits(0.5, 0.5, 0.5, 0.5)),
        Refinement("segments of a line", "contact", segments, _limits(0.5, 0.5, 0.5, 1.0)),
        Refinement("mesh positions", "contact", positions, _limits(1.0, 1.0, 1.0, 1.0)),
    ]
    if elastic.model != "shell":
        fineness = {"fineness": round(FINENESS_FACTOR * elastic.fineness, 3)}
        return [*found, Refinement("fineness of the teeth", "compliance", fineness, _limits(2.0, 0.0, 1.0, 4.0))]
    face = {"lengthwise_modes": math.ceil(MODES_FACTOR * elastic.lengthwise_modes)}
    profile = {"profile_modes": math.ceil(MODES_FACTOR * elastic.profile_modes)}
    return [
        *found,
        Refinement("shell modes along the face", "compliance", face, _limits(0.5, 0.0, 0.5, 1.0)),
        Refinement("shell modes up the profile", "compliance", profile, _limits(1.0, 0.0, 0.5, 1.0)),
    ]


def convergence_rows(pair: VerifiedPair, refinement: Refinement) -> list[VerificationRow]:
    """Change of the key numbers by one refinement, a row a group of numbers.

    Examples
    --------
    >>> from easeoff.cases import read_case
    >>> pair = VerifiedPair.of(read_case("nasa-12x36"), torques=100.0)
    >>> rows = convergence_rows(pair, refinements(pair.case)[0])
    >>> {row.status.name for row in rows}
    {'WITHIN'}
    """
    finer = pair.changed(refinement.table, **refinement.values)
    compared = refinement.described(pair.case)
    return [
        VerificationRow(f"{refinement.name}, {group}", f"{compared}: {label}", value, limit, "%")
        for group, value, label in changes(key_numbers(pair.analysis.tree), key_numbers(finer.analysis.tree))
        if (limit := refinement.limits[group]) > 0.0
    ]


def changes(coarse: xr.Dataset, fine: xr.Dataset) -> Iterator[tuple[str, float, str]]:
    """Greatest change of every group of key numbers [%], and which number changes so much.

    Transmission errors count over the mean level at their torque, unloaded ones over the peak to peak; fractions in
    points; all other numbers over themselves.

    Parameters
    ----------
    coarse, fine
        From ``study.key_numbers``.

    Examples
    --------
    >>> coarse, fine = (
    ...     xr.Dataset({"mean_level": ("torque", [level], {"units": "urad"})}, {"torque": [50.0]})
    ...     for level in (200.0, 201.0)
    ... )
    >>> next(changes(coarse, fine))
    ('transmission error', 0.5, 'mean_level at 50 N m 200 and 201 urad')
    """
    worst: dict[str, tuple[float, str]] = {}
    for name, values in coarse.data_vars.items():
        if name in NOT_COMPARED or str(name).startswith(("pinion_", "unloaded_pinion_")):
            continue  # what refers to the pinion is in proportion to what refers to the gear
        group, scale = _group(coarse, str(name))
        other = fine[name].values if name in fine else np.full(values.shape, np.nan)
        if other.shape != values.shape:
            other = np.full(values.shape, np.nan)
        change = 100.0 * np.abs(other - values.values) / scale
        change = np.where(np.isnan(values.values) & np.isnan(other), 0.0, change)
        place = np.unravel_index(int(np.argmax(np.where(np.isnan(change), np.inf, change))), change.shape)
        value = float(change[place])
        if group not in worst or not value <= worst[group][0]:
            at = f" at {coarse['torque'].values[place[0]]:g} N m" if values.dims[:1] == ("torque",) else ""
            both = f"{values.values[place]:.5g} and {other[place]:.5g}"
            worst[group] = value, f"{name}{at} {both} {values.attrs.get('units', '1')}".removesuffix(" 1")
    for group, (value, label) in worst.items():
        yield group, value, label


def _group(numbers: xr.Dataset, name: str) -> tuple[str, Array]:
    """Group of a key number, and what its change is divided by."""
    values = numbers[name]
    unit = values.attrs.get("units", "1")
    if unit == "urad" and "torque" in values.dims:
        level = np.abs(numbers["mean_level"].values)
        return ERRORS, level.reshape(-1, *(1,) * (values.ndim - 1))
    if unit == "urad":
        return UNLOADED, np.maximum(numbers["unloaded_peak_to_peak"].values, UNLOADED_ERROR_MINIMUM)
    if unit == "1":
        return SHARES, np.asarray(1.0)
    return OTHERS, np.abs(values.values)
