"""The commands as data: those that each kind of unit understands, with their arguments.

Scenarios are checked against it before a run starts, units before they change anything, services are made from it.
"""

from __future__ import annotations

import math
from collections.abc import Collection, Mapping
from dataclasses import dataclass
from typing import Any

from cnc_ptp.errors import CncError, nearest_name

BAD_ARGUMENT = 22001
UNKNOWN_COMMAND = 22002


@dataclass(frozen=True, slots=True)
class Argument:
    """One argument of a command. `kind`: number, integer, switch, text, rows, files or source; `choices` limits a text.

    `positive`: only a number above 0 makes sense, so that 0 in a service means that it is left out.
    `lenient`: the command is carried out with any value and reports the one it uses.
    `field`: type of an integer in its service.
    """

    kind: str
    required: bool = True
    choices: tuple[str, ...] = ()
    positive: bool = False
    lenient: bool = False
    field: str = "int64"


Arguments = Mapping[str, Argument]
NUMBER = Argument("number")
OPTIONAL_NUMBER = Argument("number", required=False)
INTEGER = Argument("integer")
UINT8 = Argument("integer", field="uint8")
UINT32 = Argument("integer", field="uint32")
UINT64 = Argument("integer", field="uint64")
SWITCH = Argument("switch")
TEXT = Argument("text")
OPTIONAL_TEXT = Argument("text", required=False)
ROWS = Argument("rows")
OPTIONAL_ROWS = Argument("rows", required=False)
OPTIONAL_COUNT = Argument("integer", required=False, positive=True)
OPTIONAL_POSITIVE = Argument("number", required=False, positive=True)
LENIENT_NUMBER = Argument("number", required=False, lenient=True)
DYNAMICS: dict[str, Argument] = dict.fromkeys(("velocity", "acceleration", "deceleration", "jerk"), OPTIONAL_POSITIVE)
BUFFER_MODES = ("aborting", "buffered", "blending_low", "blending_previous", "blending_next", "blending_high")
START: dict[str, Argument] = {**DYNAMICS, "buffer_mode": Argument("text", required=False, choices=BUFFER_MODES)}
"""Of a motion: its dynamics, and how it follows an active one (PLCopen)."""
RAMPS: dict[str, Argument] = {name: DYNAMICS[name] for name in ("acceleration", "deceleration", "jerk")}
DIALECT = Argument("text", required=False, choices=("twincat", "iso"))
SOURCE: Arguments = {"source": TEXT}
FOR: Arguments = {"source": Argument("source", required=False)}
"""Source of a spindle command: the name of a channel, or plc for the PLC's own commands."""
OWNER: Arguments = {"owner": Argument("source", required=False)}
"""Source of the coupling."""
OPTIONAL_SWITCH = Argument("switch", required=False)
CAM: Arguments = {"table": ROWS, "file": OPTIONAL_TEXT}
COUPLING: Arguments = {
    "master": TEXT,
    "above": Argument("rows", required=False),
    "master_stands": OPTIONAL_SWITCH,
    "master_start": OPTIONAL_TEXT,
    "master_lost": OPTIONAL_SWITCH,
}
"""A master, and what the PLC fills in: its masters, whether it stands, what may start it in this block, is it lost."""

OVERLAY: Arguments = {
    "control_unit": TEXT,
    "enabled": SWITCH,
    "value": OPTIONAL_NUMBER,
    "holder": OPTIONAL_TEXT,
    "silent": OPTIONAL_SWITCH,
}
"""An external PLC serves a control unit of the HLI, or gives it back (protocol/control_units.py)."""
FEEDFORWARD: Arguments = {"enabled": OPTIONAL_SWITCH, "weight_percent": OPTIONAL_NUMBER}

SEVERAL: Mapping[str, str] = {"axis": "axes", "spindle": "spindles", "channel": "channels", "plc": "the PLC"}
"""Kind of unit -> its plural in texts."""
COMMANDS: Mapping[str, Mapping[str, Arguments]] = {
    "axis": {
        "power": {"enabled": SWITCH},
        "reset": {},
        "set_feed_release": {"forward": SWITCH, "backward": SWITCH},
        "feed_hold": {"enabled": SWITCH},
        "move_absolute": {"target": NUMBER, **START},
        "move_relative": {"distance": NUMBER, **START},
        "move_modulo": {"position": NUMBER, **START},
        "move_additive": {"distance": NUMBER, **START},
        "move_velocity": {**START, "velocity": NUMBER},
        "move_superimposed": {"distance": NUMBER, "velocity_difference": OPTIONAL_POSITIVE, **RAMPS},
        "halt_superimposed": {},
        "set_position": {"position": NUMBER, "relative": OPTIONAL_SWITCH},
        "set_override": {"percent": NUMBER},
        "set_override_type": {"type": UINT8},
        "stop": {},
        "hold_stop": {"enabled": SWITCH},
        "halt": {},
        "jog": {"velocity": NUMBER},
        "home": {"position": OPTIONAL_NUMBER},
        "set_homing_override": {"percent": NUMBER},
        "emergency_stop": dict.fromkeys(("deceleration", "jerk"), LENIENT_NUMBER),
        "new_target": {"target": NUMBER},
        "new_velocity_and_target": {"velocity": NUMBER, "target": NUMBER, "activation_position": NUMBER},
        "compensation_start": {
            "length": NUMBER,
            "difference": NUMBER,
            "process_velocity": NUMBER,
            "velocity_increase": NUMBER,
            "acceleration": OPTIONAL_POSITIVE,
            "deceleration": OPTIONAL_POSITIVE,
        },
        "compensation_stop": {},
        "external_enable": {"mode": Argument("text", choices=("absolute", "relative")), "target": OPTIONAL_NUMBER},
        "external_disable": {},
        "external_setpoints": {"setpoints": ROWS, "file": OPTIONAL_TEXT},
        "couple": {"factor": NUMBER, **COUPLING},
        "couple_gantry": {"difference_limit": NUMBER, **COUPLING},
        "couple_cyclic": {"acc_bound": NUMBER, **COUPLING},
        "couple_flying_saw": {
            "factor": NUMBER,
            "master_position": NUMBER,
            "slave_position": NUMBER,
            **DYNAMICS,
            **COUPLING,
        },
        "couple_cam": {
            **CAM,
            "cyclic": OPTIONAL_SWITCH,
            "master_offset": OPTIONAL_NUMBER,
            "master_scaling": OPTIONAL_NUMBER,
            "slave_scaling": OPTIONAL_NUMBER,
            "slave_offset": OPTIONAL_NUMBER,
            **COUPLING,
        },
        "change_cam": CAM,
        "set_coupling_factor": {"factor": NUMBER},
        "set_cyclic_factor": {"factor": NUMBER},
        "decouple": {"target": OPTIONAL_NUMBER, "velocity": OPTIONAL_POSITIVE},
        "write_parameter": {"parameter": TEXT, "value": NUMBER, "by_path": OPTIONAL_SWITCH},
        "set_feedforward": FEEDFORWARD,
        "reset_feedforward": {},
        "set_friction_compensation": {"enabled": SWITCH},
        "read_drive_parameter": {"idn": TEXT},
        "write_drive_parameter": {"idn": TEXT, "value": INTEGER},
        "overlay": OVERLAY,
        "set_emergency_stop": {"enabled": SWITCH},
        "begin_trajectory": {
            "points": ROWS,
            "path_tolerance": OPTIONAL_NUMBER,
            "goal_tolerance": OPTIONAL_NUMBER,
            "goal_time": OPTIONAL_NUMBER,
            "delay": OPTIONAL_NUMBER,
        },
        "lead": {"slave": TEXT, "enabled": SWITCH},
        "group_error": {"source": TEXT, "error": INTEGER},
        "upstream_lost": SOURCE,
    },
    "spindle": {
        "power": {"enabled": SWITCH},
        "start": {"direction": Argument("text", choices=("cw", "ccw")), "speed_rpm": NUMBER, **FOR},
        "set_speed": {"speed_rpm": NUMBER, **FOR},
        "stop": {"own": OPTIONAL_SWITCH, "homes": OPTIONAL_SWITCH, **FOR},
        "hold_stop": {"enabled": SWITCH},
        "orient": {
            "position_deg": NUMBER,
            "speed_rpm": OPTIONAL_POSITIVE,
            "direction": Argument("text", required=False, choices=("cw", "ccw", "shortest")),
            **FOR,
        },
        "home": {**FOR},
        "set_override": {"percent": NUMBER},
        "suppress_override": {"enabled": SWITCH},
        "feed_hold": {"enabled": SWITCH},
        "select_gear": {"stage": INTEGER, "resume": OPTIONAL_SWITCH, **FOR},
        "gear_changed": {},
        "set_limits": {
            "max_speed_rpm": OPTIONAL_POSITIVE,
            "min_speed_rpm": OPTIONAL_POSITIVE,
            "max_acceleration": OPTIONAL_POSITIVE,
        },
        "reset_limits": {},
        "stop_at_program_end": {"enabled": SWITCH},
        "couple": {"master": TEXT, "factor_num": OPTIONAL_NUMBER, "factor_den": OPTIONAL_NUMBER, **OWNER},
        "coupling_answer": {"granted": SWITCH, "reason": TEXT},
        "decouple": {**OWNER},
        "follow_path": SOURCE,
        "leave_path": {"travel": OPTIONAL_NUMBER, **SOURCE},
        "set_feedforward": FEEDFORWARD,
        "reset_feedforward": {},
        "reset": {},
        "overlay": OVERLAY,
        "set_emergency_stop": {"enabled": SWITCH},
        "upstream_lost": SOURCE,
    },
    "channel": {
        "load": {
            "program": TEXT,
            "text": OPTIONAL_TEXT,
            "files": Argument("files", required=False),
            "dialect": DIALECT,
        },
        "start": {
            "line": OPTIONAL_COUNT,
            "block_number": OPTIONAL_COUNT,
            "in_program": OPTIONAL_TEXT,
            "pass_number": OPTIONAL_COUNT,
        },
        "feed_hold": {"enabled": SWITCH},
        "set_override": {"percent": NUMBER},
        "single_block": {"enabled": SWITCH, "mode": Argument("text", required=False, choices=("block", "motion"))},
        "optional_stop": {"enabled": SWITCH},
        "block_skip": {"enabled": SWITCH, "level": OPTIONAL_COUNT},
        "reset": {},
        "mdi": {"text": TEXT, "files": Argument("files", required=False)},
        "acknowledge": {"id": UINT64},
        "measuring_event": {},
        "set_zero_offset": {"index": UINT32, "axis": TEXT, "value": NUMBER},
        "teach_zero_offset": {"index": UINT32, "axis": OPTIONAL_TEXT, "value": OPTIONAL_NUMBER},
        "set_clamp_position": {"index": UINT32},
        "overlay": OVERLAY,
        "set_emergency_stop": {"enabled": SWITCH},
        "upstream_lost": SOURCE,
    },
    "plc": {
        "acknowledge": {"id": UINT64},
        "auto_acknowledge": {"enabled": SWITCH},
        "set_life_sign": {"enabled": SWITCH},
        "set_input": {"name": TEXT, "value": NUMBER},
        "serve": {"unit": TEXT, "enabled": SWITCH},
        "follow_trajectory": {
            "axes": ROWS,
            "points": ROWS,
            "path_tolerance": OPTIONAL_ROWS,
            "goal_tolerance": OPTIONAL_ROWS,
            "goal_time": OPTIONAL_NUMBER,
        },
        "emergency_stop": {"enabled": SWITCH},
        "reset": {},
        "stop_all": {},
        "abort": {"reason": TEXT},
        "upstream_lost": SOURCE,
    },
}
COUPLINGS = frozenset({"couple", "couple_gantry", "couple_cyclic", "couple_flying_saw", "couple_cam"})
"""Commands that make a slave of an axis."""
HELD_OFF: Mapping[str, frozenset[str]] = {
    "axis": frozenset(
        {
            "move_absolute",
            "move_relative",
            "move_modulo",
            "move_additive",
            "move_velocity",
            "move_superimposed",
            "new_target",
            "new_velocity_and_target",
            "compensation_start",
            "jog",
            "home",
            "external_enable",
            "begin_trajectory",
        }
    )
    | COUPLINGS,
    "spindle": frozenset({"start", "set_speed", "orient", "home", "select_gear", "couple", "follow_path"}),
    "channel": frozenset(),
    "plc": frozenset(),
}
"""Kind of unit -> commands that a held stop (`hold_stop`) refuses, whoever gives them."""
INTERNAL = frozenset(
    {
        "upstream_lost",
        "abort",
        "begin_trajectory",
        "lead",
        "group_error",
        "coupling_answer",
        "set_homing_override",
        "set_emergency_stop",
        "follow_path",
        "leave_path",
    }
)
"""Commands that only watchdogs, harnesses and other units give; a scenario may not."""
READING = frozenset({"read_drive_parameter"})
"""Commands whose message is what was asked for, and no warning."""
THROUGH_PLC = COUPLINGS | {"change_cam", "external_setpoints"}
"""Commands of axes that go through the PLC: it sees all axes, and sends setpoints with the blocks of their cycles."""
NEEDS_SOMETHING = {"set_limits": "reset_limits takes the limits away"}
"""Commands that would release something when nothing is given, and how to do so explicitly."""
OF_PLC = frozenset({"above", "master_stands", "master_start", "master_lost"})
"""Arguments of couplings that the PLC fills in; only a refusal can come of them, so that they are not recorded."""
OF_CHANNELS = frozenset({"own", "homes", "owner", "by_path"})
"""Arguments that only channels give; neither services nor scenarios have them."""

FILE_CONTENTS = frozenset({"table", "setpoints"})
"""Arguments that a file may hold: its reader gives them instead of `file`."""

FORMER_NAMES = {"on": "enabled"}
"""Arguments with a former name: scenarios and recordings may still use it. (`on:` is true to YAML 1.1.)"""

TYPES = {
    "number": (int, float),
    "integer": int,
    "switch": bool,
    "text": str,
    "rows": list,
    "files": dict,
    "source": str,
}

INTEGER_RANGES = {"int64": (-(2**63), 2**63 - 1)} | {f"uint{bits}": (0, 2**bits - 1) for bits in (8, 32, 64)}
"""Type of a field -> least and largest integer that it holds."""

TYPE_TEXTS = {"integer": "an integer", "rows": "a list of rows", "files": "texts by file name"}
"""What an argument must be, where its kind with an article is no English."""


def current_names(kind: str, command: str, arguments: Mapping[str, Any]) -> dict[str, Any]:
    """The arguments with today's names; one that is given under both names keeps the former, and is refused then."""
    known = COMMANDS[kind].get(command, {})
    renamed = {old: new for old, new in FORMER_NAMES.items() if new in known and new not in arguments}
    return {renamed.get(name, name): value for name, value in arguments.items()}


def check_command(
    kind: str, unit: str, command: str, arguments: Mapping[str, Any], sources: Collection[str] = ()
) -> None:
    """Raises CncError (22001 argument, 22002 command) when a unit of `kind` cannot understand the command.

    `sources`: who may command a spindle of this machine; without them every name is accepted.
    """
    specification = COMMANDS[kind].get(command)
    if specification is None:
        known = sorted(set(COMMANDS[kind]) - INTERNAL)
        others = [other for other in COMMANDS if command in COMMANDS[other] and command not in INTERNAL]
        of_others = f"; it is a command of {' and '.join(SEVERAL[other] for other in others)}"
        hint = of_others if others else nearest_name(command, known)
        raise CncError(
            UNKNOWN_COMMAND,
            f"unknown command '{command}'{hint}",
            f"nothing was changed. Known: {', '.join(known)}",
            where=f"{kind} {unit}",
            command=command,
        )
    check_arguments(f"{kind} {unit}: {command} refused", specification, arguments, sources)


def with_floats(kind: str, command: str, arguments: Mapping[str, Any]) -> dict[str, Any]:
    """Arguments that have been checked, with all numbers as floats, whatever a scenario or a message has written."""
    specification = COMMANDS[kind][command]
    return {
        name: float(value) if specification[name].kind == "number" and is_integer(value) else value
        for name, value in arguments.items()
    }


def is_integer(value: Any) -> bool:
    """True for an integer within the range of floating point numbers; a switch is none."""
    return isinstance(value, int) and not isinstance(value, bool) and is_finite(value)


def check_arguments(
    where: str, specification: Arguments, arguments: Mapping[str, Any], sources: Collection[str] = ()
) -> None:
    """Raises CncError 22001 for an argument that is unknown, missing or not permitted; `where` begins the text."""
    for name in arguments:
        if name not in specification:
            known = ", ".join(known for known in specification if known not in OF_PLC) or "none"
            raise _bad(where, name, f"unknown argument '{name}'", f"nothing was changed. Known: {known}")
    if "file" in arguments:
        for name in FILE_CONTENTS.intersection(arguments):
            raise _bad(where, name, f"'{name}' and 'file' are both given", "nothing was changed. Give one")
    for name, argument in specification.items():
        if name in arguments:
            _check_argument(where, name, argument, arguments[name])
            if argument.kind == "source":
                _check_source(where, arguments[name], sources)
        elif argument.required:
            raise _bad(where, name, f"argument '{name}' is missing")


def check_sendable(where: str, specification: Arguments, arguments: Mapping[str, Any]) -> None:
    """Raises CncError 22001 for what a service would take for something else.

    A 0 that makes no sense is left out there, an integer beyond its field wraps around, texts are of UTF-8 only.
    """
    for name, value in arguments.items():
        if specification[name].kind == "integer":
            low, high = INTEGER_RANGES[specification[name].field]
            if not low <= value <= high:
                reason = f"{name} = {value} is not within {low} ... {high}"
                raise CncError(BAD_ARGUMENT, reason, "nothing was sent", where=where)
        if specification[name].positive and value == 0.0:
            raise CncError(BAD_ARGUMENT, f"{name} = 0 must be greater than 0", "nothing was sent", where=where)
        if isinstance(value, str) and value != value.encode(errors="ignore").decode():
            raise CncError(BAD_ARGUMENT, f"{name} is no text in UTF-8", "nothing was sent", where=where)


def _check_argument(where: str, name: str, argument: Argument, value: Any) -> None:
    if argument.lenient:
        return
    is_type = isinstance(value, TYPES[argument.kind])  # type: ignore[arg-type]
    wanted = TYPE_TEXTS.get(argument.kind, f"a {argument.kind}")
    if not is_type or (isinstance(value, bool) and argument.kind != "switch"):
        raise _bad(where, name, f"{name} = {value!r} is not {wanted}")
    if argument.kind == "number" and not is_finite(value):
        shown = value if isinstance(value, float) else "an integer that long"
        raise _bad(where, name, f"{name} = {shown} is not finite")
    if argument.choices and value not in argument.choices:
        allowed = " or ".join(filter(None, (", ".join(argument.choices[:-1]), argument.choices[-1])))
        raise _bad(where, name, f"{name} = '{value}' is not {allowed}")


def _bad(where: str, argument: str, reason: str, effect: str = "nothing was changed") -> CncError:
    return CncError(BAD_ARGUMENT, reason, effect, where=where, argument=argument)


def sources_of(kinds: Mapping[str, str]) -> list[str]:
    """Who may command a spindle: PLC and channels of the machine, from unit name -> kind."""
    return [unit for unit, kind in kinds.items() if kind in ("plc", "channel")]


def _check_source(where: str, source: str, sources: Collection[str]) -> None:
    if source and sources and source not in sources:
        known = ", ".join(sources)
        raise _bad(where, "source", f"unknown source '{source}'", f"nothing was changed. Known: {known}")


def is_finite(value: Any) -> bool:
    """False for NaN, infinities and integers beyond the range of floating point numbers."""
    try:
        return math.isfinite(value)
    except OverflowError:
        return False
