"""The units as a PLC in a file sees them: their state of the block before, commands and what becomes of them."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, TypeVar

from cnc_ptp.parameters import ParameterSet
from cnc_ptp.parameters.declare.declarations import ParameterValue
from cnc_ptp.parameters.view.by_name import parameter_by_name
from cnc_ptp.plain_values import plain
from cnc_ptp.protocol.axis_states import AxisStateCode, StatusBit
from cnc_ptp.protocol.blocks import (
    AxisBlock,
    ChannelBlock,
    Command,
    CommandAnswer,
    CycleBlock,
    JobEvent,
    PlcBlock,
    SpindleBlock,
)
from cnc_ptp.protocol.channel_states import ChannelStateCode
from cnc_ptp.protocol.commands import INTERNAL, UNKNOWN_COMMAND
from cnc_ptp.protocol.jobs import JobStatus
from cnc_ptp.protocol.unit import UPSTREAM_LOST

KEPT = 1000
"""Answers and jobs of a unit that are remembered, the newest ones."""
WRITE_PARAMETER = "write_parameter"
T = TypeVar("T")

Send = Callable[[Command], None]


class Reference:
    """One unit: `give` commands, read `block`; function blocks take it as their unit (plc/plcopen UnitReference)."""

    def __init__(self, name: str, kind: str, parameters: ParameterSet, send: Send) -> None:
        """`send` takes commands for the next block."""
        self.name = name
        self.kind = kind
        self.stops = 0
        """Number of MC_Stop that hold it."""
        self.block: CycleBlock | None = None
        """Its block previous to the one for which the PLC is called; None in the first one."""
        self.lost = False
        self._parameters = parameters
        self._written: dict[str, ParameterValue] = {}
        self._send = send
        self._tickets = 0
        self._waiting: list[tuple[int, Command]] = []
        self._answers: dict[int, CommandAnswer] = {}
        self._jobs: dict[int, JobEvent] = {}

    # for the PLC

    def give(self, command: str, **arguments: Any) -> int:
        """Gives a command, which acts in this block; the ticket for its answer."""
        self._tickets += 1
        if command in INTERNAL:
            text = f"{self.kind} {self.name}: '{command}' is given by watchdogs and units only; nothing was changed"
            self._note(self._answers, self._tickets, CommandAnswer(0, UNKNOWN_COMMAND, 0, text))
            return self._tickets
        given = Command(self.name, command, {name: plain(value) for name, value in arguments.items()})
        self._waiting.append((self._tickets, given))
        self._send(given)
        return self._tickets

    def answer(self, ticket: int) -> CommandAnswer | None:
        """What became of a command: known one block later; None before."""
        return self._answers.get(ticket)

    def job_status(self, job: int) -> JobStatus | None:
        """What became of a job; None while it waits for its turn."""
        if self.lost:
            return JobStatus.FAILED
        event = self._jobs.get(job)
        return None if event is None else JobStatus(event.status)

    def job_error(self, job: int) -> int:
        """Error number of a job that has failed."""
        event = self._jobs.get(job)
        return UPSTREAM_LOST if self.lost else 0 if event is None else event.error_id

    def parameter(self, name: str) -> ParameterValue:
        """Value in the unit of its list, by P number or name. Raises CncError 22169."""
        found = parameter_by_name(self._parameters, name)
        return self._written.get(found.ros_name, found.value)

    @property
    def error_id(self) -> int:
        """Its error at the end of the block, 0 if none."""
        return 0 if self.block is None or isinstance(self.block, PlcBlock) else self.block.error_id[-1]

    # for the PLC unit

    def note_write(self, command: Command) -> None:
        """A parameter is written by somebody else than the PLC in the file."""
        if all(command is not waiting for _, waiting in self._waiting):
            self._waiting.append((0, command))

    def take(self, block: CycleBlock | None, lost: bool) -> None:
        """The newest block, with answers and jobs; `lost`: no other will come."""
        self.block, self.lost = block, lost
        if lost:
            text = f"{self.kind} {self.name} is lost"
            for ticket, _ in self._waiting:
                self._note(self._answers, ticket, CommandAnswer(0, UPSTREAM_LOST, 0, text))
            self._waiting = []
        if block is None or isinstance(block, PlcBlock):
            return
        for event in block.job_events:
            self._note(self._jobs, event.job, event)
        for answer in block.answers:
            self._take_answer(answer)

    def _take_answer(self, answer: CommandAnswer) -> None:
        for place, (ticket, command) in enumerate(self._waiting):
            if command.id == answer.id:
                self._note(self._answers, ticket, answer)
                if command.command == WRITE_PARAMETER and not answer.error_id:
                    name = parameter_by_name(self._parameters, command.arguments["parameter"]).ros_name
                    self._written[name] = command.arguments["value"]
                del self._waiting[place]
                return

    @staticmethod
    def _note(notes: dict[int, T], number: int, value: T) -> None:
        notes[number] = value
        if len(notes) > KEPT:
            del notes[next(iter(notes))]


class AxisReference(Reference):
    """An axis. Values in mm (°) and seconds; all 0 and Disabled before its first block."""

    def _column(self, name: str) -> Any:
        return getattr(self.block, name)[-1] if isinstance(self.block, AxisBlock) else 0

    @property
    def state(self) -> AxisStateCode:
        return AxisStateCode(self._column("state"))

    @property
    def set_position(self) -> float:
        return float(self._column("set_position"))

    @property
    def set_velocity(self) -> float:
        return float(self._column("set_velocity"))

    @property
    def actual_position(self) -> float:
        return float(self._column("actual_position"))

    @property
    def actual_velocity(self) -> float:
        return float(self._column("actual_velocity"))

    @property
    def following_error(self) -> float:
        return float(self._column("following_error"))

    @property
    def override_percent(self) -> float:
        return float(self._column("override_percent"))

    @property
    def status_bits(self) -> int:
        """See StatusBit."""
        return int(self._column("status_bits"))

    @property
    def standstill(self) -> bool:
        return self.state == AxisStateCode.STANDSTILL

    @property
    def in_target_position(self) -> bool:
        return bool(self.status_bits & StatusBit.IN_TARGET_POSITION)


class SpindleReference(Reference):
    """A spindle. Speeds in rpm, positions in °; all 0 and Disabled before its first block."""

    def _column(self, name: str) -> Any:
        return getattr(self.block, name)[-1] if isinstance(self.block, SpindleBlock) else 0

    @property
    def state(self) -> AxisStateCode:
        return AxisStateCode(self._column("state"))

    @property
    def set_speed_rpm(self) -> float:
        return float(self._column("set_speed_rpm"))

    @property
    def actual_speed_rpm(self) -> float:
        return float(self._column("actual_speed_rpm"))

    @property
    def actual_position_deg(self) -> float:
        return float(self._column("actual_position_deg"))

    @property
    def override_percent(self) -> float:
        return float(self._column("override_percent"))

    @property
    def status_bits(self) -> int:
        """See SpindleBit."""
        return int(self._column("status_bits"))

    @property
    def speed_reached(self) -> bool:
        return bool(self._column("speed_reached"))

    @property
    def speed_zero(self) -> bool:
        return bool(self._column("speed_zero"))

    @property
    def in_position(self) -> bool:
        return bool(self._column("in_position"))

    @property
    def gear_request(self) -> int:
        """Stage of the gear that the PLC is to change to; 0: none."""
        return self.block.gear_request if isinstance(self.block, SpindleBlock) else 0


class ChannelReference(Reference):
    """A channel; Idle before its first block."""

    def _column(self, name: str) -> Any:
        return getattr(self.block, name)[-1] if isinstance(self.block, ChannelBlock) else 0

    @property
    def state(self) -> ChannelStateCode:
        return ChannelStateCode(self._column("state"))

    @property
    def done(self) -> bool:
        """No program runs, and nothing of one moves."""
        return not isinstance(self.block, ChannelBlock) or self.block.done

    @property
    def line(self) -> int:
        """Of the active NC block."""
        return int(self._column("line"))

    @property
    def block_number(self) -> int:
        return int(self._column("block_number"))

    @property
    def path_velocity(self) -> float:
        return float(self._column("path_velocity"))

    @property
    def override_percent(self) -> float:
        return float(self._column("override_percent"))
