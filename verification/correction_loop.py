"""The loop of the shop floor: cut with wrong settings, measure, correct, cut with the same errors, measure again.

Flanks are cut anew from the settings of the corrected case and measured along their normals; nothing of the fit's own
prediction is used.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np

from ..cases.conversion import gear_pair
from ..cases.schema.case_schema import Case
from ..core.arrays import RealArray as Array, record
from ..core.checks import instance, number, positive
from ..geometry.cutting.generating_surface import GeneratingSurface
from ..geometry.cutting.named_settings import get_setting, with_settings
from ..geometry.flanks.flank import solve_flank
from ..geometry.formats.measured_grid import flank_deviation, measured_matrix
from ..geometry.pair.gear_pair import Member
from ..geometry.tooth.tooth_flanks import MemberName, Side, named_member, side
from ..geometry.vectors import rotate_z
from ..study.case_correction import CaseCorrection, correct_case
from .envelope_condition import distance_along_normals

SIDES: tuple[Side, ...] = ("concave", "convex")


@record(frozen=True)
class CorrectionLoop:
    """A member before and after its correction.

    Parameters
    ----------
    correction
        Case with its corrected settings.
    before, after
        Deviations of each flank (rows, columns) [um], cut with the same errors of the machine.

    Examples
    --------
    >>> from easeoff.cases import read_case
    >>> errors = dict.fromkeys(("concave", "convex"), {"machine_root_angle": 1e-3})
    >>> loop = correction_loop(read_case("fm-11x41"), "gear", errors)
    >>> isinstance(loop, CorrectionLoop), sorted(loop.after)
    (True, ['concave', 'convex'])
    """

    correction: CaseCorrection
    before: dict[Side, Array]
    after: dict[Side, Array]

    @property
    def left(self) -> float:
        """Greatest deviation after over before."""
        return greatest(self.after) / greatest(self.before)


def greatest(values: Mapping[Side, Array]) -> float:
    """Greatest deviation of both flanks [um]."""
    return max(float(np.max(np.abs(value))) for value in values.values())


def correction_loop(
    case: Case, member: MemberName, errors: Mapping[Side, Mapping[str, float]], noise: float = 0.0, **options: Any
) -> CorrectionLoop:
    """Cut a member with errors, measure, correct, and cut it with the corrected settings and the same errors.

    Parameters
    ----------
    case
        The case as designed.
    member
        ``pinion`` or ``gear``, with both flanks.
    errors
        Errors of the machine that cuts each flank, by setting: mm, rad or per radian.
    noise
        Root mean square of the measuring errors of single points [um].
    **options
        Passed to ``study.correct_case``.

    Raises
    ------
    InputError, GeometryError
        As ``study.correct_case``; and if the errors cut no flank.

    Examples
    --------
    >>> from easeoff.cases import read_case
    >>> errors = dict.fromkeys(("concave", "convex"), {"machine_root_angle": 1e-3})
    >>> correction_loop(read_case("fm-11x41"), "gear", errors).left < 0.03
    True
    """
    instance("case", case, Case)
    instance("errors", errors, Mapping)
    for which in SIDES:
        instance(f"errors of the {which} flank", errors.get(which), Mapping)
        for name, by in errors[which].items():
            number(f"error {name}", by)
    positive("noise", noise, "um", zero=True)
    before = measured_case(case, case, member, errors)
    random = np.random.default_rng(7)
    noisy = {which: value + noise * random.normal(size=value.shape) for which, value in before.items()}
    correction = correct_case(case, {member: grids(case, member, noisy)}, **options)
    return CorrectionLoop(correction, before, measured_case(case, correction.case, member, errors))


def grids(case: Case, member: MemberName, values: Mapping[Side, Array]) -> list[Any]:
    """Measured grids of a member from deviations [um] by flank."""
    return [measured_matrix(seen, values[which], which) for which, seen in views(case, member).items()]


def views(case: Case, name: MemberName) -> dict[Side, Member]:
    """A member seen from both of its flanks."""
    member = named_member(gear_pair(case), name)
    return {side(seen.loaded): seen for seen in (member, member.from_opposite)}


def with_errors(surface: GeneratingSurface, errors: Mapping[str, float]) -> GeneratingSurface:
    """The flank that a machine with errors cuts at the settings of a surface."""
    return with_settings(surface, {name: get_setting(surface, name) + by for name, by in errors.items()})


def measured(designed: Member, real: GeneratingSurface) -> Array:
    """Deviations (rows, columns) [um] that a machine measures along the normals, the tooth turned to its middle."""
    # The points of a plain matrix: those of both flanks, which end at one height above the root.
    grid = flank_deviation(measured_matrix(designed, np.zeros((5, 9))), designed)
    surface, section = designed.loaded.designed, designed.section
    nominal = solve_flank(surface, section, grid.axial.ravel(), grid.radial.ravel())
    middle = section.points(np.array([0.5]), np.array([0.5]))
    places = (solve_flank(flank, section, *middle).position for flank in (real, surface))
    made, wanted = (np.arctan2(place[1], place[0]) for place in places)
    # The points are turned to the flank, as the tooth would be turned back: then its middle has no deviation.
    turn = np.broadcast_to(made - wanted, grid.value.size)
    place, normal = rotate_z(turn, nominal.position), rotate_z(turn, nominal.normal)
    return np.asarray(1e3 * distance_along_normals(real, section, place, normal).reshape(grid.value.shape).T)


def measured_case(
    case: Case, executed: Case, name: MemberName, errors: Mapping[Side, Mapping[str, float]]
) -> dict[Side, Any]:
    """Deviations [um] of both flanks of a member, executed with errors, from those of a case."""
    real = views(executed, name)
    return {
        which: measured(designed, with_errors(real[which].loaded, errors[which]))
        for which, designed in views(case, name).items()
    }
