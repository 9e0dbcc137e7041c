"""Rows of one flank: envelope of the cutter by differences, curvatures from two directions."""

from __future__ import annotations

import numpy as np

from ..core.arrays import Array, Bools
from ..geometry.cutting.generating_surface import GeneratingSurface
from ..geometry.flanks.blank_section import BlankSection
from ..geometry.flanks.curvature import principal_curvatures
from ..geometry.flanks.flank import Flank, NodeStatus, on_parts
from ..geometry.vectors import dot
from .conventional_analysis import directional_curvatures
from .envelope_condition import envelope_condition
from .verification_row import VerificationRow, not_applicable

POSITION_LIMIT = 1e-11  # of the outer cone distance: 1e-9 mm at 100 mm
NORMAL_LIMIT = 1e-10  # [rad]
CURVATURE_LIMIT = 1e-8  # of the greater curvature
LEFT_OUT = {
    NodeStatus.NO_SOLUTION: "out of the cutter's reach",
    NodeStatus.UNDERCUT: "undercut",
    NodeStatus.BEYOND_BLADE_TIP: "beyond the blade tip",
    NodeStatus.OUTSIDE_BLANK: "outside the blank",
}
SQUARE_LIMIT = 1e-6  # least squared sine between the two directions; below it rounding is all that is left


def flank_rows(member: str, flank: Flank, section: BlankSection) -> list[VerificationRow]:
    """Rows of one member's flank on the nodes of the analysis."""
    usable = np.isfinite(flank.position[0])
    nodes = f"{usable.sum()} of {usable.size} nodes{_others(flank, usable)}"
    limit = POSITION_LIMIT * section.outer_cone_distance
    condition = envelope_condition(flank)
    carried = f"blade carried through the machine joint by joint, {nodes}"
    moved = f"edge and cutting motion by differences, {nodes}"
    rows = [
        VerificationRow(f"flank position, {member}", carried, greatest(condition.position[usable]), limit, "mm"),
        VerificationRow(f"flank normal, {member}", moved, greatest(condition.normal[usable]), NORMAL_LIMIT, "rad"),
    ]
    envelope = f"envelope condition, {member}"
    if flank.surface.settings.generated:
        compared = f"cutter's motion by differences, along the blade, {nodes}"
        rows.append(VerificationRow(envelope, compared, greatest(condition.along_blade[usable]), limit, "mm"))
    else:
        rows.append(not_applicable(envelope, "cut without rolling: the blade itself sweeps the flank"))
    return [*rows, _curvature(member, flank, usable, nodes)]


def _others(flank: Flank, usable: Bools) -> str:
    """Description of the nodes without a flank."""
    left = flank.status[~usable]
    phrases = [f"{np.count_nonzero(left == kind)} {words}" for kind, words in LEFT_OUT.items() if np.any(left == kind)]
    return f" (the others: {', '.join(phrases)})" if phrases else ""


def greatest(values: Array) -> float:
    """Greatest magnitude; NaN if any value is NaN or there is none."""
    return float(np.max(np.abs(values))) if values.size else float("nan")


def _curvature(member: str, flank: Flank, usable: Bools, nodes: str) -> VerificationRow:
    """Principal curvatures and torsion from two directions against the fundamental forms, over the greater one."""

    def other(surface: GeneratingSurface, parameters: Array) -> Array:
        curvatures = directional_curvatures(surface, parameters)
        sine = dot(curvatures.across[0], curvatures.tangent[1])
        return np.concatenate(
            [curvatures.shape_operator().principal().curvature, [curvatures.torsion_residual(), sine]]
        )

    values = on_parts(flank.surface.flank_parts, flank.part, flank.parameters, other)[:, usable]
    expected = principal_curvatures(flank).curvature[:, usable]
    scale = np.max(np.abs(expected), axis=0)
    difference = np.max(np.abs([*(values[:2] - expected), values[2]]), axis=0) / scale
    # Two directions that nearly coincide tell one curvature only.
    skew = values[3] ** 2 < SQUARE_LIMIT
    left = f", {skew.sum()} left out whose directions coincide" if skew.any() else ""
    quantity = f"principal curvatures, {member}"
    compared = f"from two directions against the fundamental forms, {nodes}{left}"
    return VerificationRow(quantity, compared, greatest(difference[~skew]), CURVATURE_LIMIT, "1")
