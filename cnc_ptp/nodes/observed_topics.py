"""Topics that a recording keeps unchanged: the PLC's inputs, joint states, handshakes, offsets."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any, NamedTuple

from rclpy.qos import QoSProfile
from sensor_msgs.msg import JointState

from cnc_ptp import msg
from cnc_ptp.machine.wiring import unit_kinds
from cnc_ptp.nodes.topics import (
    EVENTS,
    JOINT_STATES,
    LIFE_SIGN,
    PLC_INPUT,
    PLC_TOPICS,
    handshake_topic,
    offsets_topic,
    plc_quality,
    plc_topic,
)
from cnc_ptp.parameters import MachineParameters

INPUTS = {of.__name__ for topics in PLC_TOPICS.values() for of in topics.values()} | {msg.LifeSign.__name__}
"""Message types of the topics that the PLC writes: they move a machine."""


class Observed(NamedTuple):
    """A topic, its type, and the quality of service with which its usual readers read it."""

    topic: str
    type: Any
    quality: QoSProfile


def observed_topics(machine: MachineParameters) -> Iterator[Observed]:
    """All such topics of a machine, whether anybody publishes on them or not."""
    for channel in machine.channels:
        yield Observed(handshake_topic(channel), msg.HandshakeRequest, EVENTS)
        yield Observed(offsets_topic(channel), msg.ChannelOffsets, EVENTS)
    for unit, kind in unit_kinds(machine).items():
        for name, message_type in PLC_TOPICS.get(kind, {}).items():
            yield Observed(plc_topic(unit, name), message_type, plc_quality(message_type))
    yield Observed(LIFE_SIGN, msg.LifeSign, PLC_INPUT)
    yield Observed(JOINT_STATES, JointState, PLC_INPUT)


def is_input(type_name: str) -> bool:
    """True for a recorded type like `cnc_ptp/msg/Jog` that only the PLC writes."""
    package, _, name = type_name.split("/")
    return package == "cnc_ptp" and name in INPUTS


def type_name(message_type: Any) -> str:
    """`package/msg/Name` of a generated class."""
    return f"{message_type.__module__.partition('.')[0]}/msg/{message_type.__name__}"
