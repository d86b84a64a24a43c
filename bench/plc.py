"""A PLC beside the mill, over DDS in real time: answers, override topics until they act, four topics at 1 kHz."""

from __future__ import annotations

import os
import subprocess
import sys
import tempfile
import time
from collections.abc import Callable, Iterator, Sequence
from concurrent.futures import ProcessPoolExecutor
from dataclasses import dataclass, field
from multiprocessing import get_context
from pathlib import Path
from statistics import median, quantiles
from typing import Any

import psutil

from bench.figures import Effort, Figure, ShowProgress
from bench.graph import missing_samples
from bench.graph_run import words_of
from bench.jobs import MACHINE

CALLS = 200
FLOODED = ("x", "y", "z", "channel")
PERIOD = 0.001
BLOCK_CYCLES = 10
PAUSE = 0.0537
"""Seconds between two calls: beats against the blocks, so that calls come at any moment of a block."""
SETTLING = 0.3
VELOCITY = 1.0
PATIENCE = 20.0


@dataclass(slots=True)
class PlcRun:
    """What the PLC has seen; times in ms."""

    answers: list[float] = field(default_factory=list)
    reactions: list[float] = field(default_factory=list)
    reaction_blocks: list[int] = field(default_factory=list)
    sent: int = 0
    seconds: float = 0.0
    newest_won: bool = False
    growth_mb: float = 0.0
    missing: int = 0


def figures(effort: Effort, show: ShowProgress) -> Iterator[Figure]:
    """All in one run of the graph."""
    calls, seconds = effort.scaled(CALLS), effort.graph_seconds
    show(f"{calls} services, {calls} override messages, {seconds:.0f} s at 1 kHz on {len(FLOODED)} topics")
    os.environ["ROS_DOMAIN_ID"] = str(1 + os.getpid() % 100)
    with ProcessPoolExecutor(1, mp_context=get_context("spawn")) as pool:
        run = pool.submit(measure, calls, seconds).result()
    yield Figure("service call to answer, median", median(run.answers), "ms")
    yield Figure("service call to answer, p99", p99(run.answers), "ms", goal=15.0, at_most=True)
    yield Figure("override message to first changed setpoint, median", median(run.reactions), "ms")
    yield Figure("the same in blocks, p99", p99(run.reaction_blocks), "blocks", goal=2.0, at_most=True)
    yield Figure("the same in blocks, largest", max(run.reaction_blocks), "blocks")
    yield Figure("override messages per second and topic", run.sent / run.seconds, "1/s", goal=1000.0)
    yield Figure("samples missing in the recording", run.missing, "", goal=0.0, at_most=True)
    yield Figure("topics whose newest value has won", len(FLOODED) * run.newest_won, "", goal=len(FLOODED))
    yield Figure("memory that the bridge has gained meanwhile (PSS)", run.growth_mb, "MB", goal=1.0, at_most=True)


def p99(values: Sequence[float]) -> float:
    return quantiles(values, n=100, method="inclusive")[98]


def measure(calls: int, seconds: float) -> PlcRun:
    """Starts and ends the graph of the mill."""
    import rclpy

    from cnc_ptp.nodes import process

    with tempfile.TemporaryDirectory() as folder:
        record = str(Path(folder) / "run.mcap")
        command = [sys.executable, "-m", "cnc_ptp", "run", MACHINE, "--stay", "--record", record]
        graph = subprocess.Popen(command, stdout=subprocess.DEVNULL)
        try:
            process.initialise()
            run = session(Plc(), psutil.Process(graph.pid), calls, seconds)
        finally:
            graph.terminate()
            graph.wait()
            rclpy.try_shutdown()
        run.missing = missing_samples(record)
    return run


def session(plc: Plc, graph: psutil.Process, calls: int, seconds: float) -> PlcRun:
    run = PlcRun()
    plc.wait(lambda: plc.blocks.keys() >= {"plc", *FLOODED} and plc.power.service_is_ready())
    run.answers = [plc.answer_time() for _ in range(calls)]
    plc.begin_motion()
    for number in range(calls):
        milliseconds, blocks = plc.reaction(50.0 + 25.0 * (number % 2))
        run.reactions.append(milliseconds)
        run.reaction_blocks.append(blocks)
    flood(plc, graph, seconds, run)
    return run


def flood(plc: Plc, graph: psutil.Process, seconds: float, run: PlcRun) -> None:
    """One message a millisecond on each topic; the last value must hold at the end."""
    bridge = next(each for each in graph.children(recursive=True) if "cnc_ptp.nodes.plc_bridge" in words_of(each))
    plc.flood(1000)
    before = bridge.memory_full_info().pss
    begin, run.sent = time.perf_counter(), round(seconds / PERIOD)
    last = plc.flood(run.sent)
    run.seconds = time.perf_counter() - begin
    run.growth_mb = (bridge.memory_full_info().pss - before) / 1e6
    plc.wait(lambda: all(plc.override_of(unit) == last for unit in FLOODED))
    plc.pause(SETTLING)
    run.newest_won = all(plc.override_of(unit) == last for unit in FLOODED)


class Plc:
    """A node with one service, four override topics and the blocks of their units."""

    def __init__(self) -> None:
        import rclpy
        from rclpy.serialization import deserialize_message, serialize_message

        from cnc_ptp import msg, srv
        from cnc_ptp.nodes import process
        from cnc_ptp.nodes.topics import BLOCKS, PLC_INPUT, block_topic

        self._node = rclpy.create_node("plc_bench")
        self._srv, self._message = srv, msg.Override
        self.power = self._node.create_client(srv.SetSwitch, "/y/power")
        self._move = self._node.create_client(srv.MoveAbsolute, "/x/move_absolute")
        self._writers = {
            unit: self._node.create_publisher(msg.Override, f"/{unit}/override", PLC_INPUT) for unit in FLOODED
        }
        self.blocks: dict[str, bytes] = {}
        self._types = dict.fromkeys(FLOODED, msg.AxisBlock) | {"plc": msg.PlcBlock, "channel": msg.ChannelBlock}
        self._changed: Any = None
        self._waits, self._read, self._written = False, deserialize_message, serialize_message
        for unit, block in self._types.items():
            self._node.create_subscription(block, block_topic(unit), self._keep(unit), BLOCKS, raw=True)
        self._executor = process.EventsExecutor()
        self._executor.add_node(self._node)

    def _keep(self, unit: str) -> Callable[[bytes], None]:
        """Only what is looked at is deserialised."""

        def keep(block: bytes) -> None:
            self.blocks[unit] = block
            if unit == "x" and self._waits and any((read := self._block("x")).set_acceleration):
                self._changed, self._waits = read, False

        return keep

    def _block(self, unit: str) -> Any:
        return self._read(self.blocks[unit], self._types[unit])

    def wait(self, condition: Callable[[], Any]) -> None:
        deadline = time.monotonic() + PATIENCE
        while not condition():
            self._executor.spin_once(timeout_sec=0.005)
            if time.monotonic() > deadline:
                raise TimeoutError("the graph does not answer")

    def pause(self, seconds: float) -> None:
        end = time.monotonic() + seconds
        self.wait(lambda: time.monotonic() >= end)

    def answer_time(self) -> float:
        """Milliseconds from a call of a service of an axis at a standstill to its answer."""
        self.pause(PAUSE)
        called = time.perf_counter()
        answer = self.power.call_async(self._srv.SetSwitch.Request(enabled=True))
        self.wait(answer.done)
        assert answer.result().accepted
        return 1000.0 * (time.perf_counter() - called)

    def begin_motion(self) -> None:
        """Axis x moves slowly, for long."""
        answer = self._move.call_async(self._srv.MoveAbsolute.Request(target=250.0, velocity=VELOCITY))
        self.wait(answer.done)
        assert answer.result().accepted
        self.pause(SETTLING)

    def reaction(self, percent: float) -> tuple[float, int]:
        """From an override message to the first block of x in which it accelerates: milliseconds and blocks."""
        self.pause(SETTLING + PAUSE)
        self._changed, self._waits, newest = None, True, self._block("plc").first_cycle
        sent = time.perf_counter()
        self._writers["x"].publish(self._message(valid=True, percent=percent))
        self.wait(lambda: self._changed is not None)
        return 1000.0 * (time.perf_counter() - sent), (self._changed.first_cycle - newest) // BLOCK_CYCLES

    def flood(self, messages: int) -> float:
        """The last value that was sent, on all topics."""
        begin, percent = time.monotonic(), 0.0
        for number in range(messages):
            percent = 50.0 + number * 7 % 41
            message = self._written(self._message(valid=True, percent=percent))
            for writer in self._writers.values():
                writer.publish(message)
            while (left := begin + (number + 1) * PERIOD - time.monotonic()) > 0.0:
                self._executor.spin_once(timeout_sec=left)
        return percent

    def override_of(self, unit: str) -> float:
        return float(self._block(unit).override_percent[-1])
