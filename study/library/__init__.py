"""The problem library: contact problems of the shipped cases, described, versioned, made anew by one command.

`description` declares what is in it, `generation` and `changes` make it, `answers` holds and proves reference answers,
`files` writes it.
"""

from .library_entries import KINDS, LIBRARY_VERSION, PARTS, Entry, Source, entries
from .library_files import Written, write_library
from .problem_generation import generate
from .reference_answers import Answer, proved_answer, reference_answers

__all__ = [
    "KINDS",
    "LIBRARY_VERSION",
    "PARTS",
    "Answer",
    "Entry",
    "Source",
    "Written",
    "entries",
    "generate",
    "proved_answer",
    "reference_answers",
    "write_library",
]
