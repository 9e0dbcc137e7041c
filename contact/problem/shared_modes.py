"""Modes that all tooth pairs share, such as those of shafts, bearings and housing, beside those of the pairs."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from ...core.checks import instance
from .modal_basis import ModalBasis, SharedModes

Array = NDArray[np.float64]


def with_shared_modes(basis: ModalBasis, columns: Array, mixing: Array) -> ModalBasis:
    """The modes of tooth pairs, and shared modes W beside them: C = diag(d) + U U' + W W'.

    Parameters
    ----------
    basis
        Modes U of the tooth pairs, p blocks; shared modes that it has already are kept.
    columns
        What a unit force at each segment does to what all share, such as its wrench (n, q).
    mixing
        Of every block (p, q, s): a segment i of block b has the row W_i = columns_i mixing_b [(mm/N)^0.5].

    Raises
    ------
    InputError
        Arrays of the wrong shape, or numbers that are not finite.

    Examples
    --------
    >>> import numpy as np
    >>> from easeoff.contact import ModalBasis, with_shared_modes
    >>> pairs = ModalBasis(4, np.array([[0, 1], [2, 3]]), np.array([[[1e-3], [2e-3]], [[2e-3], [1e-3]]]))
    >>> spring = with_shared_modes(pairs, np.ones((4, 1)), np.full((2, 1, 1), 5e-4))
    >>> round(float(spring.factor[0] @ spring.factor[3]), 12)
    2.5e-07
    """
    instance("basis", basis, ModalBasis)
    shared = replace(basis, shared=SharedModes(columns, mixing))
    if not shared.shared_factor.shape[1]:  # rigid supports
        return basis
    if basis.shared is not None:
        shared = replace(basis, shared=_joined(basis.shared, columns, mixing))
    shared.__dict__["blocks"] = basis.blocks
    return shared


def _joined(first: SharedModes, columns: Array, mixing: Array) -> SharedModes:
    """Shared modes, and others beside them."""
    p, q, s = first.mixing.shape
    both = np.zeros((p, q + mixing.shape[1], s + mixing.shape[2]))
    both[:, :q, :s], both[:, q:, s:] = first.mixing, mixing
    return SharedModes(np.hstack([first.columns, columns]), both)
