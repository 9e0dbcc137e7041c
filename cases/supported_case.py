"""A case with supports from elsewhere."""

from __future__ import annotations

from pathlib import Path

from ..core.checks import instance
from ..core.errors import InputError
from .reading import read_supports, stem
from .schema.case_schema import Case
from .schema.supports_table import SupportsTable


def with_supports(case: Case, supports: SupportsTable | str | Path) -> Case:
    """The case with other supports.

    Parameters
    ----------
    case
        A checked case.
    supports
        Supports, the name of shipped ones, or the path of a file of supports.

    Raises
    ------
    InputError
        If there is no such file, its supports have mistakes, or they do not hold the members of this case.

    Examples
    --------
    >>> from easeoff.cases import read_case
    >>> with_supports(read_case("fm-11x41"), "axle-fm-11x41").supports.gear.shaft.seat
    63.0
    """
    instance("case", case, Case)
    from .support_conversion import support_system

    table = supports if isinstance(supports, SupportsTable) else read_supports(supports)
    found = case.model_copy(update={"supports": table})
    try:
        support_system(found)
    except InputError as error:
        origin = "" if isinstance(supports, SupportsTable) else f"{supports}: "
        raise InputError(f"{origin}{error}") from error
    found._supports_name = "" if isinstance(supports, SupportsTable) else stem(supports)
    return found
