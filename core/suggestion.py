"""Suggestion of a known name for one that is misspelt."""

from __future__ import annotations

import difflib
from collections.abc import Iterable

SIMILARITY = 0.6  # least ratio of difflib
NAME_LENGTH_LIMIT = 100  # of a name that is compared [characters]


def suggestion(name: str, known: Iterable[str]) -> str:
    """The known name that comes nearest, as the end of a phrase; empty if none is near.

    Parameters
    ----------
    name
        Name as given; lower and upper case count alike.
    known
        Names that there are.

    Examples
    --------
    >>> suggestion("radial_distanse", ["radial_distance", "cradle_angle"])
    "; did you mean 'radial_distance'?"
    >>> suggestion("x", ["radial_distance"])
    ''
    """
    lower = {word.lower(): word for word in known}
    found = difflib.get_close_matches(name[:NAME_LENGTH_LIMIT].lower(), lower, n=1, cutoff=SIMILARITY)
    return f"; did you mean {lower[found[0]]!r}?" if found else ""
