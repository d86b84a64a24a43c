"""A machine of the ROS graph under the hands of a client: commands by services, blocks and events by topics."""

from __future__ import annotations

import asyncio
import threading
import time
from collections.abc import Callable, Mapping
from concurrent.futures import CancelledError, Future
from contextlib import AbstractContextManager, nullcontext, suppress
from functools import partial
from itertools import count
from typing import Any, TypeVar

from rclpy.qos import QoSProfile, QoSReliabilityPolicy

from cnc_ptp import msg
from cnc_ptp.axis.jog_commands import JOG
from cnc_ptp.client.faults import GONE, NOT_STARTED
from cnc_ptp.client.link import Link, Reply, reply_of
from cnc_ptp.client.observations import Observations
from cnc_ptp.client.record_arguments import record_arguments
from cnc_ptp.client.started_graph import STOP_TIME, StartedGraph
from cnc_ptp.errors import CncError
from cnc_ptp.interrupt import HeldSignals
from cnc_ptp.machine.plc_file import check_plc
from cnc_ptp.machine.wiring import unit_kinds
from cnc_ptp.nodes import convert
from cnc_ptp.nodes.bridge.jog_topics import free_run_text, second_client_text
from cnc_ptp.nodes.client.client_thread import ClientThread
from cnc_ptp.nodes.client.jog_sender import JogSender
from cnc_ptp.nodes.client.latest_blocks import GONE as SILENCE
from cnc_ptp.nodes.client.latest_blocks import GONE_TEXT
from cnc_ptp.nodes.client.machine_client import NO_ANSWER, PATIENCE, MachineClient
from cnc_ptp.nodes.polling_node import chain
from cnc_ptp.nodes.process import take_priority
from cnc_ptp.nodes.topics import BLOCK_CLASSES, BLOCK_TYPES, BLOCKS, COMMAND, EVENT, block_topic
from cnc_ptp.parameters import ParameterSet, read_machine
from cnc_ptp.parameters.errors import Place
from cnc_ptp.parameters.read.parameter_set import Given
from cnc_ptp.protocol.blocks import CommandRecord, CycleBlock, Event, PlcBlock, read_values
from cnc_ptp.protocol.jobs import JobStatus
from cnc_ptp.protocol.unit import PLC
from cnc_ptp.recording.overwriting import check_recording
from cnc_ptp.recording.recorder_options import RecorderOptions, check_recorder
from cnc_ptp.wire.block_codec import codec_of

FROM_NOW_ON = QoSProfile(depth=1000, reliability=QoSReliabilityPolicy.RELIABLE)
SomeLink = TypeVar("SomeLink", bound="GraphLink")
UNITS_STAND = "its units stand"
AFTER_END = 0.3
"""Seconds without a message after the block of the PLC that ends a run: the last ones of other units have come."""
LONGEST_TURN = 0.1
"""Seconds after which somebody who waits looks around, whatever has come."""


class GraphLink(Link):
    """Its thread takes what comes; whoever waits is woken by it."""

    clock = ""
    node_name = ""
    """Empty: one of its process."""
    event_quality = FROM_NOW_ON

    def __init__(self, *, domain: int | None, namespace: str) -> None:
        """Raises CncError 26108."""
        self._graph: StartedGraph | None = None
        self._changed = threading.Condition()
        self._sleepers: list[tuple[asyncio.AbstractEventLoop, asyncio.Future[None]]] = []
        self._tickets = count(1)
        self._asked: dict[int, Future[Reply]] = {}
        self._image = threading.Lock()
        self._is_held = False
        self._later: list[Callable[[], None]] = []
        self._jogs: dict[str, Jogging] = {}
        self._parameters: dict[str, ParameterSet] = {}
        self._heard = time.monotonic()
        self._gone: CncError | None = None
        self._is_open = False
        self._thread = ClientThread(domain=domain, namespace=namespace, after=self._after, name=self.node_name)

    def find(self, timeout: float) -> MachineClient:
        """The machine that runs. Raises CncError 26135."""
        self._thread.call(partial(MachineClient.find_machine, patience=timeout)).result()
        return self._thread.client

    def observe(self, kinds: Mapping[str, str], cycle_time: float) -> None:
        """Takes the blocks of these units from now on."""
        self.kinds, self.cycle_time = kinds, cycle_time
        self.seen = Observations(kinds)
        self._thread.call(self._subscribe).result()

    def _subscribe(self, client: MachineClient) -> None:
        client.kinds = dict(self.kinds)
        for unit, kind in self.kinds.items():
            take = chain(codec_of(BLOCK_CLASSES[kind]).decode, partial(self._take_block, unit))
            client.poll(BLOCK_TYPES[kind], block_topic(unit), take, BLOCKS)
        client.poll(msg.Event, EVENT, self._take_event, self.event_quality)
        client.poll(msg.CommandRecord, COMMAND, self._take_record, self.event_quality)

    def wait_until_complete(self, timeout: float) -> None:
        """Every unit has told of itself. Raises CncError 26176."""
        deadline = time.monotonic() + timeout
        while not self.seen.cycle:
            if time.monotonic() > deadline:
                silent = ", ".join(unit for unit in self.kinds if unit not in self.seen.blocks)
                raise CncError(NOT_STARTED, f"nothing has come of {silent} within {timeout:g} s", "nothing was sent")
            self.turn(LONGEST_TURN)
        self._is_open = True

    def owns(self, graph: StartedGraph) -> None:
        """This link has started the graph, and ends it."""
        self._graph = graph

    # in the thread

    def _take_block(self, unit: str, block: CycleBlock) -> None:
        self._heard = time.monotonic()
        self._note(partial(self.seen.take_block, unit, block))

    def _take_event(self, data: bytes) -> None:
        event = convert.event_of(data)
        self._note(partial(self.seen.take_event, event))
        for jogging in self._jogs.values():
            jogging.take_event(event)

    def _take_record(self, data: bytes) -> None:
        record = convert.message_to_record(convert.message_of(data, msg.CommandRecord))
        self._note(partial(self.seen.take_record, record))
        if record.command == JOG and record.target in self._jogs:
            self._jogs[record.target].take_record(record)

    def _note(self, take: Callable[[], None]) -> None:
        """Something that has come is seen now, or when the PLC cycle of the program has ended."""
        with self._image:
            if self._is_held:
                self._later.append(take)
            else:
                take()

    def _after(self, client: MachineClient) -> None:
        """After each look for what has come."""
        for jogging in self._jogs.values():
            jogging.go_on(self.seen)
        if self._is_open and self._gone is None:
            self._gone = self._end_of_run(time.monotonic() - self._heard)
        with self._changed:
            self._changed.notify_all()
        sleepers, self._sleepers = self._sleepers, []
        for loop, future in sleepers:
            with suppress(RuntimeError):  # the loop has ended meanwhile
                loop.call_soon_threadsafe(wake, future)

    def _end_of_run(self, silent: float) -> CncError | None:
        """Of a run that nothing has come of for `silent` seconds; one of this link says itself how it has ended."""
        plc = self.seen.blocks.get(PLC)
        if self._graph is None and silent > AFTER_END and isinstance(plc, PlcBlock) and plc.run_done:
            return CncError(GONE, "the machine has ended: its run has ended", UNITS_STAND)
        return CncError(GONE, GONE_TEXT, "what it does is not known") if silent > SILENCE else None

    # commands

    def give(self, unit: str, command: str, arguments: Mapping[str, Any]) -> int:
        ticket = next(self._tickets)
        if command == JOG and self.kinds[unit] == "axis":
            self._asked[ticket] = self._thread.call(partial(self._jog, unit, float(arguments["velocity"])))
        else:
            self._asked[ticket] = self._thread.call(partial(ask, unit, command, arguments))
        return ticket

    def give_recorder(self, command: str, arguments: Mapping[str, Any]) -> int:
        ticket = next(self._tickets)
        self._asked[ticket] = self._thread.call(partial(ask_recorder, command, arguments))
        return ticket

    def answer(self, ticket: int) -> Reply | None:
        if not self._asked[ticket].done():
            return None
        try:
            return self._asked.pop(ticket).result()
        except CancelledError:
            raise self._gone or CncError(GONE, "the client has ended", "nothing was sent") from None

    def _jog(self, axis: str, velocity: float, client: MachineClient) -> Reply:
        """Raises CncError 26136, 26144, 26145."""
        if axis not in self._jogs:
            take_priority([threading.get_native_id()])  # other busy programs must not cause a silence, which ends a jog
            self._jogs[axis] = Jogging(axis, client.get_name(), JogSender(client, axis))
        return self._jogs[axis].ask(client, f"axis {axis}: {JOG}", velocity, self.seen.cycle)

    def parameters_of(self, unit: str) -> ParameterSet:
        """Its node has them all; they are asked for once."""
        if unit not in self._parameters:
            given = self._thread.call(partial(MachineClient.parameters_of, unit=unit)).result()
            self._parameters[unit] = given_set(unit, "machine" if unit == PLC else self.kinds[unit], given)
        return self._parameters[unit]

    # time

    @property
    def now(self) -> float:
        return time.monotonic()

    def hold(self) -> None:
        with self._image:
            self._is_held = True

    def release(self) -> None:
        with self._image:
            self._is_held = False
            for take in self._later:
                take()
            self._later.clear()

    def turn(self, timeout: float) -> None:
        self.release()
        with self._changed:
            self._changed.wait(min(timeout, LONGEST_TURN))
        self._require_machine()

    async def turn_async(self, timeout: float) -> None:
        self.release()
        loop = asyncio.get_running_loop()
        future = loop.create_future()
        self._sleepers.append((loop, future))
        await asyncio.wait([future], timeout=min(timeout, LONGEST_TURN))
        self._require_machine()

    def _require_machine(self) -> None:
        if self._graph is not None and self._is_open and self._gone is None and self._graph.has_ended:
            why = "; ".join(self._graph.failures) or "its run has ended"
            self._gone = CncError(GONE, f"the machine has ended: {why}", UNITS_STAND)
        if self._thread.failure is not None:
            raise CncError(GONE, f"the client has failed: {self._thread.failure!r}", "its units continue")
        if self._gone is not None:
            raise self._gone

    def waiting(self) -> AbstractContextManager[HeldSignals | None]:
        return nullcontext()

    # the end

    def close(self) -> None:
        """A graph that was started stops on its ramps and ends; of another one only the jogs of this client end."""
        was_gone = self._gone
        try:
            if self._graph is not None:
                self._stop(self._graph)
            elif any(jogging.is_active for jogging in self._jogs.values()):
                self._thread.call(self._end_jogs).result()
        finally:
            if self._graph is not None:
                self._graph.end()
            self._thread.close()
        if self._graph is not None and self._graph.failures and was_gone is None:
            raise CncError(GONE, f"the machine has ended: {'; '.join(self._graph.failures)}", UNITS_STAND)

    def _stop(self, graph: StartedGraph) -> None:
        """By its PLC: the run is a good one then."""
        if self._is_open and not graph.has_ended:
            with suppress(CncError, CancelledError):
                self._thread.call(partial(ask, PLC, "stop_all", {})).result()
                graph.wait(STOP_TIME)

    def _end_jogs(self, client: MachineClient) -> None:
        for jogging in self._jogs.values():
            jogging.end()


class Jogging:
    """The jog of one axis: messages as long as it lasts, and what the machine says to them."""

    def __init__(self, axis: str, name: str, sender: JogSender) -> None:
        """`name`: of the client."""
        self._axis, self._name = axis, name
        self._sender = sender
        self._records: list[CommandRecord] = []
        self._ignored: Event | None = None
        self._reply: Reply | None = None

    @property
    def is_active(self) -> bool:
        return self._sender.velocity != 0.0

    def ask(self, client: MachineClient, what: str, velocity: float, cycle: int) -> Reply:
        """Sends another velocity and waits for the record of its command; `cycle`: now."""
        if velocity == self._sender.velocity:
            nothing_to_do = Reply(cycle, 0, "", {}, 0)
            return self._reply if self._reply is not None and velocity else nothing_to_do
        self._records.clear()
        self._ignored = None
        heard = client.spin_until(lambda: self._sender.is_heard, PATIENCE)
        if heard:
            self._sender.send(velocity)
        if not heard or not client.spin_until(partial(self._has_answer, client), PATIENCE):
            self.end()
            raise CncError(NO_ANSWER, f"{what}: no answer within {PATIENCE:g} s", "the jog was ended")
        if self._ignored is not None:
            self._sender.velocity = 0.0
            raise CncError(self._ignored.error_id, self._ignored.text, "nothing was changed")
        self._reply = reply_of(self._records[-1])
        if self._reply.error_id:
            self._sender.velocity = 0.0
        return self._reply

    def _has_answer(self, client: MachineClient) -> bool:
        client.take_polled()
        self._sender.keep_alive()
        return bool(self._records) or self._ignored is not None

    def take_record(self, record: CommandRecord) -> None:
        if record_arguments(record).get("velocity") == self._sender.velocity:
            self._records.append(record)

    def take_event(self, event: Event) -> None:
        if event.text in (free_run_text(self._axis), second_client_text(self._axis, self._name)):
            self._ignored = event

    def go_on(self, seen: Observations) -> None:
        """The messages go on as long as the job does."""
        event = seen.job_event(self._axis, self._reply.job) if self._reply is not None else None
        if event is not None and event.status != JobStatus.ACTIVE:
            self.end()
        elif self._reply is not None:
            self._sender.keep_alive()

    def end(self) -> None:
        if self.is_active:
            self._sender.send(0.0)


def ask(unit: str, command: str, arguments: Mapping[str, Any], client: MachineClient) -> Reply:
    """By the service of a unit. Raises CncError 26136."""
    answer = client.ask(unit, command, arguments)
    values = read_values(answer.values_json)
    return Reply(answer.cycle, 0 if answer.accepted else answer.error_id, answer.message, values, answer.job)


def ask_recorder(command: str, arguments: Mapping[str, Any], client: MachineClient) -> Reply:
    """The answer of the recorder. Raises CncError 26136."""
    answer = client.ask_recorder(command, arguments)
    values = read_values(answer.values_json)
    return Reply(answer.cycle, 0 if answer.accepted else answer.error_id, answer.message, values, 0)


def given_set(unit: str, kind: str, values: Mapping[str, Any]) -> ParameterSet:
    """The parameters of a unit as its node has told them."""
    place = Place(f"node /{unit}", 0, 0)
    given = {name: Given(tuple(value) if isinstance(value, list) else value, place) for name, value in values.items()}
    return ParameterSet(unit, kind, place, given)


def wake(future: asyncio.Future[None]) -> None:
    if not future.done():
        future.set_result(None)


def start_graph(options: Mapping[str, Any], *, domain: int | None, namespace: str, timeout: float) -> GraphLink:
    """The link to a graph that it starts. Raises as Machine.start."""
    files = {"scenario": options.get("scenario"), "PLC_file": options.get("plc")}
    check_recording(options.get("record"), machine_file=options["machine"], **files)
    try:
        parameters = read_machine(options["machine"])
    except CncError as error:
        raise error.meaning("nothing was started") from None
    check_plc(parameters, options.get("plc"))
    if (recorder := options.get("recorder")) is not None:
        check_recorder(RecorderOptions(**recorder), options.get("record"), unit_kinds(parameters))
    graph = StartedGraph(options, domain=domain, namespace=namespace)
    try:
        link = GraphLink(domain=domain, namespace=namespace)
    except BaseException:
        graph.end()
        raise
    link.owns(graph)
    link.has_recorder = "recorder" in options
    try:
        link.observe(unit_kinds(parameters), parameters.cycle_time_us * 1e-6)
        graph.wait_until_running(timeout)
        link.wait_until_complete(timeout)
    except BaseException:
        with suppress(CncError):
            link.close()
        raise
    return link


def connect_graph(
    *,
    domain: int | None,
    namespace: str,
    timeout: float,
    kind: type[SomeLink] = GraphLink,  # type: ignore[assignment]
) -> SomeLink:
    """The link to a graph that runs. Raises as Machine.connect."""
    link = kind(domain=domain, namespace=namespace)
    try:
        client = link.find(timeout)
        link.observe(client.kinds, client.cycle_time)
        link.wait_until_complete(timeout)
    except BaseException:
        link.close()
        raise
    return link
