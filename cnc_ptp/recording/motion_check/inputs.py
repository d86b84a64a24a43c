"""What the checker reads: the states of a unit as columns, accepted commands, parameters."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any

import numpy as np
import numpy.typing as npt

from cnc_ptp.errors import CncError
from cnc_ptp.machine.wiring import unit_kinds
from cnc_ptp.parameters import MachineParameters, load_machine
from cnc_ptp.protocol.commands import COMMANDS as COMMANDS_OF
from cnc_ptp.protocol.commands import FILE_CONTENTS, check_arguments, current_names
from cnc_ptp.recording.command_words import json_object
from cnc_ptp.recording.opened import OpenRecording
from cnc_ptp.recording.origin import FOREIGN
from cnc_ptp.recording.reader import AXIS_STATE, CHANNEL_STATE, SPINDLE_STATE
from cnc_ptp.recording.writer import MACHINE_FILE

NO_SETPOINTS = 26262
NO_PARAMETERS = 26263
LACKS_FIELDS = 26264
UNCHECKED = "no motion was checked"
CYCLE_TIME_NS = 1_000_000
"""Of a recording that does not say its own."""

Column = npt.NDArray[Any]
Columns = Mapping[str, Column]
AXIS_FIELDS = (
    "cycle",
    "set_position",
    "set_velocity",
    "set_acceleration",
    "actual_position",
    "actual_velocity",
    "state",
    "status_bits",
    "error_id",
)
SPINDLE_FIELDS = (
    "cycle",
    "set_speed_rpm",
    "set_acceleration_deg_s2",
    "set_position_deg",
    "gear",
    "referenced",
    "state",
    "status_bits",
)
COMMANDS = "/commands"
COMMAND_FIELDS = ("cycle", "target", "command", "arguments_json", "accepted")
TEXTS = frozenset({"target", "command", "arguments_json"})


@dataclass(frozen=True, slots=True)
class Order:
    """A command that was carried out at `cycle`."""

    cycle: int
    command: str
    arguments: Mapping[str, Any]

    def number(self, name: str) -> float:
        """A positive number among the arguments, also as text (inf); 0.0 if there is none."""
        try:
            value = float(self.arguments.get(name) or 0.0)
        except (TypeError, ValueError, OverflowError):
            return 0.0
        return value if value > 0.0 else 0.0


@dataclass(slots=True)
class MotionInputs:
    """Of one run: machine, cycle time in s, the states of each axis, spindle and channel, orders by unit."""

    machine: MachineParameters
    cycle_time: float
    axes: dict[str, Columns] = field(default_factory=dict)
    spindles: dict[str, Columns] = field(default_factory=dict)
    channels: dict[str, Column] = field(default_factory=dict)
    """The recorded cycles of each channel."""
    orders: dict[str, list[Order]] = field(default_factory=dict)

    def orders_of(self, unit: str) -> Sequence[Order]:
        return self.orders.get(unit, ())


def read_inputs(recording: OpenRecording) -> MotionInputs:
    """All of a recording. Raises CncError 26017, 26262, 26263, 26264, and those of its machine file."""
    units = {
        kind: [name for name, topic in recording.topics.items() if topic.type_name == kind]
        for kind in (AXIS_STATE, SPINDLE_STATE, CHANNEL_STATE)
    }
    if not recording.metadata and not any(units.values()):
        raise CncError(FOREIGN, f"recording {recording.path}: is not of cnc_ptp", UNCHECKED)
    axes = _of_units(recording, units[AXIS_STATE], AXIS_FIELDS)
    spindles = _of_units(recording, units[SPINDLE_STATE], SPINDLE_FIELDS)
    if not axes and not spindles:
        reason = f"recording {recording.path}: holds no setpoints of an axis or a spindle"
        raise CncError(NO_SETPOINTS, reason, UNCHECKED)
    inputs = MotionInputs(_machine(recording), _cycle_time(recording), axes, spindles)
    channels = _of_units(recording, units[CHANNEL_STATE], ("cycle",))
    inputs.channels = {name: columns["cycle"] for name, columns in channels.items()}
    _require_parameters(recording, inputs)
    _require_commands(recording, inputs)
    inputs.orders = orders_by_unit(inputs.machine, _commands(recording))
    return inputs


def orders_by_unit(
    machine: MachineParameters, commands: Iterable[tuple[int, str, str, str, bool]]
) -> dict[str, list[Order]]:
    """Accepted ones of (cycle, target, command, arguments as JSON, accepted), in the order of their cycles.

    What no unit of the machine could take is left out.
    """
    kinds = unit_kinds(machine)
    orders: dict[str, list[Order]] = {}
    for cycle, target, command, arguments_json, accepted in commands:
        kind, arguments = kinds.get(target, ""), json_object(arguments_json or "{}")
        if accepted and kind and arguments is not None:
            arguments = current_names(kind, command, arguments)
            taken = what_is_taken(kind, command, arguments)
            if taken is not None:
                orders.setdefault(target, []).append(Order(int(cycle), command, taken))
    for of_unit in orders.values():
        of_unit.sort(key=lambda order: order.cycle)
    return orders


def what_is_taken(kind: str, command: str, arguments: Mapping[str, Any]) -> dict[str, Any] | None:
    """The arguments of a command that a unit of this kind takes; None where one is missing or of another kind.

    Further ones, which another version may have recorded, do not count, nor does the name of the file of a table.
    """
    specification = COMMANDS_OF[kind].get(command)
    if specification is None:
        return None
    known = {name: value for name, value in arguments.items() if name in specification}
    if not FILE_CONTENTS.isdisjoint(known):
        known.pop("file", None)
    try:
        check_arguments(command, specification, known)
    except CncError:
        return None
    return known


def in_order(columns: Columns) -> Columns:
    """Sorted by their cycles, each cycle once."""
    cycles = columns["cycle"].astype(np.int64)
    if (np.diff(cycles) > 0).all():
        return {**columns, "cycle": cycles}
    _, first = np.unique(cycles, return_index=True)
    return {name: column[first] for name, column in columns.items()} | {"cycle": cycles[first]}


def _of_units(recording: OpenRecording, topics: Iterable[str], fields: Sequence[str]) -> dict[str, Columns]:
    """By name; without units of which nothing is left."""
    found = {_unit(topic): _columns(recording, topic, fields) for topic in topics}
    return {name: columns for name, columns in found.items() if len(columns["cycle"])}


def _columns(recording: OpenRecording, topic: str, fields: Sequence[str]) -> Columns:
    lacking = [name for name in fields if name not in recording.topics[topic].fields]
    if lacking:
        reason = f"recording {recording.path}: {topic} was recorded without {', '.join(lacking)}"
        raise CncError(LACKS_FIELDS, reason, UNCHECKED)
    columns = _typed(recording, topic, fields)
    return in_order({name: columns[name] for name in fields})


def _typed(recording: OpenRecording, topic: str, fields: Sequence[str]) -> Columns:
    """Raises CncError 26264 where they are no columns of numbers, or of texts."""
    columns = recording.columns(topic, *fields)
    foreign = [name for name in fields if not _has_type(name, columns[name])]
    if foreign:
        reason = f"recording {recording.path}: {topic} was recorded with another type of {', '.join(foreign)}"
        raise CncError(LACKS_FIELDS, reason, UNCHECKED)
    return columns


def _has_type(name: str, column: Column) -> bool:
    if name in TEXTS:
        return all(isinstance(value, str) for value in column)
    return column.ndim == 1 and column.dtype.kind in "biuf"


def _require_commands(recording: OpenRecording, inputs: MotionInputs) -> None:
    """What moves from the first cycle on was commanded."""
    moved = any(columns["set_velocity"].any() for columns in inputs.axes.values())
    moved |= any(columns["set_speed_rpm"].any() for columns in inputs.spindles.values())
    if moved and COMMANDS not in recording.topics:
        reason = f"recording {recording.path}: was recorded without {COMMANDS}"
        raise CncError(LACKS_FIELDS, reason, UNCHECKED)


def _commands(recording: OpenRecording) -> list[tuple[int, str, str, str, bool]]:
    if COMMANDS not in recording.topics:
        return []
    columns = _typed(recording, COMMANDS, COMMAND_FIELDS)
    return list(zip(*(columns[name] for name in COMMAND_FIELDS), strict=True))


def _machine(recording: OpenRecording) -> MachineParameters:
    try:
        text = recording.attached(MACHINE_FILE)
    except CncError:
        text = ""
    if not text:
        reason = f"recording {recording.path}: holds no attachment {MACHINE_FILE}, which has the limits"
        raise CncError(NO_PARAMETERS, reason, UNCHECKED)
    return load_machine(text, f"{recording.path}:{MACHINE_FILE}")


def _require_parameters(recording: OpenRecording, inputs: MotionInputs) -> None:
    for kind, units, known in (
        ("axis", inputs.axes, inputs.machine.axes),
        ("spindle", inputs.spindles, inputs.machine.spindles),
    ):
        for unit in units:
            if unit not in known:
                reason = f"recording {recording.path}: its {MACHINE_FILE} has no {kind} '{unit}'"
                raise CncError(NO_PARAMETERS, reason, UNCHECKED)


def _cycle_time(recording: OpenRecording) -> float:
    return int(recording.metadata.get("cycle_time_ns", CYCLE_TIME_NS)) * 1e-9


def _unit(topic: str) -> str:
    return topic.strip("/").removesuffix("/state")
