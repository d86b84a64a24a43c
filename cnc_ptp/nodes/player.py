"""`player RUN.mcap`: publishes the topics of a recording again, at the pace at which they were recorded."""

from __future__ import annotations

import math
import socket
import sys
import time
from collections.abc import Iterator
from importlib import import_module
from typing import Any

import click
import rclpy
from rclpy.duration import Duration
from rclpy.node import Node
from rclpy.qos import DurabilityPolicy, QoSProfile, ReliabilityPolicy
from rich.console import Console
from rich.progress import BarColumn, Progress, TextColumn, TimeRemainingColumn

from cnc_ptp.nodes import node_command_line, process
from cnc_ptp.nodes.observed_topics import is_input
from cnc_ptp.nodes.topics import block_topic, published_topic
from cnc_ptp.nodes.unit.claim import claim_unit
from cnc_ptp.number_range import RATE
from cnc_ptp.recording.qos import parse_profiles
from cnc_ptp.recording.reader import RawMessage, TopicInfo, iter_messages, topics_of

DISCOVERY = 5.0
"""Seconds in which subscribers may find the publishers before the first message goes out."""
SETTLED = 1.0
"""Seconds without a further subscriber after which it goes out earlier."""
FAREWELL = 0.5
LARGEST_BATCH = 500
BLOCK = block_topic("")


class PlayerNode(Node):
    """Publishes every topic of a recording with the bytes, and the quality of service, that it was recorded with.

    Topics whose message type is not installed here are left out: `left_out`; unless `inputs`, those that the PLC writes
    as well: `inputs_left_out`. `units`: those whose blocks it publishes.
    """

    def __init__(self, path: str, *, rate: float, inputs: bool = False) -> None:
        """`rate`: 2.0 = twice as fast. Raises CncError 26001 to 26005 for a file that cannot be read."""
        super().__init__("player", enable_rosout=False)
        recorded = topics_of(path)
        topics = {topic: info for topic, info in recorded.items() if inputs or not is_input(info.type_name)}
        self.inputs_left_out = sorted(recorded.keys() - topics.keys())
        classes = {topic: message_class(info.type_name) for topic, info in topics.items()}
        self.left_out = sorted(topic for topic, of in classes.items() if of is None)
        self._played = {
            topic: self.create_publisher(of, published_topic(topic), qos_of(topics[topic]))
            for topic, of in classes.items()
            if of is not None
        }
        self.units = [topic.strip("/").removesuffix(BLOCK) for topic in self._played if topic.endswith(BLOCK)]
        played = [topics[topic] for topic in self._played]
        self.topics = len(played)
        self.total = sum(info.count for info in played)
        self._first_ns = min((info.first_ns for info in played), default=0)
        self.seconds = (max((info.last_ns for info in played), default=0) - self._first_ns) * 1e-9
        self._messages: Iterator[RawMessage] = iter_messages(path, topics=self._played.keys())
        self._next: RawMessage | None = next(self._messages, None)
        self._rate = rate
        self._deadline = self._settled = math.inf
        self._subscribers = 0
        self._begin: float | None = None
        self._end: float | None = None
        self.published = 0

    @property
    def done(self) -> bool:
        return self._end is not None and time.monotonic() > self._end

    @property
    def position(self) -> float:
        """Seconds of the recording that are published."""
        return self.seconds if self._next is None else (self._next.log_time_ns - self._first_ns) * 1e-9

    def wait_time(self) -> float:
        """Seconds until the next message is due, at most 0.1."""
        if self._next is None or self._begin is None:
            return process.SPIN_TIMEOUT
        return min(process.SPIN_TIMEOUT, max(0.0, self._due(self._next, self._begin) - time.monotonic()))

    def advance(self) -> None:
        """Publishes what is due."""
        now = time.monotonic()
        if self._begin is None:
            self._await_subscribers(now)
            return
        for _ in range(LARGEST_BATCH):
            if self._next is None:
                self._end = self._end or now + FAREWELL
                return
            if self._due(self._next, self._begin) > now:
                return
            self._played[self._next.topic].publish(self._next.cdr)
            self.published += 1
            self._next = next(self._messages, None)

    def _await_subscribers(self, now: float) -> None:
        """Starts when no more subscribers come, at the latest at the deadline: earlier messages are lost."""
        self._deadline = min(self._deadline, now + DISCOVERY)
        subscribers = sum(publisher.get_subscription_count() for publisher in self._played.values())
        if subscribers != self._subscribers:
            self._subscribers, self._settled = subscribers, now + SETTLED
        if now > min(self._settled, self._deadline):
            self._begin = now

    def _due(self, message: RawMessage, begin: float) -> float:
        return begin + (message.log_time_ns - self._first_ns) * 1e-9 / self._rate


def message_class(type_name: str) -> Any:
    """The Python class of a message type like `cnc_ptp/msg/AxisState`, None where it is not installed."""
    package, _, name = type_name.split("/")
    try:
        return getattr(import_module(f"{package}.msg"), name, None)
    except ImportError:
        return None


def qos_of(info: TopicInfo) -> QoSProfile:
    """The quality of service of a topic's publisher according to the recording."""
    offered = parse_profiles(info.qos, info.type_name)
    return QoSProfile(
        depth=offered.depth,
        reliability=ReliabilityPolicy[offered.reliability.upper()],
        durability=DurabilityPolicy[offered.durability.upper()],
        lifespan=Duration(seconds=offered.lifespan),
    )


class _Show:
    """Prints what is published and where, the progress (on a terminal), and at the end what was published."""

    def __init__(self, path: str, rate: float) -> None:
        self._path = path
        self._rate = rate
        self._console = Console(highlight=False, soft_wrap=True)
        columns = (TextColumn("{task.description}"), BarColumn(), TextColumn("{task.fields[where]}"))
        self._bar = Progress(*columns, TimeRemainingColumn(), console=Console(stderr=True))
        self._node: PlayerNode | None = None

    def begin(self, node: PlayerNode) -> PlayerNode:
        self._node = node
        for topic in node.left_out:
            text = f"note: {topic} is left out, its message type is not installed"
            self._console.print(text, style="yellow", markup=False)
        self._console.print(self._first_line(node), markup=False)
        if self._bar.console.is_terminal:
            self._task = self._bar.add_task("publishing", total=node.seconds, where="")
            self._bar.start()
        return node

    def advance(self, node: PlayerNode) -> None:
        node.advance()
        if self._bar.live.is_started:
            where = f"{node.position:.1f} of {node.seconds:.1f} s"
            self._bar.update(self._task, completed=node.position, where=where)

    def end(self) -> None:
        if self._bar.live.is_started:
            self._bar.stop()
        node = self._node
        if node is not None:
            at = "" if node.published == node.total else f", up to {node.position:.1f} s of {node.seconds:.1f} s"
            text = f"published {node.published} of {node.total} messages on {node.topics} topics{at}"
            self._console.print(text, markup=False)

    def _first_line(self, node: PlayerNode) -> str:
        domain, namespace = rclpy.get_default_context().get_domain_id(), node.get_namespace()
        where = f"ROS domain {domain}" + (f", namespace {namespace}" if namespace != "/" else "")
        return (
            f"publishing {self._path} on {where}: {node.topics} topics, {node.total} messages, {node.seconds:.1f} s at "
            f"rate {self._rate:g}, so {node.seconds / self._rate:.1f} s{_left_out(node)}; Ctrl-C ends it"
        )


def _left_out(node: PlayerNode) -> str:
    topics = len(node.inputs_left_out)
    return f"; {topics} topics of PLC inputs are left out (--inputs publishes them)" if topics else ""


def publish_recording(path: str, *, rate: float, inputs: bool = False) -> int:
    """Plays a recording to its end; returns the exit status.

    The domain and the units of the recording are held as by a run: nodes would take the recorded blocks for their own.
    Raises CncError 26107 and 26141 when another process has them.
    """
    show = _Show(path, rate)

    def make() -> PlayerNode:
        claims.append(process.claim_domain())
        node = PlayerNode(path, rate=rate, inputs=inputs)
        claims.extend(claim_unit(node, unit) for unit in node.units)
        return show.begin(node)

    claims: list[socket.socket] = []
    try:
        return process.run_node(
            make, done=lambda node: node.done, wait=lambda node: node.wait_time(), after=lambda node: show.advance(node)
        )
    finally:
        show.end()
        for claim in claims:
            claim.close()


@click.command()
@click.argument("recording", type=click.Path(dir_okay=False))
@click.option("--rate", type=RATE, default=1.0, show_default=True, help="Factor, 1 = real time.")
@click.option("--inputs", is_flag=True, help="Publish PLC inputs too: a machine on this ROS domain acts on them.")
def command(recording: str, rate: float, inputs: bool) -> None:
    """Publishes RECORDING again."""
    sys.exit(publish_recording(recording, rate=rate, inputs=inputs))


def main() -> None:
    node_command_line.call(command)


if __name__ == "__main__":
    main()
