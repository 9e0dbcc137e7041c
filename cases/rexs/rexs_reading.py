"""Reading the bevel part of REXS, the exchange format for gearbox data of the FVA: a bevel stage as a case.

The components and relations are those of ``rexs_writing``. What REXS leaves open is
decided in ``docs/engineer/reference/exchange.md``.
"""

from __future__ import annotations

import math
import os
from typing import Any

from pydantic import BaseModel

from ...core.errors import InputError
from ...geometry.pair.gear_pair import MEMBERS
from ..reading import MEAN, MID_FLANK, check_case
from ..schema.case_schema import Blank, Case, MemberTable
from ..schema.cutting_table import ANGULAR_MOTIONS, ROLL_KEYS, Cutter, Machine
from .rexs_file import Component, Model, read_model
from .rexs_vocabulary import (
    APPLICATION,
    ATTRIBUTES_READ,
    BLANK_TERMS,
    CASE_TERM,
    CUTTER_TERMS,
    FLANK_TERM,
    HAND_TERM,
    MACHINE_TERMS,
    MATERIAL_TERMS,
    MEMBER_TERMS,
    MISALIGNMENT_TERMS,
    MODIFIED_ROLL_TERM,
    MOTION_TERMS,
    STAGE_TERMS,
    Hand,
    Term,
    opposite,
    side,
)

HANDS: tuple[Hand, ...] = ("left", "right")


def read_rexs(path: str | os.PathLike[str]) -> tuple[Case, list[str]]:
    """Read the bevel stage of a REXS file (XML).

    Parameters
    ----------
    path
        The file.

    Returns
    -------
    tuple
        The case, and what in the file was not understood or not used, one entry each.

    Raises
    ------
    InputError
        If the file cannot be read, does not hold exactly one bevel stage, lacks an attribute that a case needs, or has
        values that a case does not allow.

    Examples
    --------
    >>> import tempfile
    >>> from easeoff.cases import read_case, write_rexs
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     notes = write_rexs(read_case("nasa-12x36"), f"{folder}/pair.rexs")
    ...     case, notes = read_rexs(f"{folder}/pair.rexs")
    >>> case.gear.number_of_teeth
    36
    """
    try:
        return _read(read_model(path))
    except InputError as error:
        text = str(error)
        raise InputError(text if text.startswith(str(path)) else f"{path}: {text}") from error


def _read(model: Model) -> tuple[Case, list[str]]:
    notes: list[str] = []
    stages = [r for r in model.relations if r.kind == "stage" and model.in_role(r, "stage", "bevel_stage")]
    if len(stages) != 1:
        raise InputError(f"the file holds {len(stages)} bevel stages with a relation 'stage'; a case is exactly one")
    stage = model.in_role(stages[0], "stage", "bevel_stage")
    members = [model.in_role(stages[0], role, "bevel_gear") for role in ("gear_1", "gear_2")]
    if stage is None or members[0] is None or members[1] is None:
        raise InputError("the relation 'stage' of the bevel stage does not name two components of type bevel_gear")
    pinion, gear = members[0], members[1]
    missing: list[str] = []
    if (gear.number_of(MEMBER_TERMS["number_of_teeth"]) or 1e9) < (
        pinion.number_of(MEMBER_TERMS["number_of_teeth"]) or 0
    ):
        pinion, gear = gear, pinion
        notes.append("gear_2 of the stage has fewer teeth: it is taken as the pinion")
    hand = _hand(pinion, gear, missing)
    visited = {stage.number, pinion.number, gear.number}
    tables = [
        _read_member(model, component, own, missing, notes, visited)
        for component, own in ((pinion, hand), (gear, opposite(hand)))
    ]
    if model.application == APPLICATION and stage.text(CASE_TERM) is None:
        for name, table in zip(MEMBERS, tables, strict=True):
            if MEAN in table:
                table[MID_FLANK] = table.pop(MEAN)
                notes.append(
                    f"{name}.{MID_FLANK}: an earlier easeoff wrote the thickness in the middle of the flank as "
                    f"{MEMBER_TERMS[MEAN].attribute}; write the file anew, other programs take it for another one"
                )
    if missing:
        raise InputError("these attributes are needed and missing:\n" + "\n".join(f"  {line}" for line in missing))
    data = {
        "easeoff_case": 2,
        "title": (stage.name or f"{pinion.name} {gear.name}".strip() or "bevel stage")[:200],
        "pair": _values(stage, STAGE_TERMS),
        "misalignment": _values(stage, MISALIGNMENT_TERMS),
        "pinion": {**tables[0], "hand_of_spiral": hand},
        "gear": tables[1],
    }
    return check_case(data, "the bevel stage"), notes + _not_used(model, visited)


def _hand(pinion: Component, gear: Component, missing: list[str]) -> Hand:
    """Hand of the pinion, given by itself or by its mate."""
    hands: list[Hand] = []
    for component, turn in ((pinion, False), (gear, True)):
        text = component.text(HAND_TERM)
        if text is None:
            continue
        if text not in ("left", "right"):
            raise InputError(f"{component.described(HAND_TERM)} = {text!r}: must be one of left, right")
        hand: Hand = "left" if text == "left" else "right"
        hands.append(opposite(hand) if turn else hand)
    if len(set(hands)) > 1:
        raise InputError(f"{gear.described(HAND_TERM)}: both members have the same hand; they must be of opposite hand")
    if not hands:
        missing.append(pinion.described(HAND_TERM))
        return "left"
    return hands[0]


def _values(component: Component, terms: dict[str, Term]) -> dict[str, Any]:
    """Keys of a table for the attributes that a component has."""
    found = {key: component.number_of(term) for key, term in terms.items()}
    return {key: value for key, value in found.items() if value is not None}


def _needed(
    component: Component, table: type[BaseModel], terms: dict[str, Term], missing: list[str], *also: str
) -> dict[str, Any]:
    """The same, with a list of those that must be there and are not."""
    values = _values(component, terms)
    for key, term in terms.items():
        field = table.model_fields[key]
        if key not in values and (field.is_required() or key in also):
            missing.append(component.described(term))
        elif key in values and field.annotation is int:
            if not values[key].is_integer():
                raise InputError(f"{component.described(term)} = {values[key]}: must be a whole number")
            values[key] = int(values[key])
    return values


def _read_member(
    model: Model, gear: Component, hand: Hand, missing: list[str], notes: list[str], visited: set[int]
) -> dict[str, Any]:
    table = _needed(gear, MemberTable, MEMBER_TERMS, missing)
    table["blank"] = _needed(gear, Blank, BLANK_TERMS, missing)
    for relation in model.related("reference", "origin", gear.number):
        steel = model.in_role(relation, "referenced", "material")
        if steel is not None:
            visited.add(steel.number)
            table["material"] = _values(steel, MATERIAL_TERMS)
    for relation in model.related("flank", "gear", gear.number):
        for role in HANDS:
            flank = model.in_role(relation, role, "bevel_gear_flank")
            if flank is None:
                continue
            visited.add(flank.number)
            name = flank.text(FLANK_TERM) or side(hand, role)
            settings = _read_flank(model, flank, missing, notes, visited)
            if settings is None:
                continue
            if name not in ("concave", "convex") or name in table:
                raise InputError(f"{flank.described(FLANK_TERM)} = {name!r}: must be one of concave, convex, once each")
            table[name] = settings
            if flank.text(FLANK_TERM) is None:
                notes.append(
                    f"component {flank.number} (bevel_gear_flank): the {role} flank is taken as the {name} one, seen "
                    "from the heel; REXS does not say from where"
                )
    return table


def _read_flank(
    model: Model, flank: Component, missing: list[str], notes: list[str], visited: set[int]
) -> dict[str, Any] | None:
    """Machine and cutter of a flank; ``None`` if it has none."""
    steps = model.related("manufacturing_step", "workpiece", flank.number)
    if not steps:
        return None
    if len(steps) > 1:
        notes.append(
            f"component {flank.number} (bevel_gear_flank): the last of {len(steps)} manufacturing steps is used"
        )
    tool = model.in_role(steps[-1], "tool", "bevel_gear_tool")
    made = model.in_role(steps[-1], "manufacturing_settings", "bevel_gear_manufacturing_settings")
    if tool is None or made is None:
        raise InputError(
            f"component {flank.number} (bevel_gear_flank): its manufacturing step names no bevel_gear_tool or no "
            "bevel_gear_manufacturing_settings"
        )
    visited |= {tool.number, made.number}
    machine = _needed(made, Machine, MACHINE_TERMS, missing, "radial_distance", "cradle_angle")
    if not machine.get("ratio_of_roll"):
        if "ratio_of_roll" not in machine:
            notes.append(
                f"component {made.number} ({made.kind}): has no ratio_of_roll, so that the member is taken as Formate"
            )
        machine.pop("ratio_of_roll", None)
    roll = made.numbers_of(MODIFIED_ROLL_TERM)
    if any(roll[len(ROLL_KEYS) :]):
        raise InputError(
            f"{made.described(MODIFIED_ROLL_TERM)}: has more than {len(ROLL_KEYS)} coefficients other than zero"
        )
    machine |= {key: c * math.factorial(n) for n, (key, c) in enumerate(zip(ROLL_KEYS, roll, strict=False), start=2)}
    motions = {}
    for key, term in MOTION_TERMS.items():
        unit = math.degrees(1.0) if key in ANGULAR_MOTIONS else 1.0
        if coefficients := made.numbers_of(term):
            motions[key] = tuple(unit * c * math.factorial(n) for n, c in enumerate(coefficients, start=1))
    if any(roll) or any(any(values) for values in motions.values()):
        notes.append(
            f"component {made.number} ({made.kind}): coefficients of modified roll and motions are taken as those of "
            "powers of the cradle increment in rad, as the page on exchange says; REXS does not define them"
        )
    machine["motions"] = motions
    return {"machine": machine, "cutter": _needed(tool, Cutter, CUTTER_TERMS, missing)}


def _not_used(model: Model, visited: set[int]) -> list[str]:
    """Attributes and components of the file that the case does not hold."""
    notes = []
    for number in sorted(visited):
        component = model.components[number]
        unknown = [name for name in component.attributes if name not in ATTRIBUTES_READ[component.kind]]
        if unknown:
            notes.append(f"component {number} ({component.kind}): not used: {', '.join(unknown)}")
    others = [component.kind for number, component in model.components.items() if number not in visited]
    for kind in sorted(set(others)):
        notes.append(f"not used: components of type {kind} ({others.count(kind)})")
    if model.loaded:
        notes.append("not used: the load spectrum")
    return notes
