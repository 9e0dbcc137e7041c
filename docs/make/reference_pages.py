"""Pages of the reference of the interface: one for every public package, made from its ``__all__``."""

from __future__ import annotations

import importlib
import inspect
import os
import re
import sys
from collections.abc import Iterator
from pathlib import Path
from types import ModuleType

PACKAGES = {
    "easeoff": "Analyses and results",
    "easeoff.geometry": "Flanks, pairs and teeth",
    "easeoff.geometry.tooth": "Whole teeth",
    "easeoff.geometry.formats": "Measuring points, CAD, meshes",
    "easeoff.contact": "Contact problems and contact of teeth",
    "easeoff.friction": "Friction and efficiency",
    "easeoff.friction.ehl": "Mixed lubrication",
    "easeoff.friction.ehl.study": "Parameter study of mixed lubrication",
    "easeoff.cases": "Case files",
    "easeoff.study.plot": "Figures, the same as easeoff.plot",
    "easeoff.study": "Studies, reports, pictures",
    "easeoff.study.sweep": "Sweeps",
    "easeoff.study.compare": "Comparison of solvers",
    "easeoff.study.library": "Problem library",
}


def kind(thing: object) -> str:
    """Heading under which a public name stands."""
    if inspect.isclass(thing):
        return "Exceptions" if issubclass(thing, BaseException) else "Classes"
    return "Functions" if callable(thing) and not hasattr(thing, "__origin__") else "Constants"


def names(package: ModuleType, before: set[int]) -> dict[str, list[str]]:
    """Public names of a package by kind, but modules and what a package before it has already."""
    found: dict[str, list[str]] = {"Functions": [], "Classes": [], "Exceptions": [], "Constants": []}
    for name in package.__all__:
        thing = getattr(package, name)
        if not inspect.ismodule(thing) and id(thing) not in before:
            found[kind(thing)].append(name)
            before.add(id(thing))
    return {heading: listed for heading, listed in found.items() if listed}


def comment(name: str) -> str:
    """What the comment above the definition of a constant says."""
    for module in [module for key, module in sorted(sys.modules.items()) if key.startswith("easeoff.")]:
        if name in vars(module) and module.__file__:
            text = Path(module.__file__).read_text(encoding="utf-8")
            said = re.search(rf"((?:^#:? .*\n)*)^{name}\b[^=\n]*=(?!=)(.*)", text, flags=re.MULTILINE)
            if said:
                lines = [line.lstrip("#: ") for line in said[1].splitlines()] or [said[2].partition("#")[2]]
                return " ".join(lines).strip()
    return ""


def page(package: ModuleType, title: str, before: set[int]) -> Iterator[str]:
    """Lines of the page of a package."""
    name = package.__name__
    yield from (f"{name}: {title.lower()}", "=" * (len(name) + len(title) + 2), "", f".. currentmodule:: {name}", "")
    yield (inspect.getdoc(package) or "").split("\n\n", 1)[0]
    for heading, listed in names(package, before).items():
        yield from ("", heading, "-" * len(heading), "")
        if heading == "Constants":
            for each in listed:
                yield from (f".. py:data:: {each}", "", f"   {comment(each)}", "")
        else:
            yield from (".. autosummary::", "   :toctree: .", "", *(f"   {each}" for each in listed))
    yield ""


def write_reference_pages(folder: Path) -> None:
    """Write the pages into a folder; one that is as it was is left alone, for Sphinx to see that."""
    folder.mkdir(exist_ok=True)
    before: set[int] = set()
    for name, title in PACKAGES.items():
        text, path = os.linesep.join(page(importlib.import_module(name), title, before)), folder / f"{name}.rst"
        if not path.exists() or path.read_text(encoding="utf-8") != text:
            path.write_text(text, encoding="utf-8")
