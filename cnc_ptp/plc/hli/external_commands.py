"""What the external command of a control message stands for (HliAxisCommand.msg, HliSpindleCommand.msg)."""

from __future__ import annotations

from collections.abc import Mapping
from math import isfinite
from typing import Any, NamedTuple

from cnc_ptp.protocol.blocks import Command
from cnc_ptp.protocol.commands import BUFFER_MODES
from cnc_ptp.protocol.unit import PLC


class Meaning(NamedTuple):
    """The command of a `type`, and where its arguments come from."""

    command: str
    fields: Mapping[str, str] = {}
    """Argument -> field."""
    optional: Mapping[str, str] = {}
    """Argument -> field whose 0 leaves it out: what the unit has counts then."""
    constants: Mapping[str, Any] = {}


RAMPS = {name: name for name in ("acceleration", "deceleration", "jerk")}
DYNAMICS = {"velocity": "velocity", **RAMPS}
WEIGHT = {"weight_percent": "weight"}
ON, OFF = {"enabled": True}, {"enabled": False}
FOR_PLC = {"source": PLC}
"""A command that waits for its turn and is counted."""

AXIS_COMMANDS: Mapping[int, Meaning] = {
    1: Meaning("stop"),
    2: Meaning("halt"),
    3: Meaning("move_absolute", {"target": "position"}, DYNAMICS),
    4: Meaning("move_relative", {"distance": "position"}, DYNAMICS),
    5: Meaning("move_modulo", {"position": "position"}, DYNAMICS),
    6: Meaning("move_velocity", {"velocity": "velocity"}, RAMPS),
    7: Meaning("new_target", {"target": "position"}),
    8: Meaning("home", {}, {"position": "position"}),
    9: Meaning("move_additive", {"distance": "position"}, DYNAMICS),
    10: Meaning("move_superimposed", {"distance": "position"}, {"velocity_difference": "velocity", **RAMPS}),
    11: Meaning("halt_superimposed"),
    12: Meaning(
        "new_velocity_and_target",
        {"target": "position", "velocity": "velocity", "activation_position": "activation_position"},
    ),
    13: Meaning("emergency_stop", {}, {"deceleration": "deceleration", "jerk": "jerk"}),
    14: Meaning("set_position", {"position": "position"}),
    15: Meaning("couple", {"factor": "factor"}),
    16: Meaning("decouple"),
    17: Meaning("set_coupling_factor", {"factor": "factor"}),
    18: Meaning("set_feedforward", {}, WEIGHT, ON),
    19: Meaning("set_feedforward", {}, {}, OFF),
    20: Meaning("reset_feedforward"),
    21: Meaning("set_friction_compensation", {}, {}, ON),
    22: Meaning("set_friction_compensation", {}, {}, OFF),
}
SPEED = {"speed_rpm": "speed"}
RATIO = {"factor_num": "factor_num", "factor_den": "factor_den"}
LIMITS = {"max_speed_rpm": "speed", "min_speed_rpm": "min_speed", "max_acceleration": "acceleration"}
SPINDLE_COMMANDS: Mapping[int, Meaning] = {
    1: Meaning("stop", {}, {}, FOR_PLC),
    2: Meaning("start", SPEED, {}, {"direction": "cw", **FOR_PLC}),
    3: Meaning("start", SPEED, {}, {"direction": "ccw", **FOR_PLC}),
    4: Meaning("set_speed", SPEED, {}, FOR_PLC),
    5: Meaning("orient", {"position_deg": "position"}, SPEED, FOR_PLC),
    6: Meaning("home", {}, {}, FOR_PLC),
    7: Meaning("select_gear", {}, {}, FOR_PLC),
    8: Meaning("suppress_override", {}, {}, ON),
    9: Meaning("suppress_override", {}, {}, OFF),
    10: Meaning("set_limits", {}, LIMITS),
    11: Meaning("reset_limits"),
    12: Meaning("couple", {}, RATIO),
    13: Meaning("decouple"),
    14: Meaning("set_feedforward", {}, WEIGHT, ON),
    15: Meaning("set_feedforward", {}, {}, OFF),
    16: Meaning("reset_feedforward"),
}
EXTERNAL_COMMANDS = {"axis": AXIS_COMMANDS, "spindle": SPINDLE_COMMANDS}
"""Kind of unit -> `type` -> what it means."""
STOPS: Mapping[str, Mapping[int, str]] = {
    kind: {number: each.command for number, each in known.items() if each.command in ("stop", "halt", "emergency_stop")}
    for kind, known in EXTERNAL_COMMANDS.items()
}
"""Kind of unit -> `type` -> a command that brings it to rest."""
DIRECTIONS = {1: "cw", -1: "ccw", 2: "shortest"}
BUFFERABLE = ("move_absolute", "move_relative", "move_modulo", "move_additive", "move_velocity")


def external_command(kind: str, name: str, external: Mapping[str, float], masters: Mapping[int, str]) -> Command | str:
    """The command that an external command stands for, or why it is none.

    `masters`: the units of this kind by their logical numbers (P-AXIS-00016).
    """
    for field, value in external.items():
        if not isfinite(value):
            return f"{field} = {value} is not finite"
    number, known = int(external["type"]), EXTERNAL_COMMANDS[kind]
    if number not in known:
        return f"type = {number} is not within 1 ... {len(known)}"
    command, fields, optional, constants = known[number]
    arguments: dict[str, Any] = {argument: external[field] for argument, field in fields.items()}
    arguments |= {argument: external[field] for argument, field in optional.items() if external[field]}
    arguments |= constants
    if command == "couple":
        master = masters.get(int(external["master"]))
        if master is None:
            return f"master = {int(external['master'])} is the logical number (P-AXIS-00016) of no {kind}"
        arguments["master"] = master
    complete = _of_axis if kind == "axis" else _of_spindle
    return complete(name, command, arguments, external)


def _of_axis(name: str, command: str, arguments: dict[str, Any], external: Mapping[str, float]) -> Command | str:
    """An endless motion takes over what is active, so that its velocity may change; a velocity of 0 ends it."""
    if command == "move_velocity" and not external["velocity"]:
        return Command(name, "halt", {})
    if command in BUFFERABLE:
        mode = int(external["buffer_mode"]) or int(command == "move_velocity")
        if mode > len(BUFFER_MODES):
            return f"buffer_mode = {mode} is not within 0 ... {len(BUFFER_MODES)}"
        arguments |= {"buffer_mode": BUFFER_MODES[mode - 1]} if mode else {}
    return Command(name, command, arguments)


def _of_spindle(name: str, command: str, arguments: dict[str, Any], external: Mapping[str, float]) -> Command | str:
    if command == "select_gear":
        arguments["stage"] = int(external["gear"])
    elif command == "orient":
        direction = DIRECTIONS.get(int(external["direction"]))
        arguments |= {"direction": direction} if direction else {}
    return Command(name, command, arguments)
