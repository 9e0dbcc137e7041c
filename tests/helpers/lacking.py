"""Damage of datasets and trees: what a variable, an attribute, a dimension or a group can lack or have otherwise."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator
from typing import NamedTuple

import numpy as np
import xarray as xr

Change = Callable[[xr.Dataset], xr.Dataset | None]


class Damage(NamedTuple):
    """One change of one group; None of a group takes it out with all below it."""

    path: str
    kind: str
    name: str
    change: Change

    def __str__(self) -> str:
        return f"{self.path} {self.kind} {self.name}".rstrip()


def damages(tree: xr.DataTree) -> Iterator[Damage]:
    """All of a tree; none is made yet."""
    for node in tree.subtree:
        if node.path != "/":
            yield Damage(node.path, "without", "", lambda _: None)
        for kind, name, change in _changes(node.to_dataset(inherit=False)):
            yield Damage(node.path, kind, name, change)


def damaged(tree: xr.DataTree, some: Iterable[Damage]) -> xr.DataTree:
    """The tree with some damages."""
    groups: dict[str, xr.Dataset] = {node.path: node.to_dataset(inherit=False) for node in tree.subtree}
    for one in some:
        changed = one.change(groups[one.path]) if one.path in groups else None
        if changed is None:
            groups = {path: group for path, group in groups.items() if not f"{path}/".startswith(f"{one.path}/")}
        else:
            groups[one.path] = changed
    return xr.DataTree.from_dict(groups)


def _changes(group: xr.Dataset) -> Iterator[tuple[str, str, Change]]:
    for name in map(str, group.variables):
        for kind, other in VARIABLES.items():
            if kind == "one value of" and name in group.sizes:
                continue  # xarray opens no such file
            yield kind, name, lambda own, name=name, other=other: _with(own, name, other(own.variables[name]))  # type: ignore[misc]
    for name, value in group.attrs.items():
        for kind, found in (
            ("without @", None),
            ("empty @", ""),
            ("of another kind @", 3.5 if isinstance(value, str) else "x"),
        ):
            yield kind, str(name), lambda own, name=name, found=found: _with_attribute(own, name, found)  # type: ignore[misc]
    for name in map(str, group.sizes):
        yield "nothing along", name, lambda own, name=name: own.isel({name: slice(0, 0)})  # type: ignore[misc]
        yield "less along", name, lambda own, name=name: own.isel({name: slice(0, max(own.sizes[name] - 1, 1))})  # type: ignore[misc]
    if group.variables:
        yield "variables without attributes", "", lambda own: own.drop_attrs()
        yield "variables with empty attributes", "", _with_empty_attributes


#: Another variable in place of one, by what is wrong with it; None where it is missing.
VARIABLES: dict[str, Callable[[xr.Variable], xr.Variable | None]] = {
    "without": lambda _: None,
    "empty": lambda own: _filled(own, {"f": np.nan, "i": 0, "u": 0}.get(own.dtype.kind, "")),
    "text in": lambda own: _filled(own, "x"),
    "one value of": lambda own: xr.Variable((), own.values.ravel()[0] if own.size else 0.0, own.attrs),
    "other dimensions of": lambda own: xr.Variable([f"other_{name}" for name in own.dims], own.values, own.attrs),
    "other order of": lambda own: own.transpose(),
    "other units of": lambda own: xr.Variable(own.dims, own.values, {**own.attrs, "units": "furlong"}),
}


def _filled(variable: xr.Variable, value: float | str) -> xr.Variable:
    values = np.full(variable.shape, value)
    number = not isinstance(value, str)
    return xr.Variable(variable.dims, values.astype(variable.dtype) if number else values, variable.attrs)


def _with(group: xr.Dataset, name: str, variable: xr.Variable | None) -> xr.Dataset:
    rest = group.drop_vars([name])
    return rest if variable is None else rest.assign({name: variable})


def _with_attribute(group: xr.Dataset, name: object, value: object) -> xr.Dataset:
    changed = group.copy(deep=False)
    changed.attrs = {key: own for key, own in group.attrs.items() if key != name}
    return changed if value is None else changed.assign_attrs({name: value})


def _with_empty_attributes(group: xr.Dataset) -> xr.Dataset:
    changed = group.copy(deep=False)
    for name in changed.variables:
        changed[name].attrs = dict.fromkeys(changed[name].attrs, "")
    return changed
