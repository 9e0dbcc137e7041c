"""Modes that all tooth pairs share, such as those of shafts, bearings and housing, beside those of the pairs."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from .modal_basis import ModalBasis, modal_basis

Array = NDArray[np.float64]


def with_shared_modes(basis: ModalBasis, columns: Array, mixing: Array) -> ModalBasis:
    """The modes of tooth pairs, and shared modes W beside them: C = diag(d) + U U' + W W'.

    Parameters
    ----------
    basis
        Modes U of the tooth pairs, p blocks.
    columns
        What a unit force at each segment does to what all share, such as its wrench (n, q).
    mixing
        Of every block (p, q, s): a segment i of block b has the row W_i = columns_i mixing_b [(mm/N)^0.5].

    Examples
    --------
    >>> pairs = ModalBasis(4, np.array([[0, 1], [2, 3]]), np.array([[[1e-3], [2e-3]], [[2e-3], [1e-3]]]))
    >>> spring = with_shared_modes(pairs, np.ones((4, 1)), np.full((2, 1, 1), 5e-4))
    >>> round(float(spring.factor[0] @ spring.factor[3]), 12)
    2.5e-07
    """
    shared = np.zeros((basis.size, mixing.shape[2]))
    for (rows, _), own in zip(basis.blocks, mixing, strict=True):
        shared[rows] = columns[rows] @ own
    return modal_basis(np.concatenate([basis.factor, shared], axis=1))
