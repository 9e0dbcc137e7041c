"""Figures of the contact: ease-off, pattern, pressure, transmission error, load shares, misalignment, root stress.

Figures of friction: maps over the flank, power loss and efficiency.

Figures of corrections: topographies of the measured flanks before and after, and their files.
"""

from __future__ import annotations

import os
from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING, overload

import xarray as xr

from ...core.errors import InputError
from .drawing_style import drawing
from .drawn_result import require_result, views
from .picture_files import FORMATS

if TYPE_CHECKING:
    from matplotlib.figure import Figure

    from ...geometry.deviation.corrective_settings import Correction
    from ...geometry.pair.member_names import MemberName
    from ..case_correction import CaseCorrection
    from .drawn_result import AxesChoice, DrawnAxes


@overload
def ease_off(tree: xr.DataTree, *, axes: None = None) -> Figure: ...
@overload
def ease_off(tree: xr.DataTree, *, axes: DrawnAxes) -> None: ...
def ease_off(tree: xr.DataTree, *, axes: AxesChoice = None) -> Figure | None:
    """Ease-off of the gear flank with the path of contact.

    Parameters
    ----------
    tree
        A result of ``analyze`` or ``read_result``.
    axes
        One Axes to draw in; a page of its own if left out. With them nothing is returned;
        ``layout="constrained"`` of their figure makes room.

    Raises
    ------
    InputError
        If ``tree`` is no result or ``axes`` are not as many as the panels.

    Examples
    --------
    >>> import easeoff
    >>> tree = easeoff.analyze("nasa-12x36", torques=[100.0])
    >>> figure = easeoff.plot.ease_off(tree)
    >>> len(figure.axes)
    1
    """
    require_result(tree)
    with drawing(axes):
        from .ease_off_map import draw

        figure = draw(tree, views(tree, "gear")[0], axes)
    return figure if axes is None else None


@overload
def contact_pattern(
    tree: xr.DataTree,
    *,
    member: MemberName | None = None,
    parts: str | Sequence[str] | None = None,
    marking: float | None = None,
    axes: None = None,
) -> Figure: ...
@overload
def contact_pattern(
    tree: xr.DataTree,
    *,
    member: MemberName | None = None,
    parts: str | Sequence[str] | None = None,
    marking: float | None = None,
    axes: DrawnAxes,
) -> None: ...
def contact_pattern(
    tree: xr.DataTree,
    *,
    member: MemberName | None = None,
    parts: str | Sequence[str] | None = None,
    marking: float | None = None,
    axes: AxesChoice = None,
) -> Figure | None:
    """Contact pattern without load and at light load.

    Parameters
    ----------
    tree
        A result of ``analyze`` or ``read_result``.
    member
        ``gear`` or ``pinion``; both, side by side, if left out.
    parts
        Rows of panels: ``lines`` (contact lines and path of contact), ``print`` (marking print), ``light_load``; all if
        left out.
    marking
        Thickness of the marking compound [um]; that of the result if left out.
    axes
        An Axes a panel, row by row; a page of its own if left out. With them nothing is returned;
        ``layout="constrained"`` of their figure makes room.

    Raises
    ------
    InputError
        If ``tree`` is no result, a name is not known, the thickness is out of range, or ``axes`` are not as many as the
        panels.

    Examples
    --------
    >>> import easeoff
    >>> tree = easeoff.analyze("nasa-12x36", torques=[100.0])
    >>> figure = easeoff.plot.contact_pattern(tree, member="gear", parts="print")
    >>> figure.axes[0].get_title(loc="left")
    'marking print, 6 µm'
    """
    from ...contact.evaluation.marking_print import checked_thickness

    require_result(tree)
    if marking is not None:
        checked_thickness(marking)
    with drawing(axes):
        from .contact_pattern_chart import draw

        figure = draw(tree, views(tree, member), marking, parts, axes)
    return figure if axes is None else None


@overload
def pressure(
    tree: xr.DataTree,
    *,
    torque: float | Sequence[float] | None = None,
    member: MemberName | None = None,
    axes: None = None,
) -> Figure: ...
@overload
def pressure(
    tree: xr.DataTree,
    *,
    torque: float | Sequence[float] | None = None,
    member: MemberName | None = None,
    axes: DrawnAxes,
) -> None: ...
def pressure(
    tree: xr.DataTree,
    *,
    torque: float | Sequence[float] | None = None,
    member: MemberName | None = None,
    axes: AxesChoice = None,
) -> Figure | None:
    """Greatest contact pressure over the mesh cycle, a row a torque.

    Parameters
    ----------
    tree
        A result of ``analyze`` or ``read_result``.
    torque
        One or several torques of the result at the pinion [N m]; up to six, spread evenly, if left out.
    member
        ``gear`` or ``pinion``; both, side by side, if left out.
    axes
        An Axes a panel, row by row; a page of its own if left out. With them nothing is returned;
        ``layout="constrained"`` of their figure makes room.

    Raises
    ------
    InputError
        If ``tree`` is no result, it does not have a torque, the member is not known, or ``axes`` are not as many as the
        panels.

    Examples
    --------
    >>> import easeoff
    >>> tree = easeoff.analyze("nasa-12x36", torques=[100.0, 200.0])
    >>> figure = easeoff.plot.pressure(tree, torque=100.0)
    >>> [panel.get_title(loc="left") for panel in figure.axes[:2]]
    ['100 N m, gear', '100 N m, pinion']
    """
    require_result(tree)
    with drawing(axes):
        from .mesh_cycle_charts import draw_pressure as draw

        figure = draw(tree, views(tree, member), torque, axes)
    return figure if axes is None else None


@overload
def transmission_error(
    tree: xr.DataTree,
    *,
    torque: float | Sequence[float] | None = None,
    parts: str | Sequence[str] | None = None,
    axes: None = None,
) -> Figure: ...
@overload
def transmission_error(
    tree: xr.DataTree,
    *,
    torque: float | Sequence[float] | None = None,
    parts: str | Sequence[str] | None = None,
    axes: DrawnAxes,
) -> None: ...
def transmission_error(
    tree: xr.DataTree,
    *,
    torque: float | Sequence[float] | None = None,
    parts: str | Sequence[str] | None = None,
    axes: AxesChoice = None,
) -> Figure | None:
    """Transmission error over two mesh cycles, and its orders.

    Parameters
    ----------
    tree
        A result of ``analyze`` or ``read_result``.
    torque
        One or several torques of the result at the pinion [N m]; all if left out.
    parts
        Panels: ``unloaded``, ``loaded``, ``about_mean`` (loaded, about its mean), ``orders`` (amplitudes at multiples
        of the mesh frequency: the first four over torque, or all at a single torque); all if left out.
    axes
        An Axes a panel; a page of its own if left out. With them nothing is returned; ``layout="constrained"``
        of their figure makes room.

    Raises
    ------
    InputError
        If ``tree`` is no result, it does not have a torque, a part is not known, or ``axes`` are not as many as the
        panels.

    Examples
    --------
    >>> import easeoff
    >>> tree = easeoff.analyze("nasa-12x36", torques=[100.0])
    >>> from matplotlib.figure import Figure
    >>> axes = Figure().subplots()
    >>> easeoff.plot.transmission_error(tree, parts="about_mean", axes=axes)
    >>> axes.get_title(loc="left"), axes.get_ylabel()
    ('transmission error', 'under load, about its mean [µrad]')
    """
    require_result(tree)
    with drawing(axes):
        from .mesh_cycle_charts import draw_transmission_error as draw

        figure = draw(tree, torque, parts, axes)
    return figure if axes is None else None


@overload
def load_sharing(tree: xr.DataTree, *, torque: float | Sequence[float] | None = None, axes: None = None) -> Figure: ...
@overload
def load_sharing(tree: xr.DataTree, *, torque: float | Sequence[float] | None = None, axes: DrawnAxes) -> None: ...
def load_sharing(
    tree: xr.DataTree, *, torque: float | Sequence[float] | None = None, axes: AxesChoice = None
) -> Figure | None:
    """Share of the torque that each tooth pair carries, a panel a torque.

    Parameters
    ----------
    tree
        A result of ``analyze`` or ``read_result``.
    torque
        One or several torques of the result at the pinion [N m]; up to six, spread evenly, if left out.
    axes
        An Axes a panel; a page of its own if left out. With them nothing is returned; ``layout="constrained"``
        of their figure makes room.

    Raises
    ------
    InputError
        If ``tree`` is no result, it does not have a torque, or ``axes`` are not as many as the panels.

    Examples
    --------
    >>> import easeoff
    >>> tree = easeoff.analyze("nasa-12x36", torques=[100.0])
    >>> figure = easeoff.plot.load_sharing(tree)
    >>> figure.axes[0].get_title(loc="left")
    '100 N m'
    """
    require_result(tree)
    with drawing(axes):
        from .mesh_cycle_charts import draw_load_sharing as draw

        figure = draw(tree, torque, axes)
    return figure if axes is None else None


@overload
def misalignment(tree: xr.DataTree, *, axes: None = None) -> Figure: ...
@overload
def misalignment(tree: xr.DataTree, *, axes: DrawnAxes) -> None: ...
def misalignment(tree: xr.DataTree, *, axes: AxesChoice = None) -> Figure | None:
    """Misalignment E, P, G and Sigma over the torque, and the centre of the pattern that moves with them.

    Parameters
    ----------
    tree
        A result on supports, or with deflections over the torque.
    axes
        Three Axes: displacements, angle, centre of the pattern; a page of its own if left out. With them
        nothing is returned; ``layout="constrained"`` of their figure makes room.

    Raises
    ------
    InputError
        If ``tree`` is no result, its misalignment does not depend on the torque, or there are not three ``axes``.

    Examples
    --------
    >>> import easeoff
    >>> from easeoff.cases import Deflections
    >>> axle = Deflections([0.0, 200.0], offset=[0.0, 0.05])
    >>> case = easeoff.read_case("nasa-12x36")
    >>> case = case.model_copy(update={"contact": case.contact.model_copy(update={"mesh_positions": 3})})
    >>> tree = easeoff.analyze(case, torques=[100.0], misalignment=axle)
    >>> len(easeoff.plot.misalignment(tree).axes)
    3
    """
    from ..summary.deflection_report import misalignment_over_torque

    require_result(tree)
    if misalignment_over_torque(tree) is None:
        raise InputError(
            "tree: its misalignment does not depend on the torque; give supports, or a table of deflections"
        )
    with drawing(axes):
        from .study_charts import draw_misalignment as draw

        figure = draw(tree, axes)
    return figure if axes is None else None


@overload
def root_stress(
    tree: xr.DataTree,
    *,
    torque: float | Sequence[float] | None = None,
    member: MemberName | None = None,
    parts: str | Sequence[str] | None = None,
    axes: None = None,
) -> Figure: ...
@overload
def root_stress(
    tree: xr.DataTree,
    *,
    torque: float | Sequence[float] | None = None,
    member: MemberName | None = None,
    parts: str | Sequence[str] | None = None,
    axes: DrawnAxes,
) -> None: ...
def root_stress(
    tree: xr.DataTree,
    *,
    torque: float | Sequence[float] | None = None,
    member: MemberName | None = None,
    parts: str | Sequence[str] | None = None,
    axes: AxesChoice = None,
) -> Figure | None:
    """Greatest root stress along the face and over the mesh cycle, of results with finite-element teeth.

    Parameters
    ----------
    tree
        A result of ``analyze`` or ``read_result``.
    torque
        One or several torques of the result at the pinion [N m]; up to six, spread evenly, if left out.
    member
        ``pinion`` or ``gear``; both, side by side, if left out.
    parts
        Rows of panels: ``face``, ``cycle``; both if left out.
    axes
        An Axes a panel, row by row; a page of its own if left out. With them nothing is returned;
        ``layout="constrained"`` of their figure makes room.

    Raises
    ------
    InputError
        If ``tree`` is no result or has no root stress, a name or torque is not known, or ``axes`` are not as many as
        the panels.

    Examples
    --------
    >>> import easeoff
    >>> case = easeoff.read_case("fm-11x41")
    >>> coarse = {"mesh_positions": 3, "segments_per_line": 5, "lengthwise_nodes": 9, "profile_nodes": 7}
    >>> elastic = case.compliance.model_copy(update={"model": "fe", "fineness": 0.3})
    >>> contact = case.contact.model_copy(update=coarse)
    >>> case = case.model_copy(update={"contact": contact, "compliance": elastic})
    >>> tree = easeoff.analyze(case, torques=[100.0])
    >>> len(easeoff.plot.root_stress(tree).axes)
    4
    """
    require_result(tree, "root_stress")
    with drawing(axes):
        from .mesh_cycle_charts import draw_root_stress as draw

        figure = draw(tree, torque, member, parts, axes)
    return figure if axes is None else None


@overload
def deviations(tree: xr.DataTree, *, axes: None = None) -> Figure: ...
@overload
def deviations(tree: xr.DataTree, *, axes: DrawnAxes) -> None: ...
def deviations(tree: xr.DataTree, *, axes: AxesChoice = None) -> Figure | None:
    """Part of the ease-off that the deviations of both flanks add.

    Parameters
    ----------
    tree
        A result of deviating flanks.
    axes
        One Axes to draw in; a page of its own if left out. With them nothing is returned;
        ``layout="constrained"`` of their figure makes room.

    Raises
    ------
    InputError
        If ``tree`` is no result, its flanks do not deviate, or ``axes`` are not as many as the panels.

    Examples
    --------
    >>> import easeoff
    >>> case = easeoff.read_case("fm-11x41")
    >>> contact = case.contact.model_copy(update={"mesh_positions": 3})
    >>> shells = case.compliance.model_copy(update={"model": "shell"})
    >>> case = case.model_copy(update={"contact": contact, "compliance": shells})
    >>> tree = easeoff.analyze(case, torques=[100.0], deviations={"gear": "fm-11x41-worn-gear"})
    >>> len(easeoff.plot.deviations(tree).axes)  # the flank and its colour bar
    2
    """
    require_result(tree)
    if "ease_off_change" not in tree["ease_off"]:
        raise InputError("tree: its flanks have no deviations; give analyze(..., deviations=...)")
    with drawing(axes):
        from .topography_chart import draw_deviations

        figure = draw_deviations(tree, views(tree, "gear")[0], axes)
    return figure if axes is None else None


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
        from .friction_charts import draw_friction_maps as draw

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
        from .friction_charts import draw_efficiency as draw

        figure = draw(tree, parts, axes)
    return figure if axes is None else None


def topography(
    correction: Correction, *, title: str = "", parts: str | Sequence[str] | None = None, axes: AxesChoice = None
) -> Figure:
    """Topographies of measured flanks, before the correction and as predicted after it.

    Every node of the measuring grid stands on the flat sheet of the designed flank, toe on the left and root below;
    its deviation is a line along the normal, upwards where there is more metal. A rotation of the tooth is left out.

    Parameters
    ----------
    correction
        Of ``geometry.corrective_settings`` or ``study.correct_case``.
    title
        Small title of the page.
    parts
        ``before``, ``after`` or both; both if left out. Panels: a row a flank, a column a part.
    axes
        Axes to draw in, one a panel; a page of its own if left out.

    Raises
    ------
    InputError
        If ``correction`` is none, a part is unknown, or ``axes`` are not as many as the panels.

    Examples
    --------
    >>> import easeoff
    >>> case, measured = easeoff.read_case("fm-11x41"), {"gear": "fm-11x41-worn-gear"}
    >>> found = easeoff.study.correct_case(case, measured, free=["machine_root_angle"])
    >>> figure = easeoff.plot.topography(found.corrections["gear"][0])
    >>> len(figure.axes)
    2
    """
    from ...geometry.deviation.corrective_settings import Correction

    if not isinstance(correction, Correction):
        raise InputError(
            f"correction = {type(correction).__name__}: must be a Correction, as corrective_settings gives it"
        )
    with drawing(axes):
        from .topography_chart import draw

        return draw(correction, title, parts, axes)


def write_topographies(
    found: CaseCorrection, folder: str | os.PathLike[str], name: str, *, file_format: str = "png"
) -> list[Path]:
    """Draw all corrections of a case into a folder, a file a set-up: ``NAME-gear-convex-topography.png``.

    The folder is made if it does not exist; pictures of an earlier correction are replaced.
    """
    if file_format not in FORMATS:
        raise InputError(f"format = {file_format!r}: must be one of {', '.join(FORMATS)}")
    from .page import save

    written = []
    for member, corrections in found.corrections.items():
        for correction in corrections:
            title = f"{found.case.title}, {member}"
            figure = topography(correction, title=title)
            sides = "-".join(flank.side for flank in correction.flanks)
            path = Path(folder) / f"{name}-{member}-{sides}-topography.{file_format}"
            written.append(save(figure, path, {"Title": title}))
    return written
