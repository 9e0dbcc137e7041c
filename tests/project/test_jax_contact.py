"""The example that JAX differentiates: with JAX where it is installed, else with a stand-in that calls through."""

from __future__ import annotations

import importlib
import importlib.util
import sys
from collections.abc import Callable
from types import ModuleType, SimpleNamespace
from typing import Any

import numpy as np
import pytest
from places import DOCS

RESEARCHER = DOCS / "researcher"


class Function:
    """A function with derivatives of its own, as ``jax.custom_vjp``."""

    def __init__(self, primal: Callable[..., Any]) -> None:
        self.primal = primal

    def __call__(self, *data: Any) -> Any:
        return self.primal(*data)

    def defvjp(self, forward: Callable[..., Any], backward: Callable[..., Any]) -> None:
        self.forward, self.backward = forward, backward


def called_through(function: Callable[..., Any], shapes: Any, *data: Any, vmap_method: str) -> Any:
    """As ``jax.pure_callback``: the shapes must be those that were announced."""
    found = function(*data)
    assert [np.shape(one) for one in found] == [one.shape for one in shapes]
    return found


@pytest.fixture
def example(monkeypatch: pytest.MonkeyPatch) -> Any:
    if importlib.util.find_spec("jax") is None:
        jax: Any = ModuleType("jax")
        jax.numpy, jax.config = np, SimpleNamespace(update=lambda *_: None)
        jax.custom_vjp, jax.pure_callback = Function, called_through
        jax.ShapeDtypeStruct = lambda shape, _: SimpleNamespace(shape=shape)
        monkeypatch.setitem(sys.modules, "jax", jax)
        monkeypatch.setitem(sys.modules, "jax.numpy", np)
    monkeypatch.syspath_prepend(RESEARCHER)
    monkeypatch.delitem(sys.modules, "jax_contact", raising=False)
    return importlib.import_module("jax_contact")


def data_of_a_line() -> tuple[Any, ...]:
    x = np.linspace(-1.0, 1.0, 15)
    factor = 1e-3 * np.stack([np.ones(15), 0.5 * x], axis=1)
    return 0.02 * x**2, np.full(15, 50.0), np.float64(2e5), np.full(15, 3e-6), factor


def test_backward_is_the_derivative_of_forward(example: Any) -> None:
    data = data_of_a_line()
    rng = np.random.default_rng(0)
    results, kept = example.forward(*data)
    weights = rng.normal(size=15), 1e6 * rng.normal(size=15), np.float64(1e8 * rng.normal())
    gradient = example.backward(kept, weights)

    def weighed(*data: Any) -> float:
        return sum(float(np.sum(w * np.asarray(one))) for w, one in zip(weights, example.contact(*data), strict=True))

    assert weighed(*data) == pytest.approx(
        sum(np.sum(w * np.asarray(r)) for w, r in zip(weights, results, strict=True))
    )
    for number, (value, slope) in enumerate(zip(data, gradient, strict=True)):
        change = 1e-6 * value * rng.normal(size=np.shape(value))
        ends = [
            weighed(*(one + sign * change if i == number else one for i, one in enumerate(data)))
            for sign in (1.0, -1.0)
        ]
        assert np.sum(np.asarray(slope) * change) == pytest.approx(0.5 * (ends[0] - ends[1]), rel=1e-5)


def test_gradient_through_jax_itself() -> None:
    jax = pytest.importorskip("jax")
    sys.path.insert(0, str(RESEARCHER))
    example = importlib.import_module("jax_contact")
    slope = jax.jit(jax.grad(example.largest_force))(0.02)
    difference = (example.largest_force(0.02 + 1e-7) - example.largest_force(0.02 - 1e-7)) / 2e-7
    assert float(slope) == pytest.approx(float(difference), rel=1e-6)
