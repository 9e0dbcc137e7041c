"""The exceptions of the package: one tree, so that a caller can catch all of them at once."""

from __future__ import annotations

import importlib.util
import shlex
import sys
from pathlib import Path

from .printable import message


class EaseoffError(Exception):
    """Anything this package raises on purpose.

    Its text is harmless to a terminal, and values of any length are shortened in it.

    Examples
    --------
    >>> import easeoff
    >>> try:
    ...     easeoff.read_case("no-such-case")
    ... except easeoff.EaseoffError as error:
    ...     print(type(error).__name__)
    InputError
    """

    def __str__(self) -> str:
        return message(super().__str__())


class InputError(EaseoffError, ValueError):
    """A value given by the user that cannot be used; the message names it and says what is allowed.

    Examples
    --------
    >>> from easeoff.contact import Material
    >>> try:
    ...     Material(-1.0, 0.3)
    ... except InputError as error:
    ...     print(error)
    elastic_modulus = -1: must be a finite number above 0 [MPa]
    """


class GeometryError(EaseoffError):
    """Settings that describe no tooth: no flank in the blank, no conjugate position, no overlap.

    Examples
    --------
    >>> from easeoff.cases import gear_pair, read_case
    >>> from easeoff.geometry import Misalignment, ease_off
    >>> pair = gear_pair(read_case("nasa-12x36"))
    >>> try:
    ...     ease_off(pair.misaligned(Misalignment(offset=100.0)), (7, 7))
    ... except GeometryError:
    ...     print("no conjugate position")
    no conjugate position
    """


class MissingSolverError(EaseoffError, ImportError):
    """A solver was asked for whose package is not installed; the message says which extra installs it.

    Examples
    --------
    >>> issubclass(MissingSolverError, EaseoffError), issubclass(MissingSolverError, ImportError)
    (True, True)
    """


class MissingPackageError(EaseoffError, ImportError):
    """A file format was asked for whose package is not installed; the message says which extra installs it.

    Examples
    --------
    >>> issubclass(MissingPackageError, EaseoffError), issubclass(MissingPackageError, ImportError)
    (True, True)
    """


def how_to_install(requirement: str) -> str:
    """Return what installs a requirement such as ``easeoff[cad]`` here: in this environment, activated or not.

    An environment made without pip is served by the pip of the Python that made it.
    """
    root = Path(__file__).resolve().parents[1]
    checkout = requirement.startswith("easeoff[") and (root / "pyproject.toml").is_file()
    what = ["-e", f"{root}{requirement.removeprefix('easeoff')}"] if checkout else [requirement]
    if importlib.util.find_spec("pip") is not None:
        pip = [sys.executable, "-m", "pip"]
    else:
        pip = [getattr(sys, "_base_executable", sys.executable), "-m", "pip", "--python", sys.prefix]
    return f"{requirement} installs it: {shlex.join([*pip, 'install', *what])}"
