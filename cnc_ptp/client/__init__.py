"""A machine for programs, tests and notebooks: offline or as a ROS graph, with the same calls (docs/client.md).

The function blocks of PLCopen take its axes and spindles: `MC_MoveAbsolute(m.x)`, called once in `m.plc_cycles()`.
"""

from cnc_ptp.client.faults import UnknownUnit
from cnc_ptp.client.job import Answer, Job, ProgramJob
from cnc_ptp.client.machine import Machine
from cnc_ptp.client.recorder import Recorder
from cnc_ptp.client.several_jobs import TrajectoryJob
from cnc_ptp.client.states import AxisState, ChannelState, SpindleState
from cnc_ptp.client.stream import Stream
from cnc_ptp.client.units import Axis, Channel, Plc, Spindle
from cnc_ptp.errors import CncError
from cnc_ptp.plc.plcopen import (
    MC_CamIn,
    MC_CamOut,
    MC_ExtSetPointGenDisable,
    MC_ExtSetPointGenEnable,
    MC_ExtSetPointGenFeed,
    MC_GearIn,
    MC_GearOut,
    MC_Halt,
    MC_Home,
    MC_MoveAbsolute,
    MC_MoveAdditive,
    MC_MoveModulo,
    MC_MoveRelative,
    MC_MoveSuperimposed,
    MC_MoveVelocity,
    MC_OrientSpindle,
    MC_Power,
    MC_ReadAxisError,
    MC_ReadParameter,
    MC_ReadStatus,
    MC_Reset,
    MC_SetOverride,
    MC_SetPosition,
    MC_Stop,
    MC_WriteParameter,
)
from cnc_ptp.protocol.axis_states import AxisStateCode, StatusBit
from cnc_ptp.protocol.blocks import Event, HandshakeRequest
from cnc_ptp.protocol.channel_states import ChannelStateCode
from cnc_ptp.protocol.jobs import JobStatus
from cnc_ptp.protocol.spindle_states import SpindleBit, SpindleMode
from cnc_ptp.recording.recorder_options import RecorderOptions

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
    "MC_CamIn",
    "MC_CamOut",
    "MC_ExtSetPointGenDisable",
    "MC_ExtSetPointGenEnable",
    "MC_ExtSetPointGenFeed",
    "MC_GearIn",
    "MC_GearOut",
    "MC_Halt",
    "MC_Home",
    "MC_MoveAbsolute",
    "MC_MoveAdditive",
    "MC_MoveModulo",
    "MC_MoveRelative",
    "MC_MoveSuperimposed",
    "MC_MoveVelocity",
    "MC_OrientSpindle",
    "MC_Power",
    "MC_ReadAxisError",
    "MC_ReadParameter",
    "MC_ReadStatus",
    "MC_Reset",
    "MC_SetOverride",
    "MC_SetPosition",
    "MC_Stop",
    "MC_WriteParameter",
    "Machine",
    "Plc",
    "ProgramJob",
    "Recorder",
    "RecorderOptions",
    "Spindle",
    "SpindleBit",
    "SpindleMode",
    "SpindleState",
    "StatusBit",
    "Stream",
    "TrajectoryJob",
    "UnknownUnit",
]
