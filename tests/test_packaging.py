"""The package as it ships: every folder with code is listed, every docstring example works."""

from __future__ import annotations

import doctest
import importlib
import importlib.util
import pkgutil
import tomllib
from pathlib import Path

import easeoff

ROOT = Path(__file__).parents[1]
CODE = ("geometry", "contact", "friction", "cases", "study", "core", "verification")


def test_every_folder_with_code_is_listed_as_a_package() -> None:
    """A sub-package missing from the list works in a checkout and is absent from the wheel."""
    listed = tomllib.loads((ROOT / "pyproject.toml").read_text())["tool"]["setuptools"]["packages"]
    folders = {"easeoff"}
    for part in CODE:
        for file in (ROOT / part).rglob("*.py"):
            folders.add("easeoff." + ".".join(file.parent.relative_to(ROOT).parts))
    assert folders == set(listed)


def test_only_the_package_file_stands_at_the_root() -> None:
    assert [p.name for p in ROOT.glob("*.py")] == ["__init__.py"]


def test_examples_in_docstrings_work() -> None:
    tried = 0
    for part in CODE:
        if not (ROOT / part).exists():
            continue
        package = importlib.import_module(f"easeoff.{part}")
        for found in pkgutil.walk_packages(package.__path__, f"easeoff.{part}."):
            outcome = doctest.testmod(importlib.import_module(found.name))
            assert outcome.failed == 0, found.name
            tried += outcome.attempted
    assert tried > 3


def test_public_names_are_there() -> None:
    for name in easeoff.__all__:
        assert getattr(easeoff, name) is not None
