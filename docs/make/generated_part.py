"""The part of a page that a script makes: between two comments with its name."""

from __future__ import annotations

import re


def with_generated(page: str, name: str, made: str) -> str:
    """A page with the part of a name made anew."""
    begin, end = f"<!-- begin generated: {name} -->", f"<!-- end generated: {name} -->"
    return re.sub(f"{begin}.*{end}", lambda _: f"{begin}\n\n{made}\n\n{end}", page, flags=re.DOTALL)
