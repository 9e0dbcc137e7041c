"""Mutations of the bytes of any file: flipped, overwritten, cut, moved."""

from __future__ import annotations

import random


def flip(rng: random.Random, data: bytearray) -> bytearray:
    """Overwrite bytes at random, or flip a bit."""
    for _ in range(rng.choice([1, 1, 5, 50, 500])):
        at = rng.randrange(len(data))
        data[at] = rng.choice([rng.randrange(256), data[at] ^ (1 << rng.randrange(8))])
    return data


def flip_head(rng: random.Random, data: bytearray) -> bytearray:
    """Overwrite bytes near the start, where formats keep their structure."""
    for _ in range(rng.choice([1, 3, 10])):
        data[rng.randrange(min(len(data), 2048))] = rng.choice([0, 255, rng.randrange(256)])
    return data


def truncate(rng: random.Random, data: bytearray) -> bytearray:
    """Cut off the rest."""
    return data[: rng.randrange(len(data))]


def blank(rng: random.Random, data: bytearray) -> bytearray:
    """Set a block to zero, as a disk that fails does."""
    at = rng.randrange(len(data))
    count = min(len(data) - at, rng.choice([8, 64, 1024, 8192]))
    data[at : at + count] = bytes([rng.choice([0, 0, 255])]) * count
    return data


def shift(rng: random.Random, data: bytearray) -> bytearray:
    """Remove or insert a few bytes."""
    at, count = rng.randrange(len(data)), rng.choice([1, 4, 8, 512])
    return data[:at] + data[at + count :] if rng.random() < 0.5 else data[:at] + bytes(count) + data[at:]


def mutated(rng: random.Random, data: bytes) -> bytes:
    """Bytes after one of these mutations."""
    if not data:
        return b"x"
    return bytes(rng.choice([flip, flip, flip, flip_head, truncate, blank, shift])(rng, bytearray(data)))
