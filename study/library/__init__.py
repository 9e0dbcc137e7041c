"""Library of contact problems: problems of the shipped cases with reference answers, versioned and reproducible.

``library_entries`` declares the problems, ``problem_generation`` and ``problem_changes`` make them,
``reference_answers`` holds and proves their answers, ``library_files`` writes them.
"""

from .library_entries import KINDS, LIBRARY_VERSION, PARTS, USUAL_PARTS, Entry, Source, entries
from .library_files import LibraryFile, write_library
from .problem_generation import generate
from .reference_answers import ReferenceAnswer, proved_answer, reference_answers

__all__ = [
    "KINDS",
    "LIBRARY_VERSION",
    "PARTS",
    "USUAL_PARTS",
    "Entry",
    "LibraryFile",
    "ReferenceAnswer",
    "Source",
    "entries",
    "generate",
    "proved_answer",
    "reference_answers",
    "write_library",
]
