"""The machine of the graph as pages see it: node `web`."""

from __future__ import annotations

import asyncio
import time
from collections import deque
from collections.abc import Mapping
from concurrent.futures import Future
from functools import partial
from math import inf
from typing import Any

from builtin_interfaces.msg import Time
from diagnostic_msgs.msg import DiagnosticArray, DiagnosticStatus
from rclpy.publisher import Publisher

from cnc_ptp import msg
from cnc_ptp.client import Machine
from cnc_ptp.client.faults import error_of
from cnc_ptp.client.graph_link import GraphLink, connect_graph
from cnc_ptp.client.link import Reply
from cnc_ptp.nodes import convert
from cnc_ptp.nodes.client.calls_in_flight import CallsInFlight
from cnc_ptp.nodes.client.machine_client import MachineClient, services_of
from cnc_ptp.nodes.topics import (
    ACKNOWLEDGED,
    DIAGNOSTICS,
    EVENT,
    EVENTS,
    LATEST,
    PLC_INPUT,
    handshake_topic,
    jog_topic,
    offsets_topic,
    program_topic,
)
from cnc_ptp.protocol.blocks import ChannelOffsets, Event, HandshakeRequest, read_values
from cnc_ptp.web.faces.face import News
from cnc_ptp.web.faces.machine_face import MachineFace, taken
from cnc_ptp.web.numbers import ALARM_ACKNOWLEDGED
from cnc_ptp.wire.block_codec import channel_offsets

NODE = "web"
MOST_DIAGNOSTICS = 100
FREQUENT: Mapping[str, tuple[str, ...]] = {
    "channel": ("load", "start", "feed_hold", "set_override", "reset", "mdi"),
    "axis": ("halt", "stop", "reset", "move_absolute"),
    "spindle": ("start", "stop"),
    "plc": ("acknowledge",),
}
"""Commands whose services are looked for when the face begins: their first call is as quick as the others."""


PER_SECOND = 32.0
"""More messages of a jog than any page sends."""


class PageJogs:
    """Messages of jogs, counted for each axis and client, as the PLC compares them (JogTopics).

    It takes the 1 of a server that has begun again; where it has missed that, what follows is above all that the one
    before has sent: a count that goes with the time since the computer was started.
    """

    def __init__(self) -> None:
        self._publishers: dict[str, Publisher[msg.Jog]] = {}
        self._last: dict[tuple[str, str], int] = {}

    def add(self, axis: str, publisher: Publisher[msg.Jog]) -> None:
        self._publishers[axis] = publisher

    def send(self, axis: str, velocity: float, client: str) -> None:
        """mm/s, deg/s."""
        last = self._last.get((axis, client), 0)
        number = max(last + 1, int(PER_SECOND * time.monotonic()) % 2**31) if last else 1
        self._last[axis, client] = number
        message = msg.Jog(sequence=number, valid=True, velocity=velocity)
        message.header.frame_id = client
        self._publishers[axis].publish(message)


class WebLink(GraphLink):
    """As of a client, but commands wait beside each other, and jogs are passed on message by message."""

    node_name = NODE
    event_quality = EVENTS  # with those that were before this process

    def __init__(self, *, domain: int | None, namespace: str) -> None:
        self.programs: dict[str, dict[str, Any]] = {}
        self.diagnostics: deque[dict[str, Any]] = deque(maxlen=MOST_DIAGNOSTICS)
        self.offsets: deque[tuple[str, ChannelOffsets]] = deque()
        self.requests: deque[HandshakeRequest] = deque()
        """Of channels, also those from before this process."""
        self._calls = CallsInFlight()
        self._page_jogs = PageJogs()
        super().__init__(domain=domain, namespace=namespace)

    def _subscribe(self, client: MachineClient) -> None:
        self.events, self.records = self.seen.events(), self.seen.records()  # before the first one comes
        super()._subscribe(client)
        self._event_publisher = client.create_publisher(msg.Event, EVENT, EVENTS)
        self._acknowledged_publisher = client.create_publisher(msg.Event, ACKNOWLEDGED, PLC_INPUT)
        client.create_subscription(DiagnosticArray, DIAGNOSTICS, self._take_diagnostics, PLC_INPUT)
        for unit, kind in self.kinds.items():
            if kind == "channel":
                client.create_subscription(msg.ProgramState, program_topic(unit), self._take_program, LATEST)
                take_offsets = partial(self._take_offsets, unit)
                client.create_subscription(msg.ChannelOffsets, offsets_topic(unit), take_offsets, EVENTS)
                client.create_subscription(msg.HandshakeRequest, handshake_topic(unit), self._take_request, EVENTS)
            if kind == "axis":
                self._page_jogs.add(unit, client.create_publisher(msg.Jog, jog_topic(unit), PLC_INPUT))
            for command in FREQUENT[kind]:
                if command in services_of(kind):
                    self._calls.prepare(client, unit, command)

    def _take_diagnostics(self, message: DiagnosticArray) -> None:
        self.diagnostics += (diagnostics_fields(status) for status in message.status)

    def _take_program(self, state: msg.ProgramState) -> None:
        self.programs[state.channel] = {
            "program": state.program,
            "manual": state.manual,
            "file": state.file,
            "text": state.text,
            "calls": [*state.calls],
            "available": [*state.available],
        }

    def _take_offsets(self, channel: str, message: msg.ChannelOffsets) -> None:
        self.offsets.append((channel, channel_offsets(message)))

    def _take_request(self, message: msg.HandshakeRequest) -> None:
        self.requests.append(convert.message_to_request(message))

    def _after(self, client: MachineClient) -> None:
        self._calls.go_on()
        super()._after(client)

    def call(self, unit: str, command: str, arguments: Mapping[str, Any]) -> Future[Any]:
        """The response to a command, when it has come."""
        answer: Future[Any] = Future()
        self._thread.call(partial(self._begin_call, unit, command, arguments, answer))
        return answer

    def _begin_call(
        self, unit: str, command: str, arguments: Mapping[str, Any], answer: Future[Any], client: MachineClient
    ) -> None:
        if not answer.set_running_or_notify_cancel():
            return  # nobody waits for it, and it was not sent
        try:
            self._calls.begin(client, unit, command, arguments, answer)
        except Exception as error:  # for the page that has asked
            answer.set_exception(error)

    def snapshot(self, arguments: Mapping[str, Any]) -> Future[Any]:
        """The response of the recorder."""
        answer: Future[Any] = Future()
        answer.set_running_or_notify_cancel()
        self._thread.call(lambda client: self._calls.begin_snapshot(client, arguments, answer))
        return answer

    def jog(self, axis: str, velocity: float, client: str) -> None:
        """One message, at once."""
        self._page_jogs.send(axis, velocity, client)

    def publish_event(self, event: Event) -> None:
        """For recordings and other clients; its stamp is that of its cycle there.

        Acknowledgements by the PLC's node: DDS keeps what a process has published only as long as the process.
        """
        is_kept = event.error_id == ALARM_ACKNOWLEDGED
        publisher = self._acknowledged_publisher if is_kept else self._event_publisher
        publisher.publish(convert.event_to_message(event, Time()))

    def require_machine(self) -> None:
        """Raises CncError 26171 when it is gone."""
        self._require_machine()


class LiveFace(MachineFace):
    """The machine that runs on this ROS domain."""

    def __init__(self, machine: Machine, link: WebLink) -> None:
        super().__init__(machine)
        self._graph = link
        self._events, self._records = link.events, link.records
        self._first: dict[str, int] = {}
        """Unit -> first cycle of its first block here."""

    def programs(self) -> Mapping[str, Mapping[str, Any]]:
        return self._graph.programs

    async def snapshot(self, file: str, seconds: float, until: float) -> int:
        arguments = {"file": file, "seconds": seconds, "until": until}
        response = await asyncio.wrap_future(self._graph.snapshot(arguments))
        if not response.accepted:
            raise error_of(response.error_id, response.message, read_values(response.values_json))
        return int(response.cycle)

    def news(self) -> News:
        news = super().news()
        news.diagnostics = taken(self._graph.diagnostics)
        for unit, block in news.blocks:
            self._first.setdefault(unit, block.first_cycle)
        news.offsets = [*news.offsets, *taken(self._graph.offsets)]  # blocks have them, too, but may be lost
        asked = (each for each in taken(self._graph.requests) if self._is_earlier(each.channel, each.cycle))
        news.requests = [*asked, *news.requests]
        return news

    def _is_earlier(self, channel: str, cycle: int) -> bool:
        """None of its blocks here has what it says of a cycle."""
        return cycle < self._first.get(channel, inf)

    async def _answer_to(self, unit: str, command: str, arguments: Mapping[str, Any], user: str) -> Reply:
        response = await asyncio.wrap_future(self._graph.call(unit, command, arguments))
        number = 0 if response.accepted else response.error_id
        return Reply(response.cycle, number, response.message, read_values(response.values_json), response.job)

    def publish(self, event: Event) -> None:
        self._graph.publish_event(event)

    def _send_jog(self, axis: str, velocity: float, user: str) -> None:
        self._graph.jog(axis, velocity, NODE if user == NODE else f"{NODE}:{user}")

    async def run(self) -> None:
        while True:
            await self._graph.turn_async(inf)


def diagnostics_fields(status: DiagnosticStatus) -> dict[str, Any]:
    """Of a node: its level, text, and figures as it names them (recording/node_figures.py)."""
    values = {value.key: value.value for value in status.values}
    return {
        "name": status.name,
        "level": int.from_bytes(status.level, "little"),
        "text": status.message,
        "values": values,
    }


def live_face(*, domain: int | None = None, namespace: str = "", timeout: float = 5.0) -> LiveFace:
    """Looks for the machine. Raises CncError 26108, 26135, 26176."""
    link = connect_graph(domain=domain, namespace=namespace, timeout=timeout, kind=WebLink)
    return LiveFace(Machine(link), link)
