"""Options of commands and nodes that start a program at a line or block."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from typing import Any

import click

from cnc_ptp.nc.block_search import StartPoint

NUMBER = click.IntRange(min=1)
NAMES = ("start_line", "start_block", "start_in", "start_pass")


def start_options(function: Callable[..., Any]) -> Callable[..., Any]:
    """--start-line, --start-block, --start-in, --start-pass: `take_start` makes a start point of them."""
    for option in (
        click.option("--start-pass", type=NUMBER, help="Of several passes of the line the one to begin with."),
        click.option("--start-in", help="Program of the line or block: one that the program calls."),
        click.option("--start-block", type=NUMBER, help="Begin at the block with this N number."),
        click.option("--start-line", type=NUMBER, help="Begin at this line: all before it is interpreted only."),
    ):
        function = option(function)
    return function


def take_start(options: dict[str, Any], program: str | None) -> StartPoint | None:
    """The start point that options name for `program`; they are taken out. Raises UsageError."""
    line, block, file, number = (options.pop(name, None) for name in NAMES)
    if line is None and block is None:
        if file or number:
            raise click.UsageError("--start-in and --start-pass need --start-line or --start-block")
        return None
    if line is not None and block is not None:
        raise click.UsageError("--start-line and --start-block exclude each other")
    if program is None:
        raise click.UsageError("--start-line and --start-block need --program")
    return StartPoint(line or 0, block or 0, file or "", number or 1)


def start_words(point: StartPoint | None) -> Iterator[str]:
    """The options of a start point, for the command line of a node."""
    if point is None:
        return
    yield from ("--start-line", str(point.line)) if point.line else ("--start-block", str(point.block_number))
    if point.file:
        yield from ("--start-in", point.file)
    yield from ("--start-pass", str(point.pass_number))
