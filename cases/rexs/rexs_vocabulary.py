"""Names of the keys of a case in REXS, from ``rexs_terms.toml``: attribute and unit of every key, table by table."""

from __future__ import annotations

import tomllib
from collections.abc import Mapping
from importlib import resources
from typing import Literal, NamedTuple

REXS_VERSION = "2.0.0"
APPLICATION = "easeoff"
CUSTOM_PREFIX = "custom_easeoff_"


class Term(NamedTuple):
    """Attribute of REXS for a key of a case, and its unit, in which it is read where a file states none."""

    attribute: str
    unit: str

    @property
    def custom(self) -> bool:
        """True if REXS itself has no such attribute."""
        return self.attribute.startswith(CUSTOM_PREFIX)


_TABLES = tomllib.loads(resources.files(__package__).joinpath("rexs_terms.toml").read_text(encoding="utf-8"))
#: Units a file may state: our own unit of the same quantity, and what to multiply by.
UNIT_FACTORS: Mapping[str, tuple[str, float]] = {unit: (ours, by) for unit, (ours, by) in _TABLES["units"].items()}


def _terms(table: str) -> dict[str, Term]:
    return {key: Term(attribute, unit) for key, (attribute, unit) in _TABLES[table].items()}


STAGE_TERMS, MISALIGNMENT_TERMS = _terms("stage"), _terms("misalignment")
MEMBER_TERMS, BLANK_TERMS, MATERIAL_TERMS = _terms("member"), _terms("blank"), _terms("material")
MACHINE_TERMS, MOTION_TERMS, CUTTER_TERMS = _terms("machine"), _terms("motion"), _terms("cutter")
CONTACT_TERMS = _terms("contact")
STAGE_BACKLASH, GEAR_BACKLASH = _terms("stage_backlash"), _terms("gear_backlash")
CASE_TERM = Term(f"{CUSTOM_PREFIX}case", "none")
"""Version of the case that a file was made of: the first wrote the thickness in the middle of the flank, without it."""
HAND_TERM = Term("spiral_angle_pitch_direction", "none")
FLANK_TERM = Term(f"{CUSTOM_PREFIX}flank", "none")
"""``concave`` or ``convex``: REXS says left and right, but not from which end of a bevel gear."""
MODIFIED_ROLL_TERM = Term("modified_roll_coefficients", "none")
"""C, D, ... in the order of ``ROLL_KEYS``."""

ATTRIBUTES_READ: Mapping[str, frozenset[str]] = {
    kind: frozenset(term.attribute for term in terms)
    for kind, terms in {
        "bevel_stage": [CASE_TERM, *STAGE_TERMS.values(), *MISALIGNMENT_TERMS.values()],
        "bevel_gear": [*MEMBER_TERMS.values(), *BLANK_TERMS.values(), HAND_TERM],
        "bevel_gear_flank": [FLANK_TERM],
        "bevel_gear_manufacturing_settings": [*MACHINE_TERMS.values(), *MOTION_TERMS.values(), MODIFIED_ROLL_TERM],
        "bevel_gear_tool": [*CUTTER_TERMS.values()],
        "material": [*MATERIAL_TERMS.values()],
    }.items()
}
"""Component types, and the attributes of each that are read."""

Hand = Literal["left", "right"]


def opposite(hand: Hand) -> Hand:
    """The other hand."""
    return "left" if hand == "right" else "right"


def side(hand: Hand, role: Hand) -> Literal["concave", "convex"]:
    """Side of the left or right flank of a member of a hand, seen from the heel with the tip of the tooth up."""
    return "convex" if hand == role else "concave"
