"""Sends the velocities of a jog: an axis jogs while its messages come."""

from __future__ import annotations

import time

from rclpy.node import Node

from cnc_ptp import msg
from cnc_ptp.nodes.topics import PLC_INPUT, jog_topic

PERIOD = 0.05
"""Seconds between two messages."""


class JogSender:
    """Publishes /<axis>/jog."""

    def __init__(self, node: Node, axis: str) -> None:
        self._node = node
        self._publisher = node.create_publisher(msg.Jog, jog_topic(axis), PLC_INPUT)
        self._sequence = 0
        self._sent_at = 0.0
        self.velocity = 0.0
        """Of the last message, mm/s (deg/s); 0: nothing jogs."""

    @property
    def has_begun(self) -> bool:
        """A message was sent."""
        return self._sequence > 0

    @property
    def is_heard(self) -> bool:
        """The PLC is subscribed."""
        return bool(self._publisher.get_subscription_count())

    def send(self, velocity: float) -> None:
        self._sequence += 1
        self._sent_at = time.monotonic()
        self.velocity = velocity
        message = msg.Jog(sequence=self._sequence, valid=True, velocity=velocity)
        message.header.frame_id = self._node.get_name()
        self._publisher.publish(message)

    def keep_alive(self) -> None:
        """Sends the velocity again if it is time."""
        if self.velocity and time.monotonic() - self._sent_at >= PERIOD:
            self.send(self.velocity)
