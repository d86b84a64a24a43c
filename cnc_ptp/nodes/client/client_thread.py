"""A client of a machine in a thread of its own, which alone uses ROS."""

from __future__ import annotations

import threading
import warnings
from collections import deque
from collections.abc import Callable, Sequence
from concurrent.futures import Future
from contextlib import suppress
from typing import Any, TypeVar

import rclpy
from rclpy.context import Context

from cnc_ptp.nodes import process
from cnc_ptp.nodes.client.machine_client import MachineClient

Result = TypeVar("Result")
PERIOD = 0.005
"""Seconds between two looks for what has come: a process that each block wakes would cost more."""

END_TIME = 5.0
"""Seconds that DDS may take to end: in its version here an end and an announcement can wait for each other for ever
(eProsima/Fast-DDS issue 6502)."""


class ClientThread:
    """Does what it is asked to with its client, one after the other, and calls `after` many times per second."""

    def __init__(
        self, *, domain: int | None, namespace: str, after: Callable[[MachineClient], None], name: str = ""
    ) -> None:
        """`domain`: None = ROS_DOMAIN_ID; `namespace` of the machine; `name` of the node, "" = one of its process.

        `after` is called in the thread.

        Raises CncError 26108 when ROS does not start.
        """
        self._after = after
        self._name = name
        self._calls: deque[tuple[Callable[[MachineClient], Any], Future[Any]]] = deque()
        self._ends = False
        self.failure: Exception | None = None
        """Why the thread has ended before it was to."""
        self._context = Context()
        started: Future[MachineClient] = Future()
        words = ["--ros-args", "-r", f"__ns:=/{namespace.strip('/')}"] if namespace.strip("/") else []
        self._thread = threading.Thread(target=self._run, args=(started, words, domain), name="cnc_ptp", daemon=True)
        self._thread.start()
        self.client = started.result()

    def call(self, function: Callable[[MachineClient], Result]) -> Future[Result]:
        """Has the thread call a function with its client."""
        future: Future[Result] = Future()
        self._calls.append((function, future))
        if self._ends:
            future.cancel()
        return future

    def close(self) -> None:
        """The end of the thread and of its client; a ResourceWarning if DDS has not ended after END_TIME."""
        self._ends = True
        self._thread.join(END_TIME)
        if self._thread.is_alive():
            text = f"the DDS participant of the client has not ended within {END_TIME:g} s; it is left alone"
            warnings.warn(text, ResourceWarning, stacklevel=2)

    def _run(self, started: Future[MachineClient], words: Sequence[str], domain: int | None) -> None:
        try:
            process.initialise(self._context, words=words, domain=domain)
            client = MachineClient(context=self._context, name=self._name)
        except BaseException as error:  # for the thread that waits for it
            started.set_exception(error)
            rclpy.try_shutdown(context=self._context)
            return
        started.set_result(client)
        try:
            while not self._ends:
                client.spin_until(lambda: bool(self._calls) or self._ends, PERIOD)
                self._do_calls(client)
                client.take_polled()
                self._after(client)
        except Exception as error:  # for those who wait for what will not come
            self.failure = error
        finally:
            self._ends = True
            for _, future in self._calls:
                future.cancel()
            client.end()
            with suppress(RuntimeError):
                rclpy.try_shutdown(context=self._context)

    def _do_calls(self, client: MachineClient) -> None:
        while self._calls:
            function, future = self._calls.popleft()
            try:
                future.set_result(function(client))
            except Exception as error:  # for the thread that has asked
                future.set_exception(error)
