"""Least film thickness of a smooth, isothermal line contact, by name.

>>> from easeoff.friction import FILMS
>>> list(FILMS)
['pan_hamrock', 'dowson_higginson']
>>> print(f"{FILMS['pan_hamrock'](1e-11, 5000.0, 1.3e-4):.2e}")
1.58e-05
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

from numpy.typing import NDArray

from ...core.checks import one_of

Array = NDArray[Any]


def pan_hamrock(speed: Array, material: Array, load: Array) -> Array:
    """Least film thickness over equivalent radius (...) from U, G, W (...).

    Pan and Hamrock, ASME Journal of Tribology 111, 1989, doi 10.1115/1.3261900: H = 1.714 U^0.694 G^0.568 W^-0.128.
    """
    return 1.714 * speed**0.694 * material**0.568 * load**-0.128


def dowson_higginson(speed: Array, material: Array, load: Array) -> Array:
    """Least film thickness over equivalent radius (...) from U, G, W (...).

    Dowson and Higginson, Elastohydrodynamic Lubrication, Pergamon, 1966: H = 2.65 U^0.7 G^0.54 W^-0.13.
    """
    return 2.65 * speed**0.7 * material**0.54 * load**-0.13


FILMS: dict[str, Callable[[Array, Array, Array], Array]] = {
    "pan_hamrock": pan_hamrock,
    "dowson_higginson": dowson_higginson,
}


def film_formula(name: str) -> Callable[[Array, Array, Array], Array]:
    """A film formula by name.

    Raises
    ------
    InputError
        If the name is unknown.
    """
    return FILMS[one_of("film", name, FILMS)]
