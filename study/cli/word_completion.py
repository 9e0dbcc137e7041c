"""Completion of the words of a command line: names of what is shipped, and files.

Command that prints the script by which a shell completes the words of ``easeoff``.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable
from functools import partial
from typing import TYPE_CHECKING

import click

from .command import Command

# Everything heavy is imported where it is needed: ``easeoff --help`` stays quick.
if TYPE_CHECKING:
    from click.shell_completion import CompletionItem

    Complete = Callable[[click.Context, click.Parameter, str], list[CompletionItem]]


def completion_by(names: Callable[[], Iterable[str]], *, listed: bool = False) -> Complete:
    """Completion by names that begin as the word does, else by files; of a list with commas, of its last name alone."""

    def complete(_ctx: click.Context, _param: click.Parameter, incomplete: str) -> list[CompletionItem]:
        from click.shell_completion import CompletionItem

        before, comma, last = incomplete.rpartition(",") if listed else ("", "", incomplete)
        matches = [CompletionItem(before + comma + name) for name in names() if name.startswith(last)]
        return matches or ([] if listed else [CompletionItem(incomplete, type="file")])

    return complete


def _shipped(kind: str) -> list[str]:
    """Names of what is shipped of a kind."""
    from ...cases.shipped_files import CASES, DESIGNS, SUPPORTS, names

    return names({"case": CASES, "design": DESIGNS, "supports": SUPPORTS}[kind])


def _oils() -> list[str]:
    from ...friction.lubricants.lubricant import available_lubricants

    return available_lubricants()


def _solvers() -> list[str]:
    from ...contact.solvers import available_solvers

    return ["auto", *available_solvers()]


def _models() -> list[str]:
    from ...friction.coefficient import COEFFICIENTS

    return list(COEFFICIENTS)


def _deviations() -> list[str]:
    from ...cases.shipped_files import shipped_deviations

    return [f"{member}={name}" for member in ("pinion", "gear") for name in shipped_deviations() if member in name]


def template_names(ctx: click.Context, _param: click.Parameter, incomplete: str) -> list[CompletionItem]:
    """Completion of what the numbers of a template are taken from."""
    from click.shell_completion import CompletionItem

    from ...cases.schema.file_templates import TEMPLATE_KINDS

    kind = TEMPLATE_KINDS.get(str(ctx.params.get("kind")))
    return [CompletionItem(name) for name in (kind.names() if kind else []) if name.startswith(incomplete)]


case_names = completion_by(partial(_shipped, "case"))
design_names = completion_by(partial(_shipped, "design"))
support_names = completion_by(partial(_shipped, "supports"))
oil_names = completion_by(_oils)
deviation_names = completion_by(_deviations)
solver_names = completion_by(_solvers)
friction_models = completion_by(_models, listed=True)
solver_list = completion_by(_solvers, listed=True)
SHELLS = {"bash": "~/.bashrc", "zsh": "~/.zshrc", "fish": "~/.config/fish/completions/easeoff.fish"}
#: By which the shell asks the program for completions; click derives it from the name of the program.
VARIABLE = "_EASEOFF_COMPLETE"


@click.command(cls=Command)
@click.argument("shell", type=click.Choice(list(SHELLS)))
def completion(shell: str) -> None:
    """Print the completion script of a SHELL.

    With it the tab key completes commands, options, the names of shipped cases, designs, supports, oils and solvers,
    and files:

    \b
        bash    easeoff completion bash >> ~/.bashrc
        zsh     easeoff completion zsh >> ~/.zshrc
        fish    easeoff completion fish > ~/.config/fish/completions/easeoff.fish

    A new shell has it. In bash it needs version 4.4 or later.
    """  # noqa: D301 (click keeps the lines of a paragraph that begins with a backspace)
    from click.shell_completion import get_completion_class

    shell_class = get_completion_class(shell)
    assert shell_class is not None  # of the three shells that click knows
    root = click.get_current_context().find_root().command
    click.echo(shell_class(root, {}, "easeoff", VARIABLE).source().strip())
