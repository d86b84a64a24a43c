"""A machine for programs, tests and notebooks: offline or as a ROS graph, with the same calls (docs/client.md)."""

from cnc_ptp.client.faults import UnknownUnit
from cnc_ptp.client.job import Answer, Job, ProgramJob
from cnc_ptp.client.machine import Machine
from cnc_ptp.client.states import AxisState, ChannelState, SpindleState
from cnc_ptp.client.stream import Stream
from cnc_ptp.client.units import Axis, Channel, Plc, Spindle
from cnc_ptp.errors import CncError
from cnc_ptp.protocol.axis_states import AxisStateCode, StatusBit
from cnc_ptp.protocol.blocks import Event, HandshakeRequest
from cnc_ptp.protocol.channel_states import ChannelStateCode
from cnc_ptp.protocol.jobs import JobStatus
from cnc_ptp.protocol.spindle_states import SpindleBit, SpindleMode

__all__ = [
    "Answer",
    "Axis",
    "AxisState",
    "AxisStateCode",
    "Channel",
    "ChannelState",
    "ChannelStateCode",
    "CncError",
    "Event",
    "HandshakeRequest",
    "Job",
    "JobStatus",
    "Machine",
    "Plc",
    "ProgramJob",
    "Spindle",
    "SpindleBit",
    "SpindleMode",
    "SpindleState",
    "StatusBit",
    "Stream",
    "UnknownUnit",
]
