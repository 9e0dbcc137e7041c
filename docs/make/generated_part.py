"""The part of a page that a script makes: between two comments with its name."""

from __future__ import annotations

import re


def with_generated(page: str, name: str, made: str) -> str:
    """A page with the part of a name made anew."""
    begin, end = _comments(name)
    return re.sub(f"{begin}.*{end}", lambda _: f"{begin}\n\n{made}\n\n{end}", page, flags=re.DOTALL)


def generated(page: str, name: str) -> str:
    """The part of a name in a page."""
    begin, end = _comments(name)
    return page.split(begin)[1].split(end)[0].strip()


def _comments(name: str) -> tuple[str, str]:
    return f"<!-- begin generated: {name} -->", f"<!-- end generated: {name} -->"
