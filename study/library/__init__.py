"""Library of contact problems: problems of the shipped cases with reference answers, versioned and reproducible.

``library_entries`` declares the problems, ``library_files`` makes and writes them, ``reference_answers`` holds and
proves their answers.
"""

from .library_entries import Entry, entries
from .library_files import generate
from .reference_answers import ReferenceAnswer, reference_answers

__all__ = ["Entry", "ReferenceAnswer", "entries", "generate", "reference_answers"]
