"""Accessors ``easeoff`` of trees and datasets of xarray: what one does with a result or a sweep in a notebook.

Tables of pandas in the units in which people read them, and short summaries as HTML.
"""

from __future__ import annotations

import inspect
import math
import os
import warnings
from collections.abc import Callable
from functools import cached_property, partial, update_wrapper
from importlib import import_module
from itertools import product
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
import xarray as xr

from ...core.errors import InputError, suggestion
from ...core.netcdf_file import in_memory
from ..analysis.key_numbers import key_numbers
from ..report.report_tables import FIRST_PATHS, loaded_numbers
from ..result import CONDITIONS, PATTERN, VARIABLES, faults, load_case_faults
from ..summary import sweep_report
from ..summary.assembly import ERRORS, SHARES, bearing_loads, deflection_tables, mean_misalignment, supports_tables
from ..summary.load_case_summary import load_case_notes, load_case_summary, load_case_tables
from ..summary.result_summary import contact_temperatures, efficiency_table, head_rows, result_notes, unloaded_rows
from ..summary.table import html_table, html_text, left_out
from ..sweep.reductions import LOADS, numbers, percentiles, point_dimensions, sensitivities, worst_points
from ..sweep.sweep_file import is_sweep, sweep_faults, write_sweep

if TYPE_CHECKING:
    import pandas as pd
    from matplotlib.figure import Figure

    from ...cases import Case

FAULT_COUNT_LIMIT = 3  # that a message names


class ShownSummary:
    """Summary that a terminal shows as text."""

    text: Any  # as a string

    def __str__(self) -> str:
        return str(self.text)

    __repr__ = __str__


class ShownPictures:
    """Pictures by their names, as methods."""

    kind = ""  # of what is drawn

    def __repr__(self) -> str:
        return f"pictures of a {self.kind}: {', '.join(dir(self))}"

    def __getattr__(self, name: str) -> Callable[..., Any]:
        if name.startswith("_"):
            raise AttributeError(name)
        there = dir(self)
        if name not in there:
            known = ", ".join(there)
            raise AttributeError(f"there is no picture {name!r}; there are: {known}{suggestion(name, there)}")
        return self._bound(name)

    def _bound(self, name: str) -> Callable[..., Any]:
        """Picture of a name."""
        raise NotImplementedError


class ShownContent:
    """Content of a dataset or tree: a notebook shows its summary, or what is wrong with it."""

    def summary(self) -> Any:
        """Summary of the content; InputError if it is none."""
        raise NotImplementedError

    def __repr__(self) -> str:
        try:
            return str(self.summary().text)
        except InputError as error:
            return str(error)

    def _repr_html_(self) -> str | None:
        try:
            page: str = self.summary()._repr_html_()
        except InputError:
            return None  # a notebook shows the text instead
        return page


class ResultSummary(ShownSummary):
    """Summary of a result: printed it is the text of ``easeoff show``, in a notebook a short page.

    Parameters
    ----------
    tree
        A result.

    Examples
    --------
    >>> import easeoff
    >>> summary = easeoff.analyze("nasa-12x36", torques=[100.0]).easeoff.summary()
    >>> str(summary).splitlines()[3]
    'pair          12 x 36, left-hand pinion, drive flanks'
    >>> summary.tables["loaded"]["peak_to_peak [urad]"].round().tolist()
    [221.0]
    """

    def __init__(self, tree: xr.DataTree) -> None:
        self._tree = tree

    @cached_property
    def text(self) -> str:
        """The text of ``easeoff show``."""
        if "load_cases" in self._tree.children:
            return load_case_summary(self._tree)
        from ..summary.result_summary import result_summary

        return result_summary(self._tree)

    @cached_property
    def tables(self) -> dict[str, pd.DataFrame]:
        """Key numbers as tables of pandas: ``unloaded``, ``misalignment``, ``supports``, ``loaded``, ``friction``.

        Misalignment, supports and friction are there if the result has them; of load cases there is ``load_cases``
        alone. A column bears the name of its variable and the unit in which people read it: angles are in degrees,
        torques in N m. The result itself keeps rad and N mm. ``tables["loaded"].T`` has a row a number.
        """
        return summary_frames(self._tree)

    def _repr_html_(self) -> str:
        return result_page(self._tree)


class ResultPlots(ShownPictures):
    """Pictures of a result: every function of ``easeoff.plot`` that takes one, as a method.

    Parameters
    ----------
    tree
        A result.

    Examples
    --------
    >>> import easeoff
    >>> "pressure" in dir(easeoff.analyze("nasa-12x36", torques=[100.0]).easeoff.plot)
    True
    """

    kind = "result"

    def __init__(self, tree: xr.DataTree) -> None:
        self._tree = tree

    def __dir__(self) -> list[str]:
        return sorted(_pictures())

    def _bound(self, name: str) -> Callable[..., Any]:
        function = _pictures()[name]
        bound = update_wrapper(partial(function, self._tree), function)
        signature = inspect.signature(function)
        others = list(signature.parameters.values())[1:]
        bound.__signature__ = signature.replace(parameters=others)  # type: ignore[attr-defined]
        del bound.__wrapped__
        return bound


def _pictures() -> dict[str, Callable[..., Any]]:
    """Functions of ``easeoff.plot`` that take a result first."""
    plot = import_module("easeoff").plot
    functions = {name: getattr(plot, name) for name in plot.__all__}
    return {
        name: function
        for name, function in functions.items()
        if inspect.isfunction(function) and next(iter(inspect.signature(function).parameters), "") in ("tree", "result")
    }


class ResultAccessor(ShownContent):
    """Tables, summary and pictures of a result in a notebook: ``tree.easeoff`` of every ``xarray.DataTree``.

    Every method raises ``InputError`` if the tree is no result of ``analyze``, ``modify``, ``optimize``,
    ``study.analyze_load_cases`` or ``read_result``.

    Parameters
    ----------
    tree
        The tree.

    Examples
    --------
    >>> import easeoff
    >>> tree = easeoff.analyze("nasa-12x36", torques=[100.0])
    >>> tree.easeoff.case.gear.number_of_teeth
    36
    >>> tree["loaded"].easeoff.summary()
    Traceback (most recent call last):
    easeoff.core.errors.InputError: tree = '/loaded': must be a whole result; this is a group of one: take tree.root
    """

    def __init__(self, tree: xr.DataTree) -> None:
        self._tree = tree

    def summary(self) -> ResultSummary:
        """Main numbers as text, as tables of pandas, and in a notebook as a short page.

        Examples
        --------
        >>> import easeoff
        >>> summary = easeoff.analyze("nasa-12x36", torques=[100.0]).easeoff.summary()
        >>> list(summary.tables)
        ['unloaded', 'loaded']
        """
        return ResultSummary(self._result())

    def report(self, path: str | os.PathLike[str]) -> Path:
        """Write the report, one HTML file that needs no network, and return its path; see ``study.write_report``.

        Parameters
        ----------
        path
            File to write, replaced if it exists; missing folders are made.

        Examples
        --------
        >>> import easeoff
        >>> from tempfile import TemporaryDirectory
        >>> with TemporaryDirectory() as folder:
        ...     easeoff.analyze("nasa-12x36", torques=[100.0]).easeoff.report(f"{folder}/report.html").name
        'report.html'
        """
        from ..report.report_file import write_report

        write_report(self._result(), path)
        return Path(path)

    def save(self, path: str | os.PathLike[str]) -> Path:
        """Write the result to a netCDF-4 file and return its path; see ``write_result``.

        Parameters
        ----------
        path
            File to write, replaced if it exists; missing folders are made.

        Examples
        --------
        >>> import easeoff
        >>> from tempfile import TemporaryDirectory
        >>> tree = easeoff.analyze("nasa-12x36", torques=[100.0])
        >>> with TemporaryDirectory() as folder:
        ...     easeoff.read_result(tree.easeoff.save(f"{folder}/nasa.nc")).identical(tree)
        True
        """
        from ..result import write_result

        write_result(self._result(), path)
        return Path(path)

    @property
    def plot(self) -> ResultPlots:
        """Pictures: ``tree.easeoff.plot.pressure(...)`` is ``easeoff.plot.pressure(tree, ...)``, and so on."""
        return ResultPlots(self._result())

    @property
    def case(self) -> Case:
        """The case that the result keeps, as it was read.

        What names files elsewhere, such as that of an oil, is left out with a warning if they are not found from the
        working folder.
        """
        from ...cases import parse_case
        from ..report.contact_mesh import stored_case

        tree = self._result()
        try:
            return parse_case(str(tree.attrs.get("case", "")), "the case of the result")
        except InputError as error:
            reason = " ".join(str(error).split())
        case = stored_case(tree)
        if case is None:
            raise InputError(f"case of the result: {reason}")
        warnings.warn(f"friction and load cases of the case are left out: {reason}", UserWarning, stacklevel=2)
        return case

    def _result(self) -> xr.DataTree:
        """The tree, if it is a result, with all values in memory."""
        tree = self._tree
        known = "easeoff_version" in tree.attrs
        if not known and "easeoff_version" in tree.root.attrs:
            raise InputError(f"tree = {tree.path!r}: must be a whole result; this is a group of one: take tree.root")
        tree = in_memory(tree)
        defects = load_case_faults(tree) if "load_cases" in tree.children else faults(tree)
        if not known or defects == [f"no group {name}" for name in VARIABLES]:
            name = f"tree = {str(tree.name or tree.path)!r}"
            raise InputError(f"{name}: must be a result of easeoff.analyze, modify, optimize or easeoff.read_result")
        if defects:
            raise InputError(f"tree: damaged or changed: {'; '.join(defects[:FAULT_COUNT_LIMIT])}")
        return tree


TORQUE = "torque [N m]"
#: Units of the data that nobody reads, and what they are shown in: unit and factor.
READ_UNITS = {
    "rad": ("deg", math.degrees(1.0)),
    "N mm": ("N m", 1e-3),
    "rpm": ("1/min", 1.0),
    "1": ("", 1.0),
    "": ("", 1.0),
}


def summary_frames(tree: xr.DataTree) -> dict[str, pd.DataFrame]:
    """Key numbers of a result by table; a column bears the name of its variable and the unit.

    A row a torque [N m], operating condition or load case; the rows of ``misalignment`` are means over the mesh cycle.
    """
    if "load_cases" in tree.children:
        return {"load_cases": frame_over(tree["load_cases"].to_dataset(), ("load_case",))}
    numbers = key_numbers(tree)
    parts: dict[str, list[str]] = {"unloaded": [], "loaded": [], "friction": []}
    for name, variable in numbers.data_vars.items():
        part = "friction" if "speed" in variable.dims else "loaded" if "torque" in variable.dims else "unloaded"
        parts[part].append(str(name))
    indices: dict[str, tuple[str, ...]] = {"unloaded": (), "loaded": CONDITIONS[:1], "friction": CONDITIONS}
    frames = {part: frame_over(numbers[names], indices[part]) for part, names in parts.items() if names}
    assembly = {"misalignment": _misalignment(tree), "supports": _supports(tree)}
    assembly_frames = {part: frame for part, frame in assembly.items() if frame is not None}
    return {"unloaded": frames.pop("unloaded")} | assembly_frames | frames


def _misalignment(tree: xr.DataTree) -> pd.DataFrame | None:
    """E, P, G and Sigma over the torque; ``None`` if they do not depend on it."""
    import pandas as pd

    course = mean_misalignment(tree)
    if course is None:
        return None
    heads = [f"{error.symbol} [{error.unit}]" for error in ERRORS]
    return pd.DataFrame(course[1], index=pd.Index(course[0], name=TORQUE), columns=heads)


def _supports(tree: xr.DataTree) -> pd.DataFrame | None:
    """Parts of the gear's rotation and bearing loads over the torque; ``None`` without supports."""
    import pandas as pd

    if "supports" not in tree.children:
        return None
    group = tree["supports"].to_dataset().sortby("torque")
    rotations = ("whole_rotation", *SHARES.values())
    columns = {f"{name} [urad]": group[name].mean("mesh_position").values for name in rotations}
    for name, radial, axial in zip(*bearing_loads(tree), strict=True):
        columns |= {f"{name}, radial [N]": radial.mean(axis=1), f"{name}, axial [N]": axial.mean(axis=1)}
    return pd.DataFrame(columns, index=pd.Index(group["torque"].values, name=TORQUE))


def frame_over(numbers: xr.Dataset, index: tuple[str, ...]) -> pd.DataFrame:
    """Variables as columns over some dimensions; one with further dimensions takes a column for each of theirs."""
    import pandas as pd

    columns: dict[str, Any] = {}
    for name, variable in numbers.data_vars.items():
        others = [str(dim) for dim in variable.dims if dim not in index]
        whole = variable.transpose(*index, *others)
        flat = whole.values.reshape(*whole.shape[: len(index)], -1)
        # A dimension without values of its own, such as the orders of harmonics, counts from 1.
        along = [numbers[dim].values if dim in numbers.coords else range(1, whole.sizes[dim] + 1) for dim in others]
        for number, place in enumerate(product(*along)):
            head, values = _read(" ".join([str(name), *map(str, place)]), variable, flat[..., number])
            columns[head] = np.ravel(values)
    if not index:
        return pd.DataFrame(columns)
    labels = [_read(name, numbers[name], numbers[name].values) for name in index]
    known = [pd.Index(values, name=head) for head, values in labels]
    return pd.DataFrame(columns, index=known[0] if len(known) == 1 else pd.MultiIndex.from_product(known))


def _read(name: str, variable: xr.DataArray, values: Any) -> tuple[str, Any]:
    """Head and values of a quantity in the unit in which people read it."""
    if "flag_meanings" in variable.attrs:
        words = {
            int(value): word.replace("_", " ")
            for value, word in zip(
                np.atleast_1d(variable.attrs["flag_values"]), str(variable.attrs["flag_meanings"]).split(), strict=True
            )
        }
        return name, np.vectorize(lambda value: words.get(int(value), ""), otypes=[object])(values)
    unit = str(variable.attrs.get("units", ""))
    display_unit, factor = READ_UNITS.get(unit, (unit, 1.0))
    return (f"{name} [{display_unit}]" if display_unit else name), values if factor == 1.0 else factor * values


TORQUE_COUNT_LIMIT = 8  # side by side
ROW_COUNT_LIMIT = 12  # operating conditions of friction, or load cases
#: Numbers of the loaded contact that are shown, by the variable that the report names; the rest are in the text.
SHOWN_NUMBERS = {*FIRST_PATHS, "loaded/mean_level", "loaded/mean_mesh_stiffness"}
SHOWN_NUMBERS |= {f"loaded/{name}" for name in ("max_pressure_lengthwise", "max_pressure_profile", *PATTERN)}


def result_page(tree: xr.DataTree) -> str:
    """Summary of a result in HTML without a style: pair, contact under load, friction and notes."""
    tree = in_memory(tree)
    parts = [f"<h4>{html_text(tree.attrs['title'])}</h4>"]
    if "load_cases" in tree.children:
        tables = load_case_tables(tree["load_cases"].to_dataset())
        parts += [table.html(ROW_COUNT_LIMIT, "load_cases") for table in tables]
        notes = load_case_notes(tree)
    else:
        parts.append(html_table([], [list(row) for row in head_rows(tree)]))
        assembly = (*deflection_tables(tree), *supports_tables(tree))
        parts += [*(table.html(ROW_COUNT_LIMIT) for table in assembly), "<p><b>Without load</b></p>"]
        parts.append(html_table([], [[name.strip(), words] for name, words in unloaded_rows(key_numbers(tree))]))
        parts += ["<p><b>Under load</b></p>", _loaded(tree)]
        if "friction" in tree.children:
            friction = tree["friction"].to_dataset()
            tables = [efficiency_table(friction), *contact_temperatures(friction)]
            parts += [table.html(ROW_COUNT_LIMIT) for table in tables]
        notes = result_notes(tree)
    if notes:
        entries = "".join(f"<li>{html_text(note.removeprefix('Note: '))}</li>" for note in notes)
        word = "note" if len(notes) == 1 else "notes"
        parts.append(f"<details open><summary>{len(notes)} {word}</summary><ul>{entries}</ul></details>")
    return "<div>\n" + "\n".join(part for part in parts if part) + "\n</div>"


def _loaded(tree: xr.DataTree) -> str:
    """Table of the contact under load, a column a torque."""
    numbers = loaded_numbers(tree)
    torques = numbers["torques"][:TORQUE_COUNT_LIMIT]
    rows = [
        [f"{name} [{unit}]" if unit else name, *values[:TORQUE_COUNT_LIMIT]]
        for name, unit, variable, *values in numbers["rows"]
        if variable in SHOWN_NUMBERS
    ]
    beyond = left_out(len(numbers["torques"]), TORQUE_COUNT_LIMIT, "loaded")
    return html_table(["torque at the pinion [N m]", *torques], rows) + beyond


class SweepSummary(ShownSummary):
    """Summary of a sweep: printed it is the text of ``easeoff show``, in a notebook a short page.

    Parameters
    ----------
    dataset
        A sweep.

    Examples
    --------
    >>> import easeoff
    >>> dataset = easeoff.sweep("nasa-12x36", {"E": [0.0, 0.02, 0.04]}, torques=[100.0])
    >>> print(str(dataset.easeoff.summary()).splitlines()[3])
    E             3 values from 0 to 0.04 mm
    >>> points = dataset.easeoff.summary().tables["points"]
    >>> points["peak_to_peak [urad]"].tolist() == dataset["peak_to_peak"].values.ravel().tolist()
    True
    """

    def __init__(self, dataset: xr.Dataset) -> None:
        self._dataset = _checked_sweep(dataset)
        self.text = sweep_report.sweep_summary(dataset)

    @cached_property
    def tables(self) -> dict[str, pd.DataFrame]:
        """Tables of pandas: ``points``, ``percentiles``, ``sensitivities_NAME`` and ``worst``.

        Columns bear names and units as in those of a result; ``points`` has all numbers, a row a point and torque.
        """
        return sweep_frames(self._dataset)

    def _repr_html_(self) -> str:
        return sweep_page(self._dataset)


class SweepPlots(ShownPictures):
    """Pictures of a sweep: ``plot()`` is the first that it has, ``plot.map()`` and so on one by its name.

    Parameters
    ----------
    dataset
        A sweep.

    Examples
    --------
    >>> import easeoff
    >>> dataset = easeoff.sweep("nasa-12x36", {"E": [0.0, 0.02, 0.04]}, torques=[100.0])
    >>> dataset.easeoff.plot
    pictures of a sweep: curves, pattern
    """

    kind = "sweep"

    def __init__(self, dataset: xr.Dataset) -> None:
        self._dataset = dataset

    def __call__(self, picture: str | None = None, **options: Any) -> Figure | None:
        """Draw a picture; arguments as of ``easeoff.plot.sweep``."""
        from ..plot.sweep_charts import sweep

        return sweep(self._dataset, picture, **options)

    def __dir__(self) -> list[str]:
        from ..plot.sweep_charts import short_names

        return list(short_names(self._dataset))

    def _bound(self, name: str) -> Callable[..., Figure | None]:
        return partial(self, name)


class SweepAccessor(ShownContent):
    """Tables, summary and pictures of a sweep in a notebook: ``dataset.easeoff`` of every ``xarray.Dataset``.

    Every method raises ``InputError`` if the dataset is none of ``sweep`` or ``study.sweep.read_sweep``.

    Parameters
    ----------
    dataset
        The dataset.

    Examples
    --------
    >>> import easeoff
    >>> xr.Dataset().easeoff.summary()
    Traceback (most recent call last):
    easeoff.core.errors.InputError: dataset: must be a sweep of easeoff.sweep or easeoff.study.sweep.read_sweep
    """

    def __init__(self, dataset: xr.Dataset) -> None:
        self._dataset = dataset

    def summary(self) -> SweepSummary:
        """Swept coordinates, percentiles, sensitivities and worst points."""
        return SweepSummary(self._sweep())

    @property
    def plot(self) -> SweepPlots:
        """Pictures: ``dataset.easeoff.plot.map(...)`` is ``easeoff.plot.sweep(dataset, "map", ...)``, and so on."""
        return SweepPlots(self._sweep())

    def save(self, path: str | os.PathLike[str]) -> Path:
        """Write the sweep to a netCDF-4 file and return its path; see ``study.sweep.write_sweep``.

        Parameters
        ----------
        path
            File to write, replaced if it exists; missing folders are made.
        """
        write_sweep(self._sweep(), path)
        return Path(path)

    def _sweep(self) -> xr.Dataset:
        return _checked_sweep(self._dataset)


def _checked_sweep(dataset: xr.Dataset) -> xr.Dataset:
    """A dataset, if it is a sweep."""
    if not is_sweep(dataset):
        raise InputError("dataset: must be a sweep of easeoff.sweep or easeoff.study.sweep.read_sweep")
    if faults := sweep_faults(dataset):
        raise InputError(f"dataset: a sweep that is damaged or changed: {faults[0]}")
    return dataset


def sweep_frames(dataset: xr.Dataset) -> dict[str, pd.DataFrame]:
    """Tables of a sweep by name: points, percentiles, sensitivities of each number, and worst points.

    A column bears the name of its variable and the unit; points that failed have a row, too.
    """
    loads = [name for name in LOADS if name in dataset.dims]
    rows = (*point_dimensions(dataset), *loads)
    frames = {"points": _whole(dataset, rows)}
    known = sweep_report.shown_numbers(dataset)
    if not known:
        return frames
    reduced = percentiles(dataset, sweep_report.SHOWN_PERCENT, known)
    frames["percentiles"] = _whole(reduced, ("percentile", *(name for name in loads if name in reduced.dims)))
    for name in sweep_report.SENSITIVE_NUMBERS:
        try:
            sensitivity = sensitivities(dataset, name)
        except InputError:
            continue
        frames[f"sensitivities_{name}"] = _whole(
            sensitivity, ("coordinate", *(one for one in loads if one in sensitivity.dims))
        )
    if sweep_report.WORST_NUMBER in numbers(dataset):
        frames["worst"] = _whole(worst_points(dataset, sweep_report.WORST_NUMBER, sweep_report.WORST_COUNT), ("rank",))
    return frames


def _whole(dataset: xr.Dataset, index: tuple[str, ...]) -> pd.DataFrame:
    """All numbers of a dataset over some dimensions; what does not depend on one of them is repeated along it."""
    beside = [str(name) for name in dataset.coords if name not in dataset.dims and set(dataset[name].dims) <= {*index}]
    data = dataset.reset_coords(beside).assign_coords(
        {name: range(dataset.sizes[name]) for name in index if name not in dataset.coords}
    )
    sizes = {name: dataset.sizes[name] for name in index}
    repeated: dict[Any, Any] = {}
    for name, one in data.data_vars.items():
        repeated[name] = one.variable.set_dims({**sizes, **one.sizes})  # type: ignore[no-untyped-call]
    return frame_over(data.drop_vars(list(data.data_vars)).assign(repeated), index)


def sweep_page(dataset: xr.Dataset) -> str:
    """Summary of a sweep in HTML without a style, as of ``easeoff show``."""
    parts = [f"<h4>{html_text(sweep_report.sweep_title(dataset))}</h4>"]
    parts.append(html_table([], [list(row) for row in sweep_report.sweep_head(dataset)]))
    parts += [
        f"<p>{html_text(line)}</p>" for line in (sweep_report.outcome(dataset), *sweep_report.failure_reasons(dataset))
    ]
    parts += [table.html() for table in sweep_report.sweep_tables(dataset)]
    return "<div>\n" + "\n".join(parts) + "\n</div>"
