"""Runs the graph: starts one process per node, watches them, ends them in order; leaves no orphan."""

from __future__ import annotations

import signal
import time
from collections.abc import Callable, Iterable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from multiprocessing.connection import wait
from multiprocessing.process import BaseProcess
from typing import Any

import rclpy
from rclpy.client import Client

from cnc_ptp import srv
from cnc_ptp.errors import CncError
from cnc_ptp.interrupt import INTERRUPTED
from cnc_ptp.machine.wiring import unit_kinds
from cnc_ptp.nc.block_search import StartPoint
from cnc_ptp.nodes import convert, process
from cnc_ptp.nodes.events import EventPublisher
from cnc_ptp.nodes.forked import (
    NODE_DIED,
    SERVER_ENDED,
    end,
    is_alive,
    server_is_gone,
    start_node,
    start_server,
    wait_for,
)
from cnc_ptp.nodes.live_stream import require_foxglove
from cnc_ptp.nodes.monitor import SUPERVISOR, RunMonitor
from cnc_ptp.nodes.topics import MONITOR, RECORDER
from cnc_ptp.nodes.unit.claim import require_free
from cnc_ptp.parameters import MachineParameters
from cnc_ptp.protocol.blocks import Event, Severity
from cnc_ptp.protocol.notes import Note
from cnc_ptp.protocol.unit import CLOCK, PLC
from cnc_ptp.recording.closing import close_cut_recording
from cnc_ptp.recording.recorder_options import FROM_THE_START, RecorderOptions
from cnc_ptp.ros_arguments import ros_arguments
from cnc_ptp.start_options import start_words
from cnc_ptp.state.machine_state import CHECKPOINT_SECONDS

SERVER = "server of processes"
NOT_READY = 26105
STARTED_AGAIN = 26146
POLL = 0.05
START_TIMEOUTS = (20.0, 20.0, 60.0)
"""Seconds from the node that came last to the first cycle, in each try to start: of the mill 1 to 4 s, of 26 nodes on
two busy cores 10 s. The last one is for slow computers, and for nodes that are still to come: one may have a long
program to read."""
STOP_TIMEOUT = 15.0
"""Seconds for all ramps after a fault or an interrupt."""
END_TIMEOUT = 5.0
MODULES = {"axis": "axis", "spindle": "spindle", "channel": "nc_channel", "plc": "plc_bridge"}


@dataclass(frozen=True)
class RunOptions:
    """Machine, program, scenario and options of a run, as paths for the node processes."""

    machine: str
    program: str | None = None
    scenario: str | None = None
    duration: float | None = None
    record: str | None = None
    free_run: bool = False
    stay: bool = False
    """Continue when everything is at a standstill, until a signal."""
    state_rate: float | None = None
    """Live states per second, None = as the machine file says."""
    dialect: str | None = None
    """Vocabulary of the program, None = as the machine file says."""
    begin: StartPoint | None = None
    """Where the program begins, if not at its beginning."""
    plc: str | None = None
    """A PLC in a file."""
    recorder: RecorderOptions | None = None
    """Of the recorder; without `record` it records on demand alone."""
    checkpoints: float = CHECKPOINT_SECONDS
    """Machine time between two states of all units in the recording, s; 0: none."""
    foxglove: int | None = None
    """Port of a live stream for Foxglove."""

    @property
    def recording(self) -> RecorderOptions | None:
        """None: without a recorder, which also makes the live stream."""
        needed = self.record is not None or self.foxglove is not None
        return self.recorder or (FROM_THE_START if needed else None)


class Supervisor:
    """Starts, watches and ends the processes of one run."""

    def __init__(
        self,
        machine: MachineParameters,
        options: RunOptions,
        *,
        show: Callable[[RunMonitor], None],
        watched: bool = False,
    ) -> None:
        """`show` is called about 20 times per second with the monitor; `watched`: units are shown."""
        self._machine = machine
        self._moving_units = [*machine.axes, *machine.spindles]
        self._options = options
        self._show = show
        self._watched = watched or options.stay
        self._processes: dict[str, BaseProcess] = {}
        self._stop_deadline: float | None = None
        self._stop_is_due = False
        """The PLC is to stop everything, and has not been told yet."""
        self._settled_at = 0.0
        self._dead: set[str] = set()
        self._interrupted = False
        self._signals: list[int] = []
        self._failed_starts: list[Note] = []
        self.failures: list[str] = []

    def run(self) -> RunMonitor:
        """Runs it to its end; `failures` then lists what went wrong with processes."""
        start_server()
        with only_run(self._options), self._signals_noted():
            for number, patience in enumerate(START_TIMEOUTS):
                self._patience = patience
                monitor = self._run()
                if len(self._failed_starts) == number or self._interrupted_between_starts():
                    break
                process.initialise()
        return monitor

    def _run(self) -> RunMonitor:
        """One try, with a monitor of its own: it may be the one that has not found the others."""
        monitor = RunMonitor(self._machine)
        require_free(monitor, unit_kinds(self._machine))
        if self._watched:
            monitor.watch_units()
        for note in self._failed_starts:
            monitor.notes.add(note)
        self._event_publisher = EventPublisher(monitor)
        self._stop_all: Client[Any, Any] = monitor.create_client(srv.Execute, f"{PLC}/stop_all")
        self._monitor = monitor
        try:
            self._start_all()
            self._absent, self._came_at = len(self._processes), time.monotonic()
            process.spin([monitor], done=self._over, wait=lambda: POLL, after=self._look)
        finally:
            self._end_all()
            self._close_recordings()
        return monitor

    def _look(self) -> None:
        self._monitor.take_polled()
        self._tell_to_stop()
        self._show(self._monitor)

    # processes

    def _start_all(self) -> None:
        for name, arguments in command_lines(self._machine, self._options, observers_of(self._options)):
            self._processes[name] = start_node(arguments[0], [*arguments[1:], *ros_arguments().words])

    def _over(self) -> bool:
        """True when the run has come to its end, in order or after a fault."""
        if self._processes[CLOCK].exitcode == 0:
            return True
        self._note_interrupt()
        self._note_deaths()
        if self._stop_deadline is None:
            return self._not_started_in_time()
        if not self._monitor.cycle:
            return True
        living = [name for name in self._moving_units if is_alive(self._processes[name])]
        standing = self._monitor.standing
        settled = time.monotonic() > self._settled_at and all(standing.get(name, True) for name in living)
        return settled or time.monotonic() > self._stop_deadline

    def _not_started_in_time(self) -> bool:
        """True when this try to start has failed; nothing has moved then."""
        if self._monitor.cycle:
            return False
        names = self._monitor.get_node_names_and_namespaces()
        there = {name for name, namespace in names if namespace == self._monitor.get_namespace()}
        absent = [name for name in self._processes if name not in there]
        if len(absent) < self._absent:
            self._absent, self._came_at = len(absent), time.monotonic()
        patience = START_TIMEOUTS[-1] if absent else self._patience
        if time.monotonic() - self._came_at < patience:
            return False
        self._note_failed_start(
            f"the nodes did not find each other within {patience:g} s (not there: {', '.join(absent) or 'none'})"
        )
        return True

    def _note_failed_start(self, text: str) -> None:
        tries, this_try = len(START_TIMEOUTS), len(self._failed_starts) + 1
        if this_try == tries:
            self.failures.append(f"P-ERR-{NOT_READY} {text}; the run ends")
            return
        note = Note(STARTED_AGAIN, f"{text}; they are started again ({this_try + 1} of {tries})")
        self._failed_starts.append(note)
        self._monitor.notes.add(note)

    def _interrupted_between_starts(self) -> bool:
        """An interrupt that came while the nodes of a failed start were ended: nothing is started again."""
        if self._signals:
            name = signal.Signals(self._signals[0]).name
            self.failures.append(f"P-ERR-{INTERRUPTED} the run was interrupted ({name}); nothing has moved yet")
        return bool(self._signals)

    def _note_deaths(self) -> None:
        if not wait([child.sentinel for name, child in self._processes.items() if name not in self._dead], 0.0):
            return  # one system call, where each exit status needs its own
        for name, child in self._processes.items():
            status = child.exitcode
            if status is None or name in self._dead or (name == CLOCK and status == 0):
                continue
            if SERVER in self._dead:  # nobody can tell how a node has ended
                continue
            if server_is_gone(child):
                self._dead.add(SERVER)
                self._fail(NODE_DIED, f"{SERVER_ENDED}; {self._what_follows()}")
                continue
            self._dead.add(name)
            text = f"node '{name}' (process {child.pid}) {how_ended(status)} during the run; {self._what_follows()}"
            self._fail(NODE_DIED, text)

    def _fail(self, error_id: int, text: str) -> None:
        """Notes a failure, publishes it, and has everything that is still alive stopped."""
        self.failures.append(f"P-ERR-{error_id} {text}")
        self._monitor.note_failure(self.failures[-1])
        event = Event(self._monitor.cycle, SUPERVISOR, Severity.ERROR, error_id, text)
        self._event_publisher.publish(convert.event_to_message(event, convert.time_message(time.time_ns())))
        if self._stop_deadline is None:
            self._stop_everything()

    def _stop_everything(self) -> None:
        self._stop_is_due = PLC not in self._dead
        self._tell_to_stop()
        now = time.monotonic()
        self._stop_deadline = now + STOP_TIMEOUT
        self._settled_at = now + 3.0 * self._machine.watchdog_ms / 1000.0 + 0.5
        self._monitor.watch_standstill([name for name in self._moving_units if name not in self._dead])

    def _tell_to_stop(self) -> None:
        """Once: what is sent before the service is found is lost."""
        if self._stop_is_due and self._stop_all.service_is_ready():
            self._stop_is_due = False
            self._stop_all.call_async(srv.Execute.Request())

    def _what_follows(self) -> str:
        return "everything stops on its ramps" if self._monitor.cycle else "nothing has moved yet"

    @contextmanager
    def _signals_noted(self) -> Iterator[None]:
        numbers = (signal.SIGINT, signal.SIGTERM)
        previous = {number: signal.signal(number, self._note_signal) for number in numbers}
        try:
            yield
        finally:
            for number, handler in previous.items():
                signal.signal(number, handler)

    def _note_signal(self, number: int, frame: object) -> None:
        """Only notes it: a handler may interrupt anything that the process does."""
        self._signals.append(number)

    def _note_interrupt(self) -> None:
        """First interrupt: controlled stop; second: immediately."""
        if self._signals and not self._interrupted:
            self._interrupted = True
            name = signal.Signals(self._signals[0]).name
            if self._options.stay and self._stop_deadline is None and self._monitor.note_ending(name):
                self._stop_everything()
            else:
                self._fail(INTERRUPTED, f"the run was interrupted ({name}); {self._what_follows()}")
        if len(self._signals) > 1 and self._stop_deadline:
            self._stop_deadline = 0.0
            name = signal.Signals(self._signals[1]).name
            self.failures.append(f"P-ERR-{INTERRUPTED} a second interrupt ({name}) has ended the stop before its end")

    def _end_all(self) -> None:
        """Ends the nodes: the recorder after all others, so that it has seen everything."""
        others = [child for name, child in self._processes.items() if name != RECORDER]
        recorder = [child for name, child in self._processes.items() if name == RECORDER]
        for group in (others, recorder):
            for child in group:
                end(child, signal.SIGTERM)  # SIGINT would be a KeyboardInterrupt while Python still starts
            deadline = time.monotonic() + END_TIMEOUT
            for child in group:
                wait_for(child, deadline)
                end(child, signal.SIGKILL)
                child.join()

    def _close_recordings(self) -> None:
        """Closes what a recorder that was killed or has failed was writing, so that every reader opens it."""
        recorder = self._processes.get(RECORDER)
        status = None if recorder is None else recorder.exitcode
        if recorder is None or status in (0, process.SIGNALLED + signal.SIGTERM) or not self._monitor.cycle:
            return
        if status is not None and not self._dead & {RECORDER, SERVER}:
            how = f"node '{RECORDER}' (process {recorder.pid}) {how_ended(status)} at the end of the run"
            self.failures.append(f"P-ERR-{NODE_DIED} {how}; its recording goes as far as it was written")
        self.failures += close_recordings(self._options, self._monitor)


def close_recordings(options: RunOptions, monitor: RunMonitor) -> list[str]:
    """Closes what a recorder has left open; texts of those that cannot be closed."""
    failures = []
    for recording in filter(None, (options.record, monitor.on_demand)):
        try:
            close_cut_recording(recording)
        except CncError as error:
            failures.append(str(error))
    return failures


def command_lines(
    machine: MachineParameters, options: RunOptions, observers: Iterable[str]
) -> Iterator[tuple[str, list[str]]]:
    """Name and command line (executable first) of every node of a run; the clock waits for `observers` as well."""
    free_run = ["--free-run"] if options.free_run else []
    units = ["--recorders", "1"] if options.recording else []
    if options.recording and options.checkpoints != CHECKPOINT_SECONDS:
        units += ["--checkpoints", str(options.checkpoints)]
    units = [*units, "--state-rate", str(options.state_rate)] if options.state_rate is not None else units
    program = ["--program", options.program] if options.program else []
    program += ["--dialect", options.dialect] if options.program and options.dialect else []
    begin = [*start_words(options.begin)]
    if options.recording:
        file = [options.record] if options.record else []
        live = ["--foxglove", str(options.foxglove)] if options.foxglove is not None else []
        yield RECORDER, ["recorder", options.machine, *file, *options.recording.words(), *live]
    for name, kind in unit_kinds(machine).items():
        if kind != "plc":
            first = program if options.begin is None and name == next(iter(machine.channels), None) else []
            yield name, [MODULES[kind], options.machine, name, *first, *units]
    scenario = ["--scenario", options.scenario] if options.scenario else []
    plc = ["--plc", options.plc] if options.plc else []
    stay = ["--stay"] if options.stay or options.duration is not None else []
    yield (
        PLC,
        ["plc_bridge", options.machine, *program, *begin, *scenario, *plc, *stay, *free_run, *units],
    )
    duration = ["--duration", str(options.duration)] if options.duration is not None else []
    wait_for = [word for name in observers for word in ("--wait-for", name)]
    yield CLOCK, ["clock", options.machine, *duration, *free_run, *wait_for]


@contextmanager
def only_run(options: RunOptions) -> Iterator[None]:
    """ROS with its domain for this run alone; only then is the recording opened.

    Raises CncError 26107, 26108 (process), 26113 (recorder), 26023 and 26024 (live stream).
    """
    process.initialise()
    try:
        with process.claim_domain():
            if options.recording is not None:
                options.recording.require_places(options.record)
            if options.foxglove is not None:
                require_foxglove(options.foxglove)
            yield
    finally:
        rclpy.try_shutdown()


def observers_of(options: RunOptions) -> list[str]:
    """Nodes besides the units that the clock waits for."""
    return [MONITOR, *([RECORDER] if options.recording else [])]


def how_ended(status: int) -> str:
    """The return code of a process in words; SIGNALLED + n is how our nodes report signal n."""
    number = -status if status < 0 else status - process.SIGNALLED
    if number in {*signal.Signals}:
        return f"was ended by {signal.Signals(number).name}"
    return f"ended with exit status {status}"
