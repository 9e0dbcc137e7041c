"""Checks of arguments, with one form of message: ``NAME = VALUE: must be ... [UNIT]``.

Each check returns the value, ready for use, or raises ``InputError``. A truth value, a text or a complex number is no
number; an array without dimensions is one.
"""

from __future__ import annotations

import functools
import math
import operator
import os
import reprlib
from collections.abc import Callable, Hashable, Iterable, Mapping, Sequence
from itertools import islice
from numbers import Real
from pathlib import Path
from types import UnionType
from typing import Any, Literal, NamedTuple, TypeGuard, TypeVar, Union, get_args, get_origin, get_type_hints

import numpy as np
from numpy.typing import NDArray

from .errors import InputError, printable, shortened

Record = TypeVar("Record")

KIND_WORDS = {"bool": "True or False", "Callable": "a function", "Mapping": "a dict", "NoneType": "None", "str": "text"}
SHOWN_COUNT_LIMIT = 6  # numbers of an array that a message shows one by one


class Bounds(NamedTuple):
    """Range of the numbers allowed; ``above`` and ``below`` do not belong to it."""

    above: float | None
    least: float | None
    below: float | None
    most: float | None
    infinite: bool

    def hold(self, value: Any) -> Any:
        """True for a number, or for each entry of an array, that is within the bounds."""
        valid = ~np.isnan(value) if self.infinite else np.isfinite(value)
        valid = valid if self.above is None else valid & (value > self.above)
        valid = valid if self.least is None else valid & (value >= self.least)
        valid = valid if self.below is None else valid & (value < self.below)
        return valid if self.most is None else valid & (value <= self.most)

    def in_words(self, noun: str, unit: str) -> str:
        """The numbers allowed, in words."""
        above, least, below, most, infinite = self
        finite = "" if infinite or below is not None or most is not None else "finite "
        if least is not None and most is not None:
            bounds = f" from {least:g} to {most:g}"
        else:
            lower = f" above {above:g}" if above is not None else f" of {least:g} or more" if least is not None else ""
            upper = f" below {below:g}" if below is not None else f" of at most {most:g}" if most is not None else ""
            bounds = f"{lower} and{upper.removeprefix(' of')}" if lower and upper else lower + upper
        return f"{finite}{noun}{bounds}" + (f" [{unit}]" if unit not in ("", "1") else "")


def number(
    name: str,
    value: Any,
    unit: str = "1",
    *,
    above: float | None = None,
    least: float | None = None,
    below: float | None = None,
    most: float | None = None,
    infinite: bool = False,
) -> float:
    """Return a finite number within bounds; ``above`` and ``below`` do not belong to the range.

    A unit of ``1`` is left out of the message; ``infinite`` allows infinity unless ``below`` or ``most`` is given.
    """
    if getattr(value, "ndim", None) == 0 and hasattr(value, "item"):
        value = value.item()  # an array without dimensions holds one number
    bounds = Bounds(above, least, below, most, infinite)
    if not (is_number(value) and bool(bounds.hold(float(value)))):
        raise InputError(f"{name} = {shown(value)}: must be a {bounds.in_words('number', unit)}")
    return float(value)


def positive(name: str, value: Any, unit: str = "1", *, zero: bool = False, infinite: bool = False) -> float:
    """Return a positive number, or zero if ``zero``; ``infinite`` allows infinity."""
    return number(name, value, unit, above=None if zero else 0.0, least=0.0 if zero else None, infinite=infinite)


def whole(name: str, value: Any, least: int, most: int | None = None) -> int:
    """Return a whole number from ``least`` to ``most``."""
    try:
        counted = None if isinstance(value, bool) else operator.index(value)
    except TypeError:
        counted = None
    if counted is None or counted < least or (most is not None and counted > most):
        allowed = f"of {least} or more" if most is None else f"from {least} to {most}"
        raise InputError(f"{name} = {_quoted(value)}: must be a whole number {allowed}")
    return counted


def two_whole(name: str, values: Any, least: int) -> tuple[int, int]:
    """Return two whole numbers of ``least`` or more."""
    first, second = two(name, values, f"whole numbers of {least} or more")
    return whole(f"{name}[0]", first, least), whole(f"{name}[1]", second, least)


def truth(name: str, value: Any) -> bool:
    """Return True or False; nothing else stands for them."""
    if not isinstance(value, bool):
        raise InputError(f"{name} = {shown(value)}: must be True or False")
    return value


def one_of(name: str, value: Any, allowed: Iterable[str]) -> str:
    """Return a word that is one of those allowed."""
    words = tuple(allowed)
    if not (isinstance(value, str) and value in words):
        raise InputError(f"{name} = {shown(value)}: must be one of {', '.join(words)}")
    return value


def instance(name: str, value: Any, kind: Any) -> None:
    """Refuse a value that is not of a type, or of one of several types joined by ``|``."""
    if not isinstance(value, kind):
        names = [one.__name__ for one in get_args(kind) or (kind,)]
        wanted = [KIND_WORDS.get(word, f"{'an' if word[0] in 'AEIOU' else 'a'} {word}") for word in names]
        raise InputError(f"{name} = {shown(value)}: must be {' or '.join(wanted)}")


def instances(name: str, values: Any, kind: type[Record], count: int | None = None) -> tuple[Record, ...]:
    """Return the objects of one type in a list or tuple, of a given length if that is given."""
    objects = tuple(values) if isinstance(values, Sequence) else (None,)
    if not all(isinstance(one, kind) for one in objects) or count not in (None, len(objects)):
        many = "all" if count is None else count
        raise InputError(f"{name} = {shown(values)}: must be {many} of the type {kind.__name__}, in a list or tuple")
    return objects


def two(name: str, values: Any, wanted: str) -> tuple[Any, Any]:
    """Return two values of any type, called ``wanted`` in the message."""
    try:
        first, second = values
    except (TypeError, ValueError) as error:
        raise InputError(f"{name} = {shown(values)}: must be two {wanted}") from error
    return first, second


def file_path(name: str, value: Any, also: str = "") -> Path:
    """Return a path, given as text, bytes or an object that stands for one; ``also`` adds to the message."""
    try:
        return Path(os.fsdecode(value))
    except TypeError as error:
        raise InputError(f"{name} = {shown(value)}: must be {also}a path, as text, bytes or a Path") from error


def array(
    name: str,
    values: Any,
    unit: str = "1",
    *,
    ndim: int | None = None,
    size: int | None = None,
    fewest: int = 0,
    above: float | None = None,
    least: float | None = None,
    below: float | None = None,
    most: float | None = None,
    infinite: bool = False,
    anything: bool = False,
    frozen: bool = False,
) -> NDArray[np.float64]:
    """Return an array of finite numbers, each within the bounds of ``number``.

    ``size`` and ``fewest`` count the entries. ``anything`` takes every number, NaN too, for callers with better
    messages of their own; ``frozen`` returns a read-only copy in C order.
    """
    numbers, bounds = _numbers(values, frozen), Bounds(above, least, below, most, infinite)
    if (
        numbers is None
        or (ndim is not None and numbers.ndim != ndim)
        or numbers.size < fewest
        or (size is not None and numbers.size != size)
    ):
        wanted = bounds._replace(infinite=infinite or anything).in_words("numbers", unit)
        count = f"{size}" if size is not None else f"{fewest} or more" if fewest else ""
        form = {None: "", 0: "one alone", 1: "in a row", 2: "in rows and columns"}.get(ndim, f"in {ndim} dimensions")
        wanted += f", {' '.join(filter(None, (count, form)))}" if count or form else ""
        raise InputError(f"{name} = {shown(values)}: must be {wanted}{_why_no_numbers(values)}")
    valid = bounds.hold(numbers)
    if not (anything or np.count_nonzero(valid) == valid.size):
        raise InputError(f"{name} = {shown(numbers[~valid].flat[0])}: must be a {bounds.in_words('number', unit)}")
    return read_only(numbers) if frozen else numbers


def read_only(values: NDArray[np.float64]) -> NDArray[np.float64]:
    """Forbid writing to an array and return it."""
    values.setflags(write=False)
    return values


def frozen_arrays(record: type[Record]) -> type[Record]:
    """Class decorator of a frozen dataclass: the arrays that it keeps are read-only, those given are copied.

    So are arrays in tuples, lists and mappings, those of its cached properties, and those of a copy or of a pickle.
    """
    for name in ("__init__", "__setstate__"):
        method: Any = getattr(record, name, lambda self, state: self.__dict__.update(state))  # as Python does
        setattr(record, name, _freezing(method))
    for value in vars(record).values():
        if isinstance(value, functools.cached_property):
            value.func = functools.wraps(value.func)(lambda self, compute=value.func: frozen(compute(self)))
    return record


def _freezing(method: Callable[..., None]) -> Callable[..., None]:
    """A method of a record that freezes its arrays at the end."""

    @functools.wraps(method)
    def freeze(self: Any, *values: Any, **named: Any) -> None:
        method(self, *values, **named)
        for name in (*getattr(self, "__dict__", ()), *getattr(self, "__slots__", ())):
            value = getattr(self, name)
            kept = frozen(value)
            if kept is not value:
                object.__setattr__(self, name, kept)

    return freeze


def frozen(value: Any) -> Any:
    """Return an array, or tuple, list or dict of some, that cannot be written to: the value itself where it is that."""
    if isinstance(value, float | int | str):
        return value
    if isinstance(value, np.ndarray):
        within: Any = value
        while isinstance(within, np.ndarray) and not within.flags.writeable:
            within = within.base
        if within is None:
            return value
        copy = np.array(value, subok=True)
        copy.setflags(write=False)
        return copy
    named = isinstance(value, tuple) and hasattr(value, "_make")
    if not named and type(value) not in (tuple, list, dict):
        return value
    entries = list(value.values() if isinstance(value, dict) else value)
    kept = [frozen(entry) for entry in entries]
    if all(copy is entry for copy, entry in zip(kept, entries, strict=True)):
        return value
    if isinstance(value, dict):
        return dict(zip(value, kept, strict=True))
    return type(value)._make(kept) if named else type(value)(kept)


def distinct(name: str, values: Any, unit: str = "1", **bounds: Any) -> NDArray[np.float64]:
    """Return one number, or several that differ, within the bounds of ``number``, as an array in one dimension."""
    numbers = np.atleast_1d(array(name, values, unit, fewest=1, **bounds))
    if numbers.ndim > 1:
        raise InputError(f"{name} = {shown(values)}: must be a number, or numbers in a row")
    different, counts = np.unique(numbers, return_counts=True)
    if different.size != numbers.size:
        twice = shown(different[counts > 1][0])
        raise InputError(f"{name} = {shown(values)}: must be numbers that differ; {twice} comes twice")
    return numbers


def words(name: str, values: Any, fewest: int = 0) -> tuple[str, ...]:
    """Return texts, ``fewest`` or more, given as a list, a tuple or the like; one text alone is refused."""
    listed = isinstance(values, Iterable) and not isinstance(values, str | bytes | Mapping)
    listed = listed and getattr(values, "ndim", None) != 0
    texts = tuple(values) if listed else ()
    if not listed or len(texts) < fewest or not all(isinstance(value, str) for value in texts):
        wanted = f", {fewest} or more" if fewest else ""
        raise InputError(f"{name} = {shown(values)}: must be a list of texts{wanted}")
    return texts


def check_fields(record: Any, of: str = "") -> None:
    """Refuse a record whose values are of other kinds than its annotations, or out of bounds, for ``__post_init__``.

    A ``float`` is finite and becomes Python's own; an ``int`` is 0 or more; both, if the field is ``bounded``, within
    its bounds. Arrays, tuples and dicts are not looked into. ``of`` stands before the name in the message.
    """
    record_type: Any = type(record)
    for name, kind, optional, bounds in _field_kinds(record_type):
        value = getattr(record, name)
        if (value is None and optional) or (not bounds and type(value) is kind is float and math.isfinite(value)):
            continue  # nearly all, in a tenth of the time
        if get_origin(kind) is Literal:
            if not isinstance(value, str | int) or value not in get_args(kind):
                raise InputError(f"{name} = {shown(value)}: must be one of {', '.join(map(str, get_args(kind)))}")
        elif kind is float or kind is int:
            python_number = number(f"{of}{name}", value, **bounds) if kind is float else whole(name, value, **bounds)
            if not isinstance(value, kind):
                object.__setattr__(record, name, python_number)
        elif kind is bool:
            truth(name, value)
        elif isinstance(kind, type) and kind is not Any:
            instance(name, value, kind)


def bounded(unit: str = "1", **limits: Any) -> dict[str, Any]:
    """Metadata of a field that ``check_fields`` keeps within bounds: those of ``number``, or of ``whole``."""
    return {"unit": unit, **limits}


@functools.cache
def _field_kinds(record: Hashable) -> tuple[tuple[str, Any, bool, dict[str, Any]], ...]:
    """Fields of a record: the type that their annotation allows, if it is one, whether None, too, and their bounds."""
    field_kinds = []
    for name, hint in get_type_hints(record).items():
        kinds = get_args(hint) if get_origin(hint) in (Union, UnionType) else (hint,)
        given = [kind for kind in kinds if kind is not type(None)]
        if field := record.__dataclass_fields__.get(name):  # type: ignore[attr-defined]
            kind, bounds = given[0] if len(given) == 1 else Any, dict(field.metadata)
            if kind is int:
                bounds = {"least": bounds.get("least", 0), "most": bounds.get("most")}
            field_kinds.append((name, kind, len(given) < len(kinds), bounds))
    return tuple(field_kinds)


def shown(value: Any) -> str:
    """A value as messages show it: a number to twelve digits, a large array by its shape, anything else in short.

    No other function puts values into messages.
    """
    if isinstance(value, np.ndarray):
        if value.ndim and (value.ndim > 1 or value.size > SHOWN_COUNT_LIMIT):
            return f"array of shape {value.shape}"
        value = value.tolist()
    return f"{float(value):.12g}" if is_number(value) else _quoted(value)


def _quoted(value: Any) -> str:
    """Python's own text for a value, in short and in one line."""
    try:
        text = reprlib.repr(value)
    except Exception:  # of a foreign object, or of a whole number of too many digits
        text = f"a value of the type {type(value).__name__}"
    return printable(shortened(text))


def is_number(value: Any) -> TypeGuard[float]:
    """True if a value is a real number that a float can hold."""
    if not isinstance(value, Real) or isinstance(value, bool):
        return False
    try:
        float(value)
    except OverflowError:
        return False
    return True


def _numbers(values: Any, copied: bool) -> NDArray[np.float64] | None:
    """An array of what can be made numbers without loss, in C order if copied; None of anything else."""
    try:
        if isinstance(values, np.ma.MaskedArray) and np.ma.is_masked(values):
            return None
        given = np.asarray(values)
        if given.dtype.kind not in "fiuO" or (given.dtype.kind == "O" and _strange(given)):
            return None
        return np.array(given, np.float64, order="C") if copied else np.asarray(given, dtype=np.float64)
    except (TypeError, ValueError, OverflowError):
        return None


def _strange(given: NDArray[Any]) -> list[Any]:
    """The first entry of an array of objects that is no real number, though numpy may make one of it, or none."""
    kinds = (str, bytes, bool, np.bool_, complex, np.complexfloating, type(None))
    objects = given.flat if given.dtype.kind == "O" else ()
    return list(islice((entry for entry in objects if isinstance(entry, kinds)), 1))


def _why_no_numbers(values: Any) -> str:
    """Reason why an array is not one of real numbers, and the remedy; empty where it is its shape alone."""
    if isinstance(values, np.ma.MaskedArray) and np.ma.is_masked(values):
        return f"; {np.count_nonzero(np.ma.getmaskarray(values))} are masked: fill them in, or leave them out"
    try:
        given = np.asarray(values)
        strange = _strange(given)
        kind = type(strange[0]) if strange else given.dtype.type
        if issubclass(kind, complex | np.complexfloating):
            return "; they are complex: give their real part (.real), if the imaginary one is zero"
        if issubclass(kind, bool | np.bool_):
            return "; they are truth values: give them as floats, if they are meant as 0 and 1"
        if given.ndim and not strange and given.dtype.kind in "fiuO":
            np.asarray(given, dtype=np.float64)
            return ""
    except (TypeError, ValueError, OverflowError):
        return ""
    return "; they are texts or other objects: convert them to floats" if given.ndim else ""
