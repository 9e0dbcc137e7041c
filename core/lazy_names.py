"""Public names of a folder that import their module on first use: what a command does not need is not loaded."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from importlib import import_module
from typing import Any

from .errors import suggestion


def lazy_names(
    package: str, origins: Mapping[str, Sequence[str]], folders: Sequence[str] = ()
) -> tuple[Callable[[str], Any], Callable[[], list[str]]]:
    """Functions ``__getattr__`` and ``__dir__`` of a package.

    Parameters
    ----------
    package
        Its ``__name__``.
    origins
        The names by the module, relative to the package, that they are imported from. No name may be that of a module
        in the package: once imported, the module would stand in its place.
    folders
        Sub-packages that are public names themselves.

    Examples
    --------
    >>> found, _ = lazy_names("easeoff.core", {".magnitude": ["time_in_words"]})
    >>> found("time_in_words").__module__
    'easeoff.core.errors'
    """
    modules = {name: module for module, names in origins.items() for name in names}

    def found(name: str) -> Any:
        if name in modules:
            return getattr(import_module(modules[name], package), name)
        if name in folders:
            return import_module(f".{name}", package)
        near = "" if name.startswith("_") else suggestion(name, [*modules, *folders])
        raise AttributeError(f"module {package!r} has no attribute {name!r}{near}")

    def listed() -> list[str]:
        return sorted([*modules, *folders, "__all__", "__doc__", "__file__", "__name__", "__path__"])

    return found, listed
