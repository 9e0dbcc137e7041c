"""Pictures of a result as files: which there are, their names, and marks by which earlier ones are known."""

from __future__ import annotations

import hashlib
import json
import os
import re
import warnings
from collections.abc import Callable, Iterator, Sequence
from contextlib import suppress
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
import xarray as xr

from ...contact.evaluation.marking_print import checked_thickness
from ...core.checks import distinct, file_path, one_of, whole
from ...core.errors import InputError, printable
from ...core.netcdf_file import tree_or_none
from ..result import VARIABLES, checked_given, read_result
from ..summary.assembly import misalignment_over_torque
from ..sweep.sweep_file import checked_sweep, is_sweep
from .contact_pattern_chart import contact_pattern
from .friction_charts import efficiency, friction_maps
from .matplotlib_defaults import drawing
from .mesh_cycle_charts import load_sharing, pressure, root_stress, transmission_error
from .page import FORMATS, save
from .panel_grid import chosen_parts, chosen_torques
from .study_charts import front, load_cases, misalignment, vh_check, wear
from .sweep_charts import PICTURES as SWEEP_PICTURES, pictures as pictures_of_sweep, sweep
from .topography_chart import deviations, ease_off, optimization

if TYPE_CHECKING:
    from matplotlib.figure import Figure

Drawing = Callable[..., "Figure"]

#: Pictures of every result.
PICTURES: dict[str, Drawing] = {
    "ease_off": ease_off,
    "contact_pattern": contact_pattern,
    "pressure": pressure,
    "transmission_error": transmission_error,
    "load_sharing": load_sharing,
}
#: Pictures of some results, each with what they have.
FURTHER_PICTURES: dict[str, tuple[Drawing, Callable[[xr.DataTree], bool]]] = {
    "root_stress": (root_stress, lambda tree: "root_stress" in tree.children),
    "friction_maps": (friction_maps, lambda tree: "friction" in tree.children),
    "efficiency": (efficiency, lambda tree: "friction" in tree.children),
    "misalignment": (misalignment, lambda tree: misalignment_over_torque(tree) is not None),
    "deviations": (deviations, lambda tree: "ease_off_change" in tree["ease_off"]),
    "optimization": (optimization, lambda tree: "optimization" in tree.children),
    "front": (front, lambda tree: "front" in tree.children),
}
#: Pictures of what is no result of an analysis, with a variable or group by which it is known.
STUDY_PICTURES: dict[str, tuple[Drawing, str]] = {
    "load_cases": (load_cases, "load_cases"),
    "vh_check": (vh_check, "print_excess"),
    "wear": (wear, "wear_depth"),
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
        return pictures_of_sweep(result)
    groups = result.children if isinstance(result, xr.DataTree) else getattr(result, "data_vars", ())
    for name, (_, sign) in STUDY_PICTURES.items():
        if sign in groups:
            return (name,)
    if not isinstance(result, xr.DataTree) or not VARIABLES.keys() <= {*groups}:
        raise InputError("result: must be of 'easeoff run', 'modify', 'optimize', 'sweep', 'vh' or 'wear'")
    return (*PICTURES, *(name for name, (_, there) in FURTHER_PICTURES.items() if there(result)))


def kind_of(name: str) -> tuple[str, ...]:
    """Names of all pictures of the kind of result that has one of a name."""
    if name.startswith("sweep_"):
        return SWEEP_PICTURES
    return (name,) if name in STUDY_PICTURES else (*PICTURES, *FURTHER_PICTURES)


def draw_picture(
    result: xr.DataTree | xr.Dataset, name: str, *, torque: Sequence[float] | None = None, marking: float | None = None
) -> Figure:
    """Picture of a result on a page of its own, by a name of ``pictures``.

    Maps of friction show the last of the torques [N m]; the marking compound is ``marking`` [um] thick.
    """
    if name.startswith("sweep_"):
        return sweep(result, name)  # type: ignore[arg-type]
    draw = PICTURES.get(name) or (FURTHER_PICTURES.get(name) or STUDY_PICTURES[name])[0]
    options: dict[str, Any] = {}
    if torque is not None and name in WITH_TORQUES:
        options["torque"] = torque[-1] if name == "friction_maps" else torque
    if name == "contact_pattern":
        options["marking"] = marking
    return draw(result, **options)


FLANKS = ("drive", "coast")
DPI_MINIMUM, DPI_LIMIT = 30, 1200


def write_pictures(
    result: xr.DataTree | xr.Dataset,
    folder: str | os.PathLike[str],
    *,
    names: str | Sequence[str] | None = None,
    torque: float | Sequence[float] | None = None,
    flank: str | None = None,
    marking: float | None = None,
    file_format: str = "png",
    dpi: int | None = None,
) -> list[Path]:
    """Draw pictures of a result into a folder.

    A file is named after case, flank and picture, as in ``fm-11x41-drive-pressure.png``. Pictures of an earlier result
    with the same case and flank are replaced or removed: nothing stays that could be taken for a picture of this one.
    Other files are left alone. Of load cases, each has its pictures in a folder of its name.

    Parameters
    ----------
    result
        Of ``analyze``, ``modify``, ``optimize``, ``sweep``, ``study.analyze_load_cases``, ``study.vh_check`` or
        ``study.wear``, or what ``read_result`` and ``study.sweep.read_sweep`` read.
    folder
        The folder; made if it does not exist.
    names
        One or several names of pictures, see ``pictures``; all if left out.
    torque
        One or several torques of the result at the pinion [N m], for the pictures that show torques.
    flank
        ``drive`` or ``coast``, of load cases or sweeps with both; all if left out.
    marking
        Thickness of the marking compound of the unloaded print [um]; that of the result if left out.
    file_format
        ``png``, ``svg`` or ``pdf``.
    dpi
        Dots per inch of PNG files; 160 if left out.

    Returns
    -------
    list of Path
        The files.

    Raises
    ------
    InputError
        If the result does not have a picture, torque or flank, a number is out of range, or the folder cannot be
        written to.

    Examples
    --------
    >>> import easeoff
    >>> from tempfile import TemporaryDirectory
    >>> tree = easeoff.analyze("nasa-12x36", torques=[100.0])
    >>> with TemporaryDirectory() as folder:
    ...     [path.name for path in write_pictures(tree, folder, names=["ease_off", "pressure"])]
    ['nasa-12x36-drive-ease_off.png', 'nasa-12x36-drive-pressure.png']
    """
    one_of("format", file_format, FORMATS)
    if dpi is not None:
        dpi = whole("dpi", dpi, DPI_MINIMUM, DPI_LIMIT)
    if marking is not None:
        checked_thickness(marking)
    torques = None if torque is None else distinct("torque", torque, "N m").tolist()
    parts = list(_parts(result, file_path("folder", folder), flank))
    written: list[Path] = []
    with drawing(None):  # which loads the drawing library without a configuration of this folder
        chosen = _chosen([one for one, _ in parts], names, torques)
        for (one, place), picture_names in zip(parts, chosen, strict=True):
            for name in picture_names:
                figure = draw_picture(one, name, torque=torques, marking=marking)
                if dpi is not None:
                    figure.set_dpi(dpi)
                path = place / f"{file_prefix(one)}-{name}.{file_format}"
                marks = {"Source": f"{SOURCE}, {result_mark(one)}", "Title": printable(str(one.attrs.get("title", "")))}
                written.append(save(figure, path, marks))
    for one, place in parts:
        _remove_earlier(one, place, written)
    return written


def _parts(
    result: xr.DataTree | xr.Dataset, folder: Path, flank: str | None
) -> Iterator[tuple[xr.DataTree | xr.Dataset, Path]]:
    """Results to draw, each with its folder: a result and those of its load cases, or those of one flank alone."""
    if flank is not None:
        one_of("flank", flank, FLANKS)
    if isinstance(result, xr.Dataset) and "flank" in result.dims:
        there = [str(name) for name in result["flank"].values]
        yield (result if flank is None else result.isel(flank=[_number(there, flank)])), folder
        return
    if isinstance(result, xr.DataTree) and "load_cases" in result.children:
        cases = result["results"].children.items() if "results" in result.children else ()
        there = [str(tree.attrs.get("flank", "")) for _, tree in cases]
        if flank is not None:
            _number(there, flank)
        else:
            yield result, folder
        yield from ((tree, folder / name) for name, tree in cases if flank in (None, tree.attrs.get("flank")))
        return
    if flank is not None:
        _number([str(result.attrs.get("flank", ""))], flank)
    yield result, folder


def _number(there: Sequence[str], flank: str) -> int:
    """Number of a flank among those that are there."""
    if flank not in there:
        raise InputError(f"flank = {flank!r}: must be one of the result's: {', '.join(sorted(set(there)))}")
    return list(there).index(flank)


def _chosen(
    results: Sequence[xr.DataTree | xr.Dataset], names: str | Sequence[str] | None, torques: Sequence[float] | None
) -> list[tuple[str, ...]]:
    """Names of the pictures of each result; those that are asked for if one has them, before anything is drawn."""
    there = [pictures(one) for one in results]
    known = tuple(dict.fromkeys(name for picture_names in there for name in picture_names))
    wanted = chosen_parts(known, names, "pictures")
    if torques is not None:
        _require_torques(results, torques)
        if names is not None and not set(wanted) & set(WITH_TORQUES):
            raise InputError(f"torque: must go with one of the pictures {', '.join(WITH_TORQUES)}")
    return [tuple(name for name in wanted if name in picture_names) for picture_names in there]


def _require_torques(results: Sequence[xr.DataTree | xr.Dataset], torques: Sequence[float]) -> None:
    """Refuse torques for what has none to choose, and those that a result does not have."""
    trees = [one for one in results if isinstance(one, xr.DataTree) and "loaded" in one.children]
    if len(trees) != len(results):
        raise InputError("torque: must go with a result of 'easeoff run' without load cases")
    for tree in trees:
        chosen_torques(tree["loaded"].to_dataset()["torque"].values, torques)


def _remove_earlier(result: xr.DataTree | xr.Dataset, folder: Path, written: Sequence[Path]) -> None:
    """Remove the pictures of an earlier result of the same kind, case and flank."""
    prefix, mark = f"{file_prefix(result)}-", result_mark(result)
    kind = kind_of(pictures(result)[0])
    for path, (_, picture_mark) in pictures_of_results(folder).items():
        earlier = path.name.startswith(prefix) and path.stem.removeprefix(prefix) in kind and picture_mark != mark
        if earlier and path not in written:
            with suppress(OSError):
                path.unlink()


def read_drawn(path: str | os.PathLike[str]) -> xr.DataTree | xr.Dataset:
    """Read a file of ``easeoff run``, ``modify``, ``optimize``, ``sweep``, ``vh`` or ``wear``."""
    tree = tree_or_none(path)
    if tree is None:
        return read_result(path)  # says what is wrong with the file
    if is_sweep(dataset := tree.to_dataset()):
        return checked_sweep(dataset, path)
    return checked_given(tree, Path(path))


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
