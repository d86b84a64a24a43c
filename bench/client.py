"""A test of a machine by `cnc_ptp.client`: offline, and in a graph that is started and ended for it."""

from __future__ import annotations

import os
import time
from collections.abc import Iterator
from concurrent.futures import ProcessPoolExecutor
from multiprocessing import get_context
from statistics import median

from bench.figures import Effort, Figure, ShowProgress
from bench.jobs import MACHINE
from cnc_ptp.client import Machine


def figures(effort: Effort, show: ShowProgress) -> Iterator[Figure]:
    """The same calls both ways, each in a process of its own."""
    show("offline")
    with ProcessPoolExecutor(1, mp_context=get_context("spawn")) as pool:
        offline = median(pool.submit(offline_seconds).result() for _ in range(max(2, effort.runs)))
    show("in the graph, 8 processes")
    os.environ["ROS_DOMAIN_ID"] = str(101 + os.getpid() % 100)
    with ProcessPoolExecutor(1, mp_context=get_context("spawn")) as pool:
        graph = pool.submit(graph_seconds).result()
    yield Figure("a test offline, from reading the machine to its end", 1000.0 * offline, "ms")
    yield Figure("the same in a graph, from its start to its end", graph, "s")
    yield Figure("graph / offline", graph / offline, "×", goal=100.0)


def offline_seconds() -> float:
    """The first one in a process loads the modules as well."""
    begin = time.perf_counter()
    with Machine.offline(MACHINE) as m:
        session(m)
    return time.perf_counter() - begin


def graph_seconds() -> float:
    begin = time.perf_counter()
    with Machine.start(MACHINE) as m:
        session(m)
    return time.perf_counter() - begin


def session(m: Machine) -> None:
    """A motion there and back, a spindle, manual blocks: 2 s of machine time."""
    x, spindle = m.axes["x"], m.spindles["s"]
    x.move_absolute(100).wait(30.0)
    x.move_absolute(0).wait(30.0)
    spindle.start(1200).wait(30.0)
    spindle.stop().wait(30.0)
    m.channel.mdi("G1 X20 Y20 F6000").wait(30.0)
    assert x.state.set_position == 20.0
