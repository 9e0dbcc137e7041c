"""Oracle: what every run must keep, whatever it was given."""

from __future__ import annotations

import hashlib
import os
import re
import stat
import unicodedata
from collections.abc import Sequence
from pathlib import Path

from processes import Outcome

#: Commands that may end with 1: values are uncertified, or a comparison is outside its limit.
MAY_FAIL = ("design", "run", "sweep", "vh", "modify", "optimize", "wear", "library", "verify")
#: Words of which one is in the output then.
REASONS = (
    "certified",
    "outside",
    "early",
    "differ",
    "no load distribution",
    "not reached",
    "not analysed",
    "no analysis",
)
STDOUT_SIZE_LIMIT = 60_000  # [characters], of tables and reports
STDERR_SIZE_LIMIT = 12_000
MESSAGE_SIZE_LIMIT = 4_000  # of a mistake
HASHED_SIZE_LIMIT = 50_000_000  # [bytes]; of a larger file the size alone is compared
#: Stands in a file outside the folder of the input; nothing of it may be shown.
SECRET = "Kq7-secret-4711"
#: Written by a module in the current folder that nobody asked for.
EXECUTED = "executed.txt"
DEFAULT_FOLDERS = {"compare": "comparison", "library": "library"}

Entry = tuple[str, int, int, str]
"""Type, permissions, size and content of something on disk."""


def snapshot(folder: Path) -> dict[str, Entry]:
    """What is in a folder, by path relative to it."""
    found: dict[str, Entry] = {}
    for root, folders, files in os.walk(folder):
        for name in [*folders, *files]:
            path = os.path.join(root, name)
            found[os.path.relpath(path, folder)] = _entry(path)
    return found


def _entry(path: str) -> Entry:
    status = os.lstat(path)
    mode = stat.S_IMODE(status.st_mode)
    if stat.S_ISLNK(status.st_mode):
        return "link", 0, 0, os.readlink(path)
    if stat.S_ISDIR(status.st_mode):
        return "folder", mode, 0, ""
    if not stat.S_ISREG(status.st_mode):
        return "special", mode, 0, str(stat.S_IFMT(status.st_mode))
    if status.st_size > HASHED_SIZE_LIMIT or not os.access(path, os.R_OK):
        return "file", mode, status.st_size, ""
    with open(path, "rb") as stream:
        return "file", mode, status.st_size, hashlib.sha256(stream.read()).hexdigest()


def process_faults(outcome: Outcome, command: str) -> list[str]:
    """What is wrong with how a process ended and what it printed."""
    text = outcome.stdout + outcome.stderr
    faults = []
    if outcome.hung:
        faults.append(f"hang: {outcome.processor_time:.0f} s of processor time, {outcome.wall_time:.0f} s in all")
    elif outcome.code < 0:
        faults.append(f"crash: signal {-outcome.code}")
    elif outcome.code not in (0, 1, 2):
        faults.append(f"exit code {outcome.code}")
    if outcome.orphans:
        faults.append("process left running")
    if "Traceback (most recent call last)" in text:
        faults.append(f"traceback: {_last_line(outcome.stderr)}")
    elif outcome.code == 1 and command not in MAY_FAIL:
        faults.append("exit code 1 of a command that never fails")
    elif outcome.code == 1 and not any(word in text for word in REASONS):
        faults.append("exit code 1 without a reason")
    warned = re.search(r"\b(\w*Warning|Exception ignored|HDF5-DIAG)\b.*", outcome.stderr)
    if warned and "Traceback" not in text:
        faults.append(f"warning of a library: {warned.group()[:120]}")
    return faults + _text_faults(outcome)


def _text_faults(outcome: Outcome) -> list[str]:
    text = outcome.stdout + outcome.stderr
    faults = []
    if outcome.code == 2 and outcome.stderr.count("Error: ") + outcome.stderr.count("Error:\n") < 1:
        faults.append("exit code 2 without a message")
    if outcome.code == 2 and len(outcome.stderr) > MESSAGE_SIZE_LIMIT:
        faults.append(f"message of {len(outcome.stderr)} characters")
    if len(outcome.stdout) > STDOUT_SIZE_LIMIT or len(outcome.stderr) > STDERR_SIZE_LIMIT:
        faults.append(f"output of {len(outcome.stdout)} and {len(outcome.stderr)} characters")
    odd = sorted({f"U+{ord(c):04X}" for c in text if c not in "\n\t" and harmful(c)})
    if odd:
        faults.append(f"control characters: {', '.join(odd[:8])}")
    if SECRET in text:
        faults.append("shows a file outside the folder")
    return faults


def harmful(character: str) -> bool:
    """Whether a terminal may obey a character instead of showing it, or shows the text around it in another order."""
    return (
        unicodedata.category(character) in ("Cc", "Cs", "Zl", "Zp")
        or character in "\u202a\u202b\u202c\u202d\u202e\u2066\u2067\u2068\u2069"
    )


def folder_faults(
    before: dict[str, Entry], after: dict[str, Entry], outcome: Outcome, args: Sequence[str], within: str
) -> list[str]:
    """What is wrong with what a process left in a folder.

    Parameters
    ----------
    before, after
        The folder around that of the input, and all within.
    outcome
        How the process ended.
    args
        Words of its command line: what they name may be written.
    within
        Path of the folder in which it ran.
    """
    new, gone = after.keys() - before.keys(), before.keys() - after.keys()
    changed = {path for path in before.keys() & after.keys() if before[path] != after[path]}
    faults = []
    if any(Path(path).name == EXECUTED for path in after):
        faults.append("code from the current folder ran")
    if outcome.code not in (0, 1):
        touched = sorted(path for path in new | gone | changed if Path(path).name != EXECUTED)
        return faults + ([f"left behind: {', '.join(touched[:4])}"] if touched else [])
    named = [os.path.normpath(os.path.join(within, word)) for word in _paths(args)]
    named += [
        os.path.normpath(os.path.join(os.path.dirname(path), before[path][3]))
        for path in before
        if before[path][0] == "link"
    ]
    # A finished sweep removes its batches.
    removed = {path for path in gone if any(f"{name}.batches" in (path, os.path.dirname(path)) for name in named)}
    stray = [
        path
        for path in (new | gone | changed) - removed
        if not any(_related(path, name) for name in named) and Path(path).name != EXECUTED
    ]
    if stray:
        faults.append(f"touched without being named: {', '.join(sorted(stray)[:4])}")
    # A folder ~ is that of a path that begins so.
    remains = [
        path
        for path in new
        if Path(path).name.startswith(".") or path.endswith(".tmp") or (path.endswith("~") and after[path][0] == "file")
    ]
    if remains:
        faults.append(f"temporary file: {', '.join(sorted(remains)[:4])}")
    for path in changed:
        if before[path][0] == "file" and after[path][0] == "file" and before[path][1] != after[path][1]:
            faults.append(f"permissions of {path} changed from {before[path][1]:o} to {after[path][1]:o}")
        if before[path][0] == "special":
            faults.append(f"{path} is no longer what it was")
    return faults


def _paths(args: Sequence[str]) -> list[str]:
    """Words of a command line that may be paths, and folders that a command writes to by itself."""
    words = [*args, *(word.partition("=")[2] for word in args), *(DEFAULT_FOLDERS.get(word, "") for word in args[:1])]
    if "" in args:
        words.append(".")  # the current folder
    if "--keep" in args:
        words += [os.path.splitext(word)[0] + "-points" for word in args]
    return [word for word in words if word]


def _related(path: str, name: str) -> bool:
    return path == name or path.startswith(f"{name}/") or name.startswith(f"{path}/")


def _last_line(text: str) -> str:
    lines = [line for line in text.strip().split("\n") if line and not line.startswith(" ")]
    return lines[-1][:160] if lines else ""


def place(text: str) -> str:
    """Where in the package an exception came from, to tell findings apart."""
    found = re.findall(r'File "[^"]*/easeoff/((?!fuzz/)[^"]+)", line (\d+)', text)
    return ":".join(found[-1]) if found else ""
