"""Completion of the words of a command line, in bash as the script of ``easeoff completion`` does it."""

from __future__ import annotations

import shutil
import subprocess
import sys
from pathlib import Path

import pytest
from runs import call, refusal_of, text_file

from easeoff.cases import shipped_designs

BASH = shutil.which("bash")
#: The script completes by the name of the program; here that is a file which runs the commands of this checkout.
PROGRAM = "#!{python}\nimport sys\nsys.argv[0] = 'easeoff'\nfrom easeoff.study.cli import main\nmain()\n"
COMPLETE = """
source <(easeoff completion bash)
complete -p easeoff >/dev/null || exit 3
while read -r -a COMP_WORDS; do
    [ "${{COMP_WORDS[-1]}}" = "''" ] && COMP_WORDS[-1]=""
    COMP_CWORD=$((${{#COMP_WORDS[@]}} - 1)); COMPREPLY=()
    _easeoff_completion easeoff 2>/dev/null
    echo "${{COMPREPLY[*]}}"
done <<'WORDS'
{lines}
WORDS
"""


@pytest.mark.thorough
@pytest.mark.skipif(BASH is None, reason="no bash here")
def test_bash_completes_commands_options_and_names(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    program = text_file(tmp_path / "easeoff", PROGRAM.format(python=sys.executable))
    program.chmod(0o755)
    monkeypatch.setenv("PATH", str(tmp_path), prepend=":")
    wanted = {
        "easeoff sho": "show",
        "easeoff run nasa": "nasa-12x36",
        "easeoff run fm-11x41 --supp": "--supports",
        "easeoff wear fm-11x41 --supports a": "axle-fm-11x41",
        "easeoff design ''": " ".join(shipped_designs()),
        "easeoff new case face": "face-milled face-hobbed",
        "easeoff new oil p": "pao-vg100",
        "easeoff run fm-11x41 --oil h": "heavy-mineral",
        "easeoff run fm-11x41 --flank c": "coast",
        "easeoff compare p.nc --solvers native,clar": "native,clarabel",
        "easeoff run fm-11x41 --friction-model benedict": "benedict_kelly",
        "easeoff completion f": "fish",
        "easeoff run ./": "",  # files, by the shell itself
    }
    script = COMPLETE.format(lines="\n".join(wanted))
    done = subprocess.run([str(BASH), "--norc", "-c", script], capture_output=True, text=True, check=True)
    assert dict(zip(wanted, done.stdout.split("\n"), strict=False)) == wanted


@pytest.mark.parametrize(
    ("shell", "mark"), [("bash", "complete -o"), ("zsh", "#compdef easeoff"), ("fish", "complete ")]
)
def test_every_shell_has_its_script(shell: str, mark: str) -> None:
    made = call("completion", shell)
    assert made.exit_code == 0
    assert mark in made.stdout
    assert f"_EASEOFF_COMPLETE={shell}_complete" in made.stdout
    found = shutil.which(shell)
    if found is not None:
        subprocess.run([found, "-n"], input=made.stdout, text=True, check=True)  # reads it without running it


def test_another_shell_is_a_mistake() -> None:
    refusal_of("completion", "tcsh")


def test_help_has_the_command_of_each_shell_on_a_line_of_its_own() -> None:
    words = call("completion", "--help").output
    assert "\\b" not in words
    lines = [line.split() for line in words.splitlines()]
    for shell in ("bash", "zsh", "fish"):
        assert [shell, "easeoff", "completion", shell] in [line[:4] for line in lines]
