"""Misalignment chart: E, P, G and Sigma over the torque, and the centre of the pattern that moves with them."""

from __future__ import annotations

from typing import Any

import numpy as np
import xarray as xr
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from ...report.summary.deflection_report import misalignment_over_torque
from ..page import BLUE, GREEN, GREY, INK, SMALL_SIZE, VERMILION, legend_of_curves, plain_axes
from ..panel_grid import OwnAxes, panels

DISPLACEMENTS = (
    ("E, offset", BLUE, "o"),
    ("P, pinion away along its axis", VERMILION, "s"),
    ("G, gear away along its axis", GREEN, "^"),
)
LINES: tuple[Any, ...] = ("-", (0, (5, 2)), (0, (1.5, 1.5)))  # of curves, told apart where they coincide


def draw(tree: xr.DataTree, own: OwnAxes = None) -> Figure:
    """Draw the misalignment of a result over the torque; it has one that depends on it."""
    found = misalignment_over_torque(tree)
    assert found is not None
    torques, errors = found
    in_cycle = bool(np.any(np.ptp(errors, axis=1)))
    note = "marks: without load (pattern: at light load) and at every torque"
    last = float(np.asarray(tree.attrs.get("deflection_torques_N_m", (0.0, np.inf)))[1])
    layout: dict[str, Any] = {"sharex": True, "height_ratios": [1.6, 1.0, 1.0]}
    drawn_in = panels(tree, "Misalignment over the torque", 6.2, note, (3, 1), own, **layout)
    grid = drawn_in.axes
    for number, (label, colour, mark) in enumerate(DISPLACEMENTS):
        _curve(grid[0], torques, errors[:, :, number], label, colour, mark, LINES[number])
    _curve(grid[1], torques, np.degrees(errors[:, :, 3]), "Σ, shaft angle", INK, "D")
    for fraction, label, colour, mark, line in (
        ("lengthwise", "from toe", INK, "o", LINES[0]),
        ("profile", "from root", GREY, "s", LINES[1]),
    ):
        at, centres = _pattern_centres(tree, f"pattern_centre_{fraction}")
        _curve(grid[2], at, centres[:, None], label, colour, mark, line)
    grid[2].set_ylim(0.0, 100.0)
    labels = ("displacement [mm]", "angle [°]", "pattern centre [%]")
    for axes, label in zip(grid, labels, strict=True):
        plain_axes(axes)
        axes.set_ylabel(label, fontsize=SMALL_SIZE + 1, color=INK)
        if torques[-1] > last:
            axes.axvspan(last, torques[-1], color=GREY, alpha=0.12, linewidth=0, zorder=0, label="beyond the table")
        if axes is not grid[2] and in_cycle:
            axes.fill_between([], [], [], color=GREY, alpha=0.18, linewidth=0, label="range over the mesh cycle")
        legend_of_curves(axes, on_page=drawn_in.on_page)
    for axes in grid[:2]:
        axes.axhline(0.0, color=GREY, linewidth=0.6, zorder=1)
    grid[2].set_xlabel("torque at the pinion [N m]", fontsize=SMALL_SIZE + 1, color=INK)
    for axes in grid:
        axes.set_xlim(left=0.0)
    if drawn_in.on_page:
        drawn_in.figure.align_ylabels(grid)
    return drawn_in.figure


def _pattern_centres(tree: xr.DataTree, name: str) -> tuple[np.ndarray, np.ndarray]:
    """Torques (t), and the centre of the loaded pattern on the gear flank there (t) [%]; of light load, too."""
    groups = [tree[group].to_dataset() for group in ("light_load", "loaded") if group in tree.children]
    known = [group for group in groups if name in group]  # older results lack the pattern
    torques, centres = (np.concatenate([[], *(group[one].values for group in known)]) for one in ("torque", name))
    order = np.argsort(torques)
    return torques[order], 100.0 * centres[order]


def _curve(
    axes: Axes, torques: np.ndarray, values: np.ndarray, label: str, colour: str, mark: str, line: Any = "-"
) -> None:
    """Draw values over the torques (t, k): mean over the mesh cycle, and their range as a band."""
    mean = values.mean(axis=1)
    axes.plot(
        torques, mean, label=label, color=colour, marker=mark, markersize=3.5, linewidth=1.4, linestyle=line, zorder=3
    )
    if np.any(np.ptp(values, axis=1)):
        axes.fill_between(torques, values.min(axis=1), values.max(axis=1), color=colour, alpha=0.18, linewidth=0)
