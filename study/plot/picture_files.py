"""Picture files of results: their names, and marks by which those of an earlier result are known."""

from __future__ import annotations

import hashlib
import json
import os
import re
import warnings
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np
import xarray as xr

from ...core.errors import printable

if TYPE_CHECKING:
    from matplotlib.figure import Figure

FORMATS = ("png", "svg", "pdf")
SOURCE = "easeoff: picture of a result"
MARK_LENGTH = 16  # [characters]
PREFIX_LENGTH_LIMIT = 80  # of the name of a case in the names of files [characters]
MARKED_SIZE_LIMIT = 50_000_000  # of a file that may be a picture of a result [byte]
_MARK = re.compile(rf"{SOURCE}, ([0-9a-f]{{{MARK_LENGTH}}})")


def file_prefix(result: xr.DataTree | xr.Dataset) -> str:
    """Begin of the names of a result's pictures: case, or numbers of teeth in an older result, and flank."""
    attributes = result.attrs
    teeth = (
        f"{attributes['pinion_teeth']}x{attributes['gear_teeth']}"
        if {"pinion_teeth", "gear_teeth"} <= attributes.keys()
        else "result"
    )
    name = re.sub(r"[^\w.-]+", "_", str(attributes.get("case_name", "")))[:PREFIX_LENGTH_LIMIT].strip("._-") or teeth
    swept = result.coords.get("flank") if isinstance(result, xr.Dataset) else None
    flank = str(attributes.get("flank", "") if swept is None else swept.values.item() if swept.size == 1 else "")
    return f"{name}-{flank}" if flank in ("drive", "coast") else name


def result_mark(result: xr.DataTree | xr.Dataset) -> str:
    """Mark of a result: the same for the same case, options, torques and groups, whenever it was computed."""
    attributes = {str(key): np.asarray(value).tolist() for key, value in result.attrs.items() if key != "history"}
    groups = sorted(result.children) if isinstance(result, xr.DataTree) else sorted(map(str, result.sizes.items()))
    loads = result["loaded"]["torque"] if "loaded" in groups else result.coords.get("torque", xr.DataArray([]))
    text = json.dumps([attributes, groups, np.asarray(loads).tolist()], sort_keys=True, default=str)
    return hashlib.sha256(text.encode("utf-8", "backslashreplace")).hexdigest()[:MARK_LENGTH]


def save_picture(figure: Figure, path: Path, result: xr.DataTree | xr.Dataset) -> Path:
    """Write a picture of a result, marked with the result and the title of its case; returns and raises as ``save``."""
    from .page import save

    title = printable(str(result.attrs.get("title", "")))
    return save(figure, path, {"Source": f"{SOURCE}, {result_mark(result)}", "Title": title})


def pictures_of_results(folder: str | os.PathLike[str]) -> dict[Path, tuple[str, str]]:
    """Pictures in a folder: the titles of their cases, known of PNG files alone, and the marks of the results."""
    pictures = {}
    for path in sorted(Path(folder).iterdir()) if os.path.isdir(folder) else []:
        if path.suffix[1:] not in FORMATS or not path.is_file():
            continue
        title, source = _png_marks(path) if path.suffix == ".png" else ("", _text_source(path))
        mark = _MARK.fullmatch(source)
        if mark is not None:
            pictures[path] = (title, mark[1])
    return pictures


def _png_marks(path: Path) -> tuple[str, str]:
    """Title and source of a PNG file; empty if it is none, or damaged."""
    from PIL import Image

    try:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")
            with Image.open(path) as image:
                return str(image.info.get("Title", "")), str(image.info.get("Source", ""))
    except Exception:  # no picture, or a damaged or hostile one
        return "", ""


def _text_source(path: Path) -> str:
    """Source of an SVG or PDF file, where it stands as text; empty if it has none."""
    try:
        if path.stat().st_size > MARKED_SIZE_LIMIT:
            return ""
        mark = _MARK.search(path.read_text(encoding="latin-1"))
    except OSError:
        return ""
    return mark[0] if mark else ""
