"""Picture files of results: marked as such, so that those of another result are known and do not stay."""

from __future__ import annotations

import os
from pathlib import Path
from typing import TYPE_CHECKING

import xarray as xr

if TYPE_CHECKING:
    from matplotlib.figure import Figure

SOURCE = "easeoff: picture of a result"


def save_picture(figure: Figure, path: Path, tree: xr.DataTree) -> Path:
    """Write a picture of a result, marked with the title of its case. Returns and raises as ``page.save``."""
    from .page import save  # loads the drawing library

    return save(figure, path, {"Source": SOURCE, "Title": str(tree.attrs.get("title", ""))})


def pictures_of_results(folder: str | os.PathLike[str]) -> dict[Path, str]:
    """Pictures of results in a folder, and the titles of their cases; other files are left out.

    Examples
    --------
    >>> pictures_of_results("no such folder")
    {}
    """
    from PIL import Image, UnidentifiedImageError

    found = {}
    for path in sorted(Path(folder).glob("*.png")) if os.path.isdir(folder) else []:
        try:
            with Image.open(path) as image:
                marks = dict(image.info)
        except (OSError, SyntaxError, ValueError, UnidentifiedImageError):
            continue  # no picture
        if marks.get("Source") == SOURCE:
            found[path] = str(marks.get("Title", ""))
    return found
