"""A control message of the HLI as the PLC unit reads it, and what its external command stands for."""

from __future__ import annotations

from collections.abc import Mapping
from math import isfinite
from typing import Any, NamedTuple

from cnc_ptp.parameters.list_units import DEG_S_PER_RPM
from cnc_ptp.protocol.blocks import Command
from cnc_ptp.protocol.control_units import CONTROL_UNITS
from cnc_ptp.protocol.unit import PLC

HLI_UNITS = 1
"""`units` of a control message: integers of the HLI."""
PER_PERCENT = 10.0
PER_LENGTH = 1e4
"""0.1 µm per mm, 0.0001 ° per °."""
PER_SPEED = 1e3
"""µm/s per mm/s, 0.001 °/s per °/s."""

RAMPS = ("acceleration", "deceleration", "jerk")
AXIS_COMMANDS: Mapping[int, tuple[str, Mapping[str, str]]] = {
    1: ("stop", {}),
    2: ("halt", {}),
    3: ("move_absolute", {"target": "position"}),
    4: ("move_relative", {"distance": "position"}),
    5: ("move_modulo", {"position": "position"}),
    6: ("move_velocity", {"velocity": "velocity"}),
    7: ("new_target", {"target": "position"}),
    8: ("home", {}),
}
"""`type` of HliAxisCommand -> command, its arguments and the fields that they come from."""
OPTIONAL_FIELDS: Mapping[str, tuple[str, ...]] = {
    **dict.fromkeys(("move_absolute", "move_relative", "move_modulo"), ("velocity", *RAMPS)),
    "move_velocity": RAMPS,
    "home": ("position",),
}
"""Command -> arguments with fields of the same names, where 0 means that the axis parameter counts."""
SPINDLE_COMMANDS: Mapping[int, str] = {
    1: "stop",
    2: "start",
    3: "start",
    4: "set_speed",
    5: "orient",
    6: "home",
    7: "select_gear",
}
"""`type` of HliSpindleCommand -> command."""
STOP = 1
"""`type` of axes and spindles."""
DIRECTIONS = {1: "cw", -1: "ccw", 2: "shortest"}


class ControlMessage(NamedTuple):
    """What a PLC commands of one object: the fields of <Kind>HliControl.msg."""

    source: str
    sequence: int
    valid: bool
    units: Mapping[str, tuple[bool, float]]
    """Control unit -> enable_w, command_w; overrides in percent."""
    external: Mapping[str, float] = {}
    """Fields of the external command in SI units; empty of a channel."""
    serves_functions: bool = False
    """A channel: the PLC acknowledges its functions."""
    acknowledged: tuple[int, ...] = ()

    @property
    def semaphore(self) -> bool:
        return bool(self.external and self.external["semaphore"])

    @property
    def commands(self) -> bool:
        """It serves anything, or has an external command."""
        return self.serves_functions or self.semaphore or any(enabled for enabled, _ in self.units.values())


def control_message(kind: str, source: str, fields: Mapping[str, Any]) -> ControlMessage:
    """Of the fields of a message by dotted name (`override.command_w`)."""
    hli = fields["units"] == HLI_UNITS
    units = {
        unit.name: (bool(fields[f"{unit.name}.enable_w"]), float(fields[f"{unit.name}.command_w"]))
        for unit in CONTROL_UNITS[kind]
    }
    if hli:
        enabled, permille = units["override"]
        units["override"] = enabled, permille / PER_PERCENT
    external: dict[str, float] = {}
    if "external.semaphore" in fields:
        external = {name.partition(".")[2]: fields[name] for name in fields if name.startswith("external.")}
        if hli:
            in_si(external)
    done = fields.get("acknowledge.done_w", ())
    return ControlMessage(
        source,
        fields["sequence"],
        bool(fields["valid"]),
        units,
        external,
        bool(fields.get("acknowledge.enable_w", False)),
        tuple(number for number in done if number),
    )


def in_si(external: dict[str, float]) -> None:
    """Numbers of the HLI become mm, °, mm/s, rpm."""
    external["position"] /= PER_LENGTH
    if "velocity" in external:
        external["velocity"] /= PER_SPEED
    else:
        external["speed"] /= PER_SPEED * DEG_S_PER_RPM


def is_stop(message: ControlMessage) -> bool:
    """Its external command is STOP."""
    return message.semaphore and message.external["type"] == STOP


def external_command(kind: str, name: str, external: Mapping[str, float]) -> Command | str:
    """The command that an external command stands for, or why it is none."""
    for field, value in external.items():
        if not isfinite(value):
            return f"{field} = {value} is not finite"
    number = int(external["type"])
    known = AXIS_COMMANDS if kind == "axis" else SPINDLE_COMMANDS
    if number not in known:
        return f"type = {number} is not within 1 ... {len(known)}"
    return axis_command(name, external) if kind == "axis" else spindle_command(name, external)


def axis_command(name: str, external: Mapping[str, float]) -> Command:
    """Optional fields of 0 are left out: those of the axis count.

    An endless motion takes over what is active, so that its velocity may change; a velocity of 0 ends it.
    """
    command, fields = AXIS_COMMANDS[int(external["type"])]
    arguments: dict[str, Any] = {argument: external[field] for argument, field in fields.items()}
    if command == "move_velocity":
        if not external["velocity"]:
            return Command(name, "halt", {})
        arguments["buffer_mode"] = "aborting"
    arguments |= {field: external[field] for field in OPTIONAL_FIELDS.get(command, ()) if external[field]}
    return Command(name, command, arguments)


def spindle_command(name: str, external: Mapping[str, float]) -> Command:
    """A command of the source plc: it waits for its turn and is counted."""
    number = int(external["type"])
    command = SPINDLE_COMMANDS[number]
    arguments: dict[str, Any] = {"source": PLC}
    if command == "start":
        arguments |= {"direction": "cw" if number == 2 else "ccw", "speed_rpm": external["speed"]}
    elif command == "set_speed":
        arguments["speed_rpm"] = external["speed"]
    elif command == "select_gear":
        arguments["stage"] = int(external["gear"])
    elif command == "orient":
        arguments["position_deg"] = external["position"]
        arguments |= {"speed_rpm": external["speed"]} if external["speed"] else {}
        direction = DIRECTIONS.get(int(external["direction"]))
        arguments |= {"direction": direction} if direction else {}
    return Command(name, command, arguments)
