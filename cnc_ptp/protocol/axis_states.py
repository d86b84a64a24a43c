"""States and status bits of an axis, as PLC and recordings see them."""

from __future__ import annotations

from enum import IntEnum


class AxisStateCode(IntEnum):
    """PLCopen states of axes and spindles (AxisState.msg)."""

    DISABLED = 0
    STANDSTILL = 1
    HOMING = 2
    DISCRETE_MOTION = 3
    CONTINUOUS_MOTION = 4
    SYNCHRONIZED_MOTION = 5
    STOPPING = 6
    ERROR_STOP = 7


REST_STATES = (AxisStateCode.DISABLED, AxisStateCode.STANDSTILL, AxisStateCode.ERROR_STOP)
"""States in which nothing is to move; in ErrorStop the error ramp may still be active."""


class StatusBit(IntEnum):
    """Bits of AxisState.status_bits, numbered as in TwinCAT's axis status word."""

    IN_TARGET_POSITION = 1 << 4
    PROTECTED = 1 << 5
    ERROR_DELAYED = 1 << 6
    HAS_BEEN_STOPPED = 1 << 7
    HAS_JOB = 1 << 8
    CONSTANT_VELOCITY = 1 << 12
    COMPENSATING = 1 << 13
    EXT_SETPOINT = 1 << 14
    FRICTION_COMPENSATION = 1 << 16
    FEED_WITHHELD = 1 << 17
    NOT_REFERENCED = 1 << 18
    COORDINATES_SHIFTED = 1 << 19
    FORWARD_NOT_RELEASED = 1 << 20
    BACKWARD_NOT_RELEASED = 1 << 21
    ERROR = 1 << 31


def state_name(state: IntEnum) -> str:
    """PLCopen spelling: DISCRETE_MOTION -> DiscreteMotion."""
    return "".join(part.capitalize() for part in state.name.split("_"))
