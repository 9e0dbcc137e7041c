"""The problem library: contact problems of the shipped cases, described, versioned, made anew by one command.

`description` declares what is in it, `generation` and `changes` make it, `answers` holds and proves reference answers,
`files` writes it.
"""

from .answers import Answer, proved_answer, reference_answers
from .description import KINDS, LIBRARY_VERSION, PARTS, Entry, Source, entries
from .files import Written, write_library
from .generation import generate

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
