"""The loop of the shop floor: cut with wrong settings, measure, correct, cut with the same errors, measure again."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np
from numpy.typing import NDArray

from easeoff.cases import Case, gear_pair, read_case
from easeoff.geometry import GeneratingSurface, Member, get_setting, named_member, with_settings
from easeoff.geometry.deviation.measurement import zeroed
from easeoff.geometry.formats import cmm_points, flank_deviation, measured_matrix
from easeoff.geometry.tooth.tooth_flanks import MemberName, Side, side
from easeoff.verification import distance_along_normals

Array = NDArray[np.float64]


def completing(case: str) -> Case:
    """A shipped case whose pinion is cut in one set-up: its convex flank at the settings of the concave one."""
    found = read_case(case)
    pinion = found.pinion
    assert pinion.convex is not None
    assert pinion.concave is not None
    # One cutter: outer and inner blades stand beside one another; a flank of its own for each.
    convex = pinion.convex.model_copy(update={"machine": pinion.concave.machine})
    return found.model_copy(update={"pinion": pinion.model_copy(update={"convex": convex})})


def views(case: Case, name: MemberName) -> dict[Side, Member]:
    """A member seen from both of its flanks."""
    member = named_member(gear_pair(case), name)
    return {side(seen.loaded): seen for seen in (member, member.from_opposite)}


def with_errors(surface: GeneratingSurface, errors: Mapping[str, float]) -> GeneratingSurface:
    """The flank that a machine with errors cuts at the settings of a surface."""
    return with_settings(surface, {name: get_setting(surface, name) + by for name, by in errors.items()})


def measured(designed: Member, real: GeneratingSurface) -> Array:
    """Deviations (rows, columns) [um] that a machine measures along the normals, the tooth turned to its middle."""
    points = cmm_points(designed)
    place, normal = (points[name].values[0].reshape(-1, 3).T for name in ("position", "normal"))
    distance = distance_along_normals(real, designed.section, place, normal).reshape(5, 9)
    found = flank_deviation(measured_matrix(designed, distance, deviation_unit="mm"), designed)
    return 1e3 * zeroed(found, designed.loaded).value.T


def measured_case(
    case: Case, executed: Case, name: MemberName, errors: Mapping[Side, Mapping[str, float]]
) -> dict[Side, Any]:
    """Deviations [um] of both flanks of a member, executed with errors, from those of a case."""
    real = views(executed, name)
    return {
        which: measured(designed, with_errors(real[which].loaded, errors[which]))
        for which, designed in views(case, name).items()
    }


def written(values: Array, which: Side) -> str:
    """A plain matrix of deviations as a file."""
    head = f"# flank: {which}\n# rows: root to tip\n# columns: toe to heel\n# deviation_unit: um\n"
    return head + "\n".join("; ".join(f"{value:.4f}" for value in row) for row in values) + "\n"
