"""Figures of studies: load cases, sweeps, V-H checks, wear, optimised ease-off and fronts."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Any

import xarray as xr

from ...core.checks import instance
from ...core.errors import InputError
from ..sweep.sweep_file import is_sweep
from .drawing_style import picture
from .drawn_result import require_result, views

if TYPE_CHECKING:
    from matplotlib.figure import Figure
    from numpy.typing import NDArray

    from .drawn_result import AxesChoice


@picture
def load_cases(tree: xr.DataTree, *, axes: AxesChoice = None) -> Figure | None:
    """Pattern, pressure, transmission error, power loss and damage of load cases, a row each.

    Parameters
    ----------
    tree
        Of ``study.analyze_load_cases``.
    axes
        An Axes a panel: pattern, greatest pressure, peak to peak, and power loss and damage if the result has
        them; a page of its own if left out. With them nothing is returned; ``layout="constrained"`` of their
        figure makes room.

    Raises
    ------
    InputError
        If ``tree`` is no result over load cases, or ``axes`` are not as many as the panels.

    Examples
    --------
    >>> import easeoff
    >>> from easeoff.cases import LoadCase
    >>> from easeoff.study import analyze_load_cases
    >>> case = easeoff.read_case("nasa-12x36")
    >>> case = case.model_copy(update={"contact": case.contact.model_copy(update={"mesh_positions": 3})})
    >>> tree = analyze_load_cases(case, [LoadCase(name="climb", torque=100.0)])
    >>> len(easeoff.plot.load_cases(tree).axes)
    3
    """
    require_result(tree, "load_cases")
    from .study_charts import draw_load_cases as draw

    return draw(tree, axes)


@picture
def sweep(
    dataset: xr.Dataset,
    picture: str | None = None,
    *,
    names: str | Sequence[str] | None = None,
    axes: AxesChoice = None,
) -> Figure | None:
    """A picture of a sweep.

    Parameters
    ----------
    dataset
        Of ``easeoff.sweep`` or ``study.sweep.read_sweep``.
    picture
        ``map`` over two grids, ``curves`` over one, ``pattern``, ``histograms`` of samples or ``tornado`` of
        sensitivities; the first of them that the sweep has if left out. ``pictures`` lists them with ``sweep_`` before.
    names
        Numbers to draw, a panel each: ``peak_to_peak``, ``max_pressure``, ``contact_ratio``,
        ``pattern_centre_lengthwise``, ``max_root_stress``, ``efficiency``; the first four of them if left out.
    axes
        An Axes a panel; a page of its own if left out. With them nothing is returned; ``layout="constrained"``
        of their figure makes room.

    Raises
    ------
    InputError
        If ``dataset`` is no sweep, does not have the picture or a number, or ``axes`` are not as many as the panels.

    Examples
    --------
    >>> import easeoff
    >>> found = easeoff.sweep("nasa-12x36", {"E": [0.0, 0.02, 0.04]}, torques=[100.0])
    >>> easeoff.plot.pictures(found)
    ('sweep_curves', 'sweep_pattern')
    >>> len(easeoff.plot.sweep(found, "curves", names="max_pressure").axes)
    1
    """
    if not is_sweep(dataset):
        raise InputError("dataset: must be of easeoff.sweep or study.sweep.read_sweep")
    from .study_charts import draw_sweep as draw

    return draw(dataset, picture, names, axes)


@picture
def vh_check(found: xr.Dataset, *, parts: str | Sequence[str] | None = None, axes: AxesChoice = None) -> Figure | None:
    """Marking prints of a V-H check at toe, middle and heel, and over the grid of V and H.

    Parameters
    ----------
    found
        Of ``study.vh_check``.
    parts
        ``places`` and, if it was asked for, ``grid``; both if left out.
    axes
        An Axes a print: toe, middle, heel, then the grid from the greatest H, from left to right; a page of its
        own if left out. With them nothing is returned; ``layout="constrained"`` of their figure makes room.

    Raises
    ------
    InputError
        If ``found`` is no V-H check, a part is not known, or ``axes`` are not as many as the panels.

    Examples
    --------
    >>> import easeoff
    >>> found = easeoff.study.vh_check("fh-design-a")
    >>> len(easeoff.plot.vh_check(found).axes)
    3
    """
    instance("found", found, xr.Dataset)
    if "print_excess" not in found or "in_plane" not in found:
        raise InputError("found: must be of 'easeoff vh' or study.vh_check")
    from .vh_chart import draw

    return draw(found, parts, axes)


@picture
def wear(history: xr.Dataset, *, parts: str | Sequence[str] | None = None, axes: AxesChoice = None) -> Figure | None:
    """Wear of both flanks at the end, and depth, transmission error and pressure over the revolutions.

    Parameters
    ----------
    history
        Of ``study.wear``.
    parts
        Panels: ``pinion``, ``gear``, ``largest_depth``, ``peak_to_peak``, ``max_pressure``; all if left out.
    axes
        An Axes a panel; a page of its own if left out. With them nothing is returned; ``layout="constrained"``
        of their figure makes room.

    Raises
    ------
    InputError
        If ``history`` is none of wear, a part is not known, or ``axes`` are not as many as the panels.

    Examples
    --------
    >>> import easeoff
    >>> coarse = {"mesh_positions": 4, "segments_per_line": 9, "lengthwise_nodes": 11, "profile_nodes": 9}
    >>> case = easeoff.read_case("nasa-12x36")
    >>> case = case.model_copy(update={"contact": case.contact.model_copy(update=coarse)})
    >>> history = easeoff.study.wear(case, easeoff.study.WearLaw(1e-12, 1e-12, revolutions=1e5), torque=100.0)
    >>> len(easeoff.plot.wear(history, parts=["largest_depth", "max_pressure"]).axes)
    2
    """
    instance("history", history, xr.Dataset)
    if "wear_depth" not in history or "revolutions" not in history:
        raise InputError("history: must be of 'easeoff wear' or study.wear")
    from .study_charts import draw_wear as draw

    return draw(history, parts, axes)


@picture
def optimization(
    tree: xr.DataTree, *, parts: str | Sequence[str] | None = None, axes: AxesChoice = None
) -> Figure | None:
    """Optimised modification of the ease-off, and what it changes, in the worst assembly.

    Parameters
    ----------
    tree
        Of ``easeoff.modify``.
    parts
        Panels: ``surface``, ``max_line_load``, ``max_pressure``, ``max_end_load``, ``peak_to_peak``; all if left out.
    axes
        An Axes a panel; a page of its own if left out. With them nothing is returned; ``layout="constrained"``
        of their figure makes room.

    Raises
    ------
    InputError
        If ``tree`` is of no optimisation, a part is not known, or ``axes`` are not as many as the panels.

    Examples
    --------
    >>> import easeoff
    >>> coarse = {"mesh_positions": 3, "segments_per_line": 9, "lengthwise_nodes": 9, "profile_nodes": 7}
    >>> case = easeoff.read_case("nasa-12x36")
    >>> case = case.model_copy(update={"contact": case.contact.model_copy(update=coarse)})
    >>> tree = easeoff.modify(case, torques=[200.0], order=2, programmes=1)
    >>> len(easeoff.plot.optimization(tree, parts="peak_to_peak").axes)
    1
    """
    require_result(tree, "loaded", "optimization", "modification")
    from .topography_chart import draw_optimization

    return draw_optimization(tree, views(tree, "gear")[0], parts, axes)


@picture
def front(
    tree: xr.DataTree, *, others: Mapping[str, NDArray[Any]] | None = None, axes: AxesChoice = None
) -> Figure | None:
    """Front of two objectives, with the start.

    Parameters
    ----------
    tree
        Of ``easeoff.optimize`` with ``form="pareto"``.
    others
        Points (n, 2) of both objectives that other methods found, by the name in the legend.
    axes
        An Axes; a page of its own if left out. With it nothing is returned.

    Raises
    ------
    InputError
        If ``tree`` has no front, or ``axes`` is not one.

    Examples
    --------
    >>> import easeoff
    >>> easeoff.plot.front(easeoff.analyze("nasa-12x36", torques=[100.0]))
    Traceback (most recent call last):
    easeoff.core.errors.InputError: tree: the result has no group 'front': 'easeoff optimize --form pareto' makes it
    """
    require_result(tree, "loaded", "front", "optimal_settings")
    from .study_charts import draw_front

    return draw_front(tree, others or {}, axes)
