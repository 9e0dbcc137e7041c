"""Pictures of a result: which there are, and the function that draws each."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import TYPE_CHECKING, Any

import xarray as xr

from ....core.errors import InputError
from ...report.summary.deflection_report import misalignment_over_torque
from ...result_layout import VARIABLES
from . import contact_figures, friction_figures, study_figures

if TYPE_CHECKING:
    from matplotlib.figure import Figure

Drawing = Callable[..., "Figure"]

#: Pictures of every result.
PICTURES: dict[str, Drawing] = {
    "ease_off": contact_figures.ease_off,
    "contact_pattern": contact_figures.contact_pattern,
    "pressure": contact_figures.pressure,
    "transmission_error": contact_figures.transmission_error,
    "load_sharing": contact_figures.load_sharing,
}
#: Pictures of some results, each with what they have.
FURTHER_PICTURES: dict[str, tuple[Drawing, Callable[[xr.DataTree], bool]]] = {
    "root_stress": (contact_figures.root_stress, lambda tree: "root_stress" in tree.children),
    "friction_maps": (friction_figures.friction_maps, lambda tree: "friction" in tree.children),
    "efficiency": (friction_figures.efficiency, lambda tree: "friction" in tree.children),
    "misalignment": (contact_figures.misalignment, lambda tree: misalignment_over_torque(tree) is not None),
    "deviations": (contact_figures.deviations, lambda tree: "ease_off_change" in tree["ease_off"]),
    "optimization": (study_figures.optimization, lambda tree: "optimization" in tree.children),
    "front": (study_figures.front, lambda tree: "front" in tree.children),
}
#: Pictures of what is no result of an analysis, with a variable or group by which it is known.
STUDY_PICTURES: dict[str, tuple[Drawing, str]] = {
    "load_cases": (study_figures.load_cases, "load_cases"),
    "vh_check": (study_figures.vh_check, "print_excess"),
    "wear": (study_figures.wear, "wear_depth"),
}
#: Those that take torques; ``friction_maps`` takes one.
WITH_TORQUES = ("pressure", "transmission_error", "load_sharing", "root_stress", "friction_maps")


def pictures(result: xr.DataTree | xr.Dataset) -> tuple[str, ...]:
    """Names of the pictures that a result has.

    Parameters
    ----------
    result
        Of ``analyze``, ``modify``, ``optimize``, ``sweep``, ``study.analyze_load_cases``, ``study.vh_check`` or
        ``study.wear``, or what ``read_result`` and ``study.sweep.read_sweep`` read.

    Raises
    ------
    InputError
        If it is none of these, or a sweep without a point that has numbers.

    Examples
    --------
    >>> import easeoff
    >>> tree = easeoff.analyze("nasa-12x36", torques=[100.0])
    >>> pictures(tree)
    ('ease_off', 'contact_pattern', 'pressure', 'transmission_error', 'load_sharing')
    """
    if isinstance(result, xr.Dataset) and "swept" in result.attrs:
        from ..charts.sweep_chart import pictures as of_sweep

        return of_sweep(result)
    held = result.children if isinstance(result, xr.DataTree) else getattr(result, "data_vars", ())
    for name, (_, sign) in STUDY_PICTURES.items():
        if sign in held:
            return (name,)
    if not isinstance(result, xr.DataTree) or not VARIABLES.keys() <= {*held}:
        raise InputError("result: must be of 'easeoff run', 'modify', 'optimize', 'sweep', 'vh' or 'wear'")
    return (*PICTURES, *(name for name, (_, there) in FURTHER_PICTURES.items() if there(result)))


def kind_of(name: str) -> tuple[str, ...]:
    """Names of all pictures of the kind of result that has one of a name.

    Examples
    --------
    >>> kind_of("wear")
    ('wear',)
    """
    if name.startswith("sweep_"):
        from ..charts.sweep_chart import PICTURES as OF_SWEEPS

        return OF_SWEEPS
    return (name,) if name in STUDY_PICTURES else (*PICTURES, *FURTHER_PICTURES)


def draw_picture(
    result: xr.DataTree | xr.Dataset,
    name: str,
    *,
    torque: Sequence[float] | None = None,
    marking: float | None = None,
) -> Figure:
    """A picture of a result on a page of its own, by its name.

    Parameters
    ----------
    result, name
        A result, and a name of ``pictures``.
    torque
        Torques at the pinion [N m], for pictures that take them; the friction maps show the last one.
    marking
        Thickness of the marking compound of the contact pattern [um].

    Raises
    ------
    InputError
        As the function that draws the picture.
    """
    if name.startswith("sweep_"):
        return study_figures.sweep(result, name)  # type: ignore[arg-type]
    draw = PICTURES.get(name) or (FURTHER_PICTURES.get(name) or STUDY_PICTURES[name])[0]
    options: dict[str, Any] = {}
    if torque is not None and name in WITH_TORQUES:
        options["torque"] = torque[-1] if name == "friction_maps" else torque
    if name == "contact_pattern":
        options["marking"] = marking
    return draw(result, **options)
