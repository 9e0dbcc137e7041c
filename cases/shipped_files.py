"""Names and titles of the files that come with the package. To list them, neither schemas nor numpy are loaded."""

from __future__ import annotations

from pathlib import Path

from ..core.toml_text import toml_tables

CASES = Path(__file__).parent
DESIGNS, SUPPORTS, DEVIATIONS = CASES / "designs", CASES / "supports", CASES / "deviations"


def names(folder: Path, suffix: str = ".toml") -> list[str]:
    """Names of the files in a folder, without their suffix."""
    return sorted(file.name.removesuffix(suffix) for file in folder.iterdir() if file.name.endswith(suffix))


def titles(folder: Path) -> dict[str, str]:
    """Names and titles of the TOML files in a folder, which tests check."""
    texts = {name: (folder / f"{name}.toml").read_text(encoding="utf-8") for name in names(folder)}
    return {name: str(toml_tables(text, name)["title"]) for name, text in texts.items()}


def shipped_cases() -> dict[str, str]:
    """Names and titles of the cases that come with the package.

    Examples
    --------
    >>> "nasa-12x36" in shipped_cases()
    True
    """
    return titles(CASES)


def shipped_designs() -> dict[str, str]:
    """Names and titles of the designs that come with the package.

    Examples
    --------
    >>> "fm-11x41" in shipped_designs()
    True
    """
    return titles(DESIGNS)


def shipped_supports() -> dict[str, str]:
    """Names and titles of the supports that come with the package.

    Examples
    --------
    >>> list(shipped_supports())
    ['axle-fm-11x41', 'gearbox-nasa-12x36']
    """
    return titles(SUPPORTS)


def shipped_deviations() -> list[str]:
    """Names of the measured grids that come with the package.

    Examples
    --------
    >>> shipped_deviations()[-1]
    'fm-11x41-worn-pinion'
    """
    return names(DEVIATIONS, ".csv")
