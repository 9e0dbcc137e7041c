"""Files appear whole or not at all and keep permissions; no link waits for them; killed runs leave nothing for long."""

from __future__ import annotations

import contextlib
import errno
import os
import re
import resource
import shutil
import signal
import stat
import subprocess
import sys
import threading
from collections.abc import Callable, Iterator
from pathlib import Path

import numpy as np
import pytest
import xarray as xr
from runs import in_copies, refusal_of, text_file

from easeoff import InputError
from easeoff.contact import ContactProblem, write_problems
from easeoff.contact.compliance.finite_elements import array_store
from easeoff.contact.problem.exchange.programme_file import write_npz
from easeoff.core import output_file
from easeoff.core.output_file import check_folder, check_writable, existing_folder, whole_file


def write(path: Path, text: str = "new") -> None:
    with whole_file(path) as temporary:
        temporary.write_text(text, encoding="utf-8")


def mode(path: Path) -> int:
    return stat.S_IMODE(path.lstat().st_mode)


@contextlib.contextmanager
def umask(mask: int) -> Iterator[None]:
    before = os.umask(mask)
    try:
        yield
    finally:
        os.umask(before)


def listing(folder: Path) -> list[str]:
    return sorted(str(path.relative_to(folder)) for path in folder.rglob("*"))


# Nobody waits at the temporary name.


def test_the_temporary_file_is_in_a_folder_for_its_owner_alone_with_another_name_each_time(tmp_path: Path) -> None:
    seen = set()
    for _ in range(3):
        with whole_file(tmp_path / "x.nc") as temporary:
            assert temporary.parent.parent == tmp_path
            assert mode(temporary.parent) == 0o700
            assert temporary.suffix == ".nc"
            seen.add(temporary.parent.name)
            temporary.write_text("new", encoding="utf-8")
    assert len(seen) == 3
    assert not any(str(os.getpid()) == part for name in seen for part in name.split("."))


def test_a_link_as_target_is_replaced_and_what_it_points_to_stays(tmp_path: Path) -> None:
    precious = text_file(tmp_path / "precious", "precious")
    for link, goal in ((tmp_path / "a.txt", precious), (tmp_path / "b.txt", tmp_path / "nothing")):
        link.symlink_to(goal)
        write(link)
        assert not link.is_symlink()
        assert link.read_text(encoding="utf-8") == "new"
    assert precious.read_text(encoding="utf-8") == "precious"
    assert not (tmp_path / "nothing").exists()


# Permissions.


def test_a_new_file_has_the_mode_of_any_new_file(tmp_path: Path) -> None:
    for mask, expected in ((0o022, 0o644), (0o077, 0o600), (0o002, 0o664)):
        with umask(mask):
            write(tmp_path / f"{mask:o}.txt")
            data = xr.Dataset({"x": ("n", np.arange(3.0))})
            with whole_file(tmp_path / f"{mask:o}.nc") as temporary:
                data.to_netcdf(temporary, engine="netcdf4")
        assert mode(tmp_path / f"{mask:o}.txt") == expected
        assert mode(tmp_path / f"{mask:o}.nc") == expected


@pytest.mark.parametrize("before", [0o600, 0o640, 0o664, 0o666, 0o755])
def test_a_replaced_file_keeps_its_mode(tmp_path: Path, before: int) -> None:
    path = text_file(tmp_path / "x.txt", "old")
    path.chmod(before)
    write(path)
    assert mode(path) == before
    assert path.read_text(encoding="utf-8") == "new"


@pytest.mark.skipif(not hasattr(os, "geteuid") or os.geteuid() != 0, reason="only the administrator gives files away")
def test_a_replaced_file_keeps_its_owner_and_group(tmp_path: Path) -> None:
    path = text_file(tmp_path / "x.txt", "old")
    os.chown(path, 1234, 4321)
    path.chmod(0o640)
    write(path)
    status = path.stat()
    assert (status.st_uid, status.st_gid, mode(path)) == (1234, 4321, 0o640)


def test_a_group_that_cannot_be_kept_gets_no_more_than_everybody(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """As of a file of another group in a shared folder: the group of its writer must not read what it could not."""
    path = text_file(tmp_path / "x.txt", "old")
    path.chmod(0o664)

    def refused(*_: object) -> None:
        raise PermissionError

    class Foreign:
        def __init__(self, status: os.stat_result) -> None:
            self.st_mode, self.st_uid, self.st_gid = status.st_mode, status.st_uid, status.st_gid + 1

    status = Foreign(path.lstat())
    monkeypatch.setattr(os, "chown", refused)
    new = text_file(tmp_path / "new.txt", "new")
    monkeypatch.setattr(Path, "lstat", lambda _: status)
    output_file.take_over_permissions(new, path)
    assert stat.S_IMODE(os.stat(new).st_mode) == 0o644


def test_an_access_list_is_kept_and_none_is_inherited(tmp_path: Path) -> None:
    path = text_file(tmp_path / "x.txt", "old")
    # Version 2: owner rw-, user 1234 rw-, group r--, mask rw-, others ---.
    entries = ((1, 6, 2**32 - 1), (2, 6, 1234), (4, 4, 2**32 - 1), (16, 6, 2**32 - 1), (32, 0, 2**32 - 1))
    packed = b"".join(
        number.to_bytes(size, "little")
        for tag, access, who in entries
        for number, size in ((tag, 2), (access, 2), (who, 4))
    )
    value = (2).to_bytes(4, "little") + packed
    try:
        os.setxattr(path, output_file.ACCESS_LIST, value)
    except (OSError, AttributeError):
        pytest.skip("no access lists in this file system")
    write(path)
    assert os.getxattr(path, output_file.ACCESS_LIST) == value
    plain = text_file(tmp_path / "plain.txt", "old")
    os.setxattr(tmp_path, "system.posix_acl_default", value)
    write(plain)
    assert output_file.ACCESS_LIST not in os.listxattr(plain)


# Faults at every step.

STEPS = ("mkdir", "open", "chmod", "fsync", "replace")


@pytest.mark.parametrize("step", STEPS)
@pytest.mark.parametrize("fault", [errno.ENOSPC, errno.EDQUOT, errno.EIO, errno.EROFS])
def test_a_fault_at_any_step_is_one_message_and_leaves_the_old_file(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, step: str, fault: int
) -> None:
    path = text_file(tmp_path / "x.txt", "old")

    def fail(*_: object, **__: object) -> None:
        raise OSError(fault, os.strerror(fault))

    with monkeypatch.context() as patch:
        patch.setattr(os, step, fail)
        with pytest.raises(InputError, match=f"x.txt cannot be written: {os.strerror(fault)}"):
            write(path)
    assert path.read_text(encoding="utf-8") == "old"
    assert listing(tmp_path) == ["x.txt"]


def test_a_fault_while_writing_leaves_nothing_not_even_the_folders_that_were_made(tmp_path: Path) -> None:
    for error in (OSError(errno.ENOSPC, "No space left on device"), RuntimeError("NetCDF: HDF error")):
        with pytest.raises(InputError, match=r"x\.nc cannot be written"), whole_file(tmp_path / "a" / "b" / "x.nc"):
            raise error
        assert listing(tmp_path) == []
    with pytest.raises(KeyboardInterrupt):
        _write_half(tmp_path / "a" / "b" / "x.nc", KeyboardInterrupt)
    assert listing(tmp_path) == []


def _write_half(path: Path, interruption: type[BaseException]) -> None:
    with whole_file(path) as temporary:
        temporary.write_text("half", encoding="utf-8")
        raise interruption


def test_a_folder_removed_while_writing_is_one_message(tmp_path: Path) -> None:
    def write_there(folder: Path) -> None:
        with whole_file(folder / "x.txt") as file:
            file.write_text("half", encoding="utf-8")
            shutil.rmtree(folder)

    (tmp_path / "new").mkdir()
    with pytest.raises(InputError, match=r"x\.txt cannot be written"):
        write_there(tmp_path / "new")
    assert listing(tmp_path) == []


def test_the_content_is_on_the_disk_before_the_name_and_the_name_before_the_end(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    steps: list[str] = []
    original_sync, original_replace = os.fsync, os.replace

    def sync(descriptor: int) -> None:
        kind = os.fstat(descriptor).st_mode
        steps.append("folder" if stat.S_ISDIR(kind) else "content")
        original_sync(descriptor)

    def replace(*names: Path) -> None:
        steps.append("name")
        original_replace(*names)

    monkeypatch.setattr(os, "fsync", sync)
    monkeypatch.setattr(os, "replace", replace)
    write(tmp_path / "x.txt")
    assert steps == ["content", "name", "folder"]


def problems(path: Path) -> None:
    size = 40
    problem = ContactProblem(np.zeros(size), np.full(size, 40.0), 8e4, np.diag(np.full(size, 1e-6)))
    write_problems([problem] * 3, path, {})


def programme(path: Path) -> None:
    size = 60
    write_npz(ContactProblem(np.zeros(size), np.full(size, 40.0), 8e4, np.diag(np.full(size, 1e-6))), path)


@pytest.mark.parametrize(
    ("write_file", "name"), [(problems, "x.nc"), (programme, "x.npz"), (lambda path: write(path, 9000 * "x"), "x.txt")]
)
@pytest.mark.parametrize("share", [0.0, 0.2, 0.6, 0.95])
def test_a_file_larger_than_the_limit_of_the_system_is_one_message(
    tmp_path: Path, write_file: Callable[[Path], None], name: str, share: float
) -> None:
    """In a process of its own, whose files may not grow beyond a share of what is written."""
    path = tmp_path / name
    write_file(path)
    before, size = path.read_bytes(), path.stat().st_size

    def limited(_: int) -> None:
        signal.signal(signal.SIGXFSZ, signal.SIG_IGN)
        resource.setrlimit(resource.RLIMIT_FSIZE, (int(share * size), int(share * size)))
        with pytest.raises(InputError, match=re.escape(f"{path} cannot be written")):
            write_file(path)

    in_copies(1, limited)
    assert path.read_bytes() == before
    assert listing(tmp_path) == [name]


# Remains of processes that were ended.

KILLED = """
import os, signal, sys
from pathlib import Path
from easeoff.core.output_file import whole_file
from easeoff.core import output_file
step, path = sys.argv[1], sys.argv[2]

def end(*_, **__):
    os.kill(os.getpid(), signal.SIGKILL)

if step == "lock":
    output_file.try_lock = end
elif step in ("open", "fsync", "replace", "chmod"):
    setattr(os, step, end)
with whole_file(path) as temporary:
    if step == "before":
        end()
    temporary.write_text("half")
    if step == "after":
        end()
    if step == "rmdir":
        Path.rmdir = Path.unlink = end
    if step == "last":
        os.rmdir = os.unlink
        Path.rmdir = end
end()
"""


@pytest.mark.parametrize(
    "step", ["open", "lock", "before", "after", "chmod", "fsync", "replace", "rmdir", "last", "end"]
)
def test_what_a_killed_process_left_is_removed_by_the_next_one(tmp_path: Path, step: str) -> None:
    path = text_file(tmp_path / "x.txt", "old")
    done = subprocess.run([sys.executable, "-c", KILLED, step, str(path)], capture_output=True, check=False)
    assert done.returncode == -signal.SIGKILL, done.stderr
    assert path.read_text(encoding="utf-8") == ("half" if step in ("rmdir", "last", "end") else "old")
    if step != "end":
        assert len(listing(tmp_path)) > 1
    write(tmp_path / "y.txt")
    assert listing(tmp_path) == ["x.txt", "y.txt"]


def test_a_check_removes_the_remains_too(tmp_path: Path) -> None:
    subprocess.run([sys.executable, "-c", KILLED, "after", str(tmp_path / "x.txt")], check=False)
    assert listing(tmp_path) != []
    check_writable(tmp_path / "x.txt")
    assert listing(tmp_path) == []


def test_a_file_that_is_being_written_is_left_alone(tmp_path: Path) -> None:
    with whole_file(tmp_path / "x.txt") as temporary:
        temporary.write_text("slow", encoding="utf-8")
        write(tmp_path / "y.txt")
        output_file.clear_remains(tmp_path)
        assert temporary.read_text(encoding="utf-8") == "slow"
    assert listing(tmp_path) == ["x.txt", "y.txt"]


def test_only_remains_of_this_package_are_removed(tmp_path: Path) -> None:
    keep = (".x.txt.123.tmp", ".easeoff-0123.tmp", ".easeoff-0123456789abcdef.tmp.old", "easeoff-0123456789abcdef.tmp")
    for name in keep:
        (tmp_path / name).mkdir()
        (tmp_path / name / "lock").touch()
    # Of the right name, but a file, a link to a folder, and a folder without a lock that holds something.
    (tmp_path / ".easeoff-0000000000000001.tmp").write_text("file", encoding="utf-8")
    (tmp_path / ".easeoff-0000000000000002.tmp").symlink_to(tmp_path / keep[0])
    (tmp_path / ".easeoff-0000000000000003.tmp").mkdir()
    (tmp_path / ".easeoff-0000000000000003.tmp" / "mine").touch()
    before = listing(tmp_path)
    write(tmp_path / "y.txt")
    assert listing(tmp_path) == sorted([*before, "y.txt"])


@pytest.mark.skipif(not hasattr(os, "geteuid") or os.geteuid() != 0, reason="only the administrator gives files away")
def test_remains_of_another_user_are_left_alone(tmp_path: Path) -> None:
    subprocess.run([sys.executable, "-c", KILLED, "after", str(tmp_path / "x.txt")], check=False)
    (left,) = tmp_path.iterdir()
    os.chown(left, 1234, 1234)
    write(tmp_path / "y.txt")
    assert left.exists()


def test_a_private_folder_cleared_in_the_instant_of_its_making_is_made_again(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Another run may find it before it has its lock, or lock it first."""
    original_open, original_lock = os.open, output_file.try_lock
    calls: list[str] = []

    def cleared(path: Path, *flags: int) -> int:
        if not calls and Path(path).name == "lock":
            calls.append("cleared")
            Path(path).parent.rmdir()
        return original_open(path, *flags)

    def locked(descriptor: int) -> bool:
        if len(calls) == 1:
            calls.append("locked")
            return False
        return original_lock(descriptor)

    monkeypatch.setattr(os, "open", cleared)
    monkeypatch.setattr(output_file, "try_lock", locked)
    write(tmp_path / "x.txt")
    assert calls == ["cleared", "locked"]
    monkeypatch.undo()
    write(tmp_path / "y.txt")
    assert listing(tmp_path) == ["x.txt", "y.txt"]


def test_without_locks_files_are_written_and_remains_left_alone(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    subprocess.run([sys.executable, "-c", KILLED, "after", str(tmp_path / "x.txt")], check=False)
    left = listing(tmp_path)

    def none(_: int) -> bool:
        raise OSError(errno.ENOLCK, "No locks available")

    monkeypatch.setattr(output_file, "try_lock", none)
    write(tmp_path / "y.txt")
    assert listing(tmp_path) == sorted([*left, "y.txt"])


# Several at once.


def test_of_several_writers_of_one_file_one_leaves_its_whole_file(tmp_path: Path) -> None:
    path = tmp_path / "new" / "x.txt"
    contents = [str(number) * 200_000 for number in range(6)]
    threads = [threading.Thread(target=write, args=(path, content)) for content in contents]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert path.read_text(encoding="utf-8") in contents
    assert listing(tmp_path) == ["new", "new/x.txt"]


def test_checks_of_the_same_new_folder_do_not_disturb_each_other(tmp_path: Path) -> None:
    """A check that made the folder for a moment could remove it while another looked at it."""
    path = tmp_path / "new" / "deep" / "x.txt"
    faults: list[Exception] = []

    def check() -> None:
        try:
            for _ in range(20):
                check_writable(path)
        except InputError as error:
            faults.append(error)

    threads = [threading.Thread(target=check) for _ in range(4)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert faults == []
    assert listing(tmp_path) == []


def test_processes_that_keep_the_same_arrays_leave_a_whole_file(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv(array_store.FOLDER_VARIABLE, str(tmp_path))
    key = 40 * "a"

    def keep(number: int) -> None:
        made = {"x": np.full(5000, float(number))}
        for _ in range(10):
            array_store.kept(key, {"x": (None,)}, made.copy)
            (tmp_path / f"{key}.npz").unlink(missing_ok=True)
        array_store.kept(key, {"x": (None,)}, made.copy)

    in_copies(3, keep)
    stored = array_store.kept(key, {"x": (None,)}, lambda: {"x": np.zeros(1)})["x"]
    assert np.ptp(stored) == 0.0
    assert stored.size in (1, 5000)
    assert listing(tmp_path) == [f"{key}.npz"]


# Names and folders, before any work.


def test_a_name_that_is_no_text_is_refused_before_any_work(tmp_path: Path) -> None:
    for name in (os.fsdecode(b"kegelr\xe4der.nc"), "a\0b.nc", "a\nb.nc", "\x1b[2J.nc", "a\x85.nc", "\u202ecn.exe"):
        for check in (check_writable, lambda path: check_folder(path, "pictures"), write):
            with pytest.raises(InputError, match=r"must be in UTF-8|must be a name without control characters"):
                check(tmp_path / name)
    assert listing(tmp_path) == []


def test_messages_about_such_names_show_them_harmlessly(tmp_path: Path) -> None:
    for name in ("\x1b[2J", "\u202e", "\x9b2J"):
        assert name not in refusal_of("convert", "nasa-12x36", "-o", f"{tmp_path}/{name}.toml")


def test_a_command_refuses_such_names_and_sources_at_once(tmp_path: Path) -> None:
    name = os.fsdecode(b"kegelr\xe4der")
    for words in (
        ("run", "nasa-12x36", "-o", f"{tmp_path}/{name}.nc"),
        ("run", f"{name}.toml", "-o", f"{tmp_path}/x.nc"),
        ("wear", "nasa-12x36", "--torque", "5", "--revolutions", "1", "-o", f"{name}.nc"),
        ("show", f"{name}.nc"),
    ):
        said = refusal_of(*words)
        assert "kegelr\\udce4der" in said
        assert "must be in UTF-8; rename the file" in said
    assert listing(tmp_path) == []


def test_names_beyond_ascii_are_written_as_they_are(tmp_path: Path) -> None:
    path = tmp_path / "Kegelräder 齿轮" / "größe.nc"
    problems(path)
    assert path.is_file()


def test_the_longest_names_can_be_written(tmp_path: Path) -> None:
    path = tmp_path / (252 * "x" + ".nc")
    check_writable(path)
    write(path)
    with pytest.raises(InputError, match="File name too long"):
        check_writable(tmp_path / (253 * "x" + ".nc"))
    with pytest.raises(InputError, match="File name too long"):
        check_writable(tmp_path / "new" / (256 * "x") / "x.nc")
    assert listing(tmp_path) == [path.name]


def test_a_path_through_folders_that_do_not_exist_is_checked_without_a_trace(tmp_path: Path) -> None:
    (tmp_path / "inside").mkdir()
    check_writable(tmp_path / "inside" / "new" / ".." / ".." / ".." / "x.nc")
    assert listing(tmp_path) == ["inside"]
    (tmp_path / "link").symlink_to("nowhere")
    with pytest.raises(InputError, match="cannot be written"):
        check_writable(tmp_path / "link" / "x.nc")
    assert listing(tmp_path) == ["inside", "link"]


def test_another_users_file_in_a_shared_folder_is_refused_before_the_work(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """In a folder such as ``/tmp`` only the owner can replace it, although everybody may write to it."""
    path = text_file(tmp_path / "x.nc", "old")
    path.chmod(0o666)
    tmp_path.chmod(0o1777)
    monkeypatch.setattr(os, "geteuid", lambda: path.stat().st_uid + 1)
    (tmp_path / "link.nc").symlink_to("nowhere")
    for target in (path, tmp_path / "link.nc"):
        with pytest.raises(InputError, match="another user's"):
            check_writable(target)
    tmp_path.chmod(0o777)
    check_writable(path)


def test_a_folder_is_made_for_what_succeeds(tmp_path: Path) -> None:
    with existing_folder(tmp_path / "a" / "b"):
        pass
    assert listing(tmp_path) == ["a", "a/b"]


# The terminal.


@pytest.mark.parametrize("encoding", ["ascii", "latin-1", "cp437", "utf-8"])
def test_a_terminal_that_lacks_characters_gets_escape_sequences(tmp_path: Path, encoding: str) -> None:
    code = (
        "import click; from easeoff.study.cli import main\n"
        "@main.command()\ndef speak(): click.echo('± 20 °C – µm Ω \\udce4')\nmain()"
    )
    environment = {**os.environ, "PYTHONIOENCODING": encoding}
    command = [sys.executable, "-c", code, "speak"]
    done = subprocess.run(command, capture_output=True, check=False, env=environment)
    assert done.returncode == 0, done.stderr
    assert b"20" in done.stdout
    assert done.stderr == b""


@pytest.mark.skipif(not os.path.exists("/dev/full"), reason="no device that is always full")
@pytest.mark.parametrize("words", [["completion", "bash"], ["--help"], ["run", "--help"]])
def test_output_that_has_no_room_is_one_message(words: list[str]) -> None:
    command = [sys.executable, "-c", "from easeoff.study.cli import main; main()", *words]
    with open("/dev/full", "w", encoding="utf-8") as full:
        done = subprocess.run(command, stdout=full, stderr=subprocess.PIPE, check=False, text=True)
    assert (done.returncode, done.stderr) == (2, "Error: the output: No space left on device\n")
