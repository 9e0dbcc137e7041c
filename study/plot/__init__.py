"""Plots of a result: ease-off, contact, transmission error, load sharing, friction, efficiency, misalignment."""

from __future__ import annotations

import os
from contextlib import suppress
from pathlib import Path
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    import xarray as xr

__all__ = ["FRICTION_PICTURES", "MISALIGNMENT_PICTURES", "PICTURES", "write_pictures"]

PICTURES = ("ease_off", "contact_pattern", "pressure", "transmission_error", "load_sharing")
"""Names of the pictures of every result; each is written as ``<name>.png``."""

FRICTION_PICTURES = ("friction_maps", "efficiency")
"""Names of the further pictures of a result with friction."""

MISALIGNMENT_PICTURES = ("misalignment",)
"""Names of the further pictures of a result whose misalignment depends on the torque."""


def write_pictures(tree: xr.DataTree, folder: str | os.PathLike[str], *, marking: float | None = None) -> list[Path]:
    """Draw every picture of a result.

    Pictures of another result in the folder are replaced, and those that this result does not have are removed: nothing
    stays there that could be taken for a picture of this result. Other files are left alone.

    Parameters
    ----------
    tree
        A result of ``analyze`` or ``read_result``.
    folder
        Folder for the PNG files; made if it does not exist.
    marking
        Thickness of the marking compound of the unloaded print [um]; that of the result if left out.

    Returns
    -------
    list of Path
        The files, in the order of ``PICTURES``, of ``FRICTION_PICTURES`` if the result has friction, and of
        ``MISALIGNMENT_PICTURES`` if its misalignment depends on the torque.

    Raises
    ------
    InputError
        If the folder cannot be written to, or the thickness is out of range.

    Examples
    --------
    >>> import easeoff
    >>> from tempfile import TemporaryDirectory
    >>> tree = easeoff.analyze("nasa-12x36", torques=[100.0])
    >>> with TemporaryDirectory() as folder:
    ...     [path.stem for path in write_pictures(tree, folder)]
    ['ease_off', 'contact_pattern', 'pressure', 'transmission_error', 'load_sharing']
    """
    from ...core.compiled.compiled_use import without_compiled_code
    from .drawing_style import default_style

    with default_style(), without_compiled_code():  # a drawing needs too little of it to load it for
        return _written(tree, Path(folder), marking)


def _written(tree: xr.DataTree, folder: Path, marking: float | None) -> list[Path]:
    # The drawing library is slow to load, and most of what imports this package never draws.
    from ...contact.evaluation.marking_print import checked_thickness
    from ..report.deflection_report import misalignment_over_torque
    from . import contact_pattern_chart, friction_maps, misalignment_chart
    from . import ease_off_map as ease_off
    from . import efficiency_chart as efficiency
    from . import load_share_chart as load_sharing
    from . import pressure_chart as pressure
    from . import transmission_error_chart as transmission_error
    from .picture_files import pictures_of_results, save_picture
    from .tooth_view import tooth_view

    if marking is not None:
        checked_thickness(marking)
    view, pinion = tooth_view(tree), tooth_view(tree, "pinion")
    names, figures = (
        list(PICTURES),
        [
            ease_off.draw(tree, view),
            contact_pattern_chart.draw(tree, (view, pinion), marking),
            pressure.draw(tree, (view, pinion)),
            transmission_error.draw(tree),
            load_sharing.draw(tree),
        ],
    )
    if "friction" in tree.children:
        names += FRICTION_PICTURES
        figures += [friction_maps.draw(tree, view), efficiency.draw(tree)]
    if misalignment_over_torque(tree) is not None:
        names += MISALIGNMENT_PICTURES
        figures.append(misalignment_chart.draw(tree))
    written = [save_picture(figure, folder / f"{name}.png", tree) for name, figure in zip(names, figures, strict=True)]
    for stale in pictures_of_results(folder).keys() - set(written):
        with suppress(OSError):
            stale.unlink()
    return written
