"""Topics, quality of service and message types of the graph: the one place that names them."""

from __future__ import annotations

from typing import Any

from rclpy.qos import QoSDurabilityPolicy, QoSProfile, QoSReliabilityPolicy

from cnc_ptp import msg, srv
from cnc_ptp.protocol.blocks import AxisBlock, ChannelBlock, PlcBlock, SpindleBlock

BLOCKS = QoSProfile(depth=1000, reliability=QoSReliabilityPolicy.RELIABLE)
"""Numbered blocks: nothing is lost while a reader stalls for up to 1000 blocks (10 s at 100 blocks per second)."""

REMEMBERED_BLOCKS = QoSProfile(
    depth=1000, reliability=QoSReliabilityPolicy.RELIABLE, durability=QoSDurabilityPolicy.TRANSIENT_LOCAL
)
"""Blocks of axes and spindles: a slave finds those of the tick in which it was coupled."""

NEWEST_BLOCK = QoSProfile(depth=1, reliability=QoSReliabilityPolicy.RELIABLE)
"""Blocks of which only the newest one counts when somebody looks."""

EVENTS = QoSProfile(
    depth=1000, reliability=QoSReliabilityPolicy.RELIABLE, durability=QoSDurabilityPolicy.TRANSIENT_LOCAL
)
"""Events and command records: late joiners see what has happened."""

LATEST = QoSProfile(depth=1, reliability=QoSReliabilityPolicy.RELIABLE, durability=QoSDurabilityPolicy.TRANSIENT_LOCAL)
"""What changes seldom: late joiners get the newest."""

PLC_INPUT = QoSProfile(depth=10, reliability=QoSReliabilityPolicy.RELIABLE)
"""Cyclic values that PLC programmers write: `ros2 topic pub` works without options."""

PLC_EDGES = QoSProfile(depth=100, reliability=QoSReliabilityPolicy.RELIABLE)
"""Values of which no edge may be lost while the reader stalls: 0.1 s at 1 kHz."""

STATES_OF_UNITS = QoSProfile(depth=100, reliability=QoSReliabilityPolicy.RELIABLE)
"""Checkpoints: one of each unit at a time."""

RECORDER = "recorder"
MONITOR = "run_monitor"
"""Nodes besides the units that report when they are ready."""

TICK = "clock/tick"
REPORT = "clock/report"
HEARTBEAT = "heartbeat"
LATENESS = "lateness"
EVENT = "events"
COMMAND = "commands"
DIAGNOSTICS = "diagnostics"
JOINT_STATES = "joint_states"
DRIVE_STOPS = "drive_stops"
CHECKPOINTS = "checkpoints"
LIFE_SIGN = "plc/life_sign"
ACKNOWLEDGED = "plc/acknowledged"
"""Names are relative: they are in the namespace of the nodes."""

BLOCK_TYPES: dict[str, Any] = {
    "plc": msg.PlcBlock,
    "channel": msg.ChannelBlock,
    "axis": msg.AxisBlock,
    "spindle": msg.SpindleBlock,
}

BLOCK_CLASSES: dict[str, type] = {"plc": PlcBlock, "channel": ChannelBlock, "axis": AxisBlock, "spindle": SpindleBlock}

STATE_TYPES: dict[str, Any] = {"channel": msg.ChannelState, "axis": msg.AxisState, "spindle": msg.SpindleState}

SERVICES: dict[str, dict[str, Any]] = {
    "axis": {
        "power": srv.SetSwitch,
        "reset": srv.Execute,
        "set_feed_release": srv.SetFeedRelease,
        "move_absolute": srv.MoveAbsolute,
        "move_relative": srv.MoveRelative,
        "move_modulo": srv.MoveModulo,
        "feed_hold": srv.SetHold,
        "move_additive": srv.MoveRelative,
        "move_velocity": srv.MoveVelocity,
        "move_superimposed": srv.MoveSuperimposed,
        "halt_superimposed": srv.Execute,
        "set_position": srv.SetPosition,
        "set_override": srv.SetOverride,
        "set_override_type": srv.SetOverrideType,
        "stop": srv.Execute,
        "hold_stop": srv.SetHold,
        "halt": srv.Execute,
        "home": srv.HomeAxis,
        "emergency_stop": srv.EmergencyStop,
        "new_target": srv.NewTarget,
        "new_velocity_and_target": srv.NewVelocityAndTarget,
        "compensation_start": srv.StartCompensation,
        "compensation_stop": srv.Execute,
        "external_enable": srv.EnableExternalSetpoints,
        "external_disable": srv.Execute,
        "set_coupling_factor": srv.SetCouplingFactor,
        "set_cyclic_factor": srv.SetCouplingFactor,
        "decouple": srv.Decouple,
        "set_feedforward": srv.SetFeedforward,
        "reset_feedforward": srv.Execute,
        "set_friction_compensation": srv.SetSwitch,
        "write_parameter": srv.WriteParameter,
        "read_drive_parameter": srv.ReadDriveParameter,
        "write_drive_parameter": srv.WriteDriveParameter,
    },
    "spindle": {
        "power": srv.SetSwitch,
        "start": srv.StartSpindle,
        "set_speed": srv.SetSpeed,
        "stop": srv.CommandSpindle,
        "hold_stop": srv.SetHold,
        "orient": srv.OrientSpindle,
        "home": srv.CommandSpindle,
        "set_override": srv.SetOverride,
        "suppress_override": srv.SetSwitch,
        "feed_hold": srv.SetHold,
        "select_gear": srv.SelectGear,
        "gear_changed": srv.Execute,
        "set_limits": srv.SetSpindleLimits,
        "reset_limits": srv.Execute,
        "stop_at_program_end": srv.SetHold,
        "couple": srv.CoupleSpindle,
        "decouple": srv.Execute,
        "reset": srv.Execute,
        "set_feedforward": srv.SetFeedforward,
        "reset_feedforward": srv.Execute,
    },
    "channel": {
        "load": srv.LoadProgram,
        "start": srv.StartProgram,
        "feed_hold": srv.SetHold,
        "set_override": srv.SetOverride,
        "single_block": srv.SetSingleBlock,
        "optional_stop": srv.SetHold,
        "block_skip": srv.SkipBlocks,
        "reset": srv.Execute,
        "mdi": srv.ManualDataInput,
        "acknowledge": srv.Acknowledge,
        "measuring_event": srv.Execute,
        "set_zero_offset": srv.SetZeroOffset,
        "teach_zero_offset": srv.TeachZeroOffset,
        "set_clamp_position": srv.SetClampPosition,
    },
    "plc": {
        "acknowledge": srv.Acknowledge,
        "auto_acknowledge": srv.SetSwitch,
        "set_life_sign": srv.SetHold,
        "set_input": srv.SetInput,
        "follow_trajectory": srv.FollowTrajectory,
        "emergency_stop": srv.SetSwitch,
        "reset": srv.Execute,
        "stop_all": srv.Execute,
    },
}
"""Service of a unit -> type; the service's name and fields are those of the command."""

COUPLING_SERVICES: dict[str, Any] = {
    "couple": srv.Couple,
    "couple_gantry": srv.CoupleGantry,
    "couple_cyclic": srv.CoupleCyclic,
    "couple_flying_saw": srv.CoupleFlyingSaw,
    "couple_cam": srv.CoupleCam,
    "change_cam": srv.ChangeCam,
}
"""Services of the axes that the plc_bridge answers: it sees all axes, and reads the tables."""

SERIES_SERVICES: dict[str, Any] = {"external_setpoints": srv.GiveExternalSetpoints}
"""Services of the axes by which the plc_bridge takes series of setpoints."""

RECORDER_SERVICES: dict[str, Any] = {"start": srv.StartRecording, "stop": srv.Execute, "snapshot": srv.TakeSnapshot}
"""Services of the recorder."""

VALUE_TOPICS: dict[str, Any] = {
    "override": msg.Override,
    "feed_hold": msg.Switch,
    "enable": msg.Switch,
    "feed_release": msg.FeedRelease,
    "coupling_factor": msg.CyclicCouplingFactor,
}
"""Topics `/<unit>/<name>` with one value that a PLC writes cyclically."""

HLI_CONTROL: dict[str, Any] = {
    "axis": msg.AxisHliControl,
    "spindle": msg.SpindleHliControl,
    "channel": msg.ChannelHliControl,
}
HLI_STATUS: dict[str, Any] = {
    "axis": msg.AxisHliStatus,
    "spindle": msg.SpindleHliStatus,
    "channel": msg.ChannelHliStatus,
}
"""The HLI of an object, by kind of unit: from the PLC, to the PLC."""
CONTROL = "hli/control"
STATUS = "hli/status"
EMERGENCY_STOP_TOPIC = "emergency_stop"
TRAJECTORY_ACTION = "trajectory/follow_joint_trajectory"
TRAJECTORY_TOPIC = "trajectory/joint_trajectory"
"""Trajectories of several axes in SI units, as ros2_control names them."""


def value_topics(*names: str) -> dict[str, Any]:
    return {name: VALUE_TOPICS[name] for name in names}


PLC_TOPICS: dict[str, dict[str, Any]] = {
    "channel": {**value_topics("override", "feed_hold"), CONTROL: HLI_CONTROL["channel"]},
    "axis": {
        **value_topics("override", "feed_hold", "enable", "feed_release", "coupling_factor"),
        "external_setpoint": msg.ExternalSetpoint,
        "jog": msg.Jog,
        CONTROL: HLI_CONTROL["axis"],
    },
    "spindle": {**value_topics("override", "feed_hold", "enable"), CONTROL: HLI_CONTROL["spindle"]},
}
"""Topics `/<unit>/<name>` that the PLC writes, by kind of unit; besides its life sign and the emergency stop."""


def plc_topic(unit: str, name: str) -> str:
    return f"{unit}/{name}"


def plc_quality(message_type: Any) -> QoSProfile:
    """External setpoints are a series of which none may be lost, the HLI has edges; of the others the newest counts."""
    if message_type in HLI_CONTROL.values():
        return PLC_EDGES
    return BLOCKS if message_type is msg.ExternalSetpoint else PLC_INPUT


def hli_control_topic(unit: str) -> str:
    return plc_topic(unit, CONTROL)


def hli_status_topic(unit: str) -> str:
    return plc_topic(unit, STATUS)


def block_topic(unit: str) -> str:
    return f"{unit}/block"


def jog_topic(axis: str) -> str:
    return plc_topic(axis, "jog")


def state_topic(unit: str) -> str:
    return f"{unit}/state"


def handshake_topic(channel: str) -> str:
    return f"{channel}/handshake"


def offsets_topic(channel: str) -> str:
    return f"{channel}/offsets"


def program_topic(channel: str) -> str:
    return f"{channel}/program"


def recorded_topic(topic: str) -> str:
    """A topic's name in recordings, which leave out the namespace of the run."""
    return f"/{topic.removeprefix('/')}"


def published_topic(recorded: str) -> str:
    """The topic on which a player publishes what was recorded under this name."""
    return recorded.removeprefix("/")
