"""Mutations of paths: what stands where a file is read or written, other than the file."""

from __future__ import annotations

import contextlib
import os
import random
import shutil
import socket
import stat
from pathlib import Path

#: Kinds of things; those that only the owner of a machine can make are left out where they cannot be made.
KINDS = (
    "folder", "full folder", "pipe", "device", "link", "dangling link", "circle of links", "link to folder",
    "no permission",
    "read-only folder", "sparse", "socket", "empty", "absent", "hidden link chain",
)  # fmt: skip
SPARSE_SIZE = 2**33  # [bytes]


def occupy(rng: random.Random, path: Path, kind: str | None = None) -> str:
    """Put something else where a file is, or where one will be written; return its kind."""
    kind = kind or rng.choice(KINDS)
    old = path.read_bytes() if path.is_file() else b""
    with contextlib.suppress(OSError):
        path.unlink()
    with contextlib.suppress(OSError):
        _make(kind, path, old)
    return kind


def _make(kind: str, path: Path, old: bytes) -> None:
    other = path.with_name("elsewhere-" + path.name)
    if kind in ("folder", "full folder"):
        path.mkdir()
        if kind == "full folder":
            (path / "kept.txt").write_text("kept\n")
    elif kind == "pipe":
        os.mkfifo(path)
    elif kind == "device":
        # Made in the folder of the input: nothing outside can be damaged.
        os.mknod(path, stat.S_IFCHR | 0o666, os.makedev(1, 5))
    elif kind == "link":
        other.write_bytes(old)
        path.symlink_to(other.name)
    elif kind == "dangling link":
        path.symlink_to("nowhere/" + path.name)
    elif kind == "circle of links":
        path.symlink_to(other.name)
        other.symlink_to(path.name)
    elif kind == "link to folder":
        other.mkdir()
        path.symlink_to(other.name)
    elif kind == "hidden link chain":
        other.write_bytes(old)
        for n in range(30):
            link = path.with_name(f"link{n}")
            link.symlink_to(other.name if n == 0 else f"link{n - 1}")
        path.symlink_to("link29")
    elif kind == "no permission":
        path.write_bytes(old)
        path.chmod(0)
    elif kind == "read-only folder":
        path.write_bytes(old)
        path.parent.chmod(0o555)
    elif kind == "sparse":
        with open(path, "wb") as stream:
            stream.write(old)
            stream.truncate(SPARSE_SIZE)
    elif kind == "socket":
        with socket.socket(socket.AF_UNIX) as server, contextlib.chdir(path.parent):
            server.bind(path.name)
    elif kind == "empty":
        path.write_bytes(b"")


def release(folder: Path) -> None:
    """Give a folder its permissions back, and remove it."""
    for root, _, _ in os.walk(folder):
        os.chmod(root, 0o755)
    shutil.rmtree(folder)
