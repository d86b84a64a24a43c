"""Quality of service of recorded topics, in the form in which rosbag2 keeps it."""

from __future__ import annotations

from typing import Any, NamedTuple

import yaml

from cnc_ptp import yaml_text

INFINITE = {"sec": 9223372036, "nsec": 854775807}


class Qos(NamedTuple):
    """The offer of a publisher; all else is the default of ROS. `lifespan`: s, 0 without end."""

    depth: int
    durability: str = "volatile"
    reliability: str = "reliable"
    lifespan: int = 0


BLOCKS = Qos(1000)
REMEMBERED = Qos(1000, "transient_local")
INPUT = Qos(10)
EDGES = Qos(100)
ROSOUT = Qos(1000, "transient_local", lifespan=10)
BY_TYPE = {
    "cnc_ptp/msg/AxisBlock": REMEMBERED,
    "cnc_ptp/msg/SpindleBlock": REMEMBERED,
    "cnc_ptp/msg/Event": REMEMBERED,
    "cnc_ptp/msg/CommandRecord": REMEMBERED,
    "cnc_ptp/msg/HandshakeRequest": REMEMBERED,
    "cnc_ptp/msg/ChannelOffsets": REMEMBERED,
    "cnc_ptp/msg/DriveStop": REMEMBERED,
    "cnc_ptp/msg/Override": INPUT,
    "cnc_ptp/msg/Switch": INPUT,
    "cnc_ptp/msg/CyclicCouplingFactor": INPUT,
    "cnc_ptp/msg/LifeSign": INPUT,
    "cnc_ptp/msg/Jog": INPUT,
    "cnc_ptp/msg/FeedRelease": INPUT,
    "cnc_ptp/msg/LatenessHistogram": INPUT,
    "cnc_ptp/msg/AxisHliControl": EDGES,
    "cnc_ptp/msg/ChannelHliControl": EDGES,
    "cnc_ptp/msg/SpindleHliControl": EDGES,
    "sensor_msgs/msg/JointState": INPUT,
    "diagnostic_msgs/msg/DiagnosticArray": INPUT,
    "rcl_interfaces/msg/Log": ROSOUT,
}
"""By message type, as the nodes offer it; all other topics are numbered blocks or states."""


def offered(type_name: str) -> Qos:
    """The offer of the publisher of a topic of this type."""
    return BY_TYPE.get(type_name, BLOCKS)


def profile(qos: Qos) -> dict[str, Any]:
    """One entry of `offered_qos_profiles`."""
    return {
        "history": "keep_last",
        "depth": qos.depth,
        "reliability": qos.reliability,
        "durability": qos.durability,
        "deadline": {**INFINITE},
        "lifespan": {"sec": qos.lifespan, "nsec": 0} if qos.lifespan else {**INFINITE},
        "liveliness": "automatic",
        "liveliness_lease_duration": {**INFINITE},
        "avoid_ros_namespace_conventions": False,
    }


def profiles_text(qos: Qos) -> str:
    """`offered_qos_profiles` of a channel."""
    text: str = yaml.dump([profile(qos)], Dumper=yaml_text.WRITER, sort_keys=False)
    return text.rstrip("\n")


def parse_profiles(text: str, type_name: str) -> Qos:
    """Durability and reliability of `offered_qos_profiles` of a channel, also in the numbers of old bags.

    If it has none, those of topics of this type; with several publishers what all of them offer.
    """
    usual = offered(type_name)
    try:
        profiles = yaml_text.load(text) or []
        durabilities = {DURABILITIES.get(entry["durability"], "volatile") for entry in profiles}
        reliabilities = {RELIABILITIES.get(entry["reliability"], "reliable") for entry in profiles}
        depth = max((int(entry["depth"]) for entry in profiles), default=0)
    except (yaml.YAMLError, TypeError, KeyError, ValueError):
        return usual
    if not profiles:
        return usual
    durability = durabilities.pop() if len(durabilities) == 1 else "volatile"
    reliability = reliabilities.pop() if len(reliabilities) == 1 else "best_effort"
    return Qos(depth or usual.depth, durability, reliability, usual.lifespan)


DURABILITIES = {1: "transient_local", "transient_local": "transient_local"}
RELIABILITIES = {2: "best_effort", "best_effort": "best_effort"}
