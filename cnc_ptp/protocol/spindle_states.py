"""Modes and status bits of a spindle, as PLC and recordings see them (SpindleState.msg)."""

from __future__ import annotations

from enum import IntEnum


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
