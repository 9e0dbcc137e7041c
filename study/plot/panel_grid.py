"""Panels of a picture: on a page of their own, or on axes of the caller."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, TypeAlias

import numpy as np
import xarray as xr
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from numpy.typing import NDArray

from ...core.checks import distinct, words
from ...core.errors import InputError, suggestion
from .page import evenly_chosen, page

if TYPE_CHECKING:
    pass


#: One Axes of the caller, or as many as a picture has panels.
OwnAxes: TypeAlias = Axes | Iterable[Axes] | None


TORQUE_TOLERANCE = 1e-6  # relative, between a torque as it is given and that of a result


@dataclass(frozen=True)
class Panels:
    """Panels of a picture.

    Parameters
    ----------
    figure
        Figure that they are in.
    axes
        The panels (n), row by row.
    on_page
        Whether they are on a page of their own, with a heading, small print and a legend for all.
    """

    figure: Figure
    axes: NDArray[Any]
    on_page: bool


def panels(
    tree: xr.DataTree,
    heading: str,
    body_height: float,
    note: str,
    shape: tuple[int, int],
    own: OwnAxes = None,
    *,
    count: int | None = None,
    **layout: Any,
) -> Panels:
    """Panels on a page, or the axes of the caller, checked for their number.

    Parameters
    ----------
    tree, heading, body_height, note
        As of ``page``.
    shape
        Rows and columns on the page.
    own
        Axes of the caller; ``None`` for a page.
    count
        Number of panels, if fewer than rows times columns.
    **layout
        Passed to ``Figure.subplots``.

    Raises
    ------
    InputError
        If the caller's axes are not as many as the panels.
    """
    wanted = shape[0] * shape[1] if count is None else count
    if own is None:
        figure = page(tree, heading, body_height, note)
        found = figure.subplots(*shape, squeeze=False, **layout).reshape(-1)
        for axes in found[wanted:]:
            axes.set_visible(False)
        return Panels(figure, found[:wanted], True)
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


def chosen_torques(torques: NDArray[Any], wanted: float | Sequence[float] | None, most: int) -> NDArray[np.int64]:
    """Indices of the torques that are asked for; else of at most ``most``, spread evenly.

    Parameters
    ----------
    torques
        Torques of the result (n) [N m].
    wanted
        One or several of them [N m].
    most
        Greatest number if none is asked for.

    Raises
    ------
    InputError
        If the result does not have a torque.

    Examples
    --------
    >>> [int(i) for i in chosen_torques(np.array([50.0, 100.0, 200.0]), 100.0, 6)]
    [1]
    """
    if wanted is None:
        return evenly_chosen(torques, most)
    found = []
    for torque in distinct("torque", wanted, "N m"):
        near = np.flatnonzero(np.isclose(torques, torque, rtol=TORQUE_TOLERANCE, atol=0.0))
        if not near.size:
            there = ", ".join(f"{value:g}" for value in np.sort(torques))
            raise InputError(f"torque = {torque:g}: must be one of the result's: {there} N m")
        found.append(int(near[0]))
    return np.array(found, dtype=np.int64)


def chosen_parts(known: Sequence[str], wanted: str | Sequence[str] | None, key: str = "parts") -> tuple[str, ...]:
    """Names that are asked for, each once, or all that are known.

    Raises
    ------
    InputError
        If a name is not known, with the names that are.

    Examples
    --------
    >>> chosen_parts(["loaded", "unloaded"], "loaded")
    ('loaded',)
    """
    if wanted is None:
        return tuple(known)
    names = (wanted,) if isinstance(wanted, str) else tuple(dict.fromkeys(words(key, wanted)))
    for name in names:
        if name not in known:
            raise InputError(f"{key} = {name!r}: must be one of {', '.join(known)}{suggestion(name, known)}")
    if not names:
        raise InputError(f"{key}: must name one at least of {', '.join(known)}")
    return names
