"""Arguments and options that several commands have, and how they are grouped."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import click

MACHINE = click.argument("machine", type=click.Path(dir_okay=False))
RECORDING = click.argument("recording", type=click.Path())
SCENARIO = click.option("--scenario", type=click.Path(dir_okay=False), help="Timed PLC commands (YAML).")
PROGRAM = click.option("--program", type=click.Path(dir_okay=False), help="NC program for the first channel.")
DIALECT = click.option(
    "--dialect",
    type=click.Choice(("twincat", "iso")),
    help="Vocabulary of the program; default: that of the machine file (P-CHAN-90010).",
)
DIALECT_OF_A_FILE = click.option(
    "--dialect", type=click.Choice(("twincat", "iso")), default="twincat", show_default=True, help="Vocabulary."
)
LIST_KINDS = ("axis", "channel", "tool", "zero", "clamp", "compensation", "startup")


def option_group(*options: Callable[..., Any]) -> Callable[[Callable[..., Any]], Callable[..., Any]]:
    """Several arguments and options as one decorator, in the order in which the help shows them."""

    def decorate(function: Callable[..., Any]) -> Callable[..., Any]:
        for option in reversed(options):
            function = option(function)
        return function

    return decorate


def split(text: str) -> list[str]:
    """Words with commas or blanks between."""
    return text.replace(",", " ").split()


def words(_context: click.Context, _option: click.Parameter, values: tuple[str, ...]) -> tuple[str, ...]:
    """The words of an option that may be given again and again."""
    return tuple(word for value in values for word in split(value))


def parse_kinds(
    _context: click.Context, _option: click.Parameter, values: tuple[str, ...]
) -> tuple[tuple[str, str], ...]:
    """FILE=KIND, each."""
    pairs = [(file, kind) for value in values for file, _, kind in [value.rpartition("=")]]
    for file, kind in pairs:
        if not file or kind not in LIST_KINDS:
            raise click.BadParameter(f"FILE=KIND is needed, KIND one of {', '.join(LIST_KINDS)}")
    return tuple(pairs)
