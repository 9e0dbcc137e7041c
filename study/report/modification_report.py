"""Modification report: terms of the modification, loads before and after, and warnings, as text."""

from __future__ import annotations

import numpy as np
import xarray as xr
from tabulate import tabulate

from .summary.deflection_report import deflection_notes

ROWS = (
    ("greatest line load [N/mm]", "max_line_load", 0),
    ("greatest pressure [MPa]", "max_pressure", 0),
    ("line load at the edges [N/mm]", "max_end_load", 0),
    ("transmission error, peak to peak [urad]", "peak_to_peak", 1),
)


def modification_report(tree: xr.DataTree) -> str:
    """Report of an optimal modification.

    Parameters
    ----------
    tree
        A result of ``modify``.
    """
    record, surface = tree["optimization"].to_dataset(), tree["modification"].to_dataset()
    extent = np.abs(surface["modification"].values).max()
    parts = [
        f"Modification, up to {extent:.1f} um",
        tabulate(terms(surface), headers=("term", "um"), disable_numparse=True, colalign=("left", "right")),
    ]
    torques = [f"{torque:g}" for torque in record["torque"].values]
    for number in range(record.sizes["assembly"]):
        here = record.isel(assembly=number)
        rows = [(label, *changes) for _, label, changes in assembly_rows(here)]
        parts.append(f"Before -> after, {assembly_title(here, number)}")
        headers = ("torque [N m]", *torques)
        parts.append(
            tabulate(rows, headers=headers, disable_numparse=True, colalign=("left", *["right"] * len(torques)))
        )
    parts.append("Contact on lines alone, without tooth edges: 'easeoff run' shows what edges carry")
    return "\n\n".join([*parts, *notes(tree)])


def terms(surface: xr.Dataset) -> list[tuple[str, str]]:
    """Terms of a modification and their coefficients [um]."""
    pairs = zip(surface["term"].values, surface["coefficient"].values, strict=True)
    return [(str(name), f"{value:+.2f}") for name, value in pairs]


def assembly_title(here: xr.Dataset, number: int) -> str:
    """Name of an assembly of an optimization."""
    return "case's own assembly" if number == 0 else f"assembly {number}: {_errors(here)}"


def assembly_rows(here: xr.Dataset, arrow: str = " -> ") -> list[tuple[str, str, list[str]]]:
    """Variable, name and both values at each torque of what an optimization records of one assembly."""
    torques = range(here.sizes["torque"])
    return [
        (name, label, [_change(here[name].values[:, t], digits, arrow) for t in torques])
        for label, name, digits in ROWS
    ]


def notes(tree: xr.DataTree) -> list[str]:
    """Warnings and notes: exceeded limits, a search that did not converge, extrapolated deflections."""
    record = tree["optimization"].to_dataset()
    after = record.sel(stage="after").max("assembly")
    found = []
    ripple, limit = after["peak_to_peak"].values, record.attrs["transmission_error_limit_urad"]
    if np.any(ripple > limit):
        found.append(
            f"Warning: the transmission error is {ripple.max():.2f} urad peak to peak, above its limit of {limit:g} "
            "urad: raise the limit or the order of the terms"
        )
    ends, most = after["max_end_load"].values, np.atleast_1d(record.attrs["end_load_limit_N_per_mm"])
    if np.any(ends > most):
        worst = int(np.argmax(ends - most))
        found.append(
            f"Warning: the line load at the edges is {ends[worst]:.0f} N/mm at {after['torque'].values[worst]:g} N m, "
            f"above its limit of {most[worst]:.0f} N/mm"
        )
    if not record.attrs["converged"]:
        found.append("Note: the search has not converged; more programmes may improve the result")
    greatest = record.attrs["largest_modification_um"]
    if np.abs(tree["modification"].to_dataset()["modification"].values).max() > 0.999 * greatest:
        found.append(f"Note: the modification reaches its limit of {greatest:g} um")
    return [*found, *deflection_notes(tree)]


def _change(both: np.ndarray, digits: int, arrow: str) -> str:
    return f"{both[0]:.{digits}f}{arrow}{both[1]:.{digits}f}"


def _errors(here: xr.Dataset) -> str:
    names = {"E": "offset_error", "P": "pinion_axial_error", "G": "gear_axial_error"}
    errors = [f"{key} {here[name].item():+g} mm" for key, name in names.items() if here[name].item()]
    sigma = np.degrees(here["shaft_angle_error"].item())
    over_torque = "depends_on_torque" in here and bool(here["depends_on_torque"].item())  # older results lack it
    errors += [f"Sigma {sigma:+g} deg"] if sigma else []
    return ", ".join([*errors, *(["deflections over the torque"] if over_torque else [])]) or "none"
