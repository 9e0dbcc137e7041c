"""Measured flanks of a case's members, one or both of each, from files, datasets or deviations."""

from __future__ import annotations

import os
from collections.abc import Mapping, Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any

import xarray as xr

from ...cases.deflections import FLANKS
from ...core.checks import instance, one_of
from ...core.errors import InputError
from ...geometry.deviation.deviation import Deviation, Method
from ...geometry.formats.measuring_points import opened as open_netcdf
from ...geometry.pair.gear_pair import FlankName, GearPair, Member
from ...geometry.tooth.tooth_flanks import MemberName, Side, named_member, side
from .deviation_source import Source, flank_deviations, measured_file

MeasuredFlank = tuple[Member, Deviation]


def measured_flanks(
    pair: GearPair,
    sources: Mapping[MemberName, Source | Sequence[Source]],
    flank: FlankName | None = None,
    interpolation: Method = "spline",
) -> dict[MemberName, tuple[MeasuredFlank, ...]]:
    """Measured flanks by member: the member seen from the flank, and its deviation.

    Parameters
    ----------
    pair
        The pair, seen from the drive or the coast flanks.
    sources
        By member: one source as of ``flank_deviations``, or one for each flank. A file may hold both flanks.
    flank
        ``drive`` or ``coast``: these flanks only.
    interpolation
        Between the nodes, as in ``Deviation``.

    Raises
    ------
    InputError
        If a source cannot be used, a flank comes twice, or none of the wanted ones is there.

    Examples
    --------
    >>> from easeoff.cases import gear_pair, read_case
    >>> pair = gear_pair(read_case("fm-11x41"))
    >>> [side(member.loaded) for member, _ in measured_flanks(pair, {"gear": "fm-11x41-worn-gear"})["gear"]]
    ['convex']
    """
    instance("deviations", sources, Mapping)
    if flank is not None:
        one_of("flank", flank, FLANKS)
    found: dict[MemberName, tuple[MeasuredFlank, ...]] = {}
    for name, given in sources.items():
        listed: list[Any] = list(given) if isinstance(given, list | tuple) else [given]
        member = named_member(pair, name)
        views = {side(seen.loaded): seen for seen in (member, *_other_views(member))}
        wanted = None if flank is None else side_of(name, flank)
        own: dict[Side, MeasuredFlank] = {}
        there: list[str] = []
        for source in listed:
            opened, sides = _with_sides(source, name, member)
            there += sides
            for which, seen in views.items():
                if which not in sides or wanted not in (None, which):
                    continue
                if which in own:
                    raise InputError(f"deviation {name}: the {which} flank comes twice; give it once")
                pair_seen = replace(pair, pinion=seen) if name == "pinion" else replace(pair, gear=seen)
                own[which] = (seen, flank_deviations(pair_seen, {name: opened}, interpolation)[name])
        if not own:
            asked = f"the {wanted} flank, which the {flank} side has" if wanted else f"of {' and '.join(views)}"
            raise InputError(f"deviation {name}: must hold {asked}; it holds {', '.join(there) or 'none'}")
        found[name] = tuple(own[which] for which in views if which in own)
    return found


def side_of(member: MemberName, flank: FlankName) -> Side:
    """Side of a member that is in contact on a flank of the pair: drive has the concave pinion and the convex gear."""
    return "concave" if (member == "pinion") == (flank == "drive") else "convex"


def _other_views(member: Member) -> tuple[Member, ...]:
    return () if member.opposite is None else (member.from_opposite,)


def _with_sides(source: Source, name: MemberName, member: Member) -> tuple[Source, list[str]]:
    """A source, read if it is a measured grid, and the sides of the flanks that it holds."""
    if isinstance(source, str | Path):
        path = Path(source)
        if path.suffix == ".nc" and os.path.isfile(path):
            worn = open_netcdf(path)
            if "wear_depth" in worn:
                return source, [side_of(name, "coast" if worn.attrs.get("flank") == "coast" else "drive")]
        source = measured_file(source, member)
    if isinstance(source, xr.Dataset) and "flank" in source.dims and "row" in source.dims:
        return source, [str(value) for value in source["flank"].values]
    return source, [side(member.loaded)]
