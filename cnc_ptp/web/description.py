"""The units of a machine for pages: kinds, units of length, limits."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from math import isfinite
from typing import Any

from cnc_ptp.parameters import ParameterSet
from cnc_ptp.parameters.view.axis_view import axis_view
from cnc_ptp.protocol.commands import COMMANDS, INTERNAL, OF_CHANNELS, OF_PLC, Argument
from cnc_ptp.web.rights import NOT_FROM_PAGE_ARGUMENTS, refused_from_pages


def describe_units(
    kinds: Mapping[str, str], parameters_of: Callable[[str], ParameterSet], cycle_time: float
) -> list[dict[str, Any]]:
    """`cycle_time` in s. Limits in mm, mm/s … or deg, deg/s …; of spindles none."""
    return [
        {"name": unit, "kind": kind, **(axis_limits(parameters_of(unit), cycle_time) if kind == "axis" else {})}
        for unit, kind in kinds.items()
    ]


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
        },
    }


def describe_commands() -> dict[str, dict[str, Any]]:
    """Kind of unit -> command -> arguments, of those that pages may give: kind, whether required, choices."""
    return {
        kind: {
            command: {
                name: describe_argument(argument)
                for name, argument in arguments.items()
                if name not in OF_PLC | OF_CHANNELS | NOT_FROM_PAGE_ARGUMENTS
            }
            for command, arguments in commands.items()
            if command not in INTERNAL and not refused_from_pages(kind, command)
        }
        for kind, commands in COMMANDS.items()
    }


def describe_argument(argument: Argument) -> dict[str, Any]:
    return {"kind": argument.kind, "required": argument.required, "choices": list(argument.choices)}
