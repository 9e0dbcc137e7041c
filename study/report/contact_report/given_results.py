"""What a report is made of: results, V-H checks, wear and load cases, told apart by what they hold."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np
import xarray as xr

from ....core.errors import InputError, printable
from ....core.netcdf_file import tree_or_none
from ...result import checked_result, read_result
from ...result_layout import DAMAGED, FAULT_COUNT_LIMIT, faults, require_layout
from ...sweep.sweep_file import MARK

RESULT_COUNT_LIMIT = 6  # with pictures in one report
ACCEPTED = "'easeoff run', 'modify', 'optimize', 'wear' or 'vh'"


@dataclass(frozen=True)
class GivenResults:
    """Parts of a report by name.

    Parameters
    ----------
    results
        Of ``analyze``, those of load cases among them.
    checks
        V-H checks.
    wear
        Histories of wear.
    load_cases
        Analyses over load cases, for their tables.
    notes
        What the report has no pictures of.
    """

    results: dict[str, xr.DataTree] = field(default_factory=dict)
    checks: dict[str, xr.Dataset] = field(default_factory=dict)
    wear: dict[str, xr.Dataset] = field(default_factory=dict)
    load_cases: dict[str, xr.DataTree] = field(default_factory=dict)
    notes: list[str] = field(default_factory=list)

    @classmethod
    def of(cls, given: Mapping[str, xr.DataTree | xr.Dataset]) -> GivenResults:
        """Parts of what is given by name.

        Raises
        ------
        InputError
            If something is no result, or there are too many.

        Examples
        --------
        >>> from easeoff.study import vh_check
        >>> list(GivenResults.of({"check": vh_check("fh-design-a")}).checks)
        ['check']
        """
        found = cls()
        joined = {}
        for name, one in given.items():
            kind = kind_of(one)
            if isinstance(one, xr.DataTree):
                if "load_cases" in one.children:
                    found.load_cases[printable(name)] = joined[name] = one
                elif "loaded" in one.children:
                    _require_whole(name, one)
                    found.results[printable(name)] = one
                else:
                    raise InputError(f"{name}: must be a result of {ACCEPTED}")
            else:
                _require_kind(name, kind)
                require_layout(name, one, kind)
                (found.checks if kind == "V-H check" else found.wear)[printable(name)] = one
        if not len(found.results) <= RESULT_COUNT_LIMIT or not given:
            raise InputError(
                f"results = {len(found.results)} results: must be 1 to {RESULT_COUNT_LIMIT} for one report, and V-H "
                "checks and wear besides"
            )
        for name, one in joined.items():
            found._take_load_cases(name, one, alone=len(given) == 1)
        return found

    def _take_load_cases(self, name: str, tree: xr.DataTree, *, alone: bool) -> None:
        """Take results of load cases, those of the greatest pressure if there is no room for all."""
        cases = dict(tree.children["results"].children) if "results" in tree.children else {}
        room = RESULT_COUNT_LIMIT - len(self.results)
        peaks = {
            case: float(np.nanmax([*np.ravel(one["loaded"]["max_pressure"]), -1.0])) for case, one in cases.items()
        }
        for case, one in cases.items():
            _require_whole(f"{name}, {case}", one)
        chosen = sorted(cases, key=lambda case: -peaks[case])[:room]
        for case in cases:
            if case in chosen:
                self.results[printable(case if alone else f"{name}, {case}")] = cases[case]
        if len(chosen) < len(cases):
            self.notes.append(
                f"{printable(name)}: pictures of {len(chosen)} of {len(cases)} load cases, those of the greatest "
                f"pressure; the table has all of them."
            )


def kind_of(given: xr.DataTree | xr.Dataset) -> str:
    """What is given: ``result``, ``sweep``, ``V-H check`` or ``wear``.

    Examples
    --------
    >>> kind_of(xr.Dataset({"wear_depth": 0.0}))
    'wear'
    """
    if MARK in given.attrs:
        return "sweep"
    if isinstance(given, xr.Dataset):
        return "wear" if "wear_depth" in given else "V-H check" if "print_excess" in given else "other"
    return "result"


def read_given(path: Path) -> xr.DataTree | xr.Dataset:
    """A result, a V-H check or wear from its file.

    Raises
    ------
    InputError
        If it is none of them.
    """
    tree = tree_or_none(path)
    return read_result(path) if tree is None else checked_given(tree, path)


def checked_given(tree: xr.DataTree, path: Path) -> xr.DataTree | xr.Dataset:
    """The same of what a file holds."""
    found = tree.to_dataset()
    kind = kind_of(found)
    if kind == "other":
        return checked_result(tree, path)
    _require_kind(str(path), kind)
    require_layout(str(path), found, kind)
    return found


def by_name(results: Sequence[xr.DataTree | xr.Dataset]) -> dict[str, xr.DataTree | xr.Dataset]:
    """Results by flank, or by title if these differ, with a number where they are alike.

    Examples
    --------
    >>> list(by_name([xr.Dataset(attrs={"flank": "drive"}), xr.Dataset(attrs={"flank": "drive"})]))
    ['1: drive', '2: drive']
    """
    flanks, titles = ([str(tree.attrs.get(key, "")) for tree in results] for key in ("flank", "title"))
    names = flanks if len(set(titles)) == 1 else titles
    if len(set(names)) < len(names):
        names = [f"{number}: {name}" for number, name in enumerate(names, 1)]
    return dict(zip(names, results, strict=True))


def _require_whole(name: str, tree: xr.DataTree) -> None:
    """Refuse a result that lacks something, or has it in another form."""
    found = faults(tree)
    if found:
        told = "; ".join(found[:FAULT_COUNT_LIMIT])
        raise InputError(f"{name} {DAMAGED}: {told}; make it anew with 'easeoff run' or 'easeoff modify'")


def _require_kind(name: str, kind: str) -> None:
    """Refuse what has no pictures."""
    if kind == "sweep":
        raise InputError(
            f"{name}: is of 'easeoff sweep', which keeps numbers and no pictures: must be a result of {ACCEPTED}; "
            "'easeoff show' and 'easeoff plot' show a sweep"
        )
    if kind == "other":
        raise InputError(f"{name}: must be a result of {ACCEPTED}")
