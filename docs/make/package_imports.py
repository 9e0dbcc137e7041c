"""Modules of the package and what they import, read from the source: for the picture of the imports and for tests."""

from __future__ import annotations

import ast
from functools import cache
from pathlib import Path

import easeoff

PACKAGE = Path(easeoff.__file__).parent
#: Folders of the package; each imports from those before it alone.
ROOMS = ("core", "geometry", "contact", "friction", "cases", "study", "verification")


@cache
def modules() -> dict[str, Path]:
    """Every module of the package by its full name."""
    found = {}
    for path in PACKAGE.rglob("*.py"):
        parts = path.relative_to(PACKAGE).with_suffix("").parts
        if parts[0] in (*ROOMS, "__init__"):
            found[".".join(("easeoff", *parts)).removesuffix(".__init__")] = path
    return found


@cache
def imports(name: str) -> frozenset[str]:
    """Modules of the package that a module imports, wherever and under whatever condition it does so."""
    path, found = modules()[name], set()
    package = name.split(".") if path.name == "__init__.py" else name.split(".")[:-1]
    stub = path.with_suffix(".pyi")  # of names that are imported on first use
    text = path.read_text(encoding="utf-8") + (stub.read_text(encoding="utf-8") if stub.is_file() else "")
    for node in ast.walk(ast.parse(text)):
        if isinstance(node, ast.Import):
            found |= {alias.name for alias in node.names}
        elif isinstance(node, ast.ImportFrom):
            above = package[: len(package) + 1 - node.level] if node.level else []
            base = ".".join([*above, *([node.module] if node.module else [])])
            within = {f"{base}.{alias.name}" for alias in node.names} & modules().keys()
            found |= within if len(within) == len(node.names) else {base, *within}
        elif isinstance(node, ast.Call) and isinstance(node.func, ast.Name) and node.func.id == "kernel":
            found |= {".".join(package) + str(arg.value) for arg in node.args[:1] if isinstance(arg, ast.Constant)}
    return frozenset(found & modules().keys()) - {name}


def folder(name: str) -> str:
    """Folder of a module, down to the second level: ``geometry/pair``; empty for the package file."""
    return "/".join(modules()[name].relative_to(PACKAGE).parts[:-1][:2])


def folder_imports() -> set[tuple[str, str]]:
    """Pairs of folders of which the first has a module that imports one of the second; lists of public names aside."""
    found = set()
    for name, path in modules().items():
        if path.name != "__init__.py":
            found |= {(folder(name), folder(other)) for other in imports(name)}
    return {(one, other) for one, other in found if one != other}
