"""Functions that depend on nothing but their arguments, computed once for many tests."""

from __future__ import annotations

import pickle
import sys
from collections.abc import Callable
from dataclasses import replace
from functools import wraps
from inspect import signature
from math import inf
from typing import Any

import pytest
import xarray as xr
from runs import read_only

from easeoff.study.analysis.contact_analysis import Analysis
from easeoff.study.case_in_mesh import CaseInMesh


class Shared:
    """Results of functions by all that their arguments hold: so many at the most."""

    def __init__(self, most: float = inf) -> None:
        self.most = most
        self.results: dict[bytes, Any] = {}
        self.own: dict[int, Any] = {}

    def key(self, compute: Callable[..., Any], *arguments: Any, **keywords: Any) -> bytes:
        """A text for the call; an argument that is itself a shared result counts by its identity."""
        bound = signature(compute).bind(*arguments, **keywords)
        bound.apply_defaults()
        values = [id(value) if id(value) in self.own else value for value in bound.arguments.values()]
        if any(isinstance(value, CaseInMesh) for value in values):
            raise TypeError("a pair in mesh that is not shared is too large to look into")
        return pickle.dumps((compute.__module__, compute.__qualname__, values))

    def once(self, compute: Callable[..., Any]) -> Callable[..., Any]:
        """The function, computing once what it is asked for several times."""

        @wraps(compute)
        def computed(*arguments: Any, **keywords: Any) -> Any:
            try:
                key = self.key(compute, *arguments, **keywords)
            except (AttributeError, TypeError, pickle.PicklingError):  # wrong arguments, or those of no name or content
                return compute(*arguments, **keywords)
            if key not in self.results:
                if len(self.results) >= self.most:
                    self.own.pop(id(self.results.pop(next(iter(self.results)))), None)
                self.results[key] = result = compute(*arguments, **keywords)
                self.own[id(result)] = result
            return fresh(self.results[key])

        return computed


def fresh(result: Any) -> Any:
    """What examples may change of a result anew, its numbers read-only; what is frozen as it is."""
    if isinstance(result, Analysis):
        return replace(result, groups={name: fresh(group) for name, group in result.groups.items()})
    if isinstance(result, xr.DataTree):
        return read_only(result).copy(deep=False)
    return read_only(result).copy(deep=False) if isinstance(result, xr.Dataset) else result


def replace_everywhere(patch: pytest.MonkeyPatch, compute: Callable[..., Any], other: Callable[..., Any]) -> None:
    """Put another function in the place of one, in every module of the package that has it."""
    for module in [found for name, found in sys.modules.items() if name.startswith("easeoff")]:
        if vars(module).get(compute.__name__) is compute:
            patch.setattr(module, compute.__name__, other)
