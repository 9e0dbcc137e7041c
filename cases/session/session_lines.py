"""The lines of a session script: which keyword has which value, for which member, flank and menu.

A script is what one would type into the menus of the program: a menu is opened by its name and left by EXIT, a setting
is a keyword with a value behind it, ``//`` begins a comment. Members are told apart by ROTOR and TYPE, flanks by
CONCAVE and CONVEX. The nesting itself carries nothing more, so that it need not be complete: the one public writer of
such scripts leaves out the names of the flanks, and then a member's first MACHINE is that of the concave flank.
"""

from __future__ import annotations

import os
from dataclasses import dataclass, field
from typing import Literal

from ...core.errors import InputError
from ...core.reading.text_file import LINE_LENGTH_LIMIT, SCRIPT_SIZE_LIMIT, read_text

MemberName = Literal["PINION", "GEAR"]
MenuPath = tuple[str, str, str]
"""Member, flank and menu; empty where there is none."""

ROTOR_MEMBERS: dict[str, MemberName] = {"1": "PINION", "2": "GEAR"}
TYPE_MEMBERS: dict[str, MemberName] = {"FACEMILLED_PINION": "PINION", "FACEMILLED_GEAR": "GEAR"}
MENU_NAMES = (
    *("EDIT", "PAIRS", "ROTOR", "HYPOID", "SHAFT", "SEGMENT", "COMMON", "MACHINE", "CUTTER"),
    *("CONCAVE", "CONVEX"),
)
MOTION_ORDERS = range(1, 7)
WORD_COUNT_LIMIT = 1000  # of a line that are read
MENU_KEYWORDS: dict[str, tuple[str, ...]] = {
    "PAIRS": ("HAND_PINION",),
    "HYPOID": ("GEAR_TYPE",),
    "COMMON": (
        *("NTEETH", "HAND", "OUTERCONEDIST", "FACEWIDTH", "FACEANGLE", "PITCHANGLE", "ROOTANGLE", "FRONTANGLE"),
        *("BACKANGLE", "PITCHAPEX", "FACEAPEX", "ROOTAPEX"),
    ),
    "MACHINE": (
        *("RADIALSETTING", "TILTANGLE", "SWIVELANGLE", "BLANKOFFSET", "ROOTANGLE", "MACHCTRBACK", "SLIDINGBASE"),
        *("CRADLEANGLE", "RATIOROLL", "HORIZONTAL", "VERTICAL"),
        *("MODROLL_2C", "MODROLL_6D", "MODROLL_24E", "MODROLL_120F", "MODROLL_720G", "MODROLL_5040H"),
        *(f"{letter}{order}" for letter in "HVR" for order in MOTION_ORDERS),
    ),
    "CUTTER": (
        *("POINTRADIUS", "BLADEANGLE", "EDGERADIUS", "TYPE", "RHO"),
        *(
            f"{relief}_{what}"
            for relief in ("TOPREM", "FLANKREM")
            for what in ("OPTION", "DEPTH", "BLEND_RADIUS", "ANGLE")
        ),
    ),
}
"""Settings that a case can hold, menu by menu."""


@dataclass(frozen=True)
class Setting:
    """A value of a script, and the line it stands in."""

    keyword: str
    value: str
    line: int

    def number(self) -> float:
        """The value as a number.

        Raises
        ------
        InputError
            If it is not a number.
        """
        try:
            return float(self.value)
        except ValueError as error:
            raise InputError(f"line {self.line}: {self.keyword} = {self.value!r}: must be a number") from error

    def word(self, *allowed: str) -> str:
        """The value as one of the allowed words, in capitals.

        Raises
        ------
        InputError
            If it is another word.
        """
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
    """Read the settings of a script.

    Parameters
    ----------
    path
        The script.

    Returns
    -------
    tuple
        Settings by menu and keyword, and the lines that were not understood.

    Raises
    ------
    InputError
        If the file cannot be read as text, or a keyword stands without a value.
    """
    text = read_text(path, SCRIPT_SIZE_LIMIT, line_limit=LINE_LENGTH_LIMIT)
    state = _State()
    settings: dict[MenuPath, dict[str, Setting]] = {}
    unknown: list[str] = []
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
                settings.setdefault(state.menu_path(), {})[keyword] = Setting(keyword, rest[0], line)
                words = rest[1:]
            elif keyword in MENU_NAMES and not (rest and rest[0].isdigit()):
                state.enter(keyword, line)
                words = rest
            else:
                unknown.append(f"line {line}: {' '.join(words)}")
                break
    return settings, unknown
