"""A machine for programs: `with Machine.offline("config/mill.yaml") as m: m.x.move_absolute(100).wait()`."""

from __future__ import annotations

import atexit
import sys
from collections.abc import Callable, Mapping, Sequence
from contextlib import suppress
from dataclasses import asdict, replace
from os import PathLike, fspath
from types import TracebackType
from typing import Any, TypeVar

from cnc_ptp.client.asking import Rows
from cnc_ptp.client.faults import check_callable, check_seconds, unknown_unit
from cnc_ptp.client.link import Link
from cnc_ptp.client.plc_cycles import PlcCycles
from cnc_ptp.client.recorder import Recorder
from cnc_ptp.client.session import Session, Turns
from cnc_ptp.client.several_jobs import TrajectoryJob
from cnc_ptp.client.stream import Stream
from cnc_ptp.client.units import UNITS, Axis, Channel, Plc, Spindle, Unit
from cnc_ptp.errors import CncError
from cnc_ptp.protocol.blocks import Event
from cnc_ptp.protocol.unit import PLC
from cnc_ptp.recording.recorder_options import RecorderOptions

Path = str | PathLike[str]
Kind = TypeVar("Kind", Axis, Spindle, Channel)
OneKind = TypeVar("OneKind")


class Machine:
    """The units of a machine by name: `m.x`, `m["x"]`; typed in `m.axes`, `m.spindles`, `m.channels`; `m.plc`.

    Made by `start` (a graph of its own), `connect` (a graph that runs already) or `offline` (no graph at all); the
    calls are the same. Offline, time passes only while the program waits: in `wait`, `wait_until`, `run_for` and
    iterators. `close`, or the end of a `with` block, ends it.
    """

    def __init__(self, link: Link) -> None:
        self._session = Session(link)
        self.recorder = Recorder(self._session)
        """Records on demand: start, stop, snapshot."""
        self._units: dict[str, Unit] = {name: UNITS[kind](self._session, name) for name, kind in link.kinds.items()}
        self.axes: Mapping[str, Axis] = self._of(Axis)
        self.spindles: Mapping[str, Spindle] = self._of(Spindle)
        self.channels: Mapping[str, Channel] = self._of(Channel)
        atexit.register(self._close_at_exit)

    def _of(self, kind: type[Kind]) -> Mapping[str, Kind]:
        units = {name: unit for name, unit in self._units.items() if isinstance(unit, kind)}
        return Units(units, kind.__name__.lower())

    # where it comes from

    @classmethod
    def offline(
        cls,
        machine: Path,
        *,
        record: Path | None = None,
        recorder: RecorderOptions | None = None,
        scenario: Path | None = None,
        plc: Path | None = None,
    ) -> Machine:
        """A machine without a graph, as fast as possible, the same to the bit every time. Its first block is computed.

        `record`: an MCAP file, as of `cnc_ptp simulate`; `recorder`: how it is written, and recordings on demand;
        `scenario`: timed commands; `plc`: a PLC in a file. Raises ParameterError, ScenarioError, and CncError 25104,
        26007, 26012, 26019, 26020, 26110, 26113, 26117, 26222.
        """
        from cnc_ptp.client.offline_link import OfflineLink

        files = given_files(record=record, scenario=scenario, plc=plc)
        return cls(OfflineLink(fspath(machine), recorder=recorder, **files))

    @classmethod
    def start(
        cls,
        machine: Path,
        *,
        record: Path | None = None,
        recorder: RecorderOptions | None = None,
        scenario: Path | None = None,
        plc: Path | None = None,
        composed: bool = False,
        domain: int | None = None,
        namespace: str = "",
        timeout: float = 60.0,
    ) -> Machine:
        """Starts the ROS graph of a machine, as `cnc_ptp run --stay` does; it ends on its ramps with this program.

        `record`: an MCAP file; `recorder`: how it is written, and recordings on demand; `scenario`: timed commands;
        `plc`: a PLC in a file; `composed`: all nodes in one process; `domain`: None = ROS_DOMAIN_ID;
        `namespace`: of all nodes; `timeout` in s until it runs. Raises ParameterError, ScenarioError, CncError 26176
        (not started) and what `cnc_ptp run` refuses: 26107 (the domain is taken), 26108, 26110, 26113, 26117, 26141 …
        """
        from cnc_ptp.client.graph_link import start_graph

        check_seconds("start", "timeout", timeout, "nothing was started", finite=True)
        files = given_files(record=record, scenario=scenario, plc=plc)
        options: dict[str, Any] = {"machine": fspath(machine), "composed": composed, **files}
        if record is not None or recorder is not None:
            options["recorder"] = asdict(
                replace(recorder or RecorderOptions(), scenario=files.get("scenario"), plc=files.get("plc"))
            )
        return cls(start_graph(options, domain=domain, namespace=namespace, timeout=timeout))

    @classmethod
    def connect(cls, *, domain: int | None = None, namespace: str = "", timeout: float = 5.0) -> Machine:
        """The machine that runs on this ROS domain; motions and programs continue when this client ends, jogs end.

        As `start`; `timeout` in s for it to be found. Raises CncError 26108, 26135.
        """
        from cnc_ptp.client.graph_link import connect_graph

        check_seconds("connect", "timeout", timeout, "no machine was looked for", finite=True)
        return cls(connect_graph(domain=domain, namespace=namespace, timeout=timeout))

    # units

    @property
    def plc(self) -> Plc:
        """The PLC."""
        plc = self._units[PLC]
        assert isinstance(plc, Plc)
        return plc

    @property
    def channel(self) -> Channel:
        """The channel of this name, or the first one. Raises CncError 26111 where there is none."""
        for channel in [self.channels.get("channel"), *self.channels.values()]:
            if channel is not None:
                return channel
        raise unknown_unit("channel", self._units)

    def __getitem__(self, name: str) -> Unit:
        """The unit of this name. Raises CncError 26111, which is also a KeyError."""
        unit = self._units.get(name)
        if unit is None:
            raise unknown_unit(name, self._units)
        return unit

    def __getattr__(self, name: str) -> Any:
        """As `m[name]`; the error is also an AttributeError."""
        if name.startswith("_"):
            raise AttributeError(name)
        return self[name]

    def __dir__(self) -> list[str]:
        return [*super().__dir__(), *self._units]

    def follow(
        self,
        axes: Sequence[Axis | str],
        points: Rows,
        *,
        path_tolerance: Rows | None = None,
        goal_tolerance: Rows | None = None,
        goal_time: float | None = None,
    ) -> TrajectoryJob:
        """Axes follow a trajectory together: `m.follow([m.x, m.y], [(1.0, [100, 50], [0, 0])]).wait()`.

        The arguments are those of `m.plc.follow_trajectory`. Raises its refusal: the form of the points. What an axis
        refuses, and what goes wrong on the way, `wait` raises.
        """
        names = [axis if isinstance(axis, str) else axis.name for axis in axes]
        given = {"path_tolerance": path_tolerance, "goal_tolerance": goal_tolerance, "goal_time": goal_time}
        return self.plc._trajectory_job(names, points, given)

    # time

    @property
    def cycle(self) -> int:
        """The first cycle that not every unit has told of."""
        return self._session.link.seen.cycle

    @property
    def time(self) -> float:
        """Seconds of the machine up to that cycle."""
        return self._session.time

    @property
    def cycle_time(self) -> float:
        """Seconds."""
        return self._session.link.cycle_time

    def run_for(self, seconds: float) -> None:
        """Lets so much time of the machine pass, rounded up to whole blocks. Raises CncError 22001 for no number."""
        self._session.run(self._session.until(self._time_is(seconds), None, "run_for", may_stall=True))

    async def run_for_async(self, seconds: float) -> None:
        """As `run_for`, in an event loop."""
        await self._session.run_async(self._session.until(self._time_is(seconds), None, "run_for", may_stall=True))

    def _time_is(self, seconds: float) -> Callable[[], bool]:
        check_seconds("run_for", "seconds", seconds, "no time has passed", finite=True)
        end = self.cycle + round(seconds / self.cycle_time)
        return lambda: self.cycle >= end

    def plc_cycles(self, duration: float | None = None) -> PlcCycles:
        """The PLC cycles (cycle blocks) for function blocks: `for _ in m.plc_cycles():`, or `async for`.

        The first one comes at once. `duration` in s of the machine; None: without an end, but offline CncError 26174
        where nothing has moved for 10 s. Raises as `Job.wait`.
        """
        return PlcCycles(self._session, duration)

    def wait_until(self, condition: Callable[[], bool], timeout: float | None = None) -> None:
        """Waits until the condition is true; it is asked with every block. Raises as `Job.wait`."""
        self._session.run(self._until(condition, timeout))

    async def wait_until_async(self, condition: Callable[[], bool], timeout: float | None = None) -> None:
        """As `wait_until`, in an event loop."""
        await self._session.run_async(self._until(condition, timeout))

    def _until(self, condition: Callable[[], bool], timeout: float | None) -> Turns:
        check_callable("wait_until", "condition", condition, "no time has passed")
        check_seconds("wait_until", "timeout", timeout, "no time has passed")
        return self._session.until(condition, timeout, "the condition has not come true", effect="")

    def events(self, duration: float | None = None) -> Stream[Event, Event]:
        """The events of all units from now on: state changes, warnings, errors. As `Axis.states`."""
        mailbox = self._session.link.seen.events()
        return Stream(self._session, mailbox, lambda event: [event], duration=duration, what="no new event")

    # the end

    def close(self) -> None:
        """The end: an offline machine, or a graph that was started, stops on its ramps. A second call has no effect."""
        if self._session.closed:
            return
        self._let_go()
        self._session.closed = True
        atexit.unregister(self._close_at_exit)
        self._session.link.close()

    def _close_at_exit(self) -> None:
        """Of a program that has not closed it: nobody is left that could take an error."""
        try:
            self.close()
        except CncError as error:
            print(error, file=sys.stderr)

    def _let_go(self) -> None:
        """Units that MC_Stop of this program holds are free; a machine that is gone holds none."""
        for unit in self._units.values():
            if unit.stops:
                with suppress(CncError):
                    self._session.ask(unit.name, "hold_stop", {"enabled": False})

    def __enter__(self) -> Machine:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        try:
            self.close()
        except Exception as second:
            if error is None:
                raise
            error.add_note(f"then, when the machine was closed: {second}")

    async def __aenter__(self) -> Machine:
        return self

    async def __aexit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self.__exit__(kind, error, trace)

    def __repr__(self) -> str:
        return f"<machine of {', '.join(self._units)}{', closed' if self._session.closed else ''}>"


class Units(dict[str, OneKind]):
    """The units of one kind by name; a name that is not there has its own error."""

    def __init__(self, units: Mapping[str, OneKind], what: str) -> None:
        super().__init__()
        self.update(units)
        self._what = what

    def __missing__(self, name: str) -> OneKind:
        raise unknown_unit(name, self, self._what)


def given_files(**files: Path | None) -> dict[str, str]:
    """Those that are given, as texts."""
    return {name: fspath(path) for name, path in files.items() if path is not None}
