"""Cycle blocks that units exchange: one per tick, field for field the messages of msg/.

Per-cycle fields are lists of `count` values; the channel's setpoints are axis-major (axis index * count + cycle).
Units: mm, s, deg and their derivatives; the .msg files say the rest.
"""

from __future__ import annotations

import json
from collections.abc import Mapping
from dataclasses import dataclass, field
from enum import IntEnum
from math import inf, isfinite, nan
from typing import Any, Final, NamedTuple

from cnc_ptp.errors import Value


class Severity(IntEnum):
    """Severity of an event (Event.msg)."""

    INFO = 0
    WARNING = 1
    ERROR = 2


@dataclass(slots=True)
class Command:
    """A command on its way to a unit (CommandRequest.msg); `arguments` is a JSON object."""

    target: str
    command: str
    arguments: dict[str, Any] = field(default_factory=dict)
    id: int = 0

    @property
    def arguments_json(self) -> str:
        """The arguments as JSON."""
        return json_of(self.arguments)

    @classmethod
    def from_record(cls, record: CommandRecord) -> Command:
        """The command of a record; older records name the file of a table in addition."""
        arguments = arguments_of(record.arguments_json)
        if "table" in arguments:
            arguments.pop("file", None)
        return cls(record.target, record.command, arguments, record.id)


def json_of(arguments: Mapping[str, Any]) -> str:
    """Arguments as JSON; numbers that it does not have as `{"$numberDouble": "NaN"}`, other values as their repr."""
    try:
        return json.dumps(arguments, sort_keys=True, ensure_ascii=False, default=repr, allow_nan=False)
    except ValueError:
        return json.dumps(_extended(arguments), sort_keys=True, ensure_ascii=False, default=repr)


def arguments_of(arguments_json: str) -> dict[str, Any]:
    """What `json_of` has written. Raises ValueError for anything but a JSON object."""
    arguments: Any = json.loads(arguments_json, object_hook=_number_or_object)
    if not isinstance(arguments, dict):
        raise ValueError(f"no JSON object: {arguments_json:.60}")
    return arguments


NUMBER: Final = "$numberDouble"
"""The key of a number that JSON does not have, as in MongoDB's Extended JSON."""
NOT_FINITE: Final = {"NaN": nan, "Infinity": inf, "-Infinity": -inf}


def _extended(value: Any) -> Any:
    if isinstance(value, float) and not isfinite(value):
        return {NUMBER: "NaN" if value != value else "Infinity" if value > 0.0 else "-Infinity"}
    if isinstance(value, Mapping):
        return {name: _extended(each) for name, each in value.items()}
    if isinstance(value, list | tuple):
        return [_extended(each) for each in value]
    return value


def _number_or_object(read: dict[str, Any]) -> Any:
    text = read.get(NUMBER)
    return NOT_FINITE[text] if len(read) == 1 and isinstance(text, str) and text in NOT_FINITE else read


@dataclass(slots=True)
class CommandRecord:
    """A command carried out or refused at `cycle` (CommandRecord.msg).

    `arguments` as JSON; with the text of a program as they came: it may be long, and becomes JSON when that is needed.
    """

    cycle: int
    target: str
    command: str
    arguments: str | Mapping[str, Any]
    accepted: bool
    error_id: int
    message: str
    id: int = 0
    values: Mapping[str, Value] = field(default_factory=dict, compare=False)
    """Values of the refusal's text, or what the command was to find out, by name."""
    job: int = field(default=0, compare=False)
    """Number of the job that it has begun (protocol/jobs.py), 0 if none."""
    warning_id: int = field(default=0, compare=False)
    """Number of the warning in the message of a command that was carried out, 0 if none."""

    @property
    def arguments_json(self) -> str:
        """The arguments as JSON."""
        return self.arguments if isinstance(self.arguments, str) else json_of(self.arguments)

    @property
    def values_json(self) -> str:
        """The values as JSON; empty without any."""
        return json_of(self.values) if self.values else ""


def read_values(values_json: str) -> dict[str, Value]:
    """Of `CommandRecord.values_json`."""
    values: dict[str, Value] = json.loads(values_json) if values_json else {}
    return values


class EventValue(NamedTuple):
    """A number in the text of an event (EventValue.msg)."""

    name: str
    value: float
    unit: str = ""
    role: str = ""
    """limit, actual, faulty, expected or corrected; empty for another number."""


NO_VALUE = EventValue("", 0.0)
"""In place of one that an event does not have."""


@dataclass(slots=True)
class Event:
    """A state change, warning or error (Event.msg)."""

    cycle: int
    source: str
    severity: int
    error_id: int
    text: str
    line: int = 0
    values: list[EventValue] = field(default_factory=list)

    def of_role(self, role: str) -> EventValue:
        """The first value that is a limit, an actual value …; NO_VALUE without one."""
        return next((value for value in self.values if value.role == role), NO_VALUE)

    @property
    def limit(self) -> EventValue:
        return self.of_role("limit")

    @property
    def actual(self) -> EventValue:
        return self.of_role("actual")

    @property
    def faulty(self) -> EventValue:
        return self.of_role("faulty")

    @property
    def expected(self) -> EventValue:
        return self.of_role("expected")

    @property
    def corrected(self) -> EventValue:
        return self.of_role("corrected")


@dataclass(slots=True)
class HandshakeRequest:
    """An M/S/T/D output of the channel, for which it may wait (HandshakeRequest.msg)."""

    cycle: int
    id: int
    channel: str
    kind: str
    spindle: str
    number: int
    value: float
    line: int
    acknowledge_needed: bool
    position: float = 0.0
    direction: str = ""
    synchronisation: str = ""


@dataclass(slots=True)
class ChannelOffsets:
    """What lies between programmed and machine positions (ChannelOffsets.msg)."""

    cycle: int
    line: int
    axes: list[str]
    zero_index: int
    zero_name: str
    zero_offset: list[float]
    reference_offset: list[float]
    preset: list[float]
    clamp_index: int
    clamp_offset: list[float]
    tool_offset: list[float]
    scale: list[float]
    mirrored: list[bool]
    rotated: bool
    rotation_angle: float
    systems: list[str]
    machine_coordinates: bool
    matrix: list[float]
    shift: list[float]
    origin: list[float] = field(default_factory=list)
    default_index: int = -1
    """-1: a recording from before it was told."""
    changed_indices: list[int] = field(default_factory=list)
    changed_offsets: list[float] = field(default_factory=list)
    changed_inactive: list[bool] = field(default_factory=list)


class CommandAnswer(NamedTuple):
    """What a unit answers to a command of the PLC (CommandAnswer.msg)."""

    id: int
    error_id: int = 0
    job: int = 0
    message: str = ""
    values_json: str = ""

    @property
    def values(self) -> dict[str, Value]:
        """What the command was to find out, or the values of a refusal, by name."""
        return read_values(self.values_json)


class JobEvent(NamedTuple):
    """What has become of a job (JobEvent.msg, protocol/jobs.py)."""

    job: int
    status: int
    cycle: int
    error_id: int = 0


class ControlUnitState(NamedTuple):
    """A control unit of the HLI after a change (ControlUnitState.msg, protocol/control_units.py)."""

    name: str
    held: bool
    request: float
    state: float
    holder: str = ""


class CycleTick(NamedTuple):
    """The cycles first_cycle .. first_cycle + count - 1 are to be computed (CycleTick.msg)."""

    first_cycle: int
    count: int  # type: ignore[assignment]  # tuple.count is not wanted here


@dataclass(slots=True)
class PlcBlock:
    """PlcBlock.msg"""

    first_cycle: int
    count: int
    life_sign: int = 0
    scenario_done: bool = True
    run_done: bool = False
    run_failed: bool = False
    commands: list[Command] = field(default_factory=list)


@dataclass(slots=True)
class ChannelBlock:
    """ChannelBlock.msg"""

    first_cycle: int
    count: int
    path_active: bool = False
    axes: list[str] = field(default_factory=list)
    set_position: list[float] = field(default_factory=list)
    set_velocity: list[float] = field(default_factory=list)
    set_acceleration: list[float] = field(default_factory=list)
    set_jerk: list[float] = field(default_factory=list)
    path_spindles: list[str] = field(default_factory=list)
    spindle_travel: list[float] = field(default_factory=list)
    spindle_speed: list[float] = field(default_factory=list)
    spindle_acceleration: list[float] = field(default_factory=list)
    spindle_jerk: list[float] = field(default_factory=list)
    thread_axis: list[int] = field(default_factory=list)
    thread_spindle: list[int] = field(default_factory=list)
    thread_lead: list[float] = field(default_factory=list)
    thread_set_pitch_error: list[float] = field(default_factory=list)
    thread_actual_pitch_error: list[float] = field(default_factory=list)
    thread_set_phase_error_deg: list[float] = field(default_factory=list)
    thread_actual_phase_error_deg: list[float] = field(default_factory=list)
    line: list[int] = field(default_factory=list)
    block_number: list[int] = field(default_factory=list)
    path_velocity: list[float] = field(default_factory=list)
    programmed_feed: list[float] = field(default_factory=list)
    override_percent: list[float] = field(default_factory=list)
    distance_to_go: list[float] = field(default_factory=list)
    state: list[int] = field(default_factory=list)
    error_id: list[int] = field(default_factory=list)
    done: bool = True
    blocks_done: int = 0
    blocks_total: int = 0
    progress: float = 0.0
    time_left: float = 0.0
    programmed_position: list[float] = field(default_factory=list)
    offsets: list[ChannelOffsets] = field(default_factory=list)
    commands: list[Command] = field(default_factory=list)
    requests: list[HandshakeRequest] = field(default_factory=list)
    job: int = 0
    job_events: list[JobEvent] = field(default_factory=list)
    answers: list[CommandAnswer] = field(default_factory=list)
    control_units: list[ControlUnitState] = field(default_factory=list)


@dataclass(slots=True)
class AxisBlock:
    """AxisBlock.msg"""

    first_cycle: int
    count: int
    set_position: list[float] = field(default_factory=list)
    set_velocity: list[float] = field(default_factory=list)
    set_acceleration: list[float] = field(default_factory=list)
    set_jerk: list[float] = field(default_factory=list)
    actual_position: list[float] = field(default_factory=list)
    actual_velocity: list[float] = field(default_factory=list)
    following_error: list[float] = field(default_factory=list)
    command_velocity: list[float] = field(default_factory=list)
    feedforward_velocity: list[float] = field(default_factory=list)
    additive_velocity: list[float] = field(default_factory=list)
    additive_torque: list[float] = field(default_factory=list)
    friction_current: list[float] = field(default_factory=list)
    actual_torque: list[float] = field(default_factory=list)
    feedforward_percent: list[float] = field(default_factory=list)
    override_percent: list[float] = field(default_factory=list)
    state: list[int] = field(default_factory=list)
    status_bits: list[int] = field(default_factory=list)
    error_id: list[int] = field(default_factory=list)
    master: str = ""
    target_velocity: float = 0.0
    modulo_begin: float = 0.0
    modulo_length: float = 0.0
    torque_digits: float = 0.0
    couples_actual: bool = False
    probe_on: bool = False
    probe_switched: bool = False
    probe_cycle: float = 0.0
    probe_position: float = 0.0
    job: int = 0
    job_events: list[JobEvent] = field(default_factory=list)
    answers: list[CommandAnswer] = field(default_factory=list)
    control_units: list[ControlUnitState] = field(default_factory=list)


class Refusal(NamedTuple):
    """A spindle's refusal of a command of `source`; a message has it as one text."""

    source: str
    number: int
    text: str

    def encode(self) -> str:
        return f"{self.source}: P-ERR-{self.number} {self.text}"

    @classmethod
    def decode(cls, message: str) -> Refusal:
        """Of what `encode` has made; a message of another form has the number 0."""
        source, _, refusal = message.partition(": P-ERR-")
        number, _, text = refusal.partition(" ")
        return cls(source, int(number), text) if number.isdecimal() else cls("", 0, message)


@dataclass(slots=True)
class SpindleBlock:
    """SpindleBlock.msg"""

    first_cycle: int
    count: int
    set_speed_rpm: list[float] = field(default_factory=list)
    actual_speed_rpm: list[float] = field(default_factory=list)
    programmed_speed_rpm: list[float] = field(default_factory=list)
    set_acceleration_deg_s2: list[float] = field(default_factory=list)
    set_position_deg: list[float] = field(default_factory=list)
    actual_position_deg: list[float] = field(default_factory=list)
    target_position_deg: list[float] = field(default_factory=list)
    distance_to_go_deg: list[float] = field(default_factory=list)
    following_error_deg: list[float] = field(default_factory=list)
    override_percent: list[float] = field(default_factory=list)
    feedforward_percent: list[float] = field(default_factory=list)
    drive_output: list[int] = field(default_factory=list)
    mode: list[int] = field(default_factory=list)
    gear: list[int] = field(default_factory=list)
    speed_reached: list[bool] = field(default_factory=list)
    speed_zero: list[bool] = field(default_factory=list)
    in_position: list[bool] = field(default_factory=list)
    referenced: list[bool] = field(default_factory=list)
    gear_change_active: list[bool] = field(default_factory=list)
    status_bits: list[int] = field(default_factory=list)
    state: list[int] = field(default_factory=list)
    error_id: list[int] = field(default_factory=list)
    gear_request: int = 0
    master: str = ""
    master_wanted: str = ""
    source: str = ""
    plc_commands: int = 0
    plc_acknowledged: int = 0
    refused: list[Refusal] = field(default_factory=list)
    commands: list[Command] = field(default_factory=list)
    job: int = 0
    job_events: list[JobEvent] = field(default_factory=list)
    answers: list[CommandAnswer] = field(default_factory=list)
    control_units: list[ControlUnitState] = field(default_factory=list)


CycleBlock = PlcBlock | ChannelBlock | AxisBlock | SpindleBlock
