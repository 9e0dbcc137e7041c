"""Public names of a folder, listed in its stub, that import their module on first use."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import lazy_loader

from .errors import suggestion


def lazy_names(package: str, file: str) -> tuple[Callable[[str], Any], Callable[[], list[str]], list[str]]:
    """``__getattr__``, ``__dir__`` and ``__all__`` of a package, by its ``__name__`` and ``__file__``, from its stub.

    No name may be that of a module in the package: once imported, the module would stand in its place.
    """
    named, listed, names = lazy_loader.attach_stub(package, file)

    def public_name(name: str) -> Any:
        if name in names:
            return named(name)
        near = "" if name.startswith("_") else suggestion(name, names)
        raise AttributeError(f"module {package!r} has no attribute {name!r}{near}")

    return public_name, listed, names
