"""From a service call to the first setpoint that it changes, over DDS, in a graph of five processes in real time."""

from __future__ import annotations

import os
import subprocess
import sys
import time
from collections.abc import Iterator
from concurrent.futures import ProcessPoolExecutor
from multiprocessing import get_context
from statistics import median, quantiles
from typing import Any

from bench.figures import Effort, Figure, ShowProgress

MACHINE = "config/ptp.yaml"
CALLS = 300
PAUSE = 0.1437
"""Seconds between two calls: beats against the blocks, so that calls come at any moment of a block."""
STEP = 0.1
PATIENCE = 20.0


def figures(effort: Effort, show: ShowProgress) -> Iterator[Figure]:
    """Starts the graph, calls `move_relative` of an axis at a standstill again and again."""
    calls = effort.scaled(CALLS)
    show(f"{calls} service calls")
    os.environ["ROS_DOMAIN_ID"] = str(101 + os.getpid() % 100)
    with ProcessPoolExecutor(1, mp_context=get_context("spawn")) as pool:
        times = pool.submit(measure, calls).result()
    answers, setpoints = (sorted(column) for column in zip(*times, strict=True))
    yield Figure("service calls that moved the axis", len(times), "", goal=calls)
    yield Figure("call to answer, median", median(answers), "ms")
    yield Figure("call to first changed setpoint, median", median(setpoints), "ms")
    yield Figure("call to first changed setpoint, p99", quantiles(setpoints, n=100)[98], "ms", goal=25.0, at_most=True)
    yield Figure("call to first changed setpoint, largest", setpoints[-1], "ms")


def measure(calls: int) -> list[tuple[float, float]]:
    """Milliseconds from each call to its answer, and to the arrival of the block with the first changed setpoint."""
    import rclpy

    from cnc_ptp.nodes import process

    duration = 5.0 + calls * (PAUSE + 0.1)
    command = [sys.executable, "-m", "cnc_ptp", "run", MACHINE, "--duration", str(duration)]
    graph = subprocess.Popen(command, stdout=subprocess.DEVNULL)
    try:
        process.initialise()
        client = Client()
        times = [client.call(calls_before % 2 == 0) for calls_before in range(calls)]
    finally:
        graph.terminate()
        graph.wait()
        rclpy.try_shutdown()
    return times


class Client:
    """One service of one axis, and its blocks."""

    def __init__(self) -> None:
        import rclpy

        from cnc_ptp import msg, srv
        from cnc_ptp.nodes import process
        from cnc_ptp.nodes.topics import BLOCKS, block_topic

        self._node = rclpy.create_node("service_bench")
        self._request = srv.MoveRelative.Request
        self._service = self._node.create_client(srv.MoveRelative, "/x/move_relative")
        self._moving_at: float | None = None
        self._standing = False
        self._node.create_subscription(msg.AxisBlock, block_topic("x"), self._on_block, BLOCKS)
        self._executor = process.EventsExecutor()
        self._executor.add_node(self._node)

    def _on_block(self, block: Any) -> None:
        moves = any(block.set_velocity)
        self._standing = not moves
        if moves and self._moving_at is None:
            self._moving_at = time.perf_counter()

    def _wait(self, condition: Any) -> None:
        deadline = time.monotonic() + PATIENCE
        while not condition():
            self._executor.spin_once(timeout_sec=0.005)
            if time.monotonic() > deadline:
                raise TimeoutError("the graph does not answer")

    def call(self, forwards: bool) -> tuple[float, float]:
        """Waits for standstill, calls, waits for answer and motion."""
        self._wait(lambda: self._standing and self._service.service_is_ready())
        pause = time.monotonic() + PAUSE
        self._wait(lambda: time.monotonic() >= pause)
        self._moving_at = None
        called = time.perf_counter()
        answer = self._service.call_async(self._request(distance=STEP if forwards else -STEP))
        self._wait(answer.done)
        answered = time.perf_counter()
        self._wait(lambda: self._moving_at is not None)
        assert self._moving_at is not None and answer.result().accepted
        return 1000.0 * (answered - called), 1000.0 * (self._moving_at - called)
