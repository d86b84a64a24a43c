"""The units of a machine for pages: kinds, units of length, limits."""

from __future__ import annotations

import re
from collections.abc import Mapping
from math import isfinite
from pathlib import Path
from typing import Any

from cnc_ptp.parameters import ParameterSet
from cnc_ptp.parameters.declare import ids
from cnc_ptp.parameters.list_units import DEG_S_PER_RPM
from cnc_ptp.parameters.view.axis_view import axis_view, is_facing
from cnc_ptp.parameters.view.channel_view import channel_view
from cnc_ptp.parameters.view.gears import active_gear
from cnc_ptp.parameters.view.spindle_view import spindle_view
from cnc_ptp.protocol.command_help import ArgumentText, argument_text
from cnc_ptp.protocol.commands import COMMANDS, INTERNAL, OF_CHANNELS, OF_PLC, Argument
from cnc_ptp.web.access.rights import NOT_FROM_PAGE_ARGUMENTS, refused_from_pages

LINK = re.compile(r" ?\(\[[^\]]*\]\([^)]*\)\)|\[([^\]]*)\]\([^)]*\)")
"""To another document: one in brackets is left out, of another one its text stays."""


def describe_units(
    kinds: Mapping[str, str], sets: Mapping[str, ParameterSet], cycle_time: float
) -> list[dict[str, Any]]:
    """`sets`: parameters by unit; `cycle_time` in s. Limits in mm, mm/s … or deg, deg/s …; of spindles in rpm."""
    described = {"axis": axis_limits, "spindle": spindle_limits}
    units = []
    for unit, kind in kinds.items():
        fields = described[kind](sets[unit], cycle_time) if kind in described else {}
        if kind == "channel":
            fields = channel_members(sets[unit], sets)
        units.append({"name": unit, "kind": kind, **fields})
    return units


def channel_members(channel: ParameterSet, sets: Mapping[str, ParameterSet]) -> dict[str, Any]:
    """Axes by unit and by their names in programs, spindles; whether it turns."""
    view = channel_view(channel, sets, Path())
    facing = [unit for unit in (axis.node for axis in view.axes) if unit in sets and is_facing(sets[unit])]
    return {
        "axes": [{"unit": axis.node, "name": axis.name} for axis in view.axes],
        "spindles": [spindle.node for spindle in view.spindles if spindle.node],
        "turning": bool(facing),
        "limits": {"override": view.max_override_percent},
    }


def spindle_limits(parameters: ParameterSet, cycle_time: float) -> dict[str, Any]:
    spindle = spindle_view(parameters, cycle_time)
    speed = max(gear.max_speed for gear in spindle.gears.values()) / DEG_S_PER_RPM
    return {"limits": {"speed": speed, "gears": [*spindle.gears], "override": spindle.max_override_percent}}


def axis_limits(parameters: ParameterSet, cycle_time: float) -> dict[str, Any]:
    axis = axis_view(parameters, cycle_time)
    soft = (axis.soft_limit_negative, axis.soft_limit_positive)
    return {
        "rotary": axis.rotary,
        "unit": "deg" if axis.rotary else "mm",
        "modulo": axis.modulo,
        "facing": axis.facing,
        "limits": {
            "positions": [limit if isfinite(limit) else None for limit in soft],
            "velocity": axis.max_velocity,
            "reference_velocity": axis.reference_velocity,
            "rapid": axis.rapid_velocity,
            "acceleration": axis.max_acceleration,
            "jerk": axis.jerk,
            "override": axis.max_override_percent,
            "position_window": axis.position_window,
            "kv": parameters.kernel(ids.GETRIEBE_KV, active_gear(parameters)),
        },
    }


def describe_commands() -> dict[str, dict[str, Any]]:
    """Kind of unit -> command -> arguments, of those that pages may give: kind, whether required, choices, texts."""
    return {
        kind: {
            command: {
                name: describe_argument(argument, argument_text(kind, command, name))
                for name, argument in arguments.items()
                if name not in OF_PLC | OF_CHANNELS | NOT_FROM_PAGE_ARGUMENTS
            }
            for command, arguments in commands.items()
            if command not in INTERNAL and not refused_from_pages(kind, command)
        }
        for kind, commands in COMMANDS.items()
    }


def describe_argument(argument: Argument, text: ArgumentText) -> dict[str, Any]:
    told = {name: plain(value) for name, value in text._asdict().items()}
    return {"kind": argument.kind, "required": argument.required, "choices": list(argument.choices), **told}


def plain(text: str) -> str:
    """Without the marks and links of a document."""
    return LINK.sub(r"\1", text).replace("`", "")
