"""Layout of what a report shows beside the groups of every result: V-H checks, wear, and groups that only some have."""

from __future__ import annotations

import numpy as np
import xarray as xr

from ....core.errors import InputError
from ...result_layout import attribute_faults, index_faults, variable_faults

GRID = ("lengthwise", "profile")
COMMANDS = {"V-H check": "vh", "wear": "wear"}

Layout = dict[tuple[str, ...], tuple[str, ...]]
#: Variables of a V-H check and of wear by their dimensions.
LAYOUTS: dict[str, Layout] = {
    "V-H check": {
        ("place", *GRID): ("print_excess",),
        ("plane_axis", *GRID): ("in_plane",),
        ("place",): (
            *("v", "h", "place_lengthwise", "place_profile", "status", "peak_to_peak"),
            *(f"pattern_{name}" for name in ("centre_lengthwise", "centre_profile", "from", "to", "height")),
        ),
        (): ("total_v", "total_h", "h_over_v"),
    },
    "wear": {
        ("step", "member", *GRID): ("wear_depth",),
        ("member", *GRID, "xyz"): ("position",),
        ("step",): ("revolutions",),
        ("torque",): ("torque",),
        ("lengthwise",): ("lengthwise",),
        ("profile",): ("profile",),
        ("step", "member"): ("largest_depth",),
        ("step", "torque"): ("peak_to_peak", "max_pressure"),
    },
}
VH_GRID: Layout = {
    ("v_grid", "h_grid", *GRID): ("grid_print_excess",),
    ("v_grid", "h_grid"): ("grid_pattern_centre_lengthwise", "grid_pattern_centre_profile"),
    ("v_grid",): ("v_grid",),
    ("h_grid",): ("h_grid",),
}
#: What the dimensions of both count, in this order.
COUNTED = {
    "place": ["toe", "middle", "heel"],
    "plane_axis": ["along", "across"],
    "member": ["pinion", "gear"],
    "xyz": ["x", "y", "z"],
}
TEXTS = {"title": "text", "flank": "text"}
#: Variables of pictures and of groups that not every result has, by their dimensions.
GROUPS: dict[str, Layout] = {
    "ease_off": {GRID: ("blade_distance", "separation_skew")},
    "modification": {("term",): ("coefficient",), GRID: ("modification",)},
    "optimization": {
        ("stage", "assembly", "torque"): ("max_line_load", "max_pressure", "max_end_load", "peak_to_peak"),
        ("assembly",): ("offset_error", "pinion_axial_error", "gear_axial_error", "shaft_angle_error"),
        ("torque",): ("torque",),
    },
    "root_stress": {
        ("torque", "member", "lengthwise"): ("root_stress",),
        ("torque", "member", "mesh_position", "pair"): ("root_stress_history",),
        ("torque", "member"): ("max_root_stress",),
        ("lengthwise",): ("lengthwise",),
    },
}
LEAST_SIZES = {"lengthwise": 2, "profile": 2, "space": 3}
KNOWN_SHARE = 0.5  # of the nodes of a worn flank, at least
DAMAGED = "is damaged, changed by hand or made by another version of easeoff"
FAULT_COUNT_LIMIT = 3  # that a message names


def require_layout(name: str, found: xr.Dataset, kind: str) -> None:
    """Refuse a V-H check or wear that lacks what the report shows, or has it in another form.

    Parameters
    ----------
    name
        For messages.
    found
        The dataset.
    kind
        ``V-H check`` or ``wear``.

    Raises
    ------
    InputError
        If it does.

    Examples
    --------
    >>> from easeoff.study import vh_check
    >>> require_layout("check", vh_check("fh-design-a"), "V-H check")
    """
    layout = LAYOUTS[kind] | (VH_GRID if "grid_print_excess" in found else {})
    faults = [*variable_faults(found, layout), *index_faults(found), *attribute_faults(found.attrs, TEXTS, needed=True)]
    faults += attribute_faults(found.attrs, {"separation": "number"}, needed=kind == "V-H check")
    for dimension, size in found.sizes.items():
        names = COUNTED.get(str(dimension))
        if names is not None and [str(one) for one in found[dimension].values] != names:
            faults.append(f"{dimension!r} must be {', '.join(names)}")
        if size < LEAST_SIZES.get(str(dimension), 1):
            faults.append(f"{size} values along {dimension}, expected more")
    place, least = {"V-H check": ("in_plane", 1.0), "wear": ("position", KNOWN_SHARE)}[kind]
    if not faults and np.isfinite(found[place].values).mean() < least:
        faults.append(f"{place!r} must hold finite numbers")
    if faults:
        raise InputError(
            f"{name} {DAMAGED}: {'; '.join(faults[:FAULT_COUNT_LIMIT])}; make it anew with 'easeoff {COMMANDS[kind]}'"
        )


def require_groups(name: str, tree: xr.DataTree) -> None:
    """Refuse a result whose optional groups lack what the report shows, or have it in another form.

    Parameters
    ----------
    name
        For messages.
    tree
        The result.

    Raises
    ------
    InputError
        If they do.

    Examples
    --------
    >>> import easeoff
    >>> require_groups("result", easeoff.analyze("nasa-12x36", torques=[100.0]))
    """
    faults: list[str] = []
    for group, layout in GROUPS.items():
        if group in tree.children:
            own = tree[group].to_dataset()
            faults += [f"{group}: {fault}" for fault in (*variable_faults(own, layout), *index_faults(own))]
            least = {str(one): 2 if one in GRID else 1 for one in own.sizes}
            faults += [
                f"{group}: {own.sizes[one]} values along {one}" for one, n in least.items() if own.sizes[one] < n
            ]
    if "root_stress" in tree.children:
        for dimension in ("torque", "mesh_position"):
            sizes = [tree[group].to_dataset().sizes.get(dimension) for group in ("loaded", "root_stress")]
            faults += [] if sizes[0] == sizes[1] else [f"root_stress: {sizes[1]} values along {dimension}"]
    if "optimization" in tree.children and tree["optimization"].to_dataset().sizes.get("stage") != 2:
        faults.append("optimization: 'stage' must be before, after")
    for variable in ("pinion_deviation", "gear_deviation"):
        if variable in tree["ease_off"]:
            faults += [
                f"ease_off: {one}" for one in variable_faults(tree["ease_off"].to_dataset(), {GRID: (variable,)})
            ]
    if faults:
        raise InputError(
            f"{name} {DAMAGED}: {'; '.join(faults[:FAULT_COUNT_LIMIT])}; make it anew with 'easeoff run' or "
            "'easeoff modify'"
        )
