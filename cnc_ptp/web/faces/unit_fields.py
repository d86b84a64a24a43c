"""The state of units as pages show it, from their newest blocks."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from cnc_ptp.protocol.axis_states import AxisStateCode, state_name
from cnc_ptp.protocol.blocks import AxisBlock, ChannelBlock, CycleBlock, SpindleBlock
from cnc_ptp.protocol.channel_states import ChannelStateCode
from cnc_ptp.protocol.spindle_states import SpindleMode

DECIMALS = 6
"""Of positions and velocities: 1 nm is more than anybody sees, and shorter to send."""
SECONDS_PER_MINUTE = 60.0


def shown(value: float) -> float:
    return round(value, DECIMALS)


def axis_fields(block: AxisBlock) -> dict[str, Any]:
    """mm, mm/s … of a linear, deg, deg/s … of a rotary axis."""
    return {
        "state": state_name(AxisStateCode(block.state[-1])),
        "set_position": shown(block.set_position[-1]),
        "actual_position": shown(block.actual_position[-1]),
        "set_velocity": shown(block.set_velocity[-1]),
        "velocity": shown(block.actual_velocity[-1]),
        "set_acceleration": shown(block.set_acceleration[-1]),
        "following_error": shown(block.following_error[-1]),
        "command_velocity": shown(block.command_velocity[-1]),
        "torque": shown(block.actual_torque[-1]),
        "torque_digits": shown(block.actual_torque[-1] * block.torque_digits),
        "target_velocity": shown(block.target_velocity),
        "override": block.override_percent[-1],
        "feedforward": block.feedforward_percent[-1],
        "status_bits": block.status_bits[-1],
        "master": block.master,
        "job": block.job,
        "error": block.error_id[-1],
    }


def spindle_fields(block: SpindleBlock) -> dict[str, Any]:
    """rpm, deg."""
    return {
        "state": state_name(AxisStateCode(block.state[-1])),
        "set_speed": shown(block.set_speed_rpm[-1]),
        "speed": shown(block.actual_speed_rpm[-1]),
        "programmed_speed": shown(block.programmed_speed_rpm[-1]),
        "set_position": shown(block.set_position_deg[-1]),
        "actual_position": shown(block.actual_position_deg[-1]),
        "distance_to_go": shown(block.distance_to_go_deg[-1]),
        "following_error": shown(block.following_error_deg[-1]),
        "override": block.override_percent[-1],
        "gear": block.gear[-1],
        "modes": [mode.name.lower() for mode in SpindleMode if mode.name and block.mode[-1] & mode],
        "speed_reached": bool(block.speed_reached[-1]),
        "speed_zero": bool(block.speed_zero[-1]),
        "in_position": bool(block.in_position[-1]),
        "referenced": bool(block.referenced[-1]),
        "gear_change_active": bool(block.gear_change_active[-1]),
        "status_bits": block.status_bits[-1],
        "master": block.master,
        "job": block.job,
        "error": block.error_id[-1],
    }


def channel_fields(block: ChannelBlock) -> dict[str, Any]:
    """mm, mm/min."""
    return {
        "state": ChannelStateCode(block.state[-1]).name.lower(),
        "active": not block.done,
        "line": block.line[-1],
        "block_number": block.block_number[-1],
        "feed": shown(block.path_velocity[-1] * SECONDS_PER_MINUTE),
        "programmed_feed": shown(block.programmed_feed[-1] * SECONDS_PER_MINUTE),
        "override": block.override_percent[-1],
        "distance_to_go": shown(block.distance_to_go[-1]),
        "blocks_done": block.blocks_done,
        "blocks_total": block.blocks_total,
        "progress": round(block.progress, 4),
        "time_left": round(block.time_left, 1),
        "job": block.job,
        "error": block.error_id[-1],
    }


def path_fields(block: ChannelBlock) -> dict[str, dict[str, Any]]:
    """Axis of a channel -> work position (as programs name it) and distance to go in the active block.

    The distance of an axis is its part of the path's: exact on a line, along the tangent on an arc. None while the path
    stands within a block: it does not say where it leads (distances.py).
    """
    axes: dict[str, dict[str, Any]] = {}
    velocity, distance = block.path_velocity[-1], block.distance_to_go[-1]
    for index, (axis, position) in enumerate(zip(block.axes, block.programmed_position, strict=False)):
        left: float | None = 0.0
        if distance > 0.0:
            speed = block.set_velocity[(index + 1) * block.count - 1]
            left = shown(speed / velocity * distance) if velocity > 0.0 else None
        axes[axis] = {"work_position": shown(position), "distance_to_go": left}
    return axes


def unit_states(blocks: Mapping[str, CycleBlock]) -> dict[str, dict[str, Any]]:
    """Unit -> fields; the plc has its life sign and whether its run has ended."""
    states: dict[str, dict[str, Any]] = {}
    of_paths: dict[str, dict[str, Any]] = {}
    for unit, block in blocks.items():
        if isinstance(block, AxisBlock):
            states[unit] = axis_fields(block)
        elif isinstance(block, SpindleBlock):
            states[unit] = spindle_fields(block)
        elif isinstance(block, ChannelBlock):
            states[unit] = channel_fields(block)
            of_paths |= path_fields(block)
        else:
            states[unit] = {"scenario_done": block.scenario_done, "run_done": block.run_done}
    for axis, fields in of_paths.items():
        states.get(axis, {}).update(fields)
    return states
