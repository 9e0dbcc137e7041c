"""Picture files of results: marked as such, so that those of another result are known and do not stay."""

from __future__ import annotations

import os
import warnings
from pathlib import Path
from typing import TYPE_CHECKING

import xarray as xr

from ...core.printable import printable

if TYPE_CHECKING:
    from matplotlib.figure import Figure

SOURCE = "easeoff: picture of a result"


def save_picture(figure: Figure, path: Path, tree: xr.DataTree) -> Path:
    """Write a picture of a result, marked with the title of its case. Returns and raises as ``page.save``."""
    from .page import save  # loads the drawing library

    return save(figure, path, {"Source": SOURCE, "Title": printable(str(tree.attrs.get("title", "")))})


def pictures_of_results(folder: str | os.PathLike[str]) -> dict[Path, str]:
    """Pictures of results in a folder, and the titles of their cases; other files are left out.

    Examples
    --------
    >>> pictures_of_results("no such folder")
    {}
    """
    from PIL import Image

    found = {}
    for path in sorted(Path(folder).glob("*.png")) if os.path.isdir(folder) else []:
        try:
            with warnings.catch_warnings():
                warnings.simplefilter("ignore")
                with Image.open(path) as image:
                    marks = dict(image.info)
        except Exception:  # no picture, or a damaged or hostile one
            continue
        if marks.get("Source") == SOURCE:
            found[path] = str(marks.get("Title", ""))
    return found
