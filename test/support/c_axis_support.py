"""A lathe whose main spindle is a C axis, and what the tests of it ask its runs."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

from machine_support import ROOT, MachineBench

from cnc_ptp.parameters import MachineParameters, read_machine
from cnc_ptp.protocol.spindle_states import SpindleBit

LATHE = read_machine(ROOT / "examples" / "lathe_c.yaml")


def lathe(**channel: Any) -> MachineParameters:
    """The lathe with other parameters of its channel."""
    return replace(LATHE, channels={"channel": replace(LATHE.channels["channel"], **channel)})


def run(program: str, scenario: str = "", machine: MachineParameters = LATHE) -> MachineBench:
    return MachineBench(program, scenario, machine=machine).run()


def errors(bench: MachineBench, unit: str = "channel") -> list[str]:
    return [event.text for event in bench.events_of(unit) if event.severity == 2]


def on_path(bench: MachineBench) -> list[int]:
    """Cycles in which the path moves the spindle."""
    return [cycle for cycle, bit in enumerate(bench.column("s", "status_bits")) if bit & SpindleBit.ON_PATH]
