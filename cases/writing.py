"""Writing case files.

Objects of the geometry become tables of a case, the inverse of ``conversion``, with numbers rounded to ten decimals of
a millimetre or degree, far below anything a flank feels. A case with some of its numbers changed, by their dotted keys,
is checked again.
"""

from __future__ import annotations

import hashlib
import math
import os
import re
from collections.abc import Iterator, Mapping
from functools import cache
from pathlib import Path
from typing import Any

import tomli_w
from pydantic import BaseModel, ValidationError
from pydantic.fields import FieldInfo

from ..core.checks import instance
from ..core.errors import InputError, errors_about, suggestion
from ..core.output_file import check_writable, whole_file
from ..core.regular_file import TOML_SIZE_LIMIT, read_bytes
from ..geometry.cutting.blade import Blade
from ..geometry.cutting.generating_surface import GeneratingSurface
from ..geometry.cutting.machine import MachineSettings
from ..geometry.cutting.named_settings import MACHINE_STEPS
from ..geometry.design.iso23509.blank_dimensions import MemberBlank
from ..geometry.pair.gear_pair import MEMBERS, GearPair
from ..geometry.pair.tooth_thickness import mean_cone_distances, mean_normal_thickness
from .conversion import APEX_SUFFIX, designed_blanks, given_pair
from .mistakes import refusal
from .reading import MEAN, MID_FLANK
from .schema.case_schema import Blank, Case, usual_name
from .schema.cutting_table import (
    ANGULAR_MOTIONS,
    RELIEFS,
    ROLL_KEYS,
    Cutter,
    FlankSettings,
    Machine,
    Motions,
    blade_field,
    polynomial_derivatives,
)
from .schema.schema_table import Table, angle_keys, extra_of, inner_table, kinds

SEAL = "# checksum of the lines above, as easeoff wrote them:"
SEAL_LENGTH = 12  # of the checksum [digits]


def case_toml(case: Case, comment: str = "") -> str:
    """Text of a case file that reads as the given case.

    Only the keys that must be given and those that differ from their defaults are written, in the order of the schema.
    Numbers are written with enough digits to read the same number again.

    Parameters
    ----------
    case
        A checked case.
    comment
        Lines to stand before everything else, without the comment sign.

    Examples
    --------
    >>> from easeoff.cases import parse_case, read_case
    >>> case = read_case("nasa-12x36")
    >>> parse_case(case_toml(case)).model_dump() == case.model_dump()
    True
    """
    # TOML forbids control characters other than the tab in comments.
    instance("case", case, Case)
    instance("comment", comment, str)
    lines = (re.sub(r"[\x00-\x08\x0b-\x1f\x7f]", " ", line) for line in comment.splitlines())
    head = "".join(f"# {line}".rstrip() + "\n" for line in lines)
    # Lines of text stay lines, unless they end in a way that TOML would turn into plain line feeds.
    readable = "\r" not in case.title + case.description
    return head + tomli_w.dumps(case.model_dump(exclude_defaults=True), multiline_strings=readable)


def _sealed(text: str) -> str:
    """Text of an input file with a last line by which ``require_replaceable`` knows that nobody edited it."""
    return f"{text}{SEAL} {hashlib.sha256(text.encode()).hexdigest()[:SEAL_LENGTH]}\n"


def write_sealed(text: str, path: str | os.PathLike[str]) -> None:
    """Write an input file, whole or not at all, with a last line that shows edits; it must end with a line feed."""
    with whole_file(path) as temporary:
        temporary.write_text(_sealed(text), encoding="utf-8", newline="\n")


def require_replaceable(path: str | os.PathLike[str], force: bool = False) -> None:
    """Refuse, unless forced, to replace an input file written by hand or edited after easeoff wrote it."""
    if force or not os.path.exists(path):
        return
    try:
        head, seal, _ = (text := read_bytes(path, TOML_SIZE_LIMIT).decode()).rpartition(SEAL)
    except (InputError, UnicodeDecodeError):
        head, seal, text = "", "", ""
    if not seal or _sealed(head) != text:
        why = "was edited after easeoff wrote it" if seal else "was not written by easeoff"
        raise InputError(f"{path} {why}: give another name, or --force to replace it")


def write_case(case: Case, path: str | os.PathLike[str], comment: str = "") -> None:
    """Write a case file, whole or not at all; see ``case_toml``.

    Its last line is a checksum, a comment: the command line does not replace a file that was edited since.

    If the case takes its oil from a file by a relative path, the path is written as it is from the new file's folder.

    Raises
    ------
    InputError
        If the file cannot be written, or is the case's own file of an oil.

    Examples
    --------
    >>> import tempfile
    >>> from easeoff.cases import read_case
    >>> case = read_case("nasa-12x36")
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     write_case(case, f"{folder}/mine.toml", comment="My pair")
    ...     print(read_case(f"{folder}/mine.toml").text.splitlines()[0])
    # My pair
    """
    instance("case", case, Case)
    if case.friction is not None:
        check_writable(path, case.friction.oil_file)
        case = case.model_copy(update={"friction": case.friction.seen_from(Path(path).parent)})
    write_sealed(case_toml(case, comment), path)


def _rounded(value: float) -> float:
    return round(value, 10) + 0.0  # no minus zero


def _degrees(value: float) -> float:
    return _rounded(math.degrees(value))


def _written(table: type[Table], values: Mapping[str, float | None]) -> dict[str, Any]:
    """Values of a table by key as they are written: rounded, those in rad in degrees."""
    ways = {key: _degrees if key in angle_keys(table) else _rounded for key in values}
    return {key: None if value is None else ways[key](value) for key, value in values.items()}


def blank_table(member: MemberBlank, clearance: float) -> Blank:
    """Axial section of one member of a designed blank."""
    keys = [key for key in Blank.model_fields if key not in ("clearance", "front_angle", "back_angle")]
    values = {key: getattr(member, key.removesuffix(APEX_SUFFIX)) for key in keys}
    return Blank(**_written(Blank, {**values, "clearance": clearance}))


def with_blanks(case: Case) -> Case:
    """The case with its blanks as numbers, where it asks for them by basic data."""
    if case.blank_design is None:
        return case
    blanks = designed_blanks(case.blank_design, (case.pinion.number_of_teeth, case.gear.number_of_teeth), case.pair)
    pinion, gear = (blank_table(member, blanks.clearance) for member in (blanks.pinion, blanks.gear))
    return case.model_copy(update={"blank_design": None}).with_tables(pinion={"blank": pinion}, gear={"blank": gear})


def recorded_thicknesses(pair: GearPair) -> list[float | None]:
    """Mean normal circular thicknesses [mm] of the members, ``None`` for one without a thickness of its own."""
    return [
        None if m.mean_thickness is None else _rounded(mean_normal_thickness(m, m.mean_thickness, distance))
        for m, distance in zip((pair.pinion, pair.gear), mean_cone_distances(pair), strict=True)
    ]


def with_mean_thickness(case: Case) -> Case:
    """The case with thicknesses in the middle of the flank as those at the mean point. Raises as above."""
    given = [name for name in MEMBERS if getattr(getattr(case, name), MID_FLANK) is not None]
    if not given:
        return case
    thicknesses = dict(zip(MEMBERS, recorded_thicknesses(given_pair(case)), strict=True))
    return case.with_tables(**{name: {MEAN: thicknesses[name], MID_FLANK: None} for name in given})


def flank_settings(surface: GeneratingSurface, teeth: int) -> FlankSettings:
    """Cutter and machine settings of one flank; refused where a case file cannot hold them."""
    ratio = surface.settings.indexing_ratio
    groups = ratio * teeth
    if abs(groups - round(groups)) > 1e-9:
        raise InputError(f"indexing_ratio = {ratio}: must be a whole number of blade groups over {teeth} teeth")
    return FlankSettings(machine=machine_table(surface.settings), cutter=cutter_table(surface.blade, round(groups)))


def machine_table(settings: MachineSettings) -> Machine:
    """Machine settings in mm and degrees, modified roll and motions as derivatives."""
    if len(settings.modified_roll) > len(ROLL_KEYS):
        raise InputError(f"modified_roll = {settings.modified_roll}: must have at most {len(ROLL_KEYS)} orders")
    roll = zip(ROLL_KEYS, polynomial_derivatives(settings.modified_roll, 2), strict=False)
    motions = {}
    for name, coefficients in settings.motions:
        unit = math.degrees(1.0) if name in ANGULAR_MOTIONS else 1.0
        motions[name] = tuple(map(_rounded, polynomial_derivatives(coefficients, unit=unit)))
    values = {name: getattr(settings, name) for name in MACHINE_STEPS} | dict(roll)
    values["cradle_angle"] = math.remainder(settings.cradle_angle, 2.0 * math.pi)
    return Machine(**_written(Machine, values), motions=Motions(**motions))


def cutter_table(blade: Blade, number_of_blade_groups: int = 0) -> Cutter:
    """A blade in mm and degrees."""
    reliefs: dict[str, Any] = {}
    for name in RELIEFS:
        if (relief := getattr(blade, name)) is not None:
            reliefs[f"{name}_depth"], reliefs[f"{name}_angle"] = _rounded(relief.height), _degrees(relief.angle)
            reliefs[f"{name}_radius"] = relief.radius
    keys = [key for key in Cutter.model_fields if blade_field(key) != key]
    values = _written(Cutter, {key: getattr(blade, blade_field(key)) for key in keys})
    values["blade_spheric_radius"] = blade.spheric_radius
    if blade.spheric_radius is None:
        values["blade_reference_height"] = 0.0
    return Cutter(**values, number_of_blade_groups=number_of_blade_groups, **reliefs)


@cache
def numeric_keys() -> Mapping[str, tuple[str, str]]:
    """Unit and usual name of every number of a case file by its dotted key."""
    return {key: (extra_of(field, "unit"), usual_name(key.rpartition(".")[2])) for key, field in _numbers().items()}


@cache
def _numbers() -> Mapping[str, FieldInfo]:
    """Fields of the numbers of a case file by their dotted keys."""
    return dict(_numbers_of(Case, ""))


def _numbers_of(table: type[BaseModel], prefix: str) -> Iterator[tuple[str, FieldInfo]]:
    for name, field in table.model_fields.items():
        inner, options = inner_table(field.annotation), kinds(field.annotation)
        if inner is not None:
            yield from _numbers_of(inner, f"{prefix}{name}.")
        elif str not in options and any(kind in (int, float) for kind in options):
            yield f"{prefix}{name}", field


def require_numeric_key(key: str) -> tuple[str, str]:
    """Unit and usual name of a number of a case file; an unknown key is refused with the nearest."""
    keys = numeric_keys()
    if key not in keys:
        raise InputError(f"{key}: must be a number of the case file by its dotted key{suggestion(key, list(keys))}")
    return keys[key]


def changed_case(case: Case, numbers: Mapping[str, float]) -> Case:
    """A case with other numbers by dotted key, in the units of the case file."""
    data = case.model_dump(exclude_unset=True)
    for key, value in numbers.items():
        require_numeric_key(key)
        *tables, name = key.split(".")
        inner: Any = data
        for depth, table in enumerate(tables, start=1):
            if inner.get(table) is None:
                if depth < len(tables) or table in ("blank", "blank_design", "machine", "cutter"):
                    raise InputError(f"{key}: the case has no table [{'.'.join(tables[:depth])}]")
                inner[table] = {}
            inner = inner[table]
        is_whole = float(value).is_integer() and int in kinds(_numbers()[key].annotation)
        inner[name] = int(value) if is_whole else float(value)
    friction = case.friction
    context = None if friction is None else {"folder": friction._folder, "allow_outside": friction._allow_outside}
    try:
        new_case = Case.model_validate(data, context=context)
    except ValidationError as error:
        raise refusal("the changed case", Case, error) from error
    if new_case.blank_design is not None:
        with errors_about("the changed case:"):
            designed_blanks(
                new_case.blank_design, (new_case.pinion.number_of_teeth, new_case.gear.number_of_teeth), new_case.pair
            )
    return new_case
