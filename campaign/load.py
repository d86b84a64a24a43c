"""Load, time and company: what a running machine must not notice, or must survive."""

from __future__ import annotations

import json
import os
import signal
import subprocess
import sys
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager, suppress
from dataclasses import asdict, dataclass, field
from functools import wraps
from math import ceil, isnan, nan
from pathlib import Path
from typing import Any, Concatenate, ParamSpec

import numpy as np
import psutil

from bench.lateness import lateness_p99, told
from campaign import motion
from campaign.cases import CASES, ROUND, Case, milling
from campaign.graph import Graph, free_domain
from cnc_ptp.parameters import read_machine
from cnc_ptp.protocol.blocks import Severity
from cnc_ptp.recording.node_figures import LATENESS_MAX, LOST_BLOCKS
from cnc_ptp.recording.reader import Recorded, read_recording

SECONDS = 8.0
"""Of a run that something is done to."""
FROZEN = 3.0
"""Seconds for which a whole graph stands still."""
CLOCK_STEP = 3600.0
"""Seconds by which the wall clock is set."""
WATCHDOG = 26101
SUBSCRIBERS, FOREIGN, LATE = "subscribers", "foreign nodes", "late joiner"
COMPANY_OF = {SUBSCRIBERS: (200, 20), FOREIGN: (50, 5), LATE: (1, 1)}
"""How many, and how many of them are a participant of DDS."""
COMING = 900.0
"""Seconds at most until all newcomers are there: on two processors the machine, which comes first, leaves little."""
MOVING_TOPICS = 20
"""Floods of topics in which the program runs on, at least."""
FLOOD = 0.2
"""Seconds for each topic and each service."""
SETTLED, SETTLING = 0.2, 300.0
"""Seconds of a soak after which memory must not grow any more; part of one that is shorter."""
SAMPLING = 5.0
"""Seconds from one look at the processes to the next, in a soak of a minute or more."""
GROWTH_MB = 1.0
"""What a process may grow by in a soak."""
LATER, LATE_MS = 2.0, 10.0
"""By what the lateness (p99) may grow from the first to the last quarter of a soak; below LATE_MS it does not count."""


@dataclass
class LoadRow:
    """A condition and its consequences."""

    name: str
    figures: dict[str, float] = field(default_factory=dict)
    problems: list[str] = field(default_factory=list)
    untried: str = ""
    """Why it was not tried, if it was not: neither good nor bad then."""

    @property
    def good(self) -> bool | None:
        return None if self.untried else not self.problems

    def as_json(self) -> dict[str, Any]:
        return asdict(self) | {"good": self.good}


class NotTriedError(Exception):
    """A condition that cannot be made here."""


P = ParamSpec("P")


def condition(name: str) -> Callable[[Callable[Concatenate[LoadRow, P], None]], Callable[P, LoadRow]]:
    """Makes a function that gives a row of this name from one that fills it; an error loses nothing found before."""

    def of(fill: Callable[Concatenate[LoadRow, P], None]) -> Callable[P, LoadRow]:
        @wraps(fill)
        def attempted(*arguments: P.args, **named: P.kwargs) -> LoadRow:
            row = LoadRow(name)
            try:
                fill(row, *arguments, **named)
            except NotTriedError as error:
                row.untried = str(error)
            except Exception as error:  # whatever it is, the conditions behind it are tried
                row.problems.append(f"not looked at to the end: {error!r}")
            return row

        return attempted

    return of


@contextmanager
def started(name: str, folder: Path, domain: int, *options: str, program: str = "") -> Iterator[Graph]:
    """A run of a case that has begun; `program`: another text than that of the case."""
    case = case_of(name)
    case = case._replace(program=program or case.program)
    place = folder / f"{name}_{domain}"
    place.mkdir(parents=True, exist_ok=True)
    graph = Graph([*case.words(place), *options], place / "run.mcap", domain=domain)
    try:
        if not graph.wait_for_start():
            raise RuntimeError(f"the run did not start: {graph.output[-500:]}")
        yield graph
    finally:
        graph.end()


def case_of(name: str) -> Case:
    return next(case for case in CASES if case.name == name)


def finished(row: LoadRow, graph: Graph, name: str, *, errors_count: bool = True) -> Recorded:
    """Interrupts a run and checks that nothing but that has stopped it.

    `errors_count`: an event of an error is a problem; not where somebody has commanded what comes to one.
    """
    if not graph.running:
        row.problems.append(f"the run has ended by itself: {graph.output[-400:]}")
    graph.interrupt()
    if not graph.wait(60.0):
        row.problems.append("the run does not end")
        graph.end()
    if orphans := graph.orphans():
        row.problems.append(f"orphans: {orphans}")
    recorded = read_recording(graph.recording)
    row.problems += checked_motion(graph, name, recorded)
    errors = {event.text for event in recorded.events if event.severity == Severity.ERROR and event.error_id != 26106}
    row.problems += sorted(errors) if errors_count else []
    newest = {each.name: each.values for each in recorded.diagnostics}
    lost = sum(int(values.get(LOST_BLOCKS, 0)) for values in newest.values())
    row.problems += [f"{lost} blocks were lost"] if lost else []
    row.figures |= {
        "cycles": recorded.last_cycle + 1,
        "lost blocks": lost,
        "largest lateness [ms]": largest_lateness(recorded),
        "load": round(os.getloadavg()[0], 1),
    }
    return recorded


def checked_motion(graph: Graph, name: str, recorded: Recorded) -> list[str]:
    """What is wrong with the motion of a run that has come to its end."""
    machine = read_machine(str(case_of(name).machine))
    return [*motion.problems(recorded, machine, ended=True), *motion.violations(graph.recording)]


@condition("all processors busy")
def busy_processors(row: LoadRow, folder: Path, domain: int) -> None:
    """Twice as many programs as processors that never rest."""
    burners = [subprocess.Popen([sys.executable, "-c", "while True: pass"]) for _ in range(2 * (os.cpu_count() or 1))]
    try:
        with started("program", folder, domain) as graph:
            time.sleep(SECONDS)
            finished(row, graph, "program")
    finally:
        for burner in burners:
            burner.kill()
            burner.wait()


MEMORY = """
import mmap, sys, time
held = mmap.mmap(-1, int(sys.argv[1]) * 2**20, mmap.MAP_PRIVATE | mmap.MAP_ANONYMOUS | mmap.MAP_POPULATE)
time.sleep(float(sys.argv[2]))
"""
"""A program that holds so many MiB for so many seconds."""
SPARED = 1.0
"""GiB that it leaves."""


@condition("memory pressure")
def memory_pressure(row: LoadRow, folder: Path, domain: int) -> None:
    """A program takes all free memory but a little, and gives it back."""
    with started("program", folder, domain) as graph:
        free = max(64.0, psutil.virtual_memory().available / 2**20 - 1024.0 * SPARED)
        row.figures["MiB taken"] = float(int(free))
        done = subprocess.run([sys.executable, "-c", MEMORY, str(int(free)), "3.0"], check=False)
        row.problems += [f"it could not be taken: status {done.returncode}"] if done.returncode else []
        finished(row, graph, "program")


@contextmanager
def clock_set(by: float) -> Iterator[None]:
    """The wall clock of this computer is `by` s elsewhere. Raises PermissionError."""
    began, passed = time.time(), time.monotonic()
    time.clock_settime(time.CLOCK_REALTIME, began + by)
    try:
        yield
    finally:
        time.clock_settime(time.CLOCK_REALTIME, began + time.monotonic() - passed)


@condition(f"wall clock set by {CLOCK_STEP:g} s")
def wall_clock_set(row: LoadRow, folder: Path, domain: int) -> None:
    """An hour back, then forth; then, an hour back, the clock of the machine is killed: units notice it themselves."""
    with started("program", folder / "set", domain) as graph:
        for by in (-CLOCK_STEP, CLOCK_STEP):
            with clock_set(by):
                time.sleep(2.0)
        finished(row, graph, "program")
    with started("program", folder / "killed", domain) as graph, clock_set(-CLOCK_STEP):
        time.sleep(1.0)
        graph.processes["clock"].kill()
        if not graph.wait(30.0):
            row.problems.append("without the clock the run does not end")
    recorded = read_recording(graph.recording)
    row.problems += motion.problems(recorded, read_machine(str(case_of("program").machine)), ended=True)
    silent = {event.source for event in recorded.events if event.error_id == WATCHDOG}
    if missing := {"x", "y", "z"} - silent:
        row.problems.append(f"no watchdog of {', '.join(sorted(missing))}")


@condition(f"whole graph suspended for {FROZEN:g} s")
def suspended(row: LoadRow, folder: Path, domain: int) -> None:
    """All processes of a graph stand still together, as those of a suspended computer."""
    with started("program", folder, domain) as graph:
        time.sleep(2.0)
        family = graph.processes.values()
        for number, wait in ((signal.SIGSTOP, FROZEN), (signal.SIGCONT, 4.0)):
            for process in family:
                with suppress(psutil.NoSuchProcess):
                    process.send_signal(number)
            time.sleep(wait)
        finished(row, graph, "program")


COMPANY = """
import sys, time, rclpy
from rclpy.context import Context
from std_msgs.msg import String
from cnc_ptp import msg
from cnc_ptp.nodes import process
from cnc_ptp.nodes.topics import BLOCKS, EVENTS
what, number, each, seconds = sys.argv[1], int(sys.argv[2]), int(sys.argv[3]), float(sys.argv[4])
began, count, executors, kept = time.monotonic(), 0, [], []
def heard(message):
    global count
    count += 1
def participant():
    context = Context()
    process.initialise(context)
    executors.append(process.EventsExecutor(context=context))
def newcomer(n):
    executor = executors[-1]
    options = {"context": executor.context, "enable_rosout": False, "start_parameter_services": False}
    node = rclpy.create_node(f"newcomer{n}", **options)
    executor.add_node(node)
    return node
for n in range(number):
    if n % each == 0:
        participant()
    if what != "subscribers" or n % each == 0:
        node = newcomer(n)
    if what == "subscribers":
        node.create_subscription(msg.AxisBlock, ["x", "y", "z"][n % 3] + "/block", heard, BLOCKS)
    elif what == "late joiner":
        node.create_subscription(msg.CommandRecord, "commands", heard, EVENTS)
    else:
        kept.append(node.create_publisher(String, f"foreign{n}/text", 10))
print(round(time.monotonic() - began, 1), flush=True)
end = time.monotonic() + seconds
while time.monotonic() < end:
    for executor in executors:
        executor.spin_once(timeout_sec=0.05 / len(executors))
print(count, flush=True)
for executor in executors:
    executor.shutdown()
    executor.context.try_shutdown()
"""
"""A program of its own on the domain of the machine: so many nodes `each` are a participant of DDS, or so many
subscribers one node."""


@condition("company")
def company(row: LoadRow, what: str, number: int, each: int, folder: Path, domain: int) -> None:
    """Others on the same domain, who come while the machine runs; so many `each` are a participant of DDS."""
    row.name = f"{number} {what}, {ceil(number / each)} participants"
    with started("program", folder, domain, program=milling(ceil(COMING / ROUND))) as graph:
        words = [sys.executable, "-c", COMPANY, what, str(number), str(each), str(SECONDS)]
        environment = os.environ | {"ROS_DOMAIN_ID": str(domain)}
        done = subprocess.run(words, env=environment, capture_output=True, text=True, timeout=COMING, check=False)
        coming, got = map(float, done.stdout.split()) if done.returncode == 0 else (nan, nan)
        row.figures |= {"seconds until they were there": coming, "messages that they got": got}
        if done.returncode or (what != FOREIGN and got < 1.0):
            row.problems.append(f"they got nothing: {done.stdout} {done.stderr[-300:]}")
        finished(row, graph, "program")


@condition("floods of each topic and service")
def floods(row: LoadRow, folder: Path, domain: int) -> None:
    """1,000 messages a second on each topic that somebody may write, and calls of each service."""
    with started("program", folder, domain, "--stay") as graph:  # what comes may end the program
        machine = str(case_of("program").machine)
        words = [sys.executable, "-m", "campaign.flood", machine, str(FLOOD)]
        environment = os.environ | {"ROS_DOMAIN_ID": str(domain)}
        done = subprocess.run(words, env=environment, capture_output=True, text=True, timeout=600, check=False)
        counts = json.loads(done.stdout.splitlines()[-1]) if done.returncode == 0 else {}
        row.figures |= {name: float(count) for name, count in counts.items()}
        if done.returncode or counts["unanswered"]:
            row.problems.append(f"calls without an answer: {counts} {done.stderr[-300:]}")
        recorded = finished(row, graph, "program", errors_count=False)
    moved = int(np.count_nonzero(recorded.states["/x/state"]["set_velocity"]))
    row.figures["cycles in motion"] = moved
    if moved < 1000.0 * FLOOD * MOVING_TOPICS:
        row.problems.append(f"x has moved in {moved} cycles only: it was no flood of a running machine")


@condition("two machines on two domains")
def two_machines(row: LoadRow, folder: Path, domain: int) -> None:
    """The same program on two domains at once: equal to the bit, as far as both have come."""
    program = milling(ceil(COMING / ROUND))  # the first one runs while the second one starts
    with (
        started("program", folder, domain, program=program) as first,
        started("program", folder, free_domain(domain + 1), program=program) as second,
    ):
        time.sleep(SECONDS)
        both = [finished(row, graph, "program") for graph in (first, second)]
    cycles = int(0.5 * SECONDS * 1000.0)
    for topic, rows in both[0].states.items():
        other = both[1].states[topic]
        for name in rows.dtype.names or ():
            if not name.startswith("header") and not np.array_equal(rows[name][:cycles], other[name][:cycles]):
                row.problems.append(f"{topic} {name} differs")


@condition("soak")
def soak(row: LoadRow, minutes: float, folder: Path, domain: int) -> None:
    """A machine that runs for long: memory, handles, threads of each process, lateness of the blocks."""
    row.name = f"soak of {minutes:g} minutes"
    place = folder / "soak"
    place.mkdir(parents=True, exist_ok=True)
    case = case_of("program")._replace(program=milling(ceil(60.0 * minutes / ROUND) + 1))
    graph = Graph(case.words(place), place / "run.mcap", domain=domain)
    samples: list[dict[str, tuple[float, int, int]]] = []
    try:
        if not graph.wait_for_start():
            row.problems.append(f"the run did not start: {graph.output[-500:]}")
            return
        end = time.monotonic() + 60.0 * minutes
        while time.monotonic() < end and graph.running:
            time.sleep(min(SAMPLING, 6.0 * minutes))
            with suppress(psutil.NoSuchProcess):
                samples.append({name: figures_of(each) for name, each in graph.processes.items()})
        finished(row, graph, "program")
    finally:
        graph.end()
    grown(row, samples)
    later(row, graph.recording, judged=60.0 * minutes > SETTLING)


def figures_of(process: psutil.Process) -> tuple[float, int, int]:
    """Memory of its own in MB, file handles, threads."""
    return process.memory_full_info().uss / 1e6, process.num_fds(), process.num_threads()


def grown(row: LoadRow, samples: list[dict[str, tuple[float, int, int]]]) -> None:
    """The growth after the first five minutes; that of the memory in a shorter soak is not judged."""
    if not samples:
        row.problems.append("no process was looked at")
        return
    long = len(samples) > int(SETTLING / SAMPLING)
    settled = samples[int(SETTLING / SAMPLING) if long else int(len(samples) * SETTLED) :]
    for name in settled[0]:
        memory, handles, threads = (settled[-1][name][n] - settled[0][name][n] for n in range(3))
        row.figures[f"{name}: MB more"] = round(memory, 2)
        if long and memory > GROWTH_MB:
            row.problems.append(f"{name} has grown by {memory:.2f} MB")
        if handles > 0 or threads > 0:
            row.problems.append(f"{name} has {handles} more file handles, {threads} more threads")


def later(row: LoadRow, recording: Path, *, judged: bool = True) -> None:
    """The p99 of the latest node in the first and in the last quarter; it is only told where it is not `judged`."""
    messages = told(recording)
    begin, end = (messages[place][0] if messages else 0 for place in (0, -1))
    begin += min(int(1e9 * SETTLING), (end - begin) // 10)  # nodes are late when they start
    quarter = (end - begin) // 4
    first = lateness_p99(messages, begin, begin + quarter)
    last = lateness_p99(messages, end - quarter, end)
    if isnan(first) or isnan(last):
        row.problems.append("no node has told its lateness")
        return
    row.figures |= {"p99 of the first quarter [ms]": first, "p99 of the last quarter [ms]": last}
    if judged and last > max(LATER * first, LATE_MS):
        row.problems.append(f"p99 of the lateness has grown from {first:g} to {last:g} ms")


def largest_lateness(recorded: Recorded) -> float:
    """Of any block, ms."""
    return max((float(each.values.get(LATENESS_MAX, 0.0)) for each in recorded.diagnostics), default=0.0)
