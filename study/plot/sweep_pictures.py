"""Pictures of a sweep: which there are, and their files."""

from __future__ import annotations

import os
from contextlib import suppress
from pathlib import Path

import xarray as xr

#: Names of the pictures of a sweep; which are drawn depends on what is swept.
SWEEP_PICTURES = ("sweep_map", "sweep_curves", "sweep_pattern", "sweep_histograms", "sweep_tornado")


def write_sweep_pictures(dataset: xr.Dataset, folder: str | os.PathLike[str]) -> list[Path]:
    """Draw the pictures of a sweep.

    A map of the main numbers over two swept grids, or curves over one; the shift of the contact pattern; histograms of
    samples; and a tornado chart of the sensitivities. Pictures of other results in the folder are removed.

    Parameters
    ----------
    dataset
        From ``sweep`` or ``read_sweep``.
    folder
        Folder for the PNG files; made if it does not exist.

    Returns
    -------
    list of Path
        The files.

    Raises
    ------
    InputError
        If the folder cannot be written to, or no point of the sweep has numbers.

    Examples
    --------
    >>> import easeoff
    >>> from tempfile import TemporaryDirectory
    >>> found = easeoff.sweep("nasa-12x36", {"E": [0.0, 0.05]}, torques=[100.0])
    >>> with TemporaryDirectory() as folder:
    ...     [path.stem for path in write_sweep_pictures(found, folder)]
    ['sweep_curves', 'sweep_pattern']
    """
    from .drawing_style import default_style

    with default_style():
        from . import sweep_chart
        from .picture_files import pictures_of_results, save_picture

        tree = xr.DataTree(dataset)
        figures = sweep_chart.figures(dataset)
        written = [save_picture(figure, Path(folder) / f"{name}.png", tree) for name, figure in figures.items()]
        for stale in pictures_of_results(folder).keys() - set(written):
            with suppress(OSError):
                stale.unlink()
    return written
