"""Services that couple axes. The PLC node answers them for all axes: it alone sees who is whose master already."""

from __future__ import annotations

from collections import defaultdict, deque
from functools import partial
from typing import Any

from rclpy.qos import QoSProfile, QoSReliabilityPolicy
from rclpy.task import Future

from cnc_ptp import msg
from cnc_ptp.errors import CncError
from cnc_ptp.machine.blocks import Command
from cnc_ptp.machine.cam_file import parse_cam
from cnc_ptp.machine.commands import COMMANDS
from cnc_ptp.machine.job import read_file
from cnc_ptp.machine.unit import UPSTREAM_LOST
from cnc_ptp.nodes.requests import given_arguments
from cnc_ptp.nodes.topics import COMMAND, COUPLING_SERVICES

NEW_RECORDS = QoSProfile(depth=1000, reliability=QoSReliabilityPolicy.RELIABLE)


class CouplingServices:
    """/<axis>/couple and its kinds: the command goes out with the next PLC block, the axis' record is the answer."""

    def __init__(self, node: Any, axes: list[str]) -> None:
        self._node = node
        self._waiting: defaultdict[tuple[str, str], deque[Future]] = defaultdict(deque)
        node.create_subscription(msg.CommandRecord, COMMAND, self._on_record, NEW_RECORDS)
        for axis in axes:
            for command, service_type in COUPLING_SERVICES.items():
                node.create_service(service_type, f"/{axis}/{command}", partial(self._couple, axis, command))

    async def _couple(self, axis: str, command: str, request: Any, response: Any) -> Any:
        try:
            arguments = self._arguments(command, request)
        except CncError as error:
            response.accepted, response.error_id, response.message = False, error.error_id, error.message
            return response
        if self._node.unit.is_lost(axis):
            response.error_id, response.message = UPSTREAM_LOST, f"axis {axis}: {command} refused: its node is lost"
            return response
        answer = Future()
        self._waiting[axis, command].append(answer)
        self._node.input(Command(axis, command, arguments))
        record = await answer
        response.accepted, response.error_id = record.accepted, record.error_id
        response.message, response.cycle = record.message, record.cycle
        return response

    def _arguments(self, command: str, request: Any) -> dict[str, Any]:
        arguments = given_arguments(COMMANDS["axis"][command], request)
        if "table" in COMMANDS["axis"][command]:
            arguments["table"] = parse_cam(read_file("cam file", request.file), request.file)
        return arguments

    def _on_record(self, record: msg.CommandRecord) -> None:
        waiting = self._waiting.get((record.target, record.command))
        if waiting:
            waiting.popleft().set_result(record)
