"""Datasets and trees that lack one thing each: a variable, an attribute, the values along a dimension."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

import numpy as np
import xarray as xr


def lacking(tree: xr.DataTree) -> Iterator[tuple[str, xr.DataTree]]:
    """What was taken out or emptied, and the tree without it; attributes of variables go for a whole group at once."""
    groups = {node.path: node.to_dataset(inherit=False) for node in tree.subtree}
    for path, group in groups.items():
        for what, changed in _changes(group):
            yield f"{path} {what}", xr.DataTree.from_dict(groups | {path: changed})


def _changes(group: xr.Dataset) -> Iterator[tuple[str, xr.Dataset]]:
    for name, variable in group.variables.items():
        yield f"without {name}", group.drop_vars([str(name)])
        yield f"{name} empty", group.assign({name: _emptied(variable)})
    for name in group.attrs:
        others = {key: value for key, value in group.attrs.items() if key != name}
        yield f"without the attribute {name}", _with_attributes(group, others)
        yield f"attribute {name} empty", _with_attributes(group, {**group.attrs, name: ""})
    for name in group.sizes:
        yield f"nothing along {name}", group.isel({name: slice(0, 0)})
    if group.variables:
        yield "variables without attributes", _with_blank_variables(group, kept=False)
        yield "variables with empty attributes", _with_blank_variables(group, kept=True)


def _emptied(variable: xr.Variable) -> xr.Variable:
    """The variable without a number or a text."""
    kind = variable.dtype.kind
    values = np.full(variable.shape, {"f": np.nan, "i": 0, "u": 0}.get(kind, ""))
    return xr.Variable(variable.dims, values.astype(variable.dtype if kind in "iuf" else object), variable.attrs)


def _with_attributes(group: xr.Dataset, attributes: dict[Any, Any]) -> xr.Dataset:
    changed = group.copy(deep=False)
    changed.attrs = attributes
    return changed


def _with_blank_variables(group: xr.Dataset, *, kept: bool) -> xr.Dataset:
    changed = group.copy(deep=False)
    for name in changed.variables:
        changed[name].attrs = dict.fromkeys(changed[name].attrs, "") if kept else {}
    return changed
