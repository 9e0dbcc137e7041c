"""Shape functions of the serendipity brick of 20 nodes, the element of CalculiX and other programs."""

from __future__ import annotations

from functools import cache
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ...contact.compliance.finite_elements.bricks import shape_functions

Array = NDArray[Any]


def serendipity_functions(points: Array) -> tuple[Array, Array]:
    """Shape functions and gradients as ``bricks.shape_functions``, zero for the seven nodes that the brick lacks.

    Examples
    --------
    >>> values, _ = serendipity_functions(np.zeros((1, 3)))
    >>> float(values.sum()), int(np.count_nonzero(values))
    (1.0, 20)
    """
    values, gradients = shape_functions(points)
    fewer = _serendipity()
    return values @ fewer, np.einsum("nak,ab->nbk", gradients, fewer)


@cache
def _serendipity() -> Array:
    """Values (27, 27) of the 20 functions at all 27 nodes, zero for the nodes they lack."""
    points = np.stack(np.meshgrid(*[[-1.0, 0.0, 1.0]] * 3, indexing="ij"), axis=-1).reshape(27, 3)
    values = np.zeros((27, 27))
    for node, at in enumerate(points):
        zero = np.flatnonzero(at == 0.0)
        linear = np.prod(1.0 + np.delete(points, zero, axis=1) * np.delete(at, zero), axis=1)
        if zero.size == 0:
            values[:, node] = linear * (points @ at - 2.0) / 8.0
        elif zero.size == 1:
            values[:, node] = linear * (1.0 - points[:, zero[0]] ** 2) / 4.0
    return values
