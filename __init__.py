"""Contact of spiral bevel and hypoid gears, from machine settings to certified loaded contact.

The names a script needs are here and loaded on first use; the stages are the sub-packages ``geometry``, ``contact``
and ``friction``.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from .core.checkout import fence

if TYPE_CHECKING:
    from .cases import Case, read_case
    from .study.analysis import analyze
    from .study.optimization import optimize
    from .study.result import read_result, write_result

__all__ = ["Case", "analyze", "optimize", "read_case", "read_result", "write_result"]

_HOMES = {
    "Case": ".cases",
    "optimize": ".study.optimization",
    "read_case": ".cases",
    "analyze": ".study.analysis",
    "read_result": ".study.result",
    "write_result": ".study.result",
}

fence()


def __getattr__(name: str) -> Any:
    if name in _HOMES:
        from importlib import import_module

        return getattr(import_module(_HOMES[name], __name__), name)
    if name in ("cases", "contact", "friction", "geometry", "study"):
        from importlib import import_module

        return import_module(f".{name}", __name__)
    raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
