"""Options of the commands that show recordings and programs, and which of them go together."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import click

from cnc_ptp.commands.arguments import DIALECT, option_group, split, words
from cnc_ptp.number_range import POSITIVE

MCAP_MAGIC = b"\x89MCAP"

part_options = option_group(
    click.option("--from", "begin", type=float, help="Seconds of the recording; without it from its start."),
    click.option("--to", "end", type=float, help="Seconds of the recording; without it to its end."),
    click.option("--axes", callback=words, multiple=True, help="Axes and spindles, the others are left out: x,s"),
)
"""Options for the part of a recording to draw."""

program_options = option_group(
    click.option("--machine", type=click.Path(dir_okay=False), help="FILE is an NC program: run it on this machine."),
    click.option("--colour", type=click.Choice(("feed", "acceleration", "block")), help="Of the path; or feed."),
    DIALECT,
    click.option("--override", type=POSITIVE, help="Override of the path in %; default: 100."),
)
"""Options of a plot that are for an NC program alone."""


def take_plot(options: dict[str, Any], more_topics: tuple[str, ...]) -> tuple[dict[str, Any], dict[str, Any]]:
    """Takes the options of a plot apart: those of an NC program, those of a recording."""
    of_program = {name: options.pop(name) for name in ("machine", "colour", "dialect", "override")}
    topics = (*options.pop("topics"), *(word for text in more_topics for word in split(text)))
    return of_program, {"topics": topics} | {name: options.pop(name) for name in ("begin", "end", "axes")}


def is_text(file: str) -> bool:
    """Whether a file exists and begins as no recording does; not that of a folder of rosbag2."""
    from cnc_ptp.recording.bag import FILE  # YAML and MCAP only where they are needed

    try:
        with Path(file).open("rb") as stream:
            first = stream.read(1)
    except OSError:
        return False
    return first != MCAP_MAGIC[:1] and not file.endswith((".mcap", FILE))


def require_none(options: dict[str, Any], why: str) -> None:
    """Raises UsageError for an option that was given."""
    names = {"begin": "--from", "end": "--to", "topics": "TOPIC"}
    for name, value in options.items():
        if value not in (None, ()):
            raise click.UsageError(f"{names.get(name, f'--{name}')} {why}; nothing was drawn")
