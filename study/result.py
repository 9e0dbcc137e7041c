"""Result of an analysis: the layout that readers rely on, also of V-H checks and wear, and its netCDF-4 file."""

from __future__ import annotations

import math
import os
from collections.abc import Iterator, Mapping
from importlib import resources
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
import xarray as xr

from ..contact.outcomes import LineEnd, Status
from ..contact.supports.assembly_rounds import RoundsStatus
from ..core.attributes import StoredStatus, units_of
from ..core.checks import file_path, instance, shown
from ..core.errors import InputError
from ..core.netcdf_file import layout_fault, read_tree, tree_or_none, unreadable, write_netcdf
from ..core.regular_file import named, parsed_json

RESULT_SCHEMA_VERSION = 1  # of what older versions do not read as it is meant
SWEEP_MARK = "sweep_schema_version"  # attribute by which the file of a sweep is known
MAGNITUDE_LIMIT = 1e30
Layout = dict[tuple[str, ...], tuple[str, ...]]
AttributeKind = str | int | tuple[str, ...]  # in words, or the length of a vector, or the texts that it may be
GRID = ("lengthwise", "profile")
LOADED, SEGMENTS = ("torque", "mesh_position"), ("torque", "mesh_position", "segment")
CONDITIONS = ("torque", "speed", "temperature", "roughness")
PATTERN = ("pattern_centre_lengthwise", "pattern_centre_profile", "pattern_length", "pattern_height")
PLACES = ("place_lengthwise", "place_profile")


class GroupLayout(NamedTuple):
    """Variables of a group: those that it must have, sets of those that it need not have, and what else it must be."""

    needed: Layout
    optional: list[Layout]
    attributes: dict[str, dict[str, AttributeKind]]  # kinds by name: after ``@`` needed, after ``@?`` not
    texts: dict[str, str]  # their dimensions by name
    finite: list[str]  # variables without NaN

    def faults(self, group: xr.Dataset) -> Iterator[str]:
        """Variables that a group lacks or has in another form, of sets that it has a part of, too."""
        yield from variable_faults(group, self.needed)
        for together in self.optional:
            if any(name in group.variables for names in together.values() for name in names):
                yield from variable_faults(group, together)


def _layouts(table: str) -> dict[str, GroupLayout]:
    """Layouts by group from a table of the form of ``result_layout.txt``."""
    layouts: dict[str, GroupLayout] = {}
    for row in table.splitlines():
        if row.startswith("#"):
            continue
        if row.startswith("["):
            group = layouts[row.strip("[]")] = GroupLayout({}, [], {"@": {}, "@?": {}}, {}, [])
            needed, optional, *_ = group
            continue
        words, names = row.split(":")
        mark, *dimensions = words.split() if row[0] in "+&?@=!" else ("", *words.split())
        over, variables, kind = tuple(dimensions), tuple(names.split()), " ".join(dimensions)
        if mark in group.attributes:
            texts = tuple(kind.split("|")) if "|" in kind else kind
            group.attributes[mark] |= dict.fromkeys(variables, int(kind) if kind.isdigit() else texts)
        elif mark == "=":
            group.texts.update(dict.fromkeys(variables, kind))
        elif mark == "!":
            group.finite.extend(variables)
        elif mark == "?":
            optional += [{over: (one,)} for one in variables]
        else:
            if mark == "+":
                optional.append({})
            rows = optional[-1] if mark else needed
            rows[over] = (*rows.get(over, ()), *variables)
    return layouts


_LAYOUTS = _layouts(resources.files(__package__).joinpath("result_layout.txt").read_text(encoding="utf-8"))
#: Variables of every result by group and dimensions; of groups computed with the loaded contact, of which older results
#: lack ``misalignment``; and of groups that not every result has.
VARIABLES, COMPUTED, GROUPS = (
    {name: _LAYOUTS[name].needed for name in names}
    for names in (
        ("flanks", "ease_off", "teeth", "unloaded", "loaded"),
        ("misalignment", "supports", "friction"),
        ("modification", "optimization", "root_stress", "optimal_settings", "front", "backlash"),
    )
)
#: Variables that ``key_numbers`` takes over, by their dimensions.
KEY_NUMBERS = _LAYOUTS["key numbers"].needed
#: Dimensions along which there may be nothing: of a search without limits, or that was gone on from and ended at once.
PERHAPS_EMPTY = ("quantity_limit", "programme")
#: Dimensions that every group counts for itself: edges of a tooth pair may carry where it has no contact line.
OF_EACH_GROUP = {"pair"}
#: Attributes of the unloaded error that are NaN where the flanks do not touch at every mesh position.
OF_UNLOADED = ("peak_to_peak", "rms", "harmonics")
#: Attributes by group, of the whole result by no name, and of whatever is of one pair: their kinds.
ATTRIBUTES, OPTIONAL_ATTRIBUTES = (
    {name: layout.attributes[mark] for name, layout in _LAYOUTS.items() if layout.attributes[mark]}
    for mark in ("@", "@?")
)
OF_A_PAIR = ATTRIBUTES.pop("pair")
ATTRIBUTES[""] = OF_A_PAIR | ATTRIBUTES[""]

LOAD_CASE_TEXTS = ("load_case", "flank", "reason")
#: Variables whose values have meanings, in the groups of solves and elsewhere.
FLAGS: dict[str, type[StoredStatus]] = {
    "status": Status,
    "max_pressure_line_end": LineEnd,
    "rounds_status": RoundsStatus,
}
#: Groups whose status is that of other things.
OTHER_STATUS = ("flanks", "ease_off")
#: The contact at light load has its own torque and segments.
LIGHT_LOAD = {"torque", "segment"}
COMMANDS = {"V-H check": "vh", "wear": "wear"}

#: What dimensions of V-H checks, of wear, and of flanks and teeth of results count, in this order.
COUNTED = {
    "place": ["toe", "middle", "heel"],
    "plane_axis": ["along", "across"],
    "member": ["pinion", "gear"],
    "xyz": ["x", "y", "z"],
    "stage": ["before", "after"],
}
LEAST_SIZES = {"lengthwise": 2, "profile": 2, "space": 3, "end": 2}
FLANK_SIZE_MINIMUM = 1e-3  # length and height of a flank that can be drawn [mm]
KNOWN_SHARE = 0.5  # of the nodes of a worn flank or a modification, at least
DAMAGED = "is damaged, changed by hand or made by another version of easeoff"
FAULT_COUNT_LIMIT = 3  # that a message names


def faults(tree: xr.DataTree) -> list[str]:
    """Parts that a result lacks, or has in another form, one phrase each; empty if it is whole."""
    layout = {name: _LAYOUTS[name] for name in (*VARIABLES, *(name for name in COMPUTED if name in tree.children))}
    if "light_load" in tree.children:
        loaded = _LAYOUTS["loaded"]
        evaluated = {over: (*loaded.needed.get(over, ()), *names) for over, names in loaded.optional[0].items()}
        layout["light_load"] = loaded._replace(needed=loaded.needed | evaluated)
    defects = [f"no group {name}" for name in layout if name not in tree.children]
    if defects:
        return defects
    sizes: dict[str, int] = {}
    for name, variables in layout.items():
        group = tree[name].to_dataset()
        defects += [f"{name}: {fault}" for fault in variables.faults(group)]
        counted = {dimension for dimensions in variables.needed for dimension in dimensions}
        for dimension, length in group.sizes.items():
            alone = dimension in OF_EACH_GROUP or (name == "light_load" and dimension in LIGHT_LOAD)
            size = length if alone or dimension not in counted else sizes.setdefault(str(dimension), length)
            if size != length or size < LEAST_SIZES.get(str(dimension), 1):
                defects.append(f"{name}: {length} values along {dimension}, expected {size or 'some'}")
    defects += _group_faults(tree)
    for name in ("unloaded", "loaded"):
        if _share(tree[name].to_dataset(), "pinion_rotation") < 1.0:
            defects.append(f"{name}: 'pinion_rotation' must hold finite numbers")
    for name in ("flanks", "ease_off", "teeth"):
        grid = tree[name].to_dataset()
        defects += [f"{name}: {fault}" for fault in _counted_faults(grid)]
        rows = (layout[name].needed, *layout[name].optional)
        present = [one for known in rows for names in known.values() for one in names if one in grid]
        empty = [one for one in present if not (_share(grid, one) and (one != "inside" or grid[one].values.any()))]
        defects += [f"{name}: no values in {one!r}" for one in empty]
        for dimension in GRID:
            fractions = tree.children[name].dataset.variables.get(dimension)
            if fractions is None or not _rises(fractions.values):
                defects.append(f"{name}: {dimension!r} must hold numbers from 0 to 1 that rise")
    for name, node in tree.children.items():
        defects += [f"{name}: {fault}" for fault in form_faults(node.dataset)]
        if name in layout and name not in OTHER_STATUS:
            defects += [f"{name}: {fault}" for fault in _flag_faults(node.dataset)]
    for table, needed in ((ATTRIBUTES, True), (OPTIONAL_ATTRIBUTES, False)):
        for name, attributes in table.items():
            if not name or name in layout:
                group_attributes = (tree[name] if name else tree).attrs
                defects += [
                    f"{name or 'root'}: {fault}"
                    for fault in attribute_faults(group_attributes, attributes, needed=needed)
                ]
    if not defects:
        segments = tree.children["loaded"].dataset.variables
        for one in ("length", "tooth", "lengthwise", "profile"):
            if ((segments["force"] > 0.0) & np.isnan(segments[one])).any():
                defects.append(f"loaded: {one!r} must hold numbers where a segment carries")
    return defects


def _group_faults(tree: xr.DataTree) -> Iterator[str]:
    """Faults of the groups that not every result has."""
    for name, layout in GROUPS.items():
        if name in tree.children:
            dataset = tree[name].to_dataset()
            yield from (f"{name}: {fault}" for fault in variable_faults(dataset, layout))
            few = [
                one for one, size in dataset.sizes.items() if size < (2 if one in GRID else one not in PERHAPS_EMPTY)
            ]
            yield from (f"{name}: {dataset.sizes[one]} values along {one}" for one in few)
            if name == "modification" and _share(dataset, name) < KNOWN_SHARE:
                yield f"{name}: {name!r} must hold finite numbers"
            for text, dimension in _LAYOUTS[name].texts.items():
                if not _is_text(dataset, text) or dataset[text].dims != (dimension,):
                    yield f"{name}: no text {text!r} over {dimension}"
            partial = [one for one in _LAYOUTS[name].finite if _share(dataset, one) < 1.0]
            yield from (f"{name}: {one!r} must hold finite numbers" for one in partial)
    for name, other in (("front", "optimal_settings"), ("optimization", "modification")):
        if name in tree.children and other not in tree.children:
            yield f"{name}: no group {other} beside it"
    if "front" in tree.children:
        yield from (f"front: {fault}" for fault in _front_faults(tree))
    if "root_stress" in tree.children:
        for dimension in LOADED:
            sizes = [tree[group].to_dataset().sizes.get(dimension) for group in ("loaded", "root_stress")]
            if sizes[0] != sizes[1]:
                yield f"root_stress: {sizes[1]} values along {dimension}"
    if "optimization" in tree.children:
        yield from (f"optimization: {fault}" for fault in _counted_faults(tree["optimization"].to_dataset()))


def _front_faults(tree: xr.DataTree) -> Iterator[str]:
    """Faults of a front beside those of its variables: its own chosen point, and the names of its search."""
    front = tree["front"].to_dataset()
    yield from attribute_faults(front.attrs, {"chosen_point": "number"}, needed=True)
    chosen = front.attrs.get("chosen_point")
    if isinstance(chosen, int | float | np.number) and chosen not in range(front.sizes.get("point", 0)):
        yield f"chosen_point = {chosen}: must be the number of a point"
    search = tree["optimal_settings"].to_dataset() if "optimal_settings" in tree.children else xr.Dataset()
    for name in ("setting", "objective", "quantity_limit"):
        if name in front and name in search and front[name].values.tolist() != search[name].values.tolist():
            yield f"{name!r} must be as in optimal_settings"


def require_layout(name: str, dataset: xr.Dataset, kind: str) -> None:
    """Refuse a V-H check or wear (``kind``) that lacks a part to be shown or drawn, or has it in another form."""
    faults = [*_LAYOUTS[kind].faults(dataset), *form_faults(dataset)]
    faults += attribute_faults(dataset.attrs, OF_A_PAIR, needed=True)
    faults += attribute_faults(dataset.attrs, OPTIONAL_ATTRIBUTES[""], needed=False)
    faults += attribute_faults(dataset.attrs, {"separation": "number"}, needed=kind == "V-H check")
    faults += _counted_faults(dataset)
    for dimension, size in dataset.sizes.items():
        if size < LEAST_SIZES.get(str(dimension), 1):
            faults.append(f"{size} values along {dimension}, expected more")
    if not faults:
        known = {"position": KNOWN_SHARE} if kind == "wear" else dict.fromkeys(("in_plane", *PLACES), 1.0)
        faults += [f"{one!r} must hold finite numbers" for one in known if _share(dataset, one) < known[one]]
    if not faults and kind == "V-H check":
        plane = dataset["in_plane"].transpose("plane_axis", ...).values.reshape(2, -1)
        if not np.all(np.ptp(plane, axis=1) > FLANK_SIZE_MINIMUM):
            faults.append("'in_plane' must hold the flank's points")
    if faults:
        raise InputError(
            f"{name} {DAMAGED}: {'; '.join(faults[:FAULT_COUNT_LIMIT])}; make it anew with 'easeoff {COMMANDS[kind]}'"
        )


def _counted_faults(dataset: xr.Dataset) -> Iterator[str]:
    """Dimensions that do not count what they should."""
    for dimension, names in COUNTED.items():
        if dimension in dataset.sizes and [str(one) for one in dataset[dimension].values.tolist()] != names:
            yield f"{dimension!r} must be {', '.join(names)}"


def _share(dataset: xr.Dataset, name: str) -> float:
    """Part of the numbers of a variable that are finite."""
    values = dataset[name].values if name in dataset else np.empty(0)
    return float(np.isfinite(values).mean()) if values.dtype.kind in "fiu" and values.size else 0.0


def attribute_faults(attributes: Mapping[Any, Any], kinds: Mapping[str, AttributeKind], *, needed: bool) -> list[str]:
    """Attributes that are missing, if needed, or of another kind: text, one of some, number or vector of a length."""
    return [
        f"no {' or '.join(kind) if isinstance(kind, tuple) else 'vector' if isinstance(kind, int) else kind} in the "
        f"attribute {key!r}"
        for key, kind in kinds.items()
        if (needed or key in attributes) and not _is(kind, attributes.get(key), known=key not in OF_UNLOADED)
    ]


def load_case_faults(tree: xr.DataTree) -> list[str]:
    """Parts that a result over load cases lacks, or has in another form, one phrase each; empty if it is whole."""
    numbers = tree["load_cases"].to_dataset()
    if not numbers.sizes.get("load_case"):
        return ["load_cases: no load cases"]
    defects = [f"load_cases: {fault}" for fault in (*_LAYOUTS["load_cases"].faults(numbers), *form_faults(numbers))]
    defects += [f"load_cases: no text {name!r}" for name in LOAD_CASE_TEXTS if not _is_text(numbers, name)]
    over = [name for name, one in numbers.data_vars.items() if one.dims[:1] != ("load_case",)]
    defects += [f"load_cases: {name!r} must be over load_case" for name in over]
    for attributes, needed in (({"title": "text"}, True), (OPTIONAL_ATTRIBUTES[""], False)):
        defects += [f"root: {fault}" for fault in attribute_faults(tree.attrs, attributes, needed=needed)]
    if defects:
        return defects
    if "duty" in tree.children:
        duty = tree["duty"].to_dataset()
        defects += [f"duty: {fault}" for fault in (*_LAYOUTS["duty"].faults(duty), *form_faults(duty))]
        defects += [f"duty: no text {name!r}" for name in ("load_case", "flank") if not _is_text(duty, name)]
        defects += [f"duty: 0 values along {name}" for name, size in duty.sizes.items() if not size]
        if not defects and duty["load_case"].values.tolist() != numbers["load_case"].values.tolist():
            defects.append("duty: 'load_case' must be as in load_cases")
    results = tree["results"].children if "results" in tree.children else {}
    for name, reason in zip(numbers["load_case"].values, numbers["reason"].values, strict=True):
        if not str(reason):
            result = results.get(str(name))
            defects += [f"results: no {name}"] if result is None else [f"{name}: {fault}" for fault in faults(result)]
    return defects


def _is_text(group: xr.Dataset, name: str) -> bool:
    """True if a variable holds texts."""
    if name not in group.variables or group[name].ndim != 1:
        return False
    return all(isinstance(value, str) for value in group[name].values.tolist())


def _flag_faults(group: xr.Dataset) -> Iterator[str]:
    """Variables with a value that has no meaning."""
    for name, meanings in FLAGS.items():
        if name in group.variables:
            known = [int(one) for one in meanings]
            variable = group.variables[name]
            if variable.dtype.kind not in "iu" or not np.all(np.isin(variable.values, known)):
                yield f"{name!r} must hold whole numbers from {min(known)} to {max(known)}"


def form_faults(group: xr.Dataset) -> Iterator[str]:
    """Variables of another kind or unit than the table of attributes has, and dimensions without distinct values."""
    for name, variable in group.variables.items():
        units = units_of(str(name))
        if units is None:
            continue
        if variable.dtype.kind not in "fiu":
            yield f"{name!r} must hold numbers"
        elif str(variable.attrs.get("units", units)) != units:
            yield f"{name!r} has the units {shown(variable.attrs['units'])}: must be {units}"
        elif np.any(np.isfinite(variable.values) & (np.abs(variable.values) > MAGNITUDE_LIMIT)):
            yield f"{name!r} holds numbers beyond {MAGNITUDE_LIMIT:g}"
    for name in map(str, group.sizes):
        if name in group.variables:
            values = group.variables[name].values
            if group.variables[name].dims != (name,) or np.unique(values.astype(str)).size != values.size:
                yield f"{name!r} must hold values that differ"
            elif values.dtype.kind == "f" and not np.all(np.isfinite(values)):
                yield f"{name!r} must hold finite numbers"


def _rises(values: Any) -> bool:
    """True if fractions of the flank rise."""
    if values.dtype.kind != "f" or values.ndim != 1:
        return False
    return bool(np.all(np.abs(values - 0.5) <= 0.5 + 1e-9) and np.all(np.diff(values) > 0.0))


def variable_faults(group: xr.Dataset, variables: Mapping[tuple[str, ...], tuple[str, ...]]) -> Iterator[str]:
    """Variables that are missing from a group, over other dimensions, or no numbers; names are by dimensions."""
    for dimensions, names in variables.items():
        for name in names:
            if (
                name not in group.variables
                or not _fits(group[name].dims, dimensions)
                or group[name].dtype.kind not in "fiu"
            ):
                yield f"no numbers {name!r} over {', '.join(dimensions)}"


def _fits(stored: tuple[Any, ...], dimensions: tuple[str, ...]) -> bool:
    """True if dimensions are those of a layout; numbers of segments may be of further conditions, in their order."""
    return stored == dimensions or (
        "segment" in dimensions
        and {*dimensions} <= {*stored}
        and stored == tuple(one for one in (*SEGMENTS, *CONDITIONS[1:]) if one in stored)
    )


def _is(kind: AttributeKind, value: Any, *, known: bool) -> bool:
    """True if an attribute is of a kind: text, finite number, vector, table of numbers; NaN only if not ``known``."""
    if kind == "text" or isinstance(kind, tuple):
        return isinstance(value, str) and (kind == "text" or value in kind)
    if kind == "table of numbers":
        return isinstance(value, str) and _is_table(value)
    if value is None:
        return False
    numbers = np.asarray(value)
    if numbers.dtype.kind not in "fiu" or not np.all(np.isfinite(numbers) | (np.isnan(numbers) & (not known))):
        return False
    return bool(numbers.ndim == 0) if kind == "number" else numbers.shape == (kind,)


def _is_table(text: str) -> bool:
    """True if a text is a JSON object of finite numbers."""
    try:
        table = parsed_json(text)
    except ValueError:
        return False
    return isinstance(table, dict) and all(
        isinstance(value, float | int) and math.isfinite(value) for value in table.values()
    )


#: What reports and pictures are made of.
ACCEPTED = "'easeoff run', 'modify', 'optimize', 'wear' or 'vh'"
#: What netCDF files of other commands are, by a variable that no result has.
OTHER_KINDS = {
    "print_excess": "of 'easeoff vh', for 'easeoff show', 'plot' and 'report'",
    "wear_depth": "of 'easeoff wear', for 'easeoff show', 'plot', 'report' and --deviation",
    "comparison_status": "the table of 'easeoff verify', for xarray.open_dataset",
    "solver_tolerance": "the table of 'easeoff compare', which wrote its report and pictures beside it",
}


def write_result(tree: xr.DataTree, path: str | os.PathLike[str]) -> None:
    """Write a result to a netCDF-4 file.

    Parameters
    ----------
    tree
        Result of ``analyze``, ``modify``, ``optimize`` or ``study.analyze_load_cases``.
    path
        The file, replaced if it exists; missing folders are made.

    Raises
    ------
    InputError
        If the file cannot be written; nothing is left behind then.

    Examples
    --------
    >>> import easeoff
    >>> from tempfile import TemporaryDirectory
    >>> tree = easeoff.analyze("nasa-12x36", torques=[100.0])
    >>> with TemporaryDirectory() as folder:
    ...     easeoff.write_result(tree, f"{folder}/nasa.nc")
    ...     easeoff.read_result(f"{folder}/nasa.nc").identical(tree)
    True
    """
    instance("tree", tree, xr.DataTree)
    write_netcdf(tree, path)


def read_result(path: str | os.PathLike[str]) -> xr.DataTree:
    """Read a result from a netCDF-4 file, which is closed again.

    Parameters
    ----------
    path
        A file written by ``write_result`` or ``easeoff run``.

    Returns
    -------
    xr.DataTree
        Groups and variables as described in the page ``docs/engineer/reference/results.md``.

    Raises
    ------
    InputError
        If there is no such file, or it is no result of this package.

    Examples
    --------
    >>> import easeoff
    >>> from tempfile import TemporaryDirectory
    >>> with TemporaryDirectory() as folder:
    ...     easeoff.write_result(easeoff.analyze("nasa-12x36", torques=[100.0]), f"{folder}/nasa.nc")
    ...     tree = easeoff.read_result(f"{folder}/nasa.nc")
    >>> tree["loaded/peak_to_peak"].attrs["units"]
    'urad'
    """
    from ..cases.reading import CASE  # what is shown or drawn of a file needs no case

    source = file_path("path", path)
    if not os.path.exists(path) and str(path) in CASE.names():
        raise InputError(f"{named(source)} is a case, not a result: make one with 'easeoff run {source} -o FILE'")
    if source.suffix == ".toml":
        raise InputError(f"{source} is not a netCDF file; of a case make a result: 'easeoff run {source} -o FILE'")
    return checked_result(read_tree(source), source)


def checked_result(tree: xr.DataTree, source: Path) -> xr.DataTree:
    """The result that a file holds; raises as ``read_result``, which it ends."""
    if SWEEP_MARK in tree.attrs:
        raise InputError(f"{source} is of a sweep: easeoff.study.sweep.read_sweep reads it, 'easeoff show' shows it")
    defects = load_case_faults(tree) if "load_cases" in tree.children else faults(tree)
    if "easeoff_version" not in tree.attrs or defects == [f"no group {name}" for name in VARIABLES]:
        other = next((words for sign, words in OTHER_KINDS.items() if sign in tree.variables), None)
        description = f"is {other}" if other else "is a netCDF file, but no result of 'easeoff run'"
        raise InputError(f"{source} {description}: make a result with 'easeoff run CASE -o FILE'")
    defects = layout_fault(tree.attrs, "schema_version", RESULT_SCHEMA_VERSION) or defects
    if defects:
        raise unreadable(source, tree.attrs, defects, "easeoff run CASE -o FILE")
    return tree


def kind_of(given: xr.DataTree | xr.Dataset) -> str:
    """Kind of what is given: ``result``, ``sweep``, ``V-H check`` or ``wear``."""
    if SWEEP_MARK in given.attrs:
        return "sweep"
    if isinstance(given, xr.Dataset):
        return "wear" if "wear_depth" in given else "V-H check" if "print_excess" in given else "other"
    return "result"


def read_given(path: Path) -> xr.DataTree | xr.Dataset:
    """Read a result, a V-H check or wear from its file."""
    tree = tree_or_none(path)
    return read_result(path) if tree is None else checked_given(tree, path)


def checked_given(tree: xr.DataTree, path: Path) -> xr.DataTree | xr.Dataset:
    """The same of what a file holds."""
    dataset = tree.to_dataset()
    kind = kind_of(dataset)
    if kind == "other":
        return checked_result(tree, path)
    require_kind(named(path), kind)
    require_layout(named(path), dataset, kind)
    return dataset


def require_kind(name: str, kind: str) -> None:
    """Refuse what has no pictures."""
    if kind == "sweep":
        raise InputError(
            f"{name}: is of 'easeoff sweep', which keeps numbers and no pictures: must be a result of {ACCEPTED}; "
            "'easeoff show' and 'easeoff plot' show a sweep"
        )
    if kind == "other":
        raise InputError(f"{name}: must be a result of {ACCEPTED}")
