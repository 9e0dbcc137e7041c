"""Sizes of memory and times in words, to two figures."""

from __future__ import annotations

MEMORY_UNITS = {"TB": 1e12, "GB": 1e9, "MB": 1e6}  # [byte]
TIME_UNITS = {"years": 3.15576e7, "days": 86400.0, "h": 3600.0, "min": 60.0}  # [s]


def memory_in_words(size: float) -> str:
    """A size of memory [byte] in words.

    >>> memory_in_words(2.16e9), memory_in_words(4.0e6), memory_in_words(10.0)
    ('2.2 GB', '4 MB', '1 MB')
    """
    unit, factor = next(((unit, one) for unit, one in MEMORY_UNITS.items() if size >= one), ("MB", 1e6))
    value = float(f"{max(size / factor, 1.0):.1e}")
    if value >= 1e6:
        return f"over a million {unit}"
    return f"{value:.1f} {unit}" if value < 10.0 and value % 1.0 else f"{value:.0f} {unit}"


def time_in_words(seconds: float) -> str:
    """A time [s] in words.

    >>> time_in_words(42.4), time_in_words(1e5), time_in_words(4e9), time_in_words(1e300)
    ('about 42 s', 'about 28 h', 'about 130 years', 'over a million years')
    """
    if seconds >= 1e6 * TIME_UNITS["years"]:
        return "over a million years"
    unit, size = next((pair for pair in TIME_UNITS.items() if seconds >= 2.0 * pair[1]), ("s", 1.0))
    return f"about {float(f'{max(seconds / size, 1.0):.1e}'):.0f} {unit}"
