"""Every example in a docstring works."""

from __future__ import annotations

import doctest
import importlib
import pkgutil
from collections.abc import Callable, Iterator
from functools import wraps
from typing import Any

import pytest
from runs import read_only

import easeoff

#: All but the kernels, which are compiled as they are imported.
FOUND = [found.name for found in pkgutil.walk_packages(easeoff.__path__, "easeoff.")]
MODULES = ["easeoff", *(name for name in FOUND if not name.endswith("_kernel"))]


@pytest.fixture(scope="module", autouse=True)
def shared() -> Iterator[None]:
    """Many examples begin with the same analysis, sweep or V-H check, which is computed once and read-only."""
    found: dict[str, Any] = {}

    def once(compute: Callable[..., Any]) -> Callable[..., Any]:
        @wraps(compute)
        def computed(*arguments: Any, **keywords: Any) -> Any:
            given = f"{compute.__name__} {arguments} {keywords}"
            if " object at 0x" in given:
                return compute(*arguments, **keywords)
            if given not in found:
                found[given] = read_only(compute(*arguments, **keywords))
            return found[given].copy(deep=False)

        return computed

    with pytest.MonkeyPatch.context() as patch:
        for package, name in ((easeoff, "analyze"), (easeoff, "sweep"), (easeoff.study, "vh_check")):
            patch.setattr(package, name, once(getattr(package, name)), raising=False)
        yield


@pytest.mark.parametrize("folder", sorted({name.split(".")[1] for name in MODULES if "." in name} | {""}))
def test_examples_work(folder: str) -> None:
    tried = 0
    for name in MODULES:
        if name.split(".")[1:2] == [folder] * bool(folder):
            outcome = doctest.testmod(importlib.import_module(name))
            assert outcome.failed == 0, name
            tried += outcome.attempted
    assert tried > 2
