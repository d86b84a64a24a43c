"""States of the NC channel, as PLC and recordings see them."""

from __future__ import annotations

from enum import IntEnum
from typing import Final


class ChannelStateCode(IntEnum):
    """States of the NC channel (ChannelState.msg)."""

    IDLE = 0
    READY = 1
    RUNNING = 2
    HOLD = 3
    WAITING = 4
    STOPPED = 5
    STOPPING = 6
    ERROR = 7


IN_PROGRAM: Final = (
    ChannelStateCode.RUNNING,
    ChannelStateCode.HOLD,
    ChannelStateCode.WAITING,
    ChannelStateCode.STOPPED,
    ChannelStateCode.STOPPING,
)
"""A program is being executed; waiting is a part of its time."""
