"""Figures of friction: maps over the flank, power loss and efficiency."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, overload

import xarray as xr

from ..drawing_style import drawing
from .drawn_result import require_result, views

if TYPE_CHECKING:
    from matplotlib.figure import Figure

    from .drawn_result import AxesChoice, DrawnAxes


@overload
def friction_maps(
    tree: xr.DataTree,
    *,
    torque: float | None = None,
    speed: float | None = None,
    temperature: float | None = None,
    roughness: float | None = None,
    quantities: str | Sequence[str] | None = None,
    axes: None = None,
) -> Figure: ...
@overload
def friction_maps(
    tree: xr.DataTree,
    *,
    torque: float | None = None,
    speed: float | None = None,
    temperature: float | None = None,
    roughness: float | None = None,
    quantities: str | Sequence[str] | None = None,
    axes: DrawnAxes,
) -> None: ...
def friction_maps(
    tree: xr.DataTree,
    *,
    torque: float | None = None,
    speed: float | None = None,
    temperature: float | None = None,
    roughness: float | None = None,
    quantities: str | Sequence[str] | None = None,
    axes: AxesChoice = None,
) -> Figure | None:
    """Velocities, film, friction and temperature over the gear flank, at one operating condition.

    Parameters
    ----------
    tree
        A result with friction.
    torque, speed, temperature, roughness
        Torque at the pinion [N m], its speed [1/min], temperature of the oil [degC] and roughness [um], of those that
        the result has; the middle ones if left out.
    quantities
        Panels: ``rolling_velocity``, ``sliding_velocity``, ``slide_to_roll``, ``equivalent_radius``, ``lambda_ratio``,
        ``friction_coefficient``, ``flash_temperature``, ``pressure_velocity``; all if left out.
    axes
        An Axes a panel; a page of its own if left out. With them nothing is returned; ``layout="constrained"``
        of their figure makes room.

    Raises
    ------
    InputError
        If ``tree`` is no result with friction, it does not have a condition or a quantity, or ``axes`` are not as many
        as the panels.

    Examples
    --------
    >>> import easeoff
    >>> tree = easeoff.analyze("nasa-12x36", torques=[100.0], speed=1500.0)
    >>> figure = easeoff.plot.friction_maps(tree, quantities="sliding_velocity")
    >>> figure.axes[0].get_title(loc="left")
    'sliding velocity [m/s]'
    """
    require_result(tree, "loaded", "friction")
    with drawing(axes):
        from ..friction_map_chart import draw

        conditions = {"torque": torque, "speed": speed, "temperature": temperature, "roughness": roughness}
        figure = draw(tree, views(tree, "gear")[0], conditions, quantities, axes)
    return figure if axes is None else None


@overload
def efficiency(tree: xr.DataTree, *, parts: str | Sequence[str] | None = None, axes: None = None) -> Figure: ...
@overload
def efficiency(tree: xr.DataTree, *, parts: str | Sequence[str] | None = None, axes: DrawnAxes) -> None: ...
def efficiency(
    tree: xr.DataTree, *, parts: str | Sequence[str] | None = None, axes: AxesChoice = None
) -> Figure | None:
    """Power loss over the mesh cycle, and efficiency over every operating condition that varies.

    Parameters
    ----------
    tree
        A result with friction.
    parts
        Panels: ``cycle``, and those of ``speed``, ``torque``, ``temperature`` and ``roughness`` of which the result has
        several; all if left out.
    axes
        An Axes a panel; a page of its own if left out. With them nothing is returned; ``layout="constrained"``
        of their figure makes room.

    Raises
    ------
    InputError
        If ``tree`` is no result with friction, a part is not known, or ``axes`` are not as many as the panels.

    Examples
    --------
    >>> import easeoff
    >>> tree = easeoff.analyze("nasa-12x36", torques=[100.0], speed=[500.0, 1500.0])
    >>> len(easeoff.plot.efficiency(tree).axes)
    2
    """
    require_result(tree, "loaded", "friction")
    with drawing(axes):
        from ..efficiency_chart import draw

        figure = draw(tree, parts, axes)
    return figure if axes is None else None
