"""Figures of results, reached as ``easeoff.plot``, and their files.

Every function takes a result and returns a matplotlib ``Figure``, a page of its own. With ``axes`` it draws in the
caller's axes, one a panel, row by row, in the text sizes of their figure, and returns nothing, so that a notebook shows
them once. ``pictures`` lists what a result has; ``write_pictures`` writes the files.

>>> import easeoff
>>> tree = easeoff.analyze("nasa-12x36", torques=[100.0])
>>> figure = easeoff.plot.pressure(tree)
>>> figure.savefig("pressure.png")  # doctest: +SKIP
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from ...core.lazy_names import lazy_names

if TYPE_CHECKING:
    from .figures.contact_figures import (
        contact_pattern,
        deviations,
        ease_off,
        load_sharing,
        misalignment,
        pressure,
        root_stress,
        transmission_error,
    )
    from .figures.correction_figures import topography
    from .figures.friction_figures import efficiency, friction_maps
    from .figures.picture_list import pictures
    from .figures.study_figures import front, load_cases, optimization, sweep, vh_check, wear
    from .figures.written_pictures import write_pictures

__all__ = [
    "contact_pattern",
    "deviations",
    "ease_off",
    "efficiency",
    "friction_maps",
    "front",
    "load_cases",
    "load_sharing",
    "misalignment",
    "optimization",
    "pictures",
    "pressure",
    "root_stress",
    "sweep",
    "topography",
    "transmission_error",
    "vh_check",
    "wear",
    "write_pictures",
]

_ORIGINS = {
    ".figures.contact_figures": [
        "contact_pattern",
        "deviations",
        "ease_off",
        "load_sharing",
        "misalignment",
        "pressure",
        "root_stress",
        "transmission_error",
    ],
    ".figures.correction_figures": ["topography"],
    ".figures.friction_figures": ["efficiency", "friction_maps"],
    ".figures.picture_list": ["pictures"],
    ".figures.study_figures": ["front", "load_cases", "optimization", "sweep", "vh_check", "wear"],
    ".figures.written_pictures": ["write_pictures"],
}
__getattr__, __dir__ = lazy_names(__name__, _ORIGINS)
