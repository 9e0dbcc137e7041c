"""Picture of a V-H check as a file."""

from __future__ import annotations

import os
from pathlib import Path

import xarray as xr

from ..plot.drawing_style import default_style
from ..plot.picture_files import save_picture

NAME = "vh_check"


def write_vh_picture(found: xr.Dataset, folder: str | os.PathLike[str]) -> Path:
    """Draw a V-H check into a folder, as ``vh_check.png``; returns the path.

    Parameters
    ----------
    found
        Of ``study.vh_check``.
    folder
        The folder; made if it does not exist.

    Raises
    ------
    InputError
        If the file cannot be written.

    Examples
    --------
    >>> from tempfile import TemporaryDirectory
    >>> from easeoff.study import vh_check
    >>> with TemporaryDirectory() as folder:
    ...     write_vh_picture(vh_check("fh-design-a"), folder).name
    'vh_check.png'
    """
    with default_style():
        from .vh_chart import draw  # loads the drawing library

        return save_picture(draw(found), Path(folder) / f"{NAME}.png", xr.DataTree(found))
