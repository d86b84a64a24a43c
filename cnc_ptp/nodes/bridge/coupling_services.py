"""Services that couple axes. The PLC node answers them for all axes: only it knows the present masters of all."""

from __future__ import annotations

import time
from collections.abc import Callable
from dataclasses import dataclass
from functools import partial
from typing import Any

from rclpy.qos import QoSProfile, QoSReliabilityPolicy

from cnc_ptp import msg
from cnc_ptp.errors import CncError
from cnc_ptp.machine.command_files import with_table
from cnc_ptp.nodes import process
from cnc_ptp.nodes.convert import message_of
from cnc_ptp.nodes.topics import COMMAND, COUPLING_SERVICES
from cnc_ptp.nodes.unit.requests import RUN_OVER, given_arguments
from cnc_ptp.nodes.unit.unit_node import UnitNode
from cnc_ptp.parameters.view.authority import OF_SERVICES
from cnc_ptp.plc.plc_unit import PlcUnit
from cnc_ptp.protocol.blocks import Command, json_of
from cnc_ptp.protocol.commands import BAD_ARGUMENT, COMMANDS
from cnc_ptp.protocol.unit import UPSTREAM_LOST

NEW_RECORDS = QoSProfile(depth=1000, reliability=QoSReliabilityPolicy.RELIABLE)
NOT_ANSWERED = 26143
PATIENCE = 5.0
"""Seconds after which a call is answered without an answer of the axis."""
WATCH_PERIOD = 0.25


@dataclass(slots=True)
class Call:
    """A call whose answer is still to come."""

    command: Command
    response: Any
    deadline: float
    send: Callable[[], None] = lambda: None
    """Sends the response."""


class CouplingServices:
    """/<axis>/couple and its kinds: the command goes out with the next PLC block, the axis' record is the answer.

    Responses are sent when they are known, not returned by a coroutine that awaits them: EventsExecutor would poll it
    without a pause.
    """

    def __init__(self, node: UnitNode, plc: PlcUnit, axes: list[str]) -> None:
        self._node = node
        self._plc = plc
        self._open: list[Call] = []
        node.poll(msg.CommandRecord, COMMAND, self._on_record, NEW_RECORDS)
        process.timer(node, WATCH_PERIOD, self._watch)
        for axis in axes:
            for command, service_type in COUPLING_SERVICES.items():
                asked = partial(self._couple, axis, command)
                service: Any = node.create_service(service_type, f"{axis}/{command}", asked)
                service.send_response = partial(self._send, service.send_response)

    def _couple(self, axis: str, command: str, request: Any, response: Any) -> Any:
        """Passes the command on, or fills in why not."""
        try:
            arguments = self._arguments(axis, command, request)
        except CncError as error:
            return answered(response, error.number, error.message, json_of(error.values))
        if self._node.is_over:
            text = f"axis {axis}: {command} refused: the run has ended; nothing was changed"
            return answered(response, RUN_OVER, text)
        if self._plc.is_lost(axis):
            text = f"axis {axis}: {command} refused: its node is lost; nothing was changed"
            return answered(response, UPSTREAM_LOST, text)
        asked = Command(axis, command, arguments)
        if closed := self._node.why_closed(asked, OF_SERVICES):
            return answered(response, closed.number, closed.message)
        self._plc.input(asked)
        self._open.append(Call(asked, response, time.monotonic() + PATIENCE))
        return response

    def _arguments(self, axis: str, command: str, request: Any) -> dict[str, Any]:
        arguments = given_arguments(COMMANDS["axis"][command], request)
        if "table" not in COMMANDS["axis"][command]:
            return arguments
        points = pairs_of(request, f"axis {axis}: {command} refused")
        if not points:
            return with_table({"file": "", **arguments}, "table")
        arguments.pop("file", None)
        return {**arguments, "table": points}

    def _send(self, send: Callable[..., None], response: Any, header: Any) -> None:
        """In place of Service.send_response, which the executor calls after the callback."""
        call = next((call for call in self._open if call.response is response), None)
        if call is None:
            send(response, header)
        else:
            call.send = partial(send, response, header)

    def _on_record(self, data: bytes) -> None:
        """Ids count per sender, and couplings of axes come from the PLC alone."""
        if not self._open:
            return
        record = message_of(data, msg.CommandRecord)
        for call in self._open:
            asked = call.command
            if asked.id and (asked.id, asked.target, asked.command) == (record.id, record.target, record.command):
                call.response.cycle, call.response.job = record.cycle, record.job
                self._answer(call, record.error_id, record.message, record.values_json)
                return

    def _watch(self) -> None:
        for call in [*self._open]:
            what = f"axis {call.command.target}: {call.command.command}"
            if self._plc.is_lost(call.command.target):
                self._answer(call, UPSTREAM_LOST, f"{what} without an answer: its node is lost")
            elif time.monotonic() > call.deadline:
                reason = f"{what} without an answer for {PATIENCE:g} s"
                self._answer(call, NOT_ANSWERED, f"{reason}; {self._withdraw(call)}")

    def _withdraw(self, call: Call) -> str:
        if self._plc.withdraw(call.command):
            return "no block has gone out, the command was withdrawn"
        return "the command has gone out and may still be carried out"

    def end(self) -> None:
        """The run has ended: all pending calls are answered."""
        for call in [*self._open]:
            what = f"axis {call.command.target}: {call.command.command}"
            self._answer(call, RUN_OVER, f"{what} without an answer: the run has ended")

    def _answer(self, call: Call, error_id: int, message: str, values_json: str = "") -> None:
        self._open.remove(call)
        answered(call.response, error_id, message, values_json)
        call.send()


def answered(response: Any, error_id: int, message: str, values_json: str = "") -> Any:
    """The response with its fields set; `error_id` 0 = accepted."""
    response.accepted, response.error_id, response.message = error_id == 0, error_id, message
    response.values_json = values_json
    return response


def pairs_of(request: Any, where: str) -> list[list[float]]:
    """The points of a cam in a request. Raises CncError 22001 where a master or slave position is missing."""
    masters, slaves = len(request.master_points), len(request.slave_points)
    if masters != slaves:
        reason = f"{masters} master_points and {slaves} slave_points are no pairs"
        raise CncError(BAD_ARGUMENT, reason, "nothing was changed", where=where)
    return [[master, slave] for master, slave in zip(request.master_points, request.slave_points, strict=True)]
