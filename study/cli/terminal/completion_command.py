"""Command that prints the script by which a shell completes the words of ``easeoff``."""

from __future__ import annotations

import click

from ..command import Command

SHELLS = {
    "bash": "~/.bashrc",
    "zsh": "~/.zshrc",
    "fish": "~/.config/fish/completions/easeoff.fish",
}
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

    found = get_completion_class(shell)
    assert found is not None  # of the three shells that click knows
    root = click.get_current_context().find_root().command
    click.echo(found(root, {}, "easeoff", VARIABLE).source().strip())
