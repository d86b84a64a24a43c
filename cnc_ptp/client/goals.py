"""When an endless job does what was commanded."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import Any

from cnc_ptp.protocol.axis_states import AxisStateCode, StatusBit
from cnc_ptp.protocol.blocks import AxisBlock, CycleBlock, SpindleBlock

Blocks = Mapping[str, CycleBlock]
Goal = Callable[[Blocks, str, Mapping[str, Any]], bool]
"""Newest blocks, unit, arguments of its command."""
TOLERANCE = 1e-6
"""mm, deg, mm/s, deg/s: a flying saw runs with its master."""


def turns(blocks: Blocks, unit: str, arguments: Mapping[str, Any]) -> bool:
    """The spindle has reached its commanded speed (P-AXIS-00217), in its gear."""
    block = blocks[unit]
    return (
        isinstance(block, SpindleBlock)
        and block.state[-1] == AxisStateCode.CONTINUOUS_MOTION
        and block.speed_reached[-1]
        and not block.gear_change_active[-1]
    )


def moves(blocks: Blocks, unit: str, arguments: Mapping[str, Any]) -> bool:
    """The axis moves endlessly at a constant velocity."""
    block = blocks[unit]
    is_endless = isinstance(block, AxisBlock) and block.state[-1] == AxisStateCode.CONTINUOUS_MOTION
    return is_endless and has_bit(block, StatusBit.CONSTANT_VELOCITY)


def has_velocity(blocks: Blocks, unit: str, arguments: Mapping[str, Any]) -> bool:
    """The axis moves at a constant velocity; at velocity 0 it has come to rest."""
    block = blocks[unit]
    if arguments["velocity"] or not isinstance(block, AxisBlock):
        return moves(blocks, unit, arguments)
    rests = block.set_velocity[-1] == block.set_acceleration[-1] == 0.0
    return rests and has_state(block, AxisStateCode.CONTINUOUS_MOTION)


def follows(blocks: Blocks, unit: str, arguments: Mapping[str, Any]) -> bool:
    """The axis is a slave."""
    block = blocks[unit]
    is_slave = isinstance(block, AxisBlock) and block.master == arguments["master"]
    return is_slave and has_state(block, AxisStateCode.SYNCHRONIZED_MOTION)


def runs_with_master(blocks: Blocks, unit: str, arguments: Mapping[str, Any]) -> bool:
    """A flying saw is at its synchronous position and velocity, in the newest cycle that both have told of."""
    block, master = blocks[unit], blocks.get(arguments["master"])
    if not isinstance(block, AxisBlock) or not isinstance(master, AxisBlock) or not follows(blocks, unit, arguments):
        return False
    index = master.first_cycle + master.count - 1 - block.first_cycle
    if not 0 <= index < block.count:
        return False
    factor = arguments["factor"]
    place = arguments["slave_position"] + factor * (master.set_position[-1] - arguments["master_position"])
    off = abs(block.set_position[index] - place), abs(block.set_velocity[index] - factor * master.set_velocity[-1])
    return bool(max(off) <= TOLERANCE)


def takes_setpoints(blocks: Blocks, unit: str, arguments: Mapping[str, Any]) -> bool:
    """External setpoints are enabled."""
    return has_bit(blocks[unit], StatusBit.EXT_SETPOINT)


def has_bit(block: CycleBlock, bit: StatusBit) -> bool:
    return isinstance(block, AxisBlock) and bool(block.status_bits[-1] & bit)


def has_state(block: CycleBlock, state: AxisStateCode) -> bool:
    return isinstance(block, AxisBlock) and block.state[-1] == state


GOALS: Mapping[tuple[str, str], Goal] = {
    ("spindle", "start"): turns,
    ("spindle", "set_speed"): turns,
    ("axis", "move_velocity"): has_velocity,
    ("axis", "jog"): moves,
    ("axis", "decouple"): moves,
    ("axis", "couple"): follows,
    ("axis", "couple_gantry"): follows,
    ("axis", "couple_cyclic"): follows,
    ("axis", "couple_cam"): follows,
    ("axis", "couple_flying_saw"): runs_with_master,
    ("axis", "external_enable"): takes_setpoints,
}
"""Kind of unit and command -> when its job has reached what was commanded. All others are waited for to their end."""
