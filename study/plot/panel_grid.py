"""Panels of a picture, on a page of their own or on axes of the caller, and what of a result they show."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, TypeAlias

import numpy as np
import xarray as xr
from numpy.typing import NDArray

from ...core.arrays import Integers
from ...core.checks import distinct, words
from ...core.errors import InputError, suggestion
from ..result import VARIABLES
from .page import page

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

#: One Axes of the caller, or as many as a picture has panels; a page of its own if ``None``.
AxesChoice: TypeAlias = "Axes | Iterable[Axes] | None"
PANEL_COUNT_LIMIT = 6
TORQUE_TOLERANCE = 1e-6  # relative, between a torque as it is given and that of a result
#: What makes a group that not every result has.
MADE_BY = {
    "friction": "give a speed: analyze(..., speed=1500.0), or 'easeoff run --speed 1500'",
    "root_stress": "finite-element teeth have it: compliance.model = 'fe' in the case",
    "optimization": "it must be a result of 'easeoff modify'",
    "front": "'easeoff optimize --form pareto' makes it",
    "optimal_settings": "it must be a result of 'easeoff optimize'",
    "load_cases": "it must be a result over load cases",
}


@dataclass(frozen=True)
class Panels:
    """Panels of a picture."""

    figure: Figure
    axes: NDArray[Any]  # (n), row by row
    on_page: bool  # a page of its own: heading, small print, one legend


def panels(
    tree: xr.DataTree,
    heading: str,
    body_height: float,
    note: str,
    shape: tuple[int, int],
    axes_given: AxesChoice = None,
    *,
    count: int | None = None,
    **layout: Any,
) -> Panels:
    """Panels on a page, or axes of the caller, which must be as many as the panels."""
    from matplotlib.axes import Axes

    wanted = shape[0] * shape[1] if count is None else count
    if axes_given is None:
        figure = page(tree, heading, body_height, note)
        grid = figure.subplots(*shape, squeeze=False, **layout).reshape(-1)
        for axes in grid[wanted:]:
            axes.set_visible(False)
        return Panels(figure, grid[:wanted], True)
    given = one_by_one(axes_given)
    if len(given) != wanted or not all(isinstance(axes, Axes) for axes in given):
        kinds = ", ".join(sorted({type(axes).__name__ for axes in given})) or "nothing"
        needed = "one Axes" if wanted == 1 else f"{wanted} Axes, one a panel"
        raise InputError(f"axes = {len(given)} of {kinds}: must be {needed}")
    figure = given[0].get_figure(root=True)
    return Panels(figure, np.array(given, dtype=object), False)


def one_by_one(given: Any) -> list[Any]:
    """Axes one by one, out of lists and arrays of whatever shape."""
    given = given.ravel().tolist() if isinstance(given, np.ndarray) else given
    return [axes for part in given for axes in one_by_one(part)] if isinstance(given, list | tuple) else [given]


def evenly_chosen(values: NDArray[Any], most: int = PANEL_COUNT_LIMIT) -> Integers:
    """Indices of at most ``most`` values (n), rising with the values, spread evenly with both ends."""
    order = np.argsort(values, kind="stable")
    ranks = np.unique(np.linspace(0, order.size - 1, min(most, order.size)).round().astype(int))
    return np.asarray(order[ranks], dtype=np.int64)


def middle(values: NDArray[Any]) -> int:
    """Number of the middle one of values (n), the lower of two."""
    return int(np.argsort(values)[(values.size - 1) // 2])


def chosen_torques(torques: NDArray[Any], wanted: float | Sequence[float] | None) -> Integers:
    """Indices of the wanted among torques (n) [N m]; if none is wanted, of as many as find room, spread evenly."""
    if wanted is None:
        return evenly_chosen(torques)
    indices = []
    for torque in distinct("torque", wanted, "N m"):
        near = np.flatnonzero(np.isclose(torques, torque, rtol=TORQUE_TOLERANCE, atol=0.0))
        if not near.size:
            there = ", ".join(f"{value:g}" for value in np.sort(torques))
            raise InputError(f"torque = {torque:g}: must be one of the result's: {there} N m")
        indices.append(int(near[0]))
    return np.array(indices, dtype=np.int64)


def chosen_parts(known: Sequence[str], wanted: str | Sequence[str] | None, key: str = "parts") -> tuple[str, ...]:
    """Names that are asked for, each once, or all that are known."""
    if wanted is None:
        return tuple(known)
    names = (wanted,) if isinstance(wanted, str) else tuple(dict.fromkeys(words(key, wanted)))
    for name in names:
        if name not in known:
            raise InputError(f"{key} = {name!r}: must be one of {', '.join(known)}{suggestion(name, known)}")
    if not names:
        raise InputError(f"{key}: must name one at least of {', '.join(known)}")
    return names


def require_result(tree: object, *groups: str) -> None:
    """Refuse anything but a result that has the groups which the figure shows."""
    if not isinstance(tree, xr.DataTree) or not ("load_cases" in tree.children or VARIABLES.keys() <= {*tree.children}):
        raise InputError("tree: must be a result of 'easeoff run' or analyze")
    for group in groups or ("loaded",):
        if group not in tree.children:
            hint = MADE_BY.get(group, "draw that of one load case, in its group 'results'")
            if group == "root_stress" and "root_stress_left_out" in tree.attrs:
                hint = str(tree.attrs["root_stress_left_out"])
            raise InputError(f"tree: the result has no group {group!r}: {hint}")
