"""Function blocks without a machine: a unit that answers as a test has planned, and machines with a PLC of a test."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

from machine_support import PTP, MachineBench

from cnc_ptp.machine.offline import OfflineMachine
from cnc_ptp.machine.wiring import build_units, unit_kinds
from cnc_ptp.parameters import MachineParameters
from cnc_ptp.plc.program.plc_program import PlcFile
from cnc_ptp.plc.scenario import parse_scenario
from cnc_ptp.protocol.axis_states import AxisStateCode as S
from cnc_ptp.protocol.blocks import AxisBlock, CommandAnswer, CycleBlock, SpindleBlock
from cnc_ptp.protocol.commands import COMMANDS
from cnc_ptp.protocol.jobs import JobStatus

WAITS, ACTIVE, DONE, ABORTED, FAILED, REFUSED, ACCEPTED = (
    "waits", "active", "done", "aborted", "failed", "refused", "accepted",
)  # fmt: skip
"""What a unit tells of a command."""
STATUS = {
    ACTIVE: JobStatus.ACTIVE,
    DONE: JobStatus.DONE,
    ABORTED: JobStatus.ABORTED,
    FAILED: JobStatus.FAILED,
}


@dataclass
class Given:
    """A command that a function block has given: `tells` is what the unit tells of it now, None = nothing yet."""

    command: str
    arguments: dict[str, Any]
    tells: str | None = None


class FakeUnit:
    """A UnitReference whose answers a test decides."""

    def __init__(self, kind: str = "axis", name: str = "x") -> None:
        self.kind, self.name = kind, name
        self.stops = 0
        self.given: list[Given] = []
        self.holds: list[bool] = []
        """What it was told by hold_stop, which is answered to nobody."""
        self.block: CycleBlock | None = None
        self.parameters: dict[str, float] = {}

    def give(self, command: str, **arguments: Any) -> int:
        specification = COMMANDS[self.kind].get(command)
        assert specification is not None and arguments.keys() <= specification.keys(), (command, arguments)
        if command == "hold_stop":
            self.holds.append(arguments["enabled"])
            return 0
        self.given.append(Given(command, arguments))
        return len(self.given)

    def answer(self, ticket: int) -> CommandAnswer | None:
        tells = self.given[ticket - 1].tells
        if tells is None:
            return None
        if tells == REFUSED:
            return CommandAnswer(ticket, 23005, 0, f"command {ticket} refused")
        return CommandAnswer(ticket, 0, 0 if tells == ACCEPTED else ticket)

    def job_status(self, job: int) -> JobStatus | None:
        return STATUS.get(self.given[job - 1].tells or "")

    def job_error(self, job: int) -> int:
        return 23010

    def parameter(self, name: str) -> float:
        return self.parameters[name]

    @property
    def last(self) -> Given:
        return self.given[-1]


def axis_block(state: int = S.STANDSTILL, **fields: Any) -> AxisBlock:
    """A block of one cycle."""
    columns = {"set_velocity": [0.0], "override_percent": [100.0], "status_bits": [0], "error_id": [0]}
    return AxisBlock(fields.pop("first_cycle", 0), 1, state=[state], **{**columns, **fields})


def spindle_block(state: int = S.STANDSTILL, **fields: Any) -> SpindleBlock:
    columns = {"speed_reached": [False], "set_acceleration_deg_s2": [0.0], "error_id": [0]}
    return SpindleBlock(0, 1, state=[state], **{**columns, **fields})


def outputs(block: Any) -> str:
    """The outputs that are true, by name."""
    names = ("busy", "active", "done", "command_aborted", "error")
    return " ".join(name for name in names if getattr(block, name))


class PlcBench(MachineBench):
    """A machine offline whose PLC is an object of a test: `make(io)` gives one with `cycle(io)`."""

    def __init__(
        self, make: Callable[[Any], Any], scenario: str = "", *, machine: MachineParameters = PTP, **options: Any
    ) -> None:
        super().__init__(machine=machine, **options)
        entries = parse_scenario(scenario, "test.yaml", unit_kinds(machine))
        file = PlcFile("/test/plc.py", make)
        self.units = build_units(machine, scenario=entries, end_when_idle=True, plc_file=file)
        self.offline = OfflineMachine(machine, self.units)
        self.plc: Any = self.units["plc"].program.plc  # type: ignore[attr-defined]
