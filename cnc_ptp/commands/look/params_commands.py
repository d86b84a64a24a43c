"""The commands of `cnc_ptp params`; without one of them it searches."""

from __future__ import annotations

import sys
from typing import Any

import click

from cnc_ptp.commands.arguments import MACHINE
from cnc_ptp.commands.group import WordsOrCommand


@click.group("params", cls=WordsOrCommand)
def params_commands() -> None:
    """Show the parameter reference; compare and check machine files.

    `cnc_ptp params WORD...` shows what matches the words (id, number, parts of names, text), without words all groups.
    """


@params_commands.command("search")
@click.argument("words", nargs=-1, metavar="[WORD]...")
@click.option("--list", "list_name", help="Only this list: axis, channel, P-COMP ...")
@click.option("--topic", help="Only parameters of a topic, or of topics that have this word.")
@click.option("--changed", type=click.Path(dir_okay=False), help="Only what this machine file sets otherwise.")
def search_command(words: tuple[str, ...], **options: Any) -> None:
    """What matches the WORDs (id, number, parts of names, text), or all groups."""
    from cnc_ptp.commands.look.params import params

    sys.exit(params(" ".join(words), **options))


@params_commands.command("diff")
@click.argument("first", type=click.Path(dir_okay=False))
@click.argument("second", type=click.Path(dir_okay=False))
def diff_command(first: str, second: str) -> None:
    """In which parameters two machine files differ, defaults included. Status 1 if they do."""
    from cnc_ptp.commands.look.machine_params import diff

    sys.exit(diff(first, second))


@params_commands.command("check")
@MACHINE
def check_command(machine: str) -> None:
    """Everything that is wrong or doubtful in a machine file, at once. Status 2 if it would not start."""
    from cnc_ptp.commands.look.machine_params import check

    sys.exit(check(machine))
