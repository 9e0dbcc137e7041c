"""Library of contact problems: problems of the shipped cases with reference answers, versioned and reproducible.

``library_entries`` declares the problems, ``problem_generation`` and ``problem_changes`` make them,
``reference_answers`` holds and proves their answers, ``library_files`` writes them.
"""

from .library_entries import Entry, entries
from .problem_generation import generate
from .reference_answers import ReferenceAnswer, reference_answers

__all__ = [
    "Entry",
    "ReferenceAnswer",
    "entries",
    "generate",
    "reference_answers",
]
