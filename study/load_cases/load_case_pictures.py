"""Pictures of an analysis over load cases: one of all of them, and a folder with the pictures of each."""

from __future__ import annotations

import os
from pathlib import Path

import xarray as xr

from ..plot import write_pictures
from ..plot.drawing_style import default_style
from ..plot.picture_files import save_picture

OVERVIEW = "load_cases"


def write_load_case_pictures(
    tree: xr.DataTree, folder: str | os.PathLike[str], *, marking: float | None = None
) -> list[Path]:
    """Draw ``load_cases.png``, and the pictures of each load case into a folder of its name.

    Parameters
    ----------
    tree
        Of ``analyze_load_cases``.
    folder, marking
        As of ``write_pictures``.

    Returns
    -------
    list of Path
        The files.

    Raises
    ------
    InputError
        As ``write_pictures``.

    Examples
    --------
    >>> from tempfile import TemporaryDirectory
    >>> from easeoff.cases import LoadCase
    >>> from easeoff.study import analyze_load_cases
    >>> tree = analyze_load_cases("nasa-12x36", [LoadCase(name="climb", torque=300.0)])
    >>> with TemporaryDirectory() as folder:
    ...     [path.relative_to(folder).as_posix() for path in write_load_case_pictures(tree, folder)][:2]
    ['load_cases.png', 'climb/ease_off.png']
    """
    with default_style():
        from .load_case_chart import draw  # loads the drawing library

        written = [save_picture(draw(tree), Path(folder) / f"{OVERVIEW}.png", tree)]
    for name, result in tree["results"].children.items():
        written += write_pictures(result, Path(folder) / name, marking=marking)
    return written
