"""The exceptions of the package: one tree, so that a caller can catch all of them at once."""

from __future__ import annotations


class EaseoffError(Exception):
    """Anything this package raises on purpose."""


class InputError(EaseoffError, ValueError):
    """A value given by the user that cannot be used; the message names it and says what is allowed."""


class GeometryError(EaseoffError):
    """Settings that describe no tooth: no flank in the blank, no conjugate position, no overlap."""


class MissingSolverError(EaseoffError, ImportError):
    """A solver was asked for whose package is not installed; the message says which extra installs it."""


class MissingPackageError(EaseoffError, ImportError):
    """A file format was asked for whose package is not installed; the message says which extra installs it."""


def how_to_install(requirement: str) -> str:
    """What a message says about an extra such as ``easeoff[cad]``: what brings it, and how in a checkout."""
    extra = requirement.removeprefix("easeoff")
    return f"{requirement} installs it; in a checkout, python3 -m pip --python .venv install -e '.{extra}'"
