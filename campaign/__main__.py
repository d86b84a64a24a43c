"""`python -m campaign`: kills processes of running machines at random moments, and checks what became of them."""

from __future__ import annotations

import json
import os
import platform
import sys
import tempfile
import time
from pathlib import Path
from typing import Any

import click
from rich.console import Console

from campaign import kills, load
from campaign.table import summary, table


@click.command(context_settings={"help_option_names": ["-h", "--help"]})
@click.option("--seed", type=int, default=1, help="Which faults come, and when.")
@click.option("--count", type=click.IntRange(1), default=1_000_000, help="Faults at most.")
@click.option("--first", type=click.IntRange(0), default=0, help="Number of the first fault of the seed.")
@click.option("--minutes", type=click.FloatRange(0.0), default=5.0, help="Time after which no more runs are started.")
@click.option("--hours", type=click.FloatRange(0.0), help="The same in hours.")
@click.option("--json", "json_file", type=click.Path(dir_okay=False), help="File for the rows, one a line.")
@click.option("--keep", type=click.Path(file_okay=False), help="Folder for the recordings of runs with problems.")
@click.option("--load", "with_load", is_flag=True, help="Load, time and company instead of kills.")
@click.option("--set-clock", is_flag=True, help="With --load: sets the wall clock of this computer; needs root.")
@click.option("--soak", type=click.FloatRange(0.0), default=0.0, help="Minutes of a soak behind them.")
def main(
    seed: int,
    count: int,
    first: int,
    minutes: float,
    hours: float | None,
    json_file: str | None,
    keep: str | None,
    with_load: bool,
    set_clock: bool,
    soak: float,
) -> None:
    """Kill processes of running machines and check that nothing is lost: exit status 1 if anything was."""
    console = Console(highlight=False, width=None if sys.stdout.isatty() else 160)
    folder = Path(keep or tempfile.mkdtemp(prefix="campaign_"))
    if with_load:
        sys.exit(measure_load(console, folder, soak, json_file, sets_clock=set_clock))
    rows: list[kills.Row] = []
    for row in kills.campaign(seed, count, hours * 60.0 if hours else minutes, folder, first=first):
        rows.append(row)
        fault = row.fault
        held = f" {fault.hold:g} s" if fault.hold else ""
        what = f"{fault.case}: {fault.signal}{held} to {fault.node} after {fault.moment:g} s"
        console.print(f"{first + len(rows) - 1:4} {what}: {row.outcome}{''.join(f'; {each}' for each in row.problems)}")
        add_line(json_file, {"seed": seed, "number": first + len(rows) - 1} | row.as_json())
    console.print(table(rows))
    console.print(summary(rows))
    date = time.strftime("%Y-%m-%d", time.gmtime())
    machine = f"{os.cpu_count()} processors, load {os.getloadavg()[0]:.1f}, Python {platform.python_version()}"
    console.print(f"{date}, seed {seed}, {machine}; recordings of runs with problems: {folder}")
    sys.exit(any(not row.good for row in rows))


def measure_load(console: Console, folder: Path, soak: float, json_file: str | None, *, sets_clock: bool) -> bool:
    """True if anything was lost."""
    bad = False
    for row in load.conditions(folder, minutes=soak, sets_clock=sets_clock):
        figures = ", ".join(f"{name} {value:g}" for name, value in row.figures.items())
        console.print(f"{row.name}: {figures}{''.join(f'; {each}' for each in row.problems)}")
        add_line(json_file, row.as_json())
        bad = bad or bool(row.problems)
    return bad


def add_line(json_file: str | None, row: dict[str, Any]) -> None:
    if json_file is not None:
        with Path(json_file).open("a", encoding="utf-8") as stream:
            stream.write(json.dumps(row) + "\n")


if __name__ == "__main__":
    main()
