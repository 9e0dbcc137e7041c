"""Mutations of the structure of a netCDF file: its groups, dimensions, variables, types, values and attributes."""

from __future__ import annotations

import contextlib
import random
from collections.abc import Callable, Iterator
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import netCDF4
import numpy as np

#: What may stand in an attribute.
ODD_ATTRIBUTES: tuple[Any, ...] = (
    "x", "", -1, 0, 1, np.nan, np.inf, 1e300, np.array([1.0, 2.0]), np.array([], dtype="f8"), "drive", "1.0", "[1]",
    "{}", "nan",
    np.arange(1000), "x" * 100_000, "\x1b[2J\x1b]0;owned\x07", "\u202etxt", np.int8(3), np.uint64(2**64 - 1), ["a",
        "b"], "[" * 5000,
    "x = " + "[" * 3000, '{"a": ' * 3000, "../../secret.toml", "0x10", "true", "None", "9" * 5000,
)  # fmt: skip
NAMES = ("x", "é", "a b", "position", "torque", "time", "status", "n" * 200)
FILLS: tuple[float, ...] = (0.0, -1.0, 1.0, -7.0, 99.0, 1e300, -1e300, 1e29, 1e-300, np.nan, np.inf, -np.inf)
LARGEST = 10**10
WRITTEN_LIMIT = 10**7  # most numbers of a variable that are written


@dataclass
class Variable:
    """A variable; without data it is made but never written, as large as its dimensions are."""

    dims: tuple[str, ...]
    data: Any
    attrs: dict[str, Any] = field(default_factory=dict)
    dtype: Any = None


@dataclass
class Group:
    """A group of a netCDF file in memory."""

    attrs: dict[str, Any] = field(default_factory=dict)
    dims: dict[str, int | None] = field(default_factory=dict)
    variables: dict[str, Variable] = field(default_factory=dict)
    groups: dict[str, Group] = field(default_factory=dict)

    def all(self) -> Iterator[Group]:
        """Itself and the groups within."""
        yield self
        for group in self.groups.values():
            yield from group.all()


def mutate(rng: random.Random, source: Path, target: Path) -> None:
    """Write a file with one to three changes of the structure of another."""
    tree = load(source)
    for _ in range(rng.choice([1, 1, 1, 2, 3])):
        # What the format itself refuses is left out by ``save``; a change of nothing is no change.
        with contextlib.suppress(IndexError, KeyError, ValueError, TypeError, OverflowError):
            rng.choice(CHANGES)(rng, rng.choice(list(tree.all())))
    save(tree, target, rng.choice(["NETCDF4"] * 12 + ["NETCDF3_CLASSIC", "NETCDF4_CLASSIC"]))


def load(path: Path) -> Group:
    """Content of a file."""

    def content(group: Any) -> Group:
        found = Group({name: group.getncattr(name) for name in group.ncattrs()})
        found.dims = {name: len(dim) for name, dim in group.dimensions.items()}
        for name, variable in group.variables.items():
            attrs = {key: variable.getncattr(key) for key in variable.ncattrs()}
            found.variables[name] = Variable(variable.dimensions, variable[...], attrs, variable.dtype)
        found.groups = {name: content(below) for name, below in group.groups.items()}
        return found

    with netCDF4.Dataset(path) as file:
        file.set_auto_maskandscale(False)
        return content(file)


def save(tree: Group, path: Path, kind: Any = "NETCDF4") -> None:
    """Write a file; whatever the format cannot hold is left out."""

    def put(group: Any, content: Group, known: dict[str, int]) -> None:
        for name, value in content.attrs.items():
            with contextlib.suppress(Exception):
                group.setncattr(name, value)
        known = dict(known)
        for name, size in content.dims.items():
            with contextlib.suppress(Exception):
                group.createDimension(name, size)
                known[name] = size or 0
        for name, variable in content.variables.items():
            with contextlib.suppress(Exception):
                _put_variable(group, name, variable, known)
        for name, below in content.groups.items():
            with contextlib.suppress(Exception):
                put(group.createGroup(name), below, known)

    # A variable that the format has no room for is found on closing; the file is then as good a mutation as it is.
    with contextlib.suppress(RuntimeError), netCDF4.Dataset(path, "w", format=kind) as file:
        put(file, tree, {})


def _put_variable(group: Any, name: str, variable: Variable, known: dict[str, int]) -> None:
    written = np.prod([float(known.get(dim, 0)) for dim in variable.dims]) < WRITTEN_LIMIT
    if not written and group.data_model.startswith("NETCDF3"):
        return  # this format keeps room on the disk for what is never written
    attrs = dict(variable.attrs)
    dtype = variable.dtype or np.asarray(variable.data).dtype
    made = group.createVariable(
        name,
        dtype,
        variable.dims,
        zlib=dtype is not str and bool(variable.dims),
        fill_value=attrs.pop("_FillValue", None),
    )
    made.set_auto_maskandscale(False)
    for key, value in attrs.items():
        with contextlib.suppress(Exception):
            made.setncattr(key, value)
    data = variable.data
    if data is not None and written:
        made[...] = data if dtype is str else np.resize(np.asarray(data), made.shape).astype(made.dtype)


def _variable(rng: random.Random, group: Group) -> Variable:
    return group.variables[rng.choice(list(group.variables))]


def attribute(rng: random.Random, group: Group) -> None:
    """Another attribute, of a group or a variable."""
    attrs = rng.choice([group.attrs, _variable(rng, group).attrs]) if group.variables else group.attrs
    attrs[rng.choice(list(attrs))] = rng.choice(ODD_ATTRIBUTES)


def drop_attribute(rng: random.Random, group: Group) -> None:
    """One attribute less."""
    attrs = rng.choice([group.attrs, _variable(rng, group).attrs]) if group.variables else group.attrs
    del attrs[rng.choice(list(attrs))]


def special_attribute(rng: random.Random, group: Group) -> None:
    """Attributes that readers of netCDF obey."""
    name, value = rng.choice(
        [("scale_factor", 1e300), ("add_offset", np.nan), ("_FillValue", 0), ("units", "days since 2000-01-01"),
        ("units", 3),
         ("calendar", "x"), ("missing_value", "x"), ("dtype", "bool"), ("coordinates", "x y z"), ("flag_values", "x"),
         ("flag_meanings", 3),
         ("_Unsigned", "true"), ("dtype", "object"), ("units", "seconds since 1e300"), ("units", "days"),
         ("flag_values", np.array([77]))]
    )  # fmt: skip
    _variable(rng, group).attrs[name] = value


def drop_variable(rng: random.Random, group: Group) -> None:
    """One variable less."""
    del group.variables[rng.choice(list(group.variables))]


def rename_variable(rng: random.Random, group: Group) -> None:
    """A variable by another name."""
    old = rng.choice(list(group.variables))
    group.variables[rng.choice([old + "_x", old.upper(), *NAMES])] = group.variables.pop(old)


def rename_dimension(rng: random.Random, group: Group) -> None:
    """A dimension by another name, everywhere in its group."""
    old = rng.choice(list(group.dims))
    new = rng.choice([old + "_x", *NAMES])
    group.dims = {new if name == old else name: size for name, size in group.dims.items()}
    for variable in group.variables.values():
        variable.dims = tuple(new if dim == old else dim for dim in variable.dims)


def resize_dimension(rng: random.Random, group: Group) -> None:
    """Longer, shorter or empty; the values are repeated."""
    name = rng.choice(list(group.dims))
    size = group.dims[name] or 1
    group.dims[name] = rng.choice([0, 1, 2, size + 1, size - 1, 2 * size, 10_000, None])


def unpack(rng: random.Random, group: Group) -> None:
    """A small file that takes much memory when it is read: values that were never written."""
    name = rng.choice(list(group.dims))
    group.dims[name] = rng.choice([10**7, 10**9, LARGEST])
    for variable in group.variables.values():
        if name in variable.dims:
            variable.data = None


def dimensions(rng: random.Random, group: Group) -> None:
    """A variable with fewer, more, reordered or repeated dimensions."""
    variable = _variable(rng, group)
    dims = variable.dims
    variable.dims = rng.choice([(), dims[:-1], dims[::-1], (*dims, rng.choice(list(group.dims))), dims * 2])


def dtype(rng: random.Random, group: Group) -> None:
    """A variable of another type."""
    variable = _variable(rng, group)
    new = rng.choice(["i1", "i4", "u8", "f4", "f8", "S1", str])
    if new is str:
        variable.data = np.full(np.shape(variable.data), rng.choice(["x", "1.0", "", "\x1b[2J"]), dtype=object)
    else:
        variable.data = np.zeros(np.shape(variable.data), new)
    variable.attrs.pop("_FillValue", None)
    variable.dtype = new


def values(rng: random.Random, group: Group) -> None:
    """Other values, in a part of a variable or in all of it."""
    variable = _variable(rng, group)
    data = np.array(variable.data)
    fill = rng.choice(FILLS)
    new = data * rng.choice([-1, 2, 1e6, 1e-6]) if rng.random() < 0.2 else np.full(data.shape, fill)
    with np.errstate(all="ignore"):
        new = (
            np.nan_to_num(new, nan=-5, posinf=77, neginf=-77).astype(data.dtype)
            if data.dtype.kind in "iu"
            else new.astype(data.dtype)
        )
    where = np.random.default_rng(rng.getrandbits(32)).random(data.shape) < rng.choice([0.02, 0.3, 1.0])
    variable.data = np.where(where, new, data)


def exchange(rng: random.Random, group: Group) -> None:
    """Exchange two variables."""
    first, second = rng.choice(list(group.variables)), rng.choice(list(group.variables))
    group.variables[first], group.variables[second] = group.variables[second], group.variables[first]


def reorder(rng: random.Random, group: Group) -> None:
    """Values of a variable in another order: coordinates run backwards or twice."""
    variable = _variable(rng, group)
    data = np.asarray(variable.data)
    variable.data = rng.choice(
        [data[::-1], np.resize(data.ravel()[:1], data.shape), np.sort(data, axis=None)[::-1].reshape(data.shape)]
    )


def drop_group(rng: random.Random, group: Group) -> None:
    """One group less."""
    del group.groups[rng.choice(list(group.groups))]


def move_group(rng: random.Random, group: Group) -> None:
    """A group by another name, within another, or deep down."""
    name = rng.choice(list(group.groups))
    below = group.groups.pop(name)
    for _ in range(rng.choice([0, 1, 100])):
        below = Group(groups={"deep": below})
    group.groups[rng.choice([name, name + "_x", *NAMES])] = below


def add(rng: random.Random, group: Group) -> None:
    """Something more: a variable, a dimension, many groups."""
    way = rng.choice(["variable", "groups", "attributes", "scalar"])
    if way == "groups":
        group.groups.update({f"g{n}": Group() for n in range(300)})
    elif way == "attributes":
        group.attrs.update({f"a{n}": n for n in range(2000)})
    else:
        group.variables[rng.choice(NAMES)] = Variable(
            tuple(group.dims)[:2] if way == "variable" else (), 1.0, {}, np.dtype("f8")
        )


CHANGES: tuple[Callable[[random.Random, Group], None], ...] = (
    attribute, attribute, attribute, drop_attribute, drop_attribute, special_attribute, drop_variable, drop_variable,
        rename_variable,
    rename_dimension, rename_dimension, resize_dimension, unpack, dimensions, dtype, dtype, values, values, values,
        exchange, reorder,
    drop_group, move_group, add,
)  # fmt: skip
