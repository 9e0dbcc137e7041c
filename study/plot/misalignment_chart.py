"""Misalignment chart: E, P, G and Sigma over the torque, and the centre of the pattern that moves with them."""

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
    note = f"marks: without load (pattern: at light load) and at every torque{in_cycle}"
    last = float(np.asarray(tree.attrs.get("deflection_torques_N_m", (0.0, np.inf)))[1])
    figure = page(tree, "Misalignment over the torque", 6.2, note)
    panels = figure.subplots(3, 1, sharex=True, height_ratios=[1.6, 1.0, 1.0])
    for number, (label, colour, mark) in enumerate(DISPLACEMENTS):
        _curve(panels[0], torques, 1e3 * errors[:, :, number], label, colour, mark)
    _curve(panels[1], torques, 1e3 * errors[:, :, 3], "Σ, shaft angle", INK, "D")
    for fraction, label, colour, mark in (("lengthwise", "from toe", INK, "o"), ("profile", "from root", GREY, "s")):
        centres = _pattern_centres(tree, fraction)
        _curve(panels[2], centres["torque"].values, 100.0 * centres.values[:, None], label, colour, mark)
    labels = ("displacement [µm]", "angle [mrad]", "pattern centre [%]")
    for axes, label in zip(panels, labels, strict=True):
        plain_axes(axes)
        axes.set_ylabel(label, fontsize=SMALL_SIZE + 1, color=INK)
        if torques[-1] > last:
            axes.axvspan(last, torques[-1], color=GREY, alpha=0.12, linewidth=0, zorder=0, label="beyond the table")
        axes.legend(
            fontsize=SMALL_SIZE, frameon=False, labelcolor=INK, loc="center left", bbox_to_anchor=(1.0, 0.5),
            handlelength=1.6, borderaxespad=0.6,
        )  # fmt: skip
    for axes in panels[:2]:
        axes.axhline(0.0, color=GREY, linewidth=0.6, zorder=1)
    panels[2].set_ylim(0.0, 100.0)
    panels[2].set_xlabel("torque at the pinion [N m]", fontsize=SMALL_SIZE + 1, color=INK)
    panels[2].set_xlim(left=0.0)
    figure.align_ylabels(panels)
    return figure


def _pattern_centres(tree: xr.DataTree, fraction: str) -> xr.DataArray:
    """Centre of the loaded pattern on the gear flank, at light load and at every torque, as a fraction."""
    groups = [tree[name].to_dataset() for name in ("light_load", "loaded")]
    return xr.concat([group[f"pattern_centre_{fraction}"] for group in groups], "torque").sortby("torque")


def _curve(axes: Axes, torques: np.ndarray, values: np.ndarray, label: str, colour: str, mark: str) -> None:
    """Draw values over the torques (t, k): mean over the mesh cycle, and their range as a band."""
    mean = values.mean(axis=1)
    axes.plot(torques, mean, label=label, color=colour, marker=mark, markersize=3.5, linewidth=1.4, zorder=3)
    if np.any(np.ptp(values, axis=1)):
        axes.fill_between(torques, values.min(axis=1), values.max(axis=1), color=colour, alpha=0.18, linewidth=0)
