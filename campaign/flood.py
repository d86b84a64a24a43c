"""`python -m campaign.flood MACHINE SECONDS`: 1,000 messages a second on each topic, then calls of each service.

A program of its own on the domain of a machine that runs. It prints how many messages it has sent, calls it has made,
and calls that nobody has answered.
"""

from __future__ import annotations

import json
import sys
import time
from collections.abc import Iterator
from typing import Any

import rclpy
from rclpy.node import Node
from std_msgs.msg import Bool
from trajectory_msgs.msg import JointTrajectory

from cnc_ptp import msg
from cnc_ptp.machine.wiring import unit_kinds
from cnc_ptp.nodes import process
from cnc_ptp.nodes.topics import (
    COUPLING_SERVICES,
    EMERGENCY_STOP_TOPIC,
    LIFE_SIGN,
    PLC_TOPICS,
    RECORDER,
    RECORDER_SERVICES,
    SERIES_SERVICES,
    SERVICES,
    TRAJECTORY_TOPIC,
    plc_quality,
    plc_topic,
)
from cnc_ptp.parameters import MachineParameters, read_machine

RATE = 1000.0
"""Messages per second."""
PATIENCE = 5.0
"""Seconds for the answers to the last calls of a service."""
AT_ONCE = 8
"""Calls of a service that wait for their answers; of more than 10 rmw keeps the newest 10, and no answer comes."""
LEFT_OUT = ("emergency_stop", "stop_all")
"""Services that end the run as they should."""


def topics(machine: MachineParameters) -> Iterator[tuple[str, Any]]:
    """All that the PLC and clients write. The life sign is the last: that it does not change stops everything."""
    for unit, kind in unit_kinds(machine).items():
        for name, message_type in PLC_TOPICS.get(kind, {}).items():
            yield plc_topic(unit, name), message_type
    yield EMERGENCY_STOP_TOPIC, Bool
    yield TRAJECTORY_TOPIC, JointTrajectory
    yield LIFE_SIGN, msg.LifeSign


def harmless(name: str, message_type: Any) -> Any:
    """A message that leaves the machine as it is."""
    message = message_type()
    if isinstance(message, msg.Override):
        message.percent = 100.0
    elif isinstance(message, msg.FeedRelease):
        message.forward = message.backward = True
    elif isinstance(message, msg.Switch):
        message.enabled = name.endswith("/enable")
    return message


def services(machine: MachineParameters) -> Iterator[tuple[str, Any]]:
    """Of all units and of the recorder."""
    for unit, kind in unit_kinds(machine).items():
        of_axis = {**COUPLING_SERVICES, **SERIES_SERVICES} if kind == "axis" else {}
        for name, service_type in {**SERVICES[kind], **of_axis}.items():
            if name not in LEFT_OUT:
                yield f"{unit}/{name}", service_type
    for name, service_type in RECORDER_SERVICES.items():
        yield f"{RECORDER}/{name}", service_type


class Flood:
    """What was sent; whoever sends takes what comes meanwhile."""

    def __init__(self, node: Node, executor: Any, seconds: float) -> None:
        """`seconds` for each topic and each service."""
        self._node, self._executor, self._seconds = node, executor, seconds
        self.messages = self.calls = self.unanswered = 0

    def topic(self, name: str, message_type: Any) -> None:
        """Messages at RATE."""
        message = harmless(name, message_type)
        publisher = self._node.create_publisher(message_type, name, plc_quality(message_type))
        begin, sent = time.monotonic(), 0
        while (passed := time.monotonic() - begin) < self._seconds:
            while sent < passed * RATE:
                publisher.publish(message)
                sent += 1
            time.sleep(0.001)
        self.messages += sent
        self._node.destroy_publisher(publisher)

    def service(self, name: str, service_type: Any) -> None:
        """Calls without arguments, as fast as they are answered and at most at RATE."""
        client = self._node.create_client(service_type, name)
        if not client.wait_for_service(PATIENCE):  # the machine is gone, or never had it
            self.unanswered += 1
            return
        begin, made, waiting = time.monotonic(), 0, []
        while (passed := time.monotonic() - begin) < self._seconds:
            while made < passed * RATE and len(waiting) < AT_ONCE:
                waiting.append(client.call_async(service_type.Request()))
                made += 1
            waiting = self._open(waiting)
        deadline = time.monotonic() + PATIENCE
        while waiting and time.monotonic() < deadline:
            waiting = self._open(waiting)
        self.calls += made
        self.unanswered += len(waiting)
        self._node.destroy_client(client)

    def _open(self, waiting: list[Any]) -> list[Any]:
        """Those that are still not answered a moment later."""
        self._executor.spin_once(timeout_sec=0.001)
        return [each for each in waiting if not each.done()]


def main(machine_file: str, seconds: float) -> None:
    process.initialise()
    machine = read_machine(machine_file)
    node = rclpy.create_node("flood", enable_rosout=False, start_parameter_services=False)
    executor = process.EventsExecutor()
    executor.add_node(node)
    flood = Flood(node, executor, seconds)
    for name, message_type in topics(machine):
        flood.topic(name, message_type)
    for name, service_type in services(machine):
        flood.service(name, service_type)
    print(json.dumps({"messages": flood.messages, "calls": flood.calls, "unanswered": flood.unanswered}))
    executor.shutdown()
    rclpy.try_shutdown()


if __name__ == "__main__":
    main(sys.argv[1], float(sys.argv[2]))
