"""Hooks of imports: calls after the import of another package, the fence of a checkout, figures in notebooks.

The other package is not imported for the call. In a checkout the folder of the package holds tests and docs, too: they
cannot be imported from it.
"""

from __future__ import annotations

import sys
from collections.abc import Callable, Sequence
from contextlib import suppress
from importlib.machinery import ModuleSpec, PathFinder
from pathlib import Path
from types import ModuleType
from typing import Any


class AfterImport:
    """Module finder that calls a function once a package has been imported, and is gone then."""

    def __init__(self, package: str, call: Callable[[], None]) -> None:
        self.package, self.call = package, call

    def find_spec(self, name: str, path: Sequence[str] | None, target: ModuleType | None = None) -> ModuleSpec | None:
        """The package's own specification, whose loader calls the function after its work."""
        if name != self.package:
            return None
        spec = PathFinder.find_spec(name, path, target)
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
    """Call a function once a package has been imported: now if it is loaded, else when somebody imports it."""
    if package in sys.modules:
        call()
    else:
        sys.meta_path.insert(0, AfterImport(package, call))


EXCLUDED_MODULES = ("easeoff.tests", "easeoff.docs", "easeoff.benchmarks", "easeoff.fuzz")


class CheckoutFinder:
    """Module finder that refuses the folders of a checkout that are not part of the package."""

    @staticmethod
    def find_spec(fullname: str, path: Sequence[str] | None, target: ModuleType | None = None) -> None:
        """Raise ``ModuleNotFoundError`` for folders beside the package's own."""
        if fullname in EXCLUDED_MODULES:
            raise ModuleNotFoundError(f"No module named {fullname!r}", name=fullname)


def fence() -> None:
    """Install the finder if the package is that of a checkout."""
    if (Path(__file__).parents[1] / "pyproject.toml").is_file():
        sys.meta_path.insert(0, CheckoutFinder)


FIGURE = ("matplotlib.figure", "Figure")


def show_figures_in_notebooks() -> None:
    """Have a notebook show a matplotlib ``Figure`` that is the value of a cell, unless it does so already.

    IPython does so only once ``matplotlib.pyplot`` is loaded; neither of them is imported here.
    """
    with suppress(Exception):  # of a shell of another kind: the figure is then shown as text
        formatter = sys.modules["IPython"].get_ipython().display_formatter.formatters["image/png"]
        try:
            formatter.lookup_by_type(".".join(FIGURE))
        except KeyError:
            formatter.for_type_by_name(*FIGURE, _png)


def _png(figure: Any) -> Any:
    """The picture of a figure, as IPython draws it."""
    from IPython.core.pylabtools import print_figure

    return print_figure(figure, "png")
