"""Modes and status bits of a spindle, as PLC and recordings see them (SpindleState.msg)."""

from __future__ import annotations

from enum import IntEnum

from cnc_ptp.protocol.axis_states import AxisStateCode
from cnc_ptp.protocol.blocks import SpindleBlock


class SpindleMode(IntEnum):
    """HLI mode bits of a spindle."""

    STOP = 1
    CW = 2
    CCW = 4
    POSITION = 8
    SUPERIMPOSED = 16
    HOMING = 32


class SpindleBit(IntEnum):
    """Bits of SpindleState.status_bits."""

    POSITION_CONTROL = 1 << 0
    VELOCITY_CONTROL = 1 << 1
    MONITORING_ACTIVE = 1 << 2
    MONITORING_INVALID = 1 << 3
    OVERRIDE_SUPPRESSED = 1 << 4
    STOP_AT_PROGRAM_END = 1 << 5
    TOOL_LIMITS = 1 << 6
    JOB_ERROR = 1 << 7
    ORDERS_WAIT = 1 << 8
    """Commands wait for their turn."""
    ON_PATH = 1 << 9
    """The path of a channel moves it."""
    FEED_HOLD = 1 << 10
    """The feed hold of the HLI stops it."""


def held_by_override(block: SpindleBlock) -> bool:
    """The spindle is to move at the end of its block, and is at a standstill because of override 0 or a feed hold."""
    feed_hold = bool(block.status_bits[-1] & SpindleBit.FEED_HOLD)
    if block.status_bits[-1] & SpindleBit.OVERRIDE_SUPPRESSED and not feed_hold:
        return False
    turns_on = block.state[-1] == AxisStateCode.CONTINUOUS_MOTION
    moves = turns_on or (block.state[-1] == AxisStateCode.DISCRETE_MOTION and block.distance_to_go_deg[-1] != 0.0)
    stopped = feed_hold or block.override_percent[-1] == 0.0
    return moves and stopped and block.set_speed_rpm[-1] == 0.0
