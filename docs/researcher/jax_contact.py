"""The contact problem as a function that JAX differentiates: ``pip install jax``.

Forward it is ``easeoff.contact.solve``, backward the adjoint of ``easeoff.contact.sensitivity``, which gives the
derivatives by all data with one more linear system.
"""

from __future__ import annotations

from functools import partial
from typing import Any

import jax
import jax.numpy as jnp
import numpy as np

from easeoff.contact import ContactProblem, sensitivity, solve

jax.config.update("jax_enable_x64", True)

Array = Any


def solution(separation: Array, lever_arm: Array, torque: Array, local: Array, factor: Array) -> tuple[Array, ...]:
    """Forces (n) [N], gaps (n) [mm] and rotation [rad] as numpy arrays; C = diag(local) + factor factor'."""
    found = solve(ContactProblem(separation, lever_arm, float(torque), (local, factor)))
    return found.force, found.gap, np.float64(found.rotation)


def gradients(*data_and_weights: Array) -> tuple[Array, ...]:
    """Derivatives by the five data of the sum of weights times forces, gaps and rotation, as numpy arrays."""
    separation, lever_arm, torque, local, factor, by_force, by_gap, by_rotation = map(np.asarray, data_and_weights)
    problem = ContactProblem(separation, lever_arm, float(torque), (local, factor))
    found = sensitivity(problem, solve(problem)).adjoint(force=by_force, gap=by_gap, rotation=float(by_rotation))
    return found.separation, found.lever_arm, np.float64(found.torque), found.local, found.factor


def shape_of(array: Array) -> Array:
    """What JAX has to know of a result before it is computed."""
    return jax.ShapeDtypeStruct(jnp.shape(array), jnp.float64)


#: JAX may call the function again; it calls it for one element of a batch after the other.
callback = partial(jax.pure_callback, vmap_method="sequential")


def primal(separation: Array, lever_arm: Array, torque: Array, local: Array, factor: Array) -> Array:
    """Forces, gaps and rotation of a contact problem as JAX arrays."""
    data = separation, lever_arm, torque, local, factor
    return callback(solution, (shape_of(separation), shape_of(separation), shape_of(0.0)), *data)


def forward(*data: Array) -> tuple[Array, Array]:
    """The solution, and what its derivatives need."""
    return primal(*data), data


def backward(data: Array, weights: Array) -> Array:
    """Gradient by the data, of weights of the results."""
    return callback(gradients, tuple(map(shape_of, data)), *data, *weights)


contact = jax.custom_vjp(primal)
contact.defvjp(forward, backward)


def largest_force(crowning: Array) -> Array:
    """Smooth maximum of the forces [N] of a line of contact with this crowning [mm]."""
    x = jnp.linspace(-1.0, 1.0, 15)
    factor = 1e-3 * jnp.stack([jnp.ones(15), 0.5 * x], axis=1)
    force, _, _ = contact(crowning * x**2, jnp.full(15, 50.0), 2e5, jnp.full(15, 3e-6), factor)
    return jnp.sum(force**8) ** (1.0 / 8.0)


if __name__ == "__main__":
    step = 1e-7
    difference = (largest_force(0.02 + step) - largest_force(0.02 - step)) / (2.0 * step)
    slope = jax.jit(jax.grad(largest_force))
    print(f"derivative by the crowning: {slope(0.02):.6f} N/mm; by a difference: {difference:.6f} N/mm")
    print("over a batch:", jax.vmap(slope)(jnp.array([0.01, 0.02, 0.04])))
