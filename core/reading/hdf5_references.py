"""References of an HDF5 file that lead out of it, or round in circles; a file that netCDF writes has none of them.

The HDF5 library follows references to other files without a question, and netCDF ends the process in a circle of
groups. Neither can be told not to; so the references are found by their form in the bytes of the file (HDF5 File Format
Specification 3.0, sections III.C, IV.A.2.g, IV.A.2.h and IV.A.2.i).
"""

from __future__ import annotations

import mmap
import os
import re
import struct
from collections.abc import Iterator
from typing import NamedTuple

from ..errors import InputError
from .regular_file import named

SIGNATURE = b"\x89HDF\r\n\x1a\n"
ADDRESS_SIZE = 8  # in every file that netCDF writes [bytes]
ROOT_ADDRESS = {0: 64, 1: 68}  # its place by the version of the superblock; 36 of newer ones [bytes]
FOREIGN_BLOCK_LIMIT = 1 << 22  # in front of HDF5 data [bytes]
#: Heaps with the names of files, and what stands before their address in a message: of external files the version and
#: the numbers of slots, of a virtual layout version and class.
HEAPS = (
    (re.compile(rb"HEAP\x00{4}"), rb"\x01\x00{3}[\x00-\xff]{4}"),
    (re.compile(rb"GCOL\x01\x00{3}"), rb"[\x04\x05]\x03"),
)
ADDRESSES_AT_ONCE = 200
#: Version and flags of a link, and its type where it is not a hard one: 1 for a soft, 64 for an external link.
LINK = re.compile(rb"\x01(?:[\x00-\x07\x10-\x17]|[\x08-\x0f\x18-\x1f][\x01\x40])")
ORDERED, TYPED, CHARACTER_SET = 0x04, 0x08, 0x10
OBJECT = re.compile(rb"OHDR\x02|\x01\x00[\x00-\xff]{2}[\x00-\xff]{4}")
SYMBOLS = re.compile(rb"SNOD\x01\x00")
SYMBOL_SIZE, SOFT_SYMBOL = 40, 2
NAME_LENGTH_LIMIT = 1024
LINK_COUNT_LIMIT = 20_000


class _Link(NamedTuple):
    name: bytes
    target: int | None  # address of an object; none of a soft or external link


def check_references(path: str | os.PathLike[str]) -> bool:
    """Refuse an HDF5 file that refers to other files.

    Returns
    -------
    bool
        Whether an object has several names: then groups may lead round in circles.

    Raises
    ------
    InputError
        If the file refers to other files or to itself by name, or its form is none that netCDF writes.
    """
    with open(path, "rb") as file, mmap.mmap(file.fileno(), 0, access=mmap.ACCESS_READ) as content:
        if content[: len(SIGNATURE)] != SIGNATURE:
            if content[:FOREIGN_BLOCK_LIMIT].find(SIGNATURE) >= 0:
                raise InputError(f"{named(path)} has foreign data before its own: it is not read")
            return False  # an older format of netCDF, or no netCDF at all
        if content[9 if content[8] >= 2 else 13] != ADDRESS_SIZE:
            raise InputError(f"{named(path)} has addresses that are not of {ADDRESS_SIZE} bytes: it is not read")
        if any(_refers(content, heap, message) for heap, message in HEAPS):
            raise InputError(f"{named(path)} has data in other files: it is not read")
        root = content[(at := ROOT_ADDRESS.get(content[8], 36)) : at + ADDRESS_SIZE]
        targets = {int.from_bytes(root, "little"): b""}
        for count, link in enumerate(_links(content)):
            if link.target is None:
                raise InputError(f"{named(path)} has links to other names or files: it is not read")
            if count > LINK_COUNT_LIMIT:
                raise InputError(f"{named(path)} has more than {LINK_COUNT_LIMIT} groups and variables: it is not read")
            if targets.setdefault(link.target, link.name) != link.name:
                return True
    return False


def _refers(content: mmap.mmap, heap: re.Pattern[bytes], message: bytes) -> bool:
    """Whether a message holds the address of a heap with names of files."""
    addresses = [struct.pack("<Q", found.start()) for found in heap.finditer(content)]
    return any(
        re.search(message + b"(?:" + b"|".join(map(re.escape, addresses[at : at + ADDRESSES_AT_ONCE])) + b")", content)
        for at in range(0, len(addresses), ADDRESSES_AT_ONCE)
    )


def _links(content: mmap.mmap) -> Iterator[_Link]:
    """Links of the groups, by their messages or, of older groups, by the nodes of their symbol tables."""
    for found in LINK.finditer(content):
        link = _link(content[found.start() : found.start() + NAME_LENGTH_LIMIT + 64])
        if link is not None and (link.target is None or _is_object(content, link.target)):
            yield link
    for found in SYMBOLS.finditer(content):
        (count,) = struct.unpack_from("<H", content[found.end() : found.end() + 2].ljust(2, b"\0"))
        nodes = content[found.end() + 2 : found.end() + 2 + count * SYMBOL_SIZE]
        for at in range(0, len(nodes) - SYMBOL_SIZE + 1, SYMBOL_SIZE):
            name, target, kind = struct.unpack_from("<QQI", nodes, at)
            yield _Link(struct.pack("<QI", name, found.start() % 2**32), None if kind == SOFT_SYMBOL else target)


def _link(message: bytes) -> _Link | None:
    """The link that a message holds; none if its bytes cannot be one."""
    flags = message[1]
    at = 2 + (1 if flags & TYPED else 0)
    external = bool(flags & TYPED) and message[2] == 0x40
    at += (8 if flags & ORDERED else 0) + (1 if flags & CHARACTER_SET else 0)
    width = 1 << (flags & 0x03)
    length = int.from_bytes(message[at : at + width], "little")
    name, rest = message[at + width : at + width + length], message[at + width + length :]
    if not 0 < length <= NAME_LENGTH_LIMIT or not _is_text(name):
        return None
    if not flags & TYPED:
        return _Link(name, int.from_bytes(rest[:ADDRESS_SIZE], "little")) if len(rest) >= ADDRESS_SIZE else None
    value = rest[2 : 2 + int.from_bytes(rest[:2], "little")]
    if external:
        return _Link(name, None) if value[:1] == b"\0" and _is_text(value[1:].split(b"\0", 1)[0]) else None
    return _Link(name, None) if value and _is_text(value) else None


def _is_object(content: mmap.mmap, address: int) -> bool:
    """Whether an object begins at an address."""
    return address < len(content) and OBJECT.match(content, address) is not None


def _is_text(value: bytes) -> bool:
    """Whether bytes are text that can be printed."""
    try:
        return value.decode().isprintable() and bool(value)
    except UnicodeDecodeError:
        return False
