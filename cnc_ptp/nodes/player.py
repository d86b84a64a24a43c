"""`player RUN.mcap`: puts the topics of a recording back on the graph, at the pace at which they were recorded."""

from __future__ import annotations

import sys
import time
from collections.abc import Iterator
from importlib import import_module
from typing import Any

import click
from rclpy.node import Node

from cnc_ptp.nodes import arguments, process
from cnc_ptp.nodes.topics import BLOCKS, COMMAND, EVENT, EVENTS
from cnc_ptp.number_range import RATE
from cnc_ptp.recording.reader import RawMessage, Recorded, iter_messages, read_recording

DISCOVERY = 1.0
"""Seconds between the first publisher and the first message, so that subscribers find them."""
FAREWELL = 0.5
LARGEST_BATCH = 500


class PlayerNode(Node):
    """Publishes every topic of a recording with the bytes, and the quality of service, that it was recorded with."""

    def __init__(self, path: str, *, rate: float) -> None:
        """`rate`: 2.0 = twice as fast. Raises CncError 26001 to 26005 for a file that cannot be read."""
        super().__init__("player", enable_rosout=False)
        recorded: Recorded = read_recording(path)
        self._publish_to = {
            topic: self.create_publisher(message_class(info.type_name), topic, qos_of(topic)).publish
            for topic, info in recorded.topics.items()
        }
        self._messages: Iterator[RawMessage] = iter_messages(path)
        self._next: RawMessage | None = next(self._messages, None)
        self._first_ns = self._next.log_time_ns if self._next else 0
        self._rate = rate
        self._begin = time.monotonic() + DISCOVERY
        self._end: float | None = None
        self.published = 0

    @property
    def done(self) -> bool:
        return self._end is not None and time.monotonic() > self._end

    def wait_time(self) -> float:
        """Seconds until the next message is due, at most 0.1."""
        if self._next is None:
            return process.SPIN_TIMEOUT
        return min(process.SPIN_TIMEOUT, max(0.0, self._due(self._next) - time.monotonic()))

    def advance(self) -> None:
        """Publishes what is due."""
        now = time.monotonic()
        for _ in range(LARGEST_BATCH):
            if self._next is None:
                self._end = self._end or now + FAREWELL
                return
            if self._due(self._next) > now:
                return
            self._publish_to[self._next.topic](self._next.cdr)
            self.published += 1
            self._next = next(self._messages, None)

    def _due(self, message: RawMessage) -> float:
        return self._begin + (message.log_time_ns - self._first_ns) * 1e-9 / self._rate


def message_class(type_name: str) -> Any:
    """The Python class of a message type like `cnc_ptp/msg/AxisState`."""
    package, _, name = type_name.split("/")
    return getattr(import_module(f"{package}.msg"), name)


def qos_of(topic: str) -> Any:
    return EVENTS if topic in (EVENT, COMMAND) else BLOCKS


def publish_recording(path: str, *, rate: float) -> int:
    """Plays a recording to its end; returns the exit status."""
    return process.run_node(
        lambda: PlayerNode(path, rate=rate),
        done=lambda node: node.done,
        wait=lambda node: node.wait_time(),
        after=lambda node: node.advance(),
    )


@click.command()
@click.argument("recording", type=click.Path(dir_okay=False))
@click.option("--rate", type=RATE, default=1.0, show_default=True, help="2 = twice as fast.")
def command(recording: str, rate: float) -> None:
    """Publishes RECORDING again."""
    sys.exit(publish_recording(recording, rate=rate))


def main() -> None:
    arguments.call(command)


if __name__ == "__main__":
    main()
