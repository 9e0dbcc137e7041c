"""Root stress chart: the greatest tensile stress in the fillets along the face and over the mesh cycle."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import xarray as xr
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from numpy.typing import NDArray

from ....contact.evaluation.tooth_passage import two_cycles
from ....core.attributes import ordered
from ....geometry.pair.gear_pair import MEMBERS
from ..page import GREY, INK, PANEL_COUNT_LIMIT, SMALL_SIZE, plain_axes, torque_colours, torque_name
from ..panel_grid import OwnAxes, chosen_parts, chosen_torques, panels

PARTS = ("face", "cycle")
LABELS = {"face": "from the toe, along the face [%]", "cycle": "mesh cycles (pinion pitches)"}


def draw(
    tree: xr.DataTree,
    torque: float | Sequence[float] | None = None,
    member: str | None = None,
    parts: str | Sequence[str] | None = None,
    own: OwnAxes = None,
) -> Figure:
    """Draw the root stress chart of a result; arguments as of ``contact_figures.root_stress``."""
    stress = tree["root_stress"].to_dataset()
    torques = stress["torque"].values
    chosen = chosen_torques(torques, torque, PANEL_COUNT_LIMIT)
    names, members = chosen_parts(PARTS, parts), chosen_parts(MEMBERS, member, "member")
    note = "greatest tensile stress around the fillet of the loaded side, over the mesh cycle or anywhere on the face"
    note += "" if torque is not None or chosen.size == torques.size else f" · {chosen.size} of {torques.size} torques"
    shape = (len(names), len(members))
    found = panels(tree, "Root stress", 2.5 * len(names), note, shape, own, sharey="row")
    for number, axes in enumerate(found.axes):
        part, name = names[number // len(members)], members[number % len(members)]
        _draw_lines(axes, stress, part, name, chosen)
        axes.set_title(name, loc="left", fontsize=SMALL_SIZE + 1.5, color=INK, weight="bold", pad=3)
        axes.set_xlabel(LABELS[part], fontsize=SMALL_SIZE + 1, color=INK)
        if number % len(members) == 0 or not found.on_page:
            axes.set_ylabel("root stress [MPa]", fontsize=SMALL_SIZE + 1, color=INK)
    for axes in found.axes:  # only now: panels of a row share their limits
        axes.set_ylim(bottom=min(0.0, axes.get_ylim()[0]))
    found.axes[0].legend(fontsize=SMALL_SIZE, frameon=False, labelcolor=INK)
    return found.figure


def greatest_over_pairs(stress: xr.Dataset, torque: int, member: str) -> NDArray[np.float64]:
    """Greatest root stress of the teeth in mesh (mesh_position) [MPa]; NaN where there is none."""
    here = stress["root_stress_history"].isel(torque=torque).sel(member=member)
    values = here.transpose("mesh_position", "pair").values
    return np.where(np.any(np.isfinite(values), axis=1), np.max(np.nan_to_num(values, nan=-np.inf), axis=1), np.nan)


def _draw_lines(axes: Axes, stress: xr.Dataset, part: str, member: str, chosen: NDArray[np.int64]) -> None:
    """Draw a line a torque."""
    torques = stress["torque"].values
    along = ordered(stress.sel(member=member), "root_stress", "torque", "lengthwise")
    for index, colour in zip(chosen, torque_colours(torques[chosen]), strict=True):
        label = torque_name(float(torques[index]))
        if part == "face":
            axes.plot(100.0 * stress["lengthwise"].values, along[index], color=colour, linewidth=1.6, label=label)
        else:
            times, values = two_cycles(greatest_over_pairs(stress, int(index), member))
            axes.plot(times, values, color=colour, linewidth=1.6, label=label)
    plain_axes(axes)
    axes.set_xlim((0.0, 100.0) if part == "face" else (0.0, 2.0))
    if not np.any(np.isfinite(along[chosen])):
        axes.text(0.5, 0.5, "no certified solution", transform=axes.transAxes, ha="center", color=GREY)
