"""Commands that wait for their answers beside each other, while blocks go on being taken."""

from __future__ import annotations

import time
from collections.abc import Mapping
from concurrent.futures import Future
from dataclasses import dataclass
from typing import Any

from rclpy.client import Client

from cnc_ptp.errors import CncError
from cnc_ptp.nodes.bridge.coupling_services import PATIENCE as COUPLING_PATIENCE
from cnc_ptp.nodes.client.machine_client import MARGIN, NO_ANSWER, PATIENCE, MachineClient, services_of
from cnc_ptp.nodes.client.requests import request_of
from cnc_ptp.nodes.topics import COUPLING_SERVICES, RECORDER, RECORDER_SERVICES

SNAPSHOT_PATIENCE = 20.0
"""Seconds for a snapshot to be written."""


@dataclass(slots=True)
class Call:
    """A command on its way."""

    what: str
    client: Client[Any, Any]
    request: Any
    deadline: float
    patience: float
    answer: Future[Any]
    sent: Any = None


class CallsInFlight:
    """All methods are called in the thread of the client."""

    def __init__(self) -> None:
        self._clients: dict[tuple[str, str], Client[Any, Any]] = {}
        self._calls: list[Call] = []

    def prepare(self, client: MachineClient, unit: str, command: str) -> None:
        """The service is looked for, so that the first command need not wait for that."""
        if (unit, command) not in self._clients:
            service = services_of(client.kinds[unit])[command]
            self._clients[unit, command] = client.create_client(service, f"{unit}/{command}")

    def begin(
        self, client: MachineClient, unit: str, command: str, arguments: Mapping[str, Any], answer: Future[Any]
    ) -> None:
        """`answer` gets the response, or CncError 26136 when none comes in time. Its caller has set it running."""
        self.prepare(client, unit, command)
        patience = COUPLING_PATIENCE + MARGIN if command in COUPLING_SERVICES else PATIENCE
        request = request_of(services_of(client.kinds[unit])[command], arguments)
        what = f"{client.kinds[unit]} {unit}: {command}"
        self._begin(what, self._clients[unit, command], request, patience, answer)

    def begin_snapshot(self, client: MachineClient, arguments: Mapping[str, Any], answer: Future[Any]) -> None:
        """Of the recorder; as `begin`."""
        command = "snapshot"
        if (RECORDER, command) not in self._clients:
            service = RECORDER_SERVICES[command]
            self._clients[RECORDER, command] = client.create_client(service, f"{RECORDER}/{command}")
        request = request_of(RECORDER_SERVICES[command], arguments)
        self._begin(f"{RECORDER}: {command}", self._clients[RECORDER, command], request, SNAPSHOT_PATIENCE, answer)

    def _begin(self, what: str, client: Client[Any, Any], request: Any, patience: float, answer: Future[Any]) -> None:
        self._calls.append(Call(what, client, request, time.monotonic() + patience, patience, answer))
        self.go_on()

    def go_on(self) -> None:
        """Sends what can be sent, gives the answers that have come."""
        self._calls = [call for call in self._calls if not self._has_ended(call)]

    @staticmethod
    def _has_ended(call: Call) -> bool:
        if call.answer.cancelled():
            return True
        if call.sent is None and call.client.service_is_ready():
            call.sent = call.client.call_async(call.request)
        if call.sent is not None and call.sent.done():
            call.answer.set_result(call.sent.result())
            return True
        if time.monotonic() > call.deadline:
            text = f"{call.what}: no answer within {call.patience:g} s"
            effect = "whether it was carried out is not known, see `cnc_ptp status`"
            call.answer.set_exception(CncError(NO_ANSWER, text, effect))
            return True
        return False
