"""The heartbeat of a node: it lives, also while it waits or is at a long command."""

from __future__ import annotations

import threading
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager

from rclpy.node import Node

from cnc_ptp import msg
from cnc_ptp.nodes.topics import BLOCKS, HEARTBEAT

LONGEST_COMMAND = 2.0
"""Seconds that a command or block may take; after that the node counts as silent."""


class Heartbeat:
    """Publishes /heartbeat; blocks are a sign of life too."""

    def __init__(self, node: Node, source: str, *, watchdog_seconds: float, next_cycle: Callable[[], int]) -> None:
        """`source`: the unit. `next_cycle`: the first one of its next block."""
        self._node = node
        self._source = source
        self._period = watchdog_seconds / 4.0
        self._next_cycle = next_cycle
        self._publisher = node.create_publisher(msg.BlockReport, HEARTBEAT, BLOCKS)
        self._heard_at = time.monotonic()
        self._busy = False
        threading.Thread(target=self._send_while_busy, daemon=True).start()

    def block_sent(self) -> None:
        self._heard_at = time.monotonic()

    def send_if_due(self) -> None:
        """Nothing has been heard of this node for a while."""
        if time.monotonic() - self._heard_at > self._period:
            self._send()

    @contextmanager
    def working(self) -> Iterator[None]:
        """Around all that may take long."""
        self._busy = True
        try:
            yield
        finally:
            self._busy = False

    def _send(self) -> None:
        self._heard_at = time.monotonic()
        self._publisher.publish(msg.BlockReport(source=self._source, first_cycle=self._next_cycle()))

    def _send_while_busy(self) -> None:
        """A long command (a big program is interpreted) must not look like a dead node, but an endless one must."""
        busy_for = 0.0
        while self._node.context.ok():
            if self._busy and 0.0 < busy_for < LONGEST_COMMAND:
                self._send()
            busy_for = busy_for + self._period if self._busy else 0.0
            time.sleep(self._period)
