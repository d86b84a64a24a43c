"""Runs of the examples in examples/spindles: machine file, program and scenario as the commands of the docs take them."""

from __future__ import annotations

from functools import cache
from pathlib import Path
from typing import Any

from channel_spindle_support import moves
from machine_support import MachineBench

from cnc_ptp.machine.offline import OfflineMachine
from cnc_ptp.machine.run_entries import read_entries
from cnc_ptp.machine.wiring import build_units
from cnc_ptp.parameters import read_machine

EXAMPLES = Path(__file__).parents[2] / "examples" / "spindles"
CYCLE_TIME = 0.001


class ExampleRun(MachineBench):
    """A run to its end; columns, records, events and blocks as on the bench."""

    def __init__(self, machine: str, program: str = "", scenario: str = "", dialect: str | None = None) -> None:
        self.machine = read_machine(EXAMPLES / machine)
        files = (str(EXAMPLES / name) if name else None for name in (program, scenario))
        job = read_entries(self.machine, **dict(zip(("program", "scenario"), files, strict=True)), dialect=dialect)
        self.units = build_units(self.machine, scenario=job)
        self.offline = OfflineMachine(self.machine, self.units)
        self.blocks: dict[str, list[Any]] = {name: [] for name in self.units}
        self.events, self.all_events, self.records = [], [], []
        self.run()

    def path_begin(self, number: int, unit: str = "channel") -> int:
        """First cycle of the n-th stretch (from 0) in which the path moves."""
        return moves(self, unit)[number][0]


@cache
def example(machine: str, program: str = "", scenario: str = "") -> ExampleRun:
    """The run of an example, made once."""
    return ExampleRun(machine, program, scenario)


def first(values: list[Any], wanted: Any, begin: int = 0) -> int:
    """The first index from `begin` on with this value."""
    return values.index(wanted, begin)
