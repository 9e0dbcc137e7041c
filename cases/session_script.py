"""The design part of a session script of Transmission3D or HypoidFaceMilled, as a case.

Keywords and signs are those that the public program SpyGO (``haomjc/SpyGO``) writes into such scripts and computes
with; ``docs/engineer/reference/exchange.md`` has the table. A setting has the sign of ours, for both hands, with one
exception: the vertical motion of a gear.

A script is what one would type into the menus of the program: a menu is opened by its name and left by EXIT, a setting
is a keyword with a value behind it, ``//`` begins a comment. Members are told apart by ROTOR and TYPE, flanks by
CONCAVE and CONVEX. The nesting itself carries nothing more, so that it need not be complete: the one public writer of
such scripts leaves out the names of the flanks, and then a member's first MACHINE is that of the concave flank.
"""

from __future__ import annotations

import math
import os
from collections.abc import Mapping
from configparser import RawConfigParser
from dataclasses import dataclass, field
from importlib import resources
from pathlib import Path
from typing import Any, Literal

from ..core.errors import InputError, errors_about
from ..core.regular_file import LINE_LENGTH_LIMIT, SCRIPT_SIZE_LIMIT, read_text
from .reading import check_case
from .schema.case_schema import Case
from .schema.cutting_table import RELIEFS

MemberName = Literal["PINION", "GEAR"]
MenuPath = tuple[str, str, str]
"""Member, flank and menu; empty where there is none."""

ROTOR_MEMBERS: dict[str, MemberName] = {"1": "PINION", "2": "GEAR"}
TYPE_MEMBERS: dict[str, MemberName] = {"FACEMILLED_PINION": "PINION", "FACEMILLED_GEAR": "GEAR"}
WORD_COUNT_LIMIT = 1000  # of a line that are read
#: Keywords that must be there and others that may, with the keys of a case that they are.
_KEYWORDS = RawConfigParser(comment_prefixes=";")
_KEYWORDS.optionxform = str  # type: ignore[assignment,method-assign]  # keywords stay in capitals
_KEYWORDS.read_string(resources.files(__package__).joinpath("session_keywords.ini").read_text(encoding="utf-8"))
BLANK_KEYWORDS, GENERATED_KEYWORDS, FORMATE_KEYWORDS, BLADE_KEYWORDS = (
    (dict(_KEYWORDS[f"{table} needed"]), dict(_KEYWORDS[f"{table} optional"]))
    for table in ("BLANK", "GENERATED", "FORMATE", "BLADE")
)
#: Of a relief, after its name, by what its option says.
RELIEF_KEYWORDS = {option: dict(_KEYWORDS[f"RELIEF {option}"]) for option in ("NONE", "BLENDED", "STRAIGHT")}
MOTION_LETTERS = dict(_KEYWORDS["MOTION"])
MOTION_ORDERS = range(1, 7)
#: Settings that a case can hold, menu by menu.
MENU_KEYWORDS: dict[str, frozenset[str]] = {
    "PAIRS": frozenset({"HAND_PINION"}),
    "HYPOID": frozenset({"GEAR_TYPE"}),
    "COMMON": frozenset({"NTEETH", "HAND", "ROOTANGLE"}).union(*BLANK_KEYWORDS),
    "MACHINE": frozenset({"MODROLL_5040H"}).union(
        *GENERATED_KEYWORDS,
        *FORMATE_KEYWORDS,
        (f"{letter}{order}" for letter in MOTION_LETTERS for order in MOTION_ORDERS),
    ),
    "CUTTER": frozenset({"TYPE", "RHO"}).union(
        *BLADE_KEYWORDS,
        (f"{name.upper()}_{word}" for name in RELIEFS for word in {"OPTION"}.union(*RELIEF_KEYWORDS.values())),
    ),
}
MENU_NAMES = ("EDIT", "ROTOR", "SHAFT", "SEGMENT", "CONCAVE", "CONVEX", *MENU_KEYWORDS)


@dataclass(frozen=True)
class Setting:
    """A value of a script, and the line it stands in."""

    keyword: str
    value: str
    line: int

    def number(self) -> float:
        """The value as a number, else refused."""
        try:
            return float(self.value)
        except ValueError as error:
            raise InputError(f"line {self.line}: {self.keyword} = {self.value!r}: must be a number") from error

    def word(self, *allowed: str) -> str:
        """The value as one of the allowed words, in capitals, else refused."""
        if self.value.upper() not in allowed:
            raise InputError(f"line {self.line}: {self.keyword} = {self.value!r}: must be one of {', '.join(allowed)}")
        return self.value.upper()


@dataclass
class _State:
    """Position of a script in the menus."""

    member: str = ""
    flank: str = ""
    menu: str = ""
    named: bool = False
    machines: dict[str, int] = field(default_factory=dict)

    def select(self, member: str) -> None:
        if member != self.member:
            self.member, self.flank, self.named = member, "", False

    def enter(self, menu: str, line: int) -> None:
        self.menu = menu
        if menu in ("CONCAVE", "CONVEX"):
            self.flank, self.named = menu, True
        elif menu == "MACHINE" and not self.named:
            count = self.machines[self.member] = self.machines.get(self.member, 0) + 1
            if count > 2:
                raise InputError(f"line {line}: a third MACHINE for one member, without CONCAVE or CONVEX")
            self.flank = "CONCAVE" if count == 1 else "CONVEX"

    def menu_path(self) -> MenuPath:
        if self.menu in ("MACHINE", "CUTTER"):
            return self.member, self.flank, self.menu
        return ("", "", "PAIRS") if self.menu == "PAIRS" else (self.member, "", self.menu)


def read_settings(path: str | os.PathLike[str]) -> tuple[dict[MenuPath, dict[str, Setting]], list[str]]:
    """Settings of a script by menu and keyword, and notes on lines that were not understood or say the same again."""
    text = read_text(path, SCRIPT_SIZE_LIMIT, line_limit=LINE_LENGTH_LIMIT)
    state = _State()
    settings: dict[MenuPath, dict[str, Setting]] = {}
    notes: list[str] = []
    for line, content in enumerate(text.splitlines(), start=1):
        words = content.split("//", 1)[0].split()[:WORD_COUNT_LIMIT]
        while words:
            keyword, rest = words[0].upper(), words[1:]
            if keyword in ("EXIT", "OK"):
                state.menu = ""
                words = rest
            elif keyword in ("ROTOR", "HYPOID") and rest and rest[0].isdigit():
                if keyword == "ROTOR":
                    state.select(ROTOR_MEMBERS.get(rest[0], f"ROTOR {rest[0]}"))
                words = rest[1:]
            elif keyword == "TYPE" and rest and rest[0].upper() in TYPE_MEMBERS:
                state.select(TYPE_MEMBERS[rest[0].upper()])
                words = rest[1:]
            elif keyword in MENU_KEYWORDS.get(state.menu, ()):
                if not rest:
                    raise InputError(f"{path}: line {line}: {keyword} has no value")
                menu = settings.setdefault(state.menu_path(), {})
                if keyword in menu:
                    notes.append(
                        f"line {line}: {keyword} {rest[0]} replaces {menu[keyword].value} of line {menu[keyword].line}"
                    )
                menu[keyword] = Setting(keyword, rest[0], line)
                words = rest[1:]
            elif keyword in MENU_NAMES and not (rest and rest[0].isdigit()):
                state.enter(keyword, line)
                words = rest
            else:
                notes.append(f"not understood: line {line}: {' '.join(words)}")
                break
    return settings, notes


Settings = Mapping[str, Setting]

USUAL_SHAFT_ANGLE = 90.0  # [deg]
ROUNDING = 0.01  # of the sum of two pitch angles as drawings have them [deg]
RATIO_TOLERANCE = 0.005  # of the ratio of the sines of the pitch angles, which is that of the tooth numbers


def read_session_script(path: str | os.PathLike[str]) -> tuple[Case, list[str]]:
    """Read the design part of a session script.

    Parameters
    ----------
    path
        The script.

    Returns
    -------
    tuple
        The case, and a list of what was not understood, was assumed, or is doubtful, with line numbers.

    Raises
    ------
    InputError
        If the file cannot be read, a value is no number or no known word, a setting that a case needs is missing, or a
        value is out of the range of a case.

    Examples
    --------
    The flanks of the drive side, both generated:

    >>> import tempfile
    >>> gear = '''
    ... TYPE FACEMILLED_GEAR
    ... COMMON  NTEETH 36  PITCHANGLE 71.567  FACEANGLE 73.133  ROOTANGLE 67.683  OUTERCONEDIST 93.81  FACEWIDTH 25.459
    ... CONVEX  MACHINE  RADIALSETTING 72.643  CRADLEANGLE 59.234  ROOTANGLE 67.683  RATIOROLL 1.05167
    ...         CUTTER  POINTRADIUS 75.375  BLADEANGLE 22.0
    ... '''
    >>> pinion = '''
    ... TYPE FACEMILLED_PINION
    ... COMMON  NTEETH 12  HAND LEFT  PITCHANGLE 18.433  FACEANGLE 22.317  ROOTANGLE 16.867  OUTERCONEDIST 93.761
    ...         FACEWIDTH 25.41
    ... CONCAVE MACHINE  RADIALSETTING 74.874  CRADLEANGLE 63.942  ROOTANGLE 16.867  RATIOROLL 3.2427
    ...         CUTTER  POINTRADIUS 75.327  BLADEANGLE 18.046
    ... '''
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     script = Path(folder, "pair.ses")
    ...     _ = script.write_text("ROTOR 1" + pinion + "ROTOR 2" + gear)
    ...     case, notes = read_session_script(script)
    >>> case.pinion.number_of_teeth, case.gear.convex.machine.radial_distance
    (12, 72.643)
    """
    settings, of_lines = read_settings(path)
    notes = ["clearance is zero: the flanks begin at the root cones"]
    with errors_about(f"{path}:"):
        hand = _hand(settings, notes)
        pinion, gear = (_member(settings, member, hand, notes) for member in ("PINION", "GEAR"))
        data = {
            "easeoff_case": 2,
            "title": f"{Path(path).stem} (session script)"[:200],
            "pair": {"shaft_angle": _shaft_angle(pinion, gear, notes)},
            "pinion": {**pinion, "hand_of_spiral": hand.lower()},
            "gear": gear,
        }
    return check_case(data, str(path)), notes + of_lines


def _hand(settings: Mapping[MenuPath, Settings], notes: list[str]) -> str:
    """Hand of the pinion, RIGHT or LEFT."""
    places = ((("", "", "PAIRS"), "HAND_PINION"), (("PINION", "", "COMMON"), "HAND"))
    hands = [settings.get(menu, {}).get(keyword) for menu, keyword in places]
    given = [setting.word("LEFT", "RIGHT") for setting in hands if setting is not None]
    if not given:
        raise InputError("the hand of the pinion is missing: HAND_PINION in PAIRS, or HAND in COMMON of ROTOR 1")
    if len(set(given)) > 1:
        raise InputError("HAND_PINION in PAIRS and HAND in COMMON of ROTOR 1 contradict each other")
    gear = settings.get(("GEAR", "", "COMMON"), {}).get("HAND")
    if gear is not None and gear.word("LEFT", "RIGHT") == given[0]:
        notes.append(f"line {gear.line}: HAND of the gear is that of the pinion; the opposite hand is taken")
    return given[0]


def _shaft_angle(pinion: Mapping[str, Any], gear: Mapping[str, Any], notes: list[str]) -> float:
    """Shaft angle [deg] by the pitch cones of a pair without offset; the usual one where they are of another pair."""
    cones, teeth = [[member[key] for member in (pinion, gear)] for key in ("blank", "number_of_teeth")]
    angles = [blank["pitch_angle"] for blank in cones]
    along = [math.sin(math.radians(angle)) / count for angle, count in zip(angles, teeth, strict=True)]
    if abs(along[0] - along[1]) > RATIO_TOLERANCE * max(along):
        notes.append(
            f"shaft angle {USUAL_SHAFT_ANGLE:g} deg and offset 0 mm are assumed, since no keyword for them is known; "
            "the pitch angles are not those of a pair without offset: give shaft_angle and hypoid_offset in [pair]"
        )
        return USUAL_SHAFT_ANGLE
    angle = round(sum(angles), 6)
    angle = USUAL_SHAFT_ANGLE if abs(angle - USUAL_SHAFT_ANGLE) < ROUNDING else angle
    notes.append(
        f"shaft angle {angle:g} deg, the sum of the pitch angles, and offset 0 mm are taken, since no keyword for them "
        "is known: the pitch angles are those of such a pair"
    )
    return angle


def _numbers(
    table: Settings, where: str, needed: Mapping[str, str], optional: Mapping[str, str] | None = None
) -> dict[str, Any]:
    """Numbers by the key of a case, of keywords that must be there and of others that may."""
    missing = [keyword for keyword in needed if keyword not in table]
    if missing:
        raise InputError(f"{where} lacks {', '.join(missing)}")
    keys = {**needed, **(optional or {})}
    return {key: table[keyword].number() for keyword, key in keys.items() if keyword in table}


def _member(settings: Mapping[MenuPath, Settings], member: MemberName, hand: str, notes: list[str]) -> dict[str, Any]:
    common = settings.get((member, "", "COMMON"), {})
    where = f"COMMON of the {member.lower()}"
    blank = _numbers(common, where, *BLANK_KEYWORDS)
    blank["root_angle"] = _root_angle(settings, member, notes)
    teeth = _numbers(common, where, {"NTEETH": "number_of_teeth"})["number_of_teeth"]
    result: dict[str, Any] = {"number_of_teeth": int(teeth) if teeth.is_integer() else teeth, "blank": blank}
    kind = settings.get((member, "", "HYPOID"), {}).get("GEAR_TYPE")
    formate = kind is not None and kind.word("FORMATE", "GENERATED") == "FORMATE"
    for flank in ("CONCAVE", "CONVEX"):
        machine, cutter = (settings.get((member, flank, menu), {}) for menu in ("MACHINE", "CUTTER"))
        if not machine and not cutter:
            continue
        where = f"{flank} of the {member.lower()}"
        made = _numbers(machine, f"MACHINE, {where},", *(FORMATE_KEYWORDS if formate else GENERATED_KEYWORDS))
        if not formate:
            made["motions"] = _motions(machine, member, hand, notes)
            _doubts(machine, member, notes)
        result[flank.lower()] = {"machine": made, "cutter": _cutter(cutter, f"CUTTER, {where},")}
    return result


def _root_angle(settings: Mapping[MenuPath, Settings], member: MemberName, notes: list[str]) -> float:
    """Root angle of the blank: that of COMMON or, if the cutter is not tilted, that of the machine."""
    common = settings.get((member, "", "COMMON"), {})
    if "ROOTANGLE" in common:
        return common["ROOTANGLE"].number()
    for flank in ("CONCAVE", "CONVEX"):
        machine = settings.get((member, flank, "MACHINE"), {})
        if "ROOTANGLE" in machine and ("TILTANGLE" not in machine or machine["TILTANGLE"].number() == 0.0):
            root = machine["ROOTANGLE"]
            notes.append(f"line {root.line}: the machine root angle is taken as the root angle of the {member.lower()}")
            return root.number()
    raise InputError(
        f"the root angle of the {member.lower()} is missing, and that of the machine is not it where the cutter is "
        f"tilted: add ROOTANGLE, in degrees, to COMMON of the {member.lower()}"
    )


def _motions(machine: Settings, member: MemberName, hand: str, notes: list[str]) -> dict[str, list[float]]:
    """Derivatives of the settings that move, by our cradle increment."""
    motions = {}
    for letter, key in MOTION_LETTERS.items():
        # The reading of the program gives the vertical motion of a gear the sign opposite to its offset, both hands.
        sign = -1.0 if letter == "V" and member == "GEAR" else 1.0
        values = [machine[f"{letter}{n}"].number() if f"{letter}{n}" in machine else 0.0 for n in MOTION_ORDERS]
        while values and values[-1] == 0.0:
            values.pop()
        motions[key] = [sign * value + 0.0 for value in values]
        for order, value in enumerate(values, start=1):
            if value == 0.0:
                continue
            which = f"line {machine[f'{letter}{order}'].line}: {letter}{order}"
            if hand == "RIGHT" and _hands_differ(letter, order, member):
                notes.append(
                    f"{which} is taken with the sign of a left-hand pinion; the public reading of the program has the "
                    "other one for this hand, which is no mirror image"
                )
            elif sign < 0.0:
                notes.append(
                    f"{which} of the gear is taken with the sign opposite to BLANKOFFSET, as the public reading of the "
                    "program has it"
                )
    return motions


def _hands_differ(letter: str, order: int, member: MemberName) -> bool:
    """True if the program's public reading makes a right-hand pair that does not mirror a left-hand one."""
    if member == "PINION":
        return letter in "RV" and order % 2 == 1
    return (letter == "R" and order in (1, 5)) or (letter == "V" and order == 6)


def _doubts(machine: Settings, member: MemberName, notes: list[str]) -> None:
    """Notes on settings that are given, and whose meaning is not certain or that a case file cannot hold."""

    def say(keyword: str, text: str) -> None:
        if keyword in machine and machine[keyword].number() != 0.0:
            notes.append(f"line {machine[keyword].line}: {keyword} {machine[keyword].value} {text}")

    say("MODROLL_5040H", "is left out: a case has no modified roll of the seventh order")
    for keyword in ("MODROLL_720G", "H5", "H6"):
        say(keyword, "is taken as it is; the public reading of the program divides it by 1000")
    if member == "GEAR":
        taken = "of a gear is taken with the sense it has for a pinion; the public reading of the program"
        say("TILTANGLE", f"{taken} has the other one")
        say("SWIVELANGLE", f"{taken} contradicts itself between the hands")


def _cutter(cutter: Settings, where: str) -> dict[str, Any]:
    result = _numbers(cutter, where, *BLADE_KEYWORDS)
    if "TYPE" in cutter and cutter["TYPE"].word("STRAIGHT", "CURVED") == "CURVED":
        result |= _numbers(cutter, where, {"RHO": "blade_spheric_radius"})
    for name in RELIEFS:
        option = cutter.get(f"{name.upper()}_OPTION")
        keys = RELIEF_KEYWORDS["NONE" if option is None else option.word(*RELIEF_KEYWORDS)]
        result |= _numbers(cutter, where, {f"{name.upper()}_{word}": f"{name}_{what}" for word, what in keys.items()})
    return result
