"""Result summary: pair, unloaded and loaded contact, friction and certificates, as text."""

from __future__ import annotations

from typing import Any

import numpy as np
import xarray as xr
from tabulate import tabulate

from ...contact.loaded_cases import CERTIFICATE
from ...contact.solvers import Status
from ...friction.operation import named_models
from .departures import deviations, modification
from .plausibility import plausibility

#: Rows of the table of efficiencies; more are counted.
ROW_COUNT_LIMIT = 40
#: Words for the model of the teeth.
TEETH = {"shell": "shells, ", "solid_shell": "solid shells, ", "fe": "finite elements, "}


def efficiencies(friction: xr.Dataset) -> str:
    """Table of power loss and efficiency, a row an operating condition, with the extremes if there are many."""
    names = ("torque", "speed", "temperature", "roughness")
    values = [friction[n].transpose(*names).values for n in ("efficiency", "mean_power_loss", "mean_rolling_loss")]
    coefficient = friction["mean_friction_coefficient"].transpose(*names).values
    rows = []
    for at in np.ndindex(coefficient.shape):
        efficiency, loss, rolling = (v[at] for v in values)
        conditions = [f"{friction[name].values[i]:g}" for name, i in zip(names, at, strict=True)]
        rough = [friction[f"roughness_{member}"].values[at[3]] for member in ("pinion", "gear")]
        conditions[2] += "*" if friction["temperature_clamped"].values[at[2]] else ""
        conditions[3] = f"{rough[0]:g}" if rough[0] == rough[1] else f"{rough[0]:g}/{rough[1]:g}"
        share = 100.0 * rolling / loss
        rows.append((*conditions, f"{coefficient[at]:.4f}", f"{loss:.1f}", f"{share:.1f}", f"{100 * efficiency:.2f}"))
    headers = [
        "torque\nN m",
        "speed\n1/min",
        "oil\ndegC",
        "roughness\num",
        "mean friction\ncoefficient",
        "power loss\nW",
        "rolling part\n%",
        "efficiency\n%",
    ]
    shown = rows[:ROW_COUNT_LIMIT]
    table = tabulate(shown, headers=headers, disable_numparse=True, colalign=("right",) * len(headers))
    left = len(rows) - len(shown)
    if np.any(friction["temperature_clamped"].values):
        table += "\n* beyond the oil's data: the last value was taken"
    if left:
        table += f"\n... and {left} more in the group friction"
        known = sorted((row for row in rows if row[-1] != "nan"), key=lambda row: float(row[-1]))
        for word, row in zip(("least", "greatest"), known[:1] + known[-1:], strict=False):
            table += f"\n{word} efficiency: {row[-1]} % at {row[0]} N m, {row[1]} / min, {row[2]} degC, {row[3]} um"
    return table


def uncertified(tree: xr.DataTree) -> list[str]:
    """Lines on uncertified solutions: one a torque that has some, and one for the friction feedback."""
    loaded = tree["loaded"].to_dataset()
    lines = [
        f"{torque:g} N m: {some} of {status.size} mesh positions have no certified solution {reasons}"
        for torque, status in zip(loaded["torque"].values, loaded["status"].values, strict=True)
        for some, reasons in _failures(status)
    ]
    if "friction" in tree.children and "status" in tree["friction"]:
        status = tree["friction"].to_dataset()["status"].values
        what = "mesh positions and conditions have no load distribution"
        lines += [f"friction fed back: {some} of {status.size} {what} {reasons}" for some, reasons in _failures(status)]
    return lines


def _failures(status: Any) -> list[tuple[int, str]]:
    """Number and names of the values of ``Status`` that are not certified; empty if all are."""
    bad = status[status != Status.CERTIFIED]
    names = sorted({Status(int(value)).name.lower() for value in bad})
    return [(bad.size, f"({', '.join(names)}); their values are NaN")] if bad.size else []


def _head(tree: xr.DataTree) -> str:
    """Table of the pair, its misalignment and its unloaded contact."""
    attrs, unloaded = tree.attrs, tree["unloaded"].to_dataset()
    ease_off = tree["ease_off"].to_dataset()
    inside = ease_off["inside"].values == 1
    gap = ease_off["ease_off"].values[inside]
    harmonics = np.atleast_1d(unloaded.attrs["harmonics"])
    sigma = np.degrees(attrs["misalignment_shaft_angle_rad"])
    errors = [
        ("E", attrs["misalignment_offset_mm"], "mm"),
        ("P", attrs["misalignment_pinion_axial_mm"], "mm"),
        ("G", attrs["misalignment_gear_axial_mm"], "mm"),
        ("Sigma", sigma, "deg"),
    ]
    departures = [("deviating flanks", deviations(attrs)), ("modified ease-off", modification(attrs))]
    head = [
        (
            "pair",
            f"{attrs['pinion_teeth']} x {attrs['gear_teeth']}, {attrs['pinion_hand']}-hand pinion, "
            f"{attrs['flank']} flanks",
        ),
        ("misalignment", ", ".join(f"{name} {value:+g} {unit}" for name, value, unit in errors if value) or "none"),
        *((name, words) for name, words in departures if words),
        ("common flank", f"{100 * inside.mean():.0f} % of the gear flank"),
        ("ease-off", f"up to {gap.max():.1f} um on the common flank"),
        (
            "unloaded transmission error",
            f"{unloaded.attrs['peak_to_peak']:.2f} urad peak to peak, harmonics "
            + " / ".join(f"{a:.2f}" for a in harmonics),
        ),
    ]
    return str(tabulate(head, tablefmt="plain"))


def _loaded_table(loaded: xr.Dataset) -> str:
    """Table of the loaded contact, a row a torque."""
    worst = np.max(np.stack([loaded[name].values for name in CERTIFICATE]), axis=0)
    # Older results lack the overhang.
    edges = "overhang" in loaded and bool(loaded["overhang"].notnull().any())
    rows = [
        (
            f"{torque:g}",
            f"{loaded['mean_level'].values[i]:.1f}",
            f"{loaded['peak_to_peak'].values[i]:.2f}",
            *(f"{amplitude:.2f}" for amplitude in loaded["harmonic"].values[i, :3]),
            f"{loaded['max_pressure'].values[i]:.0f}",
            *([f"{100.0 * float(loaded['edge_share'][i].max()):.1f}"] if edges else []),
            f"{np.max(worst[i]):.0e}",
            f"{int(np.sum(loaded['status'].values[i] == Status.CERTIFIED))} of {worst.shape[1]}",
        )
        for i, torque in enumerate(loaded["torque"].values)
    ]
    headers = [
        "torque\nN m",
        "mean TE\nurad",
        "peak to\npeak urad",
        "harmonic\n1 urad",
        "\n2",
        "\n3",
        "greatest\npressure MPa",
        *(["on edges\nup to %"] if edges else []),
        "worst\nresidual",
        "certified\npositions",
    ]
    return str(tabulate(rows, headers=headers, disable_numparse=True, colalign=("right",) * len(headers)))


def _root_stresses(stresses: xr.Dataset) -> str:
    """Table of the greatest root stresses, a row a torque."""
    greatest = stresses["max_root_stress"]
    rows = [(f"{torque:g}", *(f"{v:.0f}" for v in greatest.sel(torque=torque))) for torque in greatest["torque"].values]
    headers = ["torque\nN m", "pinion\nMPa", "gear\nMPa"]
    return str(tabulate(rows, headers=headers, disable_numparse=True, colalign=("right",) * 3))


def _notes(tree: xr.DataTree) -> list[str]:
    """Notes on the reliability of the numbers."""
    notes = [*uncertified(tree), *plausibility(tree)]
    # Older results lack the attribute.
    searched = int(tree["loaded"].attrs.get("searched_segments", 0))
    if searched:
        loaded = tree["loaded"].to_dataset().isel(torque=0)
        lines = int((loaded["length"].notnull() & loaded["overhang"].isnull()).sum())
        notes.append(
            f"Note: at {searched} of {lines} segments the curvature of the flanks changes so quickly that the closest "
            "approach was searched for; forces and pressures there are approximate."
        )
    if tree.attrs["opposite_flanks"] != "given":
        notes.append(
            "Note: the case does not describe all four flanks; the missing ones were assumed to have the same "
            "settings, which affects the tooth thickness only."
        )
    return notes


def result_summary(tree: xr.DataTree) -> str:
    """Summary of a result.

    Parameters
    ----------
    tree
        A result of ``analyze`` or ``read_result``.

    Examples
    --------
    >>> import easeoff
    >>> print(result_summary(easeoff.analyze("nasa-12x36", torques=[100.0])).splitlines()[3])
    pair                         12 x 36, left-hand pinion, drive flanks
    """
    attrs = tree.attrs
    solver = "native" if attrs["solver"] == "auto" else attrs["solver"]
    title = attrs["title"]
    # Older results do not say the model.
    teeth = TEETH.get(attrs.get("compliance_model", ""), "")
    where = "lines and edges" if attrs.get("edge_contact") else "lines alone"
    contact = f"Loaded contact on {where}, {teeth}solver {solver}"
    parts = [title, "=" * len(title), "", _head(tree), "", contact, ""]
    parts.append(_loaded_table(tree["loaded"].to_dataset()))
    if "root_stress" in tree.children:
        stresses = _root_stresses(tree["root_stress"].to_dataset())
        parts += ["", "Greatest root stress, finite elements", "", stresses]
    if "friction" in tree.children:
        friction = tree["friction"].to_dataset()
        fed_back = ", fed back to the forces" if "energy_balance" in friction else ""
        name = f"Friction{fed_back}: {named_models(friction.attrs)}"
        parts += ["", name, "", efficiencies(friction)]
    notes = _notes(tree)
    return "\n".join([*parts, *(["", *notes] if notes else [])])
