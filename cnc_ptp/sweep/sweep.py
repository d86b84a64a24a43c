"""A whole sweep: plan, what is finished already, workers, table."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from contextlib import ExitStack
from dataclasses import dataclass, field
from hashlib import blake2b
from pathlib import Path
from typing import Any

from cnc_ptp.errors import CncError
from cnc_ptp.plc.scenario import Entry
from cnc_ptp.protocol.blocks import Command, json_of
from cnc_ptp.sweep.faults import NOTHING, OTHER_SWEEP, sweep_package
from cnc_ptp.sweep.goals import Goal
from cnc_ptp.sweep.journal import ENDING, Description, Journal
from cnc_ptp.sweep.plans import Plan
from cnc_ptp.sweep.pool import Pool
from cnc_ptp.sweep.results import Results, Row, Variant, by_number
from cnc_ptp.sweep.table import read_table, write_table
from cnc_ptp.sweep.variant_run import Job, kernel_id
from cnc_ptp.sweep.variation import Variation, keys_of


@dataclass
class Sweep:
    """What is to be computed, and how far it is.

    `rows` by number: those of earlier runs of the same command, too; `taken_over`: how many of them these are.
    """

    job: Job
    variations: Sequence[Variation]
    goals: Sequence[Goal]
    plan: Plan
    target: Path
    rows: dict[int, Row] = field(default_factory=dict)
    taken_over: int = 0

    @property
    def journal(self) -> Path:
        return self.target.with_name(self.target.name + ENDING)

    @property
    def results(self) -> Results:
        names = [variation.name for variation in self.variations]
        return Results(names, self.goals, by_number(self.rows.values()))

    def description(self) -> Description:
        """What decides all results."""
        commands = self.job.commands
        return {
            "machine file": digest(self.job.machine_text),
            "program or scenario file": digest("".join(command_text(*command) for command in commands)),
            "--vary": [f"{variation.name}={variation.text}" for variation in self.variations],
            "--goal": [goal.text for goal in self.goals],
            "plan": self.plan.description,
            "--duration": self.job.seconds,
            "cnc_ptp": self.job.kernel,
        }

    def run(self, make_pool: Callable[[], Pool], ended: Callable[[], bool], show: Callable[[int], None]) -> bool:
        """Computes what is missing and writes the table; False if `ended` has ended it before.

        `make_pool` is called when there is something to compute; `show` gets the number of finished variants.
        Raises CncError 26013, 26181, 26182, 26183, 26186, 27030.
        """
        sweep_package("pyarrow")  # the table needs it, at the end
        description = self.description()
        if self.target.exists():
            self.rows = read_table(self.target, description, len(self.goals))
            self.taken_over = len(self.rows)
            return True
        with Journal(self.journal, description) as journal:
            self.rows = dict(journal.rows)
            self.taken_over = len(self.rows)
            show(len(self.rows))
            if not self._compute(journal, make_pool, ended, show):
                return False
            write_table(self.target, self.results, description)
            journal.remove()
        return True

    def _compute(
        self, journal: Journal, make_pool: Callable[[], Pool], ended: Callable[[], bool], show: Callable[[int], None]
    ) -> bool:
        pool: Pool | None = None
        with ExitStack() as closing:
            for batch in self.plan.batches():
                missing = [variant for variant in batch if not self._known(variant)]
                if missing and pool is None:
                    try:
                        pool = closing.enter_context(make_pool())
                    except CncError:
                        if ended():
                            return False
                        raise
                if missing and pool is not None:
                    for row in pool.compute(self.job, missing, ended):
                        journal.add(row)
                        self.rows[row.number] = row
                        show(len(self.rows))
                if any(variant.number not in self.rows for variant in batch):
                    return False
                self.plan.tell([self.rows[variant.number] for variant in batch])
        return True

    def _known(self, variant: Variant) -> bool:
        """Finished before. Raises CncError 26182 where it had other values then."""
        row = self.rows.get(variant.number)
        if row is not None and row.values != variant.values:
            reason = f"{self.journal} has other values of variant {variant.number}: {row.values}, not {variant.values}"
            raise CncError(OTHER_SWEEP, reason, f"{NOTHING}, give another name")
        return row is not None


def make_job(
    machine_text: str,
    machine_file: str,
    entries: Sequence[Entry],
    variations: Sequence[Variation],
    goals: Sequence[Goal],
    seconds: float | None,
) -> Job:
    """What the workers get."""
    texts = tuple(goal.text for goal in goals)
    commands = tuple((entry.at, entry.command) for entry in entries)
    return Job(machine_text, machine_file, commands, keys_of(variations), texts, seconds, kernel_id())


def digest(text: str) -> str:
    return blake2b(text.encode(errors="surrogatepass"), digest_size=16).hexdigest()


def command_text(at: float, command: Command) -> str:
    """All of a timed command but the name of its program's file, which changes nothing."""
    arguments: dict[str, Any] = {name: value for name, value in command.arguments.items() if name != "program"}
    return f"{at!r} {command.target} {command.command} {json_of(arguments)}\n"
