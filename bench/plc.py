"""A PLC beside the mill, over DDS in real time: answers, override topics until they act, four topics at 1 kHz."""

from __future__ import annotations

import os
import re
import subprocess
import sys
import tempfile
import time
from collections.abc import Callable, Iterator, Mapping, Sequence
from concurrent.futures import Future, ProcessPoolExecutor
from contextlib import suppress
from dataclasses import dataclass, field
from itertools import pairwise
from math import nan
from multiprocessing import get_context
from pathlib import Path
from statistics import median, quantiles
from typing import Any

import psutil

from bench import graph_run
from bench.figures import Effort, Figure, ShowProgress
from bench.graph import missing_samples
from bench.jobs import MACHINE

CALLS = 200
FLOODED = ("x", "y", "z", "channel")
PERIOD = 0.001
LEAST_RATE = 0.999 / PERIOD
"""1/s: the sender ends within the last period, so that it is never quite 1 kHz."""
WARM_UP = 15.0
"""Seconds of messages before the memory is read, at most as many as after that: what keeps the last 1000 commands of
each unit has them then."""
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
    core_seconds: float = 0.0
    largest_lag: float = 0.0
    newest_won: int = 0
    """Topics whose last value has won."""
    growth_mb: list[dict[str, float]] = field(default_factory=list)
    """Memory that each process has gained in the first and in the second half of the messages, without the warm-up."""
    lost: float = nan
    """Blocks, as the run tells at its end."""
    missing: int = 0


def figures(effort: Effort, show: ShowProgress) -> Iterator[Figure]:
    """All in one run of the graph."""
    calls, seconds = effort.scaled(CALLS, least=2), effort.graph_seconds
    show(f"{calls} services, {calls} override messages, {seconds:.0f} s at 1 kHz on {len(FLOODED)} topics")
    os.environ["ROS_DOMAIN_ID"] = str(1 + os.getpid() % 100)
    with ProcessPoolExecutor(1, mp_context=get_context("spawn")) as pool:
        run = pool.submit(measure, calls, seconds).result()
    yield Figure("service call to answer, median", median(run.answers), "ms")
    yield Figure("service call to answer, p99", p99(run.answers), "ms", goal=15.0, at_most=True)
    yield Figure("override message to first changed setpoint, median", median(run.reactions), "ms")
    blocks = "the same in blocks that x has published since, p99"
    yield Figure(blocks, p99(run.reaction_blocks), "blocks", goal=2.0, at_most=True)
    yield Figure("the same, largest", max(run.reaction_blocks), "blocks")
    yield Figure(f"seconds of override messages on {len(FLOODED)} topics", run.seconds, "s")
    rate = "override messages per second and topic"
    yield Figure(rate, run.sent / run.seconds, "1/s", goal=LEAST_RATE)
    yield Figure("largest delay of one of them at its sender", 1000.0 * run.largest_lag, "ms")
    sending = 1e6 * run.core_seconds / (run.sent * len(FLOODED))
    yield Figure("time of a core that sending one of them takes, with all threads of DDS", sending, "µs")
    yield Figure("blocks lost", run.lost, "", goal=0.0, at_most=True)
    yield Figure("samples missing in the recording", run.missing, "", goal=0.0, at_most=True)
    yield Figure("topics whose newest value has won", run.newest_won, "", goal=len(FLOODED))
    first, second = run.growth_mb
    yield Figure("memory that all processes have gained in the first half (USS)", sum(first.values()), "MB")
    yield Figure("in the second half", sum(second.values()), "MB")
    for name, gained in second.items():
        yield Figure(f"  {name}", gained, "MB", goal=1.0, at_most=True)


def p99(values: Sequence[float]) -> float:
    return quantiles(values, n=100, method="inclusive")[98]


def measure(calls: int, seconds: float) -> PlcRun:
    """Starts and ends the graph of the mill."""
    import rclpy

    from cnc_ptp.nodes import process

    with tempfile.TemporaryDirectory() as folder:
        record = str(Path(folder) / "run.mcap")
        command = [sys.executable, "-m", "cnc_ptp", "run", MACHINE, "--stay", "--record", record]
        graph = subprocess.Popen(command, stdout=subprocess.PIPE, text=True)  # it tells little, at its end
        try:
            process.initialise()
            run = session(Plc(), psutil.Process(graph.pid), calls, seconds)
        finally:
            graph.terminate()
            told, _ = graph.communicate()
            rclpy.try_shutdown()
        if found := re.search(r"lost (\d+), computed twice", told):
            run.lost = int(found[1])
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
    """One message a millisecond on each topic, by a process that does nothing else; the last value must hold."""
    nodes = {graph_run.node_name(graph_run.words_of(each)): each for each in graph_run.nodes_of(graph)}
    family = {**nodes, graph_run.SUPERVISOR: graph}
    with ProcessPoolExecutor(1, mp_context=get_context("spawn")) as sender:
        warm_up = min(WARM_UP, seconds)
        flooding = sender.submit(send, warm_up + seconds)
        plc.pause(warm_up)
        used = [memory_of(family)]
        for _ in range(2):
            plc.pause(0.5 * seconds)
            used.append(memory_of(family))
        run.sent, run.seconds, run.core_seconds, run.largest_lag, last = plc.result(flooding, seconds + 10.0 * PATIENCE)
    run.growth_mb = [{name: now[name] - before[name] for name in family} for before, now in pairwise(used)]
    with suppress(TimeoutError):  # a value that was lost is a figure, too
        plc.wait(lambda: all(plc.override_of(unit) == last for unit in FLOODED))
    plc.pause(SETTLING)
    run.newest_won = sum(plc.override_of(unit) == last for unit in FLOODED)


def memory_of(family: Mapping[str, psutil.Process]) -> dict[str, float]:
    """MB of each process that it shares with no other: what they share is divided by their number in PSS, which grows
    when the sender ends.
    """
    return {name: float(each.memory_full_info().uss) / 1e6 for name, each in family.items()}


def send(duration: float) -> tuple[int, float, float, float, float]:
    """In its own process, for so many seconds: messages on each topic, seconds that they took, those of a core, the
    largest delay of one, and the last value.

    They are serialised before, so that what is measured is the machine and not a client in Python. It has the priority
    of a usual process: where processors are short, it sends less, and the machine does not fall behind.
    """
    import rclpy
    from rclpy.duration import Duration
    from rclpy.serialization import serialize_message

    from cnc_ptp import msg
    from cnc_ptp.nodes import process
    from cnc_ptp.nodes.topics import PLC_INPUT

    if not rclpy.ok():
        process.initialise()
    node = rclpy.create_node("plc_bench_sender")
    writers = [node.create_publisher(msg.Override, f"/{unit}/override", PLC_INPUT) for unit in FLOODED]
    percents = [50.0 + number * 7 % 41 for number in range(41)]
    texts = [serialize_message(msg.Override(valid=True, percent=percent)) for percent in percents]
    while not all(writer.get_subscription_count() for writer in writers):
        time.sleep(0.01)
    begin, of_core, lag, sent = time.monotonic(), time.process_time(), 0.0, 0
    while sent < duration / PERIOD and time.monotonic() < begin + duration:
        for writer in writers:
            writer.publish(texts[sent % 41])
        sent += 1
        left = begin + sent * PERIOD - time.monotonic()
        lag = max(lag, -left)
        time.sleep(max(0.0, left))
    seconds, of_core = time.monotonic() - begin, time.process_time() - of_core
    for writer in writers:  # the newest value is on its way until then; it is lost with its writer
        writer.wait_for_all_acked(Duration(seconds=PATIENCE))
    node.destroy_node()
    return sent, seconds, of_core, lag, percents[(sent - 1) % 41]


class Plc:
    """A node with one service, four override topics and the blocks of their units."""

    def __init__(self) -> None:
        from rclpy.serialization import deserialize_message

        from cnc_ptp import msg, srv
        from cnc_ptp.nodes import process
        from cnc_ptp.nodes.polling_node import PollingNode
        from cnc_ptp.nodes.topics import BLOCKS, PLC_INPUT, block_topic

        self._node = PollingNode("plc_bench")
        self._srv, self._message = srv, msg.Override
        self.power = self._node.create_client(srv.SetSwitch, "/y/power")
        self._move = self._node.create_client(srv.MoveAbsolute, "/x/move_absolute")
        self._writer = self._node.create_publisher(msg.Override, "/x/override", PLC_INPUT)
        self.blocks: dict[str, bytes] = {}
        self._types = dict.fromkeys(FLOODED, msg.AxisBlock) | {"plc": msg.PlcBlock, "channel": msg.ChannelBlock}
        self._waits, self._read = False, deserialize_message
        self._sent_at = self._published = 0
        for unit, block in self._types.items():
            if unit != "x":
                self._node.create_subscription(block, block_topic(unit), self._keep(unit), BLOCKS, raw=True)
        self._x = self._node.poll(msg.AxisBlock, block_topic("x"), self._keep("x"), BLOCKS)
        self._executor = process.EventsExecutor()
        self._executor.add_node(self._node)

    def _keep(self, unit: str) -> Callable[[bytes], None]:
        """Only what is looked at is deserialised."""
        return lambda block: self.blocks.update({unit: block})

    def _take_x(self) -> None:
        """Blocks of x with the time at which they were published, which the executor does not tell."""
        handle: Any = self._x.handle
        while True:
            with handle:
                taken = handle.take_message(self._x.msg_type, True)
            if taken is None:
                return
            self.blocks["x"], info = taken
            if self._waits and info["source_timestamp"] > self._sent_at:
                self._published += 1
                self._waits = not any(self._block("x").set_acceleration)

    def _block(self, unit: str) -> Any:
        return self._read(self.blocks[unit], self._types[unit])

    def wait(self, condition: Callable[[], Any], patience: float = PATIENCE) -> None:
        deadline = time.monotonic() + patience
        while not condition():
            self._executor.spin_once(timeout_sec=0.005)
            self._take_x()
            if time.monotonic() > deadline:
                raise TimeoutError("the graph does not answer")

    def pause(self, seconds: float) -> None:
        end = time.monotonic() + seconds
        self.wait(lambda: time.monotonic() >= end, seconds + PATIENCE)

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
        """From an override message to the first block of x in which it accelerates: milliseconds and blocks.

        Counted are the blocks that x has published since, by the time at which it did: what this process sees late
        because others have its core is no delay of the machine. The first one may be on its way already.
        """
        self.pause(SETTLING + PAUSE)
        self._published, self._waits, self._sent_at = 0, True, time.time_ns()
        sent = time.perf_counter()
        self._writer.publish(self._message(valid=True, percent=percent))
        self.wait(lambda: not self._waits)
        return 1000.0 * (time.perf_counter() - sent), self._published

    def result(self, future: Future[Any], patience: float) -> Any:
        """Of another process; blocks are read meanwhile."""
        self.wait(future.done, patience)
        return future.result()

    def override_of(self, unit: str) -> float:
        return float(self._block(unit).override_percent[-1])
