"""Names of the members of a pair, and of the flanks by which they drive each other."""

from __future__ import annotations

from typing import Literal

MemberName = Literal["pinion", "gear"]
FlankName = Literal["drive", "coast"]
MEMBERS = ("pinion", "gear")
