"""Compiled modules of the package: found, and refused where they are not those of the source beside them."""

from __future__ import annotations

import hashlib
import importlib
import importlib.util
from importlib.machinery import EXTENSION_SUFFIXES
from pathlib import Path
from typing import Any

HINT = "run 'make', or install the package again (pip install .)"


def kernel(name: str, package: str) -> Any:
    """Compiled module of a relative name; refused if it is missing or compiled from another source than beside it."""
    from .errors import MissingPackageError  # the build runs this file by itself

    spec = importlib.util.find_spec(name, package)
    place = "" if spec is None or spec.origin is None else spec.origin
    if not place.endswith(tuple(EXTENSION_SUFFIXES)):
        raise MissingPackageError(f"{package}{name}: is not compiled here; {HINT}")
    module = importlib.import_module(name, package)
    source = Path(place).with_name(f"{name.removeprefix('.')}.py")
    if source.is_file() and source_digest(source) != module.SOURCE_DIGEST:
        raise MissingPackageError(f"{package}{name}: has changed since it was compiled; {HINT}")
    return module


def source_digest(source: Path) -> str:
    """Digest of a compiled module's source and types, and of those of its folder: it may use them."""
    digest = hashlib.sha256()
    for types in sorted(source.parent.glob("*.pxd")):
        for path in (types, types.with_suffix(".py")):
            digest.update(path.read_bytes().replace(b"\r\n", b"\n"))
    return digest.hexdigest()
