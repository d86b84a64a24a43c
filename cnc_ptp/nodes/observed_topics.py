"""Topics that a recording keeps as they come: what the PLC writes, joint states, handshakes, logs."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any, NamedTuple

from rcl_interfaces.msg import Log
from rclpy.qos import QoSProfile, qos_profile_rosout_default
from sensor_msgs.msg import JointState

from cnc_ptp import msg
from cnc_ptp.nodes.topics import BLOCKS, EVENTS, JOINT_STATES, LIFE_SIGN, PLC_INPUT, handshake_topic
from cnc_ptp.parameters import MachineParameters

ROSOUT = "/rosout"
INPUTS = ("Switch", "Override", "ExternalSetpoint", "CyclicCouplingFactor", "Jog", "FeedRelease", "LifeSign")
"""Message types of the topics that the PLC writes: a machine obeys them."""


class Observed(NamedTuple):
    """A topic, its type, and the quality of service with which its usual readers read it."""

    topic: str
    type: Any
    quality: QoSProfile


def observed_topics(machine: MachineParameters) -> Iterator[Observed]:
    """All of a machine, whether somebody publishes on them or not."""
    for channel in machine.channels:
        yield Observed(handshake_topic(channel), msg.HandshakeRequest, EVENTS)
        yield Observed(f"{channel}/feed_hold", msg.Switch, PLC_INPUT)
    for unit in (*machine.channels, *machine.axes, *machine.spindles):
        yield Observed(f"{unit}/override", msg.Override, PLC_INPUT)
    for unit in (*machine.axes, *machine.spindles):
        yield Observed(f"{unit}/enable", msg.Switch, PLC_INPUT)
    for axis in machine.axes:
        yield Observed(f"{axis}/external_setpoint", msg.ExternalSetpoint, BLOCKS)
        yield Observed(f"{axis}/coupling_factor", msg.CyclicCouplingFactor, PLC_INPUT)
        yield Observed(f"{axis}/jog", msg.Jog, PLC_INPUT)
        yield Observed(f"{axis}/feed_release", msg.FeedRelease, PLC_INPUT)
    yield Observed(LIFE_SIGN, msg.LifeSign, PLC_INPUT)
    yield Observed(JOINT_STATES, JointState, PLC_INPUT)
    yield Observed(ROSOUT, Log, qos_profile_rosout_default)


def is_input(type_name: str) -> bool:
    """True for a recorded type like `cnc_ptp/msg/Jog` that only the PLC writes."""
    package, _, name = type_name.split("/")
    return package == "cnc_ptp" and name in INPUTS


def type_name(message_type: Any) -> str:
    """`package/msg/Name` of a generated class."""
    return f"{message_type.__module__.partition('.')[0]}/msg/{message_type.__name__}"
