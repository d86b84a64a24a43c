"""All nodes of a machine in this process: their receivers get messages, requests and goals as from an executor.

The nodes are those of `cnc_ptp run --composed`, without its executor: ticks are given by hand, the answers of services
and the goals of actions end here. What a node publishes goes through DDS.
"""

from __future__ import annotations

import os
import time
from collections.abc import Callable, Iterator, Mapping
from contextlib import ExitStack, chdir, contextmanager
from functools import partial
from pathlib import Path
from typing import Any, NamedTuple
from unittest.mock import patch

import rclpy
from rclpy.action import CancelResponse, GoalResponse
from rclpy.action.server import GoalEvent
from rclpy.node import Node
from rclpy.serialization import serialize_message
from rclpy.service import Service

from bench.checked_machine import UNCHANGED, Checks, Record, bits, content_of
from bench.fuzzing.engine import Broken, objection
from campaign.graph import free_domain
from cnc_ptp.errors import CncError
from cnc_ptp.nodes import process
from cnc_ptp.nodes.bridge import function_blocks
from cnc_ptp.nodes.clock import ClockNode
from cnc_ptp.nodes.composed import unit_nodes
from cnc_ptp.nodes.events import EventPublisher
from cnc_ptp.nodes.handover import Handover
from cnc_ptp.nodes.monitor import RunMonitor
from cnc_ptp.nodes.plc_bridge import PlcBridgeNode
from cnc_ptp.nodes.polling_node import PollingNode
from cnc_ptp.nodes.recorder import RecorderNode
from cnc_ptp.nodes.supervisor import RunOptions
from cnc_ptp.nodes.unit import jobs
from cnc_ptp.parameters import machine_text, read_machine
from cnc_ptp.protocol.blocks import Command, Severity
from cnc_ptp.protocol.unit import PLC
from cnc_ptp.recording.recorder_options import RecorderOptions
from cnc_ptp.state.machine_state import StateStore
from cnc_ptp.wire.block_codec import codec_of, encode_block
from cnc_ptp.wire.stamps import Stamps
from cnc_ptp.wire.ticks import Tick

STAMPS = Stamps(0, 1_000_000)
TOPIC, SERVICE, ACTION = "topic", "service", "action"
OF_RCLPY = "/get_type_description"
"""A service that rcl answers alone."""
KEPT = 0.2
"""Seconds that the recorder keeps for snapshots."""


class Input(NamedTuple):
    """A door of a node: name without the namespace, as in docs/interfaces.md."""

    kind: str
    node: str
    name: str
    type: Any
    receive: Any
    raw: bool = False

    @property
    def key(self) -> tuple[str, str, str]:
        return self.kind, self.node, self.name


class Goal:
    """In place of ServerGoalHandle: raises Broken where rcl would refuse a change of its state."""

    def __init__(self, request: Any) -> None:
        self.request = request
        self.is_cancel_requested = self.ended = False
        self.result: Any = None

    def _update_state(self, event: Any) -> None:
        if self.ended:
            raise Broken(f"{event} of a goal that has ended")
        self.is_cancel_requested = self.is_cancel_requested or event == GoalEvent.CANCEL_GOAL

    def _end(self) -> None:
        if self.ended:
            raise Broken("a goal ends twice")
        self.ended = True

    succeed = abort = _end

    def canceled(self) -> None:
        if not self.is_cancel_requested:
            raise Broken("a goal is canceled that nobody has canceled")
        self._end()

    def publish_feedback(self, feedback: Any) -> None:
        serialize_message(feedback)


class Actions:
    """In place of the ActionServers of a node."""

    def __init__(self) -> None:
        self.inputs: list[Input] = []

    def __call__(self, node: Node, of: Any, name: str, _execute: Any, **callbacks: Any) -> Actions:
        self.inputs.append(Input(ACTION, node.get_name(), name, of, partial(self._take, callbacks)))
        return self

    def notify_execute(self, goal: Goal, conclude: Callable[[Goal], Any]) -> None:
        goal.result = conclude(goal)
        serialize_message(goal.result)
        if not goal.ended:
            raise Broken("a goal has a result and has not ended")

    def _take(self, callbacks: Mapping[str, Any], request: Any, *, cancelled: bool) -> Goal | None:
        """None for a goal that is rejected."""
        accepts = callbacks.get("goal_callback", lambda request: GoalResponse.ACCEPT)
        if accepts(request) != GoalResponse.ACCEPT:
            return None
        goal = Goal(request)
        callbacks["handle_accepted_callback"](goal)
        if cancelled and not goal.ended and callbacks["cancel_callback"](goal) == CancelResponse.ACCEPT:
            goal._update_state(GoalEvent.CANCEL_GOAL)
        return goal


class Graph(Checks):
    """Nodes, their doors, and what they say. One at a time; `close` ends it."""

    def __init__(self, file: Path, folder: Path) -> None:
        """`folder`: working directory and place of recordings."""
        super().__init__()
        self.events: list[Any] = []
        self._stack = ExitStack()
        self._cycle, self._blocks, actions = 0, dict[str, Any](), Actions()
        self._patch(actions)
        process.initialise(domain=free_domain(os.getpid()))
        self._stack.callback(rclpy.try_shutdown)
        self._stack.enter_context(process.claim_domain())
        self._stack.enter_context(chdir(folder))
        machine, handover = read_machine(str(file)), Handover()
        self._store = StateStore(machine)
        options, keep = RunOptions(str(file), stay=True), RecorderOptions(keep=KEPT)
        recorder = RecorderNode(machine, None, machine_text(str(file)), options=keep, handover=handover)
        self.units = {node.unit.name: node for node in unit_nodes(machine, options, checkpoints=0.1, handover=handover)}
        clock, monitor = ClockNode(machine, handover=handover), RunMonitor(machine, handover=handover)
        self.nodes: list[PollingNode] = [recorder, *self.units.values(), clock, monitor]
        self._handover = handover
        for unit in self.units:
            handover.on_block(unit, partial(self._blocks.__setitem__, unit))
        self.inputs = {each.key: each for each in (*doors_of(self.nodes), *actions.inputs)}
        self._count, self._cycle_ns = machine.block_cycles, machine.cycle_time_us * 1000
        self.tick()

    def _patch(self, actions: Actions) -> None:
        for where, name, what in (
            (jobs, "ActionServer", actions),
            (function_blocks, "ActionServer", actions),
            (process, "take_priority", lambda threads=None: None),
            (Service, "send_response", lambda service, response, header: header.append(response)),
            (EventPublisher, "publish", self._on_event(EventPublisher.publish)),
        ):
            self._stack.enter_context(patch.object(where, name, what))

    def _on_event(self, publish: Callable[..., None]) -> Callable[..., None]:
        def published(publisher: EventPublisher, event: Any) -> None:
            self.events.append(event)
            publish(publisher, event)

        return published

    @property
    def over(self) -> bool:
        return bool(self._blocks[PLC].run_done)

    def close(self) -> None:
        try:
            for node in self.nodes:
                node.destroy_node()
        finally:
            self._stack.close()

    # steps

    def tick(self) -> None:
        """A block of all units, in real time as far as they know."""
        now = time.monotonic_ns()
        self._handover.tick(Tick(self._cycle, self._count, now, self._cycle * self._cycle_ns))
        self._cycle += self._count
        for name, block in self._blocks.items():
            self.check_block(name, block)
            codec_of(type(block)).decode(encode_block(block, STAMPS))
        self.check_owners(self._blocks)

    def set_free(self) -> None:
        """As somebody who wants to go on: nothing is held, errors are reset, the power is on."""
        plc = self.units[PLC]
        plc.command(Command(PLC, "emergency_stop", {"enabled": False}))
        plc.command(Command(PLC, "reset", {}))
        for name, node in self.units.items():
            for command in ("hold_stop", "feed_hold"):
                if name != PLC:
                    node.command(Command(name, command, {"enabled": False}))
            if node.unit.kind in ("axis", "spindle"):
                node.command(Command(name, "power", {"enabled": True}))
        self.tick()

    def message(self, given: Input, message: Any) -> None:
        """A message, or its bytes, comes to a node."""
        with self._handed_on():
            given.receive(message)
            plc = self.units[PLC]
            assert isinstance(plc, PlcBridgeNode)
            plc.take_inputs()

    def call(self, given: Input, request: Any) -> Any:
        """A request; its answer, if there is one already. A refusal that says so has changed nothing."""
        answers: list[Any] = []
        unit = self.units.get(given.name.partition("/")[0])
        before, left = self._content(unit), None if unit is None else Record(unit.unit)
        with self._handed_on():
            service = given.receive
            service.send_response(service.callback(request, given.type.Response()), answers)
        for answer in answers:
            serialize_message(answer)
            if left is not None and refuses(answer):
                with left.taken_away():
                    self.require(before == self._content(unit), f"a refusal has changed something: {answer.message}")
        return answers[0] if answers else None

    def goal(self, given: Input, request: Any, *, cancelled: bool) -> Goal | None:
        with self._handed_on():
            return given.receive(request, cancelled=cancelled)

    def _content(self, node: Any) -> bytes:
        """Of the unit of a node; the PLC's is not kept: it has callbacks of its node."""
        if node is None or node.unit.kind == PLC:
            return b""
        return bits(content_of(self._store, node._runner, self._cycle))

    @contextmanager
    def _handed_on(self) -> Iterator[None]:
        """A CncError that leaves a callback ends its node."""
        try:
            yield
        except CncError as error:
            raise Broken(f"the node would end: {error}") from error

    def check(self) -> None:
        """Raises Broken where a node would have ended, or an invariant does not hold; CncError for what was told."""
        for node in self.nodes:
            if failure := getattr(node, "failure", None):
                raise Broken(f"node {node.get_name()} would end: {failure}")
        if self.violations:
            raise Broken(self.violations[0])
        events, self.events = self.events, []
        faults = [CncError(each.error_id, each.text) for each in events if each.severity >= Severity.WARNING]
        for fault in faults:
            if reason := objection(fault):
                raise Broken(reason)
        if faults:
            raise faults[0]


def refuses(answer: Any) -> bool:
    """It says that nothing was changed."""
    return not getattr(answer, "accepted", True) and any(text in answer.message for text in UNCHANGED)


def doors_of(nodes: list[PollingNode]) -> Iterator[Input]:
    """Subscriptions, those that wake nobody as well, and services."""
    for node in nodes:
        for each in super(PollingNode, node).subscriptions:
            name = each.topic_name.removeprefix("/")
            yield Input(TOPIC, node.get_name(), name, each.msg_type, each.callback, raw=each.raw)
        for service in node.services:
            if not service.service_name.endswith(OF_RCLPY):
                yield Input(SERVICE, node.get_name(), service.service_name.removeprefix("/"), service.srv_type, service)
