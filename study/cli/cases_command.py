"""The command that lists the shipped cases."""

from __future__ import annotations

import click


@click.command()
def cases() -> None:
    """List the shipped cases."""
    from ...cases import shipped_cases

    shipped = shipped_cases()
    width = max(len(name) for name in shipped)
    for name, title in shipped.items():
        click.echo(f"{name:<{width}}  {title}")
