"""Result that is drawn: what figures need of it, and its views of the teeth."""

from __future__ import annotations

from typing import TYPE_CHECKING

import xarray as xr

from ...core.errors import InputError
from ...geometry.pair.gear_pair import MEMBERS
from ...geometry.tooth.tooth_flanks import MemberName
from ..result_layout import VARIABLES

if TYPE_CHECKING:
    from .tooth_view import ToothView

#: What makes a group that not every result has.
MADE_BY = {
    "friction": "give a speed: analyze(..., speed=1500.0), or 'easeoff run --speed 1500'",
    "root_stress": "finite-element teeth have it: compliance.model = 'fe' in the case",
    "optimization": "it must be a result of 'easeoff modify'",
    "front": "'easeoff optimize --form pareto' makes it",
    "optimal_settings": "it must be a result of 'easeoff optimize'",
    "load_cases": "it must be a result over load cases",
}


def require_result(tree: object, *groups: str) -> None:
    """Refuse anything but a result that has the groups which the figure shows."""
    if not isinstance(tree, xr.DataTree) or not ("load_cases" in tree.children or VARIABLES.keys() <= {*tree.children}):
        raise InputError("tree: must be a result of 'easeoff run' or analyze")
    for group in groups or ("loaded",):
        if group not in tree.children:
            hint = MADE_BY.get(group, "draw that of one load case, in its group 'results'")
            if group == "root_stress" and "root_stress_left_out" in tree.attrs:
                hint = str(tree.attrs["root_stress_left_out"])
            raise InputError(f"tree: the result has no group {group!r}: {hint}")


def flank_views(tree: xr.DataTree, member: str | None = None) -> tuple[ToothView, ...]:
    """Views of the flanks of gear and pinion, or of one of them."""
    from .panel_grid import chosen_parts
    from .tooth_view import tooth_view

    names: tuple[MemberName, ...] = ("gear", "pinion")
    chosen = chosen_parts(MEMBERS, member, "member")
    return tuple(tooth_view(tree, name) for name in names if name in chosen)
