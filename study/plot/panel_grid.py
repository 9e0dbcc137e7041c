"""Panels of a picture: on a page of their own, or on axes of the caller."""

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
from .page import evenly_chosen, page

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

    #: One Axes of the caller, or as many as a picture has panels; a page of its own if ``None``.
    AxesChoice: TypeAlias = Axes | Iterable[Axes] | None

TORQUE_TOLERANCE = 1e-6  # relative, between a torque as it is given and that of a result


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
    own: AxesChoice = None,
    *,
    count: int | None = None,
    **layout: Any,
) -> Panels:
    """Panels on a page, or axes of the caller, which must be as many as the panels."""
    from matplotlib.axes import Axes

    wanted = shape[0] * shape[1] if count is None else count
    if own is None:
        figure = page(tree, heading, body_height, note)
        grid = figure.subplots(*shape, squeeze=False, **layout).reshape(-1)
        for axes in grid[wanted:]:
            axes.set_visible(False)
        return Panels(figure, grid[:wanted], True)
    given = _flat(own)
    if len(given) != wanted or not all(isinstance(axes, Axes) for axes in given):
        kinds = ", ".join(sorted({type(axes).__name__ for axes in given})) or "nothing"
        needed = "one Axes" if wanted == 1 else f"{wanted} Axes, one a panel"
        raise InputError(f"axes = {len(given)} of {kinds}: must be {needed}")
    figure = given[0].get_figure(root=True)
    return Panels(figure, np.array(given, dtype=object), False)


def _flat(own: Any) -> list[Any]:
    """Axes one by one, out of lists and arrays of whatever shape."""
    own = own.ravel().tolist() if isinstance(own, np.ndarray) else own
    return [axes for part in own for axes in _flat(part)] if isinstance(own, list | tuple) else [own]


def chosen_torques(torques: NDArray[Any], wanted: float | Sequence[float] | None, most: int) -> Integers:
    """Indices of the wanted among torques (n) [N m]; if none is wanted, of at most ``most``, spread evenly."""
    if wanted is None:
        return evenly_chosen(torques, most)
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
