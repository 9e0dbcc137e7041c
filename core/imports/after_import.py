"""A call after the import of another package, which is not imported for it."""

from __future__ import annotations

import sys
from collections.abc import Callable, Sequence
from importlib.machinery import ModuleSpec, PathFinder
from types import ModuleType


class AfterImport:
    """Module finder that calls a function once a package has been imported, and is gone then.

    Parameters
    ----------
    package
        Name of the package.
    call
        What to call.
    """

    def __init__(self, package: str, call: Callable[[], None]) -> None:
        self.package = package
        self.call = call

    def find_spec(
        self, fullname: str, path: Sequence[str] | None, target: ModuleType | None = None
    ) -> ModuleSpec | None:
        """The package's own specification, whose loader calls the function after its work."""
        if fullname != self.package:
            return None
        spec = PathFinder.find_spec(fullname, path, target)
        loader = None if spec is None else spec.loader
        if loader is None:
            return None
        execute = loader.exec_module

        def exec_module(module: ModuleType) -> None:
            execute(module)
            if self in sys.meta_path:
                sys.meta_path.remove(self)
            self.call()

        loader.exec_module = exec_module  # type: ignore[method-assign]
        return spec


def after_import(package: str, call: Callable[[], None]) -> None:
    """Call a function once a package has been imported: now if it is loaded, else when somebody imports it.

    Parameters
    ----------
    package
        Name of the package.
    call
        What to call, without arguments.

    Examples
    --------
    >>> after_import("sys", lambda: print("loaded already"))
    loaded already
    """
    if package in sys.modules:
        call()
    else:
        sys.meta_path.insert(0, AfterImport(package, call))
