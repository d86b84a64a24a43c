"""Services of the recorder: /recorder/start, /recorder/stop, /recorder/snapshot."""

from __future__ import annotations

from collections.abc import Callable
from functools import partial
from typing import Any

from rclpy.node import Node

from cnc_ptp.errors import CncError
from cnc_ptp.nodes.bridge.coupling_services import answered
from cnc_ptp.nodes.topics import RECORDER_SERVICES
from cnc_ptp.protocol.blocks import json_of
from cnc_ptp.recording.on_demand import NOT_CHANGED, RECORDER, Answer, OnDemand

NOT_BEGUN = 26196
Done = Callable[[Answer], None]


class RecordingServices:
    """Asks the recording; answers when it has answered, which for a stop and a snapshot is later.

    Responses that come later are sent in place of those that the executor would send (coupling_services says why).
    """

    def __init__(self, node: Node, recording: Callable[[], OnDemand | None]) -> None:
        """`recording`: None as long as the machine has not begun."""
        self._recording = recording
        self._open: dict[int, Any] = {}
        """Responses that are not known yet, by their identity."""
        self._send_later: dict[int, Callable[[], None]] = {}
        asked = {"start": self._start, "stop": self._stop, "snapshot": self._snapshot}
        for name, service_type in RECORDER_SERVICES.items():
            service: Any = node.create_service(service_type, f"~/{name}", partial(self._ask, name, asked[name]))
            service.send_response = partial(self._send, service.send_response)

    def _ask(self, name: str, ask: Callable[[OnDemand, Any, Done], None], request: Any, response: Any) -> Any:
        """Fills in the response, or leaves it to `_answer`."""
        recording = self._recording()
        self._open[id(response)] = response
        try:
            if recording is None:
                reason = "the machine has not begun"
                raise CncError(NOT_BEGUN, reason, NOT_CHANGED, where=f"{RECORDER}: {name} refused")
            ask(recording, request, partial(self._answer, response))
        except CncError as error:
            self._answer(response, Answer(error=error))
        return response

    def _start(self, recording: OnDemand, request: Any, done: Done) -> None:
        done(recording.start(request.file))

    def _stop(self, recording: OnDemand, request: Any, done: Done) -> None:
        recording.stop(done)

    def _snapshot(self, recording: OnDemand, request: Any, done: Done) -> None:
        recording.snapshot(request.file, request.seconds, request.until, done)

    def _answer(self, response: Any, answer: Answer) -> None:
        error = answer.error
        response.cycle = answer.cycle
        if error is None:
            answered(response, 0, answer.warning)
        else:
            answered(response, error.number, error.message, json_of(error.values))
        del self._open[id(response)]
        self._send_later.pop(id(response), lambda: None)()

    def _send(self, send: Callable[..., None], response: Any, header: Any) -> None:
        """In place of Service.send_response, which the executor calls after the callback."""
        if id(response) in self._open:
            self._send_later[id(response)] = partial(send, response, header)
        else:
            send(response, header)
