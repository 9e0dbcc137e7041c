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
    from .contact_figures import (
        contact_pattern,
        deviations,
        ease_off,
        efficiency,
        friction_maps,
        load_sharing,
        misalignment,
        pressure,
        root_stress,
        topography,
        transmission_error,
    )
    from .study_figures import front, load_cases, optimization, sweep, vh_check, wear
    from .written_pictures import pictures, write_pictures

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
    ".contact_figures": [
        "contact_pattern",
        "deviations",
        "ease_off",
        "efficiency",
        "friction_maps",
        "load_sharing",
        "misalignment",
        "pressure",
        "root_stress",
        "topography",
        "transmission_error",
    ],
    ".study_figures": ["front", "load_cases", "optimization", "sweep", "vh_check", "wear"],
    ".written_pictures": ["pictures", "write_pictures"],
}
__getattr__, __dir__ = lazy_names(__name__, _ORIGINS)
