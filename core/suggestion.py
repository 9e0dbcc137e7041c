"""Suggestion of a known name for one that is misspelt."""

from __future__ import annotations

import difflib
from collections.abc import Iterable

SIMILARITY = 0.6  # least ratio of difflib
BEGINNING_LENGTH = 4  # least of a beginning that stands for the whole name [characters]
NAME_LENGTH_LIMIT = 100  # of a name that is compared [characters]


def suggestion(name: str, known: Iterable[str]) -> str:
    """The known name that comes nearest, or begins so, as the end of a phrase; empty if there is none.

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
    >>> suggestion("axle", ["gearbox-nasa-12x36", "axle-fm-11x41"])
    "; did you mean 'axle-fm-11x41'?"
    >>> suggestion("x", ["radial_distance"])
    ''
    """
    lower = {word.lower(): word for word in known}
    given = str(name)[:NAME_LENGTH_LIMIT].lower()
    found = difflib.get_close_matches(given, lower, n=1, cutoff=SIMILARITY)
    if not found and len(given) >= BEGINNING_LENGTH:
        found = [word for word in lower if word.startswith(given)]
    return f"; did you mean {lower[found[0]]!r}?" if found else ""
