"""The state of a unit in one cycle, with the fields of the recording (msg/AxisState.msg and its like say more)."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import Any, NamedTuple

import numpy as np

from cnc_ptp.protocol.axis_states import AxisStateCode
from cnc_ptp.protocol.blocks import AxisBlock, ChannelBlock, CycleBlock, SpindleBlock
from cnc_ptp.protocol.channel_states import ChannelStateCode
from cnc_ptp.recording.blocks import within_modulo


class AxisState(NamedTuple):
    """An axis in one cycle; mm, mm/s, … for linear axes, deg, deg/s, … for rotary axes."""

    cycle: int
    set_position: float
    set_velocity: float
    set_acceleration: float
    set_jerk: float
    actual_position: float
    actual_velocity: float
    following_error: float
    command_velocity: float
    feedforward_velocity: float
    additive_velocity: float
    additive_torque: float
    friction_current: float
    actual_torque: float
    actual_torque_digits: float
    override_percent: float
    feedforward_percent: float
    set_position_modulo: float
    actual_position_modulo: float
    set_direction: int
    state: AxisStateCode
    status_bits: int
    """Bits of `StatusBit`."""
    error_id: int
    """0: no error."""


class SpindleState(NamedTuple):
    """A spindle in one cycle; rpm, deg."""

    cycle: int
    set_speed_rpm: float
    actual_speed_rpm: float
    programmed_speed_rpm: float
    set_acceleration_deg_s2: float
    set_position_deg: float
    actual_position_deg: float
    target_position_deg: float
    distance_to_go_deg: float
    following_error_deg: float
    override_percent: float
    feedforward_percent: float
    drive_output: int
    mode: int
    """Bits of `SpindleMode`."""
    gear: int
    speed_reached: bool
    speed_zero: bool
    in_position: bool
    referenced: bool
    gear_change_active: bool
    status_bits: int
    """Bits of `SpindleBit`."""
    state: AxisStateCode
    error_id: int


class ChannelState(NamedTuple):
    """A channel in one cycle; mm, mm/s."""

    cycle: int
    line: int
    block_number: int
    path_velocity: float
    programmed_feed: float
    override_percent: float
    distance_to_go: float
    state: ChannelStateCode
    error_id: int


def axis_state(block: AxisBlock, index: int) -> AxisState:
    """`index` of the cycle in the block, as in a list."""
    velocity = block.set_velocity[index]
    derived = {
        "set_position_modulo": _modulo(block, block.set_position[index]),
        "actual_position_modulo": _modulo(block, block.actual_position[index]),
        "actual_torque_digits": block.actual_torque[index] * block.torque_digits,
        "set_direction": (velocity > 0.0) - (velocity < 0.0),
        "state": AxisStateCode(block.state[index]),
    }
    return AxisState(**_columns(AxisState, block, index, derived))


def spindle_state(block: SpindleBlock, index: int) -> SpindleState:
    """As axis_state."""
    return SpindleState(**_columns(SpindleState, block, index, {"state": AxisStateCode(block.state[index])}))


def channel_state(block: ChannelBlock, index: int) -> ChannelState:
    """As axis_state."""
    return ChannelState(**_columns(ChannelState, block, index, {"state": ChannelStateCode(block.state[index])}))


def _columns(kind: Any, block: CycleBlock, index: int, derived: Mapping[str, Any]) -> dict[str, Any]:
    """The fields of a state: the derived ones, the others from the block."""
    cycle = block.first_cycle + range(block.count)[index]
    known = {"cycle": cycle, **derived}
    return {name: known[name] if name in known else getattr(block, name)[index] for name in kind._fields}


def _modulo(block: AxisBlock, position: float) -> float:
    """As recordings have it, to the bit."""
    values = (np.array([value]) for value in (position, block.modulo_begin, block.modulo_length))
    return float(within_modulo(*values)[0])


STATES: Mapping[str, Callable[[Any, int], Any]] = {
    "axis": axis_state,
    "spindle": spindle_state,
    "channel": channel_state,
}
"""Kind of unit -> the state of a block at an index."""
