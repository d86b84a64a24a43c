"""Publisher of events: all on /events; warnings and errors on /rosout too, where rqt_console shows them."""

from __future__ import annotations

from rcl_interfaces.msg import Log
from rclpy.node import Node
from rclpy.qos import qos_profile_rosout_default

from cnc_ptp import msg
from cnc_ptp.nodes.topics import EVENT, EVENTS
from cnc_ptp.protocol.blocks import Severity

ROSOUT = "/rosout"
"""Absolute, as rcl has it."""
LEVELS = {Severity.WARNING: (Log.WARN, "P-WARN"), Severity.ERROR: (Log.ERROR, "P-ERR")}


class EventPublisher:
    """Publishes the events of a node.

    The nodes' own loggers stay off /rosout: they would print to stderr and write files as well.
    """

    def __init__(self, node: Node) -> None:
        self._events = node.create_publisher(msg.Event, EVENT, EVENTS)
        self._log = node.create_publisher(Log, ROSOUT, qos_profile_rosout_default)
        self._name = node.get_logger().name

    def publish(self, event: msg.Event) -> None:
        self._events.publish(event)
        if event.severity in LEVELS:
            level, word = LEVELS[Severity(event.severity)]
            text = f"{word}-{event.error_id} {event.text}"
            self._log.publish(Log(stamp=event.header.stamp, level=level, name=self._name, msg=text))
