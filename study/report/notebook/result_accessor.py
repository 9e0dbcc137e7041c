"""Accessor ``easeoff`` of a tree of xarray: what one does with a result in a notebook."""

from __future__ import annotations

import inspect
import os
import warnings
from collections.abc import Callable
from functools import cached_property, partial, update_wrapper
from importlib import import_module
from pathlib import Path
from typing import TYPE_CHECKING, Any

import xarray as xr

from ....core.errors import InputError, suggestion
from ....core.netcdf_file import in_memory
from ...result_layout import VARIABLES, faults, load_case_faults

if TYPE_CHECKING:
    import pandas as pd

    from ....cases import Case

FAULT_COUNT_LIMIT = 3  # that a message names


class ResultSummary:
    """Summary of a result: printed it is the text of ``easeoff show``, in a notebook a short page.

    Parameters
    ----------
    tree
        A result.

    Examples
    --------
    >>> import easeoff
    >>> found = easeoff.analyze("nasa-12x36", torques=[100.0]).easeoff.summary()
    >>> str(found).splitlines()[3]
    'pair          12 x 36, left-hand pinion, drive flanks'
    >>> found.tables["loaded"]["peak_to_peak [urad]"].round().tolist()
    [221.0]
    """

    def __init__(self, tree: xr.DataTree) -> None:
        self._tree = tree

    @cached_property
    def text(self) -> str:
        """The text of ``easeoff show``."""
        if "load_cases" in self._tree.children:
            from ..summary.load_case_summary import load_case_summary

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
        from .summary_frames import summary_frames

        return summary_frames(self._tree)

    def __str__(self) -> str:
        return self.text

    def __repr__(self) -> str:
        return self.text

    def _repr_html_(self) -> str:
        from .result_page import result_page

        return result_page(self._tree)


class ResultPlots:
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

    def __init__(self, tree: xr.DataTree) -> None:
        self._tree = tree

    def __dir__(self) -> list[str]:
        return sorted(_pictures())

    def __repr__(self) -> str:
        return f"pictures of a result: {', '.join(sorted(_pictures()))}"

    def __getattr__(self, name: str) -> Callable[..., Any]:
        if name.startswith("_"):
            raise AttributeError(name)
        functions = _pictures()
        if name not in functions:
            known = ", ".join(sorted(functions))
            raise AttributeError(f"there is no picture {name!r}; there are: {known}{suggestion(name, functions)}")
        function = functions[name]
        bound = update_wrapper(partial(function, self._tree), function)
        signature = inspect.signature(function)
        others = list(signature.parameters.values())[1:]
        bound.__signature__ = signature.replace(parameters=others)  # type: ignore[attr-defined]
        del bound.__wrapped__
        return bound


def _pictures() -> dict[str, Callable[..., Any]]:
    """Functions of ``easeoff.plot`` that take a result first."""
    plot = import_module("easeoff").plot
    found = {name: getattr(plot, name) for name in plot.__all__}
    return {
        name: function
        for name, function in found.items()
        if inspect.isfunction(function) and next(iter(inspect.signature(function).parameters), "") in ("tree", "result")
    }


class ResultAccessor:
    """What one does with a result in a notebook: ``tree.easeoff`` of every ``xarray.DataTree``.

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
        from ..contact_report.report_file import write_report

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
        from ...result import write_result

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
        from ....cases import parse_case
        from ..contact_report.stored_case import stored_case

        tree = self._result()
        try:
            return parse_case(str(tree.attrs.get("case", "")), "the case of the result")
        except InputError as error:
            reason = " ".join(str(error).split())
        found = stored_case(tree)
        if found is None:
            raise InputError(f"case of the result: {reason}")
        warnings.warn(f"friction and load cases of the case are left out: {reason}", UserWarning, stacklevel=2)
        return found

    def __repr__(self) -> str:
        try:
            return self.summary().text
        except InputError as error:
            return str(error)

    def _repr_html_(self) -> str | None:
        try:
            return self.summary()._repr_html_()
        except InputError:
            return None  # a notebook shows the text instead

    def _result(self) -> xr.DataTree:
        """The tree, if it is a result, with all values in memory."""
        tree = self._tree
        known = "easeoff_version" in tree.attrs
        if not known and "easeoff_version" in tree.root.attrs:
            raise InputError(f"tree = {tree.path!r}: must be a whole result; this is a group of one: take tree.root")
        tree = in_memory(tree)
        found = load_case_faults(tree) if "load_cases" in tree.children else faults(tree)
        if not known or found == [f"no group {name}" for name in VARIABLES]:
            name = f"tree = {str(tree.name or tree.path)!r}"
            raise InputError(f"{name}: must be a result of easeoff.analyze, modify, optimize or easeoff.read_result")
        if found:
            raise InputError(f"tree: damaged or changed: {'; '.join(found[:FAULT_COUNT_LIMIT])}")
        return tree
