"""What nodes need, imported once: processes that are forked from the one that did this share its memory.

Nothing here starts ROS, a thread, or handles a signal: a process that is forked would inherit half of it. Two threads
of LTTng, which comes with the wheels of ROS, are there as soon as rclpy is loaded. They sleep until somebody traces,
hold no lock meanwhile, and are not inherited.
"""

import gc
import threading

import rclpy
from rclpy.type_support import check_for_type_support

from cnc_ptp import msg
from cnc_ptp.nodes import axis, clock, nc_channel, plc_bridge, recorder, spindle
from cnc_ptp.nodes.topics import BLOCK_TYPES, COUPLING_SERVICES, PLC_TOPICS, SERIES_SERVICES, SERVICES, STATE_TYPES
from cnc_ptp.state.machine_state import kernel_digest

MODULES = (axis, clock, nc_channel, plc_bridge, recorder, spindle)
MESSAGES = {
    *(msg.CycleTick, msg.BlockReport, msg.Event, msg.CommandRecord, msg.LatenessHistogram, msg.HandshakeRequest),
    *(msg.DriveStop, msg.UnitCheckpoint),
    *(*BLOCK_TYPES.values(), *STATE_TYPES.values(), *COUPLING_SERVICES.values(), *SERIES_SERVICES.values()),
    *(message_type for group in (*PLC_TOPICS.values(), *SERVICES.values()) for message_type in group.values()),
}


def require_nothing_started() -> None:
    """Raises RuntimeError in a process that cannot be forked without harm."""
    if rclpy.ok():
        raise RuntimeError("ROS has been started in the process that node processes are to be forked from")
    if threading.active_count() > 1:
        raise RuntimeError("a thread runs in the process that node processes are to be forked from")


for message_type in MESSAGES:
    check_for_type_support(message_type)
require_nothing_started()
kernel_digest()
gc.collect()
gc.freeze()  # pages with what is never collected stay shared
