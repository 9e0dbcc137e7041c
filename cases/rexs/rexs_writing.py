"""Writing the bevel part of REXS, the exchange format for gearbox data of the FVA: a case as a bevel stage.

A ``bevel_stage`` joins two ``bevel_gear`` components by the relation ``stage``. Every gear has two ``bevel_gear_flank``
components (relation ``flank``), and every flank the ``bevel_gear_tool`` and the ``bevel_gear_manufacturing_settings``
it is cut with (relation ``manufacturing_step``). Contact points of a result are a ``point_list`` of the gear's
``bevel_stage_gear_data``, their values a ``meshing_contact_stage_data_set``. What REXS leaves open is decided in
``docs/engineer/reference/exchange.md``.
"""

from __future__ import annotations

import datetime
import math
import os
from collections.abc import Mapping
from dataclasses import dataclass
from importlib.metadata import version

import numpy as np
from pydantic import BaseModel

from ...core.arrays import Array
from ...core.checks import instance
from ...core.errors import EaseoffError
from ...core.output_file import whole_file
from ...geometry.pair.gear_pair import MEMBERS, FlankName
from ..conversion import machine_settings
from ..reading import MID_FLANK
from ..schema.case_schema import MATING_SIDES, Case, MemberTable
from ..schema.cutting_table import ANGULAR_MOTIONS, Cutter, FlankSettings, polynomial
from ..writing import with_blanks, with_mean_thickness
from . import rexs_vocabulary as rexs
from .rexs_reading import HANDS, ModelWriter, Value
from .rexs_vocabulary import Hand, Term, opposite, side

#: Keys of a case that a file holds, or that have a note of their own.
HELD = ("easeoff_case", "title", "pair", "blank_design", "pinion", "gear", "misalignment", "supports")


@dataclass(frozen=True)
class ContactPoints:
    """Contact points of a result, with their values by the keys of ``CONTACT_TERMS``."""

    name: str
    flank: FlankName
    points: Array  # (n, 3) on the gear flank, in the frame of the gear [mm]
    values: Mapping[str, Array]  # (n)
    backlash: Mapping[str, float]  # those known, by the keys of ``STAGE_BACKLASH`` and ``GEAR_BACKLASH`` [mm]


def write_rexs(case: Case, path: str | os.PathLike[str], contact: ContactPoints | None = None) -> list[str]:
    """Write the geometry of a case as a REXS file (XML, version 2.0.0).

    Parameters
    ----------
    case
        A checked case.
    path
        The file; REXS asks for the suffix ``.rexs``.
    contact
        Contact points of a result of the case, written with it.

    Returns
    -------
    list of str
        Data that REXS cannot hold: left out, or written as an attribute that other programs do not know.

    Raises
    ------
    InputError
        If the file cannot be written.

    Examples
    --------
    >>> import tempfile
    >>> from easeoff.cases import read_case
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     notes = write_rexs(read_case("nasa-12x36"), f"{folder}/pair.rexs")
    >>> notes[0]
    'pinion.blank.front_angle: written as custom_easeoff_front_angle, which other programs do not know'
    """
    instance("case", case, Case)
    notes: list[str] = []
    if case.blank_design is not None:
        notes.append("blank_design: written as the blanks it gives")
        case = with_blanks(case)
    given = [f"{name}.{MID_FLANK}" for name in MEMBERS if getattr(getattr(case, name), MID_FLANK) is not None]
    try:
        case = with_mean_thickness(case)
        notes += [f"{key}: written as that at the mean point" for key in given]
    except EaseoffError as error:
        notes += [f"{key}: left out, the teeth have none at the mean point ({error})" for key in given]
    file = ModelWriter(
        version=rexs.REXS_VERSION,
        applicationId=rexs.APPLICATION,
        applicationVersion=version("easeoff"),
        date=datetime.datetime.now(datetime.UTC).isoformat(timespec="seconds"),
        applicationLanguage="en",
    )
    pair = [
        (rexs.CASE_TERM, case.easeoff_case),
        *_terms(case.pair, rexs.STAGE_TERMS),
        *((t, v) for t, v in _terms(case.misalignment, rexs.MISALIGNMENT_TERMS) if v),
    ]
    stage = file.component("bevel_stage", case.title, pair)
    hand = case.pinion.hand_of_spiral
    pinion = _write_member(file, "pinion", case.pinion, hand, notes)
    gear = _write_member(file, "gear", case.gear, opposite(hand), notes)
    file.relation("stage", stage=stage, gear_1=pinion, gear_2=gear)
    if contact is not None:
        _write_contact(file, stage, {pinion: hand, gear: opposite(hand)}, contact)

    for name in (name for name in Case.model_fields if name not in HELD):
        if getattr(case, name) != Case.model_fields[name].default:
            notes.append(f"{name}: left out, REXS cannot hold it")
    if case.misalignment.deflections:
        notes.append("misalignment.deflections: left out, REXS cannot hold it")
    if case.supports is not None:
        notes.append("supports: left out, the file holds the bevel stage alone")
    if case.pinion.number_of_teeth > case.gear.number_of_teeth:
        notes.append("number_of_teeth: a reader may take the member with fewer teeth for the pinion")
    with whole_file(path) as temporary:
        # The specification asks for a byte order mark.
        temporary.write_text(file.text(), encoding="utf-8-sig", newline="\n")
    return notes


def _write_contact(file: ModelWriter, stage: int, gears: Mapping[int, Hand], contact: ContactPoints) -> None:
    """Add which flank of the pinion and of the gear is loaded, and the points with their values to the gear."""
    gear = data = 0
    for (gear, hand), loaded in zip(gears.items(), MATING_SIDES[contact.flank], strict=True):
        role = next(role for role in HANDS if side(hand, role) == loaded)
        data = file.component("bevel_stage_gear_data", f"{loaded} flank", [(Term("loaded_tooth_flank", "none"), role)])
        file.relation("stage_gear_data", stage=stage, gear=gear, stage_gear_data=data)
    for number, terms in ((stage, rexs.STAGE_BACKLASH), (gear, rexs.GEAR_BACKLASH)):
        file.add(number, [(term, contact.backlash[key]) for key, term in terms.items() if key in contact.backlash])
    x, y, z = contact.points.T
    columns = {Term(f"point_coordinates_{axis}_coord", "mm"): at for axis, at in zip("uvw", (z, -y, x), strict=True)}
    numbers = range(1, len(contact.points) + 1)
    kind = (Term("kind_of_point_list", "none"), "meshing_contact_points")
    attributes = [kind, *_arrays({Term("point_ids", "none"): numbers, **columns})]
    points = file.component("point_list", contact.name, attributes)
    file.relation("assembly", assembly=data, part=points)
    columns = {term: contact.values[key] for key, term in rexs.CONTACT_TERMS.items() if key in contact.values}
    attributes = _arrays({Term("set_ids", "none"): numbers, **columns})
    values = file.component("meshing_contact_stage_data_set", contact.name, attributes)
    file.relation("reference", origin=points, referenced=values)


def _arrays(columns: Mapping[Term, Array | range]) -> list[tuple[Term, Value]]:
    return [(term, tuple(np.asarray(column).tolist())) for term, column in columns.items()]


def _terms(table: BaseModel, terms: dict[str, Term]) -> list[tuple[Term, Value]]:
    """Attributes of the keys of a table that have a value."""
    return [(term, value) for key, term in terms.items() if (value := getattr(table, key)) is not None]


def _noted(where: str, table: BaseModel, terms: dict[str, Term], notes: list[str]) -> list[tuple[Term, Value]]:
    """The same without the keys that have their default, with a note on those that REXS does not know."""
    result = []
    for key, term in terms.items():
        value, field = getattr(table, key), type(table).model_fields[key]
        if value is None or (not field.is_required() and value == field.default and term.custom):
            continue
        if term.custom:
            notes.append(f"{where}.{key}: written as {term.attribute}, which other programs do not know")
        result.append((term, value))
    return result


def _write_member(file: ModelWriter, name: str, table: MemberTable, hand: Hand, notes: list[str]) -> int:
    assert table.blank is not None  # see ``with_blanks``
    attributes = [
        *_terms(table, rexs.MEMBER_TERMS),
        (rexs.HAND_TERM, hand),
        *_noted(f"{name}.blank", table.blank, rexs.BLANK_TERMS, notes),
    ]
    gear = file.component("bevel_gear", name, attributes)
    steel = file.component("material", f"material of the {name}", _terms(table.material, rexs.MATERIAL_TERMS))
    file.relation("reference", origin=gear, referenced=steel)
    flanks: dict[str, int] = {}
    for flank in ("concave", "convex"):
        # A relation has to name both flanks, so that a flank which the case lacks is there without settings.
        flanks[flank] = file.component("bevel_gear_flank", f"{name} {flank}", [(rexs.FLANK_TERM, flank)])
        settings = getattr(table, flank)
        if settings is not None:
            _write_flank(file, f"{name}.{flank}", flanks[flank], settings, notes)
    file.relation("flank", gear=gear, left=flanks[side(hand, "left")], right=flanks[side(hand, "right")])
    return gear


def _write_flank(file: ModelWriter, where: str, flank: int, settings: FlankSettings, notes: list[str]) -> None:
    machine = settings.machine
    if machine.horizontal_distance is not None:
        polar = machine_settings(machine)
        center = {"radial_distance": polar.radial_distance, "cradle_angle": math.degrees(polar.cradle_angle)}
        machine = machine.model_copy(update=center)
        notes.append(
            f"{where}.machine: horizontal_distance and vertical_distance are written as radial_distance and "
            "center_roll_position"
        )
    attributes = [(t, v) for t, v in _terms(machine, rexs.MACHINE_TERMS) if t != rexs.MACHINE_TERMS["ratio_of_roll"]]
    attributes.append((rexs.MACHINE_TERMS["ratio_of_roll"], machine.ratio_of_roll or 0.0))
    if any(machine.modified_roll):
        attributes.append((rexs.MODIFIED_ROLL_TERM, polynomial(machine.modified_roll, 2)))
    for term, value in _noted(f"{where}.machine.motions", machine.motions, rexs.MOTION_TERMS, notes):
        assert isinstance(value, tuple)
        unit = math.radians(1.0) if term in [rexs.MOTION_TERMS[key] for key in ANGULAR_MOTIONS] else 1.0
        if value:
            attributes.append((term, polynomial(value, unit=unit)))
    tool = file.component("bevel_gear_tool", where, _noted(f"{where}.cutter", settings.cutter, _used(settings), notes))
    made = file.component("bevel_gear_manufacturing_settings", where, attributes)
    file.relation("manufacturing_step", order=1, workpiece=flank, tool=tool, manufacturing_settings=made)


def _used(settings: FlankSettings) -> dict[str, Term]:
    """Attributes of the blade that say something: those of a plain blade's zero radii and angles REXS excludes."""
    plain = {key for key, field in Cutter.model_fields.items() if getattr(settings.cutter, key) == field.default}
    return {key: term for key, term in rexs.CUTTER_TERMS.items() if key not in plain}
