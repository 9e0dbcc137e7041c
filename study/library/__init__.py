"""Library of contact problems: problems of the shipped cases with reference answers, versioned and reproducible.

``library_entries`` declares the problems and holds their answers, ``library_files`` makes and writes them.
"""

from .library_entries import Entry, ReferenceAnswer, entries, reference_answers
from .library_files import generate

__all__ = ["Entry", "ReferenceAnswer", "entries", "generate", "reference_answers"]
