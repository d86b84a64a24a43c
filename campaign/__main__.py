"""`python -m campaign`: kills, load, random commands and mutated inputs, and what became of the machine.

The parts share the time: half of it for kills, a quarter each for commands and inputs; load takes about three minutes.
"""

from __future__ import annotations

import json
import os
import platform
import sys
import tempfile
import time
from collections import Counter
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import click
from rich.console import Console

from bench.fuzz import HEAD, row
from bench.fuzzing import engine
from bench.fuzzing.kinds import KINDS
from bench.random_commands import lives
from campaign import kills
from campaign.conditions import conditions
from campaign.table import summary, table

PARTS = ("kills", "load", "commands", "inputs")
SHARES = {"kills": 0.5, "commands": 0.25, "inputs": 0.25}
"""Of the time; load takes what it takes."""


@click.command(context_settings={"help_option_names": ["-h", "--help"]})
@click.argument("parts", nargs=-1, type=click.Choice(PARTS), metavar="[kills|load|commands|inputs]...")
@click.option("--seed", type=int, default=1, help="Which faults, commands and inputs come, and when.")
@click.option("--count", type=click.IntRange(1), default=1_000_000, help="Faults at most.")
@click.option("--first", type=click.IntRange(0), default=0, help="Number of the first fault of the seed.")
@click.option("--minutes", type=click.FloatRange(0.0), default=6.0, help="For all parts but load.")
@click.option("--hours", type=click.FloatRange(0.0), help="The same in hours.")
@click.option("--json", "json_file", type=click.Path(dir_okay=False), help="File for the rows, one a line.")
@click.option("--keep", type=click.Path(file_okay=False), help="Folder for the recordings of runs with problems.")
@click.option("--set-clock", is_flag=True, help="load: sets the wall clock of this computer, too; needs root.")
@click.option("--soak", type=click.FloatRange(0.0), default=0.0, help="load: minutes of a soak at its end.")
def main(parts: Sequence[str], hours: float | None, minutes: float, keep: str | None, **options: Any) -> None:
    """Put machines under the faults of PARTS, all without one: exit status 1 if anything was lost."""
    folder = Path(keep or tempfile.mkdtemp(prefix="campaign_"))
    chosen = parts or PARTS
    timed = sum(SHARES.get(part, 0.0) for part in chosen) or 1.0
    seconds = 60.0 * (hours * 60.0 if hours else minutes)
    campaign = Campaign(folder, options)
    good = [getattr(campaign, part)(seconds * SHARES.get(part, 0.0) / timed) for part in chosen]
    now = where_and_when()
    told = f"{now['date']}, seed {options['seed']}, {now['machine']}"
    campaign.say(f"{told}; recordings of runs with problems: {folder}")
    sys.exit(not all(good))


def where_and_when() -> dict[str, str]:
    """Of a row."""
    machine = f"{os.cpu_count()} processors, load {os.getloadavg()[0]:.1f}, Python {platform.python_version()}"
    return {"date": time.strftime("%Y-%m-%d", time.gmtime()), "machine": machine}


class Campaign:
    """Its parts; each gives True if nothing was lost."""

    def __init__(self, folder: Path, options: dict[str, Any]) -> None:
        """`options` as of the command."""
        self._folder, self._options = folder, options
        self._seed: int = options["seed"]
        self._console = Console(highlight=False, width=None if sys.stdout.isatty() else 160)

    def say(self, text: Any) -> None:
        self._console.print(text, markup=False) if isinstance(text, str) else self._console.print(text)

    def kills(self, seconds: float) -> bool:
        """Processes of running machines."""
        first, rows = self._options["first"], []
        for fault_row in kills.campaign(self._seed, self._options["count"], seconds / 60.0, self._folder, first=first):
            number = first + len(rows)
            rows.append(fault_row)
            fault = fault_row.fault
            held = f" {fault.hold:g} s" if fault.hold else ""
            what = f"{fault.case}: {fault.signal}{held} to {fault.node} after {fault.moment:g} s"
            self.say(f"{number:4} {what}: {fault_row.outcome}{''.join(f'; {each}' for each in fault_row.problems)}")
            self._add({"seed": self._seed, "number": number} | fault_row.as_json())
        self.say(table(rows))
        self.say(summary(rows))
        return all(each.good for each in rows)

    def load(self, _seconds: float) -> bool:
        """Load, time and company."""
        good = True
        soak, sets_clock = self._options["soak"], self._options["set_clock"]
        for condition in conditions(self._folder, minutes=soak, sets_clock=sets_clock):
            told = [", ".join(f"{name} {value:g}" for name, value in condition.figures.items()), *condition.problems]
            told += [f"not tried, {condition.untried}"] if condition.untried else []
            self.say(f"{condition.name}: {'; '.join(filter(None, told))}")
            self._add(condition.as_json())
            good = good and condition.good is not False
        return good

    def commands(self, seconds: float) -> bool:
        """Random commands to machines offline."""
        end, total, bad = time.monotonic() + seconds, Counter[str](), 0
        for machine in lives(sys.maxsize, self._seed):
            total += machine.counts
            bad += bool(machine.violations)
            for text in machine.violations[:5]:
                self.say(text)
            if time.monotonic() > end:
                break
        self.say(f"random commands: {', '.join(f'{n} {name}' for name, n in total.items())}; {bad} with a violation")
        self._add({"name": "random commands", "good": not bad, "seed": self._seed, **total})
        return not bad

    def inputs(self, seconds: float) -> bool:
        """Mutated inputs of all kinds."""
        self.say(HEAD)
        good = True
        for name, kind in KINDS.items():
            with tempfile.TemporaryDirectory(prefix="fuzz_") as folder:
                verdict = engine.run(kind, self._seed, sys.maxsize, Path(folder), seconds=seconds / len(KINDS))
            self.say(row(verdict))
            for finding in verdict.findings:
                self.say(str(finding))
            good = good and not verdict.findings
            counts = {"count": verdict.count, "refused": verdict.refused, "undocumented": verdict.undocumented}
            self._add({"name": f"inputs: {name}", "good": not verdict.findings, "seed": self._seed, **counts})
        return good

    def _add(self, line: dict[str, Any]) -> None:
        """To the file of the rows, with date and machine."""
        if self._options["json_file"] is not None:
            with Path(self._options["json_file"]).open("a", encoding="utf-8") as stream:
                stream.write(json.dumps(line | where_and_when()) + "\n")


if __name__ == "__main__":
    main()
