"""Mutations of a file of arrays (npz): arrays gone, renamed, of other values, shapes and types, or pickled."""

from __future__ import annotations

import io
import random
import zipfile
from pathlib import Path
from typing import Any

import numpy as np

HUGE_HEADER = (
    b"\x93NUMPY\x01\x00v\x00{'descr': '<f8', 'fortran_order': False, 'shape': (10000000000,), }".ljust(127) + b"\n"
)


def mutate(rng: random.Random, path: Path) -> None:
    """Change one array of a file."""
    with np.load(path, allow_pickle=False) as stored:
        arrays: dict[str, Any] = {name: stored[name] for name in stored.files}
    name = rng.choice(list(arrays))
    old = arrays[name]
    way = rng.choice(["drop", "rename", "values", "values", "shape", "type", "pickle", "add", "header", "nan"])
    if way == "header":
        with zipfile.ZipFile(path, "w") as archive:
            for key, array in arrays.items():
                stream = io.BytesIO()
                np.save(stream, array)
                archive.writestr(f"{key}.npy", HUGE_HEADER if key == name else stream.getvalue())
        return
    if way in ("drop", "rename"):
        del arrays[name]
    if way == "rename":
        arrays[name + "_x"] = old
    elif way == "values" and old.dtype.kind == "f":
        arrays[name] = old * rng.choice([1.0 + 1e-6, 1.1, -1.0, 0.0])
    elif way == "nan" and old.dtype.kind == "f":
        arrays[name] = np.where(np.arange(old.size).reshape(old.shape) == 0, np.nan, old)
    elif way == "shape":
        arrays[name] = rng.choice([old.ravel(), old[None], old.ravel()[:1], np.zeros((0, 3))])
    elif way == "type":
        arrays[name] = rng.choice([old.astype(str), np.zeros(old.shape, "f4"), np.zeros(old.shape, "i8")])
    elif way == "pickle":
        arrays[name] = np.array([{"a": 1}], dtype=object)
    elif way == "add":
        arrays["extra"] = old
    np.savez(path, **arrays)
