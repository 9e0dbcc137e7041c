"""Warnings of a pair as its blanks and settings cut it: undercut, blade tips off the root, thin tips, narrow slots."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ...cases.conversion import gear_pair
from ...cases.schema.case_schema import Case
from ...contact.compliance.finite_elements.finite_element_tooth import require_solid_shell
from ...core.errors import GeometryError, InputError
from ...geometry.design.edge_radius import require_whole_tooth
from ...geometry.design.pair_design import BOTH_MEMBERS, SIDES
from ...geometry.design.tooth_proportions import measured_proportions
from ...geometry.flanks.flank import Flank, NodeStatus
from ...geometry.pair.gear_pair import MEMBERS, GearPair, Member, bodies
from ...geometry.pair.tip_mates import unmet_tips
from ...geometry.pair.tooth_thickness import contradictions
from ...geometry.tooth.tooth_flanks import MemberName
from .tooth_spaces import ToothSpaces, tooth_spaces

Array = NDArray[Any]
TOP_LAND_LIMIT = 0.2  # over the module; a smaller top land is narrow
UNMET_LIMIT = 0.02  # share of a tip; a corner at the toe does no harm


def case_warnings(case: Case) -> tuple[ToothSpaces | None, tuple[str, ...]]:
    """Top lands, slots and fillets of a case, and what is doubtful of its teeth, a sentence each.

    Parameters
    ----------
    case
        A checked case.

    Returns
    -------
    tuple
        The tooth spaces, ``None`` where they cannot be measured, and the warnings, of which one says why.

    Examples
    --------
    >>> from easeoff.cases import read_case
    >>> case = read_case("fm-11x41")
    >>> shells = case.compliance.model_copy(update={"model": "shell"})
    >>> case_warnings(case.model_copy(update={"compliance": shells}))[1]
    ()
    """
    try:
        drive, coast = (gear_pair(case, side) for side in SIDES)
        proportions = measured_proportions(drive)
    except (InputError, GeometryError) as error:
        return None, (f"the teeth are not checked: {error}",)
    warnings = [*contradictions(drive), *narrow_top_lands(drive, proportions.mean_normal_module)]
    warnings += [text for _, text in unfinished_teeth(drive, case.compliance.model)]
    for side, pair in zip(SIDES, (drive, coast), strict=True):
        warnings += [f"{side}: {text}" for _, text in missing_flanks(unmet_tips(pair))]
    try:
        spaces = tooth_spaces(drive, coast, proportions)
    except GeometryError as error:
        return None, (*warnings, f"top lands, slots and fillets are not checked: {error}")
    for name, lands in zip(MEMBERS, spaces.measured, strict=True):
        for side, gap in zip(SIDES, lands.root_line, strict=True):
            warnings += [f"{side}: {text}" for text in off_the_root(name, gap, proportions.clearance)]
    return spaces, (*warnings, *spaces.warnings())


def unusual_set_ups(case: Case) -> tuple[str, ...]:
    """Flanks of the pinion in a set-up that no method of a design for the shop makes, in one line or none.

    Fixed setting and modified roll have no tilt, tilt has no modified roll, and completing has both on one machine for
    both flanks. The closest fit, and settings freed by hand, may give each flank a tilt and a modified roll of its own.

    Parameters
    ----------
    case
        A checked case.

    Examples
    --------
    >>> from easeoff.cases import read_case
    >>> len(unusual_set_ups(read_case("fm-11x41"))), unusual_set_ups(read_case("nasa-12x36"))
    (1, ())
    """
    concave, convex = case.pinion.concave, case.pinion.convex
    if concave is None or convex is None or concave.machine == convex.machine:
        return ()
    found = [
        name
        for name, machine in (("concave", concave.machine), ("convex", convex.machine))
        if machine.cutter_tilt and (any(machine.modified_roll) or any(machine.motions.model_dump().values()))
    ]
    if not found:
        return ()
    flanks, own = ("flanks have", "set-ups of their own") if len(found) > 1 else ("flank has", "a set-up of its own")
    return (
        f"Note: the pinion's {' and '.join(found)} {flanks} tilt and modified roll in {own}, as the closest fit "
        "gives for analysis; the methods of the shop (fixed_setting, modified_roll, tilt, completing) make none such",
    )


def uncut_share(flank: Flank) -> float:
    """Share of a flank's nodes that are undercut or out of the cutter's reach."""
    return float(np.mean(np.isin(flank.status, (NodeStatus.UNDERCUT, NodeStatus.NO_SOLUTION))))


def missing_flanks(unmet: tuple[float, float]) -> Iterator[tuple[MemberName, str]]:
    """Members whose flank ends before the mate's tip has passed it, each with a warning.

    Parameters
    ----------
    unmet
        Of ``unmet_tips``.
    """
    for name, mate, share in zip(reversed(BOTH_MEMBERS), BOTH_MEMBERS, unmet, strict=True):
        if not share <= UNMET_LIMIT:
            yield (
                name,
                f"the {mate}'s tip meets no flank on {100 * share:.0f} % of its length: there the {name}'s root is "
                "undercut, or its fillet reaches too high",
            )


def off_the_root(member: str, gap: Array, clearance: float, advice: str = "") -> Iterator[str]:
    """Warnings of blade tips off the root cone, and of places where no root was found.

    Parameters
    ----------
    member
        Its name.
    gap
        Height of the blade tips above the root cone at toe, middle and heel (3) [mm].
    clearance
        Of the pair [mm].
    advice
        What helps against tips off the cone.
    """
    found = np.isfinite(gap)
    if np.any(np.abs(gap[found]) > clearance):
        yield (
            f"the {member}'s blade tips deviate up to {np.abs(gap[found]).max():.2f} mm from its root cone, more than "
            f"the clearance of {clearance:.2f} mm{advice}"
        )
    if not np.all(found):
        places = " and ".join(name for name, known in zip(("toe", "middle", "heel"), found, strict=True) if not known)
        yield f"the {member} has no flank near its root at the {places}: it is undercut or not reached"


def narrow_top_lands(pair: GearPair, module: float) -> Iterator[str]:
    """Warnings of narrow top lands, or of members that have no tooth between their flanks.

    Parameters
    ----------
    pair
        The pair.
    module
        Mean normal module [mm].
    """
    try:
        both = bodies(pair)
    except GeometryError as error:
        yield str(error)
        return
    for name, body in zip(MEMBERS, both, strict=True):
        for end, thickness in zip(("toe", "heel"), body.thickness[:, 1], strict=True):
            if not thickness >= TOP_LAND_LIMIT * module:
                yield f"the {name}'s tooth has a narrow top land at the {end}: {thickness:.2f} mm"


def unfinished_teeth(pair: GearPair, model: str) -> Iterator[tuple[MemberName, str]]:
    """Members without the whole tooth that a model of the elastic teeth needs, each with the reason.

    Parameters
    ----------
    pair
        The pair, with both flanks of both members.
    model
        Of the elastic teeth.
    """
    for name in BOTH_MEMBERS:
        try:
            if model == "shell":
                require_whole_tooth(pair, name)
            else:
                require_elastic_tooth(pair, name)
        except GeometryError as error:
            yield name, str(error) if f"the {name}'s" in str(error) else f"the {name} has no whole tooth: {error}"


def require_elastic_tooth(pair: GearPair, member: MemberName) -> None:
    """Refuse a tooth that the default compliance cannot take, loaded on either flank."""
    for loaded in (pair, _from_the_other_side(pair)):
        require_solid_shell(loaded, member)


def _from_the_other_side(pair: GearPair) -> GearPair:
    def turned(member: Member) -> Member:
        assert member.opposite is not None  # a designed pair has both flanks
        return replace(member, loaded=member.opposite, opposite=member.loaded)

    return replace(pair, pinion=turned(pair.pinion), gear=turned(pair.gear))
