"""The corrected case: corrective settings of every measured set-up, and the case with the settings to be executed.

Measured flanks of a case's members, one or both of each, from files, datasets or deviations.
"""

from __future__ import annotations

import os
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import xarray as xr

from ..cases.conversion import given_pair
from ..cases.deflections import FLANKS
from ..cases.schema.case_schema import Case
from ..cases.writing import flank_settings
from ..core.checks import instance, number, one_of, truth
from ..core.errors import GeometryError, InputError
from ..core.netcdf_file import read_dataset
from ..geometry.deviation.corrective_settings import Correction, corrective_settings
from ..geometry.deviation.deviation import Deviation, Method
from ..geometry.pair.gear_pair import FlankName, GearPair, Member, shares_set_up
from ..geometry.tooth.tooth_flanks import MemberName, Side, named_member, side
from .deviations import Source, flank_deviations, measured_file

MeasuredFlank = tuple[Member, Deviation]


def measured_flanks(
    pair: GearPair,
    sources: Mapping[MemberName, Source | Sequence[Source]],
    flank: FlankName | None = None,
    interpolation: Method = "spline",
) -> dict[MemberName, tuple[MeasuredFlank, ...]]:
    """Measured flanks by member: the member seen from the flank, and its deviation.

    A member has one source, as of ``flank_deviations``, or one for each flank; a file may hold both flanks. With
    ``flank`` only those in contact on that side of the pair, of which one must be there.
    """
    instance("deviations", sources, Mapping)
    if flank is not None:
        one_of("flank", flank, FLANKS)
    members: dict[MemberName, tuple[MeasuredFlank, ...]] = {}
    for name, given in sources.items():
        listed: list[Any] = list(given) if isinstance(given, list | tuple) else [given]
        member = named_member(pair, name)
        both = (member,) if member.opposite is None else (member, member.from_opposite)
        views = {side(seen.loaded): seen for seen in both}
        wanted = None if flank is None else side_of(name, flank)
        flanks: dict[Side, MeasuredFlank] = {}
        there: list[str] = []
        for source in listed:
            opened, sides = _with_sides(source, name, member)
            there += sides
            for which, seen in views.items():
                if which not in sides or wanted not in (None, which):
                    continue
                if which in flanks:
                    raise InputError(f"deviation {name}: the {which} flank comes twice; give it once")
                pair_seen = replace(pair, pinion=seen) if name == "pinion" else replace(pair, gear=seen)
                flanks[which] = (seen, flank_deviations(pair_seen, {name: opened}, interpolation)[name])
        if not flanks:
            asked = f"the {wanted} flank, which the {flank} side has" if wanted else f"of {' and '.join(views)}"
            raise InputError(f"deviation {name}: must hold {asked}; it holds {', '.join(there) or 'none'}")
        members[name] = tuple(flanks[which] for which in views if which in flanks)
    return members


def side_of(member: MemberName, flank: FlankName) -> Side:
    """Side of a member that is in contact on a flank of the pair: drive has the concave pinion and the convex gear."""
    return "concave" if (member == "pinion") == (flank == "drive") else "convex"


def _with_sides(source: Source, name: MemberName, member: Member) -> tuple[Source, list[str]]:
    """A source, read if it is a measured grid, and the sides of the flanks that it holds."""
    if isinstance(source, str | Path):
        path = Path(source)
        if path.suffix == ".nc" and os.path.isfile(path):
            worn = read_dataset(path)
            if "wear_depth" in worn:
                return source, [side_of(name, "coast" if worn.attrs.get("flank") == "coast" else "drive")]
        source = measured_file(source, member)
    if isinstance(source, xr.Dataset) and "flank" in source.dims and "row" in source.dims:
        return source, [str(value) for value in source["flank"].values]
    return source, [side(member.loaded)]


@dataclass(frozen=True)
class CaseCorrection:
    """Corrections of a case.

    Parameters
    ----------
    case
        The case with the settings to be executed.
    corrections
        By member: one correction a set-up.

    Examples
    --------
    >>> from easeoff.cases import read_case
    >>> corrected = correct_case(read_case("fm-11x41"), {"gear": "fm-11x41-worn-gear"}, free=["machine_root_angle"])
    >>> isinstance(corrected, CaseCorrection), list(corrected.corrections)
    (True, ['gear'])
    """

    case: Case
    corrections: dict[MemberName, tuple[Correction, ...]]


def correct_case(
    case: Case,
    deviations: Mapping[MemberName, Source | Sequence[Source]],
    *,
    flank: FlankName | None = None,
    free: Sequence[str] | None = None,
    shared: bool | None = None,
    thickness: Mapping[MemberName, float] | None = None,
    rounded: bool = True,
    interpolation: Method = "spline",
) -> CaseCorrection:
    """Correct the machine settings of a case for measured flanks.

    Flanks that share a set-up are corrected together; where only one of them was measured, the other one changes with
    it. Flanks with set-ups of their own are corrected each by itself.

    Parameters
    ----------
    case
        The case as designed.
    deviations
        By member: one source as of ``flank_deviations``, or one for each flank. A file may hold both flanks.
    flank
        ``drive`` or ``coast``: only these flanks are corrected.
    free
        Settings that may change, see ``named_settings``; ``usual_settings``, without blades, if left out.
    shared
        Whether both flanks of a member are cut in one set-up; if left out, whether their settings are equal.
    thickness
        By member: by how much the normal circular thickness in the middle of the tooth was measured to be above the
        one designed [um]; only of a set-up with both flanks measured.
    rounded
        Whether the corrected settings are rounded to the resolution of the machine.
    interpolation
        Between the nodes, as in ``Deviation``.

    Raises
    ------
    InputError
        If a deviation cannot be used, or a setting cannot be moved; the message names the member.
    GeometryError
        If the corrected settings cut no flank.

    Examples
    --------
    >>> from easeoff.cases import read_case
    >>> corrected = correct_case(read_case("fm-11x41"), {"gear": "fm-11x41-worn-gear"}, free=["machine_root_angle"])
    >>> correction, = corrected.corrections["gear"]
    >>> corrected.case.gear.convex.machine.machine_root_angle == corrected.case.gear.concave.machine.machine_root_angle
    True
    """
    instance("case", case, Case)
    pair = given_pair(case)
    measured = measured_flanks(pair, deviations, flank, interpolation)
    instance("thickness", thickness, Mapping | None)
    thicknesses = dict(thickness or {})
    for name, value in thicknesses.items():
        number(f"thickness {name}", value, "um")
        if name not in measured:
            raise InputError(f"thickness {name} = {value:g} um: must be of a member with measured flanks")
    corrections = {}
    for name, flanks in measured.items():
        excess = thicknesses.get(name)
        options: dict[str, Any] = {"free": free, "rounded": rounded, "shared": shared}
        options["thickness"] = None if excess is None else 1e-3 * excess
        try:
            corrections[name] = _member_corrections(flanks, options)
        except (InputError, GeometryError) as error:
            raise type(error)(f"{name}: {error}") from error
    corrected = case
    for name, member_corrections in corrections.items():
        corrected = _with_corrections(corrected, name, member_corrections)
    return CaseCorrection(corrected, corrections)


def _member_corrections(flanks: Sequence[MeasuredFlank], options: dict[str, Any]) -> tuple[Correction, ...]:
    (member, deviation), *others = flanks
    shared = options["shared"]
    one = shares_set_up(member) if shared is None else truth("shared", shared)
    if one and others:
        return (corrective_settings(member, deviation, opposite=others[0][1], **options),)
    return tuple(corrective_settings(seen, flank_deviation, **options) for seen, flank_deviation in flanks)


def _with_corrections(case: Case, name: MemberName, corrections: Sequence[Correction]) -> Case:
    """The case with the corrected settings of a member; what its flanks were fitted to is no longer theirs."""
    table = getattr(case, name)
    changed = [correction for correction in corrections if not correction.nothing]
    if not changed:
        return case
    surfaces = {which: surface for correction in changed for which, surface in correction.surfaces.items()}
    try:
        update = {which: flank_settings(surface, table.number_of_teeth) for which, surface in surfaces.items()}
    except ValueError as error:  # a setting beyond what a case may hold
        lines = [line.strip() for line in str(error).splitlines() if line.strip()]
        raise InputError(f"{name}: the corrected settings cannot stand in a case: {'; '.join(lines[1:3])}") from error
    sides: tuple[FlankName, ...] = ("drive", "coast")
    dropped: dict[str, Any] = {flank: None for flank in sides if side_of(name, flank) in surfaces}
    now = {*case.corrected_flanks, *(f"{name} {which}" for which in surfaces)}
    return case.model_copy(
        update={
            name: table.model_copy(update=update),
            "target": case.target.model_copy(update=dropped),
            "corrected_flanks": tuple(sorted(now)),
        }
    )
