"""Figures of corrections: topographies of the measured flanks before and after, and their files."""

from __future__ import annotations

import os
from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING

from ....core.errors import InputError
from ....geometry.deviation.corrective_settings import Correction
from ...deviations.case_correction import CaseCorrection
from ..drawing_style import drawing
from ..picture_files import FORMATS

if TYPE_CHECKING:
    from matplotlib.figure import Figure

    from .drawn_result import AxesChoice


def topography(
    correction: Correction, *, title: str = "", parts: str | Sequence[str] | None = None, axes: AxesChoice = None
) -> Figure:
    """Topographies of measured flanks, before the correction and as predicted after it.

    Every node of the measuring grid stands on the flat sheet of the designed flank, toe on the left and root below;
    its deviation is a line along the normal, upwards where there is more metal. A rotation of the tooth is left out.

    Parameters
    ----------
    correction
        Of ``geometry.corrective_settings`` or ``study.correct_case``.
    title
        Small title of the page.
    parts
        ``before``, ``after`` or both; both if left out. Panels: a row a flank, a column a part.
    axes
        Axes to draw in, one a panel; a page of its own if left out.

    Raises
    ------
    InputError
        If ``correction`` is none, a part is unknown, or ``axes`` are not as many as the panels.

    Examples
    --------
    >>> import easeoff
    >>> found = easeoff.study.correct_case(easeoff.read_case("fm-11x41"), {"gear": "fm-11x41-worn-gear"})
    >>> figure = easeoff.plot.topography(found.corrections["gear"][0])
    >>> len(figure.axes)
    2
    """
    if not isinstance(correction, Correction):
        raise InputError(
            f"correction = {type(correction).__name__}: must be a Correction, as corrective_settings gives it"
        )
    with drawing(axes):
        from ..charts.topography_chart import draw

        return draw(correction, title, parts, axes)


def write_topographies(
    found: CaseCorrection, folder: str | os.PathLike[str], name: str, *, file_format: str = "png"
) -> list[Path]:
    """Draw the topographies of all corrections of a case into a folder, a file a set-up.

    Parameters
    ----------
    found
        Of ``study.correct_case``.
    folder
        The folder; made if it does not exist.
    name
        Begin of the names of the files, as in ``fm-11x41-gear-convex-topography.png``.
    file_format
        ``png``, ``svg`` or ``pdf``.

    Returns
    -------
    list of Path
        The files; those of an earlier correction are replaced.

    Raises
    ------
    InputError
        If the format is unknown or the folder cannot be written to.

    Examples
    --------
    >>> import easeoff
    >>> from tempfile import TemporaryDirectory
    >>> found = easeoff.study.correct_case(easeoff.read_case("fm-11x41"), {"gear": "fm-11x41-worn-gear"})
    >>> with TemporaryDirectory() as place:
    ...     [path.name for path in write_topographies(found, place, "mine")]
    ['mine-gear-convex-topography.png']
    """
    if file_format not in FORMATS:
        raise InputError(f"format = {file_format!r}: must be one of {', '.join(FORMATS)}")
    from ..page import save

    written = []
    for member, corrections in found.corrections.items():
        for correction in corrections:
            title = f"{found.case.title}, {member}"
            figure = topography(correction, title=title)
            sides = "-".join(flank.side for flank in correction.flanks)
            path = Path(folder) / f"{name}-{member}-{sides}-topography.{file_format}"
            written.append(save(figure, path, {"Title": title}))
    return written
