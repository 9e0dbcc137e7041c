"""Misalignment chart: E, P, G and Sigma over the torque, with their range over the mesh cycle."""

from __future__ import annotations

import numpy as np
import xarray as xr
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from ..report.deflection_report import misalignment_over_torque
from .page import BLUE, GREEN, GREY, INK, SMALL_SIZE, VERMILION, page, plain_axes

DISPLACEMENTS = (
    ("E, offset", BLUE, "o"),
    ("P, pinion away along its axis", VERMILION, "s"),
    ("G, gear away along its axis", GREEN, "^"),
)


def draw(tree: xr.DataTree) -> Figure:
    """Draw the misalignment of a result over the torque; it has one that depends on it."""
    found = misalignment_over_torque(tree)
    assert found is not None
    torques, errors = found
    in_cycle = " · bands: over the mesh cycle" if np.any(np.ptp(errors, axis=1)) else ""
    last = float(np.asarray(tree.attrs.get("deflection_torques_N_m", (0.0, np.inf)))[1])
    figure = page(tree, "Misalignment over the torque", 4.6, f"a mark a torque, the first without load{in_cycle}")
    upper, lower = figure.subplots(2, 1, sharex=True, height_ratios=[1.6, 1.0])
    for number, (label, colour, mark) in enumerate(DISPLACEMENTS):
        _curve(upper, torques, 1e3 * errors[:, :, number], label, colour, mark)
    _curve(lower, torques, 1e3 * errors[:, :, 3], "Σ, shaft angle", INK, "D")
    for axes, label in ((upper, "displacement [µm]"), (lower, "angle [mrad]")):
        plain_axes(axes)
        axes.axhline(0.0, color=GREY, linewidth=0.6, zorder=1)
        axes.set_ylabel(label, fontsize=SMALL_SIZE + 1, color=INK)
        if torques[-1] > last:
            axes.axvspan(last, torques[-1], color=GREY, alpha=0.12, linewidth=0, zorder=0, label="beyond the table")
        axes.legend(
            fontsize=SMALL_SIZE, frameon=False, labelcolor=INK, loc="center left", bbox_to_anchor=(1.0, 0.5),
            handlelength=1.6, borderaxespad=0.6,
        )  # fmt: skip
    lower.set_xlabel("torque at the pinion [N m]", fontsize=SMALL_SIZE + 1, color=INK)
    lower.set_xlim(left=0.0)
    figure.align_ylabels([upper, lower])
    return figure


def _curve(axes: Axes, torques: np.ndarray, values: np.ndarray, label: str, colour: str, mark: str) -> None:
    """Draw values over the torques (t, k): mean over the mesh cycle, and their range as a band."""
    mean = values.mean(axis=1)
    axes.plot(torques, mean, label=label, color=colour, marker=mark, markersize=3.5, linewidth=1.4, zorder=3)
    if np.any(np.ptp(values, axis=1)):
        axes.fill_between(torques, values.min(axis=1), values.max(axis=1), color=colour, alpha=0.18, linewidth=0)
