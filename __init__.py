"""Contact of spiral bevel and hypoid gears, from machine settings to certified loaded contact.

An analysis in two lines:

>>> import easeoff
>>> tree = easeoff.analyze("nasa-12x36", torques=[100.0])
>>> int(tree["loaded"]["status"].max())  # zero: every load distribution is certified
0

The functions here read a case, analyse or optimise it, and write and read the result, an ``xarray.DataTree``. What they
raise is an ``EaseoffError``. The sub-packages hold the steps and can be used alone: ``geometry`` (flanks and ease-off),
``contact`` (unloaded and loaded contact, the contact problem and its solvers), ``friction`` (friction coefficient and
efficiency), ``cases`` (case files), ``study`` (reports, wear, comparison of solvers), ``plot`` (figures) and
``verification`` (independent checks). All are imported on first use.

Every ``xarray.DataTree`` has the accessor ``easeoff``: ``tree.easeoff.summary()`` and so on, see
``easeoff.study.ResultAccessor``; every ``xarray.Dataset`` that of a sweep, see ``easeoff.study.SweepAccessor``.
"""

from __future__ import annotations

from importlib import import_module
from typing import TYPE_CHECKING, Any

from .core.import_hooks import after_import, fence, show_figures_in_notebooks
from .core.lazy_names import lazy_names

if TYPE_CHECKING:
    import xarray as xr

    from .study.notebook.accessors import ResultAccessor, SweepAccessor

_named, __dir__, __all__ = lazy_names(__name__, __file__)

#: Folders with public names, in which a name is looked for that is not here.
_FOLDERS = ("study", "cases", "contact", "geometry", "friction", "study.plot", "study.sweep", "verification")


def _register_accessor() -> None:
    """Give every tree and dataset of xarray the attribute ``easeoff``, which imports the accessor on first use."""
    import xarray as xr

    def accessor(tree: xr.DataTree) -> ResultAccessor:
        from .study.notebook.accessors import ResultAccessor

        return ResultAccessor(tree)

    def sweep_accessor(dataset: xr.Dataset) -> SweepAccessor:
        from .study.notebook.accessors import SweepAccessor

        return SweepAccessor(dataset)

    xr.register_datatree_accessor("easeoff")(accessor)  # type: ignore[no-untyped-call]
    xr.register_dataset_accessor("easeoff")(sweep_accessor)  # type: ignore[no-untyped-call]


fence()
if __name__ == "easeoff":  # test runners import the root of a checkout under the name of its folder, too
    after_import("xarray", _register_accessor)
    show_figures_in_notebooks()


def __getattr__(name: str) -> Any:
    if name in __all__:
        return _named(name)
    if name == "__version__":
        return import_module("importlib.metadata").version(__name__)
    raise AttributeError(f"module {__name__!r} has no attribute {name!r}{_hint(name)}")


def _hint(name: str) -> str:
    """Place of a name in a sub-package, or the nearest name, as the end of a phrase."""
    if name.startswith("_") or __name__ != "easeoff":
        return ""  # a test runner asks an unpacked source distribution, where nothing is compiled, for names of its own
    wanted = {"report": "write_report"}.get(name, name)
    for folder in _FOLDERS:
        if wanted in import_module(f".{folder}", __name__).__all__:
            return f": it is {__name__}.{folder.replace('study.plot', 'plot')}.{wanted}"
    return str(import_module(".core.errors", __name__).suggestion(name, __all__))
